"""A model: checked for finite rates, exact Jacobians, known units, the mirror law and an exact model file."""

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array
from seatrial.data.folder.model_file import ModelFile, model_text, parse_model
from seatrial.testing.conformance import is_unit, require
from seatrial.testing.model_points import MirrorLaw, Point, random_points

# dimensionless: by what share of the largest entry of its row an exact derivative may differ from a central difference;
# ours, a hundred times the rounding error of such a difference
_JACOBIAN_TOLERANCE = 2e-7
# relative steps of a difference, of which the better counts, and the magnitude (SI) below which they are absolute;
# ours: the smaller suits strong curvature, the larger rates that are small differences of large terms
_STEPS, _SMALLEST = (1e-6, 3e-5), 1e-2
_FARTHEST = 100.0  # of a value that is not zero, the most that counts as its magnitude; chosen
_MIRROR_TOLERANCE = 1e-9  # relative; ours: sums in another order


def check_model(model: Model, mirror: MirrorLaw | None = None, seed: int = 0, points: int = 20) -> None:
    """Check a model: values, units, sources, finite rates, exact Jacobians, reproducibility, its model file.

    Args:
        model: every parameter must have a value (`Model.with_ship`, `Model.with_values`).
        mirror: declares the model symmetric to port and starboard, which is then checked; None: it is not.
        seed: of the states and inputs at which it is evaluated.
        points: number of them.

    Raises:
        ConformanceError: the first violation.
    """
    _check_declarations(model)
    for point in random_points(model, np.random.default_rng(seed), points):
        values = _rates_and_outputs(model, point)
        finite = bool(np.all(np.isfinite(values)))
        require(finite, f"a rate or output is not finite at {point.text(model)}; guard the denominator")
        same = values.tobytes() == _rates_and_outputs(model, point).tobytes()
        require(same, "evaluated twice the model gives other rates")
        _check_jacobian(model, point)
        if mirror is not None:
            _check_mirror(model, point, mirror)
    _check_model_file(model)


def _check_declarations(model: Model) -> None:
    """Check names, values, units and sources."""
    missing = ", ".join(model.parameters.missing)
    require(not missing, f"parameters without a value: {missing}; give them with with_ship or with_values first")
    require(bool(model.equations.source), "the model names no source; pass source= to Sheet")
    for name, unit in [(p.name, p.unit) for p in model.parameters] + [(b.name, b.unit) for b in model.bindings]:
        require(is_unit(unit), f"'{name}' has the unit '{unit}', which is no product of SI units such as 'kg m/s^2'")
    for p in model.parameters.free:
        require(p.lower <= p.value <= p.upper, f"the value {p.value:g} of '{p.name}' lies outside its bounds")


def _rates_and_outputs(model: Model, point: Point) -> Array:
    """Return rates, then outputs, shape (nx + ny,)."""
    rates, outputs = np.empty(len(model.states)), np.empty(len(model.outputs))
    model.compiled.rates(0.0, point.states, point.inputs, point.parameters, rates)
    if len(outputs):
        model.compiled.outputs(0.0, point.states, point.inputs, point.parameters, outputs)
    return np.concatenate([rates, outputs])


def _check_jacobian(model: Model, point: Point) -> None:
    """Check the generated Jacobians by [x | u | p] against central differences."""
    nx, ny, columns = len(model.states), len(model.outputs), point.size
    exact = np.zeros((nx + ny, columns))
    tangent = np.zeros((nx, columns))
    model.compiled.rates_tangent(0.0, point.states, point.inputs, point.parameters, np.empty(nx), tangent)
    exact[:nx] = tangent
    if ny:
        tangent = np.zeros((ny, columns))
        model.compiled.outputs_tangent(0.0, point.states, point.inputs, point.parameters, np.empty(ny), tangent)
        exact[nx:] = tangent
    size = np.abs(exact).max(axis=1) + np.finfo(float).tiny
    names = (*model.states, *model.input_names, *model.parameters.names)
    for column, name in enumerate(names):
        gaps = []
        for relative in _STEPS:
            value = abs(point.vector[column])
            step = relative * max(value, min(_SMALLEST, _FARTHEST * value) or _SMALLEST)
            up, down = (_rates_and_outputs(model, point.moved(column, s)) for s in (step, -step))
            gaps.append(np.abs(exact[:, column] - (up - down) / (2.0 * step)) / size)
        gap = np.minimum(*gaps)
        row = int(np.argmax(gap))
        require(
            bool(gap[row] <= _JACOBIAN_TOLERANCE),
            f"d({(*model.states, *model.outputs)[row]})/d({name}) is {exact[row, column]:g}, off by {gap[row]:.2g} of "
            f"the largest derivative from a difference at {point.text(model)}; avoid a jump or kink there",
        )


def _check_mirror(model: Model, point: Point, law: MirrorLaw) -> None:
    """Check that the mirrored ship makes the mirrored motion."""
    names = (*model.states, *model.outputs)
    expected = law.motion(names, _rates_and_outputs(model, point))
    mirrored = _rates_and_outputs(model, point.mirrored(model, law))
    for name, value, other in zip(names, expected, mirrored, strict=True):
        require(
            abs(other - value) <= _MIRROR_TOLERANCE * max(1.0, abs(value)),
            f"'{name}' breaks the mirror law at {point.text(model)}: {other:g} for the mirrored ship, not {value:g}",
        )


def _check_model_file(model: Model) -> None:
    """Check that the model file restores equations and parameters to the last bit."""
    restored = parse_model(model_text(ModelFile(model)), "model file in memory", model).model
    for before, after in zip(model.parameters, restored.parameters, strict=True):
        require(before == after, f"the parameter '{before.name}' changes when the model file is written and read")
