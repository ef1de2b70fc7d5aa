"""Facts of the page, by the keys under which the rows of `study.toml` name them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.results import Curve
from seatrial.core.values import Array
from seatrial.numerics.optimise import Normaliser
from seatrial.physics.loops import FREQUENCIES_AND_DAMPINGS, SECONDS_PER_HOUR, Preamplifier
from seatrial_studies.study_page import Facts, FactTable
from seatrial_studies.yu2014.audit import FinGainAudit, contradictory_rows
from seatrial_studies.yu2014.published import (
    DESIGN_ROW,
    DESIGN_ROW_AT_22_KN,
    GAIN_NAMES,
    PREAMPLIFIER_LABELS,
    PUBLISHED_VALUES,
    TABLE_1,
    ControllerResult,
    FinObjective,
    RegulatorSetting,
    RollResponse,
    SeaCondition,
    Table1Row,
    performance,
    roll_response,
)
from seatrial_studies.yu2014.reproduction import (
    WATTS_PER_KILOWATT,
    EnergyComparison,
    RollHistories,
    Table1Fit,
    best_fit_of,
)
from seatrial_studies.yu2014.searches import (
    BOX,
    FinGainSearches,
    FiveGainComparison,
    FiveGainDesign,
    GeneticSearchSetting,
    JointOptimum,
    ThreeGainOptimum,
    TimeDomainSearch,
    WeightComparison,
)

PRINTED, WASHOUT = Preamplifier.PRINTED, Preamplifier.WASHOUT
_ROW_NAMES = tuple(row.name for row in TABLE_1)


@dataclass(frozen=True, eq=False)
class FinGainEvidence:
    """Numbers of one run of the study.

    Attributes:
        calibrated_K_q: by reading.
        table_1_responses: the GA's column at these, long-crested, by reading, in the table's order.
        table_1_fits: table 1 fitted, each reading in both senses of the heading.
        rms_variation: of the rms roll of one record of 1000 s, share.
        time_domain_seconds: CPU time [s] of one search with records in time, compiled and with scipy's lsim.
        ratios_elsewhere: for each row of table 1 the least that three gains can make of the larger of roll and fin-rate
            variance over the paper's, by reading.
        energy: W and estimates of losses in every row, best fit; fitted_energies: the same of each of `table_1_fits`.
        weights: random against fixed weights, by reading.
        regulators: Gh and Gl as functions, by reading.
        joint_optima: one set of gains for all six conditions, by reading.
        time_domain: the search by records of 1000 s; None in the quick version.
        three_gain_optima: the best of three gains by reading, with Ms <= 2 and with the paper's own Ms.
    """

    audit: FinGainAudit
    calibrated_K_q: dict[Preamplifier, float]
    table_1_responses: dict[Preamplifier, tuple[RollResponse, ...]]
    table_1_fits: tuple[Table1Fit, ...]
    histories: RollHistories
    rms_variation: float
    searches: tuple[FinGainSearches, ...]
    weights: dict[Preamplifier, WeightComparison]
    time_domain_seconds: tuple[float, float]
    energy: tuple[EnergyComparison, ...]
    fitted_energies: tuple[tuple[EnergyComparison, ...], ...]
    regulators: dict[Preamplifier, tuple[RegulatorSetting, ...]]
    joint_optima: dict[Preamplifier, JointOptimum]
    time_domain: TimeDomainSearch | None
    three_gain_optima: dict[Preamplifier, tuple[ThreeGainOptimum, ThreeGainOptimum]]
    ratios_elsewhere: dict[Preamplifier, tuple[float, ...]]
    five_gain_design: FiveGainDesign

    def fit(self, preamplifier: Preamplifier) -> Table1Fit:
        """Return the fit in the sense of the heading with the smaller error."""
        return best_fit_of(self.table_1_fits, preamplifier)

    @property
    def best_fit(self) -> Table1Fit:
        """Return the better fit of both readings."""
        return min(self.table_1_fits, key=lambda f: f.log_error)

    @property
    def nearest_baseline(self) -> Table1Fit:
        """Return the fit that comes nearest to the traditional PID's column."""
        return min(self.table_1_fits, key=lambda f: f.baseline_log_error)

    def searches_with(
        self, preamplifier: Preamplifier, fin_objective: FinObjective = FinObjective.PRINTED
    ) -> FinGainSearches:
        """Return the searches of one reading and one J2, normalised by the largest."""
        wanted = GeneticSearchSetting(preamplifier, fin_objective, Normaliser.MAX)
        return next(s for s in self.searches if s.setting == wanted)

    @property
    def search_seconds(self) -> float:
        """Return the median CPU time [s] of one search with its front."""
        return float(np.median(np.concatenate([s.seconds for s in self.searches])))


