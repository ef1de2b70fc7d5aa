"""Runs on the page: a table of their errors, a figure and the measures of each, the IMO criteria."""

from collections.abc import Sequence
from dataclasses import dataclass

from seatrial.core.results import Fit, Prediction
from seatrial.core.results.fit_charts import has_band
from seatrial.core.results.prediction import estimated_current
from seatrial.core.text.numbers import fixed
from seatrial.core.text.words import sentence
from seatrial.core.values import InputError, Record
from seatrial.core.values.record_chart import has_track
from seatrial.physics.manoeuvres import ImoCriterion, imo_criteria
from seatrial.physics.sensors.measured_outputs import shows_ground_velocity, without_current
from seatrial.reporting.grades import run_error
from seatrial.reporting.measures import corrected_measure_label
from seatrial.reporting.section import Cell, Level, Section, number, table_of, words

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
