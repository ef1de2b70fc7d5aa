"""A heel that is held before the release is found, with how long it lasts."""

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.data.check.phases import begins_before_release, is_free_decay, is_in_waves, release_findings, release_row

TIME = np.arange(0.0, 60.0, 0.05)


def held_heel(rng: np.random.Generator, seconds: float) -> Record:
    swing = np.where(seconds > TIME, 1.0, np.exp(-0.03 * (TIME - seconds)) * np.cos(2.5 * (TIME - seconds)))
    return Record.from_arrays("decay", TIME, {"phi": 0.2 * swing + 1e-3 * rng.standard_normal(len(TIME))})


def test_a_held_heel_is_named_with_its_seconds(rng: np.random.Generator) -> None:
    (finding,) = release_findings(held_heel(rng, 5.0))
    assert finding.code == "held-roll" and "for 5.0 s" in finding.evidence


def test_a_record_from_the_release_on_has_nothing_to_name(rng: np.random.Generator) -> None:
    assert release_findings(held_heel(rng, 0.0)) == ()
    assert release_row(np.cos(TIME)) == 0


def test_rest_before_the_heel_is_before_the_release_too(rng: np.random.Generator) -> None:
    shifted = np.concatenate([np.zeros(200), held_heel(rng, 0.0)["phi"]])
    at_rest_first = Record.from_arrays("decay", 0.05 * np.arange(len(shifted)), {"phi": shifted})
    assert begins_before_release(at_rest_first) and release_findings(at_rest_first) == ()
    assert begins_before_release(held_heel(rng, 5.0)) and not begins_before_release(held_heel(rng, 0.0))
    assert not is_free_decay(Record.from_arrays("roll", TIME, {"phi": 0.1 * np.cos(TIME)}))


def test_a_heel_that_wanders_while_it_is_pulled_is_held_to_its_end() -> None:
    """Held at 12.7 deg for 25 s, largest long before it is let go; the noise of the sensor is far smaller."""
    time = np.arange(0.0, 80.0, 0.02)
    wander = 0.3 * np.sin(2.0 * np.pi * time / 23.0)
    rolling = 12.7 * np.exp(-0.08 * (time - 25.0)) * np.cos(0.8 * (time - 25.0))
    phi = np.radians(np.where(time < 25.0, 12.7 + wander, rolling))
    noise = np.radians(0.02) * np.random.default_rng(5).standard_normal(time.size)
    assert 25.0 - 0.2 < time[release_row(phi + noise)] < 25.0 + 0.5


@pytest.mark.parametrize("period", [5.0, 9.0])
@pytest.mark.parametrize("seconds", [6.4, 7.9])
def test_a_coarse_record_begins_behind_the_hold(period: float, seconds: float, rng: np.random.Generator) -> None:
    """At 1 Hz the release lies between two rows; the last row of the hold knows nothing of it."""
    time = np.arange(0.0, 12.0 * period)
    free = np.exp(-0.03 * (time - seconds)) * np.cos(2.0 * np.pi / period * (time - seconds))
    phi = 0.2 * np.where(time < seconds, 1.0, free) + 1e-3 * rng.standard_normal(len(time))
    assert seconds <= time[release_row(phi)] < seconds + 1.2


def pumped(steady: float) -> np.ndarray:
    """Driven from side to side for 33 s, to the same angle for so many of them, then left alone; rad."""
    size = np.where(TIME < 33.0, np.minimum(1.0, 0.2 + 0.8 * TIME / (33.0 - steady)), np.exp(-0.1 * (TIME - 33.0)))
    return 0.18 * size * np.cos(2.5 * (TIME - 33.0))


@pytest.mark.parametrize("steady", [0.0, 10.0])
def test_a_ship_that_people_drive_is_released_at_their_last_swing(steady: float, rng: np.random.Generator) -> None:
    phi = pumped(steady) + 1e-3 * rng.standard_normal(len(TIME))
    record = Record.from_arrays("decay", TIME, {"phi": phi})
    assert TIME[release_row(phi)] == pytest.approx(33.0, abs=1.4), "half a period before at most"
    assert begins_before_release(record) and not is_in_waves(phi)
    (finding,) = release_findings(record)
    assert finding.code == "held-roll" and "driven before it is released" in finding.message


def test_a_light_decay_is_not_driven() -> None:
    """Swings of one side lose 3 % each: as many are nearly as large as the first."""
    phi = np.exp(-0.0125 * TIME) * np.cos(2.5 * TIME)
    assert release_row(phi) == 0


def test_groups_of_waves_are_no_decays_and_releases_no_waves(rng: np.random.Generator) -> None:
    """A lightly damped roll driven by noise, by an own recursion of the damped oscillator."""
    time = np.arange(0.0, 1800.0, 0.5)
    turn = np.exp((-0.05 + 0.8j) * 0.5)
    swing, sea = 0.0j, np.empty(len(time))
    for row in range(len(time)):
        swing = turn * swing + rng.standard_normal() + 1j * rng.standard_normal()
        sea[row] = swing.real
    assert is_in_waves(sea)
    assert not is_in_waves(np.tile(np.exp(-0.05 * TIME) * np.cos(2.5 * TIME), 5)), "five releases in one record"
