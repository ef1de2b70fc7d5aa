"""A programme steered through a model: zigzags, turning circles, a release; with the rudder's rate."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from seatrial.core.equations import Model
from seatrial.core.equations.model import RUDDER
from seatrial.core.values import Array, InputError, Provenance, Record, frozen
from seatrial.core.values.record import MAX_SAMPLES
from seatrial.physics.manoeuvres import REACH_PERCENTILE
from seatrial.physics.manoeuvres.programme import (
    FINISHED,
    NOT_FINISHED,
    Programme,
    Steering,
    release_angle,
    rudder_angles,
)
from seatrial.physics.simulate.replay import commanded, record_of, require_bounded, trajectory
from seatrial.physics.simulate.states import approach_speed, characteristic_time, held_inputs, settled_actuators

if TYPE_CHECKING:
    from seatrial.physics.manoeuvres.thrust_programme import ThrustProgramme

# A ship that rolls, let go from an angle: the decay that a model foresees.

_PERIODS = 15.0  # natural periods that a decay is simulated for where nothing is said; chosen
_SAMPLES_A_PERIOD = 100.0  # chosen; Runge-Kutta of fourth order then errs by 1e-6 of the angle a period


def natural_period(model: Model) -> float:
    """Return the natural period at small angles [s] of a model that rolls, 2 pi / sqrt(c_1).

    Raises:
        InputError: the model has no restoring moment `c_1`, or one that is not positive.
    """
    c_1 = model.parameters.value_of("c_1", math.nan)
    if not c_1 > 0.0:
        raise InputError(f"model '{model.name}' cannot be released: it needs a positive restoring moment c_1")
    return 2.0 * math.pi / math.sqrt(c_1)


def release(model: Model, text: str, period: float, duration: float | None = None) -> Record:
    """Let the ship go from an angle, at rest, in calm water with fins amidships.

    Args:
        model: states phi and p; all parameters must have values.
        text: ``release:15`` or ``release:15:port`` [deg], counted from the angle of rest `phi_0`.
        period: natural period [s], which sets sample interval and duration.
        duration: s; by default 15 natural periods.

    Returns:
        A simulated record of phi, p and the inputs, all zero.

    Raises:
        InputError: the text names no release, a duration that is not positive, or the simulation diverges.
    """
    angle, longest = release_angle(text), _PERIODS * period if duration is None else duration
    if not (math.isfinite(longest) and longest > 0.0):
        raise InputError(f"the duration {longest:g} s of a release is not positive")
    dt = period / _SAMPLES_A_PERIOD
    time = frozen(dt * np.arange(round(longest / dt) + 1))
    start = np.zeros(len(model.states))
    rest = model.parameters.value_of("phi_0", 0.0)
    start[model.states.index("phi")] = rest + angle
    inputs = np.zeros((len(time), len(model.inputs)))
    states, outputs = trajectory(model, inputs, dt, start)
    require_bounded(model, time, states, f"manoeuvre '{text}'")
    simulated = record_of(model, text, time, states, outputs, inputs)
    return replace(simulated, provenance=Provenance(f"manoeuvre '{text}' of model '{model.name}'"))


# A programme steered through a model: zigzags, turning circles and the rest, with the helmsman in the loop.

# 35 deg to 30 deg on the other side in 28 s: SOLAS, chapter II-1, regulation 29.3.2
SOLAS_SLEW_RATE = math.radians(65.0 / 28.0)


def manoeuvre(
    model: Model,
    programme: Programme,
    *,
    dt: float = 0.1,
    duration: float | None = None,
    speed: float | None = None,
    inputs: Mapping[str, float] | None = None,
    slew_rate: float = SOLAS_SLEW_RATE,
    approach: float = 0.0,
    length: float = 0.0,
) -> Record:
    """Steer `programme` from a straight run.

    The rudder angles the helmsman gave are then replayed linear between samples, so that replaying the returned record
    repeats it to the last bit.

    Args:
        model: needs the input ``delta`` and the state ``psi``; all parameters must have values.
        programme: from `manoeuvres.programme`.
        dt: step and sample interval [s].
        duration: s, at the longest; by default the programme's own in ship lengths, and it ends when finished.
        speed: approach speed u [m/s]; by default the speed at which the surge equation balances, rudder amidships.
        inputs: the other inputs, held constant, by name in SI units and notation signs (``n``, ``v_j``); wind is zero.
        slew_rate: of the rudder [rad/s]; by default SOLAS's for ships at full scale.
        approach: s before the first execute.
        length: of a craft [m] whose model has no parameter ``L``.

    Returns:
        A simulated record of states, outputs and inputs from the start of the approach.

    Raises:
        InputError: an input is missing or unknown, no steady speed exists, or the simulation diverges.
    """
    _require_steerable(model, dt, slew_rate)
    held = held_inputs(model, inputs or {}, RUDDER)
    start = settled_actuators(model, held)
    if model.has_speed:
        start[model.states.index("u")] = approach_speed(model, held) if speed is None else speed
    unit = characteristic_time(model, start, given_speed=speed, length=length)
    longest = approach + programme.maximum_lengths * unit if duration is None else duration
    rudder = model.input_names.index(RUDDER)
    steering = Steering(
        model.states.index("psi"), model.states.index("r") if "r" in model.states else -1,
        rudder, -1.0 if model.inputs[rudder].is_reversed else 1.0, slew_rate, dt, approach, unit,
    )  # fmt: skip
    memory = programme.memory(steering)
    used, _, finished = steer_programme(model, programme, memory, FINISHED, dt, start, held, longest)
    used[:, rudder] = rudder_angles(used[:, rudder])
    time = frozen(dt * np.arange(len(used)))
    # Record.dt's own quotient, so that a replay takes the same steps to the last bit
    states, outputs = trajectory(model, used, float(time[-1] - time[0]) / (len(time) - 1), start)
    require_bounded(model, time, states, f"manoeuvre '{programme.text}'")
    made = record_of(model, programme.text, time, states, outputs, used)
    ending = f"finished at {time[-1]:g} s" if finished else f"not finished after {time[-1]:g} s"
    steps = (f"rudder slews at {math.degrees(slew_rate):g} deg/s", ending)
    return replace(made, provenance=Provenance(f"manoeuvre '{programme.text}' of model '{model.name}'", steps=steps))


def _require_steerable(model: Model, dt: float, slew_rate: float) -> None:
    if not model.has_rudder or not model.has_heading:
        raise InputError(f"model '{model.name}' cannot be steered: it needs the input '{RUDDER}' and the state 'psi'")
    if model.parameters.missing:
        raise InputError(f"model '{model.name}' has no value for {', '.join(model.parameters.missing)}")
    if not (dt > 0.0 and slew_rate > 0.0):
        raise InputError(f"step {dt:g} s and slew rate {slew_rate:g} rad/s must be positive")


def steer_programme(
    model: Model, programme: "Programme | ThrustProgramme", memory: Array, finished_at: int, dt: float, start: Array,
    held: Array, longest: float,
) -> tuple[Array, Array, bool]:  # fmt: skip
    """Return inputs at the samples (n, nu), the model's signs, the last state (nx,), and whether it has finished.

    finished_at: where the programme's helmsman writes in its memory when he has.
    """
    if not 1.0 <= longest / dt < MAX_SAMPLES:
        raise InputError(f"a manoeuvre of {longest:g} s is not between 1 and {MAX_SAMPLES:.0e} steps of {dt:g} s")
    count = int(longest / dt) + 1
    subject = f"manoeuvre '{programme.text}'"
    states, inputs = commanded(model, programme.helmsman, memory, dt, count, start, held, subject)
    finished = memory[finished_at] != NOT_FINISHED
    last = min(count, round(memory[finished_at] / dt) + 1) if finished else count
    return np.ascontiguousarray(inputs[:last]), states[last - 1].copy(), bool(finished)


# How fast the rudder of a simulated manoeuvre moves: as fast as the runs show it, at least as SOLAS requires.

RUDDER_RATE = "rudder_rate"
"""Key of the fastest rate of the training runs [rad/s] in what a model file says they cover."""
MOVE_SHARE = 0.5
"""Share of the range of rudder angles that a sustained move covers: noise and small corrections do not; chosen."""
CLEARLY_FASTER = 1.2
"""Times the rate that SOLAS requires from which recorded moves are faster: slopes are read to some 10 %; chosen."""
_SPIKE = 3  # samples of the running median: a single bad reading is no move; the least a median can have


@dataclass(frozen=True)
class RudderRate:
    """Rate of a rudder, rad/s, and where it is from."""

    value: float
    origin: str

    @property
    def text(self) -> str:
        """A phrase for people."""
        return f"rudder rate {math.degrees(self.value):.3g} deg/s, {self.origin}"


def rudder_rate(scale: float, recorded: float | None = None) -> RudderRate:
    """Return the rate that manoeuvres are steered with: that of the records, where clearly faster than SOLAS requires.

    Args:
        scale: of the ship, full scale over that of the trials; a rate grows with its root (Froude's law).
        recorded: fastest sustained move of the training runs [rad/s], as `sustained_rudder_rate` has it.
    """
    required = SOLAS_SLEW_RATE * math.sqrt(scale)
    if recorded is not None and recorded >= CLEARLY_FASTER * required:
        return RudderRate(recorded, "the fastest of the training runs")
    return RudderRate(required, "as SOLAS requires, at the ship's scale" if scale != 1.0 else "as SOLAS requires")


def sustained_rudder_rate(record: Record) -> float | None:
    """Return the fastest rate at which the rudder moves through half its range [rad/s]; None: it hardly moves.

    A run of fewer samples, one whose rudder needs longer than at SOLAS's rate at full scale, and one without rudder
    angles have none. A move between two samples counts as taking one sample interval.
    """
    if "delta" not in record or len(record) <= _SPIKE:
        return None
    angles = np.median(sliding_window_view(record["delta"], _SPIKE), axis=1)
    if not np.isfinite(angles).any():
        return None
    least, most = np.nanpercentile(angles, (100.0 - REACH_PERCENTILE, REACH_PERCENTILE))
    threshold = MOVE_SHARE * float(most - least)
    slowest = math.ceil(threshold / (SOLAS_SLEW_RATE * record.dt))
    for steps in range(1, min(slowest, len(angles) - 1) + 1):
        largest = _largest_move(angles, steps)
        if largest >= threshold:
            return largest / (steps * record.dt)
    return None


def _largest_move(angles: Array, steps: int) -> float:
    moves = np.abs(angles[steps:] - angles[:-steps])
    return float(np.nanmax(moves, initial=0.0))
