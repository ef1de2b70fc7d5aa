"""Declared conventions compared with the data: frame, sign, unit, point, and the side of drift."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.text.numbers import significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, Channel, Finding, InputError, Record, Severity, TrialEdit, quantity
from seatrial.core.values.arrays import unwrapped
from seatrial.core.values.notation import COMMANDS, NOTATION, OPPOSITE, positive_direction
from seatrial.data.check.consequences import REVERSED
from seatrial.data.check.consistency import channel_name
from seatrial.data.check.motion import (
    MIN_SAMPLES,
    RecordedMotion,
    recorded_motion,
    smoothed,
    smoothed_derivative,
    window_length,
)
from seatrial.data.readings import (
    OPEN_NATS,
    ColumnReading,
    JointReading,
    JudgedStatements,
    NamedColumn,
    RefutedStatement,
    Samples,
    judge_statements,
    mistaken_units,
)
from seatrial.physics.manoeuvres.turns import course_of

# Declared conventions to the notation table's: sign, frame, reference point, unwrapped angles.

_VELOCITY_PAIRS = (("u", "v"), ("u_dot", "v_dot"))
_UNWRAPPED_CHANNELS = (
    "psi", "wind_direction", "wind_direction_relative", *(c for c in COMMANDS if c.startswith("alpha"))
)  # fmt: skip

_UPRIGHT_CHANNELS = ("phi", "theta")


def canonical_record(record: Record, reference_point: float = 0.0) -> Record:
    """Return the record in the notation table's conventions, by its declared metadata only.

    Every channel points in the table's positive direction (positive rudder turns to starboard), u and v are body-fixed,
    v, x0 and y0 refer to the point `reference_point` metres forward of midship, headings and wind angles are
    unwrapped, roll and pitch also about upright. Applying it twice changes nothing.

    Raises:
        InputError: a positive direction is unknown, or the heading or yaw rate a conversion needs is missing.
    """
    return _moved_to_reference_point(_in_body_axes(with_standard_signs(record)), reference_point)


def with_standard_signs(record: Record) -> Record:
    """Return the record with the table's signs and angles unwrapped; frames and reference points as they were.

    Raises:
        InputError: a positive direction is neither the notation table's nor its opposite.
    """
    flipped = [s for s, c in record.channels.items() if _has_opposite_sign(s, c, record.name)]
    channels = {s: _with_standard_sign(s, c, flip=s in flipped) for s, c in record.channels.items()}
    record = replace(record, channels=channels)
    return record.with_step(f"sign of {', '.join(flipped)} turned") if flipped else record


def _has_opposite_sign(symbol: str, channel: Channel, record: str) -> bool:
    if symbol not in NOTATION:
        return False
    wanted = positive_direction(symbol, channel.frame)
    if channel.positive == wanted:
        return False
    if channel.positive != OPPOSITE.get(wanted):
        either = f"'{wanted}' or '{OPPOSITE[wanted]}'" if wanted in OPPOSITE else f"'{wanted}'"
        raise InputError(f"record '{record}', channel '{symbol}': positive must be {either}, not '{channel.positive}'")
    return True


def _with_standard_sign(symbol: str, channel: Channel, *, flip: bool) -> Channel:
    values = -channel.values if flip else channel.values
    if symbol in _UNWRAPPED_CHANNELS:
        values = unwrapped(values)
    if symbol in _UPRIGHT_CHANNELS and np.any(np.isfinite(values)):
        values = unwrapped(values)
        values = values - math.tau * np.round(np.nanmean(values) / math.tau)
    positive = positive_direction(symbol, channel.frame) if symbol in NOTATION else channel.positive
    return replace(channel.with_values(values), positive=positive)


def _in_body_axes(record: Record) -> Record:
    """u = x0' cos(psi) + y0' sin(psi), v = -x0' sin(psi) + y0' cos(psi) (Fossen 2021, eq. 2.42 inverted)."""
    for a, b in _VELOCITY_PAIRS:
        frames = {s: record.channel(s).frame for s in (a, b) if s in record}
        if "earth" not in frames.values():
            continue
        if set(frames.values()) != {"earth"} or len(frames) < 2 or "psi" not in record:
            raise InputError(
                f"record '{record.name}': turning earth-fixed {a}, {b} into the ship's axes needs both of them "
                "and the heading 'psi'"
            )
        c, s = np.cos(record["psi"]), np.sin(record["psi"])
        north, east = record.channel(a), record.channel(b)
        ahead = _body_fixed_channel(a, north, north.values * c + east.values * s)
        aside = _body_fixed_channel(b, east, east.values * c - north.values * s)
        record = record.with_channel(a, ahead).with_channel(b, aside, f"{a}, {b} turned into the ship's axes")
    return record


def _body_fixed_channel(symbol: str, channel: Channel, values: Array) -> Channel:
    return replace(channel.with_values(values), frame="body", positive=quantity(symbol).positive)


def _moved_to_reference_point(record: Record, reference_point: float) -> Record:
    """v_P = v + d r, x_P = x + d cos(psi), y_P = y + d sin(psi), d = distance to P (Fossen 2021, section 2.3)."""
    moved, places = [], list[str]()
    for symbol, needed in (("v", {"r", "psi"}), ("v_dot", {"r", "psi"}), ("x0", {"psi"}), ("y0", {"psi"})):
        if symbol not in record:
            continue
        channel = record.channel(symbol)
        distance = reference_point - channel.reference_point
        if distance != 0.0:
            if not needed & set(record.channels):
                raise InputError(
                    f"record '{record.name}': moving '{symbol}' to a point {distance:+g} m off needs the heading 'psi'"
                )
            values = channel.values + distance * _lever(symbol, record)
            record = record.with_channel(symbol, replace(channel.with_values(values), reference_point=reference_point))
            moved.append(symbol)
            places.append(f"{channel.reference_point:g} m")
    same = {s: replace(record.channel(s), reference_point=reference_point) for s in ("u", "u_dot") if s in record}
    record = replace(record, channels={**record.channels, **same})
    if not moved:
        return record
    origin = enumeration(list(dict.fromkeys(places)))
    return record.with_step(f"{', '.join(moved)} moved from x = {origin} to {reference_point:g} m from midship")


def _lever(symbol: str, record: Record) -> Array:
    if symbol in ("x0", "y0"):
        return (np.cos if symbol == "x0" else np.sin)(record["psi"])
    rate = record["r"] if "r" in record else np.gradient(record["psi"], record.time)
    return rate if symbol == "v" else np.gradient(rate, record.time)


# Drift in turns: a hull turns with its bow to the inside, and a record that has it outside is off somewhere.

LEAST_TURN = float(np.radians(180.0))
"""Change of heading in one direction that counts as a turn [rad]: a steady current averages out over more; chosen."""
LEAST_DRIFT = float(np.radians(2.0))
"""Drift to the outside of the turn from which on it is said [rad]: some errors of a compass; chosen."""
_SLOW = 0.3  # share of the record's highest speed ahead, below which a craft spins rather than turns; chosen


@dataclass(frozen=True)
class _Turn:
    """A turn's mean drift to its outside [rad], and how far the point without drift lies aft of midship [m]."""

    is_starboard: bool
    outward: float
    aft: float


