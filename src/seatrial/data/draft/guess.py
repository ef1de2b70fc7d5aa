"""What the columns of a log are by name, range and command; unsure stays open, with both readings."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import permutations

import numpy as np

from seatrial.core.values import Array, InputError, Record
from seatrial.data.check import canonical_record
from seatrial.data.check.inputs import SURE_EFFECT, ThrusterEffect, thruster_effects
from seatrial.data.check.motion import jackknife_least_squares, smoothed, smoothed_derivative, window_length
from seatrial.data.draft.column_guess import Changes, ColumnGuess
from seatrial.data.draft.naming import NameGuess, columns_not_needed, guess_by_name, named_side, unit_in_heading
from seatrial.data.draft.stored_parameters import OutputSetting, is_disabled, output_setting
from seatrial.data.draft.stretches import smooth_speed, track_velocity
from seatrial.data.draft.survey import ColumnSummary, LogSurvey, TopicSummary, column_values, columns_by_source
from seatrial.data.readings import name_table
from seatrial.physics.manoeuvres.track import has_track
from seatrial.physics.models.thruster_layout import CommandInput, Thruster, ThrusterLayout

# Columns without names, by what they do: derivatives of one another, the heading of the track, what turns the ship.

# correlation of a column with the derivative of another that makes them a pair, and share by which their ratio may
# differ from one unit to the other; chosen
_PAIR_CORRELATION, _PAIR_RATIO = 0.98, 0.05
_COURSE_ANGLE = math.radians(25.0)  # rad rms between course and heading, up to which ships drift in turns; chosen
_SURE_T = 5.0  # effect over standard error that proves a rudder; as in the checks
_FEWEST_WINDOWS = 4  # of smoothing, in which a craft shows what turns it; chosen
_ANGLE_UNITS = {"deg": math.pi / 180.0, "rad": 1.0}  # rad


@dataclass(frozen=True)
class UnnamedColumn:
    """What a column without a name is, and why."""

    index: int
    symbol: str
    unit: str
    frame: str
    positive: str
    evidence: str


def recognised_columns(columns: dict[int, Array], dt: float) -> list[UnnamedColumn]:
    """Return what columns (numbered from 1, each (n,) without gaps) are; empty where no motion is recognised.

    Two pairs of a position and its rate whose course a third, an angle with its rate, follows are x0, y0, u, v
    (earth-fixed), psi and r; of the rest what leads the yaw acceleration is the rudder.
    """
    length = window_length(len(next(iter(columns.values()), ())))
    if length < 3 or len(columns) < 6:  # columns of a motion; samples of a window
        return []
    rates = {k: smoothed_derivative(values, dt, length) for k, values in columns.items()}
    smooth = {k: smoothed(values, length) for k, values in columns.items()}
    pairs = _derivative_pairs(smooth, rates)
    best: tuple[float, list[UnnamedColumn]] = (_COURSE_ANGLE, [])
    for (x, u), (y, v), (psi, r) in permutations(pairs, 3):
        for unit, size in _ANGLE_UNITS.items():
            misfit = _course_misfit(smooth[u], smooth[v], size * smooth[psi])
            if misfit < best[0]:
                best = (misfit, _motion(x, y, psi, u, v, r, unit, misfit))
    if not best[1]:
        return []
    taken = {one.index for one in best[1]}
    psi = next(one for one in best[1] if one.symbol == "psi")
    yaw = smooth[next(one.index for one in best[1] if one.symbol == "r")]
    rest = {k: values for k, values in smooth.items() if k not in taken}
    return [*best[1], *_rudder(rest, yaw, rates[_index(best[1], "r")], psi.unit)]


def columns_of_turning(columns: dict[int, Array], heading: Array, unit: str, dt: float) -> list[UnnamedColumn]:
    """Return which columns (numbered, each (n,) without gaps) are the rate of a heading, and what turns it.

    heading: (n,), in `unit`, deg or rad. The rate comes in either; the rudder is as for a log that has no names.
    """
    length = window_length(len(heading))
    if not columns or len(heading) < _FEWEST_WINDOWS * length:
        return []
    yaw = smoothed_derivative(np.unwrap(_ANGLE_UNITS[unit] * heading), dt, length)
    smooth = {k: smoothed(values, length) for k, values in columns.items()}
    rates = [
        UnnamedColumn(k, "r", f"{name}/s", "", "", "the derivative of the heading")
        for name, size in _ANGLE_UNITS.items()
        for k, values in smooth.items()
        if abs(abs(_ratio(size * values, yaw)) - 1.0) < _PAIR_RATIO
    ]
    acceleration = smoothed_derivative(yaw, dt, 3)  # samples: it is smooth already
    rest = {k: values[1:-1] for k, values in smooth.items() if k not in {rate.index for rate in rates}}
    return [*rates, *_rudder(rest, yaw[1:-1], acceleration, unit)]


def _ratio(values: Array, rate: Array) -> float:
    """Return the factor by which values follow a rate, 0 where they do not."""
    power, size = float(rate @ rate), float(values @ values)
    if power == 0.0 or size == 0.0:
        return 0.0
    factor = float(values @ rate) / power
    return factor if abs(factor) * math.sqrt(power / size) > _PAIR_CORRELATION else 0.0


def _index(columns: list[UnnamedColumn], symbol: str) -> int:
    return next(column.index for column in columns if column.symbol == symbol)


def _derivative_pairs(smooth: dict[int, Array], rates: dict[int, Array]) -> list[tuple[int, int]]:
    """Column and the column that is its derivative, in the same unit."""
    pairs = []
    for i, rate in rates.items():
        pairs += [(i, j) for j, values in smooth.items() if i != j and abs(_ratio(values, rate) - 1.0) < _PAIR_RATIO]
    return pairs


def _course_misfit(north: Array, east: Array, psi: Array) -> float:
    """The rms angle [rad] between course and heading where the craft moves."""
    speed = np.hypot(north, east)
    moving = speed > 0.3 * float(np.max(speed))  # of the largest speed: a course is well defined
    angle = np.angle(np.exp(1j * (np.arctan2(east, north) - psi)))[moving]
    return float(np.sqrt(np.mean(angle**2))) if angle.size else math.inf


def _motion(x: int, y: int, psi: int, u: int, v: int, r: int, unit: str, misfit: float) -> list[UnnamedColumn]:
    text = f"the track leads where column {psi} points, within {math.degrees(misfit):.0f} deg"
    return [
        UnnamedColumn(x, "x0", "m", "", "", f"column {u} is its derivative; {text}"),
        UnnamedColumn(y, "y0", "m", "", "", f"column {v} is its derivative; {text}"),
        UnnamedColumn(psi, "psi", unit, "", "", f"column {r} is its derivative; {text}"),
        UnnamedColumn(u, "u", "m/s", "earth", "", f"the derivative of column {x}"),
        UnnamedColumn(v, "v", "m/s", "earth", "", f"the derivative of column {y}"),
        UnnamedColumn(r, "r", f"{unit}/s", "", "", f"the derivative of column {psi}"),
    ]


def _rudder(rest: dict[int, Array], yaw: Array, acceleration: Array, unit: str) -> list[UnnamedColumn]:
    """The column that the yaw acceleration follows best: dr/dt = a r + b delta + c (Nomoto 1957, eq. 1)."""
    best = (0.0, 0)
    for k, values in rest.items():
        if np.ptp(values) > 0.0:
            features = np.column_stack([yaw, values, np.ones_like(values)])
            answer, errors = jackknife_least_squares(features, acceleration)
            t = float(answer[1] / errors[1]) if errors[1] > 0 else 0.0
            best = max(best, (t, k), key=lambda one: abs(one[0]))
    t, k = best
    if abs(t) < _SURE_T:
        return []
    side = "starboard" if t > 0 else "port"
    text = f"the yaw acceleration follows it, a positive one turns to {side} (effect over standard error {abs(t):.0f})"
    return [UnnamedColumn(k, "delta", unit, "", "" if t > 0 else "port", text)]


# Commands of thrusters and rudders: what a pulse means, and which way each drives and turns the craft.

_RANGE, _REST, _SPAN = (700.0, 2300.0), 1500.0, 400.0  # us, of servo pulses (ArduPilot, SERVOn_MIN, MAX)
_NEVER_IDLE = 1200.0  # us; a motor of one direction idles between 1000 and 1100, and every log holds that; chosen
_REST_TOLERANCE = 60.0  # us; chosen: trims of motors that stand still
_SURELY_PERCENT = 20.0  # largest size of a command from which on up to 100 is per cent, not volts or amperes; chosen
_FULL_RUDDER = 35.0  # deg, of most ships' rudders (SOLAS II-1/29): what a draft proposes
# share of the largest speed below which a craft stands still, s of it at least, share of full command that is no more
# than rest; chosen
_STILL, _STILL_S, _REST_SHARE = 0.05, 1.0, 0.05
_ONLY_SIGN = 'positive = "astern", and which side it drives: the log does not say'


def command_guess(guess: ColumnGuess, column: ColumnSummary, survey: LogSurvey) -> ColumnGuess | None:
    """Return a command as a share of its range: by the parameters of the output where the log has them, else its rest.

    An output that steers is a rudder angle; None: the output is disabled.
    """
    parameters = survey.log.parameters
    number = int(guess.symbol.removeprefix("command_"))
    if guess.unit == "percent":
        return guess.with_evidence("in per cent, as the log says")
    if column.low >= -1.0 and column.high <= 1.0:
        return replace(guess, unit="1").with_evidence("between -1 and 1")
    if column.low >= -100.0 and column.high <= 100.0 and max(-column.low, column.high) > _SURELY_PERCENT:
        other = _ONLY_SIGN if column.low < 0.0 else "set zero and span: command = (cell - zero) / span"
        text = f"from {column.low:g} to {column.high:g}: per cent of full command"
        return replace(guess, unit="percent", other_reading=other).with_evidence(text)
    if not (_RANGE[0] <= column.low and column.high <= _RANGE[1]):
        return replace(guess, unit="1", other_reading="set zero and span: command = (cell - zero) / span")
    if is_disabled(parameters, number):
        return None
    setting = output_setting(parameters, number)
    if setting is not None and setting.is_rudder:
        return _as_rudder(guess, setting)
    if setting is not None and setting.span:
        stated = replace(guess, unit="us", zero=setting.zero, span=setting.span)
        return replace(stated, positive="astern" if setting.is_reversed else "").with_evidence(setting.evidence)
    pulse = _by_rest(guess, column)
    return pulse if setting is None else pulse.with_evidence(setting.evidence)


def _by_rest(guess: ColumnGuess, column: ColumnSummary) -> ColumnGuess:
    text = f"pulses of {column.low:g} to {column.high:g} us, {column.common:g} the most often"
    distance = abs(column.common - _REST)
    zero = column.common if distance < _REST_TOLERANCE else _REST
    pulse = replace(guess, unit="us", zero=zero, span=_SPAN).with_evidence(text)
    to_both_sides = column.low > _NEVER_IDLE and min(_REST - column.low, column.high - _REST) > _REST_TOLERANCE
    if distance == 0.0 or (to_both_sides and distance >= _REST_TOLERANCE):
        return replace(pulse, other_reading=_ONLY_SIGN)
    other = f"zero = {_REST:g}" if distance < _REST_TOLERANCE else "zero = 1000, span = 1000 (one direction)"
    return replace(pulse, other_reading=other)


def _as_rudder(guess: ColumnGuess, setting: OutputSetting) -> ColumnGuess:
    """A rudder's order: the angle at full deflection is no parameter of an autopilot."""
    zero, span = (setting.zero, setting.span) if setting.span else (_REST, _SPAN)
    rudder = replace(guess, symbol="delta", unit="deg", zero=zero, span=span, scale=_FULL_RUDDER, kind="command")
    other = "scale = the rudder angle at full deflection in deg: the log does not say"
    side = "port" if setting.is_reversed else ""
    return replace(rudder, positive=side, other_reading=other).with_evidence(setting.evidence)


