"""The chapter on other estimators: their coefficients compared with the fit's, and how they predict the runs."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median

from markupsafe import Markup

from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Baseline, Coefficient, Fit, OpenLoopScores, Table
from seatrial.core.results.prediction import NO_COMPARISON
from seatrial.core.text.numbers import exact, fixed, significant
from seatrial.core.text.words import counted, enumeration, sentence
from seatrial.core.values import display_unit
from seatrial.core.values.notation import unit_text
from seatrial.reporting.figures.relative_errors import CoefficientError, estimator_chart
from seatrial.reporting.text_tables import TextTable, text_table

# distance from the fit in its standard errors up to which a coefficient is near, and up to which it is off
NEAR, OFF = 2.0, 10.0
# correlation of simulated and measured channels from which on a trajectory counts as good
HIGH_CORRELATION = 0.9
_COLUMNS = {
    "psi_deg": ("heading, deg", 1.0), "position_m": ("position, m", 1.0), "u": ("u, m/s", 1.0), "v": ("v, m/s", 1.0),
    "r": ("r, deg/s", math.degrees(1.0)), "z": ("heave, m", 1.0), "theta_deg": ("pitch, deg", 1.0),
}  # fmt: skip


@dataclass(frozen=True)
class BaselineCell:
    """A coefficient as text, the gap to the fit below it, and a word for its size: near, off or far."""

    value: str
    gap: str
    gap_class: str


@dataclass(frozen=True)
class BaselineRow:
    """An estimator's coefficients; median and worst are per cent, of the truth where it is known, else of the fit."""

    name: str
    median: str
    worst: str
    cells: tuple[BaselineCell, ...]


@dataclass(frozen=True)
class BaselineChapter:
    """What the chapter shows; without rows, `sentences` say why there is no comparison."""

    sentences: tuple[str, ...]
    header: tuple[tuple[str, str], ...] = ()
    truth: tuple[str, ...] = ()
    rows: tuple[BaselineRow, ...] = ()
    figure: Markup = Markup("")  # noqa: RUF009
    tables: tuple[TextTable, ...] = ()
    notes: tuple[str, ...] = ()


def baseline_chapter(fit: Fit) -> BaselineChapter | None:
    """Return the chapter; None where no comparison was requested."""
    if not fit.baselines:
        why = [f.text for f in fit.findings if f.code == NO_COMPARISON]
        return BaselineChapter((sentence(why[0]),)) if why else None
    free = [c for c in fit.coefficients if not c.fixed]
    first = fit.baselines[0]
    held, fitted = _named_runs(fit.baselines, "validation"), _named_runs(fit.baselines, "training")
    axis_name = "error, per cent of the known value" if first.error else (
        "difference from the fit, per cent of its estimate"
    )  # fmt: skip
    return BaselineChapter(
        baseline_sentences(fit),
        tuple((c.name, unit_text(c.unit)) for c in free),
        tuple(exact(_display_value(c.truth, c), 4) for c in free) if first.error else (),
        tuple(_baseline_row(r, first, free) for r in fit.baselines if r.values and (r is first or not r.is_fit)),
        Markup(svg(estimator_chart(_coefficient_errors(fit.baselines), axis_name))),
        tuple(text_table(t) for t in _tables(fit.baselines, held, fitted) if t.header[1:] and t.rows),
        tuple(note for r in fit.baselines for note in _notes(r)),
    )


def baseline_sentences(fit: Fit) -> tuple[str, ...]:
    """Return which regression comes nearest, which fail, and how well they predict trajectories."""
    first, regressions = fit.baselines[0], [r for r in fit.baselines if not r.is_fit]
    solved = [r for r in regressions if r.values]
    failed = [f"“{r.name}”" for r in regressions if not r.values]
    lost = [f"“{r.name}”" for r in solved if r.diverged]
    kind = "other estimator" if fit.model.is_affine else "regression"
    text = [f"{counted(len(regressions), kind).capitalize()} on the same training runs, as recorded."]
    if failed:
        text.append(f"{_count_word(failed)} of them {'fails' if len(failed) == 1 else 'fail'}: {enumeration(failed)}.")
    if lost:
        verb = "gives" if len(lost) == 1 else "give"
        text.append(
            f"{_count_word(lost)} {verb} coefficients with which a simulated run diverges: {enumeration(lost)}."
        )
    if solved:
        text.append(_nearest_sentence(first, solved))
    held = sum(c.prior_mean is not None for c in fit.coefficients if not c.fixed)
    if held:
        text.append(f"The fit has priors for {counted(held, 'coefficient')} and the regressions have none, so that "
                    "differences show what the priors do as well.")  # fmt: skip
    return tuple(t for t in (" ".join(text), _trajectory_sentences(fit, solved)) if t)


