"""Claims that the paper's own numbers can be held against, each verdict by a rule."""

import numpy as np

from seatrial.core.results import Claim, Verdict
from seatrial_studies.published_ship import HEADINGS, SIGNIFICANT_HEIGHT, SPEED
from seatrial_studies.qi2025.evidence import WildHorseEvidence, percent_text
from seatrial_studies.qi2025.published import (
    FIGURE_5_TOP,
    FIGURE_6_TOP,
    FIGURES_1_2,
    FIGURES_6_7,
    PRINTED_ERROR_COUNT,
    REBOUND_ITERATIONS,
    SearchAlgorithm,
    misprinted_errors,
    printed_error,
)
from seatrial_studies.qi2025.reproduction import FIGURE_HEADING, SearchSetting

# per cent, half of the paper's "about 1 %"; our choice
HALF_PERCENT = 0.5
# iterations in which the fitness falls from that of random places, left out of its largest value; our choice
FIRST_ITERATIONS = 20


def claims(evidence: WildHorseEvidence) -> tuple[Claim, ...]:
    """Tables, figures, formulas."""
    return (
        b53_sign_claim(evidence),
        recomputed_errors_claim(),
        order_of_errors_claim(),
        search_box_claim(evidence),
        motions_claim(evidence),
        fitness_rebound_claim(evidence),
        spectrum_claim(evidence),
    )


def b53_sign_claim(evidence: WildHorseEvidence) -> Claim:
    """Refuted where strip theory meets the paper's speed with a negative b53 only."""
    speeds, effects = (
        evidence.audit.implied_speeds,
        [100.0 * e for pair in evidence.audit.sign_effect.values() for e in pair],
    )
    is_negative = all(abs(right - SPEED) < 0.02 < abs(wrong - SPEED) for right, wrong in speeds.values())
    right, wrong = (", ".join(f"{speeds[h][j]:.{3 - j}f}" for h in HEADINGS) for j in (0, 1))
    return Claim(
        "b53 is positive, as tables 2 to 4 print it",
        Verdict.REFUTED if is_negative else Verdict.UNKNOWABLE,
        f"strip theory makes (b35 + |b53|) / (2 a33) the speed if b53 is negative: {right} m/s, the paper's 18 kn "
        f"being {SPEED:.3f}; with the printed sign it is {wrong} m/s. The sign changes the motions by "
        f"{min(effects):.0f} to {max(effects):.0f} % rms",
    )


def recomputed_errors_claim() -> Claim:
    """Confirmed where all follow."""
    wrong = misprinted_errors()
    return Claim(
        "The printed relative errors follow from the printed values",
        Verdict.REFUTED if wrong else Verdict.CONFIRMED,
        f"{len(wrong)} of {PRINTED_ERROR_COUNT} do not; the largest difference is "
        f"{max((abs(a - b) for *_, a, b in wrong), default=0.0):.2f} points, see the table",
    )


def order_of_errors_claim() -> Claim:
    """Confirmed where the mean printed errors have this order at every heading."""
    errors = {a: np.array([printed_error(h, a) for h in HEADINGS]) for a in SearchAlgorithm}
    pso, who, iwho = errors[SearchAlgorithm.PSO], errors[SearchAlgorithm.WHO], errors[SearchAlgorithm.IWHO]
    ordered = np.all((pso.mean(axis=1) > who.mean(axis=1)) & (who.mean(axis=1) > iwho.mean(axis=1)))
    return Claim(
        "PSO's errors are the largest, WHO's clearly lower, IWHO's lowest and about 1 % (section 4.2, tables 2 to 4)",
        Verdict.CONFIRMED if ordered else Verdict.REFUTED,
        f"so it is in the mean at each heading, not for each coefficient: as printed, PSO has the smaller error in "
        f"{int(np.sum(pso < who))} of {pso.size}, WHO a smaller one than IWHO in {int(np.sum(who < iwho))}. IWHO's are "
        f"{iwho.min():.2f} to {iwho.max():.2f} %, {int(np.sum(iwho < HALF_PERCENT))} of {iwho.size} below "
        f"{HALF_PERCENT:g} %: less than about 1 %",
    )


def search_box_claim(evidence: WildHorseEvidence) -> Claim:
    """Refuted where most of WHO's values lie at the end of a box about the truth."""
    hit, total = evidence.audit.saturated_values
    true, own = (evidence.saturated_means(s) for s in (SearchSetting.PAPER, SearchSetting.MODEL_STATE))
    who = percent_text(evidence.errors_of_mean(SearchSetting.MODEL_STATE, SearchAlgorithm.WHO))
    return Claim(
        "WHO's estimates came out of a search that did not know the truth",
        Verdict.REFUTED if hit > total / 2 else Verdict.UNKNOWABLE,
        f"{hit} of its {total} printed means at 90 and 135° lie between -10 and -9.3 % of the truth, as if clipped at "
        "the lower end of a box of ±10 % about the truth, which is not printed. Here its single runs have "
        f"{100 * evidence.share_at_lower_bound(SearchSetting.PAPER, SearchAlgorithm.WHO):.0f} % of their "
        "values on that bound if candidates step "
        f"from the true state, "
        f"{100 * evidence.share_at_lower_bound(SearchSetting.MODEL_STATE, SearchAlgorithm.WHO):.0f} % if from the "
        f"identified model's own; but of its {total} means of ten only {true} and {own} are as far out (error of the "
        f"mean from the model's own state, at 90/135/180°, {who}). No setting tried gives WHO's printed column",
    )


