"""A disturbance that no candidate describes: the fit says so, and its interval covers the spread between candidates."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from standard_craft import NOMOTO

from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.fit import Estimation, estimate_model
from seatrial.estimation.estimate.settings import EstimatorOptions
from seatrial.problems import disturbed_craft

TONES = (0.3, 0.5, 0.9, 1.6)
"""Frequencies [rad/s] of four swells: the candidates hold two."""


def four_tones(rows: int, count: int, _: object, step: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """A disturbance worth half of the rudder in each swell, (rows, count)."""
    time = step * np.arange(rows)[:, None]
    phases = 2.0 * math.pi * rng.random((len(TONES), count))
    return 0.5 * sum(np.sin(w * time + phase) for w, phase in zip(TONES, phases, strict=True))


@pytest.fixture(scope="module")
def estimation() -> Estimation:
    craft = NOMOTO
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(disturbed_craft, "coloured", four_tones)
        (run,) = disturbed_craft.independent_nomoto(
            craft, disturbed_craft.Disturbance(0.5, 5.0), 1, np.random.default_rng(2), is_closed=False, seconds=240.0
        )
    model = craft.model.with_values(dict(craft.guess))
    return estimate_model(model, Runs.one_session_each([run], craft.length), options=EstimatorOptions(workers=1))


def test_the_fit_does_not_say_that_its_innovations_are_white(estimation: Estimation) -> None:
    noise = estimation.noise_model
    assert not noise.is_white
    assert not any(candidate.is_white for candidate in noise.candidates)
    assert any("waves on the sensors" in candidate.name for candidate in noise.candidates)
    assert "innovations are not white" in noise.text
    assert "intervals cover the spread between the disturbance models" in noise.text


def test_its_interval_covers_the_spread_between_the_candidates(estimation: Estimation) -> None:
    assert estimation.interval.meaning.endswith("with the spread of disturbance models")
    error = estimation.estimate.common_parameters[:2] - [0.15, 8.0]
    assert np.all(np.abs(error) <= estimation.interval.half_width[:2])
