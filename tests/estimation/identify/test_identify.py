"""A trial in, a fit out: roles, offsets, settings, findings, and what is refused."""

import math

import numpy as np
import pytest
from tests.estimation.identify.conftest import NOISE, TRUTH, WriteTrial

import seatrial
from seatrial.core.values import Record
from seatrial.data.folder.result_folder import model_of_fit
from seatrial.data.trial import FitCriterion, load_trial
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.fit import with_segment_seconds
from seatrial.estimation.identify import identify

ZEROS = {"a": 0.02, "b": -0.03, "c": 0.0, "v_1": 0.05}
OFFSETS = "[estimate]\noffsets = { delta = { sd = 3, unit = 'deg' } }\ndelays = { delta = 0 }"


def test_training_runs_are_fitted_and_validation_runs_predicted(trial_of: WriteTrial) -> None:
    fit = identify(load_trial(trial_of({"a": 0.0, "b": 0.0, "v_1": 0.0, "x_1": 0.5})))
    assert {p.record: p.role for p in fit.predictions} == {"a": "training", "b": "training", "v_1": "validation"}
    assert [p.record for p in fit.validation] == ["v_1"]
    for c in fit.coefficients:
        if not c.fixed:
            assert c.truth == TRUTH[c.name]
            assert c.estimate == pytest.approx(c.truth, rel=0.01)
            assert c.standard_error is not None
            assert abs(c.estimate - TRUTH[c.name]) < 4 * c.standard_error
    levels = {n.channel: n.standard_deviation for n in fit.channel_noise}
    assert levels == pytest.approx(NOISE, rel=0.1)
    assert all(n.whiteness_p > 1e-3 for n in fit.channel_noise)
    assert fit.solution.status.is_success
    assert fit.validation[0].rms["psi_deg"] < 2 * math.degrees(NOISE["psi"])


def test_rudder_zeros_come_back_and_strangers_get_the_mean(trial_of: WriteTrial) -> None:
    fit = identify(load_trial(trial_of(ZEROS, more=OFFSETS)))
    zeros = {o.group: o for o in fit.offsets}
    assert set(zeros) == {"a", "b", "c"}
    for run, zero in zeros.items():
        assert zero.name == "delta zero"
        assert zero.unit == "rad"
        assert zero.standard_error is not None
        assert zero.standard_error < 0.005
        assert zero.estimate == pytest.approx(ZEROS[run], abs=0.002 + 4 * zero.standard_error)
    (unseen,) = fit.validation
    drift = np.polyfit(unseen.measured.time, unseen.measured["psi"] - unseen.simulated["psi"], 1)[0]
    mean = np.mean([z.estimate for z in zeros.values()])
    assert drift == pytest.approx(TRUTH["K"] * (ZEROS["v_1"] - mean), rel=0.1)


def test_runs_of_one_session_share_their_zero(trial_of: WriteTrial) -> None:
    runs = {"t_day1_a": 0.03, "t_day1_b": 0.03, "t_day2_a": -0.02, "v_day1_c": 0.03}
    fit = identify(load_trial(trial_of(runs, layout="session = '*_{day}_*'", more=OFFSETS)))
    assert [o.group for o in fit.offsets] == ["day1", "day2"]
    np.testing.assert_allclose([o.estimate for o in fit.offsets], [0.03, -0.02], atol=0.002)
    # the model file holds them: the held-out run of a fitted day is simulated as the report shows it
    (unseen,) = fit.validation
    again = seatrial.predict(model_of_fit(fit), unseen.measured, "day1").simulated
    np.testing.assert_allclose(again["psi"], unseen.simulated["psi"], atol=2e-3)
    other = seatrial.predict(model_of_fit(fit), unseen.measured, "day2").simulated
    assert np.abs(other["psi"] - unseen.simulated["psi"]).max() > 0.1


def test_nothing_of_a_validation_run_is_fitted(trial_of: WriteTrial) -> None:
    """Its samples after the first seconds may say anything: the prediction stays bit for bit."""
    path = trial_of({"a": 0.0, "b": 0.0, "v_1": 0.0})
    one = identify(load_trial(path))
    lines = (path.parent / "v_1.csv").read_text().splitlines()
    for i in range(200, len(lines)):
        time, u, r, psi, delta = lines[i].split(",")
        lines[i] = ",".join([time, u, str(float(r) + 0.001), str(float(psi) + 0.01), delta])
    (path.parent / "v_1.csv").write_text("\n".join(lines) + "\n")
    two = identify(load_trial(path))
    np.testing.assert_array_equal(one.validation[0].simulated["psi"], two.validation[0].simulated["psi"])
    assert one.validation[0].rms != two.validation[0].rms
    assert one.validation[0].initial_seconds == pytest.approx(4.0, rel=0.01)


def test_the_trials_wishes_become_settings(trial_of: WriteTrial) -> None:
    more = """
[noise]
psi = { sd = 1, unit = "deg" }

[estimate]
method = "output-error"
robust = true
channels = ["psi"]
offsets = { delta = 0.01 }
gains = ["delta"]
current = 0.2
"""
    trial = load_trial(trial_of({"a": 0.0}, more=more))
    settings = trial.estimate
    assert settings.criterion is FitCriterion.OUTPUT_ERROR
    assert settings.robust is True
    assert settings.channels == ("psi",)
    assert trial.noise == pytest.approx({"psi": math.radians(1.0)})
    assert (settings.offsets, settings.gains, settings.delays) == ({"delta": 0.01}, {"delta": None}, {})
    assert settings.current == 0.2


def test_segment_lengths_are_counted_in_ship_lengths(trial_of: WriteTrial) -> None:
    trial = load_trial(trial_of({"a": 0.0}, more="[estimate]\nsegment_lengths = 3.0"))
    record = Record.from_arrays("a", np.arange(5.0), {"u": np.full(5, 2.0)})
    runs = Runs.one_session_each([record], trial.ship.length)
    settings = with_segment_seconds(trial.estimate, trial.model, runs)
    assert (settings.segment_s, settings.segment_lengths) == (pytest.approx(3.0 * 8.0 / 2.0), None)
    assert with_segment_seconds(settings, trial.model, runs) is settings


def test_a_stated_segment_is_used_and_named(trial_of: WriteTrial) -> None:
    fit = identify(load_trial(trial_of({"a": 0.0, "b": 0.0}, more="[estimate]\nsegment_s = 20.0")))
    assert fit.method.criterion == "output error, multiple shooting with segments of 20 s"
    assert fit.method.settings["segments"] == 2 * round(499 * 0.5 / 20.0)


def test_a_bound_that_is_hit_is_a_finding(trial_of: WriteTrial) -> None:
    fit = identify(load_trial(trial_of({"a": 0.0}, model="bounds = { T = [9.0, 50.0] }")))
    (hit,) = [f for f in fit.findings if f.code == "bound-hit"]
    assert "T" in hit.message
    assert "[model.bounds]" in hit.advice
    assert next(c.estimate for c in fit.coefficients if c.name == "T") == 9.0


def test_the_same_trial_gives_the_same_bits(trial_of: WriteTrial) -> None:
    path = trial_of({"a": 0.0})
    one, two = (identify(load_trial(path)) for _ in range(2))
    assert [c.estimate for c in one.coefficients] == [c.estimate for c in two.coefficients]
    np.testing.assert_array_equal(one.covariance, two.covariance)
