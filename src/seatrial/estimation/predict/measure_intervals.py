"""Intervals of a manoeuvre that was only simulated: steered with ships drawn from the fit and with tied models."""

from collections.abc import Callable

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import IntervalBasis
from seatrial.core.results.coefficients import STORED_LEVEL, two_sided_quantile
from seatrial.core.values import Array, InputError, Record
from seatrial.estimation.information.discrepancy import Discrepancy
from seatrial.estimation.information.extrapolation import extrapolation
from seatrial.estimation.predict.draws import square_root
from seatrial.physics.manoeuvres import bounded_interval, measures

_RUDDER_OFFSET = "delta zero"

MeasuresPair = tuple[dict[str, float] | None, dict[str, float] | None]


def measure_intervals(
    model: Model, interval_basis: IntervalBasis, steer: Callable[[Model], Record], length: float
) -> dict[str, tuple[float, float] | None]:
    """Return the 95 % interval of each measure of the manoeuvre that `steer` makes of a model; None: not determined.

    The helmsman steers two ships along every principal direction of the coefficients' covariance, one standard
    deviation to either side, and two with the rudder's zero off by what it differs between runs (where the model has it
    as `delta_0`); half their differences add up in squares. Nothing is drawn at random. Measures of a kind that runs
    left out have shown get the discrepancy found there, others the foreseen spread times the margin's factor; the
    distance of tied models comes on top. Process noise is not counted: the interval is for the manoeuvre in water as
    calm as discrepancy and factor have it.

    Raises:
        InputError: more than half of these ships diverge.
    """
    nominal = steer(model)
    centre = measures(nominal, length)
    reached = extrapolation(nominal, interval_basis.training_envelope, model.equations.layout)
    index = reached.index if reached else 1.0
    pairs = [
        (_measures_or_none(up, steer, length), _measures_or_none(down, steer, length))
        for up, down in perturbed_models(model, interval_basis)
    ]
    lost = sum(m is None for pair in pairs for m in pair)
    if lost > len(pairs):
        raise InputError(
            f"{lost} of {2 * len(pairs)} ships one standard deviation from the fit cannot be steered through this "
            "manoeuvre: the records do not determine it, and its measures have no interval"
        )
    tied = [
        m for one in interval_basis.tied if (m := _measures_or_none(model.with_values(one), steer, length)) is not None
    ]
    beyond = Discrepancy(interval_basis.measure_deviation, interval_basis.factor, 1.0, {})
    t = two_sided_quantile(STORED_LEVEL, interval_basis.degrees_of_freedom)
    intervals: dict[str, tuple[float, float] | None] = {}
    for name, value in centre.items():
        away = [d for pair in pairs if (d := _half_difference(pair, name, value)) is not None]
        if 2 * len(away) > len(pairs) or not pairs:
            spread = beyond.measure_sd(name, float(np.sqrt(np.sum(np.square(away)))), index)
            apart = [m[name] - value for m in tied if name in m]
            half = t * float(np.hypot(spread, np.sqrt(np.mean(np.square(apart))) if apart else 0.0))
            intervals[name] = bounded_interval(name, value, half)
    return intervals


def _half_difference(pair: MeasuresPair, name: str, centre: float) -> float | None:
    """Return half the difference of both sides; the distance of one where only one shows the measure; else None."""
    sides = [m[name] for m in pair if m is not None and name in m]
    if len(sides) == 2:
        return 0.5 * (sides[0] - sides[1])
    return sides[0] - centre if sides else None


def perturbed_models(model: Model, interval_basis: IntervalBasis) -> list[tuple[Model, Model]]:
    """Return pairs of models one standard deviation to either side of the fit, along every principal direction."""
    free = model.parameters.free_names
    centre: Array = np.array([p.value for p in model.parameters.free])
    columns = [c for c in square_root(interval_basis.covariance).T if np.any(c)]
    models = [
        (
            model.with_values(dict(zip(free, centre + c, strict=True))),
            model.with_values(dict(zip(free, centre - c, strict=True))),
        )
        for c in columns
    ]
    between = interval_basis.offsets.get(_RUDDER_OFFSET, 0.0)
    if between > 0 and "delta_0" in model.parameters:
        zero = model.parameters["delta_0"].value
        models.append((model.with_values({"delta_0": zero + between}), model.with_values({"delta_0": zero - between})))
    return models


def _measures_or_none(model: Model, steer: Callable[[Model], Record], length: float) -> dict[str, float] | None:
    try:
        return measures(steer(model), length)
    except InputError:
        return None
