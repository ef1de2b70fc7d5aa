"""A recommendation as a value, and which gains of a front are the best or lie on a bound."""

from dataclasses import dataclass

import numpy as np

from seatrial.control.gain_evaluation import GainEvaluator
from seatrial.core.results.tuning import ParetoFront
from seatrial.core.values import Array
from seatrial.numerics.optimise import non_dominated
from seatrial.physics.loops import TransferLoop

ON_BOUND = 1e-3  # share of a gain's range that counts as on the bound; chosen


@dataclass(frozen=True, eq=False)
class NamedGains:
    """Gains (g,) of a loop that stand beside the chosen ones, by name."""

    name: str
    evaluator: GainEvaluator
    gains: Array


@dataclass(frozen=True)
class GainOnBound:
    """A gain that ends on the `end` ("lower", "upper") of what the search may take."""

    name: str
    end: str
    bound: float


@dataclass(frozen=True, eq=False)
class GainChoice:
    """The evaluator of the chosen loop, its gains (g,), the name of the front they come from, why, and what else."""

    evaluator: GainEvaluator
    gains: Array
    front_name: str
    reasons: tuple[str, ...]
    designs: tuple[NamedGains, ...] = ()


def gains_on_bound(loop: TransferLoop, gains: Array) -> tuple[GainOnBound, ...]:
    """Return the free gains (g,) that lie on a bound of the search which is not zero."""
    found = []
    for gain in loop.gains.free:
        value = float(gains[loop.gains.names.index(gain.name)])
        for end, bound in (("lower", gain.lower), ("upper", gain.upper)):
            if bound and abs(value - bound) <= ON_BOUND * (gain.upper - gain.lower):
                found.append(GainOnBound(gain.name, end, bound))
    return tuple(found)


def non_dominated_gains(evaluator: GainEvaluator, front: ParetoFront) -> Array:
    """Return gains of the front of which none leaves less of the motion at a lower actuator rate, by motion, (n, g)."""
    both = motion_and_rate_variances(evaluator, front.gains)
    first = non_dominated(both)
    return front.gains[first[np.argsort(both[first, 0])]]


def motion_and_rate_variances(evaluator: GainEvaluator, gains: Array) -> Array:
    """Return variances of the motion that counts and of the actuator's rate, means over what the loop meets, (n, 2)."""
    return evaluator.evaluate(gains).variances[:, :, [3, 2]].mean(axis=1)
