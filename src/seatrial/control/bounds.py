"""What no linear controller does better: bounds compared with a tuning, as many as can be computed."""

import contextlib
from dataclasses import replace
from importlib.util import find_spec

from seatrial.control.quadratic import quadratic_bound, rational_spectrum
from seatrial.control.task import OUTPUT, Seaway, TuningTask
from seatrial.control.youla import NoBound, youla_bound
from seatrial.core.results.tuning import PerformanceBound
from seatrial.core.values import Array
from seatrial.physics.loops import TransferLoop


def is_available() -> bool:
    """Return whether the convex bounds can be computed: cvxpy, the extra `bounds`, is installed."""
    return find_spec("cvxpy") is not None


def bounds(task: TuningTask, loop: TransferLoop, gains: Array) -> tuple[PerformanceBound, ...]:
    """Return bounds against the controller `gains` (g,) of `loop`, in the first sea of the task.

    Where cvxpy is installed the convex one in the sea itself, and in a rational spectrum fitted to it: one without
    energy outside a band lets complicated controllers predict what real seas, with tails, do not. The linear-quadratic
    one in the latter, for context. None for servo loops on plants that integrate or run away (an autopilot), nor where
    no sea is met: their output has no variance without control. Nor where a point of the hull counts, not the output.
    """
    sea = next((met for met in task.disturbances if isinstance(met, Seaway)), None)
    if sea is None or task.demand is not None or task.motion is not OUTPUT:
        return ()
    loop = replace(sea.disturbed(loop), sampling=None)  # a bound in continuous time without dead time is one of all
    waves, peak = sea.exposure(loop), task.constraints.Ms

    def with_tails() -> PerformanceBound:
        bound = youla_bound(loop, rational_spectrum(waves, loop.disturbance)[0], gains, peak)
        return replace(bound, name=f"{bound.name}, waves with tails")

    convex = [lambda: youla_bound(loop, waves, gains, peak), with_tails] if is_available() else []
    computed: list[PerformanceBound] = []
    for compute in (*convex, lambda: quadratic_bound(loop, waves, gains)):
        with contextlib.suppress(NoBound):
            computed.append(compute())
    return tuple(computed)
