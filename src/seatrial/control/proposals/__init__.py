"""Gains proposed on board: the sea and the craft that a stretch of record shows, and the gains that fit both."""
