"""Runs on the page: their errors in one table, and each with its picture and its measures; IMO's standards."""

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from seatrial.manoeuvres import Criterion, criteria
from seatrial.report import words
from seatrial.report.figures.channels import comparison
from seatrial.report.numbers import DASH, column, fixed, significant
from seatrial.results import Measure, Prediction
from seatrial.values import InputError, Record

_ERRORS = {"psi_deg": ("heading", "deg"), "position_m": ("position", "m"), "u": ("u", "m/s"), "v": ("v", "m/s"),
           "r": ("r", "deg/s")}  # fmt: skip
_DEGREES = 57.29577951308232
OVERSHOOTS = 6


@dataclass(frozen=True)
class MeasureRow:
    """One measure, measured and simulated."""

    name: str
    unit: str
    measured: str
    simulated: str
    difference: str


@dataclass(frozen=True)
class Run:
    """One run: its picture and measures; `more` are later overshoots, `is_unlike`: nothing simulated can be read."""

    name: str
    key: str
    is_held_out: bool
    summary: str
    figure: Markup
    measures: tuple[MeasureRow, ...]
    more: tuple[MeasureRow, ...]
    is_unlike: bool


def scores(predictions: Sequence[Prediction], length: float) -> dict[str, object]:
    """Errors (rms) of every run: `header` of name and unit, `rows` of record, held out or not, texts."""
    names = [name for name in _ERRORS if any(name in p.rms for p in predictions)]
    header = [_ERRORS[name] for name in names]
    if "position_m" in names and length > 0:
        header.insert(names.index("position_m") + 1, ("position", "L"))
    ordered = sorted(predictions, key=lambda p: p.role != "validation")
    columns = [column(values) for values in zip(*(_errors(p, names, length) for p in ordered), strict=True)]
    texts = zip(*columns, strict=True)
    rows = [(p.record, p.role == "validation", list(cells)) for p, cells in zip(ordered, texts, strict=False)]
    return {"header": header, "rows": rows}


def _errors(p: Prediction, names: Sequence[str], length: float) -> list[float | None]:
    found: list[float | None] = []
    for name in names:
        value = p.rms.get(name)
        factor = _DEGREES if name == "r" else 1.0
        found.append(None if value is None else value * factor)
        if name == "position_m" and length > 0:
            found.append(None if value is None else value / length)
    return found


def runs(predictions: Sequence[Prediction], length: float, inputs: Sequence[str]) -> list[Run]:
    """All runs in order; `inputs` are the channels the model is driven by."""
    return [_run(p, length, inputs, f"run{k}") for k, p in enumerate(predictions)]


def _run(p: Prediction, length: float, inputs: Sequence[str], key: str) -> Run:
    rows = {name: _measure(name, m) for name, m in p.measures.items()}
    late = {name for name in rows if name.startswith("overshoot_") and int(name.split("_")[1]) > OVERSHOOTS}
    return Run(
        p.record, key, p.role == "validation", _summary(p), Markup(comparison(p, length, inputs)),
        tuple(row for name, row in rows.items() if name not in late),
        tuple(row for name, row in rows.items() if name in late),
        bool(rows) and all(m.simulated is None for m in p.measures.values()),
    )  # fmt: skip


def _summary(p: Prediction) -> str:
    parts = [f"{_ERRORS[name][0]} {significant(p.rms[name], 2)} {_ERRORS[name][1]}"
             for name in ("psi_deg", "position_m") if name in p.rms]  # fmt: skip
    return ", ".join(parts)


def _measure(name: str, m: Measure) -> MeasureRow:
    label, unit = words.measure(name)
    digits = {"deg": 1, "L": 2, "s": 1, "m/s": 3, "deg/s": 2}.get(unit, 3)
    both = m.measured is not None and m.simulated is not None
    difference = _signed(m.simulated - m.measured, digits) if both else DASH  # type: ignore[operator]
    return MeasureRow(label, unit, fixed(m.measured, digits), fixed(m.simulated, digits), difference)


def _signed(value: float, digits: int) -> str:
    text = fixed(value, digits)
    return text if value < 0 or float(round(value, digits)) == 0.0 else f"+{text}"


def standards(predictions: Sequence[Prediction], length: float, scale: float) -> dict[str, object]:
    """Rows of the standards the records can be held against, and the notes about them."""
    rows, notes = [], []
    for p in predictions:
        measured = _criteria(p.measured, length, scale, p.measured)
        simulated = {c.name: c for c in _criteria(p.simulated, length, scale, p.measured)}
        for c in measured:
            label, unit = words.measure(c.name)
            other = simulated.get(c.name)
            digits = 1 if unit == "deg" else 2
            rows.append({
                "record": p.record, "measure": label, "unit": unit, "limit": fixed(c.limit, digits),
                "measured": fixed(c.value, digits), "simulated": fixed(other.value if other else None, digits),
                "holds": c.holds, "paragraph": c.source.rsplit(", ", 1)[-1],
            })  # fmt: skip
            if c.note:
                notes.append(c.note)
    return {"rows": rows, "notes": list(dict.fromkeys(notes))}


def _criteria(record: Record, length: float, scale: float, like: Record) -> tuple[Criterion, ...]:
    """The record's criteria, its manoeuvre as in `like`; none where that cannot be judged."""
    try:
        return criteria(record, length, scale, like=like) if length > 0 else ()
    except InputError:
        return ()
