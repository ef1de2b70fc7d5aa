"""Estimates while the record is still being made: the batch criterion over a growing window, then a filter."""
