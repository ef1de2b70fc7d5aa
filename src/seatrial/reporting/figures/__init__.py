"""Figures of the pages: results in, charts out."""