def rudder_in_percent(guess: ColumnGuess) -> ColumnGuess:
    """Return a rudder that is logged as a share of its range as an angle; which one full deflection is stays open."""
    other = f"scale = the angle at 100 per cent in deg, not {_FULL_RUDDER:g}: the log does not say"
    percent = replace(guess, unit="deg", span=100.0, scale=_FULL_RUDDER, other_reading=other)  # per cent of full
    return percent.with_evidence("in per cent")


def rest_of_commands(record: Record) -> Changes:
    """Return the commands that are at rest at 0 or the middle pulse, as the craft stands still with it at the start."""
    names = [name for name in record.channels if name.startswith("command_")]
    flow = smooth_speed(record)
    if not names or flow is None:
        return {}
    moving = np.flatnonzero(flow > _STILL * np.max(flow))
    rows = int(moving[0]) if moving.size else 0
    if rows * record.dt < _STILL_S:
        return {}
    resting = [name for name in names if np.max(np.abs(record[name][:rows])) < _REST_SHARE]
    return dict.fromkeys(resting, _with_known_rest)


def _with_known_rest(guess: ColumnGuess) -> ColumnGuess:
    if guess.unit not in ("us", "percent") or not guess.is_open:
        return guess
    text = f"the craft stands still with {guess.zero:g} {'us' if guess.unit == 'us' else 'per cent'} at the start"
    return replace(guess, other_reading=_ONLY_SIGN).with_evidence(text)


