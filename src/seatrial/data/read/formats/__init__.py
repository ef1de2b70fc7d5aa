"""Readers, one format a file: from a path and a layout to a `Log`."""
