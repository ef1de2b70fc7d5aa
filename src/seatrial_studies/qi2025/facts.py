"""Facts of the page, by the keys under which the rows of `study.toml` name them."""

import math
from functools import partial

import numpy as np

from seatrial.core.results import Curve
from seatrial.core.values import Array
from seatrial.physics.models import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial_studies.controller_cost import controller_rows, largest_excess, uncontrolled_excess
from seatrial_studies.heave_pitch_search import STEP, is_smaller
from seatrial_studies.qi2025.evidence import (
    WildHorseEvidence,
    count_below_printed,
    simulated_steps,
)
from seatrial_studies.qi2025.published import (
    PRINTED,
    SearchAlgorithm,
    mean_recomputed_error,
    misprinted_errors,
    printed_error,
    printed_estimate,
    printed_mean_errors,
    true_values,
)
from seatrial_studies.qi2025.reproduction import (
    ABLATION_SETTINGS,
    FAMILY_PROBABILITY,
    FIGURE_HEADING,
    ITERATIONS,
    TEN_RUN_SETTINGS,
    HerdVariant,
    SearchSetting,
)
from seatrial_studies.seaway import HEADINGS, SHIP, SIGNIFICANT_HEIGHT, SPEED
from seatrial_studies.study_file import read_study, study_setting
from seatrial_studies.study_page import Facts, FactTable

FACTS = FactTable[WildHorseEvidence]()
LIMITS = read_study("qi2025").limits
PSO, WHO, IWHO = SearchAlgorithm
PAPER, MODEL_STATE, OFF_CENTRE = SearchSetting.PAPER, SearchSetting.MODEL_STATE, SearchSetting.OFF_CENTRE
FIRST_ITERATIONS = study_setting("qi2025", "first_iterations", int).value
# the coefficients of figures 8 to 11, with their units and the power of ten that the tables print
_HISTORY_PAIRS = {
    ("a33", "b33"): (("kg", "kg/s"), 1e5, "10⁵"),
    ("a35", "b35"): (("kg m", "kg m/s"), 1e6, "10⁶"),
    ("a55", "b55"): (("kg m²", "kg m²/s"), 1e8, "10⁸"),
    ("a53", "b53"): (("kg m", "kg m/s"), 1e6, "10⁶"),
}


@FACTS.declare
def searches(evidence: WildHorseEvidence) -> Facts:
    """What every row may name of the searches: errors, per cent, and runs by setting, work by algorithm."""
    reproduction = evidence.reproduction
    single = {s.name: {a: evidence.single_run_errors(s, a) for a in SearchAlgorithm} for s in reproduction.settings}
    scatter = {s.name: {a: evidence.scatter(s, a) for a in SearchAlgorithm} for s in reproduction.settings}
    ratios = {name: {a: np.divide(errors[a], errors[IWHO]) for a in (PSO, WHO)} for name, errors in single.items()}
    off_centre, paper = single["WHOLE_OFF_CENTRE"], single["PAPER"]
    return {
        "single": single,
        "largest_single": {name: max(errors[IWHO]) for name, errors in single.items()},
        "of_mean": {s.name: {a: evidence.errors_of_mean(s, a) for a in SearchAlgorithm} for s in reproduction.settings},
        "scatter": scatter,
        "is_steadiest": {
            name: np.all(each[IWHO] == np.min([*each.values()], axis=0)) for name, each in scatter.items()
        },
        "who_over_iwho": {name: errors[WHO] for name, errors in ratios.items()},
        "pso_over_iwho": {name: errors[PSO] for name, errors in ratios.items()},
        "who_better": sum(w < i for w, i in zip(off_centre[WHO], off_centre[IWHO], strict=True)),
        "pso_worse": [f"{h}°" for h, p, w in zip(HEADINGS, paper[PSO], paper[WHO], strict=True) if p > w],
        "headings": len(HEADINGS),
        "runs": {s.name: evidence.run_count(s) for s in reproduction.settings},
        "median_tens": [100.0 * float(np.median(runs.tens)) for runs in reproduction.ten_runs.values()],
        "repeats": len(next(iter(reproduction.ten_runs.values())).tens),
        "judged": {a: evidence.evaluations(a) for a in SearchAlgorithm},
        "whole_record_steps": simulated_steps(evidence.evaluations(IWHO), has_slopes=False),
        "search_seconds": ITERATIONS * STEP,
        "paper_setting": PAPER.value,
        "ten_run_settings": [s.value for s in TEN_RUN_SETTINGS],
        "absent": [s.value for s in SearchSetting if s not in reproduction.settings],
        "rarity": 100.0 * FAMILY_PROBABILITY / len(HEADINGS),
    }