def command_directions(record: Record) -> Changes:
    """Return what shows which way each command drives the craft and to which side it turns it."""
    names = [name for name in record.channels if name.startswith("command_")]
    record = _with_speeds(record)
    if not names or not {"u", "r", "psi"} <= set(record.channels):
        return {}
    try:
        body = canonical_record(record, 0.0)
    except InputError:
        return {}
    # one metre to port: ahead turns to starboard, so that an effect on yaw is positive to that side
    to_port = tuple(Thruster(name, 0.0, -1.0, CommandInput(name)) for name in names)
    effects = thruster_effects(ThrusterLayout(to_port), [body])
    return {
        name: partial(_with_direction, effect)
        for name, effect in zip(names, effects, strict=True)
        if abs(effect.surge) > SURE_EFFECT
    }


def _with_speeds(record: Record) -> Record:
    """The record with the speeds ahead and to starboard as the positions show them, where no speed is recorded."""
    if "u" in record or not has_track(record) or "psi" not in record:
        return record
    north, east = track_velocity(record)
    cos, sin = np.cos(record["psi"]), np.sin(record["psi"])
    speeds = {"u": north * cos + east * sin, "v": east * cos - north * sin}
    motion = Record.from_arrays("motion", record.time, speeds)
    return record.with_channel("u", motion.channel("u")).with_channel("v", motion.channel("v"))


