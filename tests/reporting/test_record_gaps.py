"""What the training runs do not show: only what is true, to both sides, with the manoeuvre that shows it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.results import Fit, Prediction
from seatrial.core.values import Array, Record
from seatrial.physics.manoeuvres.programme import programme, release_angle
from seatrial.physics.manoeuvres.thrust_programme import thrust_programme
from seatrial.physics.models.thruster_layout import CATAMARAN, AngleInput, CommandInput, Thruster, ThrusterLayout
from seatrial.physics.simulate.thrust import craft_programme
from seatrial.reporting.key_facts import key_facts
from seatrial.reporting.record_gaps import RecordGap, gap_facts, gaps_of_rolling, gaps_of_thrusters, record_gaps

TIME = np.arange(0.0, 200.0, 1.0)
SQUARE = np.where(np.sin(TIME / 20.0) > 0.0, 1.0, -1.0)


def run(degrees: Array, u: Array | float = 0.8, positive: str = "starboard", **others: Array | float) -> Record:
    """A run with this rudder, counted positive to a side."""
    values = {"delta": np.radians(degrees), "u": u + 0.0 * TIME, **{k: v + 0.0 * TIME for k, v in others.items()}}
    record = Record.from_arrays("run", TIME, values)
    channel = replace(record.channel("delta"), positive=positive)
    return record.with_channel("delta", channel)


def trained(fit: Fit, *records: Record) -> Fit:
    like = next(p for p in fit.predictions if p.role == "training")
    runs: tuple[Prediction, ...] = tuple(replace(like, measured=r, record=r.name) for r in records)
    return replace(fit, predictions=(*runs, *fit.validation))


def names(fit: Fit) -> list[str]:
    return [gap.name for gap in record_gaps(fit)]


@pytest.mark.parametrize(("sign", "positive", "other", "options"), [
    (1.0, "starboard", "port", "turning-circle:20:port"), (-1.0, "starboard", "starboard", "turning-circle:20"),
    (1.0, "port", "starboard", "turning-circle:20"), (-1.0, "port", "port", "turning-circle:20:port"),
])  # fmt: skip
def test_a_rudder_to_one_side_leaves_the_other_open(
    fit: Fit, sign: float, positive: str, other: str, options: str
) -> None:
    one = trained(fit, run(sign * 10.0 * (1.0 + SQUARE), positive=positive))
    (gap,) = [g for g in record_gaps(one) if g.name.startswith("turns to")]
    assert gap.name == f"turns to {other}" and gap.command == f"--manoeuvre {options}"
    assert f"went to {'port' if other == 'starboard' else 'starboard'} only" in gap.text
    assert not [n for n in names(trained(fit, run(20.0 * SQUARE))) if n.startswith("turns to")]


def test_a_rudder_that_never_moves_has_no_side(fit: Fit) -> None:
    assert not [n for n in names(trained(fit, run(0.0 * TIME))) if n.startswith(("turns", "rudder"))]


def test_angles_beyond_those_run_end_at_full_rudder(fit: Fit) -> None:
    assert "rudder beyond 20°" in names(trained(fit, run(20.0 * SQUARE)))
    assert not [n for n in names(trained(fit, run(34.0 * SQUARE))) if n.startswith("rudder")]


def test_one_speed_is_named_and_two_are_not(fit: Fit) -> None:
    (one,) = [g for g in record_gaps(trained(fit, run(20.0 * SQUARE))) if "speeds" in g.name]
    assert one.name == "approach speeds other than 0.80 m/s" and one.text.startswith("The only run begins at 0.80 m/s")
    assert one.options == "zigzag:20/20 --speed 0.60"
    alike = trained(fit, run(20.0 * SQUARE), run(20.0 * SQUARE, 0.82))
    assert any(g.text.startswith("Both runs begin at 0.81 m/s") for g in record_gaps(alike))
    assert not [n for n in names(trained(fit, run(20.0 * SQUARE), run(20.0 * SQUARE, 0.5))) if "speeds" in n]


def test_one_setting_of_the_propulsion_shows_no_thrust_apart_from_resistance(fit: Fit) -> None:
    constant = trained(fit, run(20.0 * SQUARE, v_j=1.866))
    (gap,) = [g for g in record_gaps(constant) if g.name == "thrust apart from resistance"]
    assert gap.text.startswith("The jet velocity was 1.87 m/s throughout") and gap.options.endswith("--set v_j=1.4")
    varied = trained(fit, run(20.0 * SQUARE, v_j=1.866), run(20.0 * SQUARE, v_j=1.5))
    assert "thrust apart from resistance" not in names(varied)
    assert "thrust apart from resistance" not in names(trained(fit, run(20.0 * SQUARE)))  # not recorded
    shafts = trained(fit, run(20.0 * SQUARE, n=2.0))
    assert "thrust apart from resistance" not in names(shafts)  # the model has no such input


def thruster_gaps(r: Array, command: Array) -> list[RecordGap]:
    channels = {"psi": np.cumsum(r), "r": r, "command_1": command, "command_2": command}
    return list(gaps_of_thrusters([Record.from_arrays("run", TIME, channels)], CATAMARAN))


def test_a_craft_with_thrusters_lacks_a_side_orders_astern_and_full_command() -> None:
    gaps = {g.name: g.command for g in thruster_gaps(0.2 * (1.0 + SQUARE), 0.3 + 0.2 * SQUARE)}
    assert gaps == {
        "turns to port": "--manoeuvre spin:50:port", "orders beyond 50 % ahead": "--manoeuvre straight:100",
        "orders astern": "--manoeuvre stop:50",
    }  # fmt: skip
    assert [g.name for g in thruster_gaps(-0.2 * (1.0 + SQUARE), SQUARE)] == ["turns to starboard"]
    assert thruster_gaps(0.2 * SQUARE, SQUARE) == []


@pytest.mark.parametrize(("x", "end"), [(-2.0, ":port"), (2.0, "")])
def test_a_craft_whose_thruster_turns_lacks_a_side_and_larger_angles_of_it(x: float, end: str) -> None:
    """Thrust to port, at the stern, turns to starboard, at the bow to port."""
    turned = Thruster("pod", x, 0.0, CommandInput("command_1"), angle=AngleInput("alpha_1"))
    angle = -math.radians(10.0) * (1.0 + SQUARE)
    channels = {"psi": 0.0 * TIME, "alpha_1": angle, "command_1": SQUARE}
    gaps = list(gaps_of_thrusters([Record.from_arrays("run", TIME, channels)], ThrusterLayout((turned,))))
    assert [g.options for g in gaps] == [f"turning-circle:20{end}", "turning-circle:35"]
    assert gaps[1].name == "steering angle beyond 20°"
    assert all(craft_programme(ThrusterLayout((turned,)), g.options) for g in gaps)


def test_a_larger_release_is_named_up_to_the_deck_edge() -> None:
    (gap,) = gaps_of_rolling([Record.from_arrays("decay", TIME, {"phi": np.radians(12.0) * np.cos(TIME)})])
    assert gap.name == "roll beyond 12°" and gap.options == "release:24"
    assert not list(gaps_of_rolling([Record.from_arrays("decay", TIME, {"phi": np.radians(20.0) * np.cos(TIME)})]))


def test_what_is_named_is_a_manoeuvre_that_can_be_simulated(fit: Fit) -> None:
    for gap in record_gaps(trained(fit, run(10.0 * (1.0 + SQUARE), v_j=1.866))):
        assert programme(gap.options.split()[0]) is not None
    for gap in thruster_gaps(0.2 * (1.0 + SQUARE), 0.3 + 0.2 * SQUARE):
        assert thrust_programme(gap.options) is not None
    assert math.degrees(release_angle("release:24")) == pytest.approx(24.0)


def test_the_first_screen_has_the_row_only_where_something_is_missing(fit: Fit) -> None:
    (row,) = gap_facts(trained(fit, run(20.0 * SQUARE)))
    assert row in key_facts(trained(fit, run(20.0 * SQUARE))) and row.is_good is None
    assert row.text.startswith("rudder beyond 20°; ") and "simulate" not in row.text
    (wide,) = gap_facts(trained(fit, run(34.0 * SQUARE), run(34.0 * SQUARE, 0.4)))
    assert wide.text == "rudder beyond 34°"
    assert gap_facts(replace(fit, predictions=())) == ()