@FACTS.declare
def print_(evidence: WildHorseEvidence) -> Facts:
    """What every row may name of the print: errors recomputed, values clipped at a bound or beyond it."""
    hit, hit_of = evidence.audit.saturated_values
    beyond, beyond_of, _ = evidence.audit.beyond_box
    return {
        "printed_mean_errors": printed_mean_errors(),
        "recomputed": {a: [mean_recomputed_error(h, a) for h in HEADINGS] for a in SearchAlgorithm},
        "largest_printed": {a: max(max(printed_error(h, a)) for h in HEADINGS) for a in SearchAlgorithm},
        "saturated": hit,
        "saturated_of": hit_of,
        "saturated_share": hit / hit_of,
        "beyond": beyond,
        "beyond_of": beyond_of,
    }


@FACTS.declare
def fits(evidence: WildHorseEvidence) -> Facts:
    """What every row may name of our own fits."""
    fit_results, evaluations = evidence.output_error.values(), evidence.output_error_evaluations
    return {
        "worst_fit": max(float(np.max(np.abs(o.noise_free_errors))) for o in fit_results),
        "noisy_fits": [100.0 * float(np.mean(np.abs(o.noisy_errors))) for o in fit_results],
        "fit_steps": simulated_steps(evaluations, has_slopes=True),
    }


@FACTS.declare
def parts(evidence: WildHorseEvidence) -> Facts:
    """What every row may name of IWHO with parts left out, mean errors, per cent, by setting and part."""
    ablated = evidence.ablation
    named = {"IWHO": None, **{v.name: v for v in HerdVariant}}
    return {
        "parts": {s.name: {name: ablated.mean_errors(s, v) for name, v in named.items()} for s in ABLATION_SETTINGS},
        "at_centre": ablated.share_at_centre(PAPER, None),
    }


def addition(variant: HerdVariant, evidence: WildHorseEvidence) -> Facts:
    """Runs in which IWHO is better or worse with one of its additions than without, by setting, and sign tests."""
    pairs = {s.name: [evidence.ablation.run_errors(s, v) for v in (None, variant)] for s in ABLATION_SETTINGS}
    return {
        "variant": variant,
        "without": {s.name: evidence.ablation.mean_errors(s, variant) for s in ABLATION_SETTINGS},
        "better": {name: int((complete < bare).sum()) for name, (complete, bare) in pairs.items()},
        "worse": {name: int((complete > bare).sum()) for name, (complete, bare) in pairs.items()},
        "is_better": {name: is_smaller(complete, bare) for name, (complete, bare) in pairs.items()},
        "is_worse": {name: is_smaller(bare, complete) for name, (complete, bare) in pairs.items()},
        "compared": pairs[PAPER.name][0].size,
    }


for _variant in (HerdVariant.NO_FLUCTUATION, HerdVariant.NO_INERTIA, HerdVariant.NO_COMPETITION):
    FACTS.functions[_variant.name] = partial(addition, _variant)