FACTS = FactTable[FinGainEvidence]()


def responses_at_table_1(preamplifier: Preamplifier) -> tuple[RollResponse, ...]:
    """Return the paper's gains at every row of table 1, long-crested."""
    return tuple(roll_response(performance(preamplifier, SeaCondition(row.speed, row.heading))) for row in TABLE_1)


def _gains(gains: Array, names: Sequence[str] = GAIN_NAMES) -> list[str]:
    return [f"{name} {gain:.2f}" for name, gain in zip(names, gains, strict=True)]


@FACTS.declare
def energy(evidence: FinGainEvidence) -> Facts:
    """Fin rates and W of both columns, printed and fitted, and what else costs energy, by the better fit."""
    comparisons = evidence.energy
    each = [part for e in comparisons for part in e.fitted]
    more = [e.row for e in comparisons if e.fitted[1].reversals > e.fitted[0].reversals]
    return {
        "ratios": [e.printed_rate_ratio for e in comparisons],
        "saved": [e.saved(e.printed) for e in comparisons],
        "by_reading": [_fitted_energy(evidence, reading) for reading in (WASHOUT, PRINTED)],
        "works": [part.work for part in each],
        "reversals": float(np.mean([part.reversals for part in each])),
        "powers": [part.work * part.reversals / SECONDS_PER_HOUR for part in each],
        "drags": [part.fin_power / WATTS_PER_KILOWATT for part in each],
        "drag_changes": [100.0 * (e.fitted[1].fin_power / e.fitted[0].fin_power - 1.0) for e in comparisons],
        "more": more,
        "more_count": len(more),
        "rows": [
            (
                e.row, e.printed_rate_ratio, e.fitted_rate_ratio, *(part.work for part in e.printed),
                e.saved(e.printed), *(part.work for part in e.fitted), e.saved(e.fitted),
            )
            for e in comparisons
        ],
    }  # fmt: skip


def _fitted_energy(evidence: FinGainEvidence, reading: Preamplifier) -> Facts:
    """Fin rates and W of one reading, over both senses of the heading."""
    pairs = zip(evidence.table_1_fits, evidence.fitted_energies, strict=True)
    fits = [(fit.baseline_log_error, energies) for fit, energies in pairs if fit.preamplifier is reading]
    each = [e for _, energies in fits for e in energies]
    return {
        "label": PREAMPLIFIER_LABELS[reading],
        "rates": [e.fitted_rate_ratio for e in each],
        "changes": [-e.saved(e.fitted) for e in each],
        "errors": [error for error, _ in fits],
        "nearest": ", the nearest to that column" * (evidence.nearest_baseline.preamplifier is reading),
    }


@FACTS.declare
def losses(evidence: FinGainEvidence) -> Facts:
    """What propulsion loses, and how often the fins turn back."""
    return {
        "rows": [
            (
                e.row,
                *(part.fin_power / WATTS_PER_KILOWATT for part in e.fitted),
                *(part.roll_power / WATTS_PER_KILOWATT for part in e.fitted),
                *(part.reversals for part in e.fitted),
            )
            for e in evidence.energy
        ]
    }


