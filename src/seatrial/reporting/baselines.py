"""The chapter on other estimators: their coefficients compared with the fit's, and how they predict the runs."""

import math
from collections.abc import Callable, Sequence, Set
from functools import partial
from statistics import median

import numpy as np

from seatrial.core.figures.panels import NamedCurve, curves_chart
from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Baseline, Coefficient, Fit, OpenLoopScores
from seatrial.core.results.prediction import NO_COMPARISON
from seatrial.core.results.term_selection import SelectedTerms
from seatrial.core.text.numbers import exact, fixed, significant
from seatrial.core.text.words import counted, enumeration, sentence
from seatrial.core.values import display_unit
from seatrial.core.values.notation import unit_text
from seatrial.reporting.figures.coefficient_charts import CoefficientError, estimator_chart
from seatrial.reporting.section import Cell, Column, Level, Picture, Section, TextTable, name, number, table_of, words

# distance from the fit in its standard errors up to which a coefficient is near, and up to which it is off
NEAR, OFF = 2.0, 10.0
# correlation of simulated and measured channels from which on a trajectory counts as good
HIGH_CORRELATION = 0.9
_TITLE = "Other estimators on the same records"
_TERMS_TITLE = "Terms that Lasso selects"
_TERMS_NOTE = (
    "Lasso’s path (Song et al. 2025, eq. (11)) over the candidates that the model declares, on the weak form of the "
    "training runs. Least squares on the terms that a penalty keeps predicts what was left out. The largest penalty "
    "within one standard error of the least error is chosen (Breiman et al. 1984)."
)
_TINY = 1e-300  # above zero, for a logarithm
_RUN_NOTE = (
    "Root mean square of simulated minus measured over all runs of that kind, open loop from the recorded inputs and "
    "from the initial state that the fit gave each run. CC: Pearson’s correlation of measured and simulated, mean over "
    "the runs. Good trajectories and correlations prove nothing about coefficients."
)
_TEST_NOTE = (
    "The last part of each record, predicted row by row by the regression. Explained: 1 less the residual's mean "
    "square over the variance; below 0 the mean of the rows predicts better."
)
_COLUMNS = {
    "psi_deg": ("heading, deg", 1.0),
    "position_m": ("position, m", 1.0),
    "u": ("u, m/s", 1.0),
    "v": ("v, m/s", 1.0),
    "r": ("r, deg/s", math.degrees(1.0)),
    "z": ("heave, m", 1.0),
    "theta_deg": ("pitch, deg", 1.0),
}


def term_section(fit: Fit) -> Section:
    """Return the chapter on the terms that Lasso selects; empty where they were not compared."""
    selection = fit.term_selection
    if selection is None:
        return Section("")
    free = set(fit.model.parameters.free_names)
    kept = set(selection.kept)
    both = [name for terms in selection.equations for name in terms.candidates if name in free]
    sentences = [
        f"Of {counted(sum(len(terms.candidates) for terms in selection.equations), 'candidate term')} Lasso keeps "
        f"{len(kept)}; the fit has {len(both)} of the candidates.",
        *_difference_sentences(both, kept),
        f"Left out one after the other: {selection.left_out}. The fit’s own choice is judged by the runs it predicts.",
    ]
    unpredicted = [terms.equations for terms in selection.equations if terms.errors[terms.chosen] >= 1.0]
    if unpredicted:
        sentences.append(f"No choice of terms predicts the rate of {enumeration(unpredicted)} in what was left out.")
    if selection.held:
        sentences.append(
            f"Held at the fit’s values, as the rates are not linear in them: {enumeration(selection.held)}."
        )
    table = table_of(
        selection.equations,
        words("rate of", lambda terms: terms.equations),
        words(
            "kept, as they enter", lambda terms: ", ".join(name for name in terms.order if name in terms.kept) or "none"
        ),
        words("dropped", lambda terms: ", ".join(terms.dropped)),
        number("error, all terms", lambda terms: significant(100.0 * terms.errors[0], 3), "%"),
        number("error, terms kept", lambda terms: significant(100.0 * terms.errors[terms.chosen], 3), "%"),
        number("least error", lambda terms: significant(100.0 * terms.errors[terms.best], 3), "%"),
    )
    pictures = tuple(_path_picture(terms) for terms in selection.equations)
    return Section(
        _TERMS_TITLE, "terms", tuple(sentences), table=table, note=_TERMS_NOTE,
        parts=(Section("Errors along the path", pictures=pictures, level=Level.PAGE),), is_folded=True,
    )  # fmt: skip