def _with_direction(effect: ThrusterEffect, guess: ColumnGuess) -> ColumnGuess:
    """The guess with its direction where nothing but that is open; open where its parameters contradict the motion."""
    if guess.is_open and guess.other_reading != _ONLY_SIGN:
        return guess
    is_astern = (guess.positive == "astern") == (effect.surge > 0.0)
    word = "astern" if is_astern else "ahead"
    text = f"more drives {word} (effect over standard error {abs(effect.surge):.0f})"
    if abs(effect.yaw) > SURE_EFFECT:
        side = "port" if effect.yaw * effect.surge > 0.0 else "starboard"
        guess = replace(guess, side=side)
        text += f"; it turns the craft as a thruster on the {side} side does ({abs(effect.yaw):.0f})"
    if not guess.is_open and is_astern != (guess.positive == "astern"):
        return replace(guess, other_reading=f'positive = "{word}": {text}')
    return replace(guess, positive="astern" if is_astern else "", other_reading="").with_evidence(text)


# What the columns of a log are by name; the judge of readings has their units, frames and signs.

# headings of the angle of a thruster that is turned; a steering angle may be that of a rudder behind a shaft; chosen
_TURNED = re.compile("outboard|azimuth|engine|motor|pod", re.IGNORECASE)
_STEERING = re.compile("steer", re.IGNORECASE)
NOZZLE = re.compile("nozzle|jet|bucket", re.IGNORECASE)
"""In the name of a column that steers by the jet itself."""
# headings of the rate of a propeller or its shaft, which no gear stands before
_SHAFT = re.compile("prop|shaft|welle|aksel|arbre|helice|hélice|elica", re.IGNORECASE)
_TWINS = 2  # rudders, nozzles or shafts of which half the sum is one input
# what such an input means for a model; thrust goes with D^4 at one rate and advance
_OF_TWINS = {
    "delta": "in mmg A_R is the area of both, in mmg_twin that of one",
    "n": "in mmg a propeller of 1.19 times D_P stands for two, mmg_twin has both",
}
_PLACE_OR_SPEED = frozenset({"lat", "x0", "u", "v", "sog", "stw"})
_STEERS = ("delta", "command_", "alpha_", "n_")  # beginnings of the channels of what steers a craft
_WAVES = frozenset({"zeta", "F3", "alpha_w"})  # channels of craft that waves move
_NO_RUDDER = "an order, or what no model takes: then leave it out"
_HEADING_OF_PHONES = "azimuth"  # of the triple azimuth, pitch, roll (Android, SensorManager.getOrientation)
_FOLDERS_READ = 3  # folders above a file whose names may be those of a topic; chosen


