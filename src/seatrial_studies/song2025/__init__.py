"""Song et al. 2025: support vector regression for a waterjet craft, repeated as published, audited, and answered."""

from seatrial_studies.song2025.study import study

__all__ = ["study"]
