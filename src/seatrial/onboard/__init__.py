"""Identification on board: streams of samples, growing estimates, the live table and page."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
