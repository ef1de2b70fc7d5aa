"""Fits and studies as self-contained HTML pages."""

from seatrial.reporting.page import write_report

__all__ = ["write_report"]
