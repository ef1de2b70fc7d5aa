"""Heave and pitch show their signs by the waves that move the craft, in a simulated ship whose signs are known."""

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.data.draft.behaviour import wave_motion_signs
from seatrial.data.draft.column_guess import ColumnGuess

TIME = 0.1 * np.arange(2001)
PERIODS, PHASES = np.array([6.0, 7.5, 9.0, 11.0]), np.array([0.3, 1.9, 4.0, 5.1])  # s; rad, chosen


def head_seas(heave_positive_up: bool, bow_up: bool) -> Record:
    """Waves so long that the craft follows them: w = zeta upwards, pitch by the slope of waves from ahead."""
    angles = np.outer(TIME, 2.0 * np.pi / PERIODS) + PHASES
    zeta = 0.5 * np.cos(angles).sum(axis=1)
    # a wave from ahead, cos(omega t + k x): its front rises towards the bow where the elevation is rising
    slope = -0.02 * np.sin(angles).sum(axis=1)
    channels = {"zeta": zeta, "z": zeta if heave_positive_up else -zeta, "theta": slope if bow_up else -slope}
    return Record.from_arrays("waves", TIME, channels)


@pytest.mark.parametrize(("heave_up", "bow_up"), [(True, True), (True, False), (False, True), (False, False)])
def test_heave_and_pitch_of_head_seas_show_their_signs(heave_up: bool, bow_up: bool) -> None:
    changes = wave_motion_signs(head_seas(heave_up, bow_up))
    heave, pitch = (changes[symbol](ColumnGuess(symbol, symbol, "m")) for symbol in ("z", "theta"))
    assert heave.positive == ("up" if heave_up else "")
    assert pitch.positive == ("" if bow_up else "bow down")
    assert not heave.is_open and not pitch.is_open


def test_a_motion_that_the_waves_do_not_move_stays_open() -> None:
    record = head_seas(heave_positive_up=True, bow_up=True)
    noise = record.channel("z").with_values(np.random.default_rng(1).standard_normal(len(TIME)))
    guess = wave_motion_signs(record.with_channel("z", noise))["z"](ColumnGuess("z", "z", "m"))
    assert guess.is_open


def test_without_waves_nothing_is_decided() -> None:
    assert not wave_motion_signs(Record.from_arrays("calm", TIME, {"z": np.sin(TIME)}))
