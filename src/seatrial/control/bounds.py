"""What no linear controller does better: the bounds beside a tuning, as many as can be had."""

import contextlib
from dataclasses import replace
from importlib.util import find_spec

from seatrial.control.quadratic import quadratic_bound, rational_spectrum
from seatrial.control.task import Seaway, TuningTask
from seatrial.control.youla import NoBound, youla_bound
from seatrial.core.results.tuning import PerformanceBound
from seatrial.core.values import Array
from seatrial.physics.loops import TransferLoop


def is_available() -> bool:
    """Whether the convex bounds can be had: cvxpy, the extra `bounds`."""
    return find_spec("cvxpy") is not None


def bounds(task: TuningTask, loop: TransferLoop, gains: Array) -> tuple[PerformanceBound, ...]:
    """Bounds against the controller `gains` (g,) of `loop`, in the first sea of the task.

    Where cvxpy is installed the convex one in the sea itself, and in a rational spectrum fitted to it: one without
    energy outside a band lets complicated controllers predict what real seas, with tails, do not. The linear-quadratic
    one in the latter, for context. None for servo loops on plants that integrate or run away (an autopilot), nor where
    no sea is met: their output has no variance without control.

    Raises:
        InputError: the loop is unstable with these gains.
    """
    sea = next((met for met in task.disturbances if isinstance(met, Seaway)), None)
    if sea is None or task.demand is not None:
        return ()
    met, peak = sea.exposure(loop), task.constraints.Ms

    def in_the_sea() -> PerformanceBound:
        return youla_bound(loop, met, gains, peak)

    def in_rational_spectrum() -> PerformanceBound:
        made = youla_bound(loop, rational_spectrum(met, loop.disturbance)[0], gains, peak)
        return replace(made, name=f"{made.name}, waves with tails")

    def quadratic() -> PerformanceBound:
        return quadratic_bound(loop, met, gains)

    made: list[PerformanceBound] = []
    for one in (in_the_sea, in_rational_spectrum, quadratic) if is_available() else (quadratic,):
        with contextlib.suppress(NoBound):
            made.append(one())
    return tuple(made)
