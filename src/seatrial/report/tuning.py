"""The page of a tuned controller: recommendation, front, margins, simulation, schedule, the loop itself."""

import math
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from seatrial.equations.latex import symbol
from seatrial.report import told_tuning
from seatrial.report.figures import demanded, fronts, loop_diagram, margins, schedule_maps, voyages
from seatrial.report.figures.bars import bars
from seatrial.report.mathml import inline
from seatrial.report.numbers import DASH, exact, fixed, significant
from seatrial.report.page import environment
from seatrial.report.sheets import Sheet
from seatrial.report.tables import findings
from seatrial.report.words import channel
from seatrial.results import Bars
from seatrial.results.tuning import Bound, Component, Controller, Slot, Tuning
from seatrial.trial.orders import shown_unit

TITLES = {
    "answer": "Recommendation",
    "findings": "Findings",
    "controllers": "Controllers compared",
    "front": "Front",
    "margins": "Margins",
    "sailed": "Simulation with limits and stall",
    "manoeuvres": "Demands followed",
    "schedule": "Schedule",
    "bounds": "What no linear controller does better",
    "loop": "The loop",
    "method": "How it was made",
}
FOLDED = 40


@dataclass(frozen=True)
class ControllerRow:
    """One controller as text: cells in the order of the heads."""

    name: str
    is_chosen: bool
    gains: tuple[str, ...]
    objectives: tuple[str, ...]
    rms: tuple[str, ...]
    reduction: str
    margins: tuple[str, ...]
    shares: tuple[str, ...]
    broken: tuple[str, ...]


def html(tuning: Tuning) -> str:
    """The page as text; sections without content are left out."""
    drawn = fronts.fronts(tuning)
    shown = {
        "findings": bool(tuning.findings), "front": bool(drawn), "margins": len(margins.styled(tuning)) > 0,
        "sailed": bool(tuning.sailed), "manoeuvres": bool(tuning.manoeuvres), "schedule": bool(tuning.schedule),
        "bounds": bool(tuning.bounds), "loop": bool(tuning.components),
    }  # fmt: skip
    context: dict[str, object] = {
        "tuning": tuning,
        "titles": {key: title for key, title in TITLES.items() if shown.get(key, True)},
        "answer": told_tuning.sentences(tuning),
        "facts": told_tuning.facts(tuning),
        "settings": told_tuning.settings(tuning),
        "gains": [(gain_symbol(name), exact(value, 5)) for name, value in tuning.chosen.gains.items()],
        "findings": findings(tuning.findings),
        "output": channel(tuning.output),
        "actuator": channel(tuning.actuator),
        "gain_names": [(name, gain_symbol(name)) for name in _gain_names(tuning)],
        "objectives": [(name, fronts.people_s(unit)[1]) for name, unit in _objectives(tuning)],
        "rms_heads": _rms_heads(tuning),
        "has_reduction": any(math.isfinite(c.reduction) for c in (tuning.chosen, *tuning.rivals)),
        "controllers": [_row(c, tuning) for c in (tuning.chosen, *tuning.rivals)],
        "front": Markup(drawn),
        "sensitivities": Markup(margins.sensitivities(tuning)),
        "nyquist": Markup(margins.nyquist(tuning)),
        "reductions": Markup(_reductions(tuning)),
        "differences": Markup(voyages.differences(tuning.paired)),
        "histories": Markup(voyages.histories(tuning)),
        "seeds": voyages.seeds_of(tuning.sailed),
        "manoeuvres": [(m, Markup(demanded.manoeuvre(m, tuning)), told_tuning.followed(m)) for m in tuning.manoeuvres],
        "maps": Markup(schedule_maps.schedule_maps(tuning.schedule)),
        "schedule": schedule_sheet(tuning.schedule),
        "is_folded": len(tuning.schedule) > FOLDED,
        "bounds": [_bound(b) for b in tuning.bounds],
        "diagram": Markup(loop_diagram.diagram(tuning.components, tuning.output, tuning.actuator)),
        "components": [_component(c, tuning.chosen.gains) for c in loop_diagram.in_order(tuning.components)],
    }
    return environment().get_template("tuning.html").render(context)


def gain_symbol(name: str) -> Markup:
    """``KP`` and ``K_P`` as K with its index."""
    spaced = f"K_{name[1:]}" if len(name) > 1 and name[0] == "K" and name[1:].isupper() else name
    return Markup(inline(symbol(spaced)))


def transfer_latex(num: tuple[float, ...], den: tuple[float, ...]) -> str:
    """num(s) / den(s) as LaTeX; the denominator 1 is left out."""
    above, below = _polynomial(num), _polynomial(den)
    return above if below == "1" else f"\\frac{{{above}}}{{{below}}}"


def schedule_sheet(slots: tuple[Slot, ...]) -> Sheet:
    """The schedule's gains as a table, a line for each condition."""
    first = slots[0] if slots else None
    gains, others = (list(first.gains), list(first.others)) if first else ([], [])
    header = ("speed m/s", "heading deg", "height m", *gains, "cost", *others, "Ms", "saturation %",
              "")  # fmt: skip
    rows = [
        (exact(s.U, 4), exact(math.degrees(s.beta), 4), exact(s.height, 3),
         *(exact(s.gains.get(name, math.nan), 4) for name in gains), fixed(s.cost, 3),
         *(_cost(s.others.get(name, math.nan)) for name in others), fixed(s.peak, 2), fixed(100.0 * s.saturation, 1),
         "" if s.is_feasible else "not kept")
        for s in slots
    ]  # fmt: skip
    return Sheet("Gains of the schedule", header, tuple([True] * (len(header) - 1) + [False]), tuple(rows), "")