def _difference_sentences(free: Sequence[str], kept: Set[str]) -> list[str]:
    """In which terms the fit and Lasso differ."""
    without, beyond = [name for name in free if name not in kept], sorted(kept - set(free))
    text = []
    if without:
        text.append(f"In the fit and not kept: {enumeration(without)}.")
    if beyond:
        text.append(f"Kept and not in the fit: {enumeration(beyond)}; --choose tries such terms in the fit itself.")
    return text or ["Both have the same terms."]


def _path_picture(terms: SelectedTerms) -> Picture:
    penalties = np.log10(np.maximum(np.array(terms.penalties), _TINY))
    curves = [NamedCurve("error, % of the rate’s rms", penalties, 100.0 * np.array(terms.errors))]
    chart = curves_chart(f"path of {terms.equations}", curves, "log10 of the penalty", "error, %")
    count = terms.counts[terms.chosen]
    return Picture(
        partial(svg, chart),
        f"Rate of {terms.equations}: error on what was left out, by the penalty; {counted(count, 'term')} at log10 "
        f"{fixed(float(penalties[terms.chosen]), 2)}.",
    )


def baseline_section(fit: Fit) -> Section:
    """Return the chapter on other estimators; empty where no comparison was requested."""
    if not fit.baselines:
        why = [f.text for f in fit.findings if f.code == NO_COMPARISON]
        return Section(_TITLE, "baselines", (sentence(why[0]),)) if why else Section("")
    first, held = fit.baselines[0], "Held-out runs"
    parts = [
        Section(
            "Coefficients",
            pictures=(_picture(fit.baselines),),
            table=_coefficients(fit),
            note=_distance_note(first),
            level=Level.PAGE,
        ),
        *(
            Section(
                title, table=_runs(fit.baselines, role), note=_RUN_NOTE if title == held else "", level=Level.DETAIL
            )
            for title, role in ((held, "validation"), ("Training runs", "training"))
        ),
        _test_section(fit.baselines),
        Section(
            "Notes on the estimators",
            points=tuple(f"{note}." for r in fit.baselines for note in _notes(r)),
            level=Level.DETAIL,
        ),
    ]
    return Section(
        _TITLE, "baselines", baseline_sentences(fit), table=_deviation_table(fit), parts=tuple(parts), is_folded=True
    )


def _picture(items: Sequence[Baseline]) -> Picture:
    axis = (
        "error, per cent of the known value" if items[0].error else "difference from the fit, per cent of its estimate"
    )
    caption = (
        "A dot for each coefficient; filled: within two standard errors of the fit, ring: farther off. The upright "
        "tick is the median, the name is that of the worst coefficient."
    )
    return Picture(lambda: svg(estimator_chart(_coefficient_errors(items), axis)), caption)


def _deviation_table(fit: Fit) -> TextTable:
    """How far each estimator is from the fit, or from the truth where it is known, or why it gave nothing."""
    first = fit.baselines[0]
    off = "errors" if first.error else "from this fit"
    return table_of(
        fit.baselines,
        words("", lambda r: r.name),
        number(f"{off}, median", lambda r: _share(r, first, _median_deviation), "%"),
        number("worst", lambda r: _share(r, first, _worst_deviation), "%"),
        words("", lambda r: _failure(r, len(fit.predictions))),
    )


