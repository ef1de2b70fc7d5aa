"""When a simulation leaves the world: a sentence that says when, and which channel went first."""

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import NOTATION, Array, DivergedError

# by SI unit: beyond these no ship is believable (and nothing is, beyond 1e9)
_LIMITS_BY_UNIT = {"m": 1e7, "m/s": 150.0, "rad": 1e4, "rad/s": 20.0}
_DEFAULT_LIMIT = 1e9  # of a state in any other unit, as said above


def state_limits(model: Model) -> Array:
    """Return bounds of the states' magnitudes, shape (nx,)."""
    units = [NOTATION[s].unit if s in NOTATION else "" for s in model.states]
    return np.array([_LIMITS_BY_UNIT.get(unit, _DEFAULT_LIMIT) for unit in units])


def first_row_outside(states: Array, limits: Array) -> int | None:
    """Return the first row of states (n, nx) in which one exceeds its limit (nx,) or is NaN; None where none is."""
    inside = np.abs(states) <= limits
    return None if inside.all() else int(np.argmin(inside.all(axis=1)))


def require_bounded(model: Model, time: Array, states: Array, subject: str) -> None:
    """Accept states (n, nx) that stay within their bounds.

    Raises:
        DivergedError: they do not; the first time [s] and channel are named.
    """
    row = first_row_outside(states, state_limits(model))
    if row is None:
        return
    state = model.states[_diverging_state(states, row, state_limits(model))]
    raise DivergedError(
        f"the simulation of {subject} with model '{model.name}' diverges: '{state}' left its bounds at "
        f"t = {time[row]:g} s; check the model's coefficients and initial state, or take a smaller step"
    )


def _diverging_state(states: Array, row: int, bounds: Array) -> int:
    """The state farthest outside at `row`, or the fastest growing one before it where nothing there is finite."""
    here = np.abs(states[row]) / bounds
    if np.isfinite(here).any() and np.nanmax(here) > 1.0:
        return int(np.nanargmax(here))
    return int(np.argmax(np.abs(states[max(row - 1, 0)]) / bounds))
