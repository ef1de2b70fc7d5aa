"""Fits, designs, tunings and studies as self-contained HTML pages; computes nothing."""

from seatrial.reporting.page import write_report

__all__ = ["write_report"]
