"""A simulated trial series of a craft with known coefficients."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
