"""A disturbance larger than the motion is called the model's misfit."""

import numpy as np

from seatrial.core.values import Record
from seatrial.estimation.identify.misfit_disturbance import misfit_disturbance

TIME = np.arange(0.0, 100.0, 0.2)
RUN = Record.from_arrays("run", TIME, {"u": 4.0 + 0.3 * np.sin(TIME), "r": 0.2 * np.sin(0.5 * TIME)})


def test_a_disturbance_larger_than_the_motion_is_a_misfit() -> None:
    """0.7 m/s over the root of a second, in 1.4 s 0.83 m/s: the surge of the run spreads by 0.21 m/s."""
    (finding,) = misfit_disturbance({"u": 0.7, "r": 0.05}, [RUN], 1.4)
    assert "0.83 m/s within 1.4 s" in finding.evidence
    assert "0.21 m/s" in finding.evidence
    assert "r:" not in finding.evidence


def test_gusts_of_a_sea_and_states_of_no_run_are_none() -> None:
    assert misfit_disturbance({"u": 0.05, "r": 0.05, "v": 1.0}, [RUN], 1.4) == ()
