"""The commands as functions of values; those of `seatrial` itself and what the command line needs besides."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
