"""Which manoeuvre would tell what the data so far do not: the Cramer-Rao bound after it, for the ship as estimated."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from time import monotonic
from typing import Protocol, runtime_checkable

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results.online import Phase, Snapshot
from seatrial.core.values import Array, InputError, Record
from seatrial.data.trial import Trial
from seatrial.data.trial.follow_table import followed
from seatrial.estimation.estimate.fit import swings
from seatrial.estimation.information.covariance import inverse
from seatrial.onboard.offered import Offer, information, offers
from seatrial.physics.simulate.channels import AT_REST
from seatrial.physics.simulate.steer import RUDDER

# a coefficient is told once its standard error is below this share of it
_TOLD = 1.0
# a random sequence, which nobody steers by hand, must leave errors smaller by this factor
_UNUSUAL = 2.0
# an unstable ship's course tells everything of her, on paper: relative errors below this are no promise
_BELIEVABLE = 1e-5
# s between two looks
_PAUSE = 60.0
_MOST_NAMED = 3


@runtime_checkable
class Knowing(Protocol):
    """What an estimator knows besides its snapshot."""

    @property
    def covariance(self) -> Array:
        """Of the free coefficients, (k, k); infinite diagonal where nothing is known."""
        ...

    def records(self) -> tuple[Record, ...]:
        """What is kept of what it saw, in the house's frames and signs."""
        ...


@dataclass(frozen=True, eq=False)
class Prospect:
    """A manoeuvre and the relative standard errors after it, (k,)."""

    offer: Offer
    after: Array


class Adviser:
    """Adds advice to snapshots of an estimator, looking anew once a minute at most."""

    def __init__(self, trial: Trial, estimator: object, clock: Callable[[], float] = monotonic) -> None:
        self._trial, self._clock = trial, clock
        self._estimator = estimator if isinstance(estimator, Knowing) else None
        self._latest, self._when, self._about = "", -np.inf, ()

    def advised(self, snapshot: Snapshot) -> Snapshot:
        """The snapshot with what would help; unchanged where nothing is untold or nothing is known yet."""
        if self._estimator is None or not snapshot.untold or snapshot.phase is Phase.WAITING:
            return snapshot
        if self._clock() - self._when >= _PAUSE:
            self._latest = advice(snapshot, self._trial, self._estimator.covariance, self._seen())
            self._when, self._about = self._clock(), snapshot.untold
        return replace(snapshot, advice=self._latest)

    def _seen(self) -> tuple[Record, ...]:
        """What the estimator still keeps; nothing where that is too short to be read."""
        try:
            return () if self._estimator is None else self._estimator.records()
        except InputError:
            return ()

    def concluded(self, snapshot: Snapshot) -> Snapshot:
        """As `advised`, for the last snapshot: looks anew if other coefficients are untold now."""
        if snapshot.untold != self._about:
            self._when = -np.inf
        return self.advised(snapshot)


def advice(snapshot: Snapshot, trial: Trial, covariance: Array, records: Sequence[Record]) -> str:
    """One or two sentences: the standard manoeuvre that tells most of what is untold, and what stays untold by all.

    covariance: of the free coefficients by now, (k, k); records: by now. Sensors are taken to be as noisy as the
    residuals, white, so that the numbers are the best that can be hoped for.
    """
    model = trial.model.with_parameters(trial.model.parameters.with_free_values(snapshot.value))
    try:
        found = prospects(snapshot, trial, model, covariance, records)
    except InputError as error:
        return _by_words(snapshot, model, records, str(error))
    return _said(snapshot, model, found, records)


def prospects(
    snapshot: Snapshot, trial: Trial, model: Model, covariance: Array, records: Sequence[Record]
) -> list[Prospect]:
    """Standard manoeuvres, the most helpful first: fewest untold after it, then the smallest errors of these.

    Raises:
        InputError: nothing can be moved, or the ship cannot be simulated at the estimate.
    """
    noise = {n: v for n, v in snapshot.noise.items() if np.isfinite(v) and v > 0.0}
    if not noise:
        raise InputError("residuals are not known")
    rate, size = trial.estimate.rate or followed(trial).rate, _sizes(snapshot, model)
    known = _precision(covariance)
    found = []
    for offer in offers(trial, model, records, noise):
        left = np.sqrt(np.diag(inverse(known + information(model, offer, noise, rate))))
        if np.min(left / size) > _BELIEVABLE:
            found.append(Prospect(offer, left / size))
    if not found:
        raise InputError("no manoeuvre can be simulated")
    at = _places(snapshot)

    def rank(one: Prospect) -> tuple[int, float]:
        unusual = math.log(_UNUSUAL) if one.offer.is_random else 0.0
        return int(np.sum(one.after[at] > _TOLD)), float(np.mean(np.log(one.after[at]))) + unusual

    return sorted(found, key=rank)


