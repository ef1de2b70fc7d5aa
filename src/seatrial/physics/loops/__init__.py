"""Linear feedback loops: blocks, a loop linear in its gains, what a sea does to it, its margins."""

from seatrial.physics.loops.block import Block, in_series
from seatrial.physics.loops.exposure import Exposure, HullFactor, exposure
from seatrial.physics.loops.loop import Term, TransferLoop
from seatrial.physics.loops.margins import Margins, margins
from seatrial.physics.loops.objective import Objective, Row, Seen
from seatrial.physics.loops.performance import Evaluation, Performance

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
