"""What the motion shows of the guesses: units, frames, signs, axes, wind."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from seatrial.core.values import Array, InputError, Record
from seatrial.data.check.conventions import ACCEPTABLE_MISFIT, CERTAIN_RATIO, with_standard_signs
from seatrial.data.check.inputs import (
    CERTAIN_T,
    DOUBTFUL_T,
    steady_turning_response,
    t_ratio,
    yaw_acceleration_response,
)
from seatrial.data.check.motion import least_squares, recorded_motion, smoothed, smoothed_derivative, window_length
from seatrial.data.check.repair import repaired_whole, without_sentinels
from seatrial.data.check.time_base import rebuild_time_base
from seatrial.data.draft.column_guess import RELATIVE, Changes, ColumnGuess
from seatrial.data.draft.guess import command_directions, rest_of_commands
from seatrial.data.draft.naming import APPARENT_WIND
from seatrial.data.draft.stretches import padded
from seatrial.data.draft.survey import LogSurvey
from seatrial.data.read.assemble import LogSource, assemble_record, record_of_sources

# Axes of positions and attitudes that a log leaves open, by the GNSS fixes of the same run or by its thrusters.

_POSITIONS, _FIXES, _QUATERNION = ("x0", "y0"), ("lat", "lon"), ("q_w", "q_x", "q_y", "q_z")
_READINGS = ("enu", "earth")
_SIDES = ("port", "starboard")
_LEAST_SAMPLES = 30  # of the track beside the fixes; as in the checks

Parts = list[list[ColumnGuess]]
RecordOf = Callable[[Sequence[Sequence[ColumnGuess]]], Record | None]
"""The record of the used guesses of a run."""


def with_axes_by_fixes(parts: Parts, record_of: RecordOf) -> Parts:
    """Return the guesses with the axes of open positions as the fixes show them, then those of open attitudes.

    Positions are compared with the fixes, attitudes with the velocities and the derivative of position; one reading
    must fit, and the other three times worse.
    """
    if not _has_open(parts, _POSITIONS):
        return parts
    fixes, pose = record_of(_fixes_only(parts)), (*_POSITIONS, *_QUATERNION)
    if fixes is None:
        return parts
    poses = {reading: record_of(_with_frame(_only(parts, pose), pose, reading, 0.0, "")) for reading in _READINGS}
    frame = _surer({one: _distance(record, fixes) for one, record in poses.items()})
    if frame is None:
        return parts
    settled = _with_frame(parts, _POSITIONS, *frame, "with the GNSS fixes")
    if not _has_open(parts, _QUATERNION):
        return settled
    frame = _surer({reading: _heading_misfit(record_of(_with_frame(settled, _QUATERNION, reading, 0.0, "")))
                    for reading in _READINGS})  # fmt: skip
    return settled if frame is None else _with_frame(settled, _QUATERNION, *frame, "of velocities turned by it")


def with_axes_by_thrusters(parts: Parts, named: Mapping[str, str]) -> Parts:
    """Return the guesses with open axes settled where thrusters to both sides turn the craft as their names say.

    Read the other way the world is mirrored, and each thruster would be on the other side.

    named: command -> side that its name has, port or starboard; empty: none.
    """
    shown = {g.symbol: g.side for part in parts for g in part if g.is_used and not g.is_open}
    agreeing = [side for symbol, side in named.items() if side and shown.get(symbol) == side]
    contradicted = any(side and shown.get(symbol, side) != side for symbol, side in named.items())
    if contradicted or len(set(agreeing)) < len(_SIDES):
        return parts
    evidence = "as thrusters to port and starboard turn the craft"
    return [
        [replace(g, other_reading="").with_evidence(evidence) if g.is_used and g.is_open and g.frame == "enu" else g
         for g in part] for part in parts
    ]  # fmt: skip


def _has_open(parts: Parts, symbols: tuple[str, ...]) -> bool:
    return any(g.symbol in symbols and g.is_used and g.is_open and g.frame == "enu" for part in parts for g in part)


def _only(parts: Parts, symbols: tuple[str, ...]) -> Parts:
    return [[replace(g, is_used=g.is_used and g.symbol in symbols) for g in part] for part in parts]


def _fixes_only(parts: Parts) -> Parts:
    """The first latitude and longitude of the first source that has both."""
    result = _only(parts, ())
    for k, part in enumerate(parts):
        rows = [next((i for i, g in enumerate(part) if g.symbol == symbol), None) for symbol in _FIXES]
        if None not in rows:
            result[k] = [replace(g, is_used=i in rows) for i, g in enumerate(part)]
            break
    return result


def _distance(track: Record | None, fixes: Record) -> float:
    """The rms distance of a track from the fixes over the extent of these, wherever on the craft their antenna is."""
    if track is None:
        return np.inf
    start, stop = max(track.time[0], fixes.time[0]), min(track.time[-1], fixes.time[-1])
    common = (track.time >= start) & (track.time <= stop)
    if np.count_nonzero(common) < _LEAST_SAMPLES:
        return np.inf
    at_fixes = [np.interp(track.time[common], fixes.time, fixes[symbol]) for symbol in _POSITIONS]
    extent = math.hypot(*(float(np.std(fix)) for fix in at_fixes))
    distance = np.concatenate([fix - track[symbol][common] for fix, symbol in zip(at_fixes, _POSITIONS, strict=True)])
    places = _antenna_places(track["psi"][common] if "psi" in track else np.zeros(len(at_fixes[0])))
    return least_squares(places, distance)[1] * math.sqrt(2.0) / max(extent, np.finfo(float).tiny)


def _antenna_places(psi: Array) -> Array:
    """North and east, one below the other, of a metre north, east, forward and to starboard; shape (2 n, 4)."""
    one, none = np.ones_like(psi), np.zeros_like(psi)
    north = np.column_stack([one, none, np.cos(psi), -np.sin(psi)])
    return np.vstack([north, np.column_stack([none, one, np.sin(psi), np.cos(psi)])])


def _heading_misfit(record: Record | None) -> float:
    """The misfit of velocities with the derivative of position where the heading is as declared."""
    motion = None if record is None else recorded_motion(record)
    if motion is None or motion.path_length == 0.0:
        return np.inf
    return min(motion.misfit(convention) for convention in motion.conventions if convention.psi_factor == 1.0)


def _surer(misfits: dict[str, float]) -> tuple[str, float] | None:
    """The frame that fits where the other does not, with its misfit."""
    (best, misfit), (_, other) = sorted(misfits.items(), key=lambda item: item[1])
    return (best, misfit) if misfit < ACCEPTABLE_MISFIT and other > CERTAIN_RATIO * misfit else None


def _with_frame(parts: Parts, symbols: tuple[str, ...], frame: str, misfit: float, evidence: str) -> Parts:
    words = "x east, y north" if frame == "enu" else "x north, y east"

    def settled(guess: ColumnGuess) -> ColumnGuess:
        if not (guess.is_used and guess.symbol in symbols):
            return guess
        why = (guess.evidence[0], f"{words}: {misfit:.1%} misfit {evidence}")
        return replace(guess, frame=frame, other_reading="", evidence=why)

    return [[settled(g) for g in part] for part in parts]


# The sides to which heave and pitch are positive, by the waves that move the craft.

_SURE = 0.5  # share of the motion in long waves that is in phase with what a craft follows, from which it shows; chosen
_LONG_WAVES = 0.5  # share of the waves' energy that lies below the frequency up to which waves count as long; chosen


def wave_motion_signs(record: Record) -> Changes:
    """Return the signs of z and theta: a craft rises with long waves, and in head seas its bow with their slope.

    Where neither shows, a heave sensor's usual sign stays open.
    """
    if "zeta" not in record:
        return {}
    changes: Changes = {}
    if "z" in record:
        changes["z"] = _decided(
            -_in_phase(record, "z"), "up", "down", "a craft rises with long waves, here those of a probe at midship"
        )
    if "theta" in record:
        text = "its bow rises on their front, if they come from ahead"
        changes["theta"] = _decided(_in_phase(record, "theta", of_slope=True), "bow down", "bow up", text)
    return changes


def _decided(share: float, other: str, standard: str, text: str) -> Callable[[ColumnGuess], ColumnGuess]:
    def decided(guess: ColumnGuess) -> ColumnGuess:
        opposite = "" if guess.positive == other else other
        if abs(share) < _SURE:
            evidence = f"in phase with long waves by only {abs(share):.2f}"
            return replace(guess, other_reading=f'positive = "{other}"').with_evidence(evidence)
        positive = guess.positive if share > 0.0 else opposite
        return replace(guess, positive=positive).with_evidence(f"{text}: the column is positive {positive or standard}")

    return decided


def _in_phase(record: Record, symbol: str, of_slope: bool = False) -> float:
    """The share, -1 to 1, of a motion in long waves that is in phase with their elevation or with its rate."""
    waves, motion = _spectrum(record["zeta"]), _spectrum(record[symbol])
    energy = np.cumsum(np.abs(waves) ** 2)
    long = energy <= _LONG_WAVES * energy[-1]
    followed = waves[long] * (1j if of_slope else 1.0)
    size = float(np.sqrt(np.sum(np.abs(followed) ** 2) * np.sum(np.abs(motion[long]) ** 2)))
    return float(np.real(np.sum(np.conj(followed) * motion[long]))) / size if size > 0.0 else 0.0


def _spectrum(values: Array) -> NDArray[np.complex128]:
    return np.fft.rfft((values - np.mean(values)) * np.hanning(len(values)))


# What columns of wind are, by which reading of them the wind over ground is steady while the craft turns.

_TURNS_RAD = np.radians(90.0)  # range of the heading from which on readings differ; chosen
_SURE_RATIO = 2.0  # scatter of the wind in one reading over that in another, from which on they differ; chosen
_KNOT = 1852.0 / 3600.0  # m/s
_PAIRS = (("wind_speed_relative", "wind_direction_relative"), ("wind_speed", "wind_direction"))
_APPARENT, _OFF_BOW, _TRUE = (
    "apparent wind, with an angle off the bow",
    "the true wind's speed, with an angle off the bow",
    "the true wind",
)
_NAMED = {"wind_speed_relative": _APPARENT, "wind_speed": _TRUE}
_NOT_AS_NAMED = "NOT AS NAMED"
# what turns an apparent wind into the true one, of the same source
_OVER_GROUND = frozenset({"sog", "cog", "psi"})


def tells_wind(parts: Sequence[Sequence[ColumnGuess]]) -> bool:
    """Return whether columns of one source say the true wind without doubt, or an apparent one with what turns it."""
    return any(_true_wind_columns(part) for part in parts)


def with_wind_role(parts: Sequence[Sequence[ColumnGuess]], *, is_taken: bool) -> tuple[tuple[ColumnGuess, ...], ...]:
    """Return the guesses with the wind as an input of the model where it is one, else as a comment that says why."""
    return tuple(tuple(_in_role(g, _true_wind_columns(part) if is_taken else ()) for g in part) for part in parts)


def _in_role(guess: ColumnGuess, inputs: Sequence[str]) -> ColumnGuess:
    if not guess.is_of_wind or not guess.is_used:
        return guess
    if guess.symbol in inputs:
        what = "the true wind follows from it; an input" if "relative" in guess.symbol else "an input of the model"
        return guess.with_evidence(what)
    why = f"{' and '.join(inputs)} beside it say the wind" if inputs else "the air is taken for calm"
    return replace(guess, is_commented=True).with_evidence(f"a comment in the file: {why}")


def _true_wind_columns(part: Sequence[ColumnGuess]) -> tuple[str, str] | tuple[()]:
    """The pair of channels of a source that says the true wind; empty where none does without doubt."""
    sure = {g.symbol for g in part if g.is_used and not g.is_open and not any(_NOT_AS_NAMED in e for e in g.evidence)}
    apparent, true = _PAIRS
    if set(true) <= sure:
        return true
    return apparent if set(apparent) | _OVER_GROUND <= sure else ()


def wind_readings(record: Record) -> Changes:
    """Return what the wind's columns show: the reading in which it is steady, where that is another than their name's.

    A wind over ground changes slowly; read wrongly it turns with the craft, or grows and falls with its speed.
    """
    changes: Changes = {}
    velocity = _velocity(record)
    if velocity is None or float(np.ptp(np.unwrap(record["psi"]))) < _TURNS_RAD:
        return changes
    for pair in _PAIRS:
        if set(pair) <= set(record.channels):
            scatters = _scatters(record[pair[0]], record[pair[1]], record["psi"], velocity)
            changes = {**changes, **_changes(pair, scatters)}
    return changes


def _changes(pair: tuple[str, str], scatters: dict[tuple[str, str], float]) -> Changes:
    reading, unit = min(scatters, key=lambda scatter: scatters[scatter])
    least = scatters[reading, unit]
    of_readings = {one: min(value for (other, _), value in scatters.items() if other == one) for one, _ in scatters}
    rival = min((value for one, value in of_readings.items() if one != reading), default=math.inf)
    decided = rival > _SURE_RATIO * least
    named = _NAMED[pair[0]]
    if reading != named and of_readings[named] > _SURE_RATIO * least:
        rest = f"as {named} within {of_readings[named]:.0%}"
        text = f"as {reading} it is steady within {least:.0%} while the craft turns, {rest}"
        shown = reading if decided else ""
        return dict.fromkeys(pair, lambda guess: _as_shown(guess, shown, unit, text))
    if reading == named and decided:
        units = [value for (other, _), value in scatters.items() if other == named]
        sure_unit = unit if max(units) > _SURE_RATIO * least else ""
        text = f"{named}: with it the wind over ground is steady while the craft turns"
        return dict.fromkeys(pair, lambda guess: _as_shown(guess, named, sure_unit, text))
    return {}


def _as_shown(guess: ColumnGuess, reading: str, unit: str, text: str) -> ColumnGuess:
    """The guess as the turn of the craft shows it: what its name left open is closed, what its name denies is said.

    reading: empty where two are left. unit: of an apparent speed; empty where both will do.
    """
    names_neither = guess.other_reading == APPARENT_WIND
    named = _NAMED[guess.symbol.replace("direction", "speed")]
    if reading != named and not (names_neither and reading == _APPARENT):
        return guess if "direction" in guess.symbol else guess.with_evidence(f"{_NOT_AS_NAMED}: {text}")
    if not guess.is_open:
        return guess
    is_unit_open = not names_neither and "speed" in guess.symbol
    if is_unit_open and not unit:
        return guess
    symbol = guess.symbol.removesuffix(RELATIVE) + (RELATIVE if reading == _APPARENT else "")
    read = replace(guess, symbol=symbol, unit=unit if is_unit_open else guess.unit, other_reading="")
    return read.with_evidence(f"{read.unit}: the wind over ground is then steady" if is_unit_open else text)


def _velocity(record: Record) -> tuple[Array, Array] | None:
    """North and east velocity over ground [m/s], each (n,); None without positions or heading."""
    if not {"x0", "y0", "psi"} <= set(record.channels):
        return None
    north, east = (np.gradient(padded(record, record[one]), record.dt) for one in ("x0", "y0"))
    return north, east


def _scatters(speed: Array, angle: Array, psi: Array, velocity: tuple[Array, Array]) -> dict[tuple[str, str], float]:
    """Scatter of the wind over its mean in each reading and unit of an apparent speed.

    Wind comes from a direction: what meets the craft comes from there and from ahead (Fossen 2021, section 10.1).
    """
    off_bow = speed * np.exp(1j * (psi + angle))
    ship = velocity[0] + 1j * velocity[1]
    readings = {
        (_OFF_BOW, "m/s"): off_bow,
        (_TRUE, "m/s"): speed * np.exp(1j * angle),
        (_APPARENT, "m/s"): off_bow - ship,
        (_APPARENT, "kn"): _KNOT * off_bow - ship,
    }
    return {
        key: float(np.std(wind) / max(np.abs(np.mean(wind)), np.finfo(float).tiny)) for key, wind in readings.items()
    }


# What the motion shows of the guesses: units, frames, signs.

# correlation with the rate of the heading that proves a yaw rate; factor by which a unit may be missed; chosen
_SURE_CORRELATION, _UNIT_TOLERANCE = 0.8, 1.3
_YAW_RATE_UNITS = {"rad/s": 1.0, "deg/s": 180.0 / math.pi, "deg/min": 10800.0 / math.pi}  # per rad/s
# misfit with the derivative of position below which a velocity is over ground: any current would leave more; chosen
_TRACK_MISFIT = 0.03
_SPEED_TOLERANCE = 1.15  # factor by which a unit of speed may be missed; chosen: units differ by 1.8 and more
_SPEED_UNITS = {"m/s": 1.0, "kn": 1852.0 / 3600.0, "km/h": 1.0 / 3.6}  # m/s


def checked_by_behaviour(
    surveys: Sequence[LogSurvey], guesses: Sequence[Sequence[ColumnGuess]]
) -> list[list[ColumnGuess]]:
    """Return the guesses of the sources of one run with units, frames and signs as the motion shows them."""
    result = with_axes_by_fixes([list(guess) for guess in guesses], partial(run_record, surveys))
    named = {g.symbol: g.side for one in result for g in one if g.is_used and g.symbol.startswith("command_")}
    for decide in (
        _yaw_rate_unit,
        _velocity_convention,
        _ground_speed_unit,
        _rudder_sign,
        rest_of_commands,
        command_directions,
        wave_motion_signs,
    ):
        record = run_record(surveys, result)
        if record is not None:
            changes = decide(record)
            result = _changed(result, changes)
    if any(g.is_used and g.is_of_wind for one in result for g in one):
        record = run_record(surveys, result, has_wind=True)
        result = result if record is None else _changed(result, wind_readings(record))
    result = with_axes_by_thrusters(result, named)
    if any(g.is_used and g.is_open and g.frame == "enu" for one in result for g in one):
        result = [[_as_open_as_the_axes(g) for g in one] for one in result]
    return result


def _as_open_as_the_axes(guess: ColumnGuess) -> ColumnGuess:
    """What was compared with axes that are open themselves has its side with them: a mirrored world looks the same."""
    if not guess.is_used or guess.is_open or guess.symbol not in ("v", "r", "delta", "psi"):
        return guess
    other = "the other side, if the axes of positions and attitude are read the other way"
    return replace(guess, other_reading=other)


def _changed(parts: Sequence[Sequence[ColumnGuess]], changes: Changes) -> list[list[ColumnGuess]]:
    return [[changes.get(g.symbol, _same)(g) if g.is_used else g for g in part] for part in parts]


def _same(guess: ColumnGuess) -> ColumnGuess:
    return guess


def run_record(
    surveys: Sequence[LogSurvey], guesses: Sequence[Sequence[ColumnGuess]], *, has_wind: bool = False
) -> Record | None:
    """The record of the used guesses, even and complete, in standard signs; None where there is none."""
    sources = []
    for survey, part in zip(surveys, guesses, strict=True):
        columns = tuple(g.column for g in part if g.is_used and (has_wind or not g.is_of_wind))
        if columns:
            time = next(topic.time for topic in survey.topics if topic.time is not None)
            geometry = replace(survey.layout.geometry, variation=0.0)
            sources.append(LogSource(survey.log, replace(survey.layout, time=time, columns=columns, geometry=geometry)))
    try:
        if len(sources) == 1:
            record = assemble_record(sources[0].log, sources[0].layout, "")
        else:
            record = record_of_sources("run", sources)
        even, _ = rebuild_time_base(without_sentinels(record)[0])
        return with_standard_signs(repaired_whole(even))
    except (InputError, IndexError, StopIteration):
        return None


def _yaw_rate_unit(record: Record) -> Changes:
    """Unit and sign of r by the derivative of the heading."""
    if "psi" not in record or "r" not in record or len(record) < 4 * window_length(len(record)):
        return {}
    length = window_length(len(record))
    turning = smoothed_derivative(record["psi"], record.dt, length)
    rate = smoothed(record["r"], length)
    power = float(turning @ turning)
    if power == 0.0 or not np.any(rate):
        return {}
    factor = float(rate @ turning) / power
    match = factor * math.sqrt(power / float(rate @ rate))
    if abs(match) < _SURE_CORRELATION:
        text = f"correlation with d(psi)/dt only {match:.2f}"
        return {"r": lambda g: replace(g, other_reading=g.other_reading or "another column").with_evidence(text)}

    def decided(guess: ColumnGuess) -> ColumnGuess:
        in_file = abs(factor) * _YAW_RATE_UNITS[guess.unit] if guess.unit in _YAW_RATE_UNITS else abs(factor)
        unit = min(_YAW_RATE_UNITS, key=lambda one: abs(math.log(in_file / _YAW_RATE_UNITS[one])))
        if abs(math.log(in_file / _YAW_RATE_UNITS[unit])) > math.log(_UNIT_TOLERANCE):
            return replace(guess, other_reading="another unit").with_evidence(f"{in_file:.3g} times d(psi)/dt in rad/s")
        opposite = {"port": "", "": "port", "starboard": "port"}[guess.positive]
        positive = opposite if factor < 0 else guess.positive
        text = (
            f"follows d(psi)/dt with correlation {match:.2f}: {unit}, positive to {'port' if positive else 'starboard'}"
        )
        return replace(guess, unit=unit, positive=positive, other_reading="").with_evidence(text)

    return {"r": decided}


def _velocity_convention(record: Record) -> Changes:
    """Frame, sign and unit of u and v, and the unit of psi, by the derivative of position."""
    motion = recorded_motion(record)
    if motion is None or motion.path_length == 0.0:
        return {}
    best = motion.best_of(motion.conventions)
    misfit = motion.misfit(best)
    if misfit > ACCEPTABLE_MISFIT:
        text = f"u, v fit the derivative of position in no frame ({misfit:.0%} misfit)"
        return {
            s: (lambda g: replace(g, other_reading='frame = "body" or "earth"').with_evidence(text)) for s in ("u", "v")
        }
    scale = motion.speed_scale(best)
    unit = _speed_unit(scale)
    text = f"{misfit:.0%} misfit with the derivative of position, {best.frame}-fixed"
    changes = {}
    for symbol in ("u", "v"):
        flips = symbol == "v" and best.v_sign < 0

        def decided(guess: ColumnGuess, flips: bool = flips) -> ColumnGuess:
            frame = best.frame if guess.frame != "enu" else guess.frame
            opposite = "" if guess.positive in ("port", "west") else "west" if frame == "earth" else "port"
            positive = opposite if flips else guess.positive
            if guess.is_open and not unit:
                return replace(guess, frame=frame).with_evidence(f"{text}, {scale:.2f} times as large")
            known = guess.unit if not guess.is_open else unit
            one = replace(guess, frame=frame, positive=positive, unit=known, other_reading="")
            return replace(one, follows_track=misfit < _TRACK_MISFIT).with_evidence(text)

        changes[symbol] = decided
    if best.psi_factor == 1.0:
        changes["psi"] = lambda g: replace(g, other_reading="").with_evidence("turns velocities into the track")
    elif best.psi_factor == -1.0:
        changes["psi"] = lambda g: replace(g, positive="port", other_reading="").with_evidence(
            "turns against the track"
        )
    else:
        right = "deg" if best.psi_factor < 1.0 else "rad"
        changes["psi"] = lambda g: replace(g, unit=right, other_reading="").with_evidence(
            f"turns with the track: {right}"
        )
    return changes


def _ground_speed_unit(record: Record) -> Changes:
    """The unit of a speed over ground by the derivative of position."""
    if not {"x0", "y0", "u", "v"} <= set(record.channels) or record.channel("u").frame != "earth":
        return {}
    length = window_length(len(record))
    track = np.concatenate([smoothed_derivative(record[s], record.dt, length) for s in ("x0", "y0")])
    over_ground = np.concatenate([smoothed(record[s], length) for s in ("u", "v")])
    power = float(over_ground @ over_ground)
    factor = float(track @ over_ground) / power if power > 0.0 else 0.0
    size = max(float(np.linalg.norm(track)), np.finfo(float).tiny)
    misfit = float(np.linalg.norm(track - factor * over_ground)) / size
    unit = _speed_unit(factor) if misfit < ACCEPTABLE_MISFIT else ""

    def decided(guess: ColumnGuess) -> ColumnGuess:
        if not guess.is_open or not unit:
            return guess
        return replace(guess, unit=unit, other_reading="").with_evidence(
            f"{misfit:.0%} misfit with the derivative of position: {unit}"
        )

    return {"sog": decided}


def _speed_unit(factor: float) -> str:
    """The unit in which a speed is factor m/s; empty where none is near."""
    size = max(factor, 1e-9)  # never log of zero
    unit = min(_SPEED_UNITS, key=lambda unit: abs(math.log(size / _SPEED_UNITS[unit])))
    return unit if abs(math.log(size / _SPEED_UNITS[unit])) < math.log(_SPEED_TOLERANCE) else ""


def _rudder_sign(record: Record) -> Changes:
    """The side to which a positive rudder turns the ship, by the yaw acceleration and by the turn that follows."""
    if "delta" not in record or "psi" not in record:
        return {}
    first, steady = t_ratio(yaw_acceleration_response(record)), t_ratio(steady_turning_response(record))
    t = first if abs(first) > abs(steady) else steady
    numbers = f"effect over standard error {first:.1f} on yaw acceleration, {steady:.1f} on the turn that follows"
    if abs(t) < CERTAIN_T or min(first, steady) < -DOUBTFUL_T < DOUBTFUL_T < max(first, steady):
        text = f"the turn does not show its sign ({numbers})"
        return {"delta": lambda g: replace(g, other_reading=g.other_reading or 'positive = "port"').with_evidence(text)}

    def decided(guess: ColumnGuess) -> ColumnGuess:
        side = "port" if (guess.positive == "port") == (t > 0) else ""
        return replace(guess, positive=side).with_evidence(f"a positive one turns to {side or 'starboard'} ({numbers})")

    return {"delta": decided}
