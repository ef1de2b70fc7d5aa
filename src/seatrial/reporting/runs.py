"""Runs of a fit: errors, measures, and the curves of measured and simulated motion."""

import base64
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup

from seatrial.core.equations import Model
from seatrial.core.equations.latex import rates_function
from seatrial.core.results import Coefficient, Fit, Prediction
from seatrial.core.results.fit_charts import has_band
from seatrial.core.results.prediction import estimated_current
from seatrial.core.text.numbers import fixed
from seatrial.core.text.words import sentence
from seatrial.core.values import Array, InputError, Record, display_unit
from seatrial.core.values.notation import channel_label, channel_letter, channel_meaning, channel_unit, display_values
from seatrial.core.values.record_chart import has_track
from seatrial.physics.manoeuvres import ImoCriterion, imo_criteria
from seatrial.physics.sensors.measured_outputs import shows_ground_velocity, without_current
from seatrial.physics.simulate.filtering import corrected_inputs as delayed_inputs
from seatrial.physics.simulate.replay import inputs_of, state_limits
from seatrial.reporting.document import environment
from seatrial.reporting.measures import corrected_measure_label
from seatrial.reporting.section import Cell, Level, Section, number, table_of, words
from seatrial.reporting.verdict import run_error

# Held-out runs that the page simulates again with other coefficients: data, controls and script, in one piece.

# a slider reaches so many half widths of the 95 % interval to each side, and this share of the estimate; both chosen
HALF_WIDTHS, SHARE = 3.0, 0.5
MAX_SAMPLES = 6000  # of a run: with two inputs and three channels 250 kB of page; chosen
MAX_LETTERS = 160_000  # of the data of all runs, with which a page of 15 runs stays below a megabyte
_CHANNELS = ("psi", "theta", "phi", "z", "u")  # of which the first that the run has is drawn; chosen, as at the top
_POSITION = ("y0", "x0")  # east, north
# deviation from the prediction of the fit, as a share of its range, from which on the page does not draw the run
AGREEMENT = 1e-6
_MOST_REPEATED = 0.5  # distinct values over samples up to which a table is shorter; chosen
COMPARED = 60  # samples of each channel that are compared; chosen


@dataclass(frozen=True)
class Slider:
    """A coefficient that can be moved, SI."""

    name: str
    meaning: str
    unit: str
    place: int
    value: float
    low: float
    high: float
    interval: tuple[float, float] | None


def resimulation(fit: Fit) -> Markup:
    """Return the part of the page that simulates held-out runs again; empty where there is none to simulate.

    The model has to be integrated step by step (no exact propagator), a run has to have all inputs, and every state
    needs a start. The script compares its own run with the prediction before it draws. The worst run is shown first.
    """
    able = sorted((p for p in fit.validation if _can_be_simulated(p, fit)), key=run_error, reverse=True)
    free = [c for c in fit.coefficients if not c.fixed]
    if not able or not free:
        return Markup()
    sliders, runs = [_slider(c, fit) for c in free], _documents(able, fit)
    names = [p.record for p in fit.validation if p.record in runs]
    common = {
        "agreement": AGREEMENT,
        "sliders": [{"place": s.place, "value": s.value, "low": s.low, "high": s.high} for s in sliders],
    }
    data = f'{_json(common)[:-1]},"runs":[{",".join(runs[name] for name in names)}]}}'
    values = {
        "names": names,
        "worst": able[0].record,
        "left_out": [p.record for p in able if p.record not in runs],
        "sliders": sliders,
        "data": Markup(data.replace("<", "\\u003c")),  # a closing tag inside the text would end the element
        "script": Markup(replay_script(fit.model)),
    }
    return Markup(environment().get_template("resimulation.html").render(values))


def _documents(runs: Sequence[Prediction], fit: Fit) -> dict[str, str]:
    """The data of each run by its name, the first always, of the others those that fit."""
    texts = dict[str, str]()
    for p in runs:
        text = _json(_document(p, fit))
        if not texts or sum(map(len, texts.values())) + len(text) <= MAX_LETTERS:
            texts[p.record] = text
    return texts


def _json(document: Mapping[str, Any]) -> str:
    return json.dumps(document, separators=(",", ":"), ensure_ascii=False)


def replay_script(model: Model) -> str:
    """Return the script that simulates a run: `replay`, the integrator, and the model's `rates`."""
    return f"{environment().get_template('replay.js').render()}\nconst rates = {rates_function(model)};\n"


