"""Standard manoeuvres, their measures, and the IMO criteria."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
