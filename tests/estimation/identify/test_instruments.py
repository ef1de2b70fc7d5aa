"""A sway velocity that is recorded at another place than stated is named with that place."""

from dataclasses import replace

import numpy as np
import pytest
from tests.reporting.fabricated import zigzag

from seatrial.core.results import Prediction
from seatrial.estimation.identify.instruments import antenna_findings

LENGTH = 9.8
RUN = zigzag("run", 20.0)


def predicted(x: float, noise: float, rng: np.random.Generator, simulated_share: float = 1.0) -> Prediction:
    """A run whose sway is that of a receiver x forward of the origin [m], with noise [m/s]."""
    channel = RUN.channel("v")
    measured = RUN["v"] + x * RUN["r"] + noise * rng.standard_normal(len(RUN))
    simulated = RUN.with_channel("v", channel.with_values(simulated_share * RUN["v"]))
    return Prediction("run", "training", RUN.with_channel("v", channel.with_values(measured)), simulated, {}, {}, 5.0)


@pytest.mark.parametrize(("x", "place"), [(2.0, "2.0 m forward"), (-3.0, "3.0 m aft")])
def test_the_place_is_that_of_the_receiver(x: float, place: str, rng: np.random.Generator) -> None:
    (finding,) = antenna_findings([predicted(x, 0.01, rng)], LENGTH)
    assert finding.code == "antenna-place" and f"as if it were measured {place} of" in finding.message
    assert "antenna = { x = ..., y = ... }" in finding.advice


def test_noise_a_small_lever_and_a_run_without_sway_are_no_finding(rng: np.random.Generator) -> None:
    assert antenna_findings([predicted(0.0, 0.05, rng)], LENGTH) == ()
    assert antenna_findings([predicted(0.1, 0.0, rng)], LENGTH) == ()
    one = predicted(2.0, 0.01, rng)
    assert antenna_findings([replace(one, measured=one.measured.without("v"))], LENGTH) == ()
    assert antenna_findings([], LENGTH) == antenna_findings([one], 0.0) == ()