@FACTS.declare
def controllers(evidence: WildHorseEvidence) -> Facts:
    """What controllers cost that are tuned on printed coefficients and on ours."""
    costs = evidence.controllers
    return {
        "rows": controller_rows({f"{h}°": each for h, each in costs.items()}),
        "printed": largest_excess(costs, lambda method: method.endswith("printed") and "b53" not in method),
        "ours": largest_excess(costs, lambda method: method.startswith("ours")),
        "idle": uncontrolled_excess(costs),
    }


@FACTS.declare
def largest_means(evidence: WildHorseEvidence) -> Facts:
    """The largest errors of WHO's means of ten in both boxes, and its printed ones above 10 %."""
    by_setting = evidence.reproduction.searches
    printed = np.concatenate([printed_error(h, WHO) for h in HEADINGS])
    return {
        "largest_mean": {
            s.name: float(np.max([by_setting[s, h, WHO].error_of_mean for h in HEADINGS])) for s in (PAPER, OFF_CENTRE)
        },
        "above_ten": int(np.sum(printed > 10.0)),
        "above_ten_of": printed.size,
    }


@FACTS.declare
def centre(evidence: WildHorseEvidence) -> Facts:
    """Mean errors with the truth at the middle of the box and a quarter of the box aside."""
    zero, aside = evidence.centre_bias.truth_at_centre, evidence.centre_bias.truth_off_centre
    return {
        "at_zero": zero,
        "aside": aside,
        "algorithms": [{"name": a, "at_zero": zero[a], "aside": aside[a]} for a in SearchAlgorithm],
        "rows": [(str(a), 100.0 * zero[a], 100.0 * aside[a]) for a in SearchAlgorithm],
    }


@FACTS.declare
def sign(evidence: WildHorseEvidence) -> Facts:
    """Speeds that strip theory implies with either sign of b53, and what the sign does to the motions."""
    negative, positive = zip(*evidence.audit.implied_speeds.values(), strict=True)
    return {
        "negative": negative,
        "positive": positive,
        "negative_off": np.abs(np.subtract(negative, SPEED)),
        "positive_off": np.abs(np.subtract(positive, SPEED)),
        "speed": SPEED,
        "effects": [effect for pair in evidence.audit.sign_effect.values() for effect in pair],
    }


@FACTS.declare
def misprints(_: WildHorseEvidence) -> Facts:
    """Printed errors that do not follow from the printed values."""
    wrong = misprinted_errors()
    return {
        "misprinted": len(wrong),
        "are_six": len(wrong) == 6,
        "printed_count": sum(len(printed.errors) for printed in PRINTED.values()),
        "difference": max((abs(a - b) for *_, a, b in wrong), default=0.0),
        "rows": [(f"{h}°", str(a), *cells) for h, a, *cells in wrong],
    }


@FACTS.declare
def order(_: WildHorseEvidence) -> Facts:
    """The printed errors of the three against one another."""
    pso, who, iwho = (np.array([printed_error(h, a) for h in HEADINGS]) for a in SearchAlgorithm)
    means = [errors.mean(axis=1) for errors in (pso, who, iwho)]
    return {
        "is_ordered": bool(np.all((means[0] > means[1]) & (means[1] > means[2]))),
        "pso_smaller": int(np.sum(pso < who)),
        "who_smaller": int(np.sum(who < iwho)),
        "compared": pso.size,
        "iwho": iwho.ravel(),
        "below_half": int(np.sum(iwho < LIMITS["half_percent"])),
    }


@FACTS.declare
def saturation(evidence: WildHorseEvidence) -> Facts:
    """WHO's values on the lower bound of the narrow box, by setting, beside the print."""
    narrow = [s for s in evidence.reproduction.settings if s not in (OFF_CENTRE, SearchSetting.WHOLE_OFF_CENTRE)]
    shares = {s.name: evidence.share_at_lower_bound(s, WHO) for s in narrow}
    means = {s.name: evidence.saturated_means(s) for s in narrow}
    rows = [(s.value, 100.0 * shares[s.name], means[s.name]) for s in narrow]
    return {"on_bound": shares, "means": means, "rows": [("printed", None, evidence.audit.saturated_values[0]), *rows]}


