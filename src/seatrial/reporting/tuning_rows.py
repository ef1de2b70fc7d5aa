"""Rows of a tuning's page: controllers, schedule, bounds, blocks, as text."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from markupsafe import Markup

from seatrial.core.equations.latex import latex_symbol
from seatrial.core.results.front_chart import degree_unit
from seatrial.core.results.tuning import (
    Component,
    Controller,
    DiscreteBlock,
    DisturbanceSimulation,
    OperatingPoint,
    PerformanceBound,
    Tuning,
)
from seatrial.core.text.numbers import DASH, exact, fixed, significant
from seatrial.core.values.notation import channel_meaning
from seatrial.data.folder.gains_file import channel_display_unit
from seatrial.reporting import tuning_text
from seatrial.reporting.mathml import inline
from seatrial.reporting.text_tables import TextTable

_HALF = 1.96  # standard errors of half a 95 % interval
# share of the largest gain of a name below which a gain is rounding
ZERO_TOLERANCE = 1e-9


@dataclass(frozen=True)
class ControllerRow:
    """One controller as text: cells in the order of the heads."""

    name: str
    gains: tuple[str, ...]
    objectives: tuple[str, ...]
    rms: tuple[str, ...]
    reduction: str
    margins: tuple[str, ...]
    work: tuple[str, ...]
    saturation_shares: tuple[str, ...]
    violated: tuple[str, ...]


def gain_symbol(name: str) -> Markup:
    """Return ``KP`` and ``K_P`` as K with its index."""
    spaced = f"K_{name[1:]}" if len(name) > 1 and name[0] == "K" and name[1:].isupper() else name
    return Markup(inline(latex_symbol(spaced)))


def gain_unit(tuning: Tuning, name: str) -> str:
    """Return the unit of a gain; nothing where it has none."""
    unit = tuning.gain_units.get(name, "1")
    return "" if unit == "1" else unit


def discrete_rows(tuning: Tuning) -> list[tuple[str, str, Markup]]:
    """Return role, name and difference equation of every block of the controller on board."""
    if tuning.discrete is None:
        return []
    return [(b.role, b.name, Markup(inline(_difference_latex(b)))) for b in tuning.discrete.blocks]


def _difference_latex(block: DiscreteBlock) -> str:
    """``y_k = 0.2 x_k + 0.2 x_{k-1} + 0.6 y_{k-1}``."""
    parts = [(c, "x", i) for i, c in enumerate(block.b)] + [(-c, "y", i) for i, c in enumerate(block.a) if i]
    text = ""
    for c, symbol, i in parts:
        if c:
            index = "k" if i == 0 else f"{{k-{i}}}"
            text += (" - " if c < 0.0 else " + " if text else "") + f"{_latex_number(abs(c))} {symbol}_{index}"
    return f"y_k = {text or '0'}"


def gain_names(tuning: Tuning) -> list[str]:
    """Return the names of all gains, in order, each once."""
    return list(dict.fromkeys(name for c in tuning.compared for name in c.gains))


def gain_texts(rows: Sequence[Mapping[str, float]], names: Sequence[str]) -> list[tuple[str, ...]]:
    """Return gains of several controllers as text; 0 where rounding left a tiny share of the largest of that name."""
    sizes = {name: [abs(row[name]) for row in rows if name in row] for name in names}
    least = {name: ZERO_TOLERANCE * max(values, default=0.0) for name, values in sizes.items()}
    return [
        tuple(DASH if name not in row else exact(row[name] if abs(row[name]) > least[name] else 0.0, 4)
              for name in names)
        for row in rows
    ]  # fmt: skip


def rms_headings(tuning: Tuning) -> list[tuple[str, str]]:
    """Return names and units of the root mean squares."""
    channels = [(channel_meaning(name), tuning_text.unit_label(name)) for name in (tuning.output, tuning.actuator)]
    motion = [(tuning.motion, "m/s²")] if tuning.motion else []
    return [*channels, ("its rate", tuning_text.unit_label(tuning.actuator, "/s")), *motion]


def controller_rows(tuning: Tuning) -> list[ControllerRow]:
    """Return the chosen controller, then the baselines."""
    controllers = tuning.compared
    gains = gain_texts([c.gains for c in controllers], gain_names(tuning))
    return [_controller_row(c, texts, tuning) for c, texts in zip(controllers, gains, strict=True)]


def schedule_table(operating_points: tuple[OperatingPoint, ...]) -> TextTable:
    """Return the schedule's gains as a table, a line for each condition."""
    first = operating_points[0] if operating_points else None
    gains, baselines = (list(first.gains), list(first.baseline_costs)) if first else ([], [])
    header = ("speed m/s", "heading deg", "height m", *gains, "cost", *baselines, "Ms", "saturation %", "")
    gain_cells = gain_texts([s.gains for s in operating_points], gains)
    rows = [
        (
            exact(s.U, 4), exact(math.degrees(s.beta), 4), exact(s.height, 3), *texts, fixed(s.cost, 3),
            *(_cost_text(s.baseline_costs.get(name, math.nan)) for name in baselines), fixed(s.Ms, 2),
            fixed(100.0 * s.saturation, 1), "" if s.is_feasible else "; ".join(s.lacks) or "infeasible",
        )
        for s, texts in zip(operating_points, gain_cells, strict=True)
    ]  # fmt: skip
    return TextTable("Gains of the schedule", header, tuple([True] * (len(header) - 1) + [False]), tuple(rows), "")