@FACTS.declare
def table_1(evidence: FinGainEvidence) -> Facts:
    """Table 1 against itself, and beside the GA's gains in both readings."""
    design, at_22, responses = DESIGN_ROW, DESIGN_ROW_AT_22_KN, evidence.table_1_responses
    reductions = {reading.name: responses[reading][4].reduction for reading in Preamplifier}
    remaining = 100.0 - design.genetic.reduction
    return {
        "design": design,
        "at_22": at_22,
        "rate_ratio_at_22": at_22.genetic.rate / at_22.traditional.rate,
        "rows_at_90_differ": design.genetic.reduction != at_22.genetic.reduction,
        "row_count": len(TABLE_1),
        "contradictory_count": len(evidence.audit.contradictory_rows),
        "drop": design.traditional.reduction - design.genetic.reduction,
        "chance": remaining * evidence.rms_variation * np.sqrt(2.0),
        "made": reductions,
        "points_at_22": reductions["WASHOUT"] - at_22.genetic.reduction,
        "K_q": {reading.name: K_q for reading, K_q in evidence.calibrated_K_q.items()},
        "uncontrolled": responses[WASHOUT][1].uncontrolled,
        "rows": _beside_table_1(lambda row: row.genetic, [responses[reading] for reading in Preamplifier]),
    }


def _beside_table_1(
    column: Callable[[Table1Row], ControllerResult], columns: Sequence[Sequence[ControllerResult | RollResponse]]
) -> list[tuple[str | float, ...]]:
    """Return the rows of table 1: for each quantity the paper's number and that of each reading."""
    return [
        (
            row.name,
            *(getattr(result, name) for name in ("roll", "rate", "reduction") for result in (column(row), *ours)),
        )
        for row, *ours in zip(TABLE_1, *columns, strict=True)
    ]


@FACTS.declare
def fits(evidence: FinGainEvidence) -> Facts:
    """Table 1 fitted: errors, gains of the baseline, what was fitted."""
    by_reading = {reading.name: evidence.fit(reading) for reading in Preamplifier}
    return {
        "of": by_reading,
        "baseline": {name: _gains(fit.baseline) for name, fit in by_reading.items()},
        "rows": [
            (
                PREAMPLIFIER_LABELS[f.preamplifier], "following" if f.following_is_zero else "head", f.K_q, f.level,
                f.log_error, f.baseline_log_error,
            )
            for f in evidence.table_1_fits
        ],
    }  # fmt: skip


@FACTS.declare
def fitted_genetic(evidence: FinGainEvidence) -> Facts:
    """The GA's column as it is fitted."""
    results = [f.results(f.genetic) for f in map(evidence.fit, Preamplifier)]
    return {"rows": _beside_table_1(lambda row: row.genetic, results)}


@FACTS.declare
def fitted_baseline(evidence: FinGainEvidence) -> Facts:
    """The traditional PID's column as it is fitted."""
    results = [f.results(f.traditional) for f in map(evidence.fit, Preamplifier)]
    return {"rows": _beside_table_1(lambda row: row.traditional, results)}


@FACTS.declare
def implied_roll(_: FinGainEvidence) -> Facts:
    """The roll without fins that both columns of table 1 imply."""
    apart = contradictory_rows()
    return {
        "rows": [
            (row.name, row.traditional.uncontrolled, row.genetic.uncontrolled, "yes" if row.name in apart else "no")
            for row in TABLE_1
        ]
    }


@FACTS.declare
def search(evidence: FinGainEvidence) -> Facts:
    """The published search over seeds, and random against fixed weights."""
    washout = evidence.searches_with(WASHOUT)
    smaller, larger = evidence.weights[WASHOUT].count_better()
    return {
        "by_reading": [_search_of(evidence, reading) for reading in Preamplifier],
        "is_better": all(comparison.is_better for comparison in evidence.weights.values()),
        "is_worse": all(comparison.is_worse for comparison in evidence.weights.values()),
        "spread": washout.relative_spread,
        "narrowest": float(washout.relative_spread.min()),
        "smaller": smaller,
        "larger": larger,
    }


