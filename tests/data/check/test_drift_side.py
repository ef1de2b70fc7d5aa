"""A bow that points out of the turn is said to do so, with the place of the antenna that would explain it."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.data.check.conventions import drift_side_findings
from seatrial.data.check.motion import RecordedMotion


def turns(drift_deg: float, antenna: float = 0.0) -> RecordedMotion:
    """A ship of 3 m/s that turns by 300 deg to starboard and as far to port, its bow `drift_deg` inside the turn.

    antenna: where the velocities were measured, m ahead of midship.
    """
    time = np.arange(0.0, 200.0, 0.5)
    r = np.radians(3.0) * np.where(time < 100.0, 1.0, -1.0)
    psi = np.cumsum(r) * 0.5
    drift = np.radians(drift_deg) * np.sign(r)
    u, v = 3.0 * np.cos(drift), -3.0 * np.sin(drift) + antenna * r
    north, east = u * np.cos(psi) - v * np.sin(psi), u * np.sin(psi) + v * np.cos(psi)
    channels = {"u": u, "v": v, "r": r, "psi": psi, "x0": np.cumsum(north) * 0.5, "y0": np.cumsum(east) * 0.5}
    return RecordedMotion(Record.from_arrays("turns", time, channels))


def test_a_bow_inside_the_turn_is_no_finding() -> None:
    assert drift_side_findings(turns(8.0)) == ()


def test_a_bow_outside_both_turns_is_a_warning_with_both_angles() -> None:
    (finding,) = drift_side_findings(turns(-8.0))
    assert finding.code == "drift-side"
    assert "8.0 deg in turns to starboard, 8.0 deg in turns to port" in finding.evidence


@pytest.mark.parametrize("is_stated", [False, True])
def test_an_antenna_at_the_bow_shows_it_until_it_is_stated(is_stated: bool) -> None:
    """20 m ahead: 0.35 rad/s m of sway over 3 m/s are 19 deg outward, less the drift of 8 deg."""
    motion = turns(8.0, 20.0)
    if is_stated:
        record = motion.record
        stated = replace(record.channel("v"), reference_point=20.0)
        assert drift_side_findings(RecordedMotion(record.with_channel("v", stated))) == ()
        return
    (finding,) = drift_side_findings(motion)
    aft = (20.0 * np.radians(3.0) - 3.0 * np.sin(np.radians(8.0))) / np.radians(3.0)
    assert f"the point without drift lies {aft:.0f} m aft" in finding.evidence


def test_a_swing_of_less_than_half_a_circle_is_no_turn() -> None:
    record = turns(-8.0).record.between(80.0, 120.0)
    assert drift_side_findings(RecordedMotion(record)) == ()


@pytest.mark.parametrize(
    "symbols, count", [(("command_1", "command_2"), 1), (("command_3",), 0), (("alpha_1", "alpha_2"), 0)]
)
def test_nothing_is_said_of_a_craft_whose_thrusters_can_push_to_the_side(symbols: tuple[str, ...], count: int) -> None:
    record = turns(-8.0).record
    thrusters = Record.from_arrays("t", record.time, dict.fromkeys(symbols, np.zeros(len(record))))
    both = replace(record, channels={**record.channels, **thrusters.channels})
    assert len(drift_side_findings(RecordedMotion(both))) == count
