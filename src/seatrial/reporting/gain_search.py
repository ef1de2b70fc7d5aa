"""The chapter on a published search for gains: one table with the package's front, its cost, convergence, scatter."""

import math
from collections.abc import Sequence

import numpy as np

from seatrial.core.figures.chart import Chart
from seatrial.core.figures.panels import NamedCurve, bars_chart, curves_chart
from seatrial.core.results.front_chart import degree_unit
from seatrial.core.results.tuning import Controller, GainSearch, Tuning
from seatrial.core.text.numbers import DASH, exact, fixed, significant
from seatrial.core.text.words import counted
from seatrial.core.values import Array
from seatrial.reporting.section import TextTable, plain_table

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
    """Return what the search covers of the front, and what it would cost with records in time; no verdict on time."""
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
        f"judged in {counted(len(tuning.seas), 'sea')}. In time, with a record of 1000 s in "
        f"steps of 0.1 s each, it would take {exact(search.compiled_ratio, 2)} times as long by a compiled loop "
        f"({significant(1e3 * search.compiled_record_s, 2)} ms a record), {exact(search.lsim_ratio, 2)} times by "
        f"scipy.signal.lsim ({significant(1e3 * search.lsim_record_s, 2)} ms), on this machine."
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
