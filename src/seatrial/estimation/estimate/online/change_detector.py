"""Whether and when a ship has changed: a bank of instants, and what the data since say of a change at each."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.results.online import CoefficientChange
from seatrial.core.values import Array
from seatrial.estimation.estimate.online.recursive import JumpSearch, RecursiveFilter
from seatrial.numerics.kernels.recursive import CLOSE_SAMPLES, jump_evidence

# What the data after an instant say against those before it.

SIZE = 0.25
"""Standard deviation of a change before any data, relative to the coefficient; chosen: loads and fouling are of it."""
THRESHOLD = 10.9
"""Nats of evidence at which a change is reported; chosen: five alarms in 300 h of ten samples a second with 45 instants
each is what a ship that stays as it is may raise (`python benchmarks/changed_ships.py --hours 300` counts them)."""


@dataclass(frozen=True, eq=False)
class GaussianEstimate:
    """An estimate of k coefficients and its covariance."""

    value: Array
    covariance: Array


@dataclass(frozen=True, eq=False)
class _Moves:
    """What data since some instants say of relative changes of the coefficients there.

    With P and p covariances then and now, changes D have the information J = P^-1 (P - p) P^-1, and J D is
    P^-1 (theta_now - theta_then): the error of the earlier estimate is in it.

    Attributes:
        information: J, (m, k, k); score: J D, (m, k).
    """

    information: Array
    score: Array

    @classmethod
    def since(cls, before: Sequence[GaussianEstimate], now: GaussianEstimate) -> "_Moves":
        """Return what is new since each of these estimates."""
        scale = np.where(np.abs(now.value) > 0.0, now.value, 1.0)
        units = np.outer(scale, scale)
        known = np.linalg.inv(np.array([one.covariance for one in before]) / units)
        moved = (now.value - np.array([one.value for one in before])) / scale
        return cls(known - known @ (now.covariance / units) @ known, np.einsum("mij,mj->mi", known, moved))

    @property
    def precision(self) -> Array:
        """Of relative changes, their prior included, (m, k, k)."""
        return self.information + np.eye(self.score.shape[1]) / SIZE**2

    @property
    def sizes(self) -> Array:
        """The likeliest relative changes under their prior, (m, k)."""
        return np.asarray(np.linalg.solve(self.precision, self.score[..., None])[..., 0], dtype=np.float64)

    @property
    def evidence(self) -> Array:
        """Evidence for a change at each instant, nats, (m,), see `jump_evidence`."""
        information = np.ascontiguousarray(np.moveaxis(self.information, 0, 2))
        score, evidence = np.ascontiguousarray(self.score.T), np.empty(len(self.score))
        jump_evidence(information, score, SIZE**2, np.empty_like(information), np.empty_like(score), evidence)
        return evidence


# Instants at which the ship may have changed: those of a filter's samples, and those of searches.


@dataclass(frozen=True, eq=False)
class _Instant:
    """A time [s], and value and standard error of the coefficients there, (k,)."""

    time: float
    value: Array
    error: Array


# the bank of a filter: instants close to the present sample by sample, older ones ever farther apart
_OLDEST = 400.0  # s, age of the oldest instant at least; chosen: what takes longer to show is no jump
_KNOWN = 0.15  # relative standard error of every coefficient from which on an instant is kept; chosen


def jump_search(rate: float) -> JumpSearch:
    """Return what the filter of a `FilterWatch` looks for at so many samples a second."""
    doublings = max(int(np.ceil(np.log2(_OLDEST * rate / CLOSE_SAMPLES))), 0)
    return JumpSearch(CLOSE_SAMPLES + doublings * CLOSE_SAMPLES // 2, SIZE, THRESHOLD, _KNOWN)


class FilterWatch:
    """Samples taken in by a filter that looks for jumps of the coefficients, until it finds one.

    Args:
        recursive: the filter, which looks for what `jump_search` says.
    """

    def __init__(self, recursive: RecursiveFilter) -> None:
        self._filter = recursive
        self._times = np.empty(len(recursive.jumps.opened))  # s, of the instants

    def update(self, times: Array, measured: Array, inputs: Array) -> int:
        """Take in the next n samples up to one that shows a jump, and return how many; times (n,), s.

        Others as of `RecursiveFilter.update`.
        """
        if self._filter.is_halted:
            return len(times)
        jumps = self._filter.jumps
        before = jumps.looks
        self._filter.update(measured, inputs)
        new = np.flatnonzero(jumps.opened >= before)
        self._times[new] = times[jumps.opened[new] - before]
        return jumps.looks - before + self._filter.is_halted if jumps.is_searched else len(times)

    @property
    def is_ended(self) -> bool:
        """Whether no more samples are taken in: there is a change, or the filter is no longer sound."""
        return self._filter.is_halted

    @property
    def has_changed(self) -> bool:
        """Whether the evidence for a change at any instant is enough."""
        return self._filter.jumps.has_changed

    def kept(self) -> tuple[list[_Instant], _Moves]:
        """Return the instants that are kept, in their order, and what the data say of a change at each."""
        jumps, k = self._filter.jumps, len(self._filter.names)
        places = np.argsort(jumps.opened)[np.count_nonzero(jumps.opened < 0) :]
        estimates = jumps.estimates[:, places]
        instants = [_Instant(float(t), v[:k], v[k:]) for t, v in zip(self._times[places], estimates.T, strict=True)]
        lower = np.moveaxis(jumps.information[:, :, places], 2, 0)
        whole = np.tril(lower) + np.swapaxes(np.tril(lower, -1), 1, 2)
        return instants, _Moves(whole, jumps.score[:, places].T)


# What is reported of both, and until when.

_APART = 0.8  # of an earlier search's variances, to which another's have to fall to be compared with it; chosen
_SOON, _MOST_IN_A_ROW = 60.0, 3  # s from a report to a change that counts as one with it, and how many a ship makes;
# chosen: a ramp of a minute is found in three
_SPAN = 3.0  # nats below the likeliest instant down to which another is inside its interval: half of chi squared, 99 %


@dataclass(eq=False)
class ChangeDetector:
    """Look for changes of the coefficients in a filter that takes in every sample, or else between searches.

    Attributes:
        names: of the coefficients.
        detected: the last change; None: there was none.
    """

    names: tuple[str, ...]
    detected: CoefficientChange | None = None
    _searches: tuple[tuple[_Instant, GaussianEstimate], ...] = ()
    _in_a_row: int = 0

    @property
    def is_ended(self) -> bool:
        """Whether changes followed one another so closely that none is looked for any longer."""
        return self._in_a_row > _MOST_IN_A_ROW

    def update(self, time: float, watch: FilterWatch) -> bool:
        """Take in what a filter made of the samples up to `time` [s], and return whether there is a change.

        The estimate is then to begin anew, and so is the watch.
        """
        if self.is_ended or not watch.has_changed:
            return False
        self._report(time, *watch.kept())
        return True

    def update_search(self, time: float, now: GaussianEstimate, *, is_kept: bool = True) -> bool:
        """Take in a search of all data up to `time` [s], and return whether there is a change since an earlier one.

        is_kept: whether later ones are compared with this one, if it knows the coefficients.
        """
        if self.is_ended or not np.all(np.isfinite(now.covariance)):
            return False
        variance = np.diagonal(now.covariance)
        compared = [s for s in self._searches if np.all(variance <= _APART * np.diagonal(s[1].covariance))]
        if compared:
            moves = _Moves.since([estimate for _, estimate in compared], now)
            if np.max(moves.evidence) > THRESHOLD:
                self._report(time, [instant for instant, _ in compared], moves)
                return True
        if is_kept and np.all(np.sqrt(variance) <= _KNOWN * np.abs(now.value)):
            self._searches = (*self._searches, (_Instant(time, now.value, np.sqrt(variance)), now))
        return False

    def doubt(self, since: float) -> None:
        """Forget all searches; a change closely before `since` [s], from where residuals are coloured, is withdrawn."""
        change = self.detected
        if change is not None and change.is_believed and since - change.reported_at < _SOON:
            self.detected = replace(change, is_believed=False)
        self.restart()

    def restart(self) -> None:
        """Forget all searches: the estimate begins anew, or counts data anew."""
        self._searches = ()

    def _report(self, time: float, instants: Sequence[_Instant], moves: _Moves) -> None:
        """Report the change at the likeliest instant; of a ship which changes all the time none is believed."""
        nats = moves.evidence
        best = int(np.argmax(nats))
        likely = np.flatnonzero(nats >= nats[best] - _SPAN)
        times = [*(one.time for one in instants), time]  # a change may be anywhere until the next instant
        errors = np.sqrt(np.abs(np.diagonal(np.linalg.inv(moves.precision[best]))))
        instant, clearest = instants[best], int(np.argmax(np.abs(moves.sizes[best]) / errors))
        before, error_before = (
            dict(zip(self.names, values.tolist(), strict=True)) for values in (instant.value, instant.error)
        )
        between = times[likely[0]], times[likely[-1] + 1]
        change = CoefficientChange(
            instant.time, between, time, float(nats[best]), self.names[clearest], before, error_before
        )
        self._in_a_row = self._in_a_row + 1 if self._follows_closely(change) else 1
        self.detected = self._joined(change) if self._in_a_row > 1 else change
        self.restart()

    def _follows_closely(self, change: CoefficientChange) -> bool:
        return self.detected is not None and change.since - self.detected.reported_at < _SOON

    def _joined(self, change: CoefficientChange) -> CoefficientChange:
        """One finding with the change that it follows closely: as a whole it is believed or it is not."""
        first = self.detected
        assert first is not None
        clearest = max(first, change, key=lambda one: one.evidence)
        return replace(
            first,
            reported_at=change.reported_at,
            evidence=first.evidence + change.evidence,
            most_changed=clearest.most_changed,
            is_believed=first.is_believed and not self.is_ended,
        )
