"""A heel that is held before the release is found, with how long it lasts."""

import numpy as np

from seatrial.core.values import Record
from seatrial.data.check.roll_release import begins_before_release, is_free_decay, release_findings, release_row

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
