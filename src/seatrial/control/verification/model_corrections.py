"""What in the model was wrong: its properties before the log and with it."""

import math

import numpy as np

from seatrial.core.results.verification import ModelCorrection, normal_interval
from seatrial.core.values import Array
from seatrial.estimation.sea import PLANT_FACTORS, LegFit
from seatrial.physics.loops import TransferLoop


def model_corrections(loop: TransferLoop, deviations: Array, fit: LegFit) -> tuple[ModelCorrection, ...]:
    """Return effectiveness of the fins, natural frequency and damping ratio of the plant, before the log and with it.

    deviations: of the logarithms of the factors before the log, (3,).
    """
    pole = loop.plant.poles[np.argmin(np.abs(loop.plant.poles.real) / np.abs(loop.plant.poles))]
    effect = loop.plant.gain / loop.disturbance.gain
    values = (
        ("effectiveness of the fins, K_alpha", "1", effect),
        ("natural frequency", "rad/s", float(np.abs(pole))),
        ("damping ratio", "1", float(-pole.real / np.abs(pole))),
    )
    return tuple(
        _correction(name, unit, value, float(deviations[k]), float(fit.ship[k]), float(fit.ship_deviations[k]))
        for k, ((name, unit, value), _) in enumerate(zip(values, PLANT_FACTORS, strict=True))
    )


def _correction(
    name: str, unit: str, value: float, deviation: float, factor: float, factor_deviation: float
) -> ModelCorrection:
    """Return a property times a factor whose logarithm is normal."""
    low, high = (value * math.exp(end) for end in normal_interval(factor, factor_deviation))
    return ModelCorrection(
        name, unit, value, value * deviation, value * math.exp(factor), low, high, not low <= value <= high
    )