def drift_side_findings(motion: RecordedMotion) -> tuple[Finding, ...]:
    """Return a warning `drift-side` where the bow points out of every turn, at midship as declared; else nothing.

    Forces on the hull need a drift to the inside (Fossen 2021, Handbook of Marine Craft Hydrodynamics and Motion
    Control, 2nd ed., section 3.3, sideslip and crab angle): sway is negative in a turn to starboard. Thrusters that can
    push to the side turn a craft with any drift: nothing is said of these.
    """
    turns = [] if _may_push_aside(motion.record) else _turns(motion)
    if not turns or any(turn.outward < LEAST_DRIFT for turn in turns):
        return ()
    sides = [
        f"{np.degrees(np.mean([t.outward for t in turns if t.is_starboard == side])):.1f} deg in turns to {name}"
        for side, name in ((True, "starboard"), (False, "port"))
        if any(t.is_starboard == side for t in turns)
    ]
    aft = float(np.median([t.aft for t in turns]))
    return (Finding(
        Severity.WARNING, "drift-side", f"record '{motion.record.name}': the bow points out of the turn, where that of "
        "a ship points into it", f"{', '.join(sides)}; the point without drift lies {significant(aft, 2)} m aft of "
        "where the velocities are said to be",
        "if the antenna is ahead of midship, state it: antenna = { x = ..., y = ... } under [[records]]; else check "
        "the signs of v, of heading and of course",
    ),)  # fmt: skip


