"""Rows of the page's tables: values of a fit as text in display units."""

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from seatrial.core.equations import Model
from seatrial.core.equations.latex import LatexEquation, latex_symbol
from seatrial.core.equations.latex import latex_equations as latex_equations
from seatrial.core.results import Coefficient, Fit, Method, Noise, Offset
from seatrial.core.text.numbers import DASH, EstimateText, estimate_text, exact, p_value, significant
from seatrial.core.text.numbers import fixed as decimals
from seatrial.core.values import NOTATION, Finding, Severity, display_unit, quantity
from seatrial.core.values.notation import channel_letter, channel_meaning, unit_text
from seatrial.reporting.citations import Citations
from seatrial.reporting.mathml import inline, pieces

_SEVERITIES = (Severity.ERROR, Severity.WARNING, Severity.INFO)
# findings of a group that are shown unfolded
MAX_UNFOLDED = 3


@dataclass(frozen=True)
class FitCoefficientRow:
    """One free coefficient; `contains_truth` says whether the interval contains the known value."""

    symbol: Markup
    name: str
    meaning: str
    unit: str
    estimate: EstimateText
    prior: str
    truth: str
    contains_truth: bool | None


@dataclass(frozen=True)
class FindingGroup:
    """All findings of one code with the same advice: the first few in full, the others behind a fold."""

    severity: str
    code: str
    advice: str
    texts: tuple[str, ...]
    folded: tuple[str, ...]


@dataclass(frozen=True)
class EquationRow:
    """One line of the model: pieces of MathML between which it may break."""

    name: str
    pieces: tuple[Markup, ...]
    unit: str
    source: Markup


@dataclass(frozen=True)
class EquationList:
    """Rates, and the definitions they rest on, in order."""

    rates: tuple[EquationRow, ...]
    definitions: tuple[EquationRow, ...]


def coefficient_symbol(c: Coefficient) -> Markup:
    """Return the coefficient as MathML."""
    return Markup(inline(c.latex or latex_symbol(c.name)))


def _display_value(value: float | None, unit: str) -> float | None:
    return None if value is None else value * display_unit(unit)[0]


def coefficients(items: Sequence[Coefficient]) -> list[FitCoefficientRow]:
    """Return a row for each free coefficient."""
    return [_coefficient_row(c) for c in items if not c.fixed]


def _coefficient_row(c: Coefficient) -> FitCoefficientRow:
    value, error, lower, upper = (_display_value(x, c.unit) for x in (c.estimate, c.standard_error, c.lower, c.upper))
    holds = None
    if c.truth is not None and c.lower is not None and c.upper is not None:
        holds = c.lower <= c.truth <= c.upper
    return FitCoefficientRow(
        coefficient_symbol(c), c.name, c.meaning, unit_text(c.unit), estimate_text(value or 0.0, error, lower, upper),
        _prior_text(c), exact(_display_value(c.truth, c.unit)), holds,
    )  # fmt: skip


def _prior_text(c: Coefficient) -> str:
    if c.prior_mean is None or c.prior_standard_deviation is None:
        return DASH
    mean, spread = _display_value(c.prior_mean, c.unit), _display_value(c.prior_standard_deviation, c.unit)
    text = estimate_text(mean or 0.0, spread, None, None)
    return f"{text.value} ± {text.error}{text.power}"


def assumption(c: Coefficient) -> str:
    """Return what is assumed of a coefficient, its fixed value or its prior with the source; empty for nothing."""
    unit = unit_text(c.unit)
    if c.fixed:
        value = f"{c.name} = {exact(_display_value(c.estimate, c.unit))} {unit}".rstrip()
        return f"{value} (fixed{': ' + c.source if c.source else ''})"
    if c.prior_mean is None or c.prior_standard_deviation is None:
        return ""
    return f"{c.name} = {_prior_text(c)} {unit}".rstrip() + " (prior)"


def finding_groups(items: Sequence[Finding]) -> list[FindingGroup]:
    """Return findings grouped by code and advice, the most severe first."""
    groups: dict[tuple[int, str, str], list[Finding]] = {}
    for f in items:
        groups.setdefault((_SEVERITIES.index(f.severity), f.code, f.advice), []).append(f)
    return [
        FindingGroup(_SEVERITIES[rank].value, code, advice, tuple(f.text for f in group[:MAX_UNFOLDED]),
                     tuple(f.text for f in group[MAX_UNFOLDED:]))
        for (rank, code, advice), group in sorted(groups.items(), key=lambda pair: pair[0][0])
    ]  # fmt: skip


