"""Commands of thrusters and rudders: what a pulse means, and which way each drives and turns the craft."""

from dataclasses import replace
from functools import partial

import numpy as np

from seatrial.core.values import InputError, Record
from seatrial.data.check import canonical_record
from seatrial.data.check.thrusters import SURE_EFFECT, ThrusterEffect, thruster_effects
from seatrial.data.draft.column_guess import Changes, ColumnGuess
from seatrial.data.draft.stored_parameters import OutputSetting, is_disabled, output_setting
from seatrial.data.draft.stretch import padded, smooth_speed
from seatrial.data.draft.survey import ColumnSummary, LogSurvey
from seatrial.physics.models.thruster_layout import CommandInput, Thruster, ThrusterLayout

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
    if "u" in record or not {"x0", "y0", "psi"} <= set(record.channels):
        return record
    north, east = (np.gradient(padded(record, record[one]), record.dt) for one in ("x0", "y0"))
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