def _count_word(items: Sequence[str]) -> str:
    return "One" if len(items) == 1 else str(len(items))


def _nearest_sentence(reference: Baseline, solved: Sequence[Baseline]) -> str:
    best = min(solved, key=lambda r: _median_deviation(r, reference))
    if not reference.error:
        return f"Nearest to the fit comes “{best.name}”: {_difference(best, reference)}."
    own = [_percent(part(reference, reference)) for part in (_median_deviation, _worst_deviation)]
    nearest = f"Nearest to the known values comes “{best.name}”: {_difference(best, reference)}"
    return f"{nearest}; the fit is {own[0]} % and {own[1]} % off."


def _difference(baseline: Baseline, reference: Baseline) -> str:
    off = "off" if reference.error else "from the fit"
    return (
        f"{_percent(_median_deviation(baseline, reference))} % {off} in the median, "
        f"{_percent(_worst_deviation(baseline, reference))} % at worst"
    )


def _trajectory_sentences(fit: Fit, solved: Sequence[Baseline]) -> str:
    """How well wrong coefficients can predict trajectories."""
    first, role = fit.baselines[0], "validation" if fit.validation else "training"
    alone = [r for r in fit.baselines if r.is_fit][-1]
    counts = [_count_better(alone, solved, other_role) for other_role in dict.fromkeys((role, "training"))]
    text = []
    without = "" if alone is first else ", its offsets set to zero"
    if all(counts):
        text.append(f"Heading nearer the measured one than the fit’s{without}: {' and '.join(counts)}.")
    alike = [r for r in solved if min(_simulated_runs(r, role).correlation.values(), default=0.0) > HIGH_CORRELATION]
    if alike:
        worst = max(alike, key=lambda r: _median_deviation(r, first))
        least = fixed(min(_simulated_runs(worst, role).correlation.values()), 3)
        text.append(
            f"Good trajectories prove nothing about coefficients: those of “{worst.name}” are "
            f"{_difference(worst, first)}, and yet its u, v and r correlate with the measured ones by {least} or "
            "better (CC)."
        )
    return " ".join(text)


def _count_better(fit: Baseline, solved: Sequence[Baseline], role: str) -> str:
    """How many predict runs of a role with a smaller error of heading than the fit; empty where nothing is known."""
    heading_of_fit = _simulated_runs(fit, role).rms.get("psi_deg")
    headings = [_simulated_runs(r, role).rms["psi_deg"] for r in solved if "psi_deg" in _simulated_runs(r, role).rms]
    if heading_of_fit is None or not headings:
        return ""
    runs = "held-out" if role == "validation" else "training"
    number = sum(h < heading_of_fit for h in headings) or "none"
    return f"{number} of the {len(headings)} that simulate the {runs} runs"


def _simulated_runs(baseline: Baseline, role: str) -> OpenLoopScores:
    return baseline.validation if role == "validation" else baseline.training


def _named_runs(items: Sequence[Baseline], role: str) -> list[tuple[str, OpenLoopScores]]:
    return [(r.name, _simulated_runs(r, role)) for r in items if r.values]


def _deviations(baseline: Baseline, reference: Baseline) -> list[float]:
    return [abs(a) for a in baseline.relative_deviation(reference).values()] or [math.nan]


def _median_deviation(baseline: Baseline, reference: Baseline) -> float:
    return median(_deviations(baseline, reference))


def _worst_deviation(baseline: Baseline, reference: Baseline) -> float:
    return max(_deviations(baseline, reference))


def _percent(value: float) -> str:
    return significant(100.0 * value, 2)


