"""The predictions' chapter: whole runs, windows, and samples ahead."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Extrapolation, Fit, FrequencyResponse, KStepErrors, Measure, Prediction, WindowScore
from seatrial.core.results.fit_charts import has_modelled_position, prediction_view
from seatrial.core.results.prediction import ChannelScore
from seatrial.core.text.numbers import column_texts, duration, exact, fixed, interval, ratio_text, significant
from seatrial.core.text.words import counted, enumeration, sentence
from seatrial.core.values import Record, display_unit
from seatrial.core.values.notation import channel_letter
from seatrial.core.values.record_chart import has_track
from seatrial.reporting.figures.response_charts import frequency_chart, k_step_chart
from seatrial.reporting.measures import (
    NOT_DETERMINED,
    IntervalVerdict,
    extrapolation_text,
    extrapolation_zone,
    interval_verdict,
    measure_decimals,
    measure_label,
)
from seatrial.reporting.runs import drawn_predictions, hidden_runs_sentence, reading_note, resimulation
from seatrial.reporting.section import Cell, Column, Level, Picture, Section, TextTable, number, table_of, words
from seatrial.reporting.time_figures import run_figure
from seatrial.reporting.verdict import DEGREES, ERROR_LABELS, GRADE_NOTE, MAX_NAMES, repeat_clause, repeated_runs

# Windows of held-out runs on the page: their scores next to predictions that need no fit.

WINDOW_NOTE = (
    "Errors in windows: root-mean-square errors open loop, each window from the state estimated in its first seconds. "
    "Fit in windows: 100 % less the error over the spread about the mean (NRMSE, as MATLAB's compare): 100 is perfect, "
    "0 no better than the mean. In brackets R², one less the squares of the errors over those about the mean."
)
"""How the tables of windows are to be read, once for all runs."""


def shortest_judged(fit: Fit) -> float:
    """Return the s of windows from which on a better prediction without the fit speaks against it.

    Of roll its natural period: over less, the motion goes on as it began, and any smooth curve predicts it.
    """
    return fit.roll.natural_period.value if fit.roll is not None else 0.0


def baseline_sentence(fit: Fit, labels: dict[str, tuple[str, str]], shortest: float = 0.0) -> str:
    """Return in which windows the model diverges, and which runs predictions without this fit predict better.

    shortest: s of the windows that are compared, at least.
    """
    clauses, lost = [], []
    for p in fit.validation:
        for w in p.windows:
            if w.diverged:
                lost.append(f"{p.record}, windows of {w.window}: {w.divergence_text}")
            rivals = w.better_baselines(fit.sensor_errors)
            better = [f"{labels[name][0]} by {baseline}" for name, baseline in rivals.items()]
            if better and w.seconds >= shortest:
                clauses.append(f"{p.record} in windows of {w.window}: {enumeration(better)}")
    sentences = [f"{sentence('; '.join(lost))}"] if lost else []
    if clauses:
        sentences.append(
            f"Predictions without this fit are better in places, so do not rely on it there: {'; '.join(clauses)}."
        )
    return " ".join(sentences)


# Chapters on predictions some samples ahead and on frequency responses.

_ROLES = {"validation": "held-out runs", "training": "training runs"}
_AHEAD_NOTE = (
    "The Kalman filter of the fit takes the measured samples up to a moment; model and recorded inputs go on from "
    "there. Root-mean-square error over many moments, in brackets that of the last value held. With noise of the "
    "sensors only, every horizon has the error of a simulation."
)
_COMPARED_NOTE = (
    "Cross-spectrum over input spectrum (H1; Welch 1967) of what was measured, and by the same estimator of the model "
    "simulated with the same inputs. Compared: frequencies at which the input has a thousandth of its largest density "
    "or more and the 95 % region of the records leaves zero out. Chance takes the model out of the region at one in "
    "twenty. Where a controller was on, disturbances bias the response of the records."
)


def k_step_section(fit: Fit) -> Section:
    """Return the chapter on errors over the horizon; empty where the fit has none."""
    if not fit.k_step_errors:
        return Section("")
    longest = max(fit.k_step_errors, key=lambda e: len(e.steps))
    dt = longest.seconds[0] / longest.steps[0]
    horizons = sorted({k for e in fit.k_step_errors for k in e.steps})
    ordered = [e for role in _ROLES for e in fit.k_step_errors if e.role == role]
    table = table_of(
        ordered,
        words("Channel", lambda e: f"{channel_letter(e.channel)}, {display_unit(e.unit)[1]}"),
        words("runs", lambda e: _ROLES[e.role]),
        *(_horizon_column(k, k * dt) for k in horizons),
    )
    picture = Picture(lambda: svg(k_step_chart(fit.k_step_errors)), "Root-mean-square error over the horizon.")
    return Section(
        "Prediction some samples ahead",
        "ahead",
        table=table,
        note=_AHEAD_NOTE,
        pictures=(picture,),
        level=Level.DETAIL,
        is_folded=True,
    )


def _horizon_column(steps: int, seconds: float) -> Column[KStepErrors]:
    def text(e: KStepErrors) -> str:
        if steps not in e.steps:
            return ""
        factor, place = display_unit(e.unit)[0], e.steps.index(steps)
        return f"{significant(factor * e.rms[place], 3)} ({significant(factor * e.held_rms[place], 3)})"

    return number(f"{steps} ({exact(seconds, 3)} s)", text)


def frequency_section(fit: Fit) -> Section:
    """Return the chapter on frequency responses of records and model; empty where the fit has none."""
    if not fit.frequency_responses:
        return Section("")
    table = table_of(
        fit.frequency_responses,
        words("Response", lambda r: f"{channel_letter(r.output)} over {channel_letter(r.input)}"),
        number("excited", lambda r: " to ".join(significant(w, 2) for w in r.excited_range), "rad/s"),
        number("compared", lambda r: str(int(r.is_compared.sum()))),
        number("model inside", lambda r: _where_compared(r, str(int((r.is_inside & r.is_compared).sum())))),
        number("coherence there, mean", _coherence),
    )
    caption = "Magnitude and phase with the 95 % region of the records (Jenkins & Watts 1968, section 10.3)."
    picture = Picture(
        lambda: "" if (chart := frequency_chart(fit.frequency_responses)) is None else svg(chart), caption
    )
    return Section(
        "Frequency response: records and model",
        "frequency",
        table=table,
        note=_COMPARED_NOTE,
        pictures=(picture,),
        level=Level.DETAIL,
        is_folded=True,
    )


def _where_compared(r: FrequencyResponse, text: str) -> str:
    return text if r.is_compared.any() else ""


def _coherence(r: FrequencyResponse) -> str:
    return fixed(float(r.coherence[r.is_compared].mean()), 2) if r.is_compared.any() else ""


# Chapters on runs: how those held out are predicted, and how those that were fitted are reproduced.

# measures of a run, and held-out runs, that are shown unfolded; chosen, one screen
MAX_MEASURES, MAX_RUNS = 8, 4
_ERROR_DIGITS = 3  # significant ones; chosen
_FLOOR_NOTE = "Process noise: error that the disturbance as estimated would leave by itself, model error in it."
_TIED_NOTE = "Tied models: standard deviation over the models that the records do not distinguish."
_ZONES = {"edge": "just beyond", "beyond": "beyond", "inside": "inside"}
_TONES = {"edge": "warn", "beyond": "bad"}


def prediction_section(fit: Fit) -> Section:
    """Return the chapter on the held-out runs; empty where there are none."""
    held = fit.validation
    if not held:
        return Section("")
    drawn = {p.record for p in drawn_predictions(fit.predictions)}
    runs = [run_section(p, fit.predictions, *_drawing(fit), is_drawn=p.record in drawn) for p in held]
    start = significant(fit.predictions[0].initial_seconds, 2)
    note = (
        "Root mean square of model minus record over each run, simulated open loop from its recorded inputs. The state "
        f"at the start comes from the first {start} s of the run. Nothing is fitted on a held-out run. {GRADE_NOTE}"
    )
    return Section(
        "Prediction of held-out runs",
        "prediction",
        note=f"{note} {table_notes(fit.predictions)} {reading_note(fit.predictions)}",
        table=score_table(fit.predictions, _track_unit(fit)),
        parts=(*runs, _window_section(fit)),
        widget=resimulation(fit),
        unfolded=MAX_RUNS,
    )


def training_section(fit: Fit) -> Section:
    """Return the chapter on the runs that were fitted; empty where none was simulated."""
    drawn = {p.record for p in drawn_predictions(fit.predictions)}
    runs = [p for p in fit.predictions if p.role == "training" and p.record in drawn]
    hidden = hidden_runs_sentence(fit.predictions)
    return (
        Section(
            "Fit of the training runs",
            "training",
            sentences=(hidden,) if hidden else (),
            table=None if fit.validation else score_table(fit.predictions, _track_unit(fit)),
            note="" if fit.validation else f"{table_notes(fit.predictions)} {reading_note(fit.predictions)}",
            parts=tuple(replace(run_section(p, fit.predictions, *_drawing(fit)), is_folded=True) for p in runs),
            level=Level.PAGE,
            is_folded=True,
        )
        if runs
        else Section("")
    )


# One row for each run: its errors, and how far it leaves the training runs.


def score_table(predictions: Sequence[Prediction], length: float) -> TextTable:
    """Return the errors of every run, those held out first; on the page only.

    length: of the craft [m], in which positions are given too; 0: in none.
    """
    ordered = sorted(predictions, key=lambda p: p.role != "validation")
    names = [name for name in ERROR_LABELS if any(name in p.rms for p in ordered)]
    columns = [_error_column(name, ordered, DEGREES if name == "r" else 1.0, ERROR_LABELS[name]) for name in names]
    if "position_m" in names and length > 0.0:
        place = names.index("position_m") + 1
        columns.insert(place, _error_column("position_m", ordered, 1.0 / length, ("position", "L")))
    return _page_only(
        table_of(
            ordered,
            words("Run", _run_cell),
            words("Role", lambda p: "held out" if p.role == "validation" else "fitted", is_wide=True),
            words("Repeats", lambda p: _repeats(p, predictions), is_wide=True),
            *columns,
            number("extrapolation index", _extrapolation_cell),
            is_marked=lambda p: p.role == "validation",
        )
    )


def _drawing(fit: Fit) -> tuple[float, Sequence[str], Mapping[str, float]]:
    """Length of the craft [m], 0 where it is not known, inputs of the model, and the sensors' own errors."""
    return fit.ship.particulars.get("L", 0.0), fit.model.input_names, fit.sensor_errors


