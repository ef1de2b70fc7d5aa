"""Course stability of a model on a straight course, with the interval its coefficients leave it.

The index C = Y_v'(N_r' - m' x_G') - N_v'(Y_r' - m') (Clarke, Gedling & Hine 1983, eq. (13); Abkowitz 1964) is the
determinant of the linearised sway-yaw equations times the determinant of inertia; what is given here is the first
factor, det(A) (L/U)^2 with d(v, r)/dt = A (v, r), which has C's sign for every model.
"""

from collections.abc import Callable

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Stability
from seatrial.core.results.coefficients import STORED_LEVEL, two_sided_quantile
from seatrial.core.values import Array
from seatrial.numerics.kernels.sensitivity import evaluate_tangent

_STEP = 1e-4  # of a coefficient's characteristic size, for central differences
# of the speed, for one-sided slopes; relative difference of equal sides; chosen
_LATERAL_OFFSET, _EQUAL_SIDES = 1e-12, 0.01


def straight_course_rates(model: Model, speed: float, inputs: Array) -> Array:
    """Linearised rates of sway and yaw (or yaw alone) on a straight course, shape (2, 2) or (1, 1), SI.

    The mean over both sides (`one_sided_rates`). speed: m/s; inputs (nu,) in the model's signs, rudder amidships.
    """
    return one_sided_rates(model, speed, inputs).mean(axis=0)


def one_sided_rates(model: Model, speed: float, inputs: Array) -> Array:
    """The same for a turn just begun to starboard (r > 0 > v) and one to port, shape (2, n, n).

    They differ where a coefficient does (gamma_R): such a model has a kink on the straight course itself.
    """
    aside = {s: _LATERAL_OFFSET * speed * (-1.0 if s == "v" else 1.0) for s in lateral_states(model)}
    states = np.array([[speed if s == "u" else side * aside.get(s, 0.0) for s in model.states] for side in (1.0, -1.0)])
    nx, width = len(model.states), len(model.states) + len(model.inputs) + len(model.parameters)
    out, jacobian = np.empty((2, nx)), np.zeros((2, nx, width))
    both = np.tile(inputs, (2, 1)), np.tile(model.parameters.values, (2, 1))
    evaluate_tangent(model.compiled.rates_tangent, states, *both, 1.0, out, jacobian)
    place = [model.states.index(s) for s in lateral_states(model)]
    return jacobian[np.ix_([0, 1], place, place)]


def lateral_states(model: Model) -> tuple[str, ...]:
    """States that decide on course stability: sway and yaw, or yaw and what nobody measures; empty without yaw rate."""
    if "r" not in model.states:
        return ()
    return ("v", "r") if "v" in model.states else tuple(s for s in model.states if s not in ("psi", "x0", "y0", "u"))


def stability(
    model: Model, covariance: Array, degrees_of_freedom: float, speed: float, inputs: Array, length: float
) -> Stability | None:
    """Index and 95 % interval by the delta method over the free coefficients; None where the model has no yaw rate.

    covariance: of the free coefficients, (n, n); length in m.
    """
    if not lateral_states(model):
        return None
    unit = length / speed

    def index_of(one: Model) -> float:
        return _index(straight_course_rates(one, speed, inputs), unit)

    centre = index_of(model)
    slope = _gradient(model, index_of)
    half = two_sided_quantile(STORED_LEVEL, degrees_of_freedom) * float(np.sqrt(max(slope @ covariance @ slope, 0.0)))
    slowest = float(np.max(np.linalg.eigvals(straight_course_rates(model, speed, inputs)).real)) * unit
    starboard, port = (_index(rates, unit) for rates in one_sided_rates(model, speed, inputs))
    text = _stability_text(centre, half, slowest) + _asymmetry_text(starboard, port)
    return Stability(centre, centre - half, centre + half, text)


def _index(rates: Array, unit: float) -> float:
    return float(np.linalg.det(-rates) * unit ** len(rates))


def _gradient(model: Model, stability_index: Callable[[Model], float]) -> Array:
    made = []
    for p in model.parameters.free:
        step = _STEP * p.characteristic_scale
        up, down = (stability_index(model.with_values({p.name: p.value + s})) for s in (step, -step))
        made.append((up - down) / (2.0 * step))
    return np.array(made)


def _stability_text(index: float, half: float, slowest: float) -> str:
    text = "whether the ship is course stable cannot be determined"
    if abs(index) > half:
        text = f"the ship is course {'stable' if index > 0 else 'unstable'}"
    if slowest == 0.0:
        return text
    grown = "dies out" if slowest < 0 else "grows"
    return f"{text}: at the estimate a disturbance {grown} by a factor e in {abs(1.0 / slowest):.2g} ship lengths"


def _asymmetry_text(starboard: float, port: float) -> str:
    """What is said where turns to both sides do not begin alike."""
    if abs(starboard - port) <= _EQUAL_SIDES * max(abs(starboard), abs(port)):
        return ""
    return f"; the sides differ: C is {starboard:+.2g} beginning a turn to starboard and {port:+.2g} to port"
