"""What no linear controller does better: the bounds beside a tuning, as many as can be had."""

import contextlib
from dataclasses import replace
from importlib.util import find_spec

from seatrial.control.quadratic import quadratic_bound, with_tails
from seatrial.control.task import Seaway, Task
from seatrial.control.youla import NoBound, youla_bound
from seatrial.core.results.tuning import Bound
from seatrial.core.values import Array
from seatrial.physics.loops import TransferLoop


def is_available() -> bool:
    """Whether the convex bounds can be had: cvxpy, the extra `bounds`."""
    return find_spec("cvxpy") is not None


def bounds(task: Task, loop: TransferLoop, gains: Array) -> tuple[Bound, ...]:
    """Bounds against the controller `gains` (g,) of `loop`, in the first sea of the task.

    Where cvxpy is installed the convex one in the sea itself, and in a rational spectrum fitted to it: one without
    energy outside a band lets complicated controllers predict what real seas, with tails, do not. The linear-quadratic
    one in the latter, for context. None for servo loops on plants that integrate or run away (an autopilot), nor where
    no sea is met: their output has no variance without control.

    Raises:
        InputError: the loop is unstable with these gains.
    """
    sea = next((met for met in task.met if isinstance(met, Seaway)), None)
    if sea is None or task.demand is not None:
        return ()
    met, peak = sea.exposure(loop), task.restriction.peak

    def in_the_sea() -> Bound:
        return youla_bound(loop, met, gains, peak)

    def with_its_tails() -> Bound:
        made = youla_bound(loop, with_tails(met, loop.disturbance)[0], gains, peak)
        return replace(made, name=f"{made.name}, waves with tails")

    def known() -> Bound:
        return quadratic_bound(loop, met, gains)

    made: list[Bound] = []
    for one in (in_the_sea, with_its_tails, known) if is_available() else (known,):
        with contextlib.suppress(NoBound):
            made.append(one())
    return tuple(made)