@FACTS.declare
def rebound(evidence: WildHorseEvidence) -> Facts:
    """How often the best fitness rises at 45 degrees, and its largest value late in the search, by setting."""
    settings = (SearchSetting.REMEMBERED, SearchSetting.DEGREES, MODEL_STATE)
    fitness = {s.name: _first_fitness(evidence, s) for s in settings}
    return {
        "rises": {name: int(np.sum(np.diff(best) > 0.0)) for name, best in fitness.items()},
        "late": {name: float(best[FIRST_ITERATIONS:].max()) for name, best in fitness.items()},
        "steps": len(fitness["MODEL_STATE"]) - 1,
    }


def _first_fitness(evidence: WildHorseEvidence, setting: SearchSetting, algorithm: SearchAlgorithm = IWHO) -> Array:
    return evidence.reproduction.searches[setting, FIGURE_HEADING, algorithm].best_fitness


@FACTS.declare
def spectrum(evidence: WildHorseEvidence) -> Facts:
    """How far the significant height by the printed exponent is from the stated one, m."""
    printed, _ = evidence.audit.spectrum_heights
    return {"stated": SIGNIFICANT_HEIGHT, "misses": abs(printed / SIGNIFICANT_HEIGHT - 1.0)}


@FACTS.declare
def hold(evidence: WildHorseEvidence) -> Facts:
    """Errors of our fit in continuous waves, per cent, by what the wave force is taken for."""
    bias = evidence.hold_bias
    kinds = {name: [100.0 * np.abs(getattr(b, name)) for b in bias.values()] for name in ("held", "sampled", "fine")}
    held, sampled = ([float(e.mean()) for e in kinds[name]] for name in ("held", "sampled"))
    each = zip(bias, *kinds.values(), strict=True)
    return {
        "held": held,
        "sampled": sampled,
        "least_ratio": min(held) / max(sampled),
        "largest_fine": float(np.max(kinds["fine"])),
        "rows": [(f"{h}°", *(float(size) for e in errors for size in (e.mean(), e.max()))) for h, *errors in each],
    }


@FACTS.declare
def one_sample(evidence: WildHorseEvidence) -> Facts:
    """What one step of two motions identifies, and where a search by samples ends off centre."""
    searched = evidence.reproduction.searches[OFF_CENTRE, HEADINGS[0], IWHO]
    off = float(np.mean(np.abs(searched.errors[0])))
    return {"unknowns": len(COEFFICIENTS), "fitness": searched.best_fitness[-1], "off": off}


@FACTS.declare
def work(evidence: WildHorseEvidence) -> Facts:
    """Times, printed and here, and the work behind them."""
    seconds = {a: [PRINTED[h, a].seconds for h in HEADINGS] for a in SearchAlgorithm}
    judged = {a: evidence.evaluations(a) for a in SearchAlgorithm}
    return {
        "printed_times": {a: sum(seconds[PSO]) / sum(seconds[a]) for a in (WHO, IWHO)},
        "printed_more": np.subtract(seconds[IWHO], seconds[WHO]),
        "slowest": max(seconds[IWHO]),
        "judged_ratio": judged[PSO] / judged[WHO],
        "judged_in_iteration": judged[IWHO] / ITERATIONS,
        "milliseconds": {a: 1e3 * evidence.search_seconds(a) for a in SearchAlgorithm},
        "fit_milliseconds": 1e3 * evidence.output_error_seconds,
        "time_ratio": evidence.search_seconds(IWHO) / evidence.output_error_seconds,
        "evaluation_ratio": judged[IWHO] / evidence.output_error_evaluations,
    }


