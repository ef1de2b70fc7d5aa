"""Linear feedback loops: blocks, a loop linear in its gains, what a sea does to it, its margins."""

from seatrial.loops.block import Block, in_series
from seatrial.loops.exposure import Exposure, HullFactor, exposure
from seatrial.loops.loop import Term, TransferLoop
from seatrial.loops.margins import Margins, margins
from seatrial.loops.objective import Objective, Row, Seen
from seatrial.loops.performance import Evaluation, Performance

__all__ = [
    "Block",
    "Evaluation",
    "Exposure",
    "HullFactor",
    "Margins",
    "Objective",
    "Performance",
    "Row",
    "Seen",
    "Term",
    "TransferLoop",
    "exposure",
    "in_series",
    "margins",
]