def motions_claim(evidence: WildHorseEvidence) -> Claim:
    """Undecidable where the paper's figures of one condition contradict one another."""
    heave, pitch = evidence.audit.median_extremes
    contradict = FIGURES_1_2 != FIGURES_6_7
    return Claim(
        "At 45° the ship heaves within 0.3 m and pitches within 0.3° (figures 1, 2)",
        Verdict.UNKNOWABLE if contradict or heave > FIGURES_1_2[0] else Verdict.CONFIRMED,
        f"figures 6 and 7 show heave from -{FIGURES_6_7[0]:.2f} to {FIGURE_6_TOP:.2f} m and ±{FIGURES_6_7[1]}° of the "
        "same condition: they contradict "
        "figures 1 and 2. Force coefficients and the coefficients at 45° are not printed; with the closed form "
        f"and those of 90°, assumed, {heave:.2f} m and {pitch:.1f}° are reached. A ship that follows waves of "
        f"0.3 m at the modal frequency pitches {evidence.audit.kinematic_pitch:.2f}°",
    )


def fitness_rebound_claim(evidence: WildHorseEvidence) -> Claim:
    """Refuted where the best of a remembered fitness never rises and that of a fitness of one sample does."""
    rises = {
        s: _count_rises(evidence, s)
        for s in (SearchSetting.REMEMBERED, SearchSetting.MODEL_STATE, SearchSetting.DEGREES)
    }
    steps = (
        len(
            evidence.reproduction.searches[SearchSetting.MODEL_STATE, FIGURE_HEADING, SearchAlgorithm.IWHO].best_fitness
        )
        - 1
    )
    top = {s: _largest_late_fitness(evidence, s) for s in (SearchSetting.DEGREES, SearchSetting.MODEL_STATE)}
    refuted = rises[SearchSetting.REMEMBERED] == 0 < rises[SearchSetting.MODEL_STATE]
    return Claim(
        f"The best fitness falls, but rebounds at iterations {REBOUND_ITERATIONS[0]} and "
        f"{REBOUND_ITERATIONS[1]} (figure 5)",
        Verdict.REFUTED if refuted else Verdict.UNKNOWABLE,
        f"the best so far cannot rise: remembered, it rises {rises[SearchSetting.REMEMBERED]} times in "
        f"{steps} iterations. "
        f"Judged by a sample of each iteration's own it rises {rises[SearchSetting.DEGREES]} times from "
        "the true state, "
        f"{rises[SearchSetting.MODEL_STATE]} times from the identified model's: the curve is the error at "
        "a sample, no measure "
        f"of the search. After iteration {FIRST_ITERATIONS} the largest is {top[SearchSetting.DEGREES]:.5f} and "
        f"{top[SearchSetting.MODEL_STATE]:.4f}; "
        f"the paper's axis ends at {FIGURE_5_TOP:.3f}. Both are smaller: from which state the paper's candidates "
        "stepped is undecided (45°, coefficients of 90° assumed, pitch in degrees)",
    )


def spectrum_claim(evidence: WildHorseEvidence) -> Claim:
    """Refuted where the printed exponent misses the stated height by more than 1 %."""
    printed, corrected = evidence.audit.spectrum_heights
    return Claim(
        "The sea is the two-parameter ITTC spectrum with B = 3.11 / h\u00b3 (eq. 13)",
        Verdict.REFUTED if abs(printed / SIGNIFICANT_HEIGHT - 1.0) > 0.01 else Verdict.CONFIRMED,
        f"it has one parameter, and its significant height is {printed:.2f} m for the stated {SIGNIFICANT_HEIGHT} m; "
        f"with h\u00b2 it is {corrected:.2f} m",
    )


def _count_rises(evidence: WildHorseEvidence, setting: SearchSetting) -> int:
    return int(
        np.sum(
            np.diff(evidence.reproduction.searches[setting, FIGURE_HEADING, SearchAlgorithm.IWHO].best_fitness) > 0.0
        )
    )


def _largest_late_fitness(evidence: WildHorseEvidence, setting: SearchSetting) -> float:
    return float(
        evidence.reproduction.searches[setting, FIGURE_HEADING, SearchAlgorithm.IWHO]
        .best_fitness[FIRST_ITERATIONS:]
        .max()
    )
