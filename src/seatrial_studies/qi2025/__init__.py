"""Qi et al. 2025: improved wild horse optimizer for heave and pitch, repeated as published, audited, and answered."""

from seatrial_studies.qi2025.study import study

__all__ = ["study"]