def _cost(value: float) -> str:
    return "unstable" if math.isinf(value) else fixed(value, 3)


def _polynomial(coefficients: tuple[float, ...]) -> str:
    """``1.432 s^{2} + 0.3796 s + 1``."""
    parts = []
    for k, c in enumerate(coefficients):
        power = len(coefficients) - 1 - k
        if c == 0.0 and len(coefficients) > 1:
            continue
        variable = "" if power == 0 else "s" if power == 1 else f"s^{{{power}}}"
        number = "" if abs(c) == 1.0 and variable else _number(abs(c))
        sign = (" - " if c < 0.0 else " + ") if parts else ("-" if c < 0.0 else "")
        parts.append(sign + f"{number} {variable}".strip())
    return "".join(parts).strip() or "0"


def _number(value: float) -> str:
    """Up to five digits, without thin spaces; powers of ten in LaTeX."""
    if value and not 1e-3 <= value < 1e5:
        mantissa, _, power = f"{value:.4e}".partition("e")
        return f"{mantissa.rstrip('0').rstrip('.')} \\cdot 10^{{{int(power)}}}"
    return f"{value:.5g}"


def _gain_names(tuning: Tuning) -> list[str]:
    return list(dict.fromkeys(name for c in (tuning.chosen, *tuning.rivals) for name in c.gains))


def _objectives(tuning: Tuning) -> list[tuple[str, str]]:
    return list(zip(tuning.objectives, tuning.units, strict=True))


def _rms_heads(tuning: Tuning) -> list[tuple[str, str]]:
    names = (("output", tuning.output, ""), ("actuator", tuning.actuator, ""),
             ("actuator_rate", tuning.actuator, "/s"))  # fmt: skip
    words = {"output": channel(tuning.output), "actuator": channel(tuning.actuator), "actuator_rate": "its rate"}
    return [(words[key], told_tuning.unit_of(name, per)) for key, name, per in names]


def _row(c: Controller, tuning: Tuning) -> ControllerRow:
    factors = [fronts.people_s(unit)[0] for unit in tuning.units]
    of_output, of_actuator = shown_unit(tuning.output)[0], shown_unit(tuning.actuator)[0]
    rms = [c.rms.get(key, math.nan) * factor for key, factor in
           (("output", of_output), ("actuator", of_actuator), ("actuator_rate", of_actuator))]  # fmt: skip
    has_limits = [math.isfinite(limit) for limit in (tuning.restriction.limit, tuning.restriction.rate)]
    return ControllerRow(
        c.name,
        c is tuning.chosen,
        tuple(exact(c.gains[name], 4) if name in c.gains else DASH for name in _gain_names(tuning)),
        tuple(significant(float(v) * f) for v, f in zip(c.objectives, factors, strict=False)),
        tuple(significant(v, 3) for v in rms),
        fixed(100.0 * c.reduction, 1),
        (_ratio(c.peak, 2), _ratio(c.gain_margin, 1), _ratio(math.degrees(c.phase_margin), 0),
         "∞" if math.isinf(c.delay_margin) else significant(c.delay_margin, 2), fixed(c.damping, 2)),
        tuple(fixed(100.0 * share, 1) if known else DASH for share, known in
              zip((c.saturation, c.rate_saturation), has_limits, strict=True)),
        c.broken,
    )  # fmt: skip


def _ratio(value: float, decimals: int) -> str:
    return "∞" if math.isinf(value) else fixed(value, decimals)


def _reductions(tuning: Tuning) -> str:
    """Bars of mean reductions: a group for each controller, a bar for each stage of what an actuator cannot do."""
    if not tuning.sailed:
        return ""
    stages = {
        "linear": [s.linear for s in tuning.sailed],
        "with angle and rate limits": [s.limited for s in tuning.sailed],
        "with stall, too": [s.stalled for s in tuning.sailed],
    }
    series = {name: tuple(100.0 * float(np.mean(row)) for row in rows) for name, rows in stages.items()}
    return bars(Bars("Reductions", tuple(s.name for s in tuning.sailed), series, "reduction of rms [%]", ""))


def _bound(b: Bound) -> tuple[str, str, str, str, str]:
    """Name, variance ratio, rms ratio, what is held equal, note."""
    rms = fixed(math.sqrt(b.ratio), 2) if b.ratio >= 0.0 else DASH
    return b.name, fixed(b.ratio, 2), rms, b.at, b.note


def _component(c: Component, gains: dict[str, float]) -> tuple[str | Markup, ...]:
    """Role, name, transfer function, gain and its value, source."""
    value = exact(gains[c.gain], 5) if c.gain in gains else ""
    letter = gain_symbol(c.gain) if c.gain else ""
    return c.role, c.name, Markup(inline(transfer_latex(c.num, c.den))), letter, value, c.source
