"""Logs surveyed, and a trial file drafted from them: guesses by name and behaviour, each with its evidence."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
