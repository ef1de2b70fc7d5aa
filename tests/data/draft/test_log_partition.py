"""The only log of a craft with thrusters is used as a whole, in parts that manoeuvres begin."""

import numpy as np

from seatrial.core.values import Record
from seatrial.data.draft.manoeuvres import AutopilotMode, parts_without_gaps
from seatrial.data.draft.stretches import LogStretch

TIME = 1.7e9 + np.arange(3001) * 0.1  # a clock that counts from 1970
STRETCHES = [
    LogStretch("turn1", 50.0, 70.0, ""),
    LogStretch("zigzag1", 75.0, 120.0, ""),
    LogStretch("turn2", 160.0, 180.0, ""),
]


def log(moves_from: float = 0.0, moves_to: float = 300.0) -> Record:
    elapsed = TIME - TIME[0]
    speed = np.where((elapsed >= moves_from) & (elapsed <= moves_to), 2.0, 0.0)
    return Record.from_arrays("log", TIME, {"u": speed, "v": 0.0 * speed})


def times(parts: tuple[LogStretch, ...]) -> list[tuple[str, float, float]]:
    return [(one.name, one.start, one.stop) for one in parts]


def test_what_lies_before_a_manoeuvre_is_its_beginning_or_where_it_is_longer_a_part_of_its_own() -> None:
    parts = times(parts_without_gaps(log(), STRETCHES, ()))
    assert parts == [
        ("between_1", 0.0, 50.0), ("turn1", 50.0, 70.0), ("zigzag1", 70.0, 120.0), ("between_2", 120.0, 160.0),
        ("turn2", 160.0, 180.0), ("between_3", 180.0, 300.0),
    ]  # fmt: skip
    assert times(parts_without_gaps(log(), (), ())) == [("between_1", 0.0, 300.0)]


def test_no_part_extends_over_a_change_of_mode() -> None:
    origin = float(TIME[0])
    modes = [
        AutopilotMode("MANUAL", origin + 2.0, origin + 170.0),
        AutopilotMode("AUTO", origin + 170.0, origin + 300.0),
    ]
    parts = parts_without_gaps(log(), [*STRETCHES[:2], LogStretch("turn2", 160.0, 169.0, "")], modes)
    assert times(parts)[-2:] == [("turn2", 160.0, 170.0), ("between_3", 170.0, 300.0)]
    assert "a controller is on" in parts[-1].evidence and "no controller" in parts[0].evidence


def test_long_rest_at_the_ends_of_a_log_is_left_out() -> None:
    parts = parts_without_gaps(log(45.0, 200.0), STRETCHES, ())
    assert abs(parts[0].start - 35.0) < 1.5 and abs(parts[-1].stop - 210.0) < 1.5
    assert parts[-1].name == "between_2", "the ends are parts where they are longer than what lies beside them"
