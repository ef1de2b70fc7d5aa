"""Which manoeuvre would identify what the data so far do not: candidates, and the Cramer-Rao bound after each."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from time import monotonic
from typing import Protocol, runtime_checkable

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.equations.model import RUDDER, ZERO_BY_DEFAULT
from seatrial.core.results.online import EstimatorPhase, Snapshot
from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, InputError, Record
from seatrial.data.trial import Trial
from seatrial.data.trial.design_request import DesignRequest, InputRange
from seatrial.data.trial.runs import require_stream
from seatrial.estimation.design.manoeuvre_information import ManoeuvreEvaluator
from seatrial.estimation.design.search import search_step, standard_manoeuvres
from seatrial.estimation.design.task import DesignTask, PriorShips
from seatrial.estimation.estimate.settings import characteristic_time
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.information.extrapolation import motion_envelope
from seatrial.numerics.optimise import NormalEquations
from seatrial.physics.simulate.batch import batch_class
from seatrial.physics.simulate.replay import state_limits
from seatrial.physics.simulate.steer import RUDDER_RATE, rudder_rate

# Manoeuvres that could come next, and the information each would add at the present estimate.

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
    if not model.has_course and not model.is_affine:
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
    speed = _median(records, "u") if model.has_speed and any("u" in r for r in records) else None
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


# Which manoeuvre would identify what the data so far do not: the Cramer-Rao bound after it, at the estimate.

# a coefficient is identified once its standard error is below this multiple of its value; chosen: its sign is known
_IDENTIFIED_BELOW = 1.0
# a random sequence, which cannot be steered by hand, must leave errors smaller by this factor to be proposed; chosen
_RANDOM_PENALTY = 2.0
# an unstable ship's course identifies everything in theory: manoeuvres of smaller relative errors are not proposed;
# chosen: far below what any trial has reached
_LEAST_CREDIBLE_ERROR = 1e-5
# s between two evaluations; chosen: each costs some seconds of simulation
_ADVICE_INTERVAL_S = 60.0
# names in a sentence before "and 2 more"; chosen
_MAX_NAMED = 3
_MAX_ITEMS = _MAX_NAMED + 1


@runtime_checkable
class EstimatorWithCovariance(Protocol):
    """An estimator that gives more than its snapshot."""

    @property
    def covariance(self) -> Array:
        """Covariance of the free coefficients, (k, k); infinite diagonal where nothing is known."""
        ...

    def records(self) -> tuple[Record, ...]:
        """Return the records it keeps, in canonical frames and signs."""
        ...


@dataclass(frozen=True, eq=False)
class PredictedAccuracy:
    """A manoeuvre and the relative standard errors after it, (k,)."""

    candidate: CandidateManoeuvre
    relative_errors: Array


class ManoeuvreAdviser:
    """Adds advice to snapshots of an estimator, evaluated anew at most once a minute."""

    def __init__(self, trial: Trial, estimator: object, clock: Callable[[], float] = monotonic) -> None:
        self._trial, self._clock = trial, clock
        self._estimator = estimator if isinstance(estimator, EstimatorWithCovariance) else None
        self._latest_advice, self._advised_at, self._advised_names = "", -np.inf, ()

    def with_advice(self, snapshot: Snapshot) -> Snapshot:
        """Return the snapshot with what would help; unchanged where all is identified or nothing is known yet."""
        if self._estimator is None or not snapshot.unidentified or snapshot.phase is EstimatorPhase.WAITING:
            return snapshot
        if self._clock() - self._advised_at >= _ADVICE_INTERVAL_S:
            self._latest_advice = advice(snapshot, self._trial, self._estimator.covariance, self._records())
            self._advised_at, self._advised_names = self._clock(), snapshot.unidentified
        return replace(snapshot, advice=self._latest_advice)

    def _records(self) -> tuple[Record, ...]:
        """Return the records that the estimator still keeps; none where they are too short to be read."""
        try:
            return () if self._estimator is None else self._estimator.records()
        except InputError:
            return ()

    def with_final_advice(self, snapshot: Snapshot) -> Snapshot:
        """As `with_advice`, for the last snapshot: evaluated anew if other coefficients are unidentified now."""
        if snapshot.unidentified != self._advised_names:
            self._advised_at = -np.inf
        return self.with_advice(snapshot)


def advice(snapshot: Snapshot, trial: Trial, covariance: Array, records: Sequence[Record]) -> str:
    """Return one or two sentences: the standard manoeuvre that identifies most, and what none identifies.

    covariance: of the free coefficients, (k, k). The sensors' noise is taken to be white, with the rms of the
    residuals, so that the errors stated are lower bounds.
    """
    model = trial.model.with_parameters(trial.model.parameters.with_free_values(snapshot.value))
    try:
        candidates = ranked_candidates(snapshot, trial, model, covariance, records)
    except InputError as error:
        return _qualitative_advice(snapshot, model, records, str(error))
    return _advice_text(snapshot, model, candidates, records)


def ranked_candidates(
    snapshot: Snapshot, trial: Trial, model: Model, covariance: Array, records: Sequence[Record]
) -> list[PredictedAccuracy]:
    """Return standard manoeuvres, the best first: fewest unidentified after it, then the smallest errors of these.

    Raises:
        InputError: no input can be moved, or the ship cannot be simulated at the estimate.
    """
    noise = {n: v for n, v in snapshot.noise.items() if np.isfinite(v) and v > 0.0}
    if not noise:
        raise InputError("residuals are not known")
    rate, size = trial.estimate.rate or require_stream(trial).rate, _error_scales(snapshot, model)
    information = _precision(covariance)
    accuracies = []
    for candidate in candidate_manoeuvres(trial, model, records, noise):
        errors = np.sqrt(np.diag(inverse(information + fisher_information(model, candidate, noise, rate)))) / size
        if np.min(errors) > _LEAST_CREDIBLE_ERROR:
            accuracies.append(PredictedAccuracy(candidate, errors))
    if not accuracies:
        raise InputError("no manoeuvre can be simulated")
    unidentified = _unidentified_indices(snapshot)

    def rank(one: PredictedAccuracy) -> tuple[int, float]:
        unusual = math.log(_RANDOM_PENALTY) if one.candidate.is_random else 0.0
        return int(np.sum(one.relative_errors[unidentified] > _IDENTIFIED_BELOW)), float(
            np.mean(np.log(one.relative_errors[unidentified]))
        ) + unusual

    return sorted(accuracies, key=rank)


def _unidentified_indices(snapshot: Snapshot) -> list[int]:
    return [snapshot.names.index(n) for n in snapshot.unidentified]


def _error_scales(snapshot: Snapshot, model: Model) -> Array:
    """Return the size to which an error is compared: the value, or the parameter's scale where that is larger, (k,)."""
    scale = np.array([model.parameters[n].scale for n in snapshot.names])
    return np.maximum(np.maximum(np.abs(snapshot.value), scale), 1e-300)  # above zero, for a division


