"""Runs on the page: a table of their errors, a figure and the measures of each, the IMO criteria."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from markupsafe import Markup

from seatrial.core.results import Divergence, Extrapolation, Fit, Measure, Prediction
from seatrial.core.results.fit_charts import has_band, has_modelled_position, prediction_view
from seatrial.core.results.prediction import estimated_current
from seatrial.core.text.numbers import DASH, column_texts, duration, fixed, interval, ratio_text, significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import InputError, Record
from seatrial.core.values.record_chart import has_track
from seatrial.physics.manoeuvres import ImoCriterion, imo_criteria
from seatrial.physics.sensors.measured_outputs import shows_ground_velocity, without_current
from seatrial.reporting.measures import (
    IntervalVerdict,
    corrected_measure_label,
    extrapolation_text,
    extrapolation_zone,
    interval_verdict,
    measure_decimals,
    measure_label,
)
from seatrial.reporting.repeats import MAX_NAMES, repeated_runs
from seatrial.reporting.text_tables import TextTable
from seatrial.reporting.time_figures import run_figure
from seatrial.reporting.windows import window_tables

ERROR_LABELS = {"psi_deg": ("heading", "deg"), "position_m": ("position", "m"), "u": ("u", "m/s"), "v": ("v", "m/s"),
           "r": ("r", "deg/s"), "z": ("heave", "m"), "theta_deg": ("pitch", "deg"),
           "phi_deg": ("roll", "deg")}  # fmt: skip
# degrees of a radian
_DEGREES = math.degrees(1.0)
# runs up to which all are drawn; beyond, how many of the worst ones of each role
MAX_DRAWN, WORST_DRAWN = 15, 12
CURRENT_NOTE = (
    "runs in a current that the fit estimated are corrected for it, measured and simulated alike: track minus current "
    "times time, speeds through the water (IMO MSC/Circ.1053, 3.4.2.5; ITTC 7.5-04-02-01, 5.1.1)"
)
# overshoots in the table; later ones are folded
MAX_OVERSHOOTS = 6


@dataclass(frozen=True)
class MeasureRow:
    """One measure, measured and simulated."""

    name: str
    unit: str
    measured: str
    simulated: str
    difference: str
    interval: str = ""
    verdict: str = IntervalVerdict.UNKNOWN
    spread: str = ""


@dataclass(frozen=True)
class MeasureTable:
    """Rows, and which columns any of them has."""

    rows: tuple[MeasureRow, ...]
    has_interval: bool
    has_spread: bool


@dataclass(frozen=True)
class ErrorCell:
    """An error, what the process noise would leave of it, and its spread over tied models; empty: not known."""

    value: str
    floor: str = ""
    spread: str = ""


@dataclass(frozen=True)
class RunScore:
    """One run's errors; `extrapolation`: its index, `extrapolation_class`: inside, edge or beyond.

    `repeats`: the training runs whose manoeuvre a held-out run repeats; empty: none.
    """

    record: str
    is_held_out: bool
    cells: tuple[ErrorCell, ...]
    extrapolation: str
    extrapolation_class: str
    repeats: str = ""


@dataclass(frozen=True)
class ScoreTable:
    """Errors (rms) of every run; `header`: name and unit of each column; `ranged`: of what runs are compared."""

    header: tuple[tuple[str, str], ...]
    rows: tuple[RunScore, ...]
    has_floor: bool
    has_spread: bool
    has_extrapolation: bool
    ranged: str


@dataclass(frozen=True)
class RunSection:
    """One run: its figure and measures; `is_other_manoeuvre`: no measure can be read from the simulated run.

    `notes` say what the process noise would leave, how far the run leaves the training, how tied models differ.
    """

    name: str
    key: str
    is_held_out: bool
    summary: str
    figure: Markup
    reference_word: str
    model_word: str
    measures: MeasureTable
    later_overshoots: MeasureTable
    is_other_manoeuvre: bool
    notes: tuple[str, ...]
    windows: tuple[TextTable, ...] = ()


def error_text(name: str, rms: float) -> str:
    """Return an error of `Prediction.rms` with its unit: ``6.3°``, ``0.037 m/s``."""
    unit = ERROR_LABELS[name][1]
    value = significant(rms * (_DEGREES if name == "r" else 1.0), 2)
    return f"{value}°" if unit == "deg" else f"{value} {unit}"


def score_table(predictions: Sequence[Prediction], length: float) -> ScoreTable:
    """Return the errors of every run, those held out first."""
    names = [name for name in ERROR_LABELS if any(name in p.rms for p in predictions)]
    header = [ERROR_LABELS[name] for name in names]
    if "position_m" in names and length > 0:
        header.insert(names.index("position_m") + 1, ("position", "L"))
    ordered = sorted(predictions, key=lambda p: p.role != "validation")
    columns = [
        column_texts(values) for values in zip(*(_error_values(p.rms, names, length) for p in ordered), strict=True)
    ]
    rows = []
    for p, texts in zip(ordered, zip(*columns, strict=True), strict=False):
        floors, spreads = _error_values(p.noise_floor, names, length), _error_values(p.tied_spread, names, length)
        cells = tuple(
            ErrorCell(t) if unit == "L" else ErrorCell(t, _two_digits(f), _two_digits(s))
            for t, f, s, (_, unit) in zip(texts, floors, spreads, header, strict=True)
        )
        e = _extrapolation(p)
        until = "" if p.divergence is None else f" (diverges; first {duration(p.divergence.seconds)})"
        rows.append(RunScore(f"{p.record}{until}", p.role == "validation", cells, ratio_text(e.index) if e else "",
                          extrapolation_zone(e.index) if e else "", _repeats(p, predictions)))  # fmt: skip
    return ScoreTable(
        tuple(header), tuple(rows), any(c.floor for row in rows for c in row.cells),
        any(c.spread for row in rows for c in row.cells), any(row.extrapolation for row in rows),
        _ranged([p.measured for p in predictions]),
    )  # fmt: skip


def _ranged(runs: Sequence[Record]) -> str:
    """What the extrapolation index compares: motions in waves, roll, or those of a craft under way."""
    shown = {name for run in runs for name in run.channels}
    if "zeta" in shown:
        return "heave, pitch or elevation of the waves"
    if "phi" in shown and not {"psi", "r", "u"} & shown:
        return "roll angle"
    return f"yaw rate, drift, {'rudder' if 'delta' in shown else 'command'} or speed"


def _repeats(p: Prediction, predictions: Sequence[Prediction]) -> str:
    return enumeration(repeated_runs(p, predictions), MAX_NAMES) if p.role == "validation" else ""


def _extrapolation(p: Prediction) -> Extrapolation | None:
    """How far a run held out leaves the training runs; None where that is not known, and for training runs."""
    e = p.extrapolation
    return e if e and p.role == "validation" and extrapolation_zone(e.index) else None


def _two_digits(value: float | None) -> str:
    return "" if value is None else significant(value, 2)


def _error_values(errors: Mapping[str, float], names: Sequence[str], length: float) -> list[float | None]:
    converted: list[float | None] = []
    for name in names:
        value = errors.get(name)
        factor = _DEGREES if name == "r" else 1.0
        converted.append(None if value is None else value * factor)
        if name == "position_m" and length > 0:
            converted.append(None if value is None else value / length)
    return converted


def run_sections(predictions: Sequence[Prediction], length: float, inputs: Sequence[str]) -> list[RunSection]:
    """Return all runs in order; `inputs` are the channels the model is driven by."""
    return [_run_section(p, length, inputs, f"run{k}") for k, p in enumerate(predictions)]


def _run_section(p: Prediction, length: float, inputs: Sequence[str], key: str) -> RunSection:
    rows = {name: _measure_row(name, m, p.tied_spread.get(name)) for name, m in p.measures.items()}
    late = {name for name in rows if name.startswith("overshoot_") and int(name.split("_")[1]) > MAX_OVERSHOOTS}
    view = replace(prediction_view(p, length, inputs), legend=())  # explained once, by `reading_note`
    return RunSection(
        p.record, key, p.role == "validation", _summary(p), run_figure(view),
        p.reference_word, p.model_word,
        _measure_table([row for name, row in rows.items() if name not in late]),
        _measure_table([row for name, row in rows.items() if name in late]),
        bool(rows) and all(m.simulated is None for m in p.measures.values()),
        tuple(_notes(p)), tuple(window_tables(p, ERROR_LABELS, {"r": _DEGREES})),
    )  # fmt: skip


def reading_note(predictions: Sequence[Prediction]) -> str:
    """Return how the figures of runs are to be read, once for all of them; empty without runs."""
    if not predictions:
        return ""
    p = predictions[0]
    reference = "the reference, itself simulated" if p.is_reference_simulated else "measured"
    inputs = "as in the reference" if p.is_reference_simulated else "as measured"
    has_ships = any(has_track(prediction.measured) for prediction in predictions)
    sides = ", along the track to its sides and up to where it is half as wide as the track is long"
    band = f" Pale: 95 % band of the {p.model_word} run{sides if has_ships else ''}."
    return (
        f"Broad grey line: {reference}. Thin dashed line: {p.model_word}, open loop, inputs {inputs}."
        f"{band if any(has_band(prediction) for prediction in predictions) else ''}"
        f"{' Ships at equal times, to scale.' if has_ships else ''} Over a plot the cursor shows the values of all "
        f"channels{' and the place on the track' if has_ships else ''}; drag to zoom, double-click to see all."
    )


def drawn_predictions(predictions: Sequence[Prediction]) -> list[Prediction]:
    """Return the runs that are drawn, in order: all of a few; of many the worst, those held out and of training."""
    if len(predictions) <= MAX_DRAWN:
        return list(predictions)
    kept: list[Prediction] = []
    for role in ("validation", "training"):
        kept += sorted((p for p in predictions if p.role == role), key=badness, reverse=True)[:WORST_DRAWN]
    return [p for p in predictions if any(p is one for one in kept)]


def badness(p: Prediction) -> float:
    """Return the main error of a run; infinite where the simulation diverges."""
    if p.divergence is not None:
        return math.inf
    return next((p.rms[name] for name in ERROR_LABELS if name in p.rms and math.isfinite(p.rms[name])), 0.0)


def hidden_runs_sentence(predictions: Sequence[Prediction]) -> str:
    """Return which runs are drawn where some are not; empty where all are."""
    if len(drawn_predictions(predictions)) == len(predictions):
        return ""
    held = sum(p.role == "validation" for p in predictions)
    of_held = "the held-out runs" if held <= WORST_DRAWN else f"the {WORST_DRAWN} worst held-out runs"
    return f"Of {len(predictions)} runs, {of_held} and the {WORST_DRAWN} worst training runs are drawn."


def _summary(p: Prediction) -> str:
    return ", ".join(_error_texts(p.rms))


def _error_texts(errors: Mapping[str, float]) -> list[str]:
    return [f"{ERROR_LABELS[name][0]} {significant(errors[name], 2)} {ERROR_LABELS[name][1]}"
            for name in ("psi_deg", "position_m", "z", "theta_deg", "phi_deg") if name in errors]  # fmt: skip


def _notes(p: Prediction) -> list[str]:
    notes = [] if p.divergence is None else [_divergence_note(p.divergence)]
    e = _extrapolation(p)
    if e:
        notes.append(f"Extrapolation index {extrapolation_text(e)}")
    if _error_texts(p.noise_floor):
        notes.append(
            f"The process noise of the fit would leave {enumeration(_error_texts(p.noise_floor))} by itself; model "
            "error counts in it."
        )
    if has_track(p.measured) and "x0" in p.simulated and not has_modelled_position(p):
        notes.append("The model does not predict the position: its speed U is 0.")
    if _error_texts(p.tied_spread):
        notes.append(
            f"Models that the records do not distinguish differ by "
            f"{enumeration(_error_texts(p.tied_spread))} (std. dev.)."
        )
    return notes


def _divergence_note(d: Divergence) -> str:
    terms = f", driven by the terms of {enumeration(d.terms)}" if d.terms else ""
    return (
        f"The simulation diverges in {d.state} after {duration(d.seconds)}{terms}; errors are those up to then. "
        "Findings say what to do."
    )


def _measure_table(rows: Sequence[MeasureRow]) -> MeasureTable:
    return MeasureTable(tuple(rows), any(row.interval for row in rows), any(row.spread for row in rows))


def _measure_row(name: str, m: Measure, spread: float | None) -> MeasureRow:
    label, unit = measure_label(name)
    digits = measure_decimals(unit, m)
    both = m.measured is not None and m.simulated is not None
    difference = _signed(m.simulated - m.measured, digits) if both else DASH  # type: ignore[operator]
    return MeasureRow(
        label, unit, fixed(m.measured, digits), fixed(m.simulated, digits), difference,
        interval(m.lower, m.upper, digits) if m.is_determined else "not determined",
        interval_verdict(name, m), _two_digits(spread),
    )  # fmt: skip


def _signed(value: float, digits: int) -> str:
    text = fixed(value, digits)
    return text if value < 0 or float(round(value, digits)) == 0.0 else f"+{text}"


def standards(predictions: Sequence[Prediction], fit: Fit, length: float) -> dict[str, object]:
    """Return rows of the criteria that apply to the records, and the notes on them.

    A run and its simulation in the same current are both corrected for it, where the fit estimated it.
    """
    rows, notes, scale = [], [], fit.ship.scale
    has_ground_velocity = shows_ground_velocity(fit.model)
    for p in predictions:
        current = estimated_current(p, fit.offsets)
        run, model = (without_current(one, current, has_ground_velocity) for one in (p.measured, p.simulated))
        measured = _applicable_criteria(run, length, scale, run)
        simulated = {c.name: c for c in _applicable_criteria(model, length, scale, run)}
        if current is not None and measured:
            notes.append(CURRENT_NOTE)
        for c in measured:
            label, unit = corrected_measure_label(c.name, None if current is None else current.speed)
            other = simulated.get(c.name)
            digits = 1 if unit == "deg" else 2
            rows.append({
                "record": p.record, "measure": label, "unit": unit, "limit": fixed(c.limit, digits),
                "measured": fixed(c.value, digits), "simulated": fixed(other.value if other else None, digits),
                "holds": c.is_fulfilled, "paragraph": c.source.rsplit(", ", 1)[-1],
            })  # fmt: skip
            if c.note:
                notes.append(c.note)
    return {"rows": rows, "notes": list(dict.fromkeys(notes))}


def _applicable_criteria(record: Record, length: float, scale: float, like: Record) -> tuple[ImoCriterion, ...]:
    """The record's criteria, its manoeuvre as in `like`; none where they do not apply."""
    try:
        return imo_criteria(record, length, scale, reference=like) if length > 0 else ()
    except InputError:
        return ()
