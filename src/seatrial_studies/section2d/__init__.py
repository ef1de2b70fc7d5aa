"""A 2-D ship section in regular beam waves: heave, sway and roll from measured records, beside potential theory."""

from seatrial_studies.section2d.study import study

__all__ = ["study"]