@FACTS.declare
def tracking(evidence: WildHorseEvidence) -> Facts:
    """Errors of the models that are carried on, shares of the rms of heave and pitch, medians over the runs."""
    models = evidence.tracking
    return {
        "own": models.median_error(FIGURE_HEADING, IWHO),
        "guess": models.guess_errors,
        "lag": 1.0 / float(models.lag_gain.max()),
        "by_heading": [
            {"heading": h, "error": {a: models.median_error(h, a) for a in SearchAlgorithm}}
            for h in (FIGURE_HEADING, *HEADINGS)
        ],
        "is_best_in_tables": models.is_most_accurate(HEADINGS),
        "is_best_at_45": models.is_most_accurate((FIGURE_HEADING,)),
    }


@FACTS.declare
def convergence(evidence: WildHorseEvidence) -> Facts:
    """How near the values are to the truth at 50 and at 100 s at 45 degrees."""
    searched = evidence.reproduction.searches[PAPER, FIGURE_HEADING, IWHO]
    errors = 100.0 * np.abs(searched.traces / searched.truth - 1.0)
    half, end = (errors[:, min(round(t / STEP), errors.shape[1] - 1)] for t in (50.0, ITERATIONS * STEP))
    near_half, near_end = (float(np.mean(e <= LIMITS["about_one_percent"])) for e in (half, end))
    return {
        "traced": len(errors),
        "near_half": near_half,
        "near_end": near_end,
        "largest_end": end.max(),
        "first_half": half[0].max(),
        "first_end": end[0].max(),
    }


@FACTS.declare
def ten_runs(evidence: WildHorseEvidence) -> list[Facts]:
    """The ten runs made again, at each heading: the limit lets chance alone fail one check in twenty studies."""
    each_ten = zip(evidence.reproduction.ten_runs.items(), printed_mean_errors(), strict=True)
    return [
        {
            "heading": heading,
            "tens": len(runs.tens),
            "median": 100.0 * float(np.median(runs.tens)),
            "all": 100.0 * runs.tens,
            "printed": printed,
            "likely": 100.0 * runs.probability_below(0.01 * printed),
            "limit": runs.limit_on_median(printed, len(HEADINGS)),
        }
        for (heading, runs), printed in each_ten
    ]


@FACTS.declare
def ten_run_means(evidence: WildHorseEvidence) -> Facts:
    """The same as rows of a table."""
    cells = [
        (
            f"{t['heading']}°",
            t["printed"],
            t["all"][0],
            t["median"],
            min(t["all"]),
            max(t["all"]),
            t["likely"],
            t["limit"],
        )
        for t in ten_runs(evidence)
    ]
    return {"rows": [tuple(float(cell) if isinstance(cell, float) else cell for cell in row) for row in cells]}


@FACTS.declare
def below_printed(evidence: WildHorseEvidence) -> Facts:
    """How many of our errors are below IWHO's printed ones."""
    counts = {
        h: [
            count_below_printed(errors, h)
            for errors in (
                np.mean(np.abs(o.noise_free_errors), axis=0),
                np.mean(np.abs(o.noisy_errors), axis=0),
                np.mean(o.noisy_errors, axis=0),
            )
        ]
        for h, o in evidence.output_error.items()
    }
    total = [sum(column) for column in zip(*counts.values(), strict=True)]
    rows = [*((f"{h}°", *below) for h, below in counts.items()), ("of 24", *total)]
    return {"rows": rows, "below": total[0], "are_all_below": total[0] == 24}


@FACTS.declare
def coefficients(evidence: WildHorseEvidence) -> list[Facts]:
    """Printed estimates and the means of the runs here, at each heading."""
    groups = []
    for number, heading in enumerate(HEADINGS, start=2):
        columns = [true_values(heading)]
        for a in SearchAlgorithm:
            mean = evidence.reproduction.searches[PAPER, heading, a].points.mean(axis=0)
            columns += [printed_estimate(heading, a), np.abs(mean)]
        groups.append({"heading": heading, "number": number, "rows": _by_coefficient(columns)})
    return groups


