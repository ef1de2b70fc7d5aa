"""The regulators of section 1, which the paper sets to 1: what they would be if they did what their names say."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from seatrial.physics.loops import Preamplifier
from seatrial.physics.sea import ittc
from seatrial_studies.yu2014.published import DESIGN_ROW, PUBLISHED_VALUES, TARGET
from seatrial_studies.yu2014.published_loop import SeaCondition, performance, roll_response

SPEEDS, HEIGHTS = (14.0, 18.0, 22.0), (2.0, 3.3, 4.5)  # kn, m; our choice, about the table's
_LEAST_GAIN, _MOST_GAIN = 1e-3, 1e2  # range of the sea regulator's factor; beyond it none is given


def speed_regulator(speed: float) -> float:
    """Return Gl at a speed [kn]: (U_0 / U)^2 keeps the loop gain where lift grows with the square of the speed."""
    return (DESIGN_ROW.speed / speed) ** 2


def sea_regulator(preamplifier: Preamplifier, height: float, speed: float = DESIGN_ROW.speed) -> float:
    """Return Gh at a significant height [m]: the factor on all gains at which the fin variance meets the target of J2.

    Beam sea; 1 is the largest value given, where the published gains keep the target; NaN where no factor keeps it.
    """
    of = performance(preamplifier, SeaCondition(speed, spectrum=ittc(height)))

    def excess(factor: float) -> float:
        fin = float(of.evaluate(factor * speed_regulator(speed) * PUBLISHED_VALUES, with_Ms=False).variances[0, 1])
        return np.log(fin / TARGET) if np.isfinite(fin) else 1.0

    if excess(1.0) <= 0.0:
        return 1.0
    return float(brentq(excess, _LEAST_GAIN, 1.0)) if excess(_LEAST_GAIN) < 0.0 else float("nan")  # type: ignore[arg-type]


@dataclass(frozen=True)
class RegulatorSetting:
    """Both regulators in one condition: values, reduction [%], fin rms [deg] and Ms with them, and without them."""

    speed: float
    height: float
    Gl: float
    Gh: float
    reductions: tuple[float, float]
    fins: tuple[float, float]
    Ms: tuple[float, float]


def regulator_settings(preamplifier: Preamplifier) -> tuple[RegulatorSetting, ...]:
    """Return both regulators over speeds and heights, beam sea."""
    return tuple(_setting(preamplifier, speed, height) for speed in SPEEDS for height in HEIGHTS)


def _setting(preamplifier: Preamplifier, speed: float, height: float) -> RegulatorSetting:
    of = performance(preamplifier, SeaCondition(speed, spectrum=ittc(height)))
    Gl, Gh = speed_regulator(speed), sea_regulator(preamplifier, height, speed)
    with_them, without = (roll_response(of, factor * PUBLISHED_VALUES) for factor in (Gl * Gh, 1.0))
    return RegulatorSetting(
        speed, height, Gl, Gh, (with_them.reduction, without.reduction), (with_them.fin, without.fin),
        (with_them.Ms, without.Ms),
    )  # fmt: skip