def _track_unit(fit: Fit) -> float:
    """The length in which errors of position are given: of a ship, not of a craft with thrusters."""
    return 0.0 if fit.model.has_thrusters else fit.ship.particulars.get("L", 0.0)


def _page_only(table: TextTable) -> TextTable:
    return replace(table, headings=tuple(replace(heading, level=Level.PAGE) for heading in table.headings))


def _run_cell(p: Prediction) -> str:
    return p.record if p.divergence is None else f"{p.record} (diverges; first {duration(p.divergence.seconds)})"


def _error_column(
    name: str, predictions: Sequence[Prediction], factor: float, label: tuple[str, str]
) -> Column[Prediction]:
    values = [None if name not in p.rms else factor * p.rms[name] for p in predictions]
    texts = dict(zip((p.record for p in predictions), column_texts(values), strict=True))
    return number(label[0], lambda p: texts[p.record], label[1])


def _repeats(p: Prediction, predictions: Sequence[Prediction]) -> str:
    return enumeration(repeated_runs(p, predictions), MAX_NAMES) if p.role == "validation" else ""


def _extrapolation_cell(p: Prediction) -> Cell | None:
    e = _extrapolation(p)
    if e is None:
        return None
    zone = extrapolation_zone(e.index)
    return Cell(ratio_text(e.index), _ZONES[zone], _TONES.get(zone, ""))


