"""Numbers and words for people: reports, terminal and live view share them."""

from seatrial.core.text.numbers import exact, significant

__all__ = ["exact", "significant"]
