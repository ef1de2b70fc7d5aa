"""Manoeuvres that could come next, and the information each would add at the present estimate."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Record
from seatrial.data.trial import Trial
from seatrial.data.trial.design_request import DesignRequest, InputRange
from seatrial.data.trial.runs import require_stream
from seatrial.estimation.design.manoeuvre_information import ManoeuvreEvaluator
from seatrial.estimation.design.search_step import search_step
from seatrial.estimation.design.ships import PriorShips
from seatrial.estimation.design.standard_manoeuvres import standard_manoeuvres
from seatrial.estimation.design.task import DesignTask
from seatrial.estimation.estimate.time_scale import characteristic_time, is_pure_roll
from seatrial.estimation.information.extrapolation import motion_envelope
from seatrial.numerics.optimise import NormalEquations
from seatrial.physics.simulate.linear import batch_class
from seatrial.physics.simulate.replay import ZERO_BY_DEFAULT, state_limits
from seatrial.physics.simulate.states import RUDDER
from seatrial.physics.simulate.steer import RUDDER_RATE, rudder_rate

# where the trial has no [design]: duration and hold in characteristic times of the ship (length over speed, or a
# period); chosen: 20 cover a zigzag or two, 40 the resonances of a linear model
_DURATION, _HOLD, _LINEAR_DURATION = 20.0, 1.0, 40.0
# rad: the rudder angle of turning trials (IMO MSC.137(76)); chosen: a fin angle below stall; rad/s: a usual fin drive
_RUDDER_LIMIT, _FIN_LIMIT, _FIN_RATE = math.radians(35.0), math.radians(10.0), math.radians(20.0)
_FIN_INPUTS = ("delta_f1", "delta_f2", "alpha_f")
# chosen: roll releases as multiples of the largest angle recorded; rad, the largest: a deck edge immerses at about that
_RELEASE_FACTORS, _MAX_RELEASE_ANGLE = (1.5, 2.0, 3.0), math.radians(35.0)


@dataclass(frozen=True, eq=False)
class CandidateManoeuvre:
    """A manoeuvre that could come next.

    Attributes:
        name, description: as `standard_manoeuvres` names it, and in words.
        initial_state: SI, (nx,); inputs: SI, (rows, nu), at steps of dt [s].
        is_random: whether it is a random sequence, which cannot be steered by hand.
    """

    name: str
    description: str
    initial_state: Array
    inputs: Array
    dt: float
    is_random: bool = False


def candidate_manoeuvres(
    trial: Trial, model: Model, records: Sequence[Record], noise: dict[str, float]
) -> list[CandidateManoeuvre]:
    """Return standard manoeuvres for `model`, at the speed and with the constant inputs of the records so far.

    noise: channel -> standard deviation, SI.

    Raises:
        InputError: no input can be moved, or the ship cannot be simulated.
    """
    if is_pure_roll(model) and not model.is_affine:
        return _roll_releases(model, records)
    task = _design_task(trial, model, records, noise)
    ship = PriorShips(model.parameters.values[None], np.zeros(len(model.parameters.free)))
    evaluator = ManoeuvreEvaluator(task, ship, search_step(task, ship))
    candidates = []
    for item in standard_manoeuvres(evaluator):
        inputs = item.inputs_for(evaluator)
        inputs = inputs[0] if inputs.ndim == 3 else inputs
        text = _describe(item.name, task)
        candidates.append(CandidateManoeuvre(item.name, text, task.initial_state, inputs, evaluator.dt, item.is_random))
    return candidates


def fisher_information(model: Model, candidate: CandidateManoeuvre, noise: dict[str, float], rate: float) -> Array:
    """Return the Fisher information of the free coefficients, (k, k); zero where the simulation diverges.

    Initial states count as unknown.

    noise: channel -> standard deviation, SI, white; rate: Hz at which these are recorded.
    """
    names, outputs = model.parameters.free_names, (*noise, *(n for n in model.states if n not in noise))
    offsets = np.array([0, len(candidate.inputs)], dtype=np.int64)
    inputs = np.ascontiguousarray(candidate.inputs)
    batch = batch_class(model)(model, inputs, offsets, candidate.dt, outputs, names)
    batch = replace(batch, initial_states=batch.influential_states())
    y, slopes, failed = batch.differentiate(
        0, 1, candidate.initial_state[None], model.parameters.values[None], np.zeros((1, 0))
    )  # fmt: skip
    k = len(names)
    states = y[:, [outputs.index(n) for n in model.states]]
    if failed[0] >= 0 or not np.all(np.abs(states) <= state_limits(model)) or not np.all(np.isfinite(slopes)):
        return np.zeros((k, k))
    scaled = (slopes[:, : len(noise)] / np.array(list(noise.values()))[:, None]).reshape(-1, slopes.shape[2])
    hessian = (scaled.T @ scaled) * (rate * candidate.dt)
    none = np.zeros(len(hessian) - k)
    return NormalEquations(
        0.0, np.zeros(k), hessian[:k, :k], none[None], hessian[None, k:, k:], hessian[None, :k, k:]
    ).without_local()[1]


def _roll_releases(model: Model, records: Sequence[Record]) -> list[CandidateManoeuvre]:
    """Free decays from larger angles, as long as the longest record."""
    angle = model.states[0]
    rolling = [r for r in records if angle in r]
    if not rolling:
        raise InputError(f"no record holds '{angle}'")
    longest = max(rolling, key=lambda r: r.duration)
    largest = max(float(np.nanmax(np.abs(r[angle]))) for r in rolling)
    rows = round(longest.duration / longest.dt) + 1
    candidates = []
    for factor in _RELEASE_FACTORS:
        if largest * factor <= _MAX_RELEASE_ANGLE:
            start = np.zeros(len(model.states))
            start[0] = largest * factor
            degrees = math.degrees(start[0])
            description = f"a free decay from {degrees:.2g} deg of {longest.duration:.0f} s"
            inputs = np.zeros((rows, len(model.inputs)))
            candidates.append(CandidateManoeuvre(f"release:{degrees:.3g}", description, start, inputs, longest.dt))
    return candidates


def _design_task(trial: Trial, model: Model, records: Sequence[Record], noise: dict[str, float]) -> DesignTask:
    rate = trial.estimate.rate or require_stream(trial).rate
    request = trial.design_request or _default_request(trial, model, records, rate)
    return DesignTask("", trial.ship, model, noise, replace(request, rate=rate, draws=0))


def _default_request(trial: Trial, model: Model, records: Sequence[Record], rate: float) -> DesignRequest:
    """What the actuators can do and what the records hold constant, for a trial without [design].

    Raises:
        InputError: nothing can be moved.
    """
    unit = characteristic_time(model, records, trial.ship.length)
    duration = _rounded((_LINEAR_DURATION if model.is_affine else _DURATION) * unit)
    hold = max(_HOLD * unit, 4.0 / rate)
    ranges = {name: _default_range(trial, model, name, hold, records) for name in model.input_names}
    inputs = {name: one for name, one in ranges.items() if one is not None}
    if not inputs:
        raise InputError(f"model '{model.name}' has no rudder and no fin that could be moved")
    # propellers and jets keep their recorded value; waves and wind are zero
    others = [n for n in model.input_names if n not in inputs and n not in ZERO_BY_DEFAULT]
    held = {n: _median(records, n) for n in others if any(n in r for r in records)}
    speed = _median(records, "u") if "u" in model.states and any("u" in r for r in records) else None
    return DesignRequest(duration=duration, rate=rate, inputs=inputs, held=held, speed=speed, draws=0)


def _default_range(trial: Trial, model: Model, name: str, hold: float, records: Sequence[Record]) -> InputRange | None:
    """Return the limits of a rudder, or of a fin that has lift; None for any other input; hold: s."""
    if name == RUDDER:
        rate = rudder_rate(trial.ship.scale, motion_envelope(records).get(RUDDER_RATE)).value
        return InputRange(lower=-_RUDDER_LIMIT, upper=_RUDDER_LIMIT, unit="rad", rate=rate, hold=hold)
    lift = name.replace("delta_f", "lift_")
    if name in _FIN_INPUTS and lift in model.parameters.names and model.parameters[lift].value:
        return InputRange(lower=-_FIN_LIMIT, upper=_FIN_LIMIT, unit="rad", rate=_FIN_RATE, hold=hold)
    return None


def _median(records: Sequence[Record], name: str) -> float:
    return float(np.median(np.concatenate([r[name] for r in records if name in r])))


def _rounded(seconds: float) -> float:
    """Two significant digits."""
    step = 10.0 ** (math.floor(math.log10(seconds)) - 1)
    return step * round(seconds / step)


def _describe(name: str, task: DesignTask) -> str:
    """A standard manoeuvre in words."""
    kind, *fields = name.split(":")
    moved, length = " and ".join(a.name for a in task.request.actuators), f"of {task.request.duration:g} s"
    if kind == "zigzag":
        return f"a zigzag {fields[0]} {length}"
    if kind == "consecutive-zigzags":
        return f"consecutive zigzags 10/10 to 30/30, {length} in all,"
    if kind == "turning-circle":
        return f"a turning circle with {fields[0]} deg of rudder {length}"
    if kind == "prbs":
        hold, share = float(fields[1].removesuffix(" s")), fields[0]
        return f"a random binary sequence of {moved} (held {hold:.2g} s, {share} of its range) {length}"
    return f"a sweep of {moved} {length}" if kind == "sine sweep" else f"steps of {moved} from end to end {length}"
