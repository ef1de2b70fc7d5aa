"""Intervals of a manoeuvre that was never sailed: the helmsman steers drawn ships, and the tied models."""

from collections.abc import Callable

import numpy as np
from scipy import stats

from seatrial.equations import Model
from seatrial.information.discrepancy import Discrepancy
from seatrial.information.extrapolation import extrapolation
from seatrial.manoeuvres import measures
from seatrial.predict.draws import root
from seatrial.results import Margin
from seatrial.values import Array, InputError, Record

DRAWS = 60
_RUDDER = "delta zero"


def measure_intervals(
    model: Model, margin: Margin, steer: Callable[[Model], Record], length: float, rng: np.random.Generator
) -> dict[str, tuple[float, float]]:
    """95 % interval of each measure of the manoeuvre that `steer` makes of a model.

    Ships are drawn from the covariance of the coefficients and from what the rudder's zero differs by between runs
    (where the model has it as `delta_0`); measures of a kind that runs left out have shown get the discrepancy found
    there, others the foreseen spread times the margin's factor; the distance of tied models comes on top.

    Raises:
        InputError: more than half of the drawn ships diverge.
    """
    sailed = steer(model)
    centre = measures(sailed, length)
    reached = extrapolation(sailed, margin.covered)
    index = reached.index if reached else 1.0
    drawn = [m for point in _drawn(model, margin, rng) if (m := _measured(point, steer, length)) is not None]
    if len(drawn) < DRAWS // 2:
        raise InputError(
            f"{DRAWS - len(drawn)} of {DRAWS} ships drawn from the fit's covariance cannot be steered through this "
            "manoeuvre; the records do not determine it"
        )
    tied = [m for one in margin.tied if (m := _measured(model.with_values(one), steer, length)) is not None]
    beyond = Discrepancy(margin.kinds, margin.factor, 1.0, {})
    t = float(stats.t.ppf(0.975, margin.degrees_of_freedom))
    made = {}
    for name, value in centre.items():
        away = [m[name] - value for m in drawn if name in m]
        if len(away) >= DRAWS // 2:
            spread = beyond.of_measure(name, float(np.sqrt(np.mean(np.square(away)))), index)
            apart = [m[name] - value for m in tied if name in m]
            half = t * float(np.hypot(spread, np.sqrt(np.mean(np.square(apart))) if apart else 0.0))
            made[name] = (value - half, value + half)
    return made


def _drawn(model: Model, margin: Margin, rng: np.random.Generator) -> list[Model]:
    free = model.parameters.free_names
    centre: Array = np.array([p.value for p in model.parameters.free])
    points = centre + rng.standard_normal((DRAWS, len(free))) @ root(margin.covariance).T
    zeros = margin.offsets.get(_RUDDER, 0.0) * rng.standard_normal(DRAWS)
    made = [model.with_values(dict(zip(free, point, strict=True))) for point in points]
    if "delta_0" not in model.parameters:
        return made
    return [
        one.with_values({"delta_0": one.parameters["delta_0"].value + zero})
        for one, zero in zip(made, zeros, strict=True)
    ]


def _measured(model: Model, steer: Callable[[Model], Record], length: float) -> dict[str, float] | None:
    try:
        return measures(steer(model), length)
    except InputError:
        return None