def _extrapolation(p: Prediction) -> Extrapolation | None:
    """How far a run held out leaves the training runs; None where that is not known, and for training runs."""
    e = p.extrapolation
    return e if e and p.role == "validation" and extrapolation_zone(e.index) else None


def table_notes(predictions: Sequence[Prediction]) -> str:
    """Return how columns of the tables of runs are to be read, as far as they have them."""
    notes = [
        (
            f"Extrapolation index: largest ratio of {ranged_motions([p.measured for p in predictions])} to that of the "
            "training runs. Up to 1 the run stays inside them; beyond 1.2 its intervals are lower limits.",
            any(_extrapolation(p) for p in predictions),
        ),
        (_FLOOR_NOTE, any(p.noise_floor for p in predictions)),
        (_TIED_NOTE, any(set(p.tied_spread) & set(p.rms) for p in predictions)),
    ]
    return " ".join(text for text, holds in notes if holds)


def ranged_motions(runs: Sequence[Record]) -> str:
    """Return what the extrapolation index compares: motions in waves, roll, or those of a craft under way."""
    channels = {name for run in runs for name in run.channels}
    if "zeta" in channels:
        return "heave, pitch or elevation of the waves"
    if "phi" in channels and not {"psi", "r", "u"} & channels:
        return "roll angle"
    return f"yaw rate, drift, {'rudder' if 'delta' in channels else 'command'} or speed"


