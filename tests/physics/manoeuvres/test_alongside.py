"""A simulated record is measured at the executes of the measured one, however far its own heading has drifted."""

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest

from seatrial.core.values import InputError, Record, frozen
from seatrial.physics.manoeuvres import ManoeuvreKind, imo_criteria, measures, recognise_manoeuvre
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.simulate.steer import manoeuvre

LENGTH = 10.0


def drifted(record: Record, rate: float) -> Record:
    """The same record with its heading running off at `rate` [rad/s]."""
    psi = record.channel("psi")
    return record.with_channel("psi", psi.with_values(frozen(psi.values + rate * record.time)))


def executes(record: Record) -> list[int]:
    """Rows at which the rudder begins to move."""
    moving = np.flatnonzero(np.diff(record["delta"]) != 0.0)
    return moving[np.flatnonzero(np.diff(moving, prepend=-9) > 1)].tolist()


@pytest.fixture(scope="module")
def zigzag() -> Record:
    model = nomoto().with_values({"K": 0.08, "T": 12.0})
    return manoeuvre(model, programme("zigzag:20/10"), slew_rate=math.radians(3.0), approach=20.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_drifting_heading_hides_no_overshoot(zigzag: Record, sign: float) -> None:
    rate = sign * math.radians(0.3)
    off = drifted(zigzag, rate)
    assert recognise_manoeuvre(off) is not ManoeuvreKind.ZIGZAG
    assert "overshoot_1_deg" not in measures(off, LENGTH)
    expected, found = measures(zigzag, LENGTH), measures(off, LENGTH, reference=zigzag)
    assert list(found) == list(expected)
    overshoots = [name for name in expected if name.startswith("overshoot_")]
    assert len(overshoots) == 4
    begins, heading = executes(zigzag), np.degrees(off["psi"])
    for k, (a, b) in enumerate(pairwise([*begins[1:], len(zigzag)])):
        side = (-1.0) ** k
        direct = np.max(side * (heading[a:b] - heading[a]))
        assert found[overshoots[k]] == pytest.approx(direct, abs=0.05)
        assert np.sign(found[overshoots[k]] - expected[overshoots[k]]) == side * sign
    assert found["period_s"] == pytest.approx(expected["period_s"], rel=0.03)
    assert sign * (found["initial_turning_time_s"] - expected["initial_turning_time_s"]) < 0.0


def test_a_record_like_itself_has_its_own_measures(zigzag: Record, circle: Callable[..., Record]) -> None:
    for record in (zigzag, circle(-1, "port")):
        assert measures(record, LENGTH, reference=record) == measures(record, LENGTH)
    counted = measures(zigzag, LENGTH, switching=math.radians(10.0))
    assert measures(zigzag, LENGTH, switching=math.radians(10.0), reference=zigzag) == counted


def test_the_rudders_sign_is_the_measured_one(circle: Callable[..., Record]) -> None:
    """Only heading and track are the simulation's own: a rudder recorded to port, or not at all, changes nothing."""
    simulated = circle(1).without("delta")
    assert measures(simulated, LENGTH, reference=circle(1, "port")) == measures(circle(1), LENGTH)


def test_a_circle_is_measured_on_its_own_track(circle: Callable[..., Record]) -> None:
    """A simulation turning with half the yaw rate, on twice the radius, at the same speed: half a turn and a bit."""
    measured = circle(1)
    time, over = measured.time, measured.time > 10.0 + 1e-9
    turned = 0.025 * np.clip(time - 10.0, 0.0, None)
    values = {
        "psi": turned,
        "x0": np.where(over, 40.0 * np.sin(turned), time - 10.0),
        "y0": np.where(over, 40.0 * (1.0 - np.cos(turned)), 0.0),
    }
    found = measures(Record.from_arrays("wide", time, values), LENGTH, reference=measured)
    assert found["advance_L"] == pytest.approx(4.0, abs=0.006)
    assert found["transfer_L"] == pytest.approx(4.0, abs=1e-3)
    assert found["tactical_diameter_L"] == pytest.approx(8.0, abs=1e-3)


def test_a_simulation_that_does_not_turn_back_lacks_that_overshoot_only(zigzag: Record) -> None:
    """From the second execute to the third the heading only rises: overshoot 1 is missing, later ones keep numbers."""
    begins = zigzag.time[executes(zigzag)]
    share = np.clip((zigzag.time - begins[1]) / (begins[2] - begins[1]), 0.0, 1.0)
    psi = zigzag.channel("psi")
    rising = zigzag.with_channel("psi", psi.with_values(frozen(psi.values + share * math.radians(90.0))))
    found, expected = measures(rising, LENGTH, reference=zigzag), measures(zigzag, LENGTH)
    assert "overshoot_1_deg" not in found
    assert found["overshoot_2_deg"] == pytest.approx(expected["overshoot_2_deg"], abs=0.1)
    assert found["overshoot_3_deg"] == pytest.approx(expected["overshoot_3_deg"], abs=1e-9)


def test_standards_are_those_of_the_measured_run() -> None:
    model = nomoto().with_values({"K": 0.08, "T": 12.0})
    record = manoeuvre(model, programme("zigzag:20/20"), slew_rate=math.radians(3.0), approach=20.0)
    off = drifted(record, math.radians(0.15))
    assert [c.name for c in imo_criteria(off, LENGTH, reference=record)] == [
        c.name for c in imo_criteria(record, LENGTH)
    ]


def test_other_times_are_refused(zigzag: Record) -> None:
    for other in (zigzag.between(0.0, 100.0), zigzag.resampled(5.0)):
        with pytest.raises(InputError, match="is not sampled at the times of"):
            measures(other, LENGTH, reference=zigzag)


def test_every_hsva_run_predicted_with_a_drift_keeps_its_overshoots(hsva) -> None:
    for name in ("Z_15_01", "Z_25_05", "Z_35_05"):
        record = hsva(name)
        off = drifted(record, math.radians(20.0) / record.duration)
        expected, found = measures(record, 7.0), measures(off, 7.0, reference=record)
        assert {k for k in expected if k.startswith("overshoot_")} <= set(found)
        for k in ("overshoot_1_deg", "overshoot_2_deg"):
            assert found[k] == pytest.approx(expected[k], abs=1.5)
