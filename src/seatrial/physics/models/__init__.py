"""The built-in ship models and their registry, loaded when they are named."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
