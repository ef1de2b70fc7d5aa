"""Errors of instruments that nobody stated, in the logs of boats simulated by their own equations."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from benchmarks.independent_ships import CRAFTS, FAULTS, posed

from seatrial.core.results import Fit
from seatrial.core.values import Record
from seatrial.data.trial import EstimateMethod, EstimateSettings
from seatrial.estimation.estimate import Estimation, Runs, estimate_model
from seatrial.estimation.identify import identify, instruments
from seatrial.estimation.identify.instruments import instrument_errors, with_undetected_sensor_errors
from seatrial.estimation.identify.score_test import output_error_estimate, own_criterion
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.sensors import Sensors

BOAT = CRAFTS["Nomoto boat"]
GAIN = 0.14
"""Of the boat with an autopilot, 1/s."""


def fit_of(fault: str) -> Fit:
    """The boat's fit by output error."""
    trial = posed(BOAT, FAULTS[fault], 3)
    return identify(replace(trial, estimate=replace(trial.estimate, method=EstimateMethod.OUTPUT_ERROR)))


@pytest.mark.long(every=3)
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


def test_a_receiver_that_is_late_for_a_craft_that_turns_fast_is_moved() -> None:
    """0.7 s of a boat whose thrust rises within 0.3 s: a term of first order of the whole lag shows half of it."""
    craft = CRAFTS["USV with two thrusters"]
    trial = posed(craft, FAULTS["receiver 0.7 s late"], 3)
    fit = identify(trial)
    found = {c.name: c for c in fit.coefficients}
    assert found["lag_receiver"].estimate == pytest.approx(0.7, abs=0.03)
    for c, value in craft.truth.items():
        assert abs(found[c].estimate - value) < 4.0 * (found[c].standard_error or 0.0)
    (finding,) = (f for f in fit.findings if f.code == "sensor-error")
    assert "late = {receiver = 0.6}" in finding.advice or "late = {receiver = 0.8}" in finding.advice
    assert f"lag_receiver {found['lag_receiver'].estimate:.3f} s" in finding.evidence, "that of the coefficient"


def test_instruments_without_an_error_have_none() -> None:
    fit = fit_of("clean")
    assert "sensor-error" not in {f.code for f in fit.findings}
    assert [c.name for c in fit.coefficients if not c.fixed] == list(BOAT.truth)


def boat_records(lag: float, waves: float = 0.0) -> tuple[Record, ...]:
    """The boat's logs, the yaw rate late by `lag` [s], waves of that rms of heading [rad] on compass and gyro."""
    rng, records = np.random.default_rng(7), []
    omega = np.linspace(1.3, 1.9, 12)  # rad/s
    size = waves * math.sqrt(2.0 / len(omega))
    for one in (run.raw_record() for run in posed(BOAT, FAULTS["clean"], 0).runs):
        phase = np.multiply.outer(one.time, omega) + rng.uniform(0.0, 2.0 * math.pi, len(omega))
        r = np.interp(one.time - lag, one.time, one["r"]) + (size * omega * np.cos(phase - omega * lag)).sum(axis=1)
        psi = one["psi"] + (size * np.sin(phase)).sum(axis=1)
        shown = {"psi": one.channel("psi").with_values(psi), "r": one.channel("r").with_values(r)}
        records.append(replace(one, channels={**one.channels, **shown}))
    return tuple(records)


def estimation_of(records: tuple[Record, ...], method: EstimateMethod, delays: Mapping[str, float]) -> Estimation:
    """The boat's estimate."""
    settings = EstimateSettings(method=method, delays=dict(delays))
    return estimate_model(posed(BOAT, FAULTS["clean"], 0).model, Runs.one_session_each(records, 2.0), settings)


def test_what_a_pair_leaves_open_is_in_the_intervals() -> None:
    """Heading and yaw rate show their lag from one another; a lag of both is the delay of the rudder."""
    records = boat_records(0.0)
    estimation = estimation_of(records, EstimateMethod.OUTPUT_ERROR, {})
    information = instrument_errors(estimation.estimate, records, 2.0, {})
    assert information is not None
    values, covariance, _ = information.test.joint(information.open_prior)
    assert np.all(np.abs(values) < 4.0 * np.sqrt(np.diag(covariance)))
    lags = [e.unit == "s" for e in information.errors]
    assert np.sum(values[lags]) == pytest.approx(0.0, abs=1e-9)
    widened = with_undetected_sensor_errors(estimation, information)
    grown = widened.interval.standard_error / estimation.interval.standard_error
    assert np.all(grown >= 1.0) and np.max(grown) < 1.5
    moved = information.test.by_candidates[:2] @ values  # within what they are widened by
    assert np.all(
        np.abs(moved) <= np.sqrt(widened.interval.standard_error**2 - estimation.interval.standard_error**2)[:2]
    )


@pytest.mark.parametrize(("length", "names"), [(2.0, {"x_antenna", "y_antenna"}), (None, set[str]())])
def test_an_antenna_whose_place_is_stated_is_no_suspect(length: float | None, names: set[str]) -> None:
    """A model that is not the craft's would have it elsewhere; whoever measured it knows better."""
    track = {channel: np.linspace(0.0, 1.0, 20) for channel in ("x0", "y0", "psi")}
    record = Record.from_arrays("run", np.arange(20.0), track)
    motion, timing = (
        instruments._Motion(track, track),
        instruments._Timing((record,), {}, dict.fromkeys(track, 0.1), is_known=True),
    )
    suspects = instruments._of_receiver(motion, timing, Sensors(), length)
    assert {e.name for suspect in suspects for e in suspect.errors} - {"lag_receiver"} == names