@FACTS.declare
def errors(evidence: WildHorseEvidence) -> list[Facts]:
    """Errors printed, of means, of single runs, and ours, per cent, at each heading."""
    groups = []
    for heading in HEADINGS:
        columns, fit = [], evidence.output_error[heading]
        for a in SearchAlgorithm:
            searched = evidence.reproduction.searches[PAPER, heading, a]
            columns += [printed_error(heading, a), 100.0 * searched.error_of_mean, 100.0 * searched.mean_error]
        columns += [100.0 * np.abs(e).mean(axis=0) for e in (fit.noise_free_errors, fit.noisy_errors)]
        mean = ("mean", *(float(np.mean(column)) for column in columns))
        groups.append({"heading": heading, "rows": [*_by_coefficient(columns), mean]})
    return groups


def _by_coefficient(columns: list[Array]) -> list[tuple[str | float, ...]]:
    return list(zip(COEFFICIENTS, *(column.tolist() for column in columns), strict=True))


@FACTS.declare
def settings(evidence: WildHorseEvidence) -> list[Facts]:
    """Errors in each setting: what box, fitness and unit decide."""
    groups = []
    for setting in evidence.reproduction.settings:
        pairs = [
            errors
            for a in SearchAlgorithm
            for errors in (evidence.errors_of_mean(setting, a), evidence.single_run_errors(setting, a))
        ]
        rows = [(f"{h}°", *cells) for h, *cells in zip(HEADINGS, *pairs, strict=True)]
        groups.append({"setting": setting.value, "is_first": not groups, "rows": rows})
    return groups


@FACTS.declare
def parts_left_out(evidence: WildHorseEvidence) -> list[Facts]:
    """Mean errors of IWHO complete and with parts left out, in each setting."""
    ablated = evidence.ablation
    return [
        {
            "setting": setting.value,
            "rows": [
                (v or "IWHO complete", *ablated.mean_errors(setting, v), 100.0 * ablated.share_at_centre(setting, v))
                for v in (None, *HerdVariant)
            ],
        }
        for setting in ABLATION_SETTINGS
    ]


@FACTS.declare
def times(evidence: WildHorseEvidence) -> Facts:
    """Seconds of a run, printed and here."""
    return {
        "rows": [
            (
                f"{h}°",
                *(PRINTED[h, a].seconds for a in SearchAlgorithm),
                *(evidence.reproduction.searches[PAPER, h, a].seconds for a in SearchAlgorithm),
                evidence.output_error[h].seconds,
            )
            for h in HEADINGS
        ]
    }


@FACTS.declare
def ship(_: WildHorseEvidence) -> Facts:
    """What the searches take from table 1."""
    return {"used": SHIP.particulars, "height": SIGNIFICANT_HEIGHT, "speed": SPEED, "none": None}


@FACTS.declare
def frequencies(evidence: WildHorseEvidence) -> Facts:
    """The frequency that the tables' coefficients hold at, and those of the waves."""
    audited, nyquist = evidence.audit, math.pi / STEP
    ranges = audited.encounter_ranges
    return {
        "rows": [(f"{h}°", audited.implied_frequencies[h], *ranges[h]) for h in HEADINGS],
        "nyquist": nyquist,
        "aliased": [f"{largest:.2f} at {h}°" for h, (_, largest) in ranges.items() if largest > nyquist],
    }


def _time(evidence: WildHorseEvidence) -> Array:
    return np.arange(len(evidence.reproduction.seas[FIGURE_HEADING][0].states), dtype=np.float64) * STEP


@FACTS.declare
def motions(evidence: WildHorseEvidence) -> list[Facts]:
    """Heave and pitch at 45 degrees, as figures 1 and 2."""
    states, time = evidence.reproduction.seas[FIGURE_HEADING][0].states, _time(evidence)
    heave, pitch = Curve("heave, up", time, -states[:, 0]), Curve("pitch, bow down", time, -np.degrees(states[:, 2]))
    return [
        {"title": "Figure 1: heave", "unit": "m", "sign": " m", "curves": [heave]},
        {"title": "Figure 2: pitch", "unit": "deg", "sign": "°", "curves": [pitch]},
    ]