def _can_be_simulated(p: Prediction, fit: Fit) -> bool:
    model = fit.model
    if model.is_affine or len(p.measured) > MAX_SAMPLES or not set(model.states) <= set(p.simulated.channels):
        return False
    if not all(np.isfinite(p.simulated[s][0]) for s in model.states) or not _plotted_channels(p, model.states):
        return False
    try:
        inputs_of(model, p.measured)
    except InputError:
        return False
    return True


def _plotted_channels(p: Prediction, states: tuple[str, ...]) -> list[str]:
    """Channels to be drawn: positions where the run has both, and the one that says most of it."""
    both = [s for s in states if s in p.measured and np.isfinite(p.measured[s]).any()]
    first = next((s for s in _CHANNELS if s in both), None)
    return [*(_POSITION if set(_POSITION) <= set(both) else ()), *([first] if first else [])]


def _document(p: Prediction, fit: Fit) -> dict[str, Any]:
    model, names = fit.model, _plotted_channels(p, fit.model.states)
    values = [p.offsets.get(q.name, float(q.value)) for q in model.parameters]
    return {
        "dt": p.measured.dt, "count": len(p.measured), "limits": state_limits(model).tolist(),
        "start": [float(p.simulated[s][0]) for s in model.states],
        "inputs": [_coded(column) for column in corrected_inputs(p, fit).T],
        "held": [i.is_held for i in model.inputs], "parameters": values, "reference": p.reference_word,
        "channels": [_channel(p, name, model.states.index(name)) for name in names],
    }  # fmt: skip


def corrected_inputs(p: Prediction, fit: Fit) -> Array:
    """Return the inputs with which the run was simulated, in the model's signs, shape (n, nu).

    Each is gain times the recorded one, `delay` seconds earlier, plus zero.
    """
    gain, zero, delay = (
        np.array([p.offsets.get(f"{name} {kind}", neutral) for name in fit.model.input_names])
        for kind, neutral in _CORRECTIONS
    )
    return delayed_inputs(inputs_of(fit.model, p.measured), p.measured.dt, gain, zero, delay)[0]


_CORRECTIONS = (
    ("gain", 1.0),
    ("zero", 0.0),
    ("delay", 0.0),
)  # kinds of a correction of an input, and what does nothing


def _channel(p: Prediction, name: str, place: int) -> dict[str, Any]:
    unit = channel_unit(name)
    return {
        "state": place, "label": channel_label(name, unit), "name": channel_letter(name),
        "meaning": channel_meaning(name), "unit": display_unit(unit)[1], "factor": display_unit(unit)[0],
        "is_position": name in _POSITION,
        "measured": _packed(_without_wrap(p.measured, name, unit), np.float32),
        "predicted": [float(v) for v in p.simulated[name][:: _stride(p)]], "stride": _stride(p),
    }  # fmt: skip


