"""Identification on board: streams of samples, growing estimates, the live table and page."""