def _search_of(evidence: FinGainEvidence, reading: Preamplifier) -> Facts:
    compared, searches = evidence.weights[reading], evidence.searches_with(reading)
    smaller, larger = compared.count_better()
    return {
        "label": PREAMPLIFIER_LABELS[reading],
        "smaller": smaller,
        "larger": larger,
        "J": np.median(compared.J, axis=1),
        "volume": np.median(compared.volume, axis=1),
        "seeds": len(searches.Ms),
        "spread": 100.0 * searches.relative_spread,
        "largest_Ms": searches.Ms.max(),
        "dominated": searches.is_dominated.sum(),
        "distance": searches.distance_to_published,
    }


@FACTS.declare
def joint(evidence: FinGainEvidence) -> Facts:
    """One set of gains for all six conditions, and the least that other gains reach in one of them."""
    optima = {reading.name: optimum for reading, optimum in evidence.joint_optima.items()}
    elsewhere = {reading.name: ratios for reading, ratios in evidence.ratios_elsewhere.items()}
    return {
        "worst_ratio": {name: optimum.worst_ratio for name, optimum in optima.items()},
        "Ms_ratio": {name: optimum.Ms_ratio for name, optimum in optima.items()},
        "least": {name: min(ratios) for name, ratios in elsewhere.items()},
        "row": {name: _ROW_NAMES[int(np.argmin(ratios))] for name, ratios in elsewhere.items()},
        "optima": [
            {
                "label": PREAMPLIFIER_LABELS[optimum.preamplifier],
                "gains": _gains(optimum.gains),
                "worst": optimum.genetic_worst_ratios,
                "Ms": optimum.genetic_Ms,
            }
            for optimum in optima.values()
        ],
        "rows": [
            (PREAMPLIFIER_LABELS[optimum.preamplifier], name, *ratios, Ms)
            for optimum in optima.values()
            for name, ratios, Ms in zip(_ROW_NAMES, optimum.ratios.tolist(), optimum.Ms.tolist(), strict=True)
        ],
    }


@FACTS.declare
def three_gains(evidence: FinGainEvidence) -> Facts:
    """The best of three gains by the worst of the three objectives over the paper's."""
    (printed, _), (_, washout) = evidence.three_gain_optima[PRINTED], evidence.three_gain_optima[WASHOUT]
    return {
        "printed": printed,
        "three": _gains(printed.gains),
        "printed_worst": float(printed.objective_ratios.max()),
        "washout_worst": float(washout.objective_ratios.max()),
        "rows": [
            (
                PREAMPLIFIER_LABELS[reading], f"{b.ms_limit:.3g}", *(round(gain, 3) for gain in b.gains.tolist()), b.Ms,
                *b.objective_ratios.tolist(),
            )
            for reading in Preamplifier
            for b in evidence.three_gain_optima[reading]
        ],
    }  # fmt: skip


@FACTS.declare
def five_gains(evidence: FinGainEvidence) -> Facts:
    """Five gains in the seas of the search and in those held out."""
    design = evidence.five_gain_design
    (band, _), (low, _) = FREQUENCIES_AND_DAMPINGS
    held_out, three = design.held_out_seas, design.three_gains
    kinds = {"searched in": design.design_seas, "held out": held_out, "three gains, same box": three}
    held_out_rate = [c.rate_ratio for c in held_out]
    return {
        "long_crested_roll": design.design_seas[0].roll_ratio,
        "worst_roll": max(c.roll_ratio for c in design.design_seas),
        "worst_rate": max(c.rate_ratio for c in design.design_seas),
        "held_out_roll": [c.roll_ratio for c in held_out],
        "held_out_rate": held_out_rate,
        "held_out_count": len(held_out_rate),
        "faster_count": sum(rate > 1.0 for rate in held_out_rate),
        "gains": _gains(design.gains, (*GAIN_NAMES, "KB", "KL")),
        "band": band,
        "low": low,
        "rows": [_compared(kind, c) for kind, seas in kinds.items() for c in seas],
    }


def _compared(kind: str, c: FiveGainComparison) -> tuple[str | float, ...]:
    name = c.sea.name or "ITTC 3.3 m, long-crested"
    return name, kind, c.roll_ratio, c.fin_ratio, c.rate_ratio, c.paper_reduction, c.reduction