def guess_columns(survey: LogSurvey, gear: float = 0.0) -> tuple[ColumnGuess, ...]:
    """Return what the columns of a log are, one for each column whose name says something.

    Of several columns for one channel the one of the fastest topic with fewest missing samples is used.
    gear: turns of the engine over those of the propeller; 0: not stated, and the rate of an engine is not used. A
    column that is called after the propeller or its shaft is taken as it is.
    """
    topics = [topic for topic in survey.topics if topic.time is not None]
    ranked = [ranked_guess for topic in topics for ranked_guess in _ranked_guesses(survey, topic, gear)]
    best: dict[str, _RankedGuess] = {}
    for one in ranked:
        symbol = one.guess.symbol
        if not one.guess.unused_because and (symbol not in best or one.rank < best[symbol].rank):
            best[symbol] = one
    chosen = [_chosen(one.guess, best[one.guess.symbol].guess if one.guess.symbol in best else None) for one in ranked]
    return without_conflicts([chosen])[0]


@dataclass(frozen=True)
class _RankedGuess:
    """What a column is, and its place among those of one channel: the smallest rank is used."""

    rank: tuple[float, ...]
    guess: ColumnGuess


def _ranked_guesses(survey: LogSurvey, topic: TopicSummary, gear: float) -> list[_RankedGuess]:
    """The guesses of a topic."""
    ranked = [_RankedGuess((0.0,), guess) for guess in _without_names(survey, topic)]
    has_tilt = _has_tilt(survey, topic)
    for column in topic.columns:
        named = _named(survey, topic, column)
        if named is None or (column.is_constant and named.symbol.startswith("command_")):
            continue
        if has_tilt and column.name.lower() == _HEADING_OF_PHONES:
            named = replace(named, symbol="psi", evidence="its name, beside pitch and roll: the heading")
        guess = _first_guess(survey, topic, column, named)
        if guess is None:
            continue
        if column.is_constant and column.low in name_table()["codes"].get(guess.symbol, ()):
            guess = replace(guess, unused_because=f"always {column.low:g}, a code for no reading")
        if guess.symbol == "n" and gear and not _SHAFT.search(column.name):
            guess = _of_propeller(guess, gear)
        ranked.append(_RankedGuess((column.is_constant, not named.unit, column.missing, -topic.rows), guess))
    return ranked


def _chosen(guess: ColumnGuess, best: ColumnGuess | None) -> ColumnGuess:
    """The guess, used where it is the best of its channel, with what is taken in its place where it is not."""
    if guess is best or best is None or guess.unused_because:
        return replace(guess, is_used=guess is best)
    return replace(guess, is_used=False, unused_because=f"'{best.source}' is taken")


def _of_propeller(guess: ColumnGuess, gear: float) -> ColumnGuess:
    """The rate of an engine as that of the propeller behind its gear."""
    text = f"an engine's, with {gear:g} turns for each of the propeller, as stated"
    return replace(guess, scale=1.0 / gear, unused_because="", evidence=(guess.evidence[0].partition(":")[0], text))


def _without_names(survey: LogSurvey, topic: TopicSummary) -> list[ColumnGuess]:
    """The guesses of a table whose columns have no names, by what they do."""
    table = next(one for one in survey.log.tables if one.topic == topic.topic)
    if any(table.names) or not math.isfinite(topic.rate):
        return []
    columns = {int(column.name): column_values(table, int(column.name) - 1) for column in topic.columns}
    complete = {k: values for k, values in columns.items() if values is not None and np.all(np.isfinite(values))}
    return [
        ColumnGuess(
            recognised_column.index,
            recognised_column.symbol,
            recognised_column.unit,
            recognised_column.frame,
            recognised_column.positive,
            evidence=(recognised_column.evidence,),
        )
        for recognised_column in recognised_columns(complete, 1.0 / topic.rate)
    ]


