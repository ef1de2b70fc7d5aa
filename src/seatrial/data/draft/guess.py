"""What the columns of a log are: by name, then by behaviour; unsure stays open, with both readings."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.values import InputError, Record
from seatrial.data.check.conventions import with_standard_signs
from seatrial.data.check.motion import recorded_motion
from seatrial.data.check.repair import repair
from seatrial.data.check.rudder import yaw_acceleration_response
from seatrial.data.check.signal import smoothed, smoothed_derivative, window_length
from seatrial.data.check.timestamps import rebuild_time_base
from seatrial.data.check.velocity_conventions import best_convention
from seatrial.data.draft.naming import NameGuess, guess_by_name
from seatrial.data.draft.survey import ColumnSummary, LogSurvey, TopicSummary, column_values
from seatrial.data.draft.unnamed import recognised_columns
from seatrial.data.read import ColumnSpec
from seatrial.data.read.assemble import LogSource, assemble_record, record_of_sources
from seatrial.data.read.quantities import log_quantity

_FULL_TURN = 2.0 * math.pi
# rad: a range of headings beyond which the column is not in radians; rad: one that shows a heading through the circle
_BEYOND_A_TURN, _MOST_OF_A_TURN = _FULL_TURN + 0.3, 5.5
_LARGEST_RUDDER = math.pi / 2.0  # rad
_LARGEST_TILT = math.pi / 2.0  # rad, of roll and pitch
_LATITUDE_RAD = math.pi / 2.0  # rad, of a pole
_LARGEST_RPS = 60.0  # 1/s; propellers of ships and models turn more slowly, those of small craft are in rpm
_PWM_RANGE, _PWM_REST, _PWM_SPAN = (700.0, 2300.0), 1500.0, 400.0  # us, of servo pulses (ArduPilot, SERVOn_MIN, MAX)
_PWM_REST_TOLERANCE = 60.0  # us; chosen: trims of motors that stand still
# correlation with the rate of the heading that proves a yaw rate; factor by which a unit may be missed; chosen
_SURE_CORRELATION, _UNIT_TOLERANCE = 0.8, 1.3
_SURE_T = 5.0  # effect over standard error that proves a sign; as in the checks
_YAW_RATE_UNITS = {"rad/s": 1.0, "deg/s": 180.0 / math.pi, "deg/min": 10800.0 / math.pi}  # per rad/s
_SPEED_UNITS = {"m/s": 1.0, "kn": 1852.0 / 3600.0, "km/h": 1.0 / 3.6}  # m/s
_FOLDERS_READ = 3  # folders above a file whose names may be those of a topic; chosen
_MISFIT = 0.3  # of velocities with the derivative of position that is acceptable; as in the checks


@dataclass(frozen=True)
class ColumnGuess:
    """What one column is taken for.

    Attributes:
        source: as the trial file addresses it.
        symbol, unit, frame, positive, zero, span, scale: as in a channel of the trial file.
        evidence: why.
        other_reading: what it may be instead; empty: it is assigned outright.
        is_used: whether it is the one chosen for its symbol.
    """

    source: str | int
    symbol: str
    unit: str
    frame: str = ""
    positive: str = ""
    zero: float = 0.0
    span: float = 1.0
    scale: float = 1.0
    evidence: tuple[str, ...] = ()
    other_reading: str = ""
    is_used: bool = True

    @property
    def is_open(self) -> bool:
        """Whether a person must choose."""
        return bool(self.other_reading)

    @property
    def column(self) -> ColumnSpec:
        """The column as a layout has it."""
        return ColumnSpec(self.symbol, self.source, self.unit, self.frame, self.positive, zero=self.zero,
                          span=self.span, factor=self.scale, is_held=self.symbol.startswith("command_"))  # fmt: skip

    def with_evidence(self, text: str) -> "ColumnGuess":
        """Return the guess with one more reason."""
        return replace(self, evidence=(*self.evidence, text))


def guess_columns(survey: LogSurvey) -> tuple[ColumnGuess, ...]:
    """Return what the columns of a log are, one for each column whose name says something.

    Of several columns for one channel the one of the fastest topic with fewest missing samples is used.
    """
    guesses: list[tuple[tuple[float, ...], ColumnGuess]] = []
    for topic in survey.topics:
        if topic.time is None:
            continue
        guesses += [((0.0,), guess) for guess in _without_names(survey, topic)]
        for column in topic.columns:
            named = guess_by_name(_topic_name(survey, topic), column.name, column.unit, survey.layout.format)
            if named is not None and not (column.is_constant and named.symbol.startswith("command_")):
                rank = (column.is_constant, not named.unit, column.missing, -topic.rows)
                guesses.append((rank, _first_guess(survey, topic, column, named)))
    best: dict[str, tuple[tuple[float, ...], ColumnGuess]] = {}
    for rank, guess in guesses:
        if guess.symbol not in best or rank < best[guess.symbol][0]:
            best[guess.symbol] = (rank, guess)
    chosen = [replace(guess, is_used=best[guess.symbol][1] is guess) for _, guess in guesses]
    return without_conflicts([chosen])[0]


def _without_names(survey: LogSurvey, topic: TopicSummary) -> list[ColumnGuess]:
    """The guesses of a table whose columns have no names, by what they do."""
    table = next(one for one in survey.log.tables if one.topic == topic.topic)
    if any(table.names) or not math.isfinite(topic.rate):
        return []
    columns = {int(one.name): column_values(table, int(one.name) - 1) for one in topic.columns}
    complete = {k: values for k, values in columns.items() if values is not None and np.all(np.isfinite(values))}
    return [
        ColumnGuess(one.index, one.symbol, one.unit, one.frame, one.positive, evidence=(one.evidence,))
        for one in recognised_columns(complete, 1.0 / topic.rate)
    ]


def _topic_name(survey: LogSurvey, topic: TopicSummary) -> str:
    """The topic, or for a plain table the folders and the file that may be called after one."""
    if topic.topic:
        return topic.topic
    path = survey.path.resolve()
    return "/".join((*path.parts[-_FOLDERS_READ - 1 : -1], path.name.partition(".")[0]))


def _first_guess(survey: LogSurvey, topic: TopicSummary, column: ColumnSummary, named: NameGuess) -> ColumnGuess:
    rule = named.rule
    name: str | int = column.name
    source = f"{topic.topic}/{name}" if topic.topic else int(column.name) if column.name.isdecimal() else name
    guess = ColumnGuess(
        source,
        named.symbol,
        named.unit,
        rule.frame,
        rule.positive,
        scale=rule.scale,
        evidence=(f"by {named.evidence}",),
    )
    if named.symbol.startswith("command_"):
        return _as_pulse(guess, column, survey)
    if rule.frame == "enu":
        other = 'frame = "earth" (x north, y east): the log does not say'
        return replace(guess, other_reading=other).with_evidence("axes as ROS recommends (REP 103)")
    guess = guess if named.unit else _with_unit_by_range(guess, column)
    if rule.logger == "ROS" and rule.positive:
        return replace(guess, other_reading='positive = "starboard": the log does not say')
    return guess


def _as_pulse(guess: ColumnGuess, column: ColumnSummary, survey: LogSurvey) -> ColumnGuess:
    """A command as a share of its range: by the parameters of the servo where the log has them, else by its rest."""
    if column.low >= -1.0 and column.high <= 1.0:
        return replace(guess, unit="1").with_evidence("between -1 and 1")
    if not (_PWM_RANGE[0] <= column.low and column.high <= _PWM_RANGE[1]):
        return replace(guess, unit="1", other_reading="set zero and span: command = (cell - zero) / span")
    number = guess.symbol.removeprefix("command_")
    known = {key: survey.log.parameters.get(f"SERVO{number}_{key}") for key in ("TRIM", "MIN", "MAX", "REVERSED")}
    trim, low, high = known["TRIM"], known["MIN"], known["MAX"]
    if trim is not None and low is not None and high is not None and low < high:
        positive = "astern" if known["REVERSED"] else ""
        stated = replace(guess, unit="us", zero=trim, span=(high - low) / 2.0, positive=positive)
        return stated.with_evidence(f"SERVO{number}_TRIM, _MIN, _MAX and _REVERSED of the log")
    text = f"pulses of {column.low:g} to {column.high:g} us, {column.common:g} the most often"
    rest = column.common if abs(column.common - _PWM_REST) < _PWM_REST_TOLERANCE else _PWM_REST
    pulse = replace(guess, unit="us", zero=rest, span=_PWM_SPAN).with_evidence(text)
    if rest == column.common:
        return replace(pulse, other_reading='positive = "astern", and which side it drives: the log does not say')
    return replace(pulse, other_reading="zero = 1000, span = 1000 (one direction)")


def _with_unit_by_range(guess: ColumnGuess, column: ColumnSummary) -> ColumnGuess:
    """The unit that the range of the numbers shows, or one with the other reading."""
    size, span = max(abs(column.low), abs(column.high)), column.high - column.low
    text = f"from {column.low:.4g} to {column.high:.4g}"
    match log_quantity(guess.symbol).unit:
        case "rad":
            limits = {"delta": _LARGEST_RUDDER, "phi": _LARGEST_TILT, "theta": _LARGEST_TILT, "lat": _LATITUDE_RAD}
            if size > limits.get(guess.symbol, _BEYOND_A_TURN) and (guess.symbol != "theta" or size > _BEYOND_A_TURN):
                return replace(guess, unit="deg").with_evidence(f"{text}: degrees")
            if guess.symbol == "theta" and size > _LARGEST_TILT:
                return replace(guess, unit="rad", other_reading="psi, with frame").with_evidence(f"{text}: no pitch")
            if span > _MOST_OF_A_TURN or guess.symbol == "delta":
                return replace(guess, unit="rad").with_evidence(f"{text}: radians")
            return replace(guess, unit="rad", other_reading='unit = "deg"').with_evidence(text)
        case "rad/s":
            return replace(guess, unit="rad/s", other_reading='unit = "deg/s" or "deg/min"').with_evidence(text)
        case "m/s":
            return replace(guess, unit="m/s", other_reading='unit = "kn"').with_evidence(text)
        case "rps" if size > _LARGEST_RPS:
            return replace(guess, unit="rpm").with_evidence(f"{text}: per minute")
        case "rps":
            return replace(guess, unit="rps", other_reading='unit = "rpm"').with_evidence(text)
        case "m":
            return replace(guess, unit="m").with_evidence("metres, as positions are")
        case unit:
            return replace(guess, unit=unit).with_evidence(f"in {unit} by default")


def without_conflicts(parts: Sequence[Sequence[ColumnGuess]]) -> list[tuple[ColumnGuess, ...]]:
    """Return the guesses of the sources of a run with one source for each channel, what is measured before the rest."""
    used: set[str] = set()
    first = []
    for part in parts:
        first.append([replace(g, is_used=g.is_used and g.symbol not in used) for g in part])
        used |= {g.symbol for g in first[-1] if g.is_used}
    follows = {"stw": {"u", "sog"}, "psi_magnetic": {"psi"}, "lat": {"x0"}, "lon": {"y0"}, "sog": {"u"}, "cog": {"v"}}
    unused = {symbol for symbol, sources in follows.items() if sources & used}
    unused |= {
        one for one, mate in (("sog", "cog"), ("cog", "sog"), ("lat", "lon"), ("lon", "lat")) if mate not in used
    }
    if not {"q_w", "q_x", "q_y", "q_z"} <= used or {"psi", "phi", "theta"} <= used:
        unused |= {"q_w", "q_x", "q_y", "q_z"}
    return [tuple(replace(g, is_used=g.is_used and g.symbol not in unused) for g in part) for part in first]


def checked_by_behaviour(
    surveys: Sequence[LogSurvey], guesses: Sequence[Sequence[ColumnGuess]]
) -> list[list[ColumnGuess]]:
    """Return the guesses of the sources of one run with units, frames and signs as the motion shows them."""
    result = [list(one) for one in guesses]
    for decide in (_yaw_rate_unit, _velocity_convention, _rudder_sign):
        record = run_record(surveys, result)
        if record is not None:
            changes = decide(record)
            result = [[changes.get(g.symbol, _same)(g) if g.is_used else g for g in one] for one in result]
    if any(g.is_used and g.is_open and g.frame == "enu" for one in result for g in one):
        result = [[_as_open_as_the_axes(g) for g in one] for one in result]
    return result


def _as_open_as_the_axes(guess: ColumnGuess) -> ColumnGuess:
    """What was compared with axes that are open themselves has its side with them: a mirrored world looks the same."""
    if not guess.is_used or guess.is_open or guess.symbol not in ("v", "r", "delta", "psi"):
        return guess
    other = "the other side, if the axes of positions and attitude are read the other way"
    return replace(guess, other_reading=other)


def _same(guess: ColumnGuess) -> ColumnGuess:
    return guess


def run_record(surveys: Sequence[LogSurvey], guesses: Sequence[Sequence[ColumnGuess]]) -> Record | None:
    """The record of the used guesses, even and complete, in standard signs; None where there is none."""
    sources = []
    for survey, part in zip(surveys, guesses, strict=True):
        columns = tuple(g.column for g in part if g.is_used)
        if columns:
            time = next(topic.time for topic in survey.topics if topic.time is not None)
            geometry = replace(survey.layout.geometry, variation=0.0)
            sources.append(LogSource(survey.log, replace(survey.layout, time=time, columns=columns, geometry=geometry)))
    try:
        if len(sources) == 1:
            record = assemble_record(sources[0].log, sources[0].layout, "")
        else:
            record = record_of_sources("run", sources)
        even, _ = rebuild_time_base(record)
        return with_standard_signs(repair(even)[0])
    except (InputError, IndexError, StopIteration):
        return None


def _yaw_rate_unit(record: Record) -> dict:
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


def _velocity_convention(record: Record) -> dict:
    """Frame, sign and unit of u and v, and the unit of psi, by the derivative of position."""
    motion = recorded_motion(record)
    if motion is None or motion.path_length == 0.0:
        return {}
    best = best_convention(motion)
    misfit = motion.misfit(best)
    if misfit > _MISFIT:
        text = f"u, v fit the derivative of position in no frame ({misfit:.0%} misfit)"
        return {
            s: (lambda g: replace(g, other_reading='frame = "body" or "earth"').with_evidence(text)) for s in ("u", "v")
        }
    scale = motion.speed_scale(best)
    unit = min(_SPEED_UNITS, key=lambda one: abs(math.log(max(scale, 1e-9) / _SPEED_UNITS[one])))  # never log of zero
    text = f"{misfit:.0%} misfit with the derivative of position, {best.frame}-fixed"
    changes = {}
    for symbol in ("u", "v"):
        flips = symbol == "v" and best.v_sign < 0

        def decided(guess: ColumnGuess, flips: bool = flips) -> ColumnGuess:
            frame = best.frame if guess.frame != "enu" else guess.frame
            opposite = "" if guess.positive in ("port", "west") else "west" if frame == "earth" else "port"
            positive = opposite if flips else guess.positive
            known = guess.unit if not guess.is_open else unit
            return replace(guess, frame=frame, positive=positive, unit=known, other_reading="").with_evidence(text)

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


def _rudder_sign(record: Record) -> dict:
    """The side to which a positive rudder turns the ship."""
    if "delta" not in record or "psi" not in record:
        return {}
    response = yaw_acceleration_response(record)
    t = 0.0 if response is None else response[0] / max(response[1], 1e-300)  # never a division by zero
    if abs(t) < _SURE_T:
        text = f"the turn does not show its sign (effect over standard error {t:.1f})"
        return {"delta": lambda g: replace(g, other_reading='positive = "port"').with_evidence(text)}

    def decided(guess: ColumnGuess) -> ColumnGuess:
        side = "port" if (guess.positive == "port") == (t > 0) else ""
        text = f"a positive one turns to {side or 'starboard'} (effect over standard error {abs(t):.0f})"
        return replace(guess, positive=side).with_evidence(text)

    return {"delta": decided}