# One run: its errors by channel, its picture, its measures.


def run_section(
    p: Prediction,
    predictions: Sequence[Prediction],
    length: float,
    inputs: Sequence[str],
    noise: Mapping[str, float],
    *,
    is_drawn: bool = True,
) -> Section:
    """Return the part on one run of all predictions.

    length: of the craft [m], 0 where it is not known; inputs: channels by which it is driven; noise: the sensors' own
    errors.
    """
    repeat = repeat_clause(p, predictions) if p.role == "validation" else ""
    sentences = [f"The run is {repeat}."] if repeat else []
    picture = Picture(lambda: run_figure(replace(prediction_view(p, length, inputs), legend=())))
    return Section(
        f"{'Held out: ' if p.role == 'validation' else ''}{p.record}, {duration(p.measured.duration)}",
        f"run-{[run.record for run in predictions].index(p.record)}",
        sentences=(*sentences, *_sentences(p)),
        table=_errors(p, noise),
        pictures=(picture,) if is_drawn else (),
        parts=(Section("", table=_measures(p), sentences=_unread_manoeuvre(p)),),
    )


def _sentences(p: Prediction) -> list[str]:
    sentences = []
    if not p.rms:
        sentences.append("Nothing can be compared: no channel of the run is an output of the model.")
    if p.divergence is not None:
        terms = f", driven by the terms of {enumeration(p.divergence.terms)}" if p.divergence.terms else ""
        sentences.append(
            f"The simulation diverges in {p.divergence.state} after {duration(p.divergence.seconds)}{terms}. "
            "Errors are those up to then."
        )
    if has_track(p.measured) and "x0" in p.simulated and not has_modelled_position(p):
        sentences.append("The model does not predict the position: its speed U is 0.")
    if (e := _extrapolation(p)) is not None and (e.untrained_kind or extrapolation_zone(e.index) != "inside"):
        sentences.append(f"Extrapolation index {extrapolation_text(e)}")
    return sentences


def _errors(p: Prediction, noise: Mapping[str, float]) -> TextTable:
    """A row for each channel: over the whole run, what process noise leaves, over windows, and without the fit."""
    last = p.windows[-1] if p.windows else None
    windows = [number(f"{w.count} x {w.window}", partial(_window_error, w)) for w in p.windows]
    return table_of(
        list(p.rms),
        words("rms error", lambda name: ", ".join(ERROR_LABELS[name])),
        number("whole run", lambda name: _error(name, p.rms)),
        number("sensor noise", lambda name: _error(name, noise), level=Level.PAGE, is_wide=True),
        number("process noise", lambda name: _error(name, p.noise_floor), is_wide=True),
        number("tied models", lambda name: _error(name, p.tied_spread), is_wide=True),
        *windows,
        *([words(f"best without fit, {last.window}", partial(_best_baseline, last, noise))] if last else []),
    )


def _error(name: str, errors: Mapping[str, float]) -> str:
    return significant(_in_degrees(name, errors[name]), _ERROR_DIGITS) if name in errors else ""


