"""The coefficients' chapter: values with intervals, correlations, and what may be used by itself."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from types import MappingProxyType

import numpy as np
from markupsafe import Markup

from seatrial.core.equations import Model
from seatrial.core.equations.latex import latex_symbol
from seatrial.core.figures.panels import heat_map
from seatrial.core.figures.run import NARROW
from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Coefficient, Fit, Identifiability
from seatrial.core.results.coefficients import STORED_LEVEL, two_sided_quantile
from seatrial.core.results.fit_charts import coefficients_chart
from seatrial.core.text.numbers import DASH, EstimateText, estimate_text, exact, fixed, signed_percent, significant
from seatrial.core.text.words import counted, enumeration
from seatrial.core.values import NOT_MEASURED, Array, display_unit
from seatrial.core.values.arrays import correlation_matrix
from seatrial.core.values.notation import unit_text
from seatrial.reporting.mathml import inline
from seatrial.reporting.model_chapter import Citations
from seatrial.reporting.section import Cell, Level, Picture, Section, formula, name, number, table_of, words

# What the correlations of the estimates mean, in words.

# variance inflation from which on coefficients are collinear (Marquardt 1970)
MIN_VARIANCE_INFLATION = 10.0
# size from which on a correlation is strong: it alone inflates variances as collinear coefficients have them, and how
# many of these are named
STRONG_CORRELATION, MAX_PAIRS = math.sqrt(1.0 - 1.0 / MIN_VARIANCE_INFLATION), 4


@dataclass(frozen=True)
class Partner:
    """The coefficient with which another one is most correlated."""

    name: str
    correlation: float


def correlation_text(names: Sequence[str], covariance: Array, degrees_of_freedom: float = math.inf) -> str:
    """Return which coefficients the records hardly distinguish; empty for fewer than two.

    Args:
        degrees_of_freedom: of the covariance; finite where it comes from that many runs left out, less one. Strong is
            then only what chance does not give in any of the pairs.
    """
    if len(names) < 2 or covariance.shape != (len(names), len(names)):
        return ""
    below = np.nan_to_num(np.tril(correlation_matrix(covariance), k=-1))
    pairs = [(int(k // len(names)), int(k % len(names))) for k in np.argsort(-np.abs(below), axis=None)[:MAX_PAIRS]]
    least = max(STRONG_CORRELATION, _largest_by_chance(len(names), degrees_of_freedom))
    strong = [pair for pair in pairs if abs(below[pair]) >= least]
    if not strong:
        i, j = pairs[0]
        if i == j:
            return "None is correlated with another."
        chance = (
            f"; with {degrees_of_freedom + 1:g} runs or segments left out that may be chance"
            if least > STRONG_CORRELATION
            else ""
        )
        return f"The strongest is {fixed(below[i, j], 2)}, between {names[i]} and {names[j]}{chance}."
    count = int(np.sum(np.abs(below) >= least))
    strongest = enumeration([f"{names[i]} and {names[j]} ({fixed(below[i, j], 2)})" for i, j in strong])
    return (
        f"{counted(count, 'pair').capitalize()} at {fixed(least, 2)} or above in size; the strongest: {strongest}. "
        "Their errors depend on one another: use them with their covariance."
    )


def strong_partners(
    names: Sequence[str], covariance: Array, degrees_of_freedom: float = math.inf
) -> dict[str, Partner]:
    """Return the coefficients that are strongly correlated with another -> that one and the correlation.

    Arguments, and what counts as strong, as in `correlation_text`.
    """
    if len(names) < 2 or covariance.shape != (len(names), len(names)):
        return {}
    matrix = np.nan_to_num(correlation_matrix(covariance)) * (1.0 - np.eye(len(names)))
    least = max(STRONG_CORRELATION, _largest_by_chance(len(names), degrees_of_freedom))
    places = ((name, int(np.argmax(np.abs(row))), row) for name, row in zip(names, matrix, strict=True))
    return {name: Partner(names[k], float(row[k])) for name, k, row in places if abs(row[k]) >= least}


def _largest_by_chance(count: int, degrees_of_freedom: float) -> float:
    """Size below which 95 of 100 sets of so many unrelated estimates have all their correlations.

    r = t / sqrt(t^2 + n - 2) (Fisher 1915, Biometrika 10, 507), n runs, the level shared among the pairs (Bonferroni).
    """
    if not 1.0 < degrees_of_freedom < math.inf:
        return 1.0 if degrees_of_freedom <= 1.0 else 0.0
    pairs = count * (count - 1) // 2
    t = two_sided_quantile(1.0 - (1.0 - STORED_LEVEL) / pairs, degrees_of_freedom - 1.0)
    return t / math.sqrt(t**2 + degrees_of_freedom - 1.0)


# What each free coefficient can be used for, one row each, and three lines on what that means; nothing is computed.

# share of its prior's standard deviation from which on the records say next to nothing of a coefficient; chosen
PRIOR_SHARE = 0.9
# relative standard error from which on a value is known vaguely only, as of combinations in the same chapter; chosen
WELL_DETERMINED = 0.1
# names that a line holds, chosen
MAX_NAMES = 8


class Use(StrEnum):
    """What a coefficient can be used for, the most first."""

    BY_ITSELF = "by itself"
    VAGUELY = "by itself, vaguely"
    AS_A_SET = "with others only"
    FROM_PRIOR = "from its prior"
    SIGN_OPEN = "sign open"
    NO_INTERVAL = "no interval"


@dataclass(frozen=True)
class CoefficientUse:
    """A free coefficient: how well it is known, how much it does, what it depends on, and what it can be used for."""

    name: str
    half_width: str
    effect: str
    variance_inflation: str
    partner: str
    use: Use


def coefficient_uses(
    coefficients: Sequence[Coefficient],
    content: Identifiability,
    strong: Mapping[str, Partner] = MappingProxyType({}),
) -> tuple[CoefficientUse, ...]:
    """Return a row for each free coefficient: those that can be used by themselves first, the widest interval last.

    strong: coefficients whose errors are strongly correlated in the intervals' covariance, as `strong_partners` has it.
    """
    collinear = {c.parameter: c for c in content.collinearity}
    effects = {s.parameter: s.effect for s in content.sensitivities}
    rows = []
    for c in (c for c in coefficients if not c.fixed):
        tied, spread = collinear.get(c.name), relative_half_width(c)
        inflation = tied.variance_inflation if tied else math.nan
        use = _use(c, inflation, is_paired=c.name in strong)
        partner = strong.get(c.name) or (Partner(tied.partner, tied.correlation) if tied and tied.partner else None)
        row = CoefficientUse(
            c.name, f"± {significant(100.0 * spread, 2)}" if math.isfinite(spread) else DASH,
            significant(effects.get(c.name), 2), "∞" if math.isinf(inflation) else significant(inflation, 2),
            f"{partner.name} {fixed(partner.correlation, 2)}" if partner else "", use,
        )  # fmt: skip
        rows.append((list(Use).index(use), spread if math.isfinite(spread) else math.inf, row))
    return tuple(row for *_, row in sorted(rows, key=lambda one: one[:2]))


def _use(c: Coefficient, inflation: float, *, is_paired: bool) -> Use:
    if c.lower is None or c.upper is None:
        return Use.NO_INTERVAL
    if c.is_sign_open:
        return Use.SIGN_OPEN
    if c.prior_standard_deviation and (c.standard_error or 0.0) >= PRIOR_SHARE * c.prior_standard_deviation:
        return Use.FROM_PRIOR
    if c.is_level or (c.standard_error or 0.0) < WELL_DETERMINED * abs(c.estimate):
        return Use.BY_ITSELF
    return Use.AS_A_SET if is_paired or inflation >= MIN_VARIANCE_INFLATION else Use.VAGUELY


def relative_half_width(c: Coefficient) -> float:
    """Return half the 95 % interval over the estimate; NaN where there is none, and of an angle or level about 0."""
    if c.lower is None or c.upper is None or c.estimate == 0.0 or c.is_level:
        return math.nan
    return 0.5 * (c.upper - c.lower) / abs(c.estimate)


def meaning_sentences(fit: Fit, content: Identifiability, uses: Sequence[CoefficientUse]) -> tuple[str, ...]:
    """Return what the identifiability means for predictions, for single values, and for what was assumed."""
    predictions = (
        "Predictions of manoeuvres like those recorded rest on combinations that are determined; others may not."
    )
    return tuple(text for text in (predictions, _single_values(uses), _assumptions(fit, content)) if text)


def _single_values(uses: Sequence[CoefficientUse]) -> str:
    names = {use: [row.name for row in uses if row.use is use] for use in Use}
    sentences = {
        Use.BY_ITSELF: "{} {are} known, with standard errors below 10 %.",
        Use.VAGUELY: "{} {are} known vaguely, with standard errors above 10 %.",
        Use.AS_A_SET: "{} {are} known together only: their errors depend on one another.",
        Use.FROM_PRIOR: "{} {are} as good as the prior: the records add next to nothing.",
        Use.SIGN_OPEN: "{} {have} an open sign.",
        Use.NO_INTERVAL: "{} {have} no interval.",
    }
    return " ".join(
        words.format(enumeration(names[use], MAX_NAMES), are="are" if len(names[use]) > 1 else "is",
                     have="have" if len(names[use]) > 1 else "has")
        for use, words in sentences.items() if names[use]
    )  # fmt: skip


def _assumptions(fit: Fit, content: Identifiability) -> str:
    tied = {name for symmetry in content.structural for name in symmetry.parameters}
    held = [c.name for c in fit.coefficients if c.fixed and c.name in tied]
    guessed = [c.name for c in fit.coefficients if c.is_unmeasured]
    sentences = []
    if held:
        sentences.append(f"No manoeuvre identifies {enumeration(held, MAX_NAMES)} apart from the others.")
    if guessed:
        are = "are" if len(guessed) > 1 else "is"
        sentences.append(f"{enumeration(guessed, MAX_NAMES)} {are} {NOT_MEASURED}.")
    is_open = {c.name for c in fit.coefficients if c.is_sign_open}
    moves = [(abs(x), c, n, x) for c in content.consequences for n, x in c.estimate_changes.items() if n not in is_open]
    if moves:
        _, worst, name, change = max(moves, key=lambda move: move[0])
        sentences.append(f"Changing {worst.parameter} by {signed_percent(worst.change)} would change {name} by "
                         f"{signed_percent(change)}.")  # fmt: skip
    return " ".join(sentences)


# Chapters on the coefficients: estimates with intervals, how they are correlated, what was fixed or assumed.

_PER_MASS = (
    "Forces and masses are those on each kg of m + m_x, as no thrust is known in newtons. To estimate them, state "
    "bollard, the thrust of a thruster at full command, and ship.m."
)
_PRIOR_NOTE = (
    "Near 100 % the records say little and the prior decides; near 0 % the records decide. Beyond 100 % runs, or "
    "models of the disturbance, contradict one another by more than the prior allows."
)


@dataclass(frozen=True)
class _Free:
    """A free coefficient with its numbers as text."""

    coefficient: Coefficient
    text: EstimateText

    @classmethod
    def from_coefficient(cls, c: Coefficient) -> "_Free":
        value, error, lower, upper = (
            _display_value(x, c.unit) for x in (c.estimate, c.standard_error, c.lower, c.upper)
        )
        return cls(c, estimate_text(value or 0.0, error, lower, upper))

    def number(self, part: str) -> str:
        """One of its numbers with the power of ten that all have in common."""
        return f"{part}{self.text.power}" if part not in ("", DASH) else ""


def coefficient_section(fit: Fit) -> Section:
    """Return the chapter on the free coefficients."""
    is_per_mass = fit.thruster_craft is not None and fit.thruster_craft.force_unit == "N/kg"
    about = "those of the package’s own estimate stand with it" if fit.reference else fit.method.intervals
    return Section(
        "Coefficients, 95 % intervals",
        "coefficients",
        sentences=(_PER_MASS,) if is_per_mass else (),
        table=table_of(
            [_Free.from_coefficient(c) for c in fit.coefficients if not c.fixed],
            formula("", lambda one: coefficient_symbol(one.coefficient)),
            name("", lambda one: one.coefficient.name),
            number("estimate", lambda one: one.number(one.text.value)),
            number("std. error", lambda one: one.number(one.text.error), level=Level.DETAIL, is_wide=True),
            number("95 % from", lambda one: one.number(one.text.lower)),
            number("to", lambda one: one.number(one.text.upper)),
            words("unit", lambda one: unit_text(one.coefficient.unit)),
            number("known", lambda one: _known_value(one.coefficient)),
            words("", lambda one: _mark(one.coefficient)),
            number("prior, mean ± s.d.", lambda one: _prior_text(one.coefficient), level=Level.DETAIL),
            words("meaning", lambda one: one.coefficient.meaning, is_wide=True),
        ),
        note=f"Intervals: {about}. An angle stands in degrees; other coefficients are per radian.",
        pictures=(_forest(fit),),
    )


def _forest(fit: Fit) -> Picture:
    return Picture(
        lambda: svg(coefficients_chart(fit.coefficients)),
        "Free coefficients with their 95 % intervals, relative to the estimate. Arrows: the interval goes on.",
        lambda: svg(coefficients_chart(fit.coefficients, NARROW)),
    )


def coefficient_symbol(c: Coefficient) -> Markup:
    """Return the coefficient as MathML."""
    return Markup(inline(c.latex or latex_symbol(c.name)))


def _display_value(value: float | None, unit: str) -> float | None:
    return None if value is None else value * display_unit(unit)[0]


def _known_value(c: Coefficient) -> str:
    return "" if c.truth is None else exact(_display_value(c.truth, c.unit))


def _mark(c: Coefficient) -> Cell:
    """Where a known value lies, else whether the interval leaves the sign open."""
    if c.lower is None or c.upper is None:
        return Cell("no interval")
    if c.truth is not None:
        is_inside = c.lower <= c.truth <= c.upper
        return Cell("inside") if is_inside else Cell("OUTSIDE", tone="bad")
    return Cell("sign open", tone="warn") if c.is_sign_open else Cell()


def _prior_text(c: Coefficient) -> str:
    if c.prior_mean is None or c.prior_standard_deviation is None:
        return ""
    mean, spread = _display_value(c.prior_mean, c.unit), _display_value(c.prior_standard_deviation, c.unit)
    text = estimate_text(mean or 0.0, spread, None, None)
    return f"{text.value} ± {text.error}{text.power}"


def assumption(c: Coefficient) -> str:
    """Return what is assumed of a coefficient, its fixed value or its prior with the source; empty for nothing."""
    unit = unit_text(c.unit)
    if c.fixed:
        value = f"{c.name} = {exact(_display_value(c.estimate, c.unit))} {unit}".rstrip()
        return f"{value} (fixed{': ' + c.source if c.source else ''})"
    prior = _prior_text(c)
    return f"{c.name} = {prior} {unit}".rstrip() + " (prior)" if prior else ""


def correlation_section(fit: Fit, note: str = "") -> Section:
    """Return the part on how the errors of the coefficients are correlated; empty for fewer than two."""
    names = fit.model.parameters.free_names
    if len(names) < 2 or fit.covariance.shape != (len(names), len(names)):
        return Section("")
    basis = math.inf if fit.interval_basis is None else fit.interval_basis.degrees_of_freedom

    def draw() -> str:
        below = correlation_matrix(fit.covariance)[1:, :-1]
        return svg(heat_map("correlations of the free coefficients", names[1:], names[:-1], below, is_lower=True))

    caption = "Correlation of the errors of the free coefficients: red together, blue against one another."
    return Section(
        "Correlations between the estimates",
        sentences=(correlation_text(names, fit.covariance, basis),),
        note=note,
        pictures=(Picture(draw, caption),),
        level=Level.PAGE,
        is_folded=True,
    )


def assumed_section(fit: Fit, citations: Citations) -> Section:
    """Return the chapter on fixed values and priors, grouped by their sources."""
    return Section(
        "Fixed values and priors",
        "fixed",
        parts=(_priors(fit.coefficients, fit.model, citations), _fixed(fit.coefficients, citations)),
        level=Level.PAGE,
        is_folded=True,
    )


def _priors(items: Sequence[Coefficient], model: Model, citations: Citations) -> Section:
    """Free coefficients with a prior: prior, estimate, remaining share of its spread."""

    def source(c: Coefficient) -> str:
        prior = model.parameters[c.name].prior if c.name in model.parameters else None
        return (prior.source if prior else "") or c.source

    def share(c: Coefficient) -> str:
        if c.standard_error is None or not c.prior_standard_deviation:
            return ""
        return significant(100.0 * c.standard_error / c.prior_standard_deviation, 2)

    chosen = [c for c in items if not c.fixed and c.prior_mean is not None and c.prior_standard_deviation]
    table = table_of(
        _by_source(chosen, source),
        formula("", coefficient_symbol),
        name("Coefficient", lambda c: c.name),
        number("prior, mean ± s.d.", _prior_text),
        number("estimate", lambda c: (one := _Free.from_coefficient(c)).number(one.text.value)),
        words("unit", lambda c: unit_text(c.unit)),
        number("std. error, of the prior’s", share, "%"),
        group=lambda c: citations.mark(source(c) or "no source given"),
    )
    return Section("Priors", table=table, note=_PRIOR_NOTE if table else "")


def _fixed(items: Sequence[Coefficient], citations: Citations) -> Section:
    table = table_of(
        _by_source([c for c in items if c.fixed], lambda c: c.source),
        formula("", coefficient_symbol),
        name("Parameter", lambda c: c.name),
        number("value", lambda c: exact(_display_value(c.estimate, c.unit))),
        words("unit", lambda c: unit_text(c.unit)),
        words("meaning", lambda c: c.meaning),
        group=lambda c: citations.mark(c.source or "no source given"),
    )
    return Section("Fixed values", table=table)


def _by_source(items: Sequence[Coefficient], source: Callable[[Coefficient], str]) -> list[Coefficient]:
    """The coefficients, those of one source together, sources in the order in which they come first."""
    order = list(dict.fromkeys(map(source, items)))
    return sorted(items, key=lambda c: order.index(source(c)))
