"""Tables of a tuning: controllers, margins, seas, and the search that found them."""

import math
from collections.abc import Callable, Mapping, Sequence
from operator import itemgetter

import numpy as np
from markupsafe import Markup

from seatrial.core.equations.latex import latex_symbol
from seatrial.core.figures.chart import Chart
from seatrial.core.figures.panels import NamedCurve, bars_chart, curves_chart
from seatrial.core.results.front_chart import degree_unit
from seatrial.core.results.tuning import (
    Component,
    Controller,
    DiscreteBlock,
    DiscreteController,
    DisturbanceSimulation,
    GainSearch,
    OperatingPoint,
    PerformanceBound,
    Tuning,
)
from seatrial.core.text.numbers import DASH, exact, fixed, significant
from seatrial.core.text.words import counted
from seatrial.core.values import Array
from seatrial.core.values.notation import channel_meaning
from seatrial.data.folder.gains_file import channel_display_unit
from seatrial.reporting import tuning_text
from seatrial.reporting.mathml import inline
from seatrial.reporting.section import Column, Level, TextTable, formula, number, plain_table, table_of, words

# The chapter on a published search for gains: one table with the package's front, its cost, convergence, scatter.

# convergence curves drawn at most: more hide one another
MAX_CURVES = 6
# columns of the table over seeds: share of the answers below
_QUANTILES = {"least": 0.0, "median": 0.5, "largest": 1.0}


def search_table(tuning: Tuning) -> TextTable:
    """Return the package's own choice and the answers of a published search side by side; empty without a search."""
    search, own = tuning.search, tuning.reference
    if search is None or own is None:
        return plain_table((), ())
    names = list(dict.fromkeys((*search.gain_names, *own.gains)))
    objectives = [f"{name}{_unit_text(unit)}" for name, unit in tuning.objectives.items()]
    front = tuning.front
    columns = {
        own.name: _controller_cells(own, names, tuning, front.evaluations, front.cpu_s),
        "genetic algorithm": _controller_cells(tuning.chosen, names, tuning, search.evaluations, search.cpu_s),
    }
    if len(search.gains) > 1:
        columns |= {label: _quantile_cells(share, search, names, tuning) for label, share in _QUANTILES.items()}
    labels = (*names, *objectives, "Ms", "keeps the limits", "evaluations", "CPU time [s]")
    rows = list(zip(labels, *columns.values(), strict=True))
    return plain_table(("", *columns), rows)


def search_note(tuning: Tuning) -> str:
    """Return how the table of the published search is to be read; empty without a search."""
    if tuning.search is None or tuning.reference is None:
        return ""
    return (
        "Own front: evaluations and CPU time of its search with the task's own gains. Least, median and largest are of "
        f"the answers of {counted(len(tuning.search.gains), 'seed')}, line by line."
    )


def _unit_text(unit: str) -> str:
    return f" [{degree_unit(unit)[1]}]" if unit else ""


def _controller_cells(
    controller: Controller, names: Sequence[str], tuning: Tuning, evaluations: int, cpu_s: float
) -> list[str]:
    gains = [exact(controller.gains[n], 4) if n in controller.gains else DASH for n in names]
    cpu_time = fixed(cpu_s, 2) if math.isfinite(cpu_s) else DASH
    # a count with all its digits
    return [*gains, *_objective_cells(controller.objectives, tuning), exact(controller.Ms, 3),
            "no" if controller.violated else "yes", exact(evaluations, 12), cpu_time]  # fmt: skip


def _quantile_cells(share: float, search: GainSearch, names: Sequence[str], tuning: Tuning) -> list[str]:
    """Quantiles of gains, objectives and Ms over the seeds, each for itself."""
    gains = dict(zip(search.gain_names, np.quantile(search.gains, share, axis=0).tolist(), strict=True))
    values, Ms = np.quantile(search.values, share, axis=0), float(np.quantile(search.Ms, share))
    kept = f"{search.feasible_count} of {len(search.gains)}" if share == _QUANTILES["median"] else ""
    return [*(exact(gains[n], 4) if n in gains else DASH for n in names), *_objective_cells(values, tuning),
            exact(Ms, 3), kept, "", ""]  # fmt: skip