@FACTS.declare
def held_out_seas(evidence: FinGainEvidence) -> list[Facts]:
    """Five gains in each sea that the search did not see."""
    design = evidence.five_gain_design
    return [
        {
            "sea": c.sea.name,
            "roll_ratio": c.roll_ratio,
            "rate_ratio": c.rate_ratio,
            "is_hardest": c.sea == design.hardest.sea,
        }
        for c in design.held_out_seas
    ]


@FACTS.declare
def times(evidence: FinGainEvidence) -> list[Facts]:
    """The search's time over that of records, scipy's and compiled."""
    compiled, single = evidence.time_domain_seconds
    named = {"scipy's lsim": single, "compiled": compiled}
    return [{"records": records, "ratio": evidence.search_seconds / seconds} for records, seconds in named.items()]


@FACTS.declare
def time_rows(evidence: FinGainEvidence) -> Facts:
    """Time of one search by how its objectives are computed."""
    compiled, single = evidence.time_domain_seconds
    seconds = {
        "variances in the frequency domain": evidence.search_seconds,
        "records of 1000 s, compiled scalar loop": compiled,
        "records of 1000 s, scipy's lsim one after another": single,
    }
    return {"rows": [(name, s, s / evidence.search_seconds) for name, s in seconds.items()]}


@FACTS.declare
def scatter(evidence: FinGainEvidence) -> Facts:
    """Answers of the published search in every setting, over seeds."""
    return {
        "seeds": len(evidence.searches[0].Ms),
        "box": [f"{n} {low:g} to {high:g}" for n, low, high in zip(GAIN_NAMES, BOX.lower, BOX.upper, strict=True)],
        "published": PUBLISHED_VALUES,
        "rows": [
            (
                PREAMPLIFIER_LABELS[s.setting.preamplifier],
                s.setting.fin_objective.value,
                s.setting.normaliser.value,
                *(
                    f"{low:.3g} to {high:.3g}"
                    for low, high in zip(s.gains.min(axis=0), s.gains.max(axis=0), strict=True)
                ),
                f"{s.Ms.min():.2f} to {s.Ms.max():.3g}",
                str(s.fragile_count),
                f"{s.reduction.min():.1f} to {s.reduction.max():.1f}",
                str(s.is_dominated.sum()),
            )
            for s in evidence.searches
        ],
    }


@FACTS.declare
def answers(evidence: FinGainEvidence) -> list[Facts]:
    """Answers of the published search by seed, in both readings."""
    groups = []
    for reading in Preamplifier:
        searches = evidence.searches_with(reading)
        columns = (*searches.gains.T, searches.Ms, *searches.objective_ratios.T, searches.reduction)
        seeds = map(str, range(1, len(searches.Ms) + 1))
        rows = list(zip(seeds, *(column.tolist() for column in columns), strict=True))
        groups.append({"label": PREAMPLIFIER_LABELS[reading], "rows": rows})
    return groups


@FACTS.declare
def by_records(evidence: FinGainEvidence) -> Facts:
    """The search by records of 1000 s beside that by the spectrum; nothing where it was left out."""
    searched = evidence.time_domain
    if searched is None:
        return {"is_made": False}
    each = zip(("records of one sea", "its spectrum"), searched.gains, searched.responses, searched.cpu_s, strict=True)
    return {
        "is_made": True,
        "label": PREAMPLIFIER_LABELS[searched.preamplifier],
        "evaluations": searched.evaluations,
        "rows": [(label, *gains.tolist(), r.reduction, r.rate, r.Ms, cpu_s) for label, gains, r, cpu_s in each],
    }


@FACTS.declare
def regulators(evidence: FinGainEvidence) -> list[Facts]:
    """Gh and Gl as functions, with what they do."""
    return [
        {
            "label": PREAMPLIFIER_LABELS[reading],
            "rows": [(s.speed, s.height, s.Gl, s.Gh, *s.reductions, *s.fins, *s.Ms) for s in settings],
        }
        for reading, settings in evidence.regulators.items()
    ]


