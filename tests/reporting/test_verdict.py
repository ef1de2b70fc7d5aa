"""The verdict is true on both sides, in both signs, for each number of runs."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.reporting.fabricated import zigzag

from seatrial.core.results import Divergence, Fit, Prediction
from seatrial.core.values import Record, Severity
from seatrial.numerics.optimise import Status
from seatrial.reporting.key_facts import first_screen
from seatrial.reporting.verdict import (
    error_text,
    extrapolation_limit,
    graded_errors,
    repeat_clause,
    repeated_runs,
    run_name,
    verdict,
    worst_errors,
)  # fmt: skip

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
    assert verdict(replace(fit, findings=(odd,))).endswith("; its coefficients are implausible.")
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


def test_one_run_is_named_by_its_manoeuvre_with_its_errors(fit: Fit) -> None:
    rms = held(fit).rms
    errors = f"{error_text('psi_deg', rms['psi_deg'])} in heading and {error_text('position_m', rms['position_m'])}"
    text = verdict(fit)
    assert text.startswith("Predicts the held-out 25° zigzag ") and text.endswith(f": {errors} in position.")


@pytest.mark.parametrize(("share", "text"), [
    (0.05, "Predicts the held-out 25° zigzag closely: "), (0.29, "Predicts the held-out 25° zigzag well: "),
    (0.49, "Predicts the held-out 25° zigzag roughly: "), (0.51, "Predicts the held-out 25° zigzag roughly: "),
    (0.71, "Predicts the held-out 25° zigzag poorly: "), (1.01, "Does not predict the held-out 25° zigzag: "),
])  # fmt: skip
def test_the_error_as_a_share_of_the_motion_is_graded(fit: Fit, share: float, text: str) -> None:
    p = with_share(held(fit), share)
    assert verdict(with_runs(fit, p)) == f"{text}{error_text('psi_deg', p.rms['psi_deg'])} in heading."


def test_of_several_runs_the_worst_is_named(fit: Fit) -> None:
    p = held(fit)
    first, second = (replace(with_share(p, share), record=name) for name, share in (("one", 0.8), ("two", 0.2)))
    error = error_text("psi_deg", first.rms["psi_deg"])
    assert verdict(with_runs(fit, first, second)) == (
        f"Predicts poorly 1 of 2 held-out runs (one): {error} in heading; the other well."
    )
    missed = with_share(first, 1.2)
    text = verdict(with_runs(fit, missed, replace(missed, record="two")))
    assert text.startswith("Does not predict 2 of 2 held-out runs, one worst: ")
    both = verdict(with_runs(fit, second, replace(second, record="one")))
    assert both.startswith("Predicts 2 held-out runs well or better, two worst: ")


def test_a_repeat_of_a_fitted_run_is_called_one(fit: Fit) -> None:
    p = held(fit)
    trained = next(prediction for prediction in fit.predictions if prediction.role == "training")
    text = verdict(with_runs(fit, replace(p, measured=trained.measured)))
    assert text.endswith("; it repeats a fitted manoeuvre.") and "repeats" not in verdict(fit)
    both = verdict(with_runs(fit, replace(p, measured=trained.measured), replace(p, record="other")))
    assert both.endswith("; 1 repeats a fitted manoeuvre.")


def test_sentence_row_and_picture_show_the_errors_of_one_run(fit: Fit) -> None:
    p = held(fit)
    worse = replace(p, record="other", rms=p.rms | {"psi_deg": 9.87, "position_m": 0.01})
    several = with_runs(fit, p, worse)
    assert verdict(several) == (
        "Predicts 2 held-out runs roughly or better, other worst: 9.9° in heading and 0.010 m in position."
    )
    assert graded_errors(several).startswith("9.9° of ") and "and 0.010 m of " in graded_errors(several)
    assert first_screen(several, 10.0).caption.startswith("The worst held-out run, other: ")


def test_a_run_that_diverges_is_not_predicted(fit: Fit) -> None:
    p = replace(held(fit), divergence=Divergence(70.0, 65.0, "r"))
    text = verdict(with_runs(fit, p))
    assert text == "Does not predict the held-out 25° zigzag: the simulation diverges after 65.0 s."
    both = verdict(with_runs(fit, p, replace(held(fit), record="b")))
    assert both == f"Does not predict 1 of 2 held-out runs: the simulation diverges ({p.record})."


def test_without_a_held_out_run_nothing_is_claimed_of_predictions(fit: Fit) -> None:
    text = verdict(with_runs(fit))
    assert text.startswith("Reproduces its 3 runs to ") and text.endswith("; no held-out run tests the model.")
    training = [p for p in fit.predictions if p.role == "training"]
    diverged = replace(training[0], divergence=Divergence(70.0, 65.0, "r"))
    text = verdict(replace(fit, predictions=(diverged, *training[1:])))
    assert text == f"Does not reproduce {diverged.record} of its 3 runs: the simulation diverges."


def test_a_fit_of_spectra_alone_claims_nothing_of_runs(fit: Fit) -> None:
    assert verdict(replace(fit, predictions=())) == "No run was simulated with this fit."


def test_a_verdict_has_two_clauses_and_25_words_at_most(fit: Fit) -> None:
    p = held(fit)
    trained = next(prediction for prediction in fit.predictions if prediction.role == "training")
    shares = (0.05, 0.2, 0.5, 0.8, 1.2)
    graded = [replace(with_share(p, share), record=f"run_{k}") for k, share in enumerate(shares)]
    cases = [with_runs(fit, *graded[:n]) for n in range(6)]
    cases += [with_runs(fit, run) for run in graded]
    cases += [with_runs(fit, replace(p, measured=trained.measured, record=name)) for name in ("a", "b")]
    odd = replace(fit.findings[0], code="unphysical-values", severity=Severity.WARNING)
    cases += [replace(case, findings=(odd,)) for case in cases]
    cases += [replace(case, solution=replace(fit.solution, status=Status.STALLED)) for case in cases]
    for case in cases:
        assert len(verdict(case).split()) <= 25 and verdict(case).count(";") <= 1


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_side_of_a_turn_is_that_of_the_ship(fit: Fit, sign: float) -> None:
    record = turning_circle(sign * ANGLE)
    side = "starboard" if sign > 0 else "port"
    for one in (record, turned(record)):
        assert run_name(replace(held(fit), measured=one)) == f"turning circle to {side} with 20° rudder"


def test_a_run_without_heading_keeps_its_name(fit: Fit) -> None:
    p = held(fit)
    assert run_name(replace(p, measured=p.measured.without("psi"))) == f"run {p.record}"


@pytest.mark.parametrize(("port", "starboard", "text"), [
    (30.0, 30.0, "rudder beyond 30°"),
    (5.0, 35.0, "rudder beyond 35° to starboard and 5° to port"),
    (35.0, 5.0, "rudder beyond 5° to starboard and 35° to port"),
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


def test_without_a_rudder_the_speed_limits(fit: Fit) -> None:
    runs = tuple(replace(p, measured=p.measured.without("delta")) for p in fit.predictions if p.role == "training")
    assert extrapolation_limit(replace(fit, predictions=runs)).startswith("speed beyond ")
    bare = tuple(replace(p, measured=p.measured.without("delta", "u")) for p in fit.predictions)
    assert extrapolation_limit(replace(fit, predictions=bare)) == ""


def test_errors_have_their_units() -> None:
    assert error_text("psi_deg", 6.26) == "6.3°" and error_text("position_m", 5.6) == "5.6 m"
    assert error_text("r", math.radians(0.5)) == "0.50 deg/s" and error_text("u", 0.0371) == "0.037 m/s"
    assert worst_errors([]) == ""


# Whether a held-out run repeats a trained manoeuvre, by what the runs show.


def repeated(fit: Fit, held: Record, trained: Record) -> bool:
    """Whether the first of two runs counts as a repeat of the second one."""
    p = fit.validation[0]
    runs = (replace(p, measured=held), replace(p, record="trained", role="training", measured=trained))
    return repeated_runs(runs[0], runs) == ["trained"]


def test_a_zigzag_repeats_one_of_the_same_orders_alone(fit: Fit) -> None:
    twenty = zigzag("a", 20.0)
    assert repeated(fit, twenty, zigzag("b", 20.0, duration=180.0))
    assert not repeated(fit, twenty, zigzag("b", 30.0))
    assert not repeated(fit, twenty, turning_circle(math.radians(20.0)))
    faster = zigzag("b", 20.0)
    faster = faster.with_channel("u", faster.channel("u").with_values(1.5 * faster["u"]))
    assert not repeated(fit, twenty, faster)
    assert repeated(fit, twenty, zigzag("b", 20.0).without("u")), "a speed that was not recorded is not compared"


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_turn_repeats_one_to_the_same_side_alone(fit: Fit, side: float) -> None:
    turn = turning_circle(side * math.radians(35.0))
    assert repeated(fit, turn, turned(turn))
    assert not repeated(fit, turn, turning_circle(-side * math.radians(35.0)))
    assert not repeated(fit, turn, turning_circle(side * math.radians(20.0)))


def test_the_clause_names_what_is_repeated_and_what_that_leaves_open(fit: Fit) -> None:
    p = fit.validation[0]
    trained = next(one for one in fit.predictions if one.role == "training")
    clause = repeat_clause(replace(p, measured=trained.measured), fit.predictions)
    assert clause == f"a repeat of {trained.record}, which was fitted: it does not test other manoeuvres"
    assert repeat_clause(p, fit.predictions) == ""
