"""Whether an actuator did in a log what the gains order: the controller run on what was measured."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter
from scipy.special import stdtrit

from seatrial.control.demand import feed_forward, reference_model, reference_rate
from seatrial.control.task import TuningTask
from seatrial.control.verification.logged_changes import LoggedChange
from seatrial.core.values import Array
from seatrial.physics.loops import TransferLoop, in_series
from seatrial.physics.loops.discrete import difference_equation

# time constants of the demand over which means run: one that is compared, as a logger's noise is not the controller's,
# and one that is taken off, trim and integral; chosen
_FAST, _SLOW = 0.5, 3.0


_CHANCE = 0.005  # of each of two statistics: together one log in a hundred is blamed by chance; chosen


@dataclass(frozen=True)
class FollowedGains:
    """What the actuator did over what the gains order: factor of its motion, and the coherence of both, 0 to 1."""

    ratio: float
    coherence: float

    @property
    def statistics(self) -> Array:
        """Return ratio and logarithm of the share of the motion that does not follow, (2,): nearly normal both."""
        return np.array([self.ratio, math.log(max(1.0 - self.coherence**2, np.finfo(float).tiny))])


@dataclass(frozen=True)
class GainTest:
    """How the actuator followed in a log, and in simulated logs of ships with these very gains: statistics (m, 2).

    stops: between which the actuator stayed, where they explain the log; None elsewhere.
    """

    followed: FollowedGains
    simulated: Array
    stops: tuple[float, float] | None = None

    @property
    def _off(self) -> Array:
        """Return by how much of what chance explains the statistics differ from the simulated ones, (2,).

        A further one of a sample lies as far from its mean as Student's distribution says (Hahn & Meeker 1991,
        Statistical Intervals, section 4.7).
        """
        m = len(self.simulated)
        sure = float(stdtrit(m - 1, 1.0 - 0.5 * _CHANCE)) * math.sqrt(1.0 + 1.0 / m)
        return (self.followed.statistics - self.simulated.mean(axis=0)) / (sure * self.simulated.std(axis=0, ddof=1))

    @property
    def is_alike(self) -> bool:
        """Whether the actuator's motion has the shape that the gains order, but for what chance explains."""
        return bool(self._off[1] <= 1.0)

    @property
    def is_followed(self) -> bool:
        """Whether it has its size, too."""
        return self.is_alike and bool(abs(self._off[0]) <= 1.0)


def followed_gains(
    task: TuningTask,
    loop: TransferLoop,
    changes: Sequence[LoggedChange],
    stops: tuple[float, float] = (-math.inf, math.inf),
) -> FollowedGains:
    """Return how the actuator of a log follows a loop at its own gains, over all its changes.

    The order is that of the logged output and reference, by the loop's blocks at the log's samples, its servo and dead
    time behind it, within the actuator's limits and stops; both are compared smoothed, slow means taken
    off.
    """
    pairs = [_order_and_motion(task, loop, change, stops) for change in changes]
    ordered, moved = (np.concatenate(rows) for rows in zip(*pairs, strict=True))
    both, own, theirs = (float(np.sum(a * b)) for a, b in ((ordered, moved), (ordered, ordered), (moved, moved)))
    if not own * theirs:
        return FollowedGains(0.0, 0.0)
    return FollowedGains(both / own, abs(both) / float(np.sqrt(own * theirs)))


def _order_and_motion(
    task: TuningTask, loop: TransferLoop, change: LoggedChange, stops: tuple[float, float]
) -> tuple[Array, Array]:
    demand, T = task.required_demand, change.dt
    level, fed = change.order, np.zeros(len(change.order))
    if change.is_step:
        motion = reference_model(change.order, T, demand.time_constant, reference_rate(task, loop, demand))
        level, fed = motion.level, motion.fed_forward(feed_forward(loop, demand))
    fast, slow = (max(1, round(share * demand.time_constant / T)) for share in (_FAST, _SLOW))
    error, order = _mean(level - change.output, fast), _mean(fed, fast)
    for gain, term in zip(loop.gain_values, loop.terms, strict=True):
        block = difference_equation(in_series("term", (term.block, *loop.filters)), T)
        order = order + gain * lfilter(block.b, block.a, error)
    served = difference_equation(in_series("servo", loop.servo), T)
    order = lfilter(served.b, served.a, order)
    late = 0 if loop.sampling is None else round(loop.sampling.dead_time / T)
    order = np.concatenate([np.zeros(late), order[: len(order) - late]])
    achieved = _within(np.clip(order, *stops), task.constraints.limit, task.constraints.rate * T)
    moved = _mean(change.actuator, fast)
    return achieved - _mean(achieved, slow), moved - _mean(moved, slow)


def _within(order: Array, limit: float, step: float) -> Array:
    """Return an order as an actuator follows it from rest within its limits."""
    made, now = np.empty(len(order)), float(order[0])
    for k, wanted in enumerate(np.clip(order, -limit, limit).tolist()):
        now += min(max(wanted - now, -step), step)
        made[k] = now
    return made


def _mean(values: Array, width: int) -> Array:
    padded = np.pad(values, (width // 2, width - 1 - width // 2), mode="edge")
    return np.convolve(padded, np.full(width, 1.0 / width), mode="valid")
