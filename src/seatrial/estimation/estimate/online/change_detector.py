"""Whether and when a ship has changed: a bank of instants, each with what was known of the coefficients there."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import logsumexp

from seatrial.core.results.online import CoefficientChange
from seatrial.core.values import Array

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
        """Evidence for a change at each instant, nats, (m,); nothing where rounding leaves none.

        The size has a Gaussian prior, of all coefficients together or of one alone, equally likely (mixture over the
        size: Willsky & Jones 1976).
        """
        of_all = 0.5 * np.einsum("mi,mi->m", self.score, self.sizes)
        of_all -= 0.5 * np.linalg.slogdet(SIZE**2 * self.precision)[1]
        alone = 1.0 + SIZE**2 * np.maximum(np.einsum("mii->mi", self.information), 0.0)
        of_each = 0.5 * SIZE**2 * self.score**2 / alone - 0.5 * np.log(alone)
        mean_of_each = logsumexp(of_each, axis=1) - np.log(self.score.shape[1])
        return np.nan_to_num(np.logaddexp(of_all, mean_of_each) - np.log(2.0), nan=-np.inf)


# The bank: instants close to the present one by one, older ones ever farther apart.

_CLOSE = 8  # looks up to whose age every instant is kept; of twice the age every second, and so on; chosen
_OLDEST = 400.0  # s, age of the oldest instant; chosen: what takes longer to show is no jump
_KNOWN = 0.15  # relative standard error of every coefficient from which on an instant is kept; chosen
_APART = (
    0.8  # of an instant's variances, to which a search's have to fall to be compared with it: a search and a filter
)
# agree to a seventh of a standard error, chosen
_SOON, _MOST_IN_A_ROW = 60.0, 3  # s between changes that count as in a row, and how many a ship makes; chosen: a ramp
# of a minute is found in three
_SPAN = 3.0  # nats below the likeliest instant down to which another is inside its interval: half of chi squared, 99 %


@dataclass(frozen=True, eq=False)
class _Instant:
    """A look: its number, its time [s], the estimate there, and whether a search gave it."""

    number: int
    time: float
    estimate: GaussianEstimate
    is_searched: bool

    def can_be_compared(self, now: GaussianEstimate, *, is_searched: bool) -> bool:
        """Whether one filter made both estimates, or what came since is more than that by which others differ."""
        variances = (np.diagonal(one.covariance) for one in (now, self.estimate))
        return not (self.is_searched or is_searched) or bool(np.all(np.divide(*variances) <= _APART))


@dataclass(eq=False)
class ChangeDetector:
    """Compare an estimate that grows with what it was at a bank of earlier instants.

    Attributes:
        names: of the coefficients.
        detected: the last change; None: there was none.
    """

    names: tuple[str, ...]
    detected: CoefficientChange | None = None
    _bank: tuple[_Instant, ...] = ()
    _looks: int = 0
    _in_a_row: int = 0

    @property
    def is_ended(self) -> bool:
        """Whether changes followed one another so closely that none is looked for any longer."""
        return self._in_a_row > _MOST_IN_A_ROW

    def update(self, time: float, now: GaussianEstimate, *, is_white: bool = True, is_searched: bool = False) -> bool:
        """Take in the estimate from all data up to `time` [s], and return whether there is a change.

        It empties the bank: the estimate is to begin anew.

        Args:
            is_white: whether its residuals are: later estimates are compared with those of a model that fits alone.
            is_searched: by a search, not by the filter that goes on.
        """
        if self.is_ended or not np.all(np.isfinite(now.covariance)):
            return False
        self._bank = tuple(one for one in self._bank if self._is_kept(one, time))
        compared = [one for one in self._bank if one.can_be_compared(now, is_searched=is_searched)]
        moves = _Moves.since([one.estimate for one in compared], now) if compared else None
        if moves is not None and np.max(moves.evidence) > THRESHOLD:
            change = self._change(time, compared, moves)
            is_soon = self.detected is not None and change.since - self.detected.since < _SOON
            self._in_a_row = self._in_a_row + 1 if is_soon else 1
            self.detected = replace(change, is_believed=not self.is_ended)
            self.restart()
            return True
        if is_white and np.all(np.sqrt(np.diagonal(now.covariance)) <= _KNOWN * np.abs(now.value)):
            self._bank = (*self._bank, _Instant(self._looks, time, now, is_searched))
        self._looks += 1
        return False

    def doubt(self, since: float) -> None:
        """Forget all instants; a change closely before `since` [s], from where residuals are coloured, is withdrawn."""
        change = self.detected
        if change is not None and change.is_believed and since - change.reported_at < _SOON:
            self.detected = replace(change, is_believed=False)
        self.restart()

    def restart(self) -> None:
        """Forget all instants: the estimate begins anew, or counts data anew."""
        self._bank = ()

    def _is_kept(self, one: _Instant, time: float) -> bool:
        every = 1 << ((self._looks - one.number) // _CLOSE).bit_length()
        return one.is_searched or (time - one.time <= _OLDEST and one.number % every == 0)

    def _change(self, time: float, compared: Sequence[_Instant], moves: _Moves) -> CoefficientChange:
        """The change at the likeliest instant."""
        nats = moves.evidence
        best = int(np.argmax(nats))
        near = [one.time for one, each in zip(compared, nats, strict=True) if each >= nats[best] - _SPAN]
        errors = np.sqrt(np.abs(np.diagonal(np.linalg.inv(moves.precision[best]))))
        instant, clearest = compared[best], int(np.argmax(np.abs(moves.sizes[best]) / errors))
        earlier = (instant.estimate.value, np.sqrt(np.diagonal(instant.estimate.covariance)))
        before, error_before = (dict(zip(self.names, values.tolist(), strict=True)) for values in earlier)
        return CoefficientChange(
            instant.time, (min(near), max(near)), time, float(nats[best]), self.names[clearest], before, error_before
        )
