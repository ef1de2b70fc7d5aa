"""What a fit says of offsets over sessions: expected value, deviation, and whether they follow the helm."""

import numpy as np
import pytest

from seatrial.core.results import OffsetPopulation
from seatrial.data.trial import EstimateSettings
from seatrial.estimation.estimate import EstimatorOptions, Runs, estimate_model
from seatrial.estimation.identify.fit_result import offset_populations
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.simulate.steer import manoeuvre

HELM = np.array([8.0, 12.0, 16.0, 20.0, 24.0])
ZEROS = np.radians([1.4, 1.15, 1.0, 0.75, 0.6])
"""Zeros of the rudder that fall with the helm, 0.2 deg for a standard deviation of it."""


def populations(covariates: dict[str, str]) -> tuple[OffsetPopulation, ...]:
    """Of zigzags whose recorded rudder angle lacks the zero of their session."""
    truth = nomoto().with_values({"K": 0.15, "T": 8.0, "U": 1.0})
    records = []
    for i, (helm, zero) in enumerate(zip(HELM, ZEROS, strict=True)):
        run = manoeuvre(truth, programme(f"zigzag:{helm:g}/10"), dt=0.5, speed=1.0, duration=90.0).renamed(f"run_{i}")
        records.append(run.with_channel("delta", run.channel("delta").with_values(run["delta"] - zero)))
    offsets, timing = {"delta": np.radians(2.0)}, {"delta": 0.0}
    settings = EstimateSettings(method="output-error", offsets=offsets, covariates=covariates, delays=timing)
    runs = Runs.one_session_each(records, 7.0)
    return offset_populations(estimate_model(truth, runs, settings, EstimatorOptions(workers=1)))


def test_mean_and_deviation_stand_in_the_fit() -> None:
    (zero,) = populations({})
    assert (zero.name, zero.unit, zero.covariate, zero.slope) == ("delta zero", "rad", "", None)
    assert zero.mean == pytest.approx(ZEROS.mean(), rel=0.02)
    assert zero.deviation == pytest.approx(np.std(ZEROS, ddof=1), rel=0.5)
    assert zero.sentence.startswith("delta zero of a new session: 0.9")
    assert zero.sentence.endswith("deg standard deviation between sessions.")


def test_a_slope_stands_with_its_error_and_what_it_is_worth() -> None:
    (zero,) = populations({"delta": "delta"})
    assert zero.covariate == "delta"
    assert zero.slope is not None
    assert zero.slope_standard_error is not None
    assert np.degrees(zero.slope) == pytest.approx(-0.28, abs=0.05)  # of all five, by a line through them
    assert abs(zero.slope) > 3.0 * zero.slope_standard_error
    assert "rms of delta." in zero.sentence


def test_a_slope_within_its_error_is_said_to_be_chance() -> None:
    slope, error = np.radians([-0.13, 0.09])
    zero = OffsetPopulation("delta zero", "rad", 0.016, 0.0016, 0.005, "delta", float(slope), float(error))
    assert "changes by \N{MINUS SIGN}0.13 deg (standard error 0.090)" in zero.sentence.replace("-", "\N{MINUS SIGN}")
    assert zero.sentence.endswith("which is no more than chance explains.")
