"""What the motion shows of the guesses: units, frames, signs, axes, wind."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.values import Array, InputError, Record
from seatrial.core.values.notation import TWIN_DIFFERENCES
from seatrial.data.check.conventions import with_standard_signs
from seatrial.data.check.motion import recorded_motion
from seatrial.data.check.repair import repaired_whole, without_sentinels
from seatrial.data.check.time_base import rebuild_time_base
from seatrial.data.draft.column_guess import RELATIVE, Changes, ColumnGuess
from seatrial.data.draft.guess import command_directions, rest_of_commands
from seatrial.data.draft.judged import judged_guesses
from seatrial.data.draft.naming import APPARENT_WIND
from seatrial.data.draft.stretches import track_velocity
from seatrial.data.draft.survey import LogSurvey
from seatrial.data.read.assemble import LogSource, assemble_record, record_of_sources
from seatrial.physics.manoeuvres.track import has_track

# Axes of positions and attitudes that a log leaves open, by its thrusters.

_SIDES = ("port", "starboard")

Parts = list[list[ColumnGuess]]


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
        [replace(g, other_reading="").with_evidence(evidence) if g.is_used and _is_side_open(g) else g for g in part]
        for part in parts
    ]


def _is_side_open(guess: ColumnGuess) -> bool:
    """Whether axes, or a side that goes with them, are all that is open."""
    is_side = guess.symbol in ("v", "r", "psi") and guess.other_reading.startswith("positive")
    return is_side or (guess.frame == "enu" and guess.is_open)


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
    is_seen = has_track(record) and "psi" in record
    if not is_seen or float(np.ptp(np.unwrap(record["psi"]))) < _TURNS_RAD:
        return changes
    velocity = track_velocity(record)
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


# What all columns of a run show of the guesses.

# misfit with the derivative of position below which a velocity is over ground: any current would leave more; chosen
_TRACK_MISFIT = 0.03


def checked_by_behaviour(
    surveys: Sequence[LogSurvey], guesses: Sequence[Sequence[ColumnGuess]]
) -> list[list[ColumnGuess]]:
    """Return the guesses of the sources of one run with units, frames and signs as the motion shows them."""
    result = judged_guesses(surveys, guesses)
    named = {g.symbol: g.side for one in result for g in one if g.is_used and g.symbol.startswith("command_")}
    record = run_record(surveys, result)
    for decide in (_over_ground, rest_of_commands, command_directions):
        if record is not None and (changes := decide(record)):
            result = _changed(result, changes)
            record = run_record(surveys, result)
    if any(g.is_used and g.is_of_wind for one in result for g in one):
        record = run_record(surveys, result, has_wind=True)
        result = result if record is None else _changed(result, wind_readings(record))
    return with_axes_by_thrusters(result, named)


def _over_ground(record: Record) -> Changes:
    """Velocities that are the derivative of the position: over ground."""
    motion = recorded_motion(record)
    if motion is None or motion.path_length == 0.0 or motion.misfit > _TRACK_MISFIT:
        return {}
    return dict.fromkeys(("u", "v"), lambda guess: replace(guess, follows_track=True))


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
            layout = replace(survey.layout, time=time, columns=columns, geometry=geometry)
            sources.append(LogSource(survey.log, layout.with_differences(TWIN_DIFFERENCES.values())))
    try:
        if len(sources) == 1:
            record = assemble_record(sources[0].log, sources[0].layout, "")
        else:
            record = record_of_sources("run", sources)
        even, _ = rebuild_time_base(without_sentinels(record)[0])
        return with_standard_signs(repaired_whole(even))
    except (InputError, IndexError, StopIteration):
        return None
