"""Optimisers: least squares, evolution strategies, swarms; start points and stopping rules."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
