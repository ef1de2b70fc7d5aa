"""Waves that the motions contradict: what the trial states of probe and speed is wrong, the motions are right."""

from pathlib import Path

import pytest
from tests.estimation.identify.test_box_forces_effect import TRIAL, write_trial

from seatrial.core.values import InputError
from seatrial.data.trial import load_trial
from seatrial.estimation.identify.identify import identify

ZETA = '"zeta", unit = "m"'


def findings(folder: Path, old: str, new: str, seconds: float) -> str:
    """What the fit, or its refusal, says of the instruments where the trial says `new` for what is right."""
    assert old in TRIAL
    trial = load_trial(write_trial(folder, 0.0, TRIAL.replace(old, new), seconds))
    try:
        return " ".join(f.text for f in identify(trial).findings if f.code == "sensor-error")
    except InputError as error:
        return str(error)


@pytest.mark.long(every=3)
@pytest.mark.parametrize(
    ("old", "new", "seconds", "said"),
    [
        (ZETA, f"{ZETA}, reference_point = 0.5", 60.0, "the probe stands 0.52 m aft"),
        (ZETA, f"{ZETA}, reference_point = -0.26", 60.0, "the probe stands 0.26 m forward"),
        ("speed = 1.6", "speed = 2.0", 60.0, "at 0.80 of the speed"),
    ],
)
def test_what_is_stated_wrongly_is_named(tmp_path: Path, old: str, new: str, seconds: float, said: str) -> None:
    text = findings(tmp_path, old, new, seconds)
    assert "contradict the waves as they are stated" in text
    assert said in text


def test_an_elevation_upside_down_is_refused_with_both_readings(tmp_path: Path) -> None:
    """Heave and pitch upside down would look alike, and are two faults."""
    text = findings(tmp_path, ZETA, f'{ZETA}, positive = "down"', 120.0)
    assert "'zeta' (zeta) has the opposite sign, or 'theta' (theta) has the opposite sign and 'z' (z)" in text


def test_nothing_is_said_of_waves_stated_rightly(tmp_path: Path) -> None:
    assert not findings(tmp_path, "speed = 1.6", "speed = 1.6", 120.0)
