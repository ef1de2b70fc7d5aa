"""A disturbance larger than the motion is called the model's misfit, or, where the model fits, not determined."""

import numpy as np
import pytest

from seatrial.core.results import Prediction
from seatrial.core.values import Record
from seatrial.estimation.identify.warnings import EXCEEDS_MOTION, misfit_disturbance

TIME = np.arange(0.0, 100.0, 0.2)
RUN = Record.from_arrays("run", TIME, {"u": 4.0 + 0.3 * np.sin(TIME), "r": 0.2 * np.sin(0.5 * TIME)})


def run(disturbed: dict[str, float], **rms: float) -> Prediction:
    """A training run with these open-loop errors, and what the disturbance moves by itself, SI."""
    return Prediction("run", "training", RUN, RUN, rms, {}, 5.0, noise_floor=disturbed)


@pytest.mark.parametrize("rms", [{"u": 0.4}, {}])
def test_a_disturbance_larger_than_the_motion_is_a_misfit(rms: dict[str, float]) -> None:
    """The surge of the run spreads by 0.21 m/s, its yaw rate by 0.14 rad/s."""
    (finding,) = misfit_disturbance([run({"u": 0.83, "r": 0.05}, **rms)])
    assert "misfit" in finding.message and "u: 0.83 m/s without steering" in finding.evidence
    assert "0.21 m/s" in finding.evidence and "r:" not in finding.evidence
    assert finding.evidence.endswith("and the model misses it by 0.40 m/s") == bool(rms)


def test_a_disturbance_that_the_model_does_not_miss_is_not_determined() -> None:
    (finding,) = misfit_disturbance([run({"u": 0.83}, u=0.07)])
    assert finding.code == EXCEEDS_MOTION and "disturbance of u cannot be" in finding.message
    assert finding.advice.startswith("state the sensors' noise of u under [noise]")


def test_gusts_of_a_sea_and_states_of_no_run_are_none() -> None:
    assert misfit_disturbance([run({"u": 0.05, "r": 0.05, "v": 1.0, "psi_deg": 90.0}, u=0.4)]) == ()
