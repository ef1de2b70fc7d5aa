"""The guesses of a run's columns as the judge of readings decides them; unsure ones with both readings."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.values import Array, si_unit
from seatrial.core.values.notation import NOTATION, OPPOSITE, positive_direction
from seatrial.data.draft.column_guess import ColumnGuess
from seatrial.data.draft.ship_estimates import HeaderStatement, header_statements
from seatrial.data.draft.survey import ColumnSummary, LogSurvey, column_values, columns_by_source
from seatrial.data.read.clock import stamps
from seatrial.data.readings import (
    ColumnReading,
    NamedColumn,
    ReadingVerdict,
    Samples,
    is_impossible,
    judge,
    without_codes,
)

_GROUPS = (("lat", "lon"), ("x0", "y0"), ("u", "v"), ("q_w", "q_x", "q_y", "q_z"))
_SIDES = ("port", "starboard")
_EITHER_SIDE = frozenset({"delta", "v", "r", "z", "theta"})  # of which logs use both sides; ours
_ANGLES = frozenset({"psi", "psi_magnetic", "cog", "phi", "theta", "wind_direction", "wind_direction_relative"})
_COMMAND = "command_"
_WORDS = {"deg": "degrees", "rad": "radians", "rpm": "per minute", "rps": "per second"}

Parts = list[list[ColumnGuess]]


@dataclass(frozen=True, eq=False)
class _Place:
    """A guess among those of a run, and its column; of twins the numbers of each."""

    part: int
    row: int
    column: ColumnSummary
    named: NamedColumn
    twins: tuple[Array, Array] | None = None


def judged_guesses(surveys: Sequence[LogSurvey], guesses: Sequence[Sequence[ColumnGuess]]) -> Parts:
    """Return the guesses of the sources of one run with units, frames, signs and zeros as all columns show them."""
    statements = [header_statements(survey) for survey in surveys]
    parts = [
        [_as_header_says(guess, statement.get(guess.symbol)) for guess in part]
        for part, statement in zip(guesses, statements, strict=True)
    ]
    places = list(_places(surveys, parts, statements))
    groups = _grouped(places)
    verdicts = judge([[place.named for place in group] for group in groups])
    for group, verdict in zip(groups, verdicts, strict=True):
        for k, place in enumerate(group):
            guess = parts[place.part][place.row]
            parts[place.part][place.row] = _decided(guess, place, verdict, k) if guess.is_used else guess
    return parts


def _as_header_says(guess: ColumnGuess, statement: HeaderStatement | None) -> ColumnGuess:
    """The guess with the side and the place of a wave probe that sentences above the table say."""
    if statement is None or not guess.is_used:
        return guess
    if statement.place and guess.symbol == "zeta":
        place = replace(guess, reference_point=statement.place, evidence=(guess.evidence[0].partition(":")[0],))
        guess = place.with_evidence(f"{statement.place:g} m forward of midship as its header says")
    if not statement.positive or guess.symbol not in NOTATION or guess.frame == "enu":
        return guess
    usual = positive_direction(guess.symbol, guess.frame)
    if statement.positive not in (usual, OPPOSITE[usual]):
        return guess
    return replace(guess, positive="" if statement.positive == usual else statement.positive)


def _places(
    surveys: Sequence[LogSurvey], parts: Parts, statements: Sequence[Mapping[str, HeaderStatement]]
) -> Iterator[_Place]:
    """The columns that are judged: those that are used, and fixes beside a pose; no waves met elsewhere."""
    for k, (survey, part) in enumerate(zip(surveys, parts, strict=True)):
        columns = columns_by_source(survey)
        clocks: dict[str, Array] = {}
        for row, guess in enumerate(part):
            is_judged = (guess.is_used and not guess.symbol.startswith(_COMMAND)) or guess.symbol in ("lat", "lon")
            if not is_judged or guess.source not in columns or guess.span != 1.0 or guess.reference_point:
                continue
            topic, column = columns[guess.source]
            table = next(one for one in survey.log.tables if one.topic == topic.topic)
            if topic.topic not in clocks and topic.time is not None:
                clocks[topic.topic] = stamps(table, topic.time).seconds
            sources = (guess.source, guess.twin) if guess.twin else (guess.source,)
            sides = [column_values(table, columns[source][1].number - 1) for source in sources]
            pair = [cells for cells in sides if cells is not None]
            if not pair or len(pair) < len(sides):
                continue
            cells = without_codes(guess.symbol, table.numbers(guess.column))
            reading = ColumnReading(guess.symbol, guess.unit, guess.frame, guess.positive, 0.0, guess.scale)
            samples = Samples(clocks[topic.topic], cells, guess.symbol in _ANGLES)
            statement = statements[k].get(guess.symbol, HeaderStatement())
            named = NamedColumn(reading, samples, guess.is_documented, is_side_said=bool(statement.positive))
            yield _Place(k, row, column, named, (pair[0], pair[1]) if guess.twin else None)


def _grouped(places: Sequence[_Place]) -> list[list[_Place]]:
    """The columns that are read together."""
    groups, taken = list[list[_Place]](), set[int]()
    for symbols in _GROUPS:
        members = [next((p for p in places if p.named.reading.symbol == symbol), None) for symbol in symbols]
        if all(one is not None for one in members):
            groups.append([one for one in members if one is not None])
            taken |= {id(one) for one in members}
    return [*groups, *([one] for one in places if id(one) not in taken)]


def _extent(low: float, high: float) -> str:
    """Return ``from 47.6 to 47.62``: of four digits, and more where both ends would read alike."""
    digits = 4
    while low < high and f"{low:.{digits}g}" == f"{high:.{digits}g}":
        digits += 1
    return f"from {low:.{digits}g} to {high:.{digits}g}"


def _decided(guess: ColumnGuess, place: _Place, verdict: ReadingVerdict, k: int) -> ColumnGuess:
    """The guess as it is read, with the reason; open where another reading is near."""
    best, rival = verdict.best.readings[k], verdict.rival.readings[k] if verdict.rival is not None else None
    candidates = {_differences(best, reading.readings[k]): nats for reading, nats in reversed(verdict.alternatives)}
    read = replace(
        guess, unit=best.unit, frame=best.frame, positive=best.positive, offset=best.offset, scale=best.factor,
        candidates=tuple(sorted(((t, n) for t, n in candidates.items() if t), key=lambda pair: pair[1])),
    )  # fmt: skip
    text = _extent(place.column.low, place.column.high)
    if is_impossible(best, place.named.samples):
        none = f"{text}: no {_WORDS.get(best.unit, best.unit)}"
        return replace(read, other_reading=_instead(best, place)).with_evidence(none)
    other = _differences(best, rival) if rival is not None and verdict.is_open else ""
    if verdict.best.contradicts:
        other = f"{_differences(best, place.named.reading)} as its heading says"
    reasons = _reasons(guess, best, {} if other else verdict.reasons)
    if place.named.is_side_said and not other and not any(word.startswith("positive") for word in reasons):
        read = read.with_evidence(f"positive {_to(best)} as its header says")
    if not guess.unit:
        word = _WORDS.get(best.unit, best.unit) if best.factor == 1.0 else f"in {best.factor:g} {best.unit}"
        read = read.with_evidence(text if "unit" in other or best.unit in reasons else f"{text}: {word}")
    for relation in dict.fromkeys(reasons.values()):
        read = read.with_evidence(f"{', '.join(w for w, r in reasons.items() if r == relation)} by {relation}")
    if place.twins is not None:
        read, contradiction = _with_difference(read, *place.twins)
        other = contradiction or other
    zeros = [one.offset for one in (best, rival) if one is not None and one.offset and (one is best or other)]
    read = read.with_evidence(_zero_text(best, zeros[0])) if zeros else read
    # an unknown unit of wind comes before whose wind it is; which of two columns is meant comes before its unit
    both = (other, guess.other_reading) if guess.is_of_wind else (guess.other_reading, other)
    return replace(read, other_reading=both[0] or both[1], is_assumed=verdict.is_assumed)


def _with_difference(guess: ColumnGuess, first: Array, second: Array) -> tuple[ColumnGuess, str]:
    """The guess with what its twins differ by, and what it may be where one turns as the other turns back."""
    both = np.isfinite(first) & np.isfinite(second)
    if not both.any():
        return guess, f"the first alone: '{guess.twin}' never has a number beside it"
    difference = (first - second)[both]
    mean, spread = float(np.mean(difference)), float(np.std(difference))
    text = f"half the sum of two, whose difference is {mean:.2g} {guess.unit} (spread {spread:.2g})"
    is_against = float(np.linalg.norm(difference)) > float(np.linalg.norm((first + second)[both]))
    return guess.with_evidence(text), f"the first alone: '{guess.twin}' turns the other way" if is_against else ""


def _instead(best: ColumnReading, place: _Place) -> str:
    """What numbers are that no unit makes possible."""
    if best.symbol == "theta":
        return "psi, with frame"
    middle = float(np.median(place.named.samples.readings[1]))
    return f"counts: write zero = {middle:g} (their median) and span = the counts of one {best.unit}"


def _reasons(guess: ColumnGuess, best: ColumnReading, reasons: Mapping[str, str]) -> dict[str, str]:
    """What is not said of a column and a relation decides: its words -> the relation."""
    words = {
        "unit": "" if guess.unit else best.unit,
        "frame": "" if best.frame == guess.frame else f"{best.frame}-fixed",
    }
    words["positive"] = (
        f"positive {_to(best)}" if best.symbol in _EITHER_SIDE or best.positive != guess.positive else ""
    )
    return {word: reasons[key] for key, word in words.items() if word and key in reasons}


def _zero_text(reading: ColumnReading, offset: float) -> str:
    """What a zero elsewhere than usual means."""
    if reading.symbol != "psi":
        return "its sensor is upside down"
    return f"the heading points {abs(math.degrees(offset * si_unit(reading.unit)[0])):.0f} deg off the course"


def _to(reading: ColumnReading) -> str:
    """The side to which a column is positive, as one says it."""
    side = reading.positive or positive_direction(reading.symbol, reading.frame)
    return f"to {side}" if side in _SIDES else side


def _differences(best: ColumnReading, other: ColumnReading) -> str:
    """The keys in which another reading differs, as a trial file has them."""
    words = [f'unit = "{other.unit}"'] if other.unit != best.unit else []
    if other.frame != best.frame:
        axes = {"enu": "x east, y north", "earth": "north, east", "body": "ahead, aside"}
        frame = other.frame or "earth"
        words.append(f'frame = "{frame}" ({"counter-clockwise from east" if _is_angle(other) else axes[frame]})')
    if other.positive != best.positive:
        words.append(f'positive = "{other.positive or positive_direction(other.symbol, other.frame)}"')
    numbers = (("offset", other.offset, best.offset), ("scale", other.factor, best.factor))
    words += [f"{key} = {new:.6g}" for key, new, old in numbers if not math.isclose(new, old)]
    return ", ".join(words)


def _is_angle(reading: ColumnReading) -> bool:
    return reading.frame == "enu" and reading.symbol == "psi"
