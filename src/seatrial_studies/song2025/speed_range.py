"""Conclusion 1, a wider range of speed: coefficients found at one speed predict the craft at half to twice of it."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from seatrial.core.equations import Model
from seatrial.data.example_series import JET_VELOCITY, SLEW_RATE
from seatrial.physics.manoeuvres import programme
from seatrial.physics.simulate import manoeuvre
from seatrial_studies.song2025.craft_models import TRUTH, replay_inputs
from seatrial_studies.song2025.generalisation import CHANNELS, prediction_accuracy
from seatrial_studies.song2025.published import PublishedManoeuvre

SPEED_FACTORS = (0.5, 0.75, 1.0, 1.5, 2.0)  # of the jet velocity, and so of the approach speed; our choice


@dataclass(frozen=True, eq=False)
class SpeedPrediction:
    """A 20/20 zigzag of the truth at one speed, predicted on its nozzle history.

    Attributes:
        factor: of the approach speed in the training series; speed: approach speed, m/s.
        errors: whose coefficients -> largest RMSE of u, v, r over the channel's rms; infinite where it diverges.
        cc: whose coefficients -> least correlation.
    """

    factor: float
    speed: float
    errors: dict[str, float]
    cc: dict[str, float]


def speed_predictions(crafts: Mapping[str, Model], factors: tuple[float, ...]) -> tuple[SpeedPrediction, ...]:
    """Return predictions at each speed; all coefficients come from a series at one."""
    return tuple(_at_speed(crafts, factor) for factor in factors)


def _at_speed(crafts: Mapping[str, Model], factor: float) -> SpeedPrediction:
    truth = manoeuvre(
        TRUTH.craft(), programme(PublishedManoeuvre.ZIGZAG_20), inputs={"v_j": factor * JET_VELOCITY},
        slew_rate=SLEW_RATE,
    )  # fmt: skip
    errors, cc = {}, {}
    for name, craft in crafts.items():
        again = replay_inputs(craft, truth)
        if len(again) < len(truth):
            errors[name], cc[name] = float("inf"), float("nan")
            continue
        accuracy = prediction_accuracy(truth, again)
        sizes = {c: float(np.sqrt(np.mean(truth[c] ** 2))) for c in CHANNELS}
        errors[name] = max(accuracy.rmse[c] / sizes[c] for c in CHANNELS)
        cc[name] = min(accuracy.cc.values())
    return SpeedPrediction(factor, float(truth["u"][0]), errors, cc)