def _in_degrees(name: str, value: float) -> float:
    return value * DEGREES if name == "r" else value


def _window_error(w: WindowScore, name: str) -> str:
    return _error(name, {key: score.rms for key, score in w.scores.items()})


def _best_baseline(w: WindowScore, noise: Mapping[str, float], name: str) -> Cell | str:
    """The best of the predictions that need no fit, and whether it is better."""
    best = min((b for b in w.baselines if name in b.scores), key=lambda b: b.scores[name].rms, default=None)
    if best is None:
        return ""
    text = f"{_error(name, {name: best.scores[name].rms})} {best.name}"
    return Cell(f"{text} (BETTER)", tone="bad") if name in w.better_baselines(noise) else text


def _window_section(fit: Fit) -> Section:
    """Every score in windows, folded: how well the model fits over each length, beside all baselines."""
    better = baseline_sentence(fit, ERROR_LABELS, shortest_judged(fit))
    parts = tuple(
        Section(f"{p.record}, {counted(w.count, 'window')} of {w.window}", table=_window_table(w))
        for p in fit.validation
        for w in p.windows
    )
    return Section(
        "Windows, beside predictions that need no fit",
        sentences=(better,) if better else (),
        note=WINDOW_NOTE if parts else "",
        parts=parts,
        level=Level.DETAIL,
        is_folded=True,
    )


def _window_table(w: WindowScore) -> TextTable:
    def of_baseline(scores: Mapping[str, ChannelScore], name: str) -> str:
        return _error(name, {name: scores[name].rms}) if name in scores else ""

    return table_of(
        list(w.scores),
        words("", lambda name: ", ".join(ERROR_LABELS[name])),
        number("rms", partial(_window_error, w)),
        number("fit", lambda name: fixed(w.scores[name].fit_percent, 1), "%"),
        number("R²", lambda name: fixed(w.scores[name].r_squared, 3)),
        number("in band", lambda name: _inside(w.scores[name])),
        *(number(b.name, partial(of_baseline, b.scores)) for b in w.baselines),
    )


def _inside(score: ChannelScore) -> str:
    if score.inside_band is None:
        return ""
    wide = " (too wide to test)" if score.is_band_too_wide else ""
    return f"{fixed(100.0 * score.inside_band, 0)} %{wide}"


def _measures(p: Prediction) -> TextTable:
    """Measures of a manoeuvre, measured and simulated; those beyond the first ones folded."""
    rows = [(name, m) for name, m in p.measures.items() if m.simulated is not None or not m.is_determined]
    return table_of(
        rows,
        words("Measure", lambda row: ", ".join(part for part in measure_label(row[0]) if part)),
        number(p.reference_word, lambda row: _value(row[0], row[1], row[1].measured)),
        number(p.model_word, _simulated),
        number("95 % interval", _interval),
        number("tied models", lambda row: _spread(p.tied_spread.get(row[0]))),
        unfolded=MAX_MEASURES,
    )


def _spread(value: float | None) -> str:
    return "" if value is None else f"± {significant(value, 2)}"


def _value(name: str, m: Measure, value: float | None) -> str:
    return "" if value is None else fixed(value, measure_decimals(measure_label(name)[1], m))


def _simulated(row: tuple[str, Measure]) -> str:
    return _value(*row, row[1].simulated) if row[1].is_determined else NOT_DETERMINED


def _interval(row: tuple[str, Measure]) -> Cell:
    """The interval, and whether the measured value lies in it."""
    (name, m), verdict = row, interval_verdict(*row)
    if not m.is_determined:
        return Cell()
    is_outside = verdict is IntervalVerdict.OUTSIDE
    ends = interval(m.lower, m.upper, measure_decimals(measure_label(name)[1], m))
    return Cell(ends, verdict.upper() if is_outside else verdict.value, "bad" if is_outside else "")


def _unread_manoeuvre(p: Prediction) -> tuple[str, ...]:
    if not p.measures or any(m.simulated is not None for m in p.measures.values()):
        return ()
    return (
        f"The {p.model_word} run cannot be read as the manoeuvre of the {p.reference_word} one: its heading drifts "
        "off, or it turns too late or too soon for the executes.",
    )
