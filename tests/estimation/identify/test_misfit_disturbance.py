"""A disturbance larger than the motion is called the model's misfit, or, where the model fits, not determined."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.results import Prediction
from seatrial.core.values import Record
from seatrial.estimation.identify.warnings import EXCEEDS_MOTION, misfit_disturbance

TIME = np.arange(0.0, 100.0, 0.2)
RUN = Record.from_arrays("run", TIME, {"u": 4.0 + 0.3 * np.sin(TIME), "r": 0.2 * np.sin(0.5 * TIME)})


def run(**rms: float) -> Prediction:
    """A training run with these open-loop errors, SI."""
    return Prediction("run", "training", RUN, RUN, rms, {}, 5.0)


@pytest.mark.parametrize("rms", [{"u": 0.4}, {}])
def test_a_disturbance_larger_than_the_motion_is_a_misfit(rms: dict[str, float]) -> None:
    """0.7 m/s over the root of a second, in 1.4 s 0.83 m/s: the surge of the run spreads by 0.21 m/s."""
    (finding,) = misfit_disturbance({"u": 0.7, "r": 0.05}, [run(**rms)], 1.4)
    assert "misfit" in finding.message and "0.83 m/s within 1.4 s" in finding.evidence
    assert "0.21 m/s" in finding.evidence and "r:" not in finding.evidence
    assert finding.evidence.endswith("and the model misses it by 0.40 m/s") == bool(rms)


def test_a_disturbance_that_the_model_does_not_miss_is_not_determined() -> None:
    (finding,) = misfit_disturbance({"u": 0.7}, [run(u=0.07)], 1.4)
    assert finding.code == EXCEEDS_MOTION and "disturbance of u cannot be" in finding.message
    assert finding.advice.startswith("state the sensors' noise of u under [noise]")


def test_gusts_of_a_sea_and_states_of_no_run_are_none() -> None:
    assert misfit_disturbance({"u": 0.05, "r": 0.05, "v": 1.0}, [run(u=0.4)], 1.4) == ()


def test_states_of_instruments_and_thrusters_are_no_motion() -> None:
    late = Record.from_arrays("run", TIME, {"u": RUN["u"]})
    assert misfit_disturbance({"v_late": 9.0, "order_port": 9.0}, [replace(run(), simulated=late)], 1.4) == ()
