"""Programmes of manoeuvres: from a text such as ``zigzag:20/10:port`` to a compiled helmsman and his memory."""

import math
from collections.abc import Callable
from dataclasses import dataclass

from seatrial.core.values import Array, InputError
from seatrial.physics.manoeuvres import helmsman
from seatrial.physics.manoeuvres.helmsman import Steering

SIDES = {"starboard": 1, "port": -1}
ZIGZAG_EXECUTES = 5  # executes of a zigzag where none are given: two overshoots each side; chosen
LENGTHS_PER_EXECUTE = 40.0  # longest time of an execute, ship lengths travelled; chosen
TURNING_CIRCLE_TURN = 540.0  # deg of heading change, one and a half turns: enough for a steady turn
PULL_OUT_TURN = 360.0
SPIRAL_HOLD_LENGTHS = 15.0  # ship lengths travelled at each rudder angle; chosen
_CIRCLE_LENGTHS, _PULL_OUT_LENGTHS, _PRBS_LENGTHS = 150.0, 200.0, 200.0  # ship lengths at the longest; chosen
_MOST_EXECUTES = 50  # of each angle; guards against a slip
_RUDDER, _SPIRAL_RUDDER = 20.0, 25.0  # deg, where none is given; chosen


@dataclass(frozen=True)
class Programme:
    """A manoeuvre to be steered.

    Attributes:
        text: the programme in its canonical form.
        kind: its first word, e.g. ``zigzag``.
        helmsman: compiled command(t, x, memory, u).
        memory: makes the helmsman's initial memory for a ship's steering.
        maximum_lengths: ship lengths after which it ends at the latest; it ends earlier when the helmsman has finished.
    """

    text: str
    kind: str
    helmsman: Callable[..., None]
    memory: Callable[[Steering], Array]
    maximum_lengths: float


def programme(text: str) -> Programme:
    """Return the programme that `text` names, fields separated by colons, angles in degrees.

    ``zigzag:20/10[:port]`` rudder angle / switching heading, five executes; ``consecutive-zigzags[:5]`` 10/10 to 30/30
    with so many executes each; ``turning-circle:35[:port]`` 540 deg of heading; ``pull-out:20[:port]``;
    ``spiral[:25][:port]``; ``prbs[:amplitude[:switching time in s[:seed]]]``, an empty
    switching time being one ship length at approach speed. Sides default to starboard.

    Raises:
        InputError: the text names no programme, or its numbers cannot be read.
    """
    kind, *fields = text.strip().split(":")
    if kind not in _KINDS:
        examples = ", ".join(example for _, example in _KINDS.values())
        raise InputError(f"unknown manoeuvre '{text}'; known are {examples}")
    maker, example = _KINDS[kind]
    try:
        return maker(text.strip(), fields)
    except (ValueError, IndexError) as error:
        detail = f": {error}" if isinstance(error, InputError) else ""
        raise InputError(f"cannot read the manoeuvre '{text}'{detail}; write it like {example}") from None


def _angle(text: str, largest: float = 90.0) -> float:
    angle = float(text)
    if not 0.0 < angle <= largest:
        raise InputError(f"the angle {text} is not between 0 and {largest:g} degrees")
    return angle


def _split_side(fields: list[str]) -> tuple[int, list[str]]:
    if fields and fields[-1] in SIDES:
        return SIDES[fields[-1]], fields[:-1]
    return 1, fields


def _refuse_extra_fields(fields: list[str], count: int) -> None:
    if len(fields) > count:
        raise InputError(f"'{fields[count]}' is one field too many")


def _zigzag(text: str, fields: list[str]) -> Programme:
    side, fields = _split_side(fields)
    _refuse_extra_fields(fields, 1)
    rudder, heading = (_angle(a) for a in fields[0].split("/"))
    return _zigzag_programme(text, "zigzag", [(rudder, heading)] * ZIGZAG_EXECUTES, side)


def _consecutive_zigzags(text: str, fields: list[str]) -> Programme:
    _refuse_extra_fields(fields, 1)
    each = int(fields[0]) if fields else ZIGZAG_EXECUTES
    if not 1 <= each <= _MOST_EXECUTES:
        raise InputError(f"{each} executes of each angle are not between 1 and {_MOST_EXECUTES}")
    # deg, zigzag angles 10/10 to 30/30; chosen
    executes = [(angle, angle) for angle in (10.0, 15.0, 20.0, 25.0, 30.0) for _ in range(each)]
    return _zigzag_programme(text, "consecutive-zigzags", executes, 1)


def _zigzag_programme(text: str, kind: str, executes: list[tuple[float, float]], side: int) -> Programme:
    table, count = helmsman.zigzag_table(executes, side), len(executes)
    longest = LENGTHS_PER_EXECUTE * count
    return Programme(text, kind, helmsman.zigzag, lambda steering: steering.memory(count, table), longest)


def _turning_circle(text: str, fields: list[str]) -> Programme:
    side, fields = _split_side(fields)
    _refuse_extra_fields(fields, 1)
    table = side * math.radians(_angle(fields[0])), side * math.radians(TURNING_CIRCLE_TURN)
    return Programme(text, "turning-circle", helmsman.turning, lambda ship: ship.memory(1, table), _CIRCLE_LENGTHS)


def _pull_out(text: str, fields: list[str]) -> Programme:
    side, fields = _split_side(fields)
    _refuse_extra_fields(fields, 1)
    rudder = _angle(fields[0]) if fields else _RUDDER
    table = side * math.radians(rudder), side * math.radians(PULL_OUT_TURN)
    return Programme(text, "pull-out", helmsman.turning, lambda ship: ship.memory(2, table), _PULL_OUT_LENGTHS)


def _spiral(text: str, fields: list[str]) -> Programme:
    side, fields = _split_side(fields)
    _refuse_extra_fields(fields, 1)
    steps = helmsman.spiral_steps(_angle(fields[0]) if fields else _SPIRAL_RUDDER, side)

    def memory(steering: Steering) -> Array:
        return steering.memory(len(steps), (SPIRAL_HOLD_LENGTHS * steering.characteristic_time, *steps))

    return Programme(text, "spiral", helmsman.timetable, memory, SPIRAL_HOLD_LENGTHS * len(steps) + 10.0)


def _prbs(text: str, fields: list[str]) -> Programme:
    _refuse_extra_fields(fields, 3)
    amplitude = _angle(fields[0]) if fields else _RUDDER
    stated = len(fields) > 1 and fields[1] != ""
    hold = float(fields[1]) if stated else 0.0
    if stated and not (math.isfinite(hold) and hold > 0.0):
        raise InputError(f"the switching time {fields[1]} s is not positive")
    steps = helmsman.binary_sequence(amplitude, int(fields[2]) if len(fields) > 2 else 0)

    def memory(steering: Steering) -> Array:
        return steering.memory(len(steps), (hold or steering.characteristic_time, *steps))

    return Programme(text, "prbs", helmsman.timetable, memory, _PRBS_LENGTHS)


_KINDS: dict[str, tuple[Callable[[str, list[str]], Programme], str]] = {
    "zigzag": (_zigzag, "zigzag:20/20 or zigzag:10/10:port"),
    "consecutive-zigzags": (_consecutive_zigzags, "consecutive-zigzags:5"),
    "turning-circle": (_turning_circle, "turning-circle:35 or turning-circle:35:port"),
    "pull-out": (_pull_out, "pull-out:20"),
    "spiral": (_spiral, "spiral:25"),
    "prbs": (_prbs, "prbs:20:5:1 (amplitude, switching time in s, seed)"),
}
