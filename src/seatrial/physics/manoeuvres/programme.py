"""Programmes of manoeuvres: from a text such as ``zigzag:20/10:port`` to a compiled helmsman and his memory."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit

from seatrial.core.values import Array, InputError, Record
from seatrial.numerics.kernels.kernel import COMMAND_SIGNATURE, OPTIONS, kernel
from seatrial.physics.hydro.free_roll import swing_extremes

# Helmsmen, and what they know of the ship they steer: compiled commands that work through a table.

# positions in the memory
PSI, R, DELTA, SIGN, SLEW, DT, APPROACH, COURSE, ANGLE, FINISHED, STAGE, STAGE_START, COUNT, TABLE = range(14)
NOT_FINISHED = -1.0
REGISTER_BITS, _ONES = 9, 5  # of the shift register: 511 switching times a period; ones at its start; chosen
_FEEDBACK = 5  # of the register: x^9 + x^5 + 1 is primitive (Zierler & Brillhart 1968, Information and Control 13, 541)


@dataclass(frozen=True)
class Steering:
    """Where a helmsman finds heading and rudder in a model, and how fast the rudder moves.

    Attributes:
        psi, r: places of heading and yaw rate among the states; r is -1 where there is none.
        delta: place of the rudder among the inputs.
        sign: +1 where a positive input turns to starboard, -1 where it turns to port.
        slew_rate: rad/s.
        dt: step of the simulation [s].
        approach: s before the first execute.
        characteristic_time: L/U0 [s], the time in which the ship travels its length.
    """

    psi: int
    r: int
    delta: int
    sign: float
    slew_rate: float
    dt: float
    approach: float
    characteristic_time: float

    def memory(self, count: int, table: Sequence[float]) -> Array:
        """Return the helmsman's initial memory, shape (TABLE + len(table),): `count` stages, described in `table`."""
        head = np.zeros(TABLE)
        head[[PSI, R, DELTA, SIGN, SLEW]] = self.psi, self.r, self.delta, self.sign, self.slew_rate * self.dt
        head[[DT, APPROACH, FINISHED, COUNT]] = self.dt, self.approach, NOT_FINISHED, count
        return np.concatenate([head, np.asarray(table, dtype=np.float64)])


@njit(**OPTIONS)
def turn_rudder(memory, order, u):
    """Move the rudder towards `order` [rad, positive to starboard] by at most one step of the slew rate."""
    before = memory[ANGLE]
    step = min(max(order - before, -memory[SLEW]), memory[SLEW])
    memory[ANGLE] = before + step
    u[int(memory[DELTA])] = memory[SIGN] * (before + 0.5 * step)


@njit(**OPTIONS)
def is_past_approach(t, x, memory):
    """Return whether the approach is over; the heading of that moment becomes the original course."""
    if memory[STAGE] == 0.0:
        if t < memory[APPROACH] - 0.5 * memory[DT]:
            return False
        memory[COURSE], memory[STAGE], memory[STAGE_START] = x[int(memory[PSI])], 1.0, t
    return True


@njit(**OPTIONS)
def heading_deviation(x, memory):
    """Return the heading off the course [rad] half a step ahead, so that executes are not late on average."""
    place = int(memory[R])
    lead = 0.5 * memory[DT] * x[place] if place >= 0 else 0.0
    return x[int(memory[PSI])] + lead - memory[COURSE]


@njit(**OPTIONS)
def next_stage(t, memory):
    """Go to the next stage; after the last one note the time and stay."""
    if memory[FINISHED] >= 0.0:
        return
    if memory[STAGE] >= memory[COUNT]:
        memory[FINISHED] = t
    else:
        memory[STAGE] += 1.0
        memory[STAGE_START] = t


def rudder_angles(step_means: Array) -> Array:
    """Rudder angle at the samples, shape (n,), from the step means a helmsman wrote, shape (n,); amidships at first."""
    signs = np.where(np.arange(len(step_means)) % 2, 1.0, -1.0)
    angles = np.zeros(len(step_means))
    angles[1:] = np.cumsum(2.0 * signs[:-1] * step_means[:-1]) * signs[:-1]
    return np.round(angles, 14) + 0.0  # 14 decimals: rounding of the sums


