"""Benchmark problems with known answers, the methods that are entered against them, and how an entry is scored."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