def _objective_cells(values: Array, tuning: Tuning) -> list[str]:
    factors = [degree_unit(unit)[0] for unit in tuning.units]
    return [significant(float(v) * f) for v, f in zip(values, factors, strict=True)]


def search_sentences(tuning: Tuning) -> tuple[str, ...]:
    """Return what the search covers of the front, and what it cost; no verdict on time."""
    search = tuning.search
    if search is None:
        return ()
    covered = (
        f"Of the hypervolume of the package's front of the same gains, what one search saw within the limits covers "
        f"{fixed(search.hypervolume, 2)}."
        if math.isfinite(search.hypervolume)
        else ""
    )
    cost = (
        f"One search took {fixed(search.cpu_s, 3)} s of CPU time for {exact(search.evaluations, 12)} controllers, each "
        f"judged in {counted(len(tuning.seas), 'sea')}."
    )
    return tuple(text for text in (covered, cost) if text)


def convergence_chart(search: GainSearch) -> Chart:
    """Return J of the fittest of each generation for the first seeds."""
    generations = np.arange(1, search.histories.shape[1] + 1, dtype=np.float64)
    curves = [NamedCurve(f"seed {k + 1}", generations, row) for k, row in enumerate(search.histories[:MAX_CURVES])]
    return curves_chart("convergence", curves, "generation", "J of the fittest, equal weights")


def scatter_chart(search: GainSearch) -> Chart | None:
    """Return the answers of all seeds as bars, per cent of each gain's range."""
    shares = 100.0 * (search.gains - search.lower) / (search.upper - search.lower)
    series = {name: tuple(shares[:, i].tolist()) for i, name in enumerate(search.gain_names)}
    labels = [str(k + 1) for k in range(len(shares))]
    return bars_chart("answers by seed", labels, series, "share of the range searched [%]")


# Rows of a tuning's page: controllers, schedule, bounds, blocks, as text.

_HALF = 1.96  # standard errors of half a 95 % interval
# share of the largest gain of a name below which a gain is rounding
ZERO_TOLERANCE = 1e-9


def gain_symbol(name: str) -> Markup:
    """Return ``KP`` and ``K_P`` as K with its index."""
    spaced = f"K_{name[1:]}" if len(name) > 1 and name[0] == "K" and name[1:].isupper() else name
    return Markup(inline(latex_symbol(spaced)))


def gain_unit(tuning: Tuning, name: str) -> str:
    """Return the unit of a gain; nothing where it has none."""
    unit = tuning.gain_units.get(name, "1")
    return "" if unit == "1" else unit


def discrete_table(controller: DiscreteController) -> TextTable:
    """Return role, name and difference equation of every block of the controller on board."""
    return table_of(
        controller.blocks,
        words("Role", lambda b: b.role),
        words("Block", lambda b: b.name),
        formula("Difference equation", lambda b: Markup(inline(_difference_latex(b)))),
    )


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


def effect_rows(tuning: Tuning) -> list[tuple[str, ...]]:
    """Return what the controllers do, a row for each quantity: reduction, rms, Ms, beyond limits, constraints."""
    controllers = tuning.compared
    of_output, of_actuator = channel_display_unit(tuning.output)[0], channel_display_unit(tuning.actuator)[0]
    factors = {"output": of_output, "actuator": of_actuator, "actuator_rate": of_actuator, "motion": 1.0}
    used = [key for key in factors if key != "motion" or tuning.motion]
    rms = [
        (_label(*heading), *(significant(c.rms.get(key, math.nan) * factors[key], 3) for c in controllers))
        for key, heading in zip(used, rms_headings(tuning), strict=True)
    ]
    reduction = ("reduction, %", *(fixed(100.0 * c.reduction, 1) for c in controllers))
    limits = tuning.constraints
    beyond = [
        (f"{name} beyond limits, %", *(fixed(100.0 * share(c), 1) for c in controllers))
        for name, limit, share in (
            ("amplitudes", limits.limit, lambda c: c.saturation), ("rates", limits.rate, lambda c: c.rate_saturation)
        ) if math.isfinite(limit)
    ]  # fmt: skip
    return [
        *([reduction] if tuning_text.has_reduction(tuning) else []),
        *rms,
        ("sensitivity peak Ms", *(_ratio_text(c.Ms, 2) for c in controllers)),
        *beyond,
        ("constraints", *("violated" if c.violated else "kept" for c in controllers)),
    ]