def _places(snapshot: Snapshot) -> list[int]:
    return [snapshot.names.index(n) for n in snapshot.untold]


def _sizes(snapshot: Snapshot, model: Model) -> Array:
    """What an error is held against: the value, or the smallest size that counts, (k,)."""
    scale = np.array([model.parameters[n].scale for n in snapshot.names])
    return np.maximum(np.maximum(np.abs(snapshot.value), scale), 1e-300)


def _precision(covariance: Array) -> Array:
    """Information from a covariance; none of coefficients that nothing is known of."""
    known = np.isfinite(np.diag(covariance)) & (np.diag(covariance) > 0.0)
    made = np.zeros_like(covariance)
    if np.any(known):
        made[np.ix_(known, known)] = inverse(covariance[np.ix_(known, known)])
    return made


def _said(snapshot: Snapshot, model: Model, found: list[Prospect], records: Sequence[Record]) -> str:
    at, size = _places(snapshot), _sizes(snapshot, model)
    before = snapshot.standard_error / size
    best = found[0]
    told = [i for i in at if best.after[i] <= _TOLD]
    never = [snapshot.names[i] for i in at if min(p.after[i] for p in found) > _TOLD]
    if not told:
        return _by_words(snapshot, model, records, "no standard manoeuvre tells them")
    shown = sorted(told, key=lambda i: best.after[i] / before[i])[:_MOST_NAMED]
    parts = [f"{snapshot.names[i]} from {_percent(before[i])} to {_percent(best.after[i])}" for i in shown]
    more = len(told) - len(shown)
    said = f"{best.offer.words} would bring {_listed(parts)}" + (f" and tell {more} more" if more else "")
    others = [snapshot.names[i] for i in at if i not in told and snapshot.names[i] not in never]
    if others:
        said += f"; {_listed(others)} then {_stay(others)} for another manoeuvre"
    return said + (f"; {_listed(never)} {_stay(never)} untold by any of them" if never else "")


def _by_words(snapshot: Snapshot, model: Model, records: Sequence[Record], why: str) -> str:
    """What to do where no manoeuvre can be weighed: move what never moved, else harder, else look at the model."""
    still = [n for n in model.input_names if not any(n in r and np.ptp(r[n]) > 0.0 for r in records)]
    named = _listed(list(snapshot.untold))
    if swings(model) and not model.is_affine:
        return f"{named}: release her from a larger angle, or roll her in waves from abeam ({why})"
    if RUDDER in still:
        return f"{named}: the rudder has not moved so far; steer a zigzag 20/20 and a turning circle ({why})"
    moving = [n for n in still if n not in AT_REST]
    if moving:
        return f"{named}: {_listed(moving)} never moved so far; let {'it' if len(moving) == 1 else 'them'} ({why})"
    if model.is_affine:
        return f"{named}: sail in higher waves or at another heading, or move the fins ({why})"
    return f"{named}: steer harder, with larger angles and longer; else fix them or give priors ({why})"


def _percent(share: float) -> str:
    if share >= 10.0:
        return "beyond 1000 %"
    return f"{100.0 * share:.0f} %" if share >= 0.1 else f"{100.0 * share:.2g} %"


def _stay(names: Sequence[str]) -> str:
    return "stays" if len(names) == 1 else "stay"


def _listed(items: Sequence[str]) -> str:
    if len(items) > _MOST_NAMED + 1:
        return f"{', '.join(items[:_MOST_NAMED])} and {len(items) - _MOST_NAMED} more"
    return " and ".join([", ".join(items[:-1]), items[-1]]) if len(items) > 1 else "".join(items)
