"""Which manoeuvre would identify what the data so far do not: the Cramer-Rao bound after it, at the estimate."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from time import monotonic
from typing import Protocol, runtime_checkable

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results.online import EstimatorPhase, Snapshot
from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, InputError, Record
from seatrial.data.trial import Trial
from seatrial.data.trial.runs import require_stream
from seatrial.estimation.estimate.fit import is_pure_roll
from seatrial.estimation.information.covariance import inverse
from seatrial.onboard.candidate_manoeuvres import CandidateManoeuvre, candidate_manoeuvres, fisher_information
from seatrial.physics.simulate.replay import ZERO_BY_DEFAULT
from seatrial.physics.simulate.states import RUDDER

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
    if is_pure_roll(model) and not model.is_affine:
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
