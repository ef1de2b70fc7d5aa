from seatrial.exporting.source import ExportSource
from seatrial.exporting.source import Export, Target
from seatrial.exporting.targets import TARGETS, target_named

__all__ = ["TARGETS", "Export", "ExportSource", "Target", "target_named"]