def with_columns_of_turning(
    surveys: Sequence[LogSurvey], parts: Sequence[tuple[ColumnGuess, ...]]
) -> list[tuple[ColumnGuess, ...]]:
    """Return the guesses of the sources of a run with the yaw rate and the rudder that no name shows.

    They are sought where the heading is, among columns that are not recognised. A rudder stays open.
    """
    used = {g.symbol for part in parts for g in part if g.is_used}
    sought = {"r"} - used if any(s.startswith(_STEERS) for s in used) else {"r", "delta"} - used
    if "psi" not in used or not sought or used & _WAVES:
        return list(parts)
    return [(*part, *_turning_guesses(survey, part, sought)) for survey, part in zip(surveys, parts, strict=True)]


def _turning_guesses(survey: LogSurvey, part: Sequence[ColumnGuess], sought: set[str]) -> list[ColumnGuess]:
    """The columns of a source that are sought, by its heading."""
    psi = next((g for g in part if g.is_used and g.symbol == "psi"), None)
    places = columns_by_source(survey)
    if psi is None or psi.source not in places:
        return []
    topic, heading = places[psi.source]
    table = next(one for one in survey.log.tables if one.topic == topic.topic)
    known = {str(g.source) for g in part}
    names = [str(s) for s, (of, _) in places.items() if of is topic and not isinstance(s, int) and s not in known]
    unknown = set(names) - set(columns_not_needed(names, {g.symbol for g in part if g.is_used}))
    numbers = {places[name][1].number: name for name in unknown if not places[name][1].is_constant}
    values = {k: column_values(table, k - 1) for k in (*numbers, heading.number)}
    complete = {k: cells for k, cells in values.items() if cells is not None and np.all(np.isfinite(cells))}
    if heading.number not in complete or not math.isfinite(topic.rate):
        return []
    angles = complete.pop(heading.number)
    unit = psi.unit or ("rad" if np.ptp(angles) <= 2.0 * math.pi else "deg")
    turning = columns_of_turning(dict(sorted(complete.items())), angles, unit, 1.0 / topic.rate)
    return [
        ColumnGuess(
            numbers[column.index], column.symbol, "" if column.symbol == "delta" else column.unit,
            evidence=(column.evidence,), other_reading=_NO_RUDDER if column.symbol == "delta" else "",
        )
        for column in {column.symbol: column for column in reversed(turning)}.values() if column.symbol in sought
    ]  # fmt: skip


def _has_tilt(survey: LogSurvey, topic: TopicSummary) -> bool:
    """Whether a topic has roll and pitch."""
    symbols = {named.symbol for column in topic.columns if (named := _named(survey, topic, column)) is not None}
    return {"phi", "theta"} <= symbols


def _named(survey: LogSurvey, topic: TopicSummary, column: ColumnSummary) -> NameGuess | None:
    """What a column is as stated, else by its name."""
    if column.name not in survey.stated:
        return guess_by_name(_topic_name(survey, topic), column.name, column.unit, survey.layout.format)
    stated = guess_by_name("", survey.stated[column.name], column.unit or unit_in_heading(column.name))
    return None if stated is None else replace(
        stated, evidence="what was stated of it", side=stated.side or named_side(column.name)
    )  # fmt: skip


def _topic_name(survey: LogSurvey, topic: TopicSummary) -> str:
    """The topic, or for a plain table the folders and the file that may be called after one."""
    if topic.topic:
        return topic.topic
    path = survey.path.resolve()
    return "/".join((*path.parts[-_FOLDERS_READ - 1 : -1], path.name.partition(".")[0]))


def _first_guess(survey: LogSurvey, topic: TopicSummary, column: ColumnSummary, named: NameGuess) -> ColumnGuess | None:
    rule = named.rule
    name: str | int = column.name
    by_number = not topic.topic and (column.is_repeated or column.name.isdecimal())
    source = column.number if by_number else f"{topic.topic}/{name}" if topic.topic else name
    guess = ColumnGuess(
        source,
        named.symbol,
        named.unit,
        rule.frame,
        rule.positive,
        scale=rule.scale,
        evidence=(f"by {named.evidence}{': ' if rule.note else ''}{rule.note}",),
        unused_because=rule.unused_because,
        side="" if column.is_constant else named.side,
        is_documented=rule.logger not in ("", "ROS"),
    )
    if named.symbol.startswith("command_"):
        return command_guess(replace(guess, side=named.side), column, survey)
    if named.symbol == "delta" and named.unit == "percent":
        return rudder_in_percent(guess)
    if rule.frame == "enu":
        guess = guess.with_evidence("axes as ROS recommends (REP 103)")
    if column.is_repeated:
        return replace(guess, other_reading=f"the number of another column that is called '{name}'")
    return replace(guess, other_reading=rule.other_reading)