def robustness_rows(tuning: Tuning) -> list[tuple[str, ...]]:
    """Return of each controller: stable draws, their largest Ms, stable corners, their largest Ms, the worst corner."""
    return [
        (
            r.controller, f"{r.stable_draws} of {r.draws}" if r.draws else DASH, _ratio_text(r.draws_Ms, 2),
            f"{r.stable_corners} of {r.corners}", _ratio_text(r.corners_Ms, 2), r.worst_corner,
        )
        for r in tuning.robustness
    ]  # fmt: skip


def disturbance_headings(tuning: Tuning) -> list[tuple[str, str, int]]:
    """Return what the columns of `disturbance_rows` are of, units, and how many columns each has."""
    (output, of_output), (actuator, of_actuator), (_, of_rate), *_ = rms_headings(tuning)
    return [(output, of_output, 3), (actuator, of_actuator, 2), ("its rate", of_rate, 2)]


def disturbance_rows(tuning: Tuning) -> list[tuple[str, ...]]:
    """Return of each disturbance rms: of the output predicted, simulated, limited; of actuator and rate without two."""
    of_output, of_actuator = channel_display_unit(tuning.output)[0], channel_display_unit(tuning.actuator)[0]

    def row(s: DisturbanceSimulation) -> tuple[str, ...]:
        half = significant(of_output * _HALF * s.standard_error["output"], 1)
        free = f"{significant(of_output * s.unlimited['output'], 3)} ± {half}"
        moved = [significant(of_actuator * rms[key], 3)
                 for key in ("actuator", "actuator_rate") for rms in (s.predicted, s.limited)]  # fmt: skip
        ends = [significant(of_output * rms["output"], 3) for rms in (s.predicted, s.limited)]
        return s.disturbance, ends[0], free, ends[1], *moved

    return [row(s) for s in tuning.disturbance_simulations]


def bound_row(b: PerformanceBound) -> tuple[str, str, str, str, str]:
    """Return name, variance ratio, rms ratio, what is held equal, note."""
    rms = fixed(math.sqrt(b.ratio), 2) if b.ratio >= 0.0 else DASH
    return b.name, fixed(b.ratio, 2), rms, b.conditions, b.note


def component_row(c: Component, gains: dict[str, float]) -> tuple[str | Markup, ...]:
    """Return role, name, transfer function, gain and its value, source."""
    value = exact(gains[c.gain], 5) if c.gain in gains else ""  # digits of the gains file
    letter = gain_symbol(c.gain) if c.gain else ""
    return c.role, c.name, Markup(inline(transfer_latex(c.num, c.den))), letter, value, c.source


