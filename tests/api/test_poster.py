"""The wheelhouse poster of a fit: what each number rests on, full scale, the page, and what is refused."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.reporting.fabricated import fabricated_fit
from typer.testing import CliRunner

import seatrial as st
from seatrial import api
from seatrial.api.measured_runs import measured_quantity, readings_of
from seatrial.api.poster import _Order, _shows
from seatrial.cli import app
from seatrial.core.results import IntervalBasis, Offset, Prediction
from seatrial.core.results.poster import Basis, Poster
from seatrial.core.values import Channel, RecordKind
from seatrial.estimation.information.extrapolation import motion_envelope
from seatrial.estimation.predict.open_loop import compare_measures
from seatrial.physics.manoeuvres import ObservedManoeuvre
from seatrial.physics.models.thruster_layout import CATAMARAN, AngleInput, CommandInput, Thruster, ThrusterLayout
from seatrial.physics.models.thrusters import thrusters
from seatrial.reporting.poster import TO_BE_FILLED_IN, html, particulars


def fit_of_runs(*manoeuvres: str) -> st.Fit:
    """The fabricated fit with runs of its own model in these manoeuvres, as if measured, behind it."""
    fit = fabricated_fit()
    runs = [replace(st.simulate(fit, m), kind=RecordKind.MEASURED, name=m.split(":")[0]) for m in manoeuvres]
    length = fit.ship.particulars["L"]
    predictions = tuple(Prediction(r.name, "training", r, r, {}, compare_measures(r, r, length), 0.0) for r in runs)
    basis = IntervalBasis(1e-2 * fit.covariance, np.inf, training_envelope=motion_envelope(runs))
    return replace(fit, predictions=predictions, records=tuple(runs), interval_basis=basis)


@pytest.fixture(scope="module")
def fit() -> st.Fit:
    return fit_of_runs("zigzag:20/20")


@pytest.fixture(scope="module")
def poster(fit: st.Fit) -> Poster:
    return api.poster(fit)


def test_each_number_says_what_it_rests_on(poster: Poster, fit: st.Fit) -> None:
    bases = {m.manoeuvre: {q.basis for q in m.quantities} for m in poster.manoeuvres}
    assert bases == {
        "turning-circle:35:port": {Basis.EXTRAPOLATED},
        "turning-circle:35": {Basis.EXTRAPOLATED},
        "zigzag:10/10": {Basis.PREDICTED},
        "zigzag:20/20": {Basis.MEASURED},
    }
    measured = {q.name: q.value for q in poster.manoeuvres[3].quantities}
    shown = fit.predictions[0].measures
    assert measured == {name: shown[name].measured for name in measured}
    assert names(poster)[3] == ["zigzag"]
    for quantity in (q for m in poster.manoeuvres[:3] for q in m.quantities if q.is_determined):
        assert quantity.lower is not None and quantity.upper is not None
        assert quantity.lower < quantity.value < quantity.upper


def test_a_zigzag_first_to_port_counts_and_the_larger_of_two_is_given(fit: st.Fit) -> None:
    (run,) = readings_of(fit)
    psi, delta = run.measured.channel("psi"), run.measured.channel("delta")
    mirrored = run.measured.with_channel("psi", psi.with_values(-1.05 * psi.values))
    mirrored = mirrored.with_channel("delta", delta.with_values(-delta.values))
    other = replace(run, measured=mirrored, manoeuvre=ObservedManoeuvre.from_record(mirrored))
    zigzag, speed = _Order("zigzag:20/20", 20.0, 1, (), 20.0), run.values["approach_speed"]
    assert _shows(run, zigzag, speed) and _shows(other, zigzag, speed)
    both = run.values["overshoot_1_deg"], other.values["overshoot_1_deg"]
    assert both[1] == pytest.approx(1.05 * both[0], rel=1e-9)
    quantity = measured_quantity("overshoot_1_deg", [run, other])
    assert quantity is not None and quantity.value == both[1] and quantity.repeats == both


def test_a_run_of_positions_without_speeds_is_read(fit: st.Fit) -> None:
    (p,) = fit.predictions
    bare = replace(fit, predictions=(replace(p, measured=without_u(p.measured), measures={}),))
    (run,) = readings_of(bare)
    for name in ("approach_speed", "initial_turning_L"):
        assert run.values[name] == pytest.approx(p.measures[name].measured, rel=0.01)


def test_a_run_of_a_craft_that_steers_by_an_outboard_is_read_by_its_angle(fit: st.Fit) -> None:
    """Abaft midship thrust to port turns to starboard: the angle is the order with its sign changed."""
    (p,) = fit.predictions
    outboard = ThrusterLayout((Thruster("outboard", -2.0, 0.0, CommandInput("command_1"), AngleInput("alpha_1")),))
    angle = Channel.from_notation("alpha_1", -p.measured["delta"])
    run = replace(p, measured=p.measured.without("delta").with_channel("alpha_1", angle))
    (reading,) = readings_of(replace(fit, model=thrusters(outboard), predictions=(run,)))
    (by_rudder,) = readings_of(fit)
    assert reading.values == by_rudder.values
    assert readings_of(replace(fit, model=thrusters(CATAMARAN), predictions=(run,))) == ()


def test_the_interval_holds_the_error_of_the_current(fit: st.Fit) -> None:
    """An error of the current of 0.1 m/s is one of 0.1 m/s of the speed through the water, towards the course."""
    (p,) = fit.predictions
    errors = {"current_north": 0.1, "current_east": 0.0}  # m/s
    offsets = tuple(Offset(name, "day 1", "m/s", 0.0, error) for name, error in errors.items())
    run = replace(p, measured=without_u(p.measured), session="day 1")
    (reading,) = readings_of(replace(fit, predictions=(run,), offsets=offsets))
    assert reading.run.current == 0.0
    assert reading.half_widths["approach_speed"] == pytest.approx(1.96 * 0.1, rel=0.01)


def without_u(record: st.Record) -> st.Record:
    return replace(record, channels={name: c for name, c in record.channels.items() if name not in ("u", "v")})


def test_a_run_of_another_speed_or_side_or_a_simulated_one_is_no_measurement(fit: st.Fit) -> None:
    faster = 1.2 * poster_speed(fit)
    assert not any(names(api.poster(fit, speed=faster)))
    assert any(names(api.poster(fit, speed=1.08 * poster_speed(fit))))
    circle = fit_of_runs("turning-circle:35")
    assert names(api.poster(circle)) == [[], ["turning-circle"], [], []]
    assert not any(names(api.poster(circle, rudder_deg=30.0)))
    simulated = replace(
        fit, predictions=tuple(
            replace(p, measured=replace(p.measured, kind=RecordKind.SIMULATED)) for p in fit.predictions
        ),
    )  # fmt: skip
    assert not any(names(api.poster(simulated)))


def names(sheet: Poster) -> list[list[str]]:
    return [[run.name for run in m.runs] for m in sheet.manoeuvres]


def poster_speed(fit: st.Fit) -> float:
    speed = fit.predictions[0].measures["approach_speed"].measured
    assert speed is not None
    return speed


def test_model_tests_are_given_at_full_scale(poster: Poster) -> None:
    full = replace(poster, scale=25.0)
    texts = dict(particulars(full))
    assert texts["length between perpendiculars"].startswith(f"{25.0 * poster.particulars['L']:.4g}")
    assert f"({5.0 * poster.approach_speed:.2f} m/s)" in texts["approach speed"]
    page, own = html(full), html(poster)
    assert "scale effects are not in the intervals" in page
    assert "scale effects" not in own
    (advance,) = (q for q in poster.manoeuvres[1].quantities if q.name == "advance_L")
    metres = 25.0 * poster.particulars["L"] * advance.value
    assert f"{metres:,.0f}".replace(",", "\u202f") in page or f"{metres:.0f}" in page


def test_the_page_says_what_no_fit_knows_and_escapes_names(poster: Poster) -> None:
    page = html(replace(poster, ship="<b>Ship</b>"))
    assert "&lt;b&gt;Ship" in page
    assert "<b>Ship" not in page
    for missing in TO_BE_FILLED_IN:
        assert missing in page
    assert "Performance may differ from this record" in page
    assert "size: A4" in page


def test_what_cannot_be_steered_has_no_poster(fit: st.Fit) -> None:
    with pytest.raises(st.InputError, match="model 'roll' has no rudder"):
        api.poster(replace(fit, model=st.models.roll()))
    with pytest.raises(st.InputError, match="rudder angle of 0 deg"):
        api.poster(fit, rudder_deg=0.0)


def test_the_command_writes_the_page(fit: st.Fit, tmp_path: Path) -> None:
    st.save(fit, tmp_path / "result")
    out, table = tmp_path / "poster.html", tmp_path / "p.json"
    done = CliRunner().invoke(
        app, ["poster", str(tmp_path / "result"), "--out", str(out), "--rudder", "30", "--json", str(table)]
    )
    assert done.exit_code == 0, done.output
    assert "turning circle with 30 deg to port" in done.output
    assert "measured" in done.output
    assert out.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    assert json.loads(table.read_text(encoding="utf-8"))["rudder_deg"] == 30.0
