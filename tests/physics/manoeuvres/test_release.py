"""The text of a release, and the measures of a decay."""

import math

import numpy as np
import pytest

from seatrial.core.values import InputError, Record
from seatrial.physics.manoeuvres.programme import release_angle, roll_measures


def test_sides_have_their_signs() -> None:
    assert release_angle("release:15") == pytest.approx(math.radians(15.0))
    assert release_angle("release:15:port") == pytest.approx(-math.radians(15.0))


@pytest.mark.parametrize("text", ["zigzag:20/20", "release", "release:x", "release:10:aft", "release:10:port:2"])
def test_other_texts_are_refused_with_an_example(text: str) -> None:
    with pytest.raises(InputError, match=r"known is release:15"):
        release_angle(text)


@pytest.mark.parametrize("text", ["release:0", "release:-3", "release:61", "release:inf"])
def test_impossible_angles_are_refused(text: str) -> None:
    with pytest.raises(InputError, match="not between 0 and 60"):
        release_angle(text)


def test_a_decay_that_ends_early_has_the_measures_that_it_shows() -> None:
    time = 0.05 * np.arange(141)
    record = Record.from_arrays("decay", time, {"phi": 0.2 * np.exp(-0.02 * time) * np.cos(time)})
    shown = roll_measures(record)
    assert list(shown) == ["swing_1_deg"]
    # extremes of exp(-a t) cos(w t): tan(w t) = -a / w
    at = math.pi - math.atan(0.02)
    assert shown["swing_1_deg"] == pytest.approx(math.degrees(-0.2 * math.exp(-0.02 * at) * math.cos(at)), rel=1e-4)


def test_a_record_with_gaps_shows_none() -> None:
    record = Record.from_arrays("decay", 0.1 * np.arange(50), {"phi": np.full(50, np.nan)})
    assert roll_measures(record) == {}
