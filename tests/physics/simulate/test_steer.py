"""Programmes steered: slew, sides, sections, approach, ends."""

import math

import numpy as np
import pytest

from seatrial.core.values import InputError, Record
from seatrial.physics.manoeuvres import measures
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate.steer import manoeuvre

JET, SLEW = {"v_j": 1.866}, math.radians(4.0)


def steered(text: str, dt: float = 0.1, approach: float = 0.0) -> Record:
    return manoeuvre(waterjet(), programme(text), dt=dt, inputs=JET, slew_rate=SLEW, approach=approach)


def test_the_published_series_of_zigzags_takes_its_time() -> None:
    """25 executes: Song et al. 2025 give about 2100 s."""
    record = steered("consecutive-zigzags")
    assert record.duration == pytest.approx(2068.0, abs=10.0)
    assert np.degrees(record["delta"]).max() == pytest.approx(30.0)


def test_the_rudder_slews_no_faster_than_ordered() -> None:
    rates = np.abs(np.diff(steered("zigzag:20/10")["delta"])) / 0.1
    assert rates.max() == pytest.approx(SLEW, rel=1e-9)


def test_positive_rudder_turns_to_starboard_whatever_the_models_sign() -> None:
    assert waterjet().inputs[0].direction == "port"
    assert steered("turning-circle:20")["psi"][-1] > 9.0
    assert steered("turning-circle:20:port")["psi"][-1] < -9.0


def test_port_mirrors_starboard() -> None:
    starboard, port = steered("zigzag:20/20"), steered("zigzag:20/20:port")
    assert len(starboard) == len(port)
    assert port["y0"] == pytest.approx(-starboard["y0"], abs=1e-9)


def test_executes_lie_at_the_switching_heading_on_average() -> None:
    record = steered("zigzag:10/10")
    moving = np.flatnonzero(np.diff(record["delta"]) != 0.0)
    begins = moving[np.flatnonzero(np.diff(moving, prepend=-2) > 1)][1:]
    off = np.abs(np.degrees(record["psi"][begins])) - 10.0
    assert np.all(np.abs(off) <= 0.5 * 0.1 * np.degrees(np.abs(record["r"][begins])) + 1e-9)


def test_the_measures_converge_with_the_step() -> None:
    coarse, fine = measures(steered("zigzag:20/20"), 9.8), measures(steered("zigzag:20/20", dt=0.01), 9.8)
    for name in ("overshoot_1_deg", "overshoot_2_deg", "period_s"):
        assert coarse[name] == pytest.approx(fine[name], rel=2e-3)


def test_the_approach_is_straight_and_steady() -> None:
    record = steered("zigzag:20/20", approach=30.0)
    before = record.between(0.0, 30.0)
    assert np.ptp(before["u"]) < 1e-9
    assert np.all(before["psi"] == 0.0)
    assert record["u"][0] == pytest.approx(0.8, abs=2e-3)


def test_the_spiral_holds_every_angle() -> None:
    angles, counts = np.unique(np.round(np.degrees(steered("spiral:15")["delta"]), 6), return_counts=True)
    held = {float(a) for a, n in zip(angles, counts, strict=True) if n > 1000}
    assert held == {-15.0, -10.0, -5.0, -3.0, -1.0, 0.0, 1.0, 3.0, 5.0, 10.0, 15.0}


def test_duration_cuts_and_is_said() -> None:
    record = manoeuvre(waterjet(), programme("zigzag:20/20"), inputs=JET, duration=50.0)
    assert record.duration == pytest.approx(50.0)
    assert "not finished after 50 s" in record.provenance.steps


def test_what_is_missing_is_named() -> None:
    zigzag = programme("zigzag:20/20")
    with pytest.raises(InputError, match="needs the input 'v_j'"):
        manoeuvre(waterjet(), zigzag)
    with pytest.raises(InputError, match="'n' is no held input"):
        manoeuvre(waterjet(), zigzag, inputs={**JET, "n": 10.0})
    with pytest.raises(InputError, match="no steady speed ahead"):
        manoeuvre(waterjet(), zigzag, inputs={"v_j": 0.0})
    with pytest.raises(InputError, match="must be positive"):
        manoeuvre(waterjet(), zigzag, inputs=JET, dt=0.0)


def test_a_model_without_speed_keeps_its_own_time() -> None:
    assert manoeuvre(nomoto(), programme("zigzag:10/10")).provenance.steps[1].startswith("finished")


@pytest.mark.parametrize("duration", [math.nan, math.inf, 1e12, 0.01])
def test_a_duration_without_an_end_or_a_step_is_refused(duration: float) -> None:
    with pytest.raises(InputError, match=r"is not between 1 and 1e\+08 steps of 0.1 s"):
        manoeuvre(nomoto(), programme("zigzag:10/10"), duration=duration)