def detail_rows(tuning: Tuning) -> list[tuple[str, ...]]:
    """Return gains, objectives, margins and work of the actuator, a row for each."""
    controllers, names = tuning.compared, gain_names(tuning)
    gains = zip(*gain_texts([c.gains for c in controllers], names), strict=True)
    factors = [degree_unit(unit)[0] for unit in tuning.units]
    objectives = [
        (_label(name, degree_unit(unit)[1]), *(significant(float(c.objectives[k]) * factors[k]) for c in controllers))
        for k, (name, unit) in enumerate(tuning.objectives.items())
    ]
    margins: dict[str, Callable[[Controller], str]] = {
        "gain may grow by a factor of": lambda c: _ratio_text(c.gain_margin, 1),
        "gain may fall to a factor of": lambda c: fixed(c.lower_gain_margin, 2),
        "phase margin, deg": lambda c: _ratio_text(math.degrees(c.phase_margin), 0),
        "delay margin, s": lambda c: "∞" if math.isinf(c.delay_margin) else significant(c.delay_margin, 2),
        "least damping ratio": lambda c: fixed(c.damping, 2),
        "noise amplification, largest |K S|": lambda c: significant(c.noise_gain, 3),
        "reversals, 1/h": lambda c: significant(c.reversals, 3),
    }
    if any(math.isfinite(c.energy) for c in controllers):
        margins["energy of a reversal, J"] = lambda c: significant(c.energy, 3)
        margins["mean power of the drive, W"] = lambda c: significant(c.power, 3)
    return [
        *((_label(name, gain_unit(tuning, name)), *texts) for name, texts in zip(names, gains, strict=True)),
        *objectives,
        *((label, *map(text, controllers)) for label, text in margins.items()),
    ]


def _label(quantity: str, unit: str) -> str:
    return f"{quantity}, {unit}" if unit else quantity


def rms_table(headings: Sequence[tuple[str, str, int]], rows: Sequence[Sequence[str]]) -> TextTable:
    """Return rms values predicted, simulated and with limits: of the first heading also on the terminal.

    headings: of what, unit, and how many columns: two where nothing was simulated without limits.
    """
    columns: list[Column[Sequence[str]]] = [words("rms of", lambda row: row[0])]
    for k, (quantity, unit, count) in enumerate(headings):
        for kind in ("predicted", "simulated", "with limits") if count == 3 else ("predicted", "with limits"):
            place = len(columns)
            level = Level.PAGE if k else Level.NORMAL
            columns.append(number(f"{quantity} {kind}", itemgetter(place), unit, level=level))
    return table_of(rows, *columns)


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
    return plain_table(header, rows, flush_left=(-1,))


def robustness_rows(tuning: Tuning) -> list[tuple[str, ...]]:
    """Return of each controller: stable draws, their largest Ms, stable corners, their largest Ms, the worst corner."""
    return [
        (
            tuning.shared_names[r.controller],
            f"{r.stable_draws} of {r.draws}" if r.draws else DASH, _ratio_text(r.draws_Ms, 2),
            f"{r.stable_corners} of {r.corners}", _ratio_text(r.corners_Ms, 2), r.worst_corner,
        )
        for r in tuning.robustness
        if r.controller in tuning.shared_names
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


def component_table(components: Sequence[Component], gains: Mapping[str, float]) -> TextTable:
    """Return role, name, transfer function, gain with its value, and source of each block."""
    return table_of(
        components,
        words("Role", lambda c: c.role),
        words("Block", lambda c: c.name),
        formula("Transfer function", lambda c: Markup(inline(transfer_latex(c.num, c.den)))),
        formula("Gain", lambda c: gain_symbol(c.gain) if c.gain else Markup("")),
        number("value", lambda c: exact(gains[c.gain], 5) if c.gain in gains else ""),  # digits of the gains file
        words("Source", lambda c: c.source),
    )


def transfer_latex(num: tuple[float, ...], den: tuple[float, ...]) -> str:
    """Return num(s) / den(s) as LaTeX; the denominator 1 is left out."""
    above, below = _polynomial_latex(num), _polynomial_latex(den)
    return above if below == "1" else f"\\frac{{{above}}}{{{below}}}"


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