def _share(r: Baseline, first: Baseline, part: Callable[[Baseline, Baseline], float]) -> str:
    is_known = r.relative_deviation(first) and (first.error or r is not first)
    return _percent(part(r, first)) if is_known else ""


def _failure(r: Baseline, runs: int) -> str:
    if r.note:
        return f"failed: {r.note}"
    return f"diverges in {len(r.diverged)} of {runs} runs, {r.diverged[0]} first" if r.diverged else ""


def _coefficients(fit: Fit) -> TextTable:
    """Each estimator's value of each coefficient, below it the distance from the fit in its standard errors."""
    free, first = [c for c in fit.coefficients if not c.fixed], fit.baselines[0]
    solved = [r for r in fit.baselines if r.values and (r is first or not r.is_fit)]

    def column(r: Baseline) -> Column[Coefficient]:
        return number(r.name, lambda c: _fit_cell(c) if r is first else _baseline_cell(r, c), is_wide=r is not first)

    return table_of(
        free,
        name("Coefficient", lambda c: c.name),
        words("unit", lambda c: unit_text(c.unit)),
        number("known", lambda c: exact(_display_value(c.truth, c), 4) if first.error else ""),
        *map(column, solved),
    )


def _distance_note(first: Baseline) -> str:
    return (
        "Below each value: its distance from the fit in the fit’s standard errors; near: up to 2, off: up to 10, far: "
        f"more. Per cent off: {'of the known values' if first.error else 'of the fit’s estimates'}."
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
        text.append(
            f"The fit has priors for {counted(held, 'coefficient')} and the regressions have none, so that "
            "differences show what the priors do as well."
        )
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


def _fit_cell(c: Coefficient) -> Cell:
    """The fit's own estimate with its standard error."""
    error = "" if c.standard_error is None else f"± {significant(_display_value(c.standard_error, c), 2)}"
    return Cell(significant(_display_value(c.estimate, c)), error)


def _baseline_cell(baseline: Baseline, c: Coefficient) -> Cell:
    value, gap = significant(_display_value(baseline.values[c.name], c)), baseline.normalised_difference.get(c.name)
    if gap is None:
        return Cell(value)
    where, tone = ("near", "") if abs(gap) <= NEAR else ("off", "warn") if abs(gap) <= OFF else ("far", "bad")
    return Cell(value, f"{where}: {'+' if gap > 0 else ''}{significant(gap, 2)}", tone)


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


def _runs(items: Sequence[Baseline], role: str) -> TextTable:
    """Errors and correlations of the runs of a role that each estimator simulates."""
    scored = [(r.name, _simulated_runs(r, role)) for r in items if r.values]
    channels = list(dict.fromkeys(c for _, scores in scored for c in scores.correlation))
    return table_of(
        [row for row in scored if row[1].rms or row[1].correlation],
        words("Estimator", lambda row: row[0]),
        *(number(title, partial(_rms, key, factor)) for key, (title, factor) in _COLUMNS.items()),
        *(number(f"CC of {channel}", partial(_correlation, channel)) for channel in channels),
    )


def _rms(key: str, factor: float, row: tuple[str, OpenLoopScores]) -> str:
    value = row[1].rms.get(key)
    return "" if value is None else significant(value * factor, 3)


def _correlation(channel: str, row: tuple[str, OpenLoopScores]) -> str:
    return fixed(row[1].correlation.get(channel), 3)


def _test_section(items: Sequence[Baseline]) -> Section:
    """Scores of the rows that pipelines keep for testing."""
    rows = [(r.name, equation, scores) for r in items for equation, scores in r.test.items()]
    table = table_of(
        rows,
        words("Estimator", lambda row: row[0]),
        words("equation", lambda row: row[1]),
        number("rows", lambda row: str(row[2].rows)),
        number("RMSE, SI", lambda row: significant(row[2].rmse, 3)),
        number("CC", lambda row: significant(row[2].correlation, 3)),
        number("explained", lambda row: significant(row[2].explained, 3)),
    )
    return Section("Rows kept for testing", table=table, note=_TEST_NOTE if table else "")


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
