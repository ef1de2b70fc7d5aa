"""The extrapolation index by hand."""

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.estimation.information.extrapolation import (
    extrapolation,
    extrapolation_index,
    motion_envelope,
    with_recorded_speed,
)

TIME = 0.1 * np.arange(2000)


def run(name: str, r: float, beta: float, delta: float, speed: float) -> Record:
    """A run that reaches exactly these, most of the time."""
    one = np.ones(len(TIME))
    return Record.from_arrays(
        name,
        TIME,
        {"u": speed * np.cos(beta) * one, "v": -speed * np.sin(beta) * one, "r": r * one, "delta": delta * one},
    )


def test_runs_in_waves_are_compared_by_their_motions_and_the_height_of_the_waves() -> None:
    swing = np.sin(TIME)
    low = Record.from_arrays("low", TIME, {"zeta": 0.02 * swing, "z": 0.5 + 0.01 * swing, "theta": 0.03 * swing})
    high = Record.from_arrays("high", TIME, {"zeta": 0.04 * swing, "z": 0.7 + 0.01 * swing, "theta": 0.045 * swing})
    found = extrapolation(high, motion_envelope([low]))
    assert found is not None
    assert dict(found.ratios) == pytest.approx({"heave": 1.0, "pitch": 1.5, "elevation": 2.0})
    assert "heave" not in motion_envelope([low.without("zeta")])


def test_ratios_are_those_of_the_largest_values() -> None:
    train = [run("a", 0.02, 0.1, 0.2, 5.0), run("b", -0.04, -0.05, -0.3, 6.0)]
    found = extrapolation(run("c", 0.06, 0.15, -0.45, 5.5), motion_envelope(train))
    assert found is not None
    assert found.ratios == pytest.approx(
        {"yaw_rate": 1.5, "drift": 1.5, "rudder": 1.5, "fastest": 5.5 / 6.0, "slowest": 5.0 / 5.5}
    )
    assert found.index == pytest.approx(1.5)


@pytest.mark.parametrize(("delta", "index"), [(-0.3, 2.0), (-0.15, 1.5), (-0.6, 2.0), (0.3, 1.0)])
def test_a_side_that_was_not_trained_is_outside(delta: float, index: float) -> None:
    """All training runs have their rudder to starboard; to port the same angle is as far away again."""
    train = [run("a", 0.02, 0.1, 0.2, 5.0), run("b", 0.04, 0.1, 0.3, 5.0)]
    found = extrapolation(run("c", 0.03, 0.1, delta, 5.0), motion_envelope(train))
    assert found is not None
    assert found.index == pytest.approx(index)
    assert ("rudder to port" in found.ratios) == (delta < 0.0)


def test_a_file_without_sides_knows_none() -> None:
    envelope = {n: v for n, v in motion_envelope([run("a", 0.02, 0.1, 0.2, 5.0)]).items() if " to " not in n}
    found = extrapolation(run("c", -0.02, 0.1, -0.2, 5.0), envelope)
    assert found is not None
    assert found.index == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("speed", "name", "ratio"), [(3.0, "slowest", 5.0 / 3.0), (9.0, "fastest", 1.5), (5.5, "fastest", 5.5 / 6.0)]
)
def test_speed_leaves_the_range_both_ways(speed: float, name: str, ratio: float) -> None:
    train = [run("a", 0.02, 0.1, 0.2, 5.0), run("b", 0.02, 0.1, 0.2, 6.0)]
    found = extrapolation(run("c", 0.02, 0.1, 0.2, speed), motion_envelope(train))
    assert found is not None
    assert found.ratios[name] == pytest.approx(ratio)


def test_a_model_without_surge_is_judged_at_the_recorded_speed() -> None:
    """A steering model simulates r alone; at half the speed of any training run the index is 2, not 1."""
    measured = [run("fast", 0.02, 0.0, 0.2, 5.0), run("slow", 0.02, 0.0, 0.2, 2.5)]
    fast, slow = (with_recorded_speed(m.without("u", "v"), m) for m in measured)
    found = extrapolation(slow, motion_envelope([fast]))
    assert found is not None
    assert found.ratios["slowest"] == found.index == pytest.approx(2.0)
    assert with_recorded_speed(measured[0], measured[1]) is measured[0]
    speedless = slow.without("u")
    assert with_recorded_speed(speedless, speedless) is speedless


def test_a_run_from_rest_is_a_tenth_of_the_speed_away_and_no_farther() -> None:
    train = [run("a", 0.02, 0.1, 0.2, 1.5), run("b", 0.02, 0.1, 0.2, 5.0)]
    for speed in (0.3, 0.0):
        found = extrapolation(run("c", 0.02, 0.1, 0.2, speed), motion_envelope(train))
        assert found is not None
        assert found.ratios["slowest"] == pytest.approx(1.5 / 0.5)


def test_a_run_covers_itself() -> None:
    one = run("a", 0.02, 0.1, 0.2, 5.0)
    assert extrapolation_index(one, [one]) == pytest.approx(1.0)


def test_a_single_bad_sample_does_not_count() -> None:
    one = run("a", 0.02, 0.1, 0.2, 5.0)
    values = one["r"].copy()
    values[7] = 3.0
    assert extrapolation_index(one.with_channel("r", one.channel("r").with_values(values)), [one]) == pytest.approx(1.0)


def test_what_no_run_holds_is_not_compared() -> None:
    rudder = Record.from_arrays("a", TIME, {"delta": 0.2 * np.ones(len(TIME))})
    found = extrapolation(run("c", 0.06, 0.15, 0.3, 5.5), motion_envelope([rudder]))
    assert found is not None and found.ratios == pytest.approx({"rudder": 1.5})
    assert extrapolation(Record.from_arrays("b", TIME, {"psi": TIME}), motion_envelope([rudder])) is None
    assert extrapolation_index(Record.from_arrays("b", TIME, {"psi": TIME}), [rudder]) == 1.0
