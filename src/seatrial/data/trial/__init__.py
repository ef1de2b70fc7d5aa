"""Trials: ship, runs and their roles, model and settings, from a trial file or made in Python."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
