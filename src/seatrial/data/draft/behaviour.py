"""What the motion shows of the guesses: units, frames, signs."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from seatrial.core.values import InputError, Record
from seatrial.data.check.conventions import with_standard_signs
from seatrial.data.check.motion import recorded_motion
from seatrial.data.check.repair import repaired_whole
from seatrial.data.check.rudder import (
    CERTAIN_T,
    DOUBTFUL_T,
    steady_turning_response,
    t_ratio,
    yaw_acceleration_response,
)
from seatrial.data.check.sentinels import without_sentinels
from seatrial.data.check.signal import smoothed, smoothed_derivative, window_length
from seatrial.data.check.timestamps import rebuild_time_base
from seatrial.data.check.velocity_conventions import ACCEPTABLE_MISFIT
from seatrial.data.draft.axes import with_axes_by_fixes, with_axes_by_thrusters
from seatrial.data.draft.column_guess import Changes, ColumnGuess
from seatrial.data.draft.commands import command_directions, rest_of_commands
from seatrial.data.draft.survey import LogSurvey
from seatrial.data.draft.wave_signs import wave_motion_signs
from seatrial.data.draft.wind_columns import wind_readings
from seatrial.data.read.assemble import LogSource, assemble_record, record_of_sources

# correlation with the rate of the heading that proves a yaw rate; factor by which a unit may be missed; chosen
_SURE_CORRELATION, _UNIT_TOLERANCE = 0.8, 1.3
_YAW_RATE_UNITS = {"rad/s": 1.0, "deg/s": 180.0 / math.pi, "deg/min": 10800.0 / math.pi}  # per rad/s
# misfit with the derivative of position below which a velocity is over ground: any current would leave more; chosen
_OVER_GROUND = 0.03
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
            return replace(one, follows_track=misfit < _OVER_GROUND).with_evidence(text)

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