def _precision(covariance: Array) -> Array:
    """Information from a covariance; zero for coefficients of which nothing is known."""
    known = np.isfinite(np.diag(covariance)) & (np.diag(covariance) > 0.0)
    information = np.zeros_like(covariance)
    if np.any(known):
        information[np.ix_(known, known)] = inverse(covariance[np.ix_(known, known)])
    return information


def _advice_text(
    snapshot: Snapshot, model: Model, candidates: list[PredictedAccuracy], records: Sequence[Record]
) -> str:
    indices, size = _unidentified_indices(snapshot), _error_scales(snapshot, model)
    before = snapshot.standard_error / size
    best = candidates[0]
    identified = [i for i in indices if best.relative_errors[i] <= _IDENTIFIED_BELOW]
    never = [snapshot.names[i] for i in indices if min(p.relative_errors[i] for p in candidates) > _IDENTIFIED_BELOW]
    if not identified:
        return _qualitative_advice(snapshot, model, records, "no standard manoeuvre identifies them")
    improved = sorted(identified, key=lambda i: best.relative_errors[i] / before[i])[:_MAX_NAMED]
    parts = [f"{snapshot.names[i]} from {_percent(before[i])} to {_percent(best.relative_errors[i])}" for i in improved]
    more = len(identified) - len(improved)
    text = f"{best.candidate.description} would reduce the standard error of {enumeration(parts, _MAX_ITEMS)}"
    text += f" and identify {more} more" if more else ""
    later = [snapshot.names[i] for i in indices if i not in identified and snapshot.names[i] not in never]
    if later:
        verb = "needs" if len(later) == 1 else "need"
        text += f"; {enumeration(later, _MAX_ITEMS)} {verb} another manoeuvre"
    return text + (f"; none of them identifies {enumeration(never, _MAX_ITEMS)}" if never else "")


def _qualitative_advice(snapshot: Snapshot, model: Model, records: Sequence[Record], reason: str) -> str:
    """What to do where no manoeuvre can be evaluated: move what never moved, excite more, or fix coefficients."""
    still = [n for n in model.input_names if not any(n in r and np.ptp(r[n]) > 0.0 for r in records)]
    named = enumeration(list(snapshot.unidentified), _MAX_ITEMS)
    if not model.has_course and not model.is_affine:
        return f"{named}: release the ship from a larger angle, or record roll in beam waves ({reason})"
    if RUDDER in still:
        return f"{named}: the rudder has not moved so far; steer a zigzag 20/20 and a turning circle ({reason})"
    moving = [n for n in still if n not in ZERO_BY_DEFAULT]
    if moving:
        which = "it" if len(moving) == 1 else "them"
        return f"{named}: {enumeration(moving, _MAX_ITEMS)} never moved so far; move {which} ({reason})"
    if model.is_affine:
        return f"{named}: record in higher waves or at another heading, or move the fins ({reason})"
    return f"{named}: steer larger angles for longer, or fix these coefficients or give priors ({reason})"


def _percent(share: float) -> str:
    if share >= 10.0:
        return "more than 1000 %"
    return f"{100.0 * share:.0f} %" if share >= 0.1 else f"{100.0 * share:.2g} %"  # two digits from 10 % down
