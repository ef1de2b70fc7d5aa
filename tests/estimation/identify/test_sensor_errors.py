"""Errors of instruments that nobody stated, in the logs of boats simulated by their own equations."""

import math
from dataclasses import replace

import numpy as np
import pytest
from benchmarks.independent_ships import CRAFTS, FAULTS, posed

from seatrial.core.results import Fit
from seatrial.data.trial import EstimateMethod, EstimateSettings
from seatrial.estimation.estimate import Runs, estimate_model
from seatrial.estimation.identify import identify
from seatrial.estimation.identify.sensor_errors import instrument_errors, with_undetected_sensor_errors

BOAT = CRAFTS["Nomoto boat"]


def fit_of(fault: str) -> Fit:
    """The boat's fit by output error."""
    trial = posed(BOAT, FAULTS[fault], 3)
    return identify(replace(trial, estimate=replace(trial.estimate, method=EstimateMethod.OUTPUT_ERROR)))


@pytest.mark.parametrize(
    ("fault", "name", "truth"),
    [
        ("compass behind a filter of 0.5 s", "lag_heading", 0.5),
        ("yaw rate biased by 0.8 deg/s", "r_bias", math.radians(0.8)),
        ("yaw rate 2 % high", "r_scale", 0.02),
    ],
)
def test_an_error_that_two_channels_show_is_estimated_and_named(fault: str, name: str, truth: float) -> None:
    fit = fit_of(fault)
    found = {c.name: c for c in fit.coefficients}
    assert abs(found[name].estimate - truth) < 4.0 * (found[name].standard_error or 0.0)
    for c, value in BOAT.truth.items():
        assert abs(found[c].estimate - value) < 4.0 * (found[c].standard_error or 0.0)
    (finding,) = (f for f in fit.findings if f.code == "sensor-error")
    assert name in finding.evidence


def test_instruments_without_an_error_have_none() -> None:
    fit = fit_of("clean")
    assert "sensor-error" not in {f.code for f in fit.findings}
    assert [c.name for c in fit.coefficients if not c.fixed] == list(BOAT.truth)


def test_what_nothing_shows_is_in_the_intervals() -> None:
    """The heading alone cannot show that the compass is late: it shows with the rate of turn, and less where that is
    coarser."""
    records = tuple(run.raw_record() for run in posed(BOAT, FAULTS["clean"], 0).runs)
    settings = EstimateSettings(method=EstimateMethod.OUTPUT_ERROR).with_known_timing(["delta"])
    estimation = estimate_model(posed(BOAT, FAULTS["clean"], 0).model, Runs.one_session_each(records, 2.0), settings)
    known = instrument_errors(estimation, records, 2.0)
    assert known is not None
    undetected = np.array([e.undetected for e in known.errors])
    values, covariance, _ = known.estimate(range(len(undetected)), undetected)
    assert np.all(np.abs(values) < 4.0 * np.sqrt(np.diag(covariance)))
    widened = with_undetected_sensor_errors(estimation, known)
    grown = widened.interval.standard_error / estimation.interval.standard_error
    assert np.all(grown >= 1.0) and np.max(grown) > 1.05
    moved = known.by_errors[:3] @ values  # within what they are widened by
    assert np.all(
        np.abs(moved) <= np.sqrt(widened.interval.standard_error**2 - estimation.interval.standard_error**2)[:3]
    )