@pytest.mark.parametrize(("noise", "negligible"), [(0.5, 0.2), (0.01, 0.1), (0.015, 0.15)])
def test_a_lag_counts_where_it_moves_its_channel_by_more_than_the_noise(noise: float, negligible: float) -> None:
    """Of a craft that turns fast a tenth of a second does; half a sample is left open in any case."""
    time = np.arange(100) * 0.2
    record = Record.from_arrays("run", time, {"psi": time})
    timing = instruments._Timing((record,), {}, {"psi": noise}, is_known=False)
    slope = 0.1 * math.sqrt(2.0) * np.sin(2.0 * np.pi * np.arange(100) / 50.0)
    (error,) = timing.late(instruments.Late.HEADING, {"psi": slope}, 0.0).errors
    assert error.negligible == pytest.approx(negligible)


@pytest.mark.long
def test_waves_on_compass_and_gyro_show_their_lag() -> None:
    """Prediction error with the waves in its model knows the lag far better than residuals of the craft alone."""
    records = boat_records(0.02, math.radians(3.0))
    estimation = estimation_of(records, EstimateMethod.PREDICTION_ERROR, {})
    assert estimation.noise_model.waves
    spread = []
    for estimate in (own_criterion(estimation), output_error_estimate(estimation)):
        information = instrument_errors(estimate, records, 2.0, {})
        assert information is not None
        values, covariance, _ = information.test.joint(np.diag([e.deviation**2 for e in information.errors]))
        heading, rate = (information.test.names.index(n) for n in ("lag_heading", "lag_yaw_rate"))
        between = np.zeros(len(values))
        between[[rate, heading]] = 1.0, -1.0
        spread.append(math.sqrt(between @ covariance @ between))
        assert abs(between @ values - 0.02) < 4.0 * spread[-1]
    assert spread[0] < 0.01 and spread[0] < 0.2 * spread[1]


@pytest.mark.long(every=2)
@pytest.mark.parametrize("delays", [{"delta": 0.0}, {"psi": 0.0, "r": 0.0}])
def test_known_timing_leaves_no_lag_open(delays: dict[str, float]) -> None:
    """Its intervals are those of bias and scale alone, which the pair shows."""
    records = boat_records(0.0)
    estimation = estimation_of(records, EstimateMethod.OUTPUT_ERROR, delays)
    information = instrument_errors(estimation.estimate, records, 2.0, delays)
    assert information is not None
    covariance = information.test.joint(information.open_prior)[1]
    assert all(np.all(row == 0.0) == (e.unit == "s") for row, e in zip(covariance, information.errors, strict=True))
    widened = with_undetected_sensor_errors(estimation, information)
    assert np.all(widened.interval.standard_error[:2] <= 1.2 * estimation.interval.standard_error[:2])


def test_the_timing_of_a_measured_channel_can_be_known() -> None:
    records = boat_records(0.0)
    estimation = estimation_of(records, EstimateMethod.OUTPUT_ERROR, {})
    information = instrument_errors(estimation.estimate, records, 2.0, {"r": 0.0})
    assert information is not None
    prior = dict(zip(information.test.names, np.diag(information.open_prior), strict=True))
    assert prior["lag_yaw_rate"] == 0.0 and prior["lag_heading"] == pytest.approx(0.1**2 / 12.0)


def test_where_a_slewing_rudder_moves_within_a_sample_is_in_the_intervals() -> None:
    """An autopilot on the recorder's clock moves the rudder at the start of each sample, which straight lines miss."""
    record = loop_record(np.random.default_rng(1))
    model = nomoto().with_values({"K": 0.12, "T": 7.0})
    model = model.with_parameters(model.parameters.only_free(["K", "T"]))
    settings = EstimateSettings(method=EstimateMethod.OUTPUT_ERROR)
    estimation = estimate_model(model, Runs.one_session_each((record,), 10.0), settings)
    information = instrument_errors(estimation.estimate, (record,), 10.0, {})
    assert information is not None and [e.name for e in information.courses] == ["delta course"]
    widened = with_undetected_sensor_errors(estimation, information).interval.standard_error
    narrow = estimation.interval.standard_error
    error = abs(estimation.model.parameters["K"].value - GAIN)
    assert error > 2.5 * narrow[0] and error < 2.0 * widened[0]
    known = instrument_errors(estimation.estimate, (record,), 10.0, {"delta": 0.0})
    assert known is None or known.courses == ()


def loop_record(rng: np.random.Generator) -> Record:
    """The boat on courses by an autopilot of 2 Hz whose rudder slews at 4 deg/s, exact but for the compass's noise."""
    rudder, psi, r, course, order, h = 0.0, 0.0, 0.0, 0.0, 0.0, 0.005
    rows = []
    for step in range(120_000):
        if step % 12_000 == 0:
            course = math.radians(float(rng.uniform(-40.0, 40.0)))
        if step % 100 == 0:
            rows.append((psi + math.radians(0.05) * rng.standard_normal(), rudder))
            order = 1.0 * (course - psi + math.radians(0.3) * math.sin(0.9 * h * step)) - 4.0 * r
        rudder += float(np.clip(order - rudder, -math.radians(4.0) * h, math.radians(4.0) * h))
        r, psi = r + h * (GAIN * rudder - r) / 8.0, psi + h * r
    heading, angle = np.array(rows).T
    return Record.from_arrays("loop", 0.5 * np.arange(len(rows)), {"psi": heading, "delta": angle})
