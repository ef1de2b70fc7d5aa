"""Rows of the page's tables: values of a fit as text in the units people read."""

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from seatrial.core.equations import Model
from seatrial.core.equations.latex import Equation, symbol
from seatrial.core.equations.latex import equations as latex_equations
from seatrial.core.results import Coefficient, Fit, Method, Noise, Offset
from seatrial.core.text import words
from seatrial.core.text.numbers import DASH, Estimate, estimate, exact, significant
from seatrial.core.text.numbers import fixed as decimals
from seatrial.core.values import Finding, Severity, display
from seatrial.reporting.citations import Citations
from seatrial.reporting.mathml import inline, pieces

_SEVERITIES = (Severity.ERROR, Severity.WARNING, Severity.INFO)
EXAMPLES = 3


@dataclass(frozen=True)
class CoefficientRow:
    """One free coefficient; `holds` says whether the interval contains the known value."""

    symbol: Markup
    name: str
    meaning: str
    unit: str
    estimate: Estimate
    prior: str
    truth: str
    holds: bool | None


@dataclass(frozen=True)
class FindingGroup:
    """All findings of one code with the same advice: the first few in full, the others behind a fold."""

    severity: str
    code: str
    advice: str
    shown: tuple[str, ...]
    folded: tuple[str, ...]


@dataclass(frozen=True)
class EquationRow:
    """One line of the model: pieces of MathML between which it may break."""

    name: str
    pieces: tuple[Markup, ...]
    unit: str
    source: Markup


@dataclass(frozen=True)
class Equations:
    """Rates, and the definitions they rest on, in order."""

    rates: tuple[EquationRow, ...]
    definitions: tuple[EquationRow, ...]


def symbol_of(c: Coefficient) -> Markup:
    """The coefficient as MathML."""
    return Markup(inline(c.latex or symbol(c.name)))


def _shown(value: float | None, unit: str) -> float | None:
    return None if value is None else value * display(unit)[0]


def coefficients(items: Sequence[Coefficient]) -> list[CoefficientRow]:
    """The free coefficients."""
    return [_coefficient(c) for c in items if not c.fixed]


def _coefficient(c: Coefficient) -> CoefficientRow:
    value, error, lower, upper = (_shown(x, c.unit) for x in (c.estimate, c.standard_error, c.lower, c.upper))
    holds = None
    if c.truth is not None and c.lower is not None and c.upper is not None:
        holds = c.lower <= c.truth <= c.upper
    return CoefficientRow(
        symbol_of(c), c.name, c.meaning, words.unit(c.unit), estimate(value or 0.0, error, lower, upper),
        _prior(c), exact(_shown(c.truth, c.unit)), holds,
    )  # fmt: skip


def _prior(c: Coefficient) -> str:
    if c.prior_mean is None or c.prior_standard_deviation is None:
        return DASH
    mean, spread = _shown(c.prior_mean, c.unit), _shown(c.prior_standard_deviation, c.unit)
    text = estimate(mean or 0.0, spread, None, None)
    return f"{text.value} ± {text.error}{text.power}"


def assumption(c: Coefficient) -> str:
    """What is assumed of a coefficient: its fixed value or its prior, with the source; empty where nothing is."""
    unit = words.unit(c.unit)
    if c.fixed:
        value = f"{c.name} = {exact(_shown(c.estimate, c.unit))} {unit}".rstrip()
        return f"{value} (fixed{': ' + c.source if c.source else ''})"
    if c.prior_mean is None or c.prior_standard_deviation is None:
        return ""
    return f"{c.name} = {_prior(c)} {unit}".rstrip() + " (prior)"


def findings(items: Sequence[Finding]) -> list[FindingGroup]:
    """Grouped by code and advice, the serious first."""
    groups: dict[tuple[int, str, str], list[Finding]] = {}
    for f in items:
        groups.setdefault((_SEVERITIES.index(f.severity), f.code, f.advice), []).append(f)
    return [
        FindingGroup(_SEVERITIES[rank].value, code, advice, tuple(f.text for f in group[:EXAMPLES]),
                     tuple(f.text for f in group[EXAMPLES:]))
        for (rank, code, advice), group in sorted(groups.items(), key=lambda pair: pair[0][0])
    ]  # fmt: skip


