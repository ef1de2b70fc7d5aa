"""Chapters on the coefficients: estimates with intervals, how they are correlated, what was fixed or assumed."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from markupsafe import Markup

from seatrial.core.equations import Model
from seatrial.core.equations.latex import latex_symbol
from seatrial.core.figures.panels import heat_map
from seatrial.core.figures.run import NARROW
from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Coefficient, Fit
from seatrial.core.results.fit_charts import coefficients_chart
from seatrial.core.text.numbers import DASH, EstimateText, estimate_text, exact, significant
from seatrial.core.values import display_unit
from seatrial.core.values.arrays import correlation_matrix
from seatrial.core.values.notation import unit_text
from seatrial.reporting.citations import Citations
from seatrial.reporting.correlations import correlation_text
from seatrial.reporting.mathml import inline
from seatrial.reporting.section import Cell, Level, Picture, Section, formula, name, number, table_of, words

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