@kernel(COMMAND_SIGNATURE, **OPTIONS)
def turning(t, x, memory, u):
    """Hold the rudder over until the heading has changed by so much.

    Table: rudder order, heading change that ends the turn [rad, both positive to starboard]. A second stage puts the
    rudder amidships for as long as the turn has taken.
    """
    order = 0.0
    if is_past_approach(t, x, memory):
        if memory[STAGE] == 1.0:
            over = heading_deviation(x, memory) / memory[TABLE + 1] >= 1.0
        else:
            over = t - memory[STAGE_START] >= memory[STAGE_START] - memory[APPROACH]
        if over:
            next_stage(t, memory)
        order = memory[TABLE] if memory[STAGE] == 1.0 else 0.0
    turn_rudder(memory, order, u)


@kernel(COMMAND_SIGNATURE, **OPTIONS)
def zigzag(t, x, memory, u):
    """Reverse the rudder when the heading has deviated by the switching heading.

    Table: order and switching heading [rad, positive to starboard] of every execute.
    """
    order = 0.0
    if is_past_approach(t, x, memory):
        place = TABLE + 2 * (int(memory[STAGE]) - 1)
        switching = memory[place + 1]
        if heading_deviation(x, memory) * np.sign(switching) >= abs(switching):
            next_stage(t, memory)
        order = memory[TABLE + 2 * (int(memory[STAGE]) - 1)]
    turn_rudder(memory, order, u)


def zigzag_table(executes: list[tuple[float, float]], side: int) -> tuple[float, ...]:
    """Return orders and switching headings [rad] of executes given as (rudder, heading) [deg]; the first to `side`."""
    signs = [side * (1 - 2 * (k % 2)) for k in range(len(executes))]
    return tuple(s * float(np.radians(a)) for s, pair in zip(signs, executes, strict=True) for a in pair)


@kernel(COMMAND_SIGNATURE, **OPTIONS)
def timetable(t, x, memory, u):
    """Hold each order for the same time. Table: that time [s], the orders [rad, positive to starboard]."""
    order = 0.0
    if is_past_approach(t, x, memory):
        if t - memory[STAGE_START] >= memory[TABLE] - 0.5 * memory[DT]:
            next_stage(t, memory)
        order = memory[TABLE + int(memory[STAGE])]
    turn_rudder(memory, order, u)


def spiral_steps(largest: float, side: int) -> tuple[float, ...]:
    """Return rudder orders [rad] from `largest` [deg] through amidships to the other side and back (direct spiral)."""
    # deg, steps of the direct spiral, closer near amidships; chosen
    inner = [a for a in (25.0, 20.0, 15.0, 10.0, 5.0, 3.0, 1.0) if a < largest]
    down = [largest, *inner, 0.0, *(-a for a in reversed(inner)), -largest]
    return tuple(side * float(np.radians(a)) for a in (*down, *down[-2::-1]))


def binary_sequence(amplitude: float, seed: int) -> tuple[float, ...]:
    """Rudder orders [rad] of one period of a maximum length sequence, 2^9 - 1 switching times; the seed shifts it."""
    bits = np.random.default_rng(seed).permutation([1] * _ONES + [0] * (REGISTER_BITS - _ONES)).tolist()
    while len(bits) < 2**REGISTER_BITS - 1:
        bits.append(bits[-REGISTER_BITS] ^ bits[_FEEDBACK - REGISTER_BITS])
    return tuple(float(a) for a in np.radians(amplitude) * (2.0 * np.array(bits) - 1.0))


# Programmes of manoeuvres: from a text such as ``zigzag:20/10:port`` to a compiled helmsman and his memory.

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
    table, count = zigzag_table(executes, side), len(executes)
    longest = LENGTHS_PER_EXECUTE * count
    return Programme(text, kind, zigzag, lambda steering: steering.memory(count, table), longest)


def _turning_circle(text: str, fields: list[str]) -> Programme:
    side, fields = _split_side(fields)
    _refuse_extra_fields(fields, 1)
    table = side * math.radians(_angle(fields[0])), side * math.radians(TURNING_CIRCLE_TURN)
    return Programme(text, "turning-circle", turning, lambda ship: ship.memory(1, table), _CIRCLE_LENGTHS)


def _pull_out(text: str, fields: list[str]) -> Programme:
    side, fields = _split_side(fields)
    _refuse_extra_fields(fields, 1)
    rudder = _angle(fields[0]) if fields else _RUDDER
    table = side * math.radians(rudder), side * math.radians(PULL_OUT_TURN)
    return Programme(text, "pull-out", turning, lambda ship: ship.memory(2, table), _PULL_OUT_LENGTHS)


