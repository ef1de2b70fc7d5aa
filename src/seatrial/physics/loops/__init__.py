"""Linear feedback loops: blocks, margins, performance in a sea; linear in their gains."""

from seatrial.physics.loops.block import Block, in_series
from seatrial.physics.loops.encounter_spectrum import EncounterSpectrum, HullFactor, wave_slope_spectrum
from seatrial.physics.loops.loop import Term, TransferLoop
from seatrial.physics.loops.margins import StabilityMargins, margins
from seatrial.physics.loops.objective import LoopSignal, Objective, WeightedVariance
from seatrial.physics.loops.performance import LoopEvaluation, Performance

__all__ = [
    "Block",
    "EncounterSpectrum",
    "HullFactor",
    "LoopEvaluation",
    "LoopSignal",
    "Objective",
    "Performance",
    "StabilityMargins",
    "Term",
    "TransferLoop",
    "WeightedVariance",
    "in_series",
    "margins",
    "wave_slope_spectrum",
]