def transfer_latex(num: tuple[float, ...], den: tuple[float, ...]) -> str:
    """Return num(s) / den(s) as LaTeX; the denominator 1 is left out."""
    above, below = _polynomial_latex(num), _polynomial_latex(den)
    return above if below == "1" else f"\\frac{{{above}}}{{{below}}}"


def _controller_row(c: Controller, gains: tuple[str, ...], tuning: Tuning) -> ControllerRow:
    factors = [degree_unit(unit)[0] for unit in tuning.units]
    of_output, of_actuator = channel_display_unit(tuning.output)[0], channel_display_unit(tuning.actuator)[0]
    rms = [c.rms.get(key, math.nan) * factor for key, factor in
           (("output", of_output), ("actuator", of_actuator), ("actuator_rate", of_actuator), ("motion", 1.0))
           if key != "motion" or tuning.motion]  # fmt: skip
    has_limits = [math.isfinite(limit) for limit in (tuning.constraints.limit, tuning.constraints.rate)]
    return ControllerRow(
        c.name,
        gains,
        tuple(significant(float(v) * f) for v, f in zip(c.objectives, factors, strict=False)),
        tuple(significant(v, 3) for v in rms),
        fixed(100.0 * c.reduction, 1),
        (_ratio_text(c.Ms, 2), _ratio_text(c.gain_margin, 1), fixed(c.lower_gain_margin, 2),
         _ratio_text(math.degrees(c.phase_margin), 0),
         "∞" if math.isinf(c.delay_margin) else significant(c.delay_margin, 2), fixed(c.damping, 2),
         significant(c.noise_gain, 3)),
        _work_texts(c, tuning),
        tuple(fixed(100.0 * share, 1) if known else DASH for share, known in
              zip((c.saturation, c.rate_saturation), has_limits, strict=True)),
        c.violated,
    )  # fmt: skip


def work_headings(tuning: Tuning) -> list[tuple[str, str]]:
    """Return names and units of what the actuator does: energy and power where its inertia is known."""
    heads = [("reversals", "1/h")]
    return [*heads, ("energy of a reversal", "J"), ("mean power of the drive", "W")] if _has_energy(tuning) else heads


def _has_energy(tuning: Tuning) -> bool:
    return any(math.isfinite(c.energy) for c in tuning.compared)


def _work_texts(c: Controller, tuning: Tuning) -> tuple[str, ...]:
    texts = (significant(c.reversals, 3),)
    energy = (significant(c.energy, 3), significant(c.power, 3))
    return (*texts, *energy) if _has_energy(tuning) else texts


def _ratio_text(value: float, decimals: int) -> str:
    return "∞" if math.isinf(value) else fixed(value, decimals)


def _cost_text(value: float) -> str:
    return "unstable" if math.isinf(value) else fixed(value, 3)


def _polynomial_latex(coefficients: tuple[float, ...]) -> str:
    """``1.432 s^{2} + 0.3796 s + 1``."""
    parts = []
    for k, c in enumerate(coefficients):
        power = len(coefficients) - 1 - k
        if c == 0.0 and len(coefficients) > 1:
            continue
        variable = "" if power == 0 else "s" if power == 1 else f"s^{{{power}}}"
        number = "" if abs(c) == 1.0 and variable else _latex_number(abs(c))
        sign = (" - " if c < 0.0 else " + ") if parts else ("-" if c < 0.0 else "")
        parts.append(sign + f"{number} {variable}".strip())
    return "".join(parts).strip() or "0"


def _latex_number(value: float) -> str:
    """Up to five digits, without thin spaces; powers of ten in LaTeX."""
    if value and not 1e-3 <= value < 1e5:  # sizes written without a power of ten, chosen
        mantissa, _, power = f"{value:.4e}".partition("e")
        return f"{mantissa.rstrip('0').rstrip('.')} \\cdot 10^{{{int(power)}}}"
    return f"{value:.5g}"