def _spiral(text: str, fields: list[str]) -> Programme:
    side, fields = _split_side(fields)
    _refuse_extra_fields(fields, 1)
    steps = spiral_steps(_angle(fields[0]) if fields else _SPIRAL_RUDDER, side)

    def memory(steering: Steering) -> Array:
        return steering.memory(len(steps), (SPIRAL_HOLD_LENGTHS * steering.characteristic_time, *steps))

    return Programme(text, "spiral", timetable, memory, SPIRAL_HOLD_LENGTHS * len(steps) + 10.0)


def _prbs(text: str, fields: list[str]) -> Programme:
    _refuse_extra_fields(fields, 3)
    amplitude = _angle(fields[0]) if fields else _RUDDER
    stated = len(fields) > 1 and fields[1] != ""
    hold = float(fields[1]) if stated else 0.0
    if stated and not (math.isfinite(hold) and hold > 0.0):
        raise InputError(f"the switching time {fields[1]} s is not positive")
    steps = binary_sequence(amplitude, int(fields[2]) if len(fields) > 2 else 0)

    def memory(steering: Steering) -> Array:
        return steering.memory(len(steps), (hold or steering.characteristic_time, *steps))

    return Programme(text, "prbs", timetable, memory, _PRBS_LENGTHS)


_KINDS: dict[str, tuple[Callable[[str, list[str]], Programme], str]] = {
    "zigzag": (_zigzag, "zigzag:20/20 or zigzag:10/10:port"),
    "consecutive-zigzags": (_consecutive_zigzags, "consecutive-zigzags:5"),
    "turning-circle": (_turning_circle, "turning-circle:35 or turning-circle:35:port"),
    "pull-out": (_pull_out, "pull-out:20"),
    "spiral": (_spiral, "spiral:25"),
    "prbs": (_prbs, "prbs:20:5:1 (amplitude, switching time in s, seed)"),
}


# A release: a ship that rolls is let go from an angle and rolls out, as in a decay test (ITTC 7.5-02-07-04.5).

EXAMPLE = "release:15 or release:15:port"
_LARGEST = 60.0  # deg, beyond which no decay test goes; chosen


def release_angle(text: str) -> float:
    """Return the angle [rad] of ``release:15`` or ``release:15:port``, from the angle of rest, positive to starboard.

    Raises:
        InputError: the text names no release, or its angle is not between 0 and 60 degrees.
    """
    kind, *fields = text.strip().split(":")
    side = SIDES.get(fields[1], 0) if len(fields) == 2 else int(len(fields) == 1)
    try:
        angle = float(fields[0]) if kind == "release" and side else math.nan
    except ValueError:
        angle = math.nan
    if math.isnan(angle):
        raise InputError(f"unknown manoeuvre '{text}' of a model that only rolls; known is {EXAMPLE} (deg)")
    if not 0.0 < angle <= _LARGEST:
        raise InputError(f"the angle {fields[0]} of a release is not between 0 and {_LARGEST:g} degrees")
    return side * math.radians(angle)


def roll_measures(record: Record) -> dict[str, float]:
    """Return measures of a decay that begins with its release, by name; those it does not show are absent.

    ``swing_1_deg`` and ``swing_2_deg``, the extremes to the other side and back; ``period_s``, from the release to the
    second of them; ``half_time_s``, until swings are half as large as the release, log-linear between extremes.
    """
    roll = record["phi"]
    if not np.all(np.isfinite(roll)) or roll[0] == 0.0:
        return {}
    times, sizes = swing_extremes(roll, record.dt)
    measures = {f"swing_{k}_deg": math.degrees(size) for k, size in enumerate(sizes[:2], start=1)}
    if len(times) > 1:
        measures["period_s"] = float(times[1])
    sizes, times = np.append(abs(roll[0]), sizes), np.append(0.0, times)
    if sizes[-1] <= 0.5 * sizes[0]:
        lower = int(np.argmax(sizes <= 0.5 * sizes[0]))
        share = math.log(2.0 * sizes[lower - 1] / sizes[0]) / math.log(sizes[lower - 1] / sizes[lower])
        measures["half_time_s"] = float(times[lower - 1] + share * (times[lower] - times[lower - 1]))
    return measures