def equations(model: Model, citations: Citations) -> EquationList:
    """Return every equation of the model."""
    lines = latex_equations(model)
    rates = tuple(_equation_row(e, citations) for e in lines if e.is_rate)
    return EquationList(rates, tuple(_equation_row(e, citations) for e in lines if not e.is_rate))


def sign_conventions(model: Model) -> str:
    """Return the sentences on axes and positive directions in a model's equations, as the model declares its inputs."""
    heading = "; heading ψ clockwise from north" if "psi" in model.observables else ""
    sentences = [f"Axes: x forward, y to starboard, z down{heading}."]
    for item in model.inputs:
        letter, usual = channel_letter(item.name), quantity(item.name).positive if item.name in NOTATION else ""
        words = "when it turns the craft to " if item.name == "delta" else ""
        if item.is_reversed:
            sentences.append(
                f"In these equations {letter} is positive {words}{item.direction}; records, plots and tables give it "
                f"positive to {usual}."
            )
        elif words:
            sentences.append(f"{channel_meaning(item.name).capitalize()} {letter} is positive {words}{usual}.")
    return " ".join(sentences)


def _equation_row(e: LatexEquation, citations: Citations) -> EquationRow:
    unit = "" if e.is_rate or e.unit == "1" else e.unit.replace("^2", "²").replace("^3", "³")
    return EquationRow(e.name, tuple(Markup(p) for p in pieces(e.latex)), unit, citations.mark(e.source))


def records(fit: Fit) -> list[dict[str, str]]:
    """Return every record: role, duration, samples, rate, channels, where it comes from."""
    held = {p.record for p in fit.validation}
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
    """Return the noise of each channel."""
    return [
        {
            "channel": n.channel,
            "meaning": channel_meaning(n.channel),
            "unit": unit_text(n.unit),
            "deviation": significant(_display_value(n.standard_deviation, n.unit), 3),
            "time": significant(n.correlation_time, 2),
            "p": p_value(n.whiteness_p).removeprefix("p ").removeprefix("= "),
            "verdict": "white" if n.is_white else "not white",
        }
        for n in items
    ]


def offsets(items: Sequence[Offset]) -> dict[str, object]:
    """Return groups as rows and offsets as columns: `header` of name and unit, `rows` of group and texts."""
    names = list(dict.fromkeys((o.name, o.unit) for o in items))
    cells = {(o.group, o.name): _offset_text(o) for o in items}
    groups = list(dict.fromkeys(o.group for o in items))
    return {
        "header": [(name, unit_text(unit)) for name, unit in names],
        "rows": [(g, [cells.get((g, name), ("", "")) for name, _ in names]) for g in groups],
    }


def _offset_text(o: Offset) -> tuple[str, str]:
    value, error = _display_value(o.estimate, o.unit), _display_value(o.standard_error, o.unit)
    text = estimate_text(value or 0.0, error, None, None)
    return text.value + text.power, text.error


def fixed_parameters(items: Sequence[Coefficient], citations: Citations) -> list[dict[str, object]]:
    """Return the fixed parameters grouped by source."""
    rows = [(c.source, (coefficient_symbol(c), c.name, exact(_display_value(c.estimate, c.unit)), unit_text(c.unit),
                        c.meaning)) for c in items if c.fixed]  # fmt: skip
    return _by_source(rows, citations)


def _by_source(rows: Sequence[tuple[str, object]], citations: Citations) -> list[dict[str, object]]:
    groups: dict[str, list[object]] = {}
    for source, row in rows:
        groups.setdefault(source, []).append(row)
    return [{"source": citations.mark(source or "no source given"), "rows": group} for source, group in groups.items()]


def priors(items: Sequence[Coefficient], model: Model, citations: Citations) -> list[dict[str, object]]:
    """Return free coefficients with a prior, grouped by its source: prior, estimate, remaining share of spread [%]."""
    rows: list[tuple[str, object]] = []
    for c in items:
        if c.fixed or c.prior_mean is None or not c.prior_standard_deviation:
            continue
        prior = model.parameters[c.name].prior if c.name in model.parameters else None
        left = None if c.standard_error is None else 100.0 * c.standard_error / c.prior_standard_deviation
        rows.append(((prior.source if prior else "") or c.source, {
            "symbol": coefficient_symbol(c), "name": c.name, "unit": unit_text(c.unit), "prior": _prior_text(c),
            "estimate": _coefficient_row(c).estimate, "spread_percent": significant(left, 2),
        }))  # fmt: skip
    return _by_source(rows, citations)


def settings(method: Method) -> list[tuple[str, str]]:
    """Return settings as text."""
    return [(name, value if isinstance(value, str) else exact(value)) for name, value in method.settings.items()]