def without_conflicts(parts: Sequence[Sequence[ColumnGuess]]) -> list[tuple[ColumnGuess, ...]]:
    """Return the guesses of the sources of a run with one source for each channel, what is measured before the rest."""
    used: set[str] = set()
    first = []
    for part in _with_twins(_with_propeller(_with_two_shafts(parts))):
        first.append([_unused(g, f"another source has {g.symbol}") if g.symbol in used else g for g in part])
        used |= {g.symbol for g in first[-1] if g.is_used}
    reasons = _superfluous(used)
    return [tuple(_unused(g, reasons[g.symbol]) if g.symbol in reasons else g for g in part) for part in first]


def _with_two_shafts(parts: Sequence[Sequence[ColumnGuess]]) -> Sequence[Sequence[ColumnGuess]]:
    """The guesses, where no rudder steers and the rates of two shafts are recorded: each as that of a thruster.

    Where the commands of thrusters are recorded as well, these are used, and the rates that follow them are not.
    """
    rates = [one for part in parts for one in part if one.symbol == "n" and one.side]
    has_rudder = any(one.is_used and one.symbol == "delta" for part in parts for one in part)
    if has_rudder or sorted(rate.side for rate in rates) != ["port", "starboard"]:
        return parts
    if any(one.is_used and one.symbol.startswith("command_") for part in parts for one in part):
        reason = "the rate of a thruster whose command is taken"
        return [[_unused(one, reason) if one in rates else one for one in part] for part in parts]
    text = "one of two shafts, and no rudder: a thruster's"
    return [[_as_thruster(one).with_evidence(text) if one in rates else one for one in part] for part in parts]


def _as_thruster(rate: ColumnGuess) -> ColumnGuess:
    symbol = {"port": "rpm_1", "starboard": "rpm_2"}[rate.side]
    because = "by its name"  # the note on two screws that turn together is not of two that steer
    return replace(rate, symbol=symbol, is_used=True, unused_because="", evidence=(because, *rate.evidence[1:]))


def _with_propeller(parts: Sequence[Sequence[ColumnGuess]]) -> list[list[ColumnGuess]]:
    """The guesses, where beside a rudder a shaft or two turn: their rate as that of the propeller."""
    used = {guess.symbol for part in parts for guess in part if guess.is_used}
    shafts = sorted(symbol for symbol in used if symbol.startswith("rpm_"))
    if "delta" not in used or "n" in used or not 0 < len(shafts) <= _TWINS:
        return [list(part) for part in parts]
    text = "the only shaft, beside a rudder: the propeller's" if len(shafts) == 1 else "of a shaft, beside a rudder"
    sides = dict(zip(shafts, ("port", "starboard"), strict=False))

    def of_propeller(guess: ColumnGuess) -> ColumnGuess:
        rate = replace(guess, symbol="n", side=sides[guess.symbol], is_used=guess.symbol == shafts[0])
        return rate.with_evidence(text)

    return [[of_propeller(guess) if guess.symbol in shafts else guess for guess in part] for part in parts]


def _with_twins(parts: Sequence[list[ColumnGuess]]) -> Sequence[list[ColumnGuess]]:
    """The guesses, where two rudders, nozzles or shafts of one table are recorded: half their sum as the one input."""
    for part in parts:
        for k, guess in enumerate(part):
            twins = [place for place, other in enumerate(part) if _are_twins(guess, other)]
            if len(twins) == 1:
                port, starboard = (k, twins[0]) if guess.side == "port" else (twins[0], k)
                other, why = part[starboard], f"half the sum with '{part[port].source}' is taken"
                used = replace(part[port], is_used=True, unused_because="", twin=other.source)
                part[port] = used.with_evidence(_OF_TWINS[guess.symbol])
                part[starboard] = replace(other, is_used=False, unused_because=why)
    return parts