@FACTS.declare
def misprints(evidence: FinGainEvidence) -> Facts:
    """What the print does where it cannot be meant, and the paper's gains where they were set."""
    audit = evidence.audit
    responses = {reading.name: response for reading, response in audit.roll_responses.items()}
    return {
        "rates": {reading.name: rates for reading, rates in audit.fin_rate_readings.items()},
        "of": responses,
        "variance": {name: response.fin**2 for name, response in responses.items()},
    }


@FACTS.declare
def rate_bars(evidence: FinGainEvidence) -> Facts:
    """Fin rate of the GA over the PID's, printed and fitted."""
    paper, fitted = zip(*((e.printed_rate_ratio, e.fitted_rate_ratio) for e in evidence.energy), strict=True)
    return {"labels": [e.row for e in evidence.energy], "series": {"paper": paper, "ours, fitted": fitted}}


@FACTS.declare
def reduction_bars(evidence: FinGainEvidence) -> Facts:
    """Roll reduction with the GA's gains, printed and in both readings."""
    series = {
        f"{PREAMPLIFIER_LABELS[reading]}, K_q fitted": tuple(m.reduction for m in evidence.table_1_responses[reading])
        for reading in Preamplifier
    }
    return {"labels": _ROW_NAMES, "series": {"paper, GA": tuple(row.genetic.reduction for row in TABLE_1), **series}}


@FACTS.declare
def histories(evidence: FinGainEvidence) -> list[Facts]:
    """Roll and fin rate over time, as figures 3 to 7."""
    h, label = evidence.histories, PREAMPLIFIER_LABELS[evidence.best_fit.preamplifier]
    labels = (
        ("Figure 3: roll without fins", "roll [°]", h.uncontrolled),
        ("Figure 4: roll under the traditional PID (fitted)", "roll [°]", h.pid[0]),
        ("Figure 5: roll under the GA's gains", "roll [°]", h.genetic[0]),
        ("Figure 6: fin rate under the traditional PID (fitted)", "fin rate [°/s]", h.pid[1]),
        ("Figure 7: fin rate under the GA's gains", "fin rate [°/s]", h.genetic[1]),
    )
    return [
        {"title": title, "y_label": y_label, "label": label, "curves": [Curve(f"rms {np.std(y):.2f}", h.time, y)]}
        for title, y_label, y in labels
    ]


@FACTS.declare
def answer_bars(evidence: FinGainEvidence) -> list[Facts]:
    """Answers by seed as shares of the searched ranges, in both readings."""
    groups = []
    for reading in Preamplifier:
        shares = 100.0 * (evidence.searches_with(reading).gains - BOX.lower) / BOX.width
        series = {name: tuple(column) for name, column in zip(GAIN_NAMES, shares.T.tolist(), strict=True)}
        labels = [str(seed) for seed in range(1, len(shares) + 1)]
        groups.append({"label": PREAMPLIFIER_LABELS[reading], "labels": labels, "series": series})
    return groups


@FACTS.declare
def peak_bars(evidence: FinGainEvidence) -> Facts:
    """Ms of the answers by seed, in both readings and with both J2."""
    series = {
        f"{PREAMPLIFIER_LABELS[reading]}, {fins.value}": tuple(evidence.searches_with(reading, fins).Ms.tolist())
        for reading in Preamplifier
        for fins in FinObjective
    }
    return {"labels": [str(seed) for seed in range(1, len(evidence.searches[0].Ms) + 1)], "series": series}


@FACTS.declare
def trade(evidence: FinGainEvidence) -> Facts:
    """Roll against fin rate with three and with five gains, and the paper's gains as a cross."""
    design, names = evidence.five_gain_design, {3: "three gains", 5: "five gains"}
    curves = [Curve(names[count], design.rate_ratios, roll) for count, roll in design.roll_ratios.items()]
    cross = (np.array([0.97, 1.03, 1.0, 1.0, 1.0]), np.array([1.0, 1.0, 1.0, 0.97, 1.03]))
    return {"curves": [*curves, Curve("paper's gains", *cross)]}