def _display_value(value: float | None, c: Coefficient) -> float | None:
    return None if value is None else value * display_unit(c.unit)[0]


def _baseline_row(baseline: Baseline, reference: Baseline, free: Sequence[Coefficient]) -> BaselineRow:
    is_first = baseline is reference
    has_errors = bool(reference.error) or not is_first
    middle, worst = (
        _percent(part(baseline, reference)) if has_errors else "" for part in (_median_deviation, _worst_deviation)
    )
    cells = tuple(_fit_cell(c) if is_first else _baseline_cell(baseline, c) for c in free)
    return BaselineRow(baseline.name, middle, worst, cells)


def _fit_cell(c: Coefficient) -> BaselineCell:
    """The fit's own estimate with its standard error."""
    error = "" if c.standard_error is None else f"± {significant(_display_value(c.standard_error, c), 2)}"
    return BaselineCell(significant(_display_value(c.estimate, c)), error, "")


def _baseline_cell(baseline: Baseline, c: Coefficient) -> BaselineCell:
    value, gap = significant(_display_value(baseline.values[c.name], c)), baseline.normalised_difference.get(c.name)
    if gap is None:
        return BaselineCell(value, "", "")
    where = "near" if abs(gap) <= NEAR else "off" if abs(gap) <= OFF else "far"
    sign = "+" if gap > 0 else ""
    return BaselineCell(value, f"{where}: {sign}{significant(gap, 2)}", where)


def _coefficient_errors(items: Sequence[Baseline]) -> dict[str, dict[str, CoefficientError]]:
    """Estimator -> coefficient -> error."""
    first, errors = items[0], {}
    for r in items if first.error else items[1:]:
        deviations = r.relative_deviation(first)
        if deviations and (r is first or not r.is_fit):
            errors[r.name] = {
                name: CoefficientError(100.0 * abs(d), abs(r.normalised_difference.get(name, math.inf)) <= NEAR)
                for name, d in deviations.items()
            }
    return errors


def _table(title: str, items: Sequence[tuple[str, OpenLoopScores]]) -> Table:
    keys = [k for k in _COLUMNS if any(k in s.rms for _, s in items)]
    channels = list(dict.fromkeys(c for _, s in items for c in s.correlation))
    header = tuple(_COLUMNS[k][0] for k in keys) + tuple(f"CC of {c}" for c in channels)
    rows = []
    for name, s in items:
        errors = [s.rms[k] * _COLUMNS[k][1] if k in s.rms else None for k in keys]
        rows.append((name, *errors, *(s.correlation.get(c) for c in channels)))
    return Table(title, ("Estimator", *header) if header else ("Estimator",), tuple(rows))


def _tables(
    items: Sequence[Baseline], held: Sequence[tuple[str, OpenLoopScores]], fitted: Sequence[tuple[str, OpenLoopScores]]
) -> tuple[Table, ...]:
    """Scores of simulated runs, and of the rows that pipelines keep for testing."""
    return _table("Held-out runs", held), _table("Training runs", fitted), _test_table(items)


def _test_table(items: Sequence[Baseline]) -> Table:
    rows = [
        (r.name, equation, s.rows, s.rmse, s.correlation, s.explained) for r in items for equation, s in r.test.items()
    ]
    return Table(
        "Rows kept for testing", ("Estimator", "equation", "rows", "RMSE, SI", "CC", "explained"), tuple(rows),
        "The last part of each record, predicted row by row by the regression. Explained: 1 less the residual's mean "
        "square over the variance; below 0 the mean of the rows predicts better.",
    )  # fmt: skip


def _notes(baseline: Baseline) -> list[str]:
    """What failed, diverged or was dropped, and constants that were fitted in addition."""
    notes = [f"{baseline.name} failed: {baseline.note}"] if baseline.note else []
    if baseline.diverged:
        notes.append(f"{baseline.name}: the simulation of {enumeration(baseline.diverged)} diverges")
    notes += [f"{baseline.name}: {f.text}" for f in baseline.findings]
    constants = [f"{significant(b, 2)} in {equations}" for equations, b in baseline.bias.items() if b]
    if constants:
        notes.append(f"{baseline.name}: constants in addition to the model's terms, {enumeration(constants)}")
    return notes
