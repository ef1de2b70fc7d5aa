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
from seatrial.core.text.numbers import significant
from seatrial.core.values import Array
from seatrial.numerics.kernels.integrate import evaluate_tangent
from seatrial.physics.simulate.states import settled_actuators

_STEP = 1e-4  # of a coefficient's characteristic size, for central differences
# of the speed, for one-sided slopes; relative difference of equal sides; chosen
_LATERAL_OFFSET, _EQUAL_SIDES = 1e-12, 0.01


def straight_course_rates(model: Model, speed: float, inputs: Array) -> Array:
    """Linearised rates of sway and yaw (or yaw alone) on a straight course, shape (2, 2) or (1, 1), SI.

    The mean over both sides (`one_sided_rates`). speed: m/s; inputs (nu,) in the model's signs, rudder amidships.
    """
    return one_sided_rates(model, speed, inputs).mean(axis=0)


def one_sided_rates(model: Model, speed: float, inputs: Array) -> Array:
    """The same for a turn just begun to starboard (r > 0 > v) and one to port, shape (2, n, n); thrusters have settled.

    They differ where a coefficient does (gamma_R): such a model has a kink on the straight course itself.
    """
    straight = settled_actuators(model, inputs)
    if model.has_speed:
        straight[model.states.index("u")] = speed
    place = [model.states.index(s) for s in lateral_states(model)]
    aside = np.zeros(len(model.states))
    aside[place] = [_LATERAL_OFFSET * speed * (-1.0 if model.states[k] == "v" else 1.0) for k in place]
    states = np.array([straight + aside, straight - aside])
    nx, width = len(model.states), len(model.states) + len(model.inputs) + len(model.parameters)
    out, jacobian = np.empty((2, nx)), np.zeros((2, nx, width))
    both = np.tile(inputs, (2, 1)), np.tile(model.parameters.values, (2, 1))
    evaluate_tangent(model.compiled.rates_tangent, states, *both, 1.0, out, jacobian)
    return jacobian[np.ix_([0, 1], place, place)]


def lateral_states(model: Model) -> tuple[str, ...]:
    """States that decide on course stability: sway and yaw, or yaw and what nobody measures; empty without yaw rate."""
    if "r" not in model.states:
        return ()
    return ("v", "r") if "v" in model.states else tuple(s for s in model.states if s not in ("psi", "x0", "y0", "u"))


def growth_rate(model: Model, speed: float, inputs: Array) -> float:
    """Return the largest real part of the eigenvalues of sway and yaw on a straight course, 1/s; below 0: stable."""
    return _growth(straight_course_rates(model, speed, inputs))


def stability(
    model: Model, covariance: Array, degrees_of_freedom: float, speed: float | None, inputs: Array, length: float
) -> Stability | None:
    """Return index and growth rate with 95 % intervals, by the delta method over the free coefficients.

    The growth rate is the largest real part of the eigenvalues of sway and yaw. None where the model has no yaw rate.

    Args:
        covariance: of the free coefficients, (n, n). inputs: (nu,), the model's signs. length: m.
        speed: straight ahead, m/s; None: not known, of a model that does not depend on it. C is then that of a second.
    """
    if not lateral_states(model):
        return None
    unit, ahead = (1.0, 1.0) if speed is None else (length / speed, speed)

    def index_and_growth(one: Model) -> Array:
        rates = straight_course_rates(one, ahead, inputs)
        return np.array([_index(rates, unit), _growth(rates)])

    t = two_sided_quantile(STORED_LEVEL, degrees_of_freedom)
    index, growth = index_and_growth(model).tolist()
    wide, open_by = (t * _deviations(model, index_and_growth, covariance)).tolist()
    starboard, port = (_index(rates, unit) for rates in one_sided_rates(model, ahead, inputs))
    noun = "craft" if model.has_thrusters else "ship"
    is_known = abs(index) > wide or abs(growth) > open_by
    text = _stability_text(noun, speed, is_known=is_known, is_stable=growth < 0.0)
    text += _growth_text(growth, open_by, None if speed is None else unit)
    return Stability(
        index, index - wide, index + wide, text + _asymmetry_text(starboard, port), speed, growth, growth - open_by,
        growth + open_by,
    )  # fmt: skip


def _index(rates: Array, unit: float) -> float:
    return float(np.linalg.det(-rates) * unit ** len(rates))


def _growth(rates: Array) -> float:
    return float(np.max(np.linalg.eigvals(rates).real))


def _deviations(model: Model, values_of: Callable[[Model], Array], covariance: Array) -> Array:
    """Standard deviations of values of the model, (k,), by central differences in its free coefficients."""
    slopes = list[Array]()
    for p in model.parameters.free:
        step = _STEP * p.characteristic_scale
        up, down = (values_of(model.with_values({p.name: p.value + s})) for s in (step, -step))
        slopes.append((up - down) / (2.0 * step))
    return np.sqrt([max(slope @ covariance @ slope, 0.0) for slope in np.ascontiguousarray(np.transpose(slopes))])


def _stability_text(noun: str, speed: float | None, *, is_known: bool, is_stable: bool) -> str:
    at = "" if speed is None else f" at {significant(speed, 2)} m/s"
    if is_known:
        return f"the {noun} is course {'stable' if is_stable else 'unstable'}{at}"
    return f"whether the {noun} is course stable{at} cannot be determined"


def _growth_text(growth: float, half: float, unit: float | None) -> str:
    """Return how fast a deviation dies out or grows; with the interval of that time where the rate has one sign."""
    if growth == 0.0:
        return ""
    seconds = significant(abs(1.0 / growth), 2)
    if 0.0 < half < abs(growth):
        seconds += f" s [{significant(1.0 / (abs(growth) + half), 2)}, {significant(1.0 / (abs(growth) - half), 2)}]"
    else:
        seconds += " s"
    verb = "dies out" if growth < 0 else "grows"
    lengths = "" if unit is None else f", {significant(abs(1.0 / growth) / unit, 2)} ship lengths"
    return f": at the estimate a deviation {verb} by a factor e in {seconds}{lengths}"


def _asymmetry_text(starboard: float, port: float) -> str:
    """What is said where turns to both sides do not begin alike."""
    if abs(starboard - port) <= _EQUAL_SIDES * max(abs(starboard), abs(port)):
        return ""
    return f"; the sides differ: C is {starboard:+.2g} beginning a turn to starboard and {port:+.2g} to port"