def equations(model: Model, citations: Citations) -> Equations:
    """Every line of the model."""
    lines = latex_equations(model)
    rates = tuple(_equation(e, citations) for e in lines if e.is_rate)
    return Equations(rates, tuple(_equation(e, citations) for e in lines if not e.is_rate))


def _equation(e: Equation, citations: Citations) -> EquationRow:
    unit = _equation_unit(e.unit, is_rate=e.is_rate)
    return EquationRow(e.name, tuple(Markup(p) for p in pieces(e.latex)), unit, citations.marked(e.source))


def _equation_unit(unit: str, *, is_rate: bool) -> str:
    return "" if is_rate or unit == "1" else unit.replace("^2", "²").replace("^3", "³")


def records(fit: Fit) -> list[dict[str, str]]:
    """Every record: role, duration, samples, rate, channels, where it comes from."""
    held = {p.record for p in fit.validation()}
    return [
        {
            "name": r.name,
            "role": "held out" if r.name in held else "fitted",
            "duration": decimals(r.duration, 0),
            "samples": decimals(float(len(r)), 0),
            "rate": exact((len(r) - 1) / r.duration, 3) if r.duration > 0 else DASH,
            "channels": ", ".join(r.channels),
            "source": r.provenance.source.rsplit("/", 1)[-1],
            "sha256": r.provenance.sha256[:12],
            "steps": "; ".join(r.provenance.steps),
        }
        for r in fit.records
    ]


def noise(items: Sequence[Noise]) -> list[dict[str, str]]:
    """Noise of each channel."""
    return [
        {
            "channel": n.channel,
            "meaning": words.channel(n.channel),
            "unit": words.unit(n.unit),
            "deviation": significant(_shown(n.standard_deviation, n.unit), 3),
            "time": significant(n.correlation_time, 2),
            "p": "< 0.001" if n.whiteness_p < 0.001 else decimals(n.whiteness_p, 3),
            "verdict": "white" if n.whiteness_p >= 0.01 else "coloured",
        }
        for n in items
    ]


def offsets(items: Sequence[Offset]) -> dict[str, object]:
    """Groups as rows, offsets as columns: `header` of name and unit, `rows` of group and texts."""
    names = list(dict.fromkeys((o.name, o.unit) for o in items))
    cells = {(o.group, o.name): _offset(o) for o in items}
    groups = list(dict.fromkeys(o.group for o in items))
    return {
        "header": [(name, words.unit(unit)) for name, unit in names],
        "rows": [(g, [cells.get((g, name), ("", "")) for name, _ in names]) for g in groups],
    }


def _offset(o: Offset) -> tuple[str, str]:
    text = estimate(_shown(o.estimate, o.unit) or 0.0, _shown(o.standard_error, o.unit), None, None)
    return text.value + text.power, text.error


def fixed(items: Sequence[Coefficient], citations: Citations) -> list[dict[str, object]]:
    """The fixed parameters grouped by source."""
    groups: dict[str, list[Coefficient]] = {}
    for c in items:
        if c.fixed:
            groups.setdefault(c.source, []).append(c)
    return [
        {
            "source": citations.marked(source or "no source given"),
            "rows": [(symbol_of(c), c.name, exact(_shown(c.estimate, c.unit)), words.unit(c.unit), c.meaning)
                     for c in group],
        }
        for source, group in groups.items()
    ]  # fmt: skip


def priors(items: Sequence[Coefficient], model: Model, citations: Citations) -> list[dict[str, object]]:
    """Free coefficients with a prior: prior, estimate, its source and how much of its spread is left."""
    made = []
    for c in items:
        if c.fixed or c.prior_mean is None or not c.prior_standard_deviation:
            continue
        known = model.parameters[c.name].prior if c.name in model.parameters else None
        left = None if c.standard_error is None else 100.0 * c.standard_error / c.prior_standard_deviation
        made.append({
            "symbol": symbol_of(c), "name": c.name, "unit": words.unit(c.unit), "prior": _prior(c),
            "estimate": _coefficient(c).estimate, "left": significant(left, 2),
            "source": citations.marked((known.source if known else "") or c.source),
        })  # fmt: skip
    return made


def settings(method: Method) -> list[tuple[str, str]]:
    """Settings as text."""
    return [(name, value if isinstance(value, str) else exact(value)) for name, value in method.settings.items()]
