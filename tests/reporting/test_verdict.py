"""The verdict is true on both sides, in both signs, for each number of runs."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.reporting.fabricated import zigzag

from seatrial.core.results import Divergence, Fit, Prediction
from seatrial.core.values import Record
from seatrial.reporting.verdict import error_text, extrapolation_limit, run_name, share_sentence, verdict, worst_errors

ANGLE = math.radians(20.0)


def held(fit: Fit) -> Prediction:
    return fit.validation[0]


def with_runs(fit: Fit, *runs: Prediction) -> Fit:
    training = tuple(p for p in fit.predictions if p.role == "training")
    return replace(fit, predictions=(*training, *runs))


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
    assert text.startswith("Predicts a 25° zigzag that was not used, 4 min 00 s, to ")
    assert f"{error_text('psi_deg', p.rms['psi_deg'])} in heading and" in text
    assert text.endswith("; beyond 30° rudder the model extrapolates.")


def test_a_run_that_is_lost_before_its_end_is_not_called_predicted(fit: Fit) -> None:
    p = held(fit)
    spread = math.degrees(float(np.nanstd(p.measured["psi"])))
    lost, kept = (replace(p, rms=p.rms | {"psi_deg": share * spread}) for share in (0.51, 0.49))
    text = verdict(with_runs(fit, lost))
    assert text.startswith("Does not follow a 25° zigzag that was not used, to its end: ")
    assert f"{error_text('psi_deg', 0.51 * spread)} in heading" in text
    assert "over 4 min 00 s" in text
    assert verdict(with_runs(fit, kept)).startswith("Predicts a 25° zigzag")
    assert share_sentence([kept]).startswith(
        "in heading 0.49 of the standard deviation of the motion itself (above 0.5"
    )
    assert share_sentence([kept, lost]).startswith("in heading 0.51 of ")
    assert share_sentence([]) == ""


def test_of_several_runs_those_that_are_lost_are_named(fit: Fit) -> None:
    p = held(fit)
    spread = math.degrees(float(np.nanstd(p.measured["psi"])))
    first, second = (replace(p, record=name, rms=p.rms | {"psi_deg": share * spread})
                     for name, share in (("one", 0.6), ("two", 0.2)))  # fmt: skip
    text = verdict(with_runs(fit, first, second))
    assert text.startswith("Of 2 runs that were not used, 4 min 00 s each, one is not followed to its end, to ")
    assert ", one and two are not followed to their end, to " in verdict(
        with_runs(fit, first, replace(first, record="two"))
    )


def test_of_several_runs_the_worst_counts(fit: Fit) -> None:
    p = held(fit)
    worse = replace(p, record="other", rms=p.rms | {"psi_deg": 9.87, "position_m": 0.01})
    text = verdict(with_runs(fit, p, worse))
    assert text.startswith("Predicts 2 runs that were not used, 4 min 00 s each, to 9.9° in heading and ")
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
        runs = tuple(replace(p, measured=one) for p in fit.predictions if p.role == "training")
        assert extrapolation_limit(replace(fit, predictions=runs)) == text


def test_without_a_rudder_the_speed_limits(fit: Fit) -> None:
    runs = tuple(replace(p, measured=p.measured.without("delta")) for p in fit.predictions if p.role == "training")
    assert extrapolation_limit(replace(fit, predictions=runs)).endswith(" m/s the model extrapolates")
    bare = tuple(replace(p, measured=p.measured.without("delta", "u")) for p in fit.predictions)
    assert extrapolation_limit(replace(fit, predictions=bare)) == ""


def test_errors_have_their_units() -> None:
    assert error_text("psi_deg", 6.26) == "6.3°" and error_text("position_m", 5.6) == "5.6 m"
    assert error_text("r", math.radians(0.5)) == "0.50 deg/s" and error_text("u", 0.0371) == "0.037 m/s"
    assert worst_errors([]) == ""