def _may_push_aside(record: Record) -> bool:
    """Whether thrusters can hold sway and yaw apart: three of them, or two whose directions change."""
    return "command_3" in record or "alpha_2" in record


def _turns(motion: RecordedMotion) -> list[_Turn]:
    """Turns by their later half, where the drift has settled."""
    record = motion.record
    psi, dt = record["psi"], record.dt
    inner = smoothed_derivative(psi, dt, motion.window_samples)
    margin = (len(psi) - len(inner)) // 2
    rate = np.pad(inner, (margin, len(psi) - len(inner) - margin), mode="edge")
    body = _in_body_axes(record)
    ahead, aside = body["u"], body["v"] - rate * record.channel("v").reference_point
    course, turns = course_of(psi), []
    for turn in (turn for turn in course.turns if abs(turn.angle) >= LEAST_TURN):
        first = turn.first + int(np.searchsorted(_turned(psi[turn.first : turn.last + 1]), 0.5))
        u, v, r = (np.nanmean(values[first : turn.last - course.scale]) for values in (ahead, aside, rate))
        if u > _SLOW * np.nanmax(ahead) and r != 0.0:
            turns.append(_Turn(bool(r > 0.0), float(np.sign(r) * np.arctan2(v, u)), float(v / r)))
    return turns


def _turned(psi: Array) -> Array:
    """Share of a turn's change of heading that is done, (n,), never decreasing."""
    return np.maximum.accumulate(np.abs(psi - psi[0]) / abs(psi[-1] - psi[0]))


# What a trial file states of channels, against what the judge of readings makes of all of them together.

_PAIRS = (("x0", "y0"), ("u", "v"))
_LONE = ("psi", "r", "p", "phi", "theta", "z", "zeta", "delta", "n")
_ANGLES = frozenset({"psi", "phi", "theta"})
_EXCHANGEABLE = (("u", "v"), ("r", "p"), ("psi", "phi"))
_RATES = {"the rate of the heading": ("psi", "r"), "the rate of roll": ("phi", "p")}
_LEAST_RANGE = math.radians(2.0)  # rad, of an angle whose rate is compared; chosen: above the noise of a compass
_EXCHANGED = 8.0  # nats against two columns that have changed places; chosen: rarer than another wrong statement
_LARGE_OFFSET = math.radians(15.0)  # rad, of a heading; chosen: smaller ones show in `closure`
_AXES = {"earth": "earth-fixed (north, east)", "body": "the ship's own (surge, sway)"}

_Statement = tuple[str, str, tuple[TrialEdit, ...]]  # code, text and edits of a finding


def statement_findings(record: Record) -> tuple[tuple[Finding, ...], frozenset[str]]:
    """Return findings on what is stated of the channels of a clean record in standard signs, and the refuted symbols.

    Unit, side, axes and zero of each, and two channels of one unit that have changed places.
    """
    if len(record) < MIN_SAMPLES:
        return (), frozenset()
    judged = judge_statements(_columns(record))
    exchange, after = _exchange(record, judged)
    findings = [_exchange_finding(record, exchange, judged, after)] if exchange else []
    for one in after.refuted:
        if not exchange or not {column.reading.symbol for column in one.columns} <= set(exchange):
            findings += [_finding(record, one, statement) for statement in _statements(record, one.columns, one.best)]
    symbols = {column.reading.symbol for one in after.refuted for column in one.columns}
    return (*findings, *_unlike_rates(record, after)), frozenset(symbols | set(exchange))


def _columns(record: Record) -> list[list[NamedColumn]]:
    """The channels that are judged, those that are read together in one list."""
    of_one_point = _at_positions(record)
    groups = [
        pair for pair in _PAIRS if {*pair} <= {*record.channels} and len({record.channel(s).frame for s in pair}) == 1
    ]
    lone = [s for s in (*_LONE, "u") if s in record and not any(s in pair for pair in groups)]
    groups += [(s,) for s in lone if s != "zeta" or record.channel(s).reference_point == 0.0]  # waves met at midship
    return [[_column(of_one_point, symbol) for symbol in group] for group in groups if _moves(record, group)]


