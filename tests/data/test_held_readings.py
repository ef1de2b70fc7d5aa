"""Readings that a faster table repeats: found by how a channel moves, whatever its rate; coarse ones are left alone."""

import numpy as np
import pytest

from seatrial.core.values import Array
from seatrial.data.held_readings import between_readings, held_text, slower_channels


def fixes(time: Array, period: float, phase: float = 0.0) -> Array:
    """A latitude in 1e-7 deg of a craft at some 3 m/s, renewed every `period` s."""
    latest = np.floor((time - phase) / period + 1e-9) * period + phase
    return 43.0 + np.round((3.0 * latest + 5.0 * np.sin(latest / 7.0)) / 111e3, 7)


@pytest.mark.parametrize(("step", "period"), [(0.2, 1.0), (0.1, 1.0), (0.1, 0.2), (0.1, 0.25), (0.5, 1.0), (1.0, 5.0)])
def test_fixes_count_where_they_are_new(step: float, period: float) -> None:
    time = step * np.arange(round(200.0 / step))
    lat = fixes(time, period)
    masks = slower_channels({"lat": lat, "lon": 0.5 * lat, "psi": np.round(20.0 * np.sin(time / 10.0), 1)}, time)
    assert set(masks) == {"lat", "lon"}
    assert masks["lat"].sum() == pytest.approx(200.0 / period, rel=0.01)
    assert np.all(masks["lat"][1:] >= (np.diff(lat) != 0.0))
    assert "every" in held_text(masks, time) and held_text({}, time) == ""


def test_latitude_and_longitude_renewed_in_turn() -> None:
    time = 0.1 * np.arange(2000)
    masks = slower_channels({"lat": fixes(time, 2.0), "lon": fixes(time, 2.0, 1.0)}, time)
    assert np.flatnonzero(masks["lat"])[:3].tolist() == [0, 20, 40]
    assert np.flatnonzero(masks["lon"])[1:3].tolist() == [30, 50]


@pytest.mark.parametrize("noise", [0.0, 0.1, 0.3, 1.0])
def test_a_coarse_compass_is_read_in_every_row(noise: float, rng: np.random.Generator) -> None:
    time = 0.1 * np.arange(2000)
    psi = np.round(20.0 * np.sin(time / 10.0) + noise * rng.standard_normal(2000))
    assert slower_channels({"psi": psi, "u": np.round(3.0 + 0.01 * psi, 1)}, time) == {}


def test_a_craft_that_stops_is_still_measured() -> None:
    time = 0.2 * np.arange(1000)
    lat = fixes(np.minimum(time, 100.0), 1.0)
    mask = slower_channels({"lat": lat, "lon": lat}, time)["lat"]
    assert mask[600:].sum() == pytest.approx(80, abs=1)


def test_a_reading_behind_a_lost_row_has_no_time_of_its_own() -> None:
    time = 0.1 * np.arange(2000)
    kept = np.arange(2000) % 10 != 0
    kept[::20] = True
    mask = slower_channels({"psi": np.degrees(fixes(time, 1.0))[kept]}, time[kept])["psi"]
    assert np.all(np.round(time[kept][mask][1:] / 0.1) % 20 == 0)


def test_a_frozen_compass_that_catches_up(rng: np.random.Generator) -> None:
    time = 0.2 * np.arange(1500)
    psi = np.round(40.0 * np.sin(time / 15.0) + 0.05 * rng.standard_normal(1500), 1)
    psi[700:750] = psi[699]
    mask = slower_channels({"psi": psi}, time)["psi"]
    assert np.flatnonzero(~mask).tolist() == list(range(700, 750))


def test_a_frozen_compass_that_begins_again_near_where_it_stopped(rng: np.random.Generator) -> None:
    """The ship has turned to and fro meanwhile: the jump is small, the stay is like no other."""
    time = 0.2 * np.arange(1500)
    psi = np.round(40.0 * np.sin(time / 15.0) + 0.05 * rng.standard_normal(1500), 1)
    psi[84:150] = psi[83]
    assert 0.4 < abs(psi[150] - psi[83]) < 1.2  # deg; it moves by up to 0.6 from row to row
    mask = slower_channels({"psi": psi}, time)["psi"]
    assert np.flatnonzero(~mask).tolist() == list(range(84, 150))


def test_a_straight_course_in_whole_degrees_is_not_frozen() -> None:
    """Stays of every length are those of legs, some far longer than most."""
    time = np.arange(3000.0)
    legs = np.repeat([10.0, 12.0, 40.0, 41.0, 10.0, 25.0], [200, 40, 900, 60, 1500, 300])
    psi = np.round(np.convolve(np.pad(legs, 30, mode="edge"), np.ones(61) / 61.0, mode="valid"))
    assert "psi" not in slower_channels({"psi": psi}, time)


def test_a_model_that_is_released_was_not_frozen() -> None:
    """Held by the carriage at first, and moving off slowly; so it does where a backlash holds it at a turn."""
    time = 0.1 * np.arange(1500)
    psi = np.round(20.0 * np.sin(np.maximum(time - 4.0, 0.0) ** 2 / 400.0), 4)
    assert "psi" not in slower_channels({"psi": psi}, time)


def test_between_readings_angles_go_the_shorter_way() -> None:
    values, is_measured = np.radians([350.0, 350.0, 10.0]), np.array([True, False, True])
    assert np.cos(between_readings(values, is_measured, is_angle=True)[1]) == pytest.approx(1.0)