@FACTS.declare
def printed_fitness(evidence: WildHorseEvidence) -> Facts:
    """IWHO's fitness alone on a linear axis, as the paper draws figure 5."""
    best = _first_fitness(evidence, MODEL_STATE)
    curve = Curve("IWHO", np.arange(len(best), dtype=np.float64), best)
    return {"curves": [curve], "setting": MODEL_STATE.value, "late": best[FIRST_ITERATIONS:].max()}


@FACTS.declare
def fitness(evidence: WildHorseEvidence) -> list[Facts]:
    """Fitness of all three, from the true state and from the identified model's own."""
    groups = []
    for letter, setting in (("a", SearchSetting.DEGREES), ("b", MODEL_STATE)):
        best = {a: _first_fitness(evidence, setting, a) for a in SearchAlgorithm}
        curves = [
            Curve(str(a), np.arange(len(history), dtype=np.float64), np.log10(np.maximum(history, 1e-12)))
            for a, history in best.items()
        ]
        groups.append({"letter": letter, "is_true_state": setting is SearchSetting.DEGREES, "curves": curves})
    return groups


@FACTS.declare
def tracked(evidence: WildHorseEvidence) -> list[Facts]:
    """Heave and pitch, observed and identified, as figures 6 and 7."""
    observed, identified = evidence.reproduction.seas[FIGURE_HEADING][0].states, evidence.tracking.states
    labels = (
        (0, 1.0, "Figure 6: heave tracked", "m", "between -0.15 and 0.10 m"),
        (2, float(np.degrees(1.0)), "Figure 7: pitch tracked", "deg", "within ±0.15°"),
    )
    named = {"observed": observed, "identified": identified}
    return [
        {
            "title": title,
            "unit": unit,
            "range": printed,
            "curves": [Curve(name, _time(evidence), -factor * states[:, j]) for name, states in named.items()],
        }
        for j, factor, title, unit, printed in labels
    ]


@FACTS.declare
def tracking_errors(evidence: WildHorseEvidence) -> Facts:
    """Identified less observed, per cent of the rms of the motion."""
    observed = evidence.reproduction.seas[FIGURE_HEADING][0].states
    shares = 100.0 * (evidence.tracking.states - observed) / np.sqrt(np.mean(observed**2, axis=0))
    return {"curves": [Curve(name, _time(evidence), shares[:, j]) for name, j in (("heave", 0), ("pitch", 2))]}


@FACTS.declare
def histories(evidence: WildHorseEvidence) -> list[Facts]:
    """Coefficients over the paper's 200 s, in the tables' units, as figures 8 to 11; b53 by magnitude, as printed."""
    searched, time = evidence.reproduction.searches[PAPER, FIGURE_HEADING, IWHO], _time(evidence)
    traces = np.abs(searched.trace[np.minimum(np.arange(len(time)), len(searched.trace) - 1)])
    errors, groups = np.abs(searched.errors[0]), []
    for number, (pair, (units, size, power)) in enumerate(_HISTORY_PAIRS.items(), start=8):
        curves = []
        for name, unit in zip(pair, units, strict=True):
            k = COEFFICIENTS.index(name)
            curves.append(Curve(f"{name}, {power} {unit}", time, traces[:, k] / size))
            curves.append(Curve(f"{name}, theory", time, np.full(len(time), abs(searched.truth[k]) / size)))
        groups.append(
            {
                "number": number,
                "pair": pair,
                "unit": ", ".join(f"{power} {unit}" for unit in units),
                "end": time[-1],
                "ends": [f"{name} {100.0 * errors[COEFFICIENTS.index(name)]:.1f} %" for name in pair],
                "has_b53": "b53" in pair,
                "curves": curves,
            }
        )
    return groups