def _are_twins(used: ColumnGuess, other: ColumnGuess) -> bool:
    """Whether a column is that of the other side of one that is used, in the same topic and unit."""
    is_left_out = not other.unused_because or other.unused_because == f"'{used.source}' is taken"
    return (
        (used.is_used and not other.is_used and is_left_out)
        and (used.symbol == other.symbol and used.unit == other.unit and used.topic == other.topic)
        and {used.side, other.side} == {"port", "starboard"}
    )


def with_turned_thruster(
    parts: Sequence[Sequence[ColumnGuess]], *, is_rate_steady: bool = True
) -> tuple[tuple[ColumnGuess, ...], ...]:
    """Return the guesses, where what steers is the only thruster, turned: its angle is the direction of the thrust.

    An angle that turns the craft to starboard is a thrust to port, at the stern. The rate of its engine is what drives
    it where no command is recorded; the turns of its gear are in the coefficients.

    is_rate_steady: whether the rate is one in all runs; a nozzle behind such a one is taken for a rudder.
    """
    guesses = [guess for part in parts for guess in part]
    used = {guess.symbol: guess for guess in guesses if guess.is_used}
    drives = [guess for guess in used.values() if guess.symbol.startswith(("command_", "rpm_"))]
    rates = [guess for guess in guesses if guess.symbol == "n"]
    steers = used.get("delta")
    is_turned = steers is not None and not steers.is_open and (
        _TURNED.search(str(steers.source))
        or (drives and _STEERING.search(str(steers.source)))
        or (not is_rate_steady and NOZZLE.search(str(steers.source)))
    )  # fmt: skip
    drives = drives or rates
    if steers is None or not is_turned or len(drives) != 1:
        return tuple(map(tuple, parts))
    drive = drives[0]
    if drive.symbol == "n":
        because = f"{drive.evidence[0].partition(':')[0]}, of the thruster that turns"
        drive = replace(drive, symbol="rpm_1", scale=1.0, is_used=True, unused_because="", evidence=(because,))
    turned = replace(
        steers, symbol=f"alpha_{drive.symbol.rpartition('_')[2]}", positive="" if steers.positive == "port" else "port"
    ).with_evidence("turns the only thruster; that of a rudder behind a fixed one is channels.delta, its sign reversed")
    of = {id(steers): turned, id(drives[0]): drive}
    return tuple(tuple(of.get(id(one), one) for one in part) for part in parts)


def without_depth(parts: Sequence[Sequence[ColumnGuess]]) -> tuple[tuple[ColumnGuess, ...], ...]:
    """Return the guesses without the depth of water so deep that no model needs it."""
    why = "the water is deep, or the model has no depth"
    return tuple(tuple(_unused(g, why) if g.symbol == "depth" else g for g in part) for part in parts)


def _unused(guess: ColumnGuess, reason: str) -> ColumnGuess:
    return replace(guess, is_used=False, unused_because=guess.unused_because or reason)


def _superfluous(used: set[str]) -> dict[str, str]:
    """Symbol -> why it is of no use beside those that are used, or without another."""
    follows = {"stw": {"u", "sog"}, "psi_magnetic": {"psi"}, "lat": {"x0"}, "lon": {"y0"}, "sog": {"u"}, "cog": {"v"}}
    mates = (("sog", "cog"), ("cog", "sog"), ("lat", "lon"), ("lon", "lat"))
    reasons = {one: f"needs {mate}, which no column is" for one, mate in mates if mate not in used}
    if used & {"lat", "x0"}:
        shown = (("sog", "speed"), ("cog", "course"))
        reasons |= {s: f"the positions show the {word} over ground" for s, word in shown if s in reasons}
    reasons |= {one: f"{min(better & used)} is there" for one, better in follows.items() if better & used}
    steers = any(one == "delta" or one.startswith(("command_", "rpm_", "alpha_")) for one in used)
    if "phi" in used and not steers and not used & _PLACE_OR_SPEED:
        reasons |= dict.fromkeys(
            ("psi", "psi_magnetic", "r"), "nothing that steers is recorded, nor a place: the roll is"
        )
    quaternion = {"q_w", "q_x", "q_y", "q_z"}
    if {"psi", "phi", "theta"} <= used:
        reasons |= dict.fromkeys(quaternion, "psi, phi and theta are there")
    elif not quaternion <= used:
        reasons |= dict.fromkeys(quaternion, "needs the other three of the quaternion")
    return reasons
