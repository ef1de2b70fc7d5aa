"""Names of this package, imported when first used."""

from seatrial.physics.loops.objective import ActuatorDrive as ActuatorDrive
from seatrial.physics.loops.objective import LiftingSurface as LiftingSurface
from seatrial.physics.loops.objective import (
    reversals_per_hour as reversals_per_hour,
    SECONDS_PER_HOUR as SECONDS_PER_HOUR,
)
from seatrial.physics.loops.autopilot import heading_loop as heading_loop, pitch_loop as pitch_loop
from seatrial.physics.loops.autopilot import speed_loop as speed_loop
from seatrial.physics.loops.loop import Block as Block, controllable_form as controllable_form
from seatrial.physics.loops.loop import in_series as in_series
from seatrial.physics.loops.encounter_spectrum import EncounterSpectrum as EncounterSpectrum
from seatrial.physics.loops.encounter_spectrum import sea_disturbance as sea_disturbance, WAVE_SLOPE as WAVE_SLOPE
from seatrial.physics.loops.structures import (
    fin_loop as fin_loop,
    K_alpha_at as K_alpha_at,
    Preamplifier as Preamplifier,
)
from seatrial.physics.loops.loop import Term as Term, TransferLoop as TransferLoop
from seatrial.physics.loops.loop_states import StateSpace as StateSpace, state_space as state_space
from seatrial.physics.loops.performance import delay_margin as delay_margin, margins as margins
from seatrial.physics.loops.performance import StabilityMargins as StabilityMargins
from seatrial.physics.loops.objective import LoopSignal as LoopSignal, Objective as Objective
from seatrial.physics.loops.objective import WeightedVariance as WeightedVariance
from seatrial.physics.loops.objective import squared_deviation as squared_deviation, variance as variance
from seatrial.physics.loops.performance import LoopEvaluation as LoopEvaluation, Performance as Performance
from seatrial.physics.loops.performance import distinct_variances as distinct_variances
from seatrial.physics.loops.discrete import block_from_system as block_from_system
from seatrial.physics.loops.discrete import controller_transfer_function as controller_transfer_function
from seatrial.physics.loops.discrete import open_loop_transfer_function as open_loop_transfer_function
from seatrial.physics.loops.discrete import transfer_function as transfer_function
from seatrial.physics.loops.loop_states import plant_model as plant_model
from seatrial.physics.loops.loop import Sampling as Sampling
from seatrial.physics.loops.structures import FREQUENCIES_AND_DAMPINGS as FREQUENCIES_AND_DAMPINGS
from seatrial.physics.loops.structures import five_gain_loop as five_gain_loop
from seatrial.physics.loops.encounter_spectrum import HullFactor as HullFactor, WaveEffect as WaveEffect
from seatrial.physics.loops.encounter_spectrum import WaveSlope as WaveSlope, YawAcceleration as YawAcceleration