def _moves(record: Record, symbols: Sequence[str]) -> bool:
    """Whether something shows how channels are read; a constant velocity turns with the heading."""
    return len(symbols) > 1 or float(np.ptp(record[symbols[0]])) > 0.0


def _is_of_one_frame(record: Record, symbols: Sequence[str]) -> bool:
    return len({record.channel(symbol).frame for symbol in symbols if symbol in record}) == 1


def _column(record: Record, symbol: str) -> NamedColumn:
    channel = record.channel(symbol)
    samples = Samples(record.time, channel.values, symbol in _ANGLES)
    offset = _heading_offset(record) if symbol == "psi" else 0.0
    offsets = (offset,) if abs(offset) > _LARGE_OFFSET else ()
    return NamedColumn(ColumnReading(symbol, channel.unit, channel.frame), samples, is_stated=True, offsets=offsets)


def _heading_offset(record: Record) -> float:
    """The angle [rad] to be added to psi with which body-fixed velocities fit the track best; 0: nothing shows it."""
    motion = recorded_motion(record)
    if motion is None or motion.frame != "body":
        return 0.0
    track, velocity = motion.smoothed_velocities
    return float(np.angle(np.sum(track * np.conj(velocity))))


def _at_positions(record: Record) -> Record:
    """The record with velocities of the point whose positions are given (Fossen 2021, section 2.3)."""
    motion = recorded_motion(record)
    if motion is None or motion.reference_offset == 0.0:
        return record
    lever = motion.reference_offset * np.gradient(record["psi"], record.dt)
    is_body = motion.frame == "body"
    ahead = np.zeros_like(lever) if is_body else -lever * np.sin(record["psi"])
    aside = lever if is_body else lever * np.cos(record["psi"])
    values = {"u": record["u"] + ahead, "v": record["v"] + aside}
    moved = {symbol: record.channel(symbol).with_values(array) for symbol, array in values.items()}
    return replace(record, channels={**record.channels, **moved})


def _exchange(record: Record, judged: JudgedStatements) -> tuple[tuple[str, ...], JudgedStatements]:
    """The two channels that have changed places, with what is judged then; none where no such explain more."""
    is_explained = not judged.refuted and not judged.is_unexplained
    pairs = [pair for pair in _EXCHANGEABLE if {*pair} <= {*record.channels} and not is_explained]
    pairs += [("p", "r")] if "r" not in record and "p" in record else []
    best: tuple[tuple[str, ...], JudgedStatements] = ((), judged)
    for pair in pairs:
        if _is_of_one_frame(record, pair):
            other = judge_statements(_columns(_with_exchanged(record, *pair)))
            if other.nats - _EXCHANGED > best[1].nats + (0.0 if not best[0] else -_EXCHANGED):
                best = (pair, other)
    return best


def _with_exchanged(record: Record, one: str, other: str) -> Record:
    names = {one: other, other: one}
    channels = {
        names.get(symbol, symbol): Channel.from_notation(names[symbol], channel.values) if symbol in names else channel
        for symbol, channel in record.channels.items()
    }
    return replace(record, channels=channels)


def _exchange_finding(
    record: Record, pair: Sequence[str], before: JudgedStatements, after: JudgedStatements
) -> Finding:
    one, other = (s for s in sorted(pair, key=lambda s: s not in record))
    labels = [channel_name(record, symbol) for symbol in (one, other)]
    refuted = [entry for entry in after.refuted if {c.reading.symbol for c in entry.columns} <= set(pair)]
    statements = [text for entry in refuted for text in _statements(record, entry.columns, entry.best)]
    text = f"{labels[0]} and {labels[1]} have changed places" if other in record else f"{labels[0]} is {labels[1]}"
    text = "; ".join([text, *(words for _, words, _ in statements)])
    gain = after.nats - _EXCHANGED - before.nats
    edits = (TrialEdit(f"channels.{one}", exchanged_with=f"channels.{other}"), *(e for s in statements for e in s[2]))
    return _with_odds(record, "mislabelled", text, gain, "", edits)


