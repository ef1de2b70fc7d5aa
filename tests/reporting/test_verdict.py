"""The verdict is true on both sides, in both signs, for each number of runs."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.reporting.fabricated import zigzag

from seatrial.core.results import Divergence, Fit, Prediction
from seatrial.core.values import Record, Severity
from seatrial.reporting.verdict import error_text, extrapolation_limit, run_name, verdict, worst_errors

ANGLE = math.radians(20.0)


def held(fit: Fit) -> Prediction:
    return fit.validation[0]


def with_share(p: Prediction, share: float) -> Prediction:
    """The run with an error of heading that is this share of its standard deviation, the largest of all."""
    spread = math.degrees(float(np.nanstd(p.measured["psi"])))
    return replace(p, rms={"psi_deg": share * spread})


def with_runs(fit: Fit, *runs: Prediction) -> Fit:
    training = tuple(p for p in fit.predictions if p.role == "training")
    return replace(fit, predictions=(*training, *runs))


def test_implausible_coefficients_stand_beside_a_good_score(fit: Fit) -> None:
    odd = replace(fit.findings[0], code="unphysical-values", severity=Severity.WARNING)
    assert "its coefficients are implausible, so rely on it for such runs only" in verdict(
        replace(fit, findings=(odd,))
    )
    noted = replace(odd, severity=Severity.INFO)
    assert "implausible" not in verdict(replace(fit, findings=(noted,)))


def turned(record: Record) -> Record:
    """The same run with rudder and heading counted positive to port."""
    for name in ("delta", "psi"):
        channel = replace(record.channel(name).with_values(-record[name]), positive="port")
        record = record.with_channel(name, channel)
    return record


def turning_circle(angle: float) -> Record:
    """Heading and rudder [rad, positive to starboard] of a turn."""
    time = np.arange(0.0, 300.0, 0.5)
    delta = np.where(time > 20.0, angle, 0.0)
    psi = np.cumsum(np.where(time > 20.0, 0.05 * np.sign(angle), 0.0)) * 0.5
    return Record.from_arrays("turn", time, {"delta": delta, "psi": psi})


def test_one_run_is_named_by_its_manoeuvre_with_errors_and_limit(fit: Fit) -> None:
    p = held(fit)
    text = verdict(fit)
    assert text.startswith("Predicts a 25° zigzag that was not used, 4 min 00 s, ")
    assert f"{error_text('psi_deg', p.rms['psi_deg'])} in heading and" in text
    assert text.endswith("; beyond 30° rudder, or from approach speeds far from 0.80 m/s, the model extrapolates.")


def test_half_of_the_motion_on_either_side_reads_alike(fit: Fit) -> None:
    below, above = (verdict(with_runs(fit, with_share(held(fit), share))) for share in (0.49, 0.51))
    start = "Predicts a 25° zigzag that was not used, 4 min 00 s, roughly: to "
    assert below.startswith(start) and above.startswith(start)


@pytest.mark.parametrize(("share", "text"), [
    (0.05, ", 4 min 00 s, closely: to "), (0.29, ", 4 min 00 s, well: to "), (0.31, ", 4 min 00 s, roughly: to "),
    (0.71, ", 4 min 00 s, poorly: to "), (1.01, "Does not predict a 25° zigzag that was not used: "),
])  # fmt: skip
def test_the_error_as_a_share_of_the_motion_is_graded(fit: Fit, share: float, text: str) -> None:
    p = with_share(held(fit), share)
    assert text in verdict(with_runs(fit, p))
    assert error_text("psi_deg", p.rms["psi_deg"]) in verdict(with_runs(fit, p))


def test_of_several_runs_those_that_are_missed_are_named(fit: Fit) -> None:
    p = held(fit)
    first, second = (replace(with_share(p, share), record=name) for name, share in (("one", 0.8), ("two", 0.2)))
    text = verdict(with_runs(fit, first, second))
    assert text.startswith("Of 2 runs that were not used, 4 min 00 s each, one is poorly predicted, to ")
    own, others = (error_text("psi_deg", p.rms["psi_deg"]) for p in (first, second))
    assert f"one is poorly predicted, to {own} in heading" in text and f"; the other well: to {others} in" in text
    lost = with_share(first, 1.2)
    assert ", one and two are not predicted, to " in verdict(with_runs(fit, lost, replace(lost, record="two")))
    assert ", 4 min 00 s each, well or better: to " in verdict(with_runs(fit, second, replace(second, record="one")))


def test_a_repeat_of_a_fitted_run_is_called_one(fit: Fit) -> None:
    p = held(fit)
    trained = next(one for one in fit.predictions if one.role == "training")
    text = verdict(with_runs(fit, replace(p, measured=trained.measured)))
    assert f"; it is a repeat of {trained.record}, which was fitted: it does not test other manoeuvres" in text
    assert "a repeat of" not in verdict(fit)
    both = verdict(with_runs(fit, replace(p, measured=trained.measured), replace(p, record="other")))
    assert "; 1 of them repeats a fitted manoeuvre" in both


def test_of_several_runs_the_worst_counts(fit: Fit) -> None:
    p = held(fit)
    worse = replace(p, record="other", rms=p.rms | {"psi_deg": 9.87, "position_m": 0.01})
    text = verdict(with_runs(fit, p, worse))
    assert text.startswith("Predicts 2 runs that were not used, 4 min 00 s each, roughly or better: to 9.9° in ")
    assert "at worst" in text and error_text("position_m", p.rms["position_m"]) in text


def test_a_run_that_diverges_is_not_predicted(fit: Fit) -> None:
    p = replace(held(fit), divergence=Divergence(70.0, 65.0, "r"))
    assert "Does not predict a 25° zigzag that was not used: the simulation diverges after 65.0 s of 4 min 00 s" in (
        verdict(with_runs(fit, p))
    )
    both = verdict(with_runs(fit, p, replace(held(fit), record="b")))
    assert both.startswith("Of 2 runs that were not used, 1 cannot be predicted")


def test_without_a_held_out_run_nothing_is_claimed_of_predictions(fit: Fit) -> None:
    text = verdict(with_runs(fit))
    assert text.startswith("Reproduces the 3 runs it was fitted to, to ")
    assert "no run was held out to test its predictions" in text


def test_a_fit_of_spectra_alone_claims_nothing_of_runs(fit: Fit) -> None:
    assert verdict(replace(fit, predictions=())).startswith("Nothing is said of predictions: no run was simulated")


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_side_of_a_turn_is_that_of_the_ship(fit: Fit, sign: float) -> None:
    record = turning_circle(sign * ANGLE)
    side = "starboard" if sign > 0 else "port"
    for one in (record, turned(record)):
        assert run_name(replace(held(fit), measured=one)) == f"a turning circle to {side} with 20° rudder"


def test_a_run_without_heading_keeps_its_name(fit: Fit) -> None:
    p = held(fit)
    assert run_name(replace(p, measured=p.measured.without("psi"))) == f"{p.record}, a run"


@pytest.mark.parametrize(("port", "starboard", "text"), [
    (30.0, 30.0, "beyond 30° rudder the model extrapolates"),
    (5.0, 35.0, "beyond 35° rudder to starboard and 5° to port the model extrapolates"),
    (35.0, 5.0, "beyond 5° rudder to starboard and 35° to port the model extrapolates"),
    (0.0, 0.0, ""),
])  # fmt: skip
def test_the_limit_of_the_rudder_is_that_of_each_side(fit: Fit, port: float, starboard: float, text: str) -> None:
    record = zigzag("z", 10.0)
    delta = np.radians(np.where(np.arange(len(record)) % 2, -port, starboard))
    moved = record.with_channel("delta", record.channel("delta").with_values(delta))
    for one in (moved, turned(moved)):
        without_speed = one.without("u")
        runs = tuple(replace(p, measured=without_speed) for p in fit.predictions if p.role == "training")
        assert extrapolation_limit(replace(fit, predictions=runs)) == text


@pytest.mark.parametrize(("factor", "text"), [
    (1.05, "beyond 30° rudder, or from approach speeds far from 0.81 m/s, the model extrapolates"),
    (1.3, "beyond 30° rudder the model extrapolates"),
])  # fmt: skip
def test_runs_from_one_speed_say_so(fit: Fit, factor: float, text: str) -> None:
    first, *rest = (p for p in fit.predictions if p.role == "training")
    u = first.measured.channel("u")
    faster = first.measured.with_channel("u", u.with_values(factor * u.values))
    assert extrapolation_limit(replace(fit, predictions=(replace(first, measured=faster), *rest))) == text
    (one, *_) = rest
    assert "approach speeds" not in extrapolation_limit(replace(fit, predictions=(one,))), "a single run shows no more"


def test_without_a_rudder_the_speed_limits(fit: Fit) -> None:
    runs = tuple(replace(p, measured=p.measured.without("delta")) for p in fit.predictions if p.role == "training")
    assert extrapolation_limit(replace(fit, predictions=runs)).endswith(" m/s the model extrapolates")
    bare = tuple(replace(p, measured=p.measured.without("delta", "u")) for p in fit.predictions)
    assert extrapolation_limit(replace(fit, predictions=bare)) == ""


def test_errors_have_their_units() -> None:
    assert error_text("psi_deg", 6.26) == "6.3°" and error_text("position_m", 5.6) == "5.6 m"
    assert error_text("r", math.radians(0.5)) == "0.50 deg/s" and error_text("u", 0.0371) == "0.037 m/s"
    assert worst_errors([]) == ""