def _stride(p: Prediction) -> int:
    """Samples from one that is compared with the prediction to the next."""
    return max(1, len(p.simulated) // COMPARED)


def _without_wrap(record: Record, name: str, unit: str) -> Array:
    """Values in SI, headings without wrap."""
    return display_values(name, record[name], unit) / display_unit(unit)[0]


def _coded(values: Array) -> str | float | dict[str, str | float | bool]:
    """Numbers of double precision: as places in a table of those that occur, where that is shorter.

    Loggers write few digits, so that an input of thousands of samples has some hundred values.
    """
    table, index = np.unique(values, return_inverse=True)
    is_wide = len(table) > np.iinfo(np.uint8).max + 1
    if len(table) == 1 or len(table) > np.iinfo(np.uint16).max or len(table) > _MOST_REPEATED * len(values):
        return _packed(values, np.float64)
    places = index.astype("<u2" if is_wide else "<u1")
    return {"table": _packed(table, np.float64), "index": base64.b64encode(places.tobytes()).decode(), "wide": is_wide}


def _packed(values: Array, kind: type) -> str | float:
    """Little-endian numbers in base 64; a channel that is constant is its value."""
    if np.all(values == values[0]):
        return float(values[0])
    return base64.b64encode(np.ascontiguousarray(values, dtype=np.dtype(kind).newbyteorder("<")).tobytes()).decode()


def _slider(c: Coefficient, fit: Fit) -> Slider:
    parameter = fit.model.parameters[c.name]
    interval = None if c.lower is None or c.upper is None else (c.lower, c.upper)
    half = 0.0 if interval is None else 0.5 * (interval[1] - interval[0])
    reach = max(HALF_WIDTHS * half, SHARE * abs(c.estimate)) or parameter.characteristic_scale
    low, high = max(c.estimate - reach, parameter.lower), min(c.estimate + reach, parameter.upper)
    unit = "" if c.unit == "1" else c.unit
    place = fit.model.parameters.index(c.name)
    return Slider(c.name, c.meaning, unit, place, c.estimate, low, high, interval)


# Runs on the page: a table of their errors, a figure and the measures of each, the IMO criteria.

# runs up to which all are drawn; beyond, how many of the worst ones of each role
MAX_DRAWN, WORST_DRAWN = 15, 12
CURRENT_NOTE = (
    "runs in a current that the fit estimated are corrected for it, measured and simulated alike: track minus current "
    "times time, speeds through the water (IMO MSC/Circ.1053, 3.4.2.5; ITTC 7.5-04-02-01, 5.1.1)"
)


def reading_note(predictions: Sequence[Prediction]) -> str:
    """Return how the figures of runs are to be read, once for all of them; empty without runs."""
    if not predictions:
        return ""
    p = predictions[0]
    reference = "the reference, itself simulated" if p.is_reference_simulated else "measured"
    inputs = "as in the reference" if p.is_reference_simulated else "as measured"
    has_ships = any(has_track(prediction.measured) for prediction in predictions)
    band = f" Pale: 95 % band of the {p.model_word} run{', of a track on all sides' if has_ships else ''}."
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
        kept += sorted((p for p in predictions if p.role == role), key=run_error, reverse=True)[:WORST_DRAWN]
    return [p for p in predictions if any(p is one for one in kept)]


def hidden_runs_sentence(predictions: Sequence[Prediction]) -> str:
    """Return which runs are drawn where some are not; empty where all are."""
    if len(drawn_predictions(predictions)) == len(predictions):
        return ""
    held = sum(p.role == "validation" for p in predictions)
    of_held = "the held-out runs" if held <= WORST_DRAWN else f"the {WORST_DRAWN} worst held-out runs"
    return f"Of {len(predictions)} runs, {of_held} and the {WORST_DRAWN} worst training runs are drawn."


@dataclass(frozen=True)
class _JudgedMeasure:
    """A criterion of a run, measured and simulated: ``label`` with its unit."""

    record: str
    label: str
    unit: str
    measured: ImoCriterion
    simulated: ImoCriterion | None

    def text(self, value: float | None) -> str:
        return fixed(value, 1 if self.unit == "deg" else 2)


def standard_section(predictions: Sequence[Prediction], fit: Fit, length: float) -> Section:
    """Return the chapter on the IMO criteria that apply to the records, and the notes on them.

    A run and its simulation in the same current are both corrected for it, where the fit estimated it.
    """
    rows, notes = list[_JudgedMeasure](), list[str]()
    has_ground_velocity = shows_ground_velocity(fit.model)
    for p in predictions:
        current = estimated_current(p, fit.offsets)
        run, model = (without_current(one, current, has_ground_velocity) for one in (p.measured, p.simulated))
        measured = _applicable_criteria(run, length, fit.ship.scale, run)
        simulated = {c.name: c for c in _applicable_criteria(model, length, fit.ship.scale, run)}
        notes += [CURRENT_NOTE] if current is not None and measured else []
        for c in measured:
            label = corrected_measure_label(c.name, None if current is None else current.speed)
            rows.append(_JudgedMeasure(p.record, *label, c, simulated.get(c.name)))
            notes += [c.note] if c.note else []
    table = table_of(
        rows,
        words("Run", lambda row: row.record),
        words("Measure", lambda row: row.label),
        words("unit", lambda row: row.unit),
        number("measured", lambda row: row.text(row.measured.value)),
        number("simulated", lambda row: row.text(row.simulated.value) if row.simulated else ""),
        number("limit", lambda row: row.text(row.measured.limit)),
        words("", lambda row: _fulfilled(row.measured)),
        words("Paragraph", lambda row: row.measured.source.rsplit(", ", 1)[-1], is_wide=True),
    )
    about = "IMO resolution MSC.137(76), section 5.3, where the manoeuvre of a record allows."
    note = " ".join(sentence(text) for text in dict.fromkeys(notes))
    return Section(
        "IMO standards",
        "standards",
        (about,) if table else (),
        table=table,
        note=note,
        level=Level.PAGE,
        is_folded=True,
    )


def _fulfilled(c: ImoCriterion) -> Cell:
    return Cell("within", tone="good") if c.is_fulfilled else Cell("exceeds", tone="bad")


def _applicable_criteria(record: Record, length: float, scale: float, like: Record) -> tuple[ImoCriterion, ...]:
    """The record's criteria, its manoeuvre as in `like`; none where they do not apply."""
    try:
        return imo_criteria(record, length, scale, reference=like) if length > 0 else ()
    except InputError:
        return ()