def _finding(record: Record, refuted: RefutedStatement, statement: _Statement) -> Finding:
    code, text, edits = statement
    alternatives = [words for columns, best in refuted.instead for _, words, _ in _statements(record, columns, best)]
    if not refuted.is_only and alternatives:
        text = f"{text}, or {' and '.join(alternatives)}"
    return _with_odds(record, code, text, refuted.gain, refuted.reason, edits if refuted.is_only else ())


def _with_odds(record: Record, code: str, text: str, gain: float, reason: str, edits: tuple[TrialEdit, ...]) -> Finding:
    evidence = f"exp({gain:.0f}) times as likely as what is stated, by {reason or 'all channels together'}"
    severity = Severity.ERROR if gain >= OPEN_NATS else Severity.WARNING
    advice = "correct the wrong one in the trial file"
    return Finding(severity, code, f"record '{record.name}': {text}", evidence, advice, edits=edits)


def _statements(record: Record, columns: Sequence[NamedColumn], best: JointReading) -> Iterator[_Statement]:
    """What is wrong of columns that are read as best, key by key."""
    stated = [column.reading for column in columns]
    symbols = [reading.symbol for reading in stated]
    names = ", ".join(channel_name(record, s) for s in symbols)
    verb = "is" if len(symbols) == 1 else "are"
    lead, read = stated[0], best.readings[0]
    if read.factor != lead.factor:
        yield _unit_statement(symbols, f"{names} {verb}", read.factor)
    if read.frame != lead.frame:
        yield _frame_statement(symbols, names, read.frame)
    for reading, symbol in zip(best.readings, symbols, strict=True):
        if reading.positive:
            edit = TrialEdit(f"channels.{symbol}.positive", REVERSED)
            yield (
                "wrong-sign",
                f"{channel_name(record, symbol) if symbol in record else symbol} has the opposite sign",
                (edit,),
            )
        if reading.offset:
            text = f"{names} is off by {math.degrees(reading.offset):+.0f} deg: another zero"
            yield "wrong-zero", text, (TrialEdit(f"channels.{symbol}.offset", f"{reading.offset:.6g}", "rad"),)


def _unit_statement(symbols: Sequence[str], subject: str, factor: float) -> _Statement:
    stated, true, _ = next(key for key in mistaken_units(symbols[0]) if key[2] == factor)
    if not true:
        edits = tuple(TrialEdit(f"channels.{s}.scale", f"{factor:g}") for s in symbols)
        return "wrong-unit", f"{subject} {1.0 / factor:g} times too large", edits
    edits = tuple(TrialEdit(f"channels.{s}.unit", f'"{true}"') for s in symbols)
    return "wrong-unit", f"{subject} in {true} although declared in {stated}", edits


def _frame_statement(symbols: Sequence[str], names: str, frame: str) -> _Statement:
    if symbols[0] == "psi":
        text = f"{names} counts from east, counter-clockwise, not from north"
        return "wrong-frame", text, (TrialEdit("channels.psi.frame", '"enu"'),)
    if frame == "enu":
        edit = TrialEdit(f"channels.{symbols[0]}", exchanged_with=f"channels.{symbols[1]}")
        return "wrong-frame", f"{names} are exchanged ({symbols[0]} counts to the east)", (edit,)
    edits = tuple(TrialEdit(f"channels.{s}.frame", f'"{frame}"') for s in symbols)
    return "wrong-frame", f"{names} are {_AXES[frame]} velocities, not as declared", edits


def _unlike_rates(record: Record, judged: JudgedStatements) -> Iterator[Finding]:
    """An error for each rate that follows its angle in no reading."""
    for relation, (angle, rate) in _RATES.items():
        if judged.relations.get(relation, 0.0) > -OPEN_NATS:
            continue
        length = window_length(len(record))
        if np.ptp(smoothed(record[angle], length)) < _LEAST_RANGE:
            continue
        turning = smoothed_derivative(record[angle], record.dt, length)
        match = float(np.corrcoef(turning, smoothed(record[rate], length))[0, 1])
        text = f"record '{record.name}': {channel_name(record, rate)} is not {relation} in any reading"
        evidence, advice = f"correlation {match:.3f}", f"look for it in another column, or remove channels.{rate}"
        yield Finding(Severity.ERROR, "contradiction", text, evidence, advice)
