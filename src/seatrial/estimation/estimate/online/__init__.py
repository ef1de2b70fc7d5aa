"""Estimates from a growing record: the batch criterion over a window, then a filter."""
