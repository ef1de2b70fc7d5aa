"""Runs predicted open loop, with intervals and what these consist of."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
