"""The speed through the water and the current, from fixes on several courses."""

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.data.check.water_speed import speed_through_water

DT = 0.5


def craft(course: float, turn: float, current: tuple[float, float], rng: np.random.Generator) -> Record:
    """Three minutes at 3 m/s, slower and drifting in the turns, in a current [m/s north, east]; fixes of 5 cm."""
    time = DT * np.arange(360)
    rate = turn * np.sin(2.0 * np.pi * time / 60.0) + 0.02 * (time > 90.0) * (turn > 0.05)
    psi = course + DT * np.cumsum(rate)
    u, v = 3.0 - 40.0 * rate**2, -1.5 * rate
    north = u * np.cos(psi) - v * np.sin(psi) + current[0]
    east = u * np.sin(psi) + v * np.cos(psi) + current[1]
    track = {
        name: DT * np.cumsum(way) + 0.05 * rng.standard_normal(len(time)) for name, way in (("x0", north), ("y0", east))
    }
    return Record.from_arrays(f"run {course:g}", time, {"psi": psi, **track})


@pytest.mark.parametrize("current", [(0.4, 1.2), (0.0, 0.0)])
def test_two_courses_show_speed_and_current(current: tuple[float, float], rng: np.random.Generator) -> None:
    shown = speed_through_water([craft(0.5, 0.06, current, rng), craft(3.6, 0.06, current, rng)])
    assert shown is not None and shown.is_separate
    assert shown.speed == pytest.approx(3.0, abs=0.06)
    assert (shown.north, shown.east) == pytest.approx(current, abs=0.04)
    assert shown.has_current == (current != (0.0, 0.0))


def test_one_course_does_not(rng: np.random.Generator) -> None:
    straight = [craft(0.5, 0.004, (0.4, 1.2), rng)]
    shown = speed_through_water(straight)
    assert shown is not None and not shown.is_separate
    assert speed_through_water([straight[0].without("psi")]) is None


def test_circles_that_take_half_the_speed_show_that_of_the_approach(rng: np.random.Generator) -> None:
    """With u^2 = U^2 - c r^2, of a straight course and two hard circles; linear in r^2 it would be 0.4 m/s more."""
    time, speed, current = DT * np.arange(800), 6.0, (0.3, 0.15)
    records = []
    for side in (-1.0, 1.0):
        rate = side * np.clip((time - 60.0) / 40.0, 0.0, 1.0) * 0.04
        psi = 1.9 + DT * np.cumsum(rate)
        u, v = np.sqrt(speed**2 - 1.6e4 * rate**2), -10.0 * rate
        ways = {
            "x0": u * np.cos(psi) - v * np.sin(psi) + current[0], "y0": u * np.sin(psi) + v * np.cos(psi) + current[1],
        }  # fmt: skip
        track = {name: DT * np.cumsum(way) + 0.3 * rng.standard_normal(len(time)) for name, way in ways.items()}
        records.append(Record.from_arrays(f"circle {side:g}", time, {"psi": psi, **track}))
    shown = speed_through_water(records)
    assert shown is not None and shown.is_separate and shown.has_current
    assert shown.speed == pytest.approx(speed, abs=max(0.1, 3.0 * shown.speed_error))
    assert (shown.north, shown.east) == pytest.approx(current, abs=0.03)


def test_a_wide_zigzag_on_one_course_separates_no_current(rng: np.random.Generator) -> None:
    shown = speed_through_water([craft(0.5, 0.09, (0.4, 1.2), rng).between(0.0, 90.0)])
    assert shown is not None and np.degrees(shown.courses) > 80.0 and not shown.is_separate


def test_currents_of_two_outings_disagree(rng: np.random.Generator) -> None:
    ebb, flood = (speed_through_water([craft(0.5, 0.06, (one, 0.0), rng)]) for one in (-0.8, 0.8))
    assert ebb is not None and flood is not None
    assert not ebb.agrees_with(flood) and ebb.agrees_with(ebb)


def test_circles_show_a_current_whatever_the_craft_does_to_its_speed(rng: np.random.Generator) -> None:
    """A boat with thrusters, whose speed changes from order to order: its own speed is none, the current is one."""
    time = DT * np.arange(600)
    u = np.repeat(rng.uniform(0.5, 2.5, 30), 20)
    psi = DT * np.cumsum(np.repeat(rng.uniform(-0.3, 0.3, 30), 20))
    ways = (("x0", u * np.cos(psi) + 0.3), ("y0", u * np.sin(psi) - 0.2))
    track = {name: DT * np.cumsum(way) + 0.05 * rng.standard_normal(len(time)) for name, way in ways}
    shown = speed_through_water([Record.from_arrays("boat", time, {"psi": psi, **track})])
    assert shown is not None and shown.shows_current and not shown.is_separate
