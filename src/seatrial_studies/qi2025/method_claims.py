"""Claims of the method: hold, one-sample fitness, time; each verdict by a rule on numbers."""

import numpy as np

from seatrial.core.results import Claim, Verdict
from seatrial.core.text import significant
from seatrial.core.values import Array
from seatrial.physics.models import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial_studies.published_ship import HEADINGS
from seatrial_studies.qi2025.evidence import WildHorseEvidence, percent_text
from seatrial_studies.qi2025.published import PRINTED_SECONDS, SearchAlgorithm
from seatrial_studies.qi2025.reproduction import FIGURE_HEADING, ITERATIONS, SearchSetting
from seatrial_studies.qi2025.search_claims import ABOUT_ONE_PERCENT, EXACT_ERROR, OWN_SETTING
from seatrial_studies.swarm_search import STEP

# share of the rms of a motion that an error of tracking may have; our choice
TRACKED_SHARE = 0.1
# share of the values that counts as most of them
MOST_SHARE = 0.5
# s, end of the figures' time axis
FIGURE_END_S = 200.0


def claims(evidence: WildHorseEvidence) -> tuple[Claim, ...]:
    """What is said of the way it is done."""
    return (
        classical_methods_claim(evidence),
        hold_claim(evidence),
        one_sample_claim(evidence),
        pitch_unit_claim(evidence),
        computing_time_claim(evidence),
        added_time_claim(evidence),
        real_time_claim(evidence),
        tracking_claim(evidence),
        compared_tracking_claim(evidence),
        convergence_claim(evidence),
    )


def classical_methods_claim(evidence: WildHorseEvidence) -> Claim:
    """Refuted where least squares finds all coefficients exactly without noise, and at the bound with it."""
    fits = evidence.output_error.values()
    worst = max(float(np.max(np.abs(o.noise_free_errors))) for o in fits)
    noisy = [100.0 * float(np.mean(np.abs(o.noisy_errors))) for o in fits]
    return Claim(
        "Classical methods can hardly identify many coefficients at once (abstract, introduction)",
        Verdict.REFUTED if worst <= EXACT_ERROR else Verdict.UNKNOWABLE,
        "least squares, the first of the classical methods it names, on the output error by Levenberg-Marquardt from a "
        f"physical start, finds all eight within {significant(worst, 1)} of their values at the three headings without "
        f"noise, in at most {evidence.output_error_evaluations} evaluations of the whole record. With 1 cm and 0.02° "
        "of noise it is "
        f"{percent_text(noisy)} off, {significant(evidence.bound_ratio, 2)} times the Cramér-Rao bound (rms)",
    )


def hold_claim(evidence: WildHorseEvidence) -> Claim:
    """Refuted where holding costs more than ten times what a continuous force does."""
    held, sampled = (
        [100.0 * float(np.mean(np.abs(getattr(b, name)))) for b in evidence.hold_bias.values()]
        for name in ("held", "sampled")
    )
    return Claim(
        "A zero-order hold before the continuous variables makes the whole system discrete without bias (eq. 8)",
        Verdict.REFUTED if min(held) > 10.0 * max(sampled) else Verdict.UNKNOWABLE,
        f"wave force is continuous: fitting motions every 0.5 s with a held force costs {percent_text(held)} mean "
        f"error without any noise; taken as continuous between the same samples {percent_text(sampled)}. The "
        "paper does not see "
        "it because its data are made with the same hold",
    )


def one_sample_claim(evidence: WildHorseEvidence) -> Claim:
    """Refuted where a sample leaves directions open and searches by samples end far off."""
    rank, wide = evidence.audit.step_rank, evidence.single_run_errors(SearchSetting.OFF_CENTRE, SearchAlgorithm.IWHO)
    left = evidence.reproduction.searches[SearchSetting.OFF_CENTRE, HEADINGS[0], SearchAlgorithm.IWHO]
    off = 100.0 * float(np.mean(np.abs(left.errors[0])))
    return Claim(
        "The smaller the fitness of eq. (28), the more accurate the parameters",
        Verdict.REFUTED if rank < len(COEFFICIENTS) and min(wide) > 1.0 else Verdict.UNKNOWABLE,
        f"one step of two motions identifies {rank} of {len(COEFFICIENTS)} directions. In a box of ±50 % off centre "
        f"a run at 90° ends with a fitness of {significant(left.best_fitness[-1], 2)} and coefficients {off:.0f} % "
        "off; mean over "
        f"runs {percent_text(wide)}",
    )


def pitch_unit_claim(evidence: WildHorseEvidence) -> Claim:
    """Undecidable: the print does not say."""
    error_text = "; ".join(
        f"{a} {percent_text(evidence.single_run_errors(SearchSetting.PAPER, a))} in rad, "
        f"{percent_text(evidence.single_run_errors(SearchSetting.DEGREES, a))} in degrees"
        for a in SearchAlgorithm
    )
    return Claim(
        "Heave and pitch can be added as eq. (28) does",
        Verdict.UNKNOWABLE,
        "metres and an angle are added and the angle's unit is not printed; mean errors of single runs in the box "
        f"about the truth: {error_text}",
    )


def computing_time_claim(evidence: WildHorseEvidence) -> Claim:
    """Refuted where PSO does not judge twice as many candidates."""
    printed = {
        a: sum(PRINTED_SECONDS[h][SearchAlgorithm.PSO] for h in HEADINGS) / sum(PRINTED_SECONDS[h][a] for h in HEADINGS)
        for a in (SearchAlgorithm.WHO, SearchAlgorithm.IWHO)
    }
    judged = {a: evidence.evaluations(a) for a in SearchAlgorithm}
    ratio = judged[SearchAlgorithm.PSO] / judged[SearchAlgorithm.WHO]
    counts = ", ".join(f"{a} {count}" for a, count in judged.items())
    times = ", ".join(f"{1e3 * evidence.search_seconds(a):.0f}" for a in SearchAlgorithm)
    return Claim(
        f"PSO takes {printed[SearchAlgorithm.WHO]:.1f} times as long as WHO and {printed[SearchAlgorithm.IWHO]:.1f} "
        "times as long as IWHO (table 5)",
        Verdict.REFUTED if ratio < 2.0 else Verdict.UNKNOWABLE,
        "almost all of the work is judging candidates, and in the setting that is judged "
        f"here a run judges {counts}: PSO {ratio:.1f} times as many as WHO. PSO judges every particle's best place "
        "again by the new sample, WHO and IWHO only those of their stallions; where fitness is remembered all judge "
        "the same number. They "
        f"take {times} ms here",
    )


def added_time_claim(evidence: WildHorseEvidence) -> Claim:
    """Undecidable: seconds are the machine's, and the work that is counted is the same."""
    who, iwho = SearchAlgorithm.WHO, SearchAlgorithm.IWHO
    more = [seconds[iwho] - seconds[who] for seconds in PRINTED_SECONDS.values()]
    return Claim(
        "IWHO takes some 0.2 s longer than WHO (table 5)",
        Verdict.UNKNOWABLE,
        f"table 5 prints {min(more):.2f} to {max(more):.2f} s more, on a machine and in a program that are not named. "
        f"Both judge {evidence.evaluations(who)} and {evidence.evaluations(iwho)} candidates here; the table 'Time of "
        "a run' has the seconds, which vary by machine",
    )


def real_time_claim(evidence: WildHorseEvidence) -> Claim:
    """Judged by accuracy where the true state is at hand and where it is not; causality needs no clock."""
    setting = "the true state before each sample is known, velocities included; box ±10 % about the truth"
    true, carried = (
        evidence.single_run_errors(s, SearchAlgorithm.IWHO) for s in (SearchSetting.PAPER, SearchSetting.MODEL_STATE)
    )
    record = ITERATIONS * STEP
    slowest = max(PRINTED_SECONDS[h][SearchAlgorithm.IWHO] for h in HEADINGS)
    text = (
        f"iteration k needs no sample after k and judges {evidence.evaluations(SearchAlgorithm.IWHO) / ITERATIONS:.0f} "
        f"candidates by one step: table 5 has up to {slowest:.1f} s for {record:.0f} s of samples, here it takes "
        f"{1e3 * evidence.search_seconds(SearchAlgorithm.IWHO):.0f} ms, our fit of the whole record "
        f"{1e3 * evidence.output_error_seconds:.1f} ms. Stepping from the true state a run ends {percent_text(true)} "
        "off; but only positions are measured (eq. 7), and from the identified model's own state it ends "
        f"{percent_text(carried)} off, a random guess in the box 5 %"
    )
    claim = "The method gives accurate parameters in real time"
    if max(true) > ABOUT_ONE_PERCENT:
        return Claim(claim, Verdict.REFUTED, text)
    if max(carried) <= ABOUT_ONE_PERCENT:
        return Claim(claim, Verdict.CONFIRMED, text)
    return Claim(claim, Verdict.HOLDS_IN_OWN_SETTING, text, setting)


def tracking_claim(evidence: WildHorseEvidence) -> Claim:
    """Held where the error stays below a tenth of the motion; limited to the box where a guess does nearly as well."""
    own = evidence.tracking.median_error(FIGURE_HEADING, SearchAlgorithm.IWHO)
    guess = evidence.tracking.guess_errors
    text = (
        f"IWHO's model, carried on while its coefficients evolve, is off by {_share_text(own)} of the rms of heave "
        "and of pitch in 200 s at 45° (median over the runs); coefficients drawn once from the box and "
        f"never corrected by {_share_text(guess)}. It does not lag by a sample, the paper's reason for its rebounds: "
        f"against the motion one sample earlier its error is {1.0 / float(evidence.tracking.lag_gain.max()):.0f} "
        "times as large or more. The waves' force is known and the box is narrow: tracking says little of the "
        "coefficients (45°, coefficients of 90° assumed)"
    )
    claim = "The identified heave and pitch follow the observed ones while coefficients evolve (figures 6, 7)"
    if max(own) > TRACKED_SHARE:
        return Claim(claim, Verdict.REFUTED, text)
    return Claim(claim, Verdict.HOLDS_IN_OWN_SETTING, text, "wave force known, box ±10 % about the truth, no noise")


def compared_tracking_claim(evidence: WildHorseEvidence) -> Claim:
    """By sign tests over the runs, at the headings of the tables and at the one whose tracking the paper shows."""
    tracking = evidence.tracking
    text = (
        "the paper shows the tracking of IWHO alone, at 45°. Errors of heave and of pitch here, median over the runs: "
        f"{'; '.join(f'at {h}° {_tracking_text(evidence, h)}' for h in (FIGURE_HEADING, *HEADINGS))} (45°: "
        "coefficients of 90° assumed). Judged by a sign test over the runs"
    )
    claim = "IWHO's model tracks the attitude more accurately than those of the others"
    if not tracking.is_most_accurate(HEADINGS):
        return Claim(claim, Verdict.REFUTED, text)
    if tracking.is_most_accurate((FIGURE_HEADING,)):
        return Claim(claim, Verdict.CONFIRMED, text)
    return Claim(claim, Verdict.HOLDS_IN_OWN_SETTING, text, f"at 90, 135 and 180°, not at 45°; {OWN_SETTING}")


def _tracking_text(evidence: WildHorseEvidence, heading: int) -> str:
    return ", ".join(
        f"{a} {_share_text(evidence.tracking.median_error(heading, a))}" for a in reversed(SearchAlgorithm)
    )


def _share_text(shares: Array) -> str:
    return " and ".join(f"{100.0 * share:.1f} %" for share in shares)


def convergence_claim(evidence: WildHorseEvidence) -> Claim:
    """Refuted where most values are not near the truth at 100 s, confirmed where all are."""
    found = evidence.reproduction.searches[SearchSetting.PAPER, FIGURE_HEADING, SearchAlgorithm.IWHO]
    errors = 100.0 * np.abs(found.traces / found.truth - 1.0)
    half, end = (errors[:, min(round(t / STEP), errors.shape[1] - 1)] for t in (50.0, ITERATIONS * STEP))
    near = {t: float(np.mean(e <= ABOUT_ONE_PERCENT)) for t, e in ((50, half), (100, end))}
    first = errors[0, min(round(50.0 / STEP), errors.shape[1] - 1)]
    text = (
        f"in {len(errors)} runs here (chosen setting; 45°, coefficients of 90° assumed) {100.0 * near[50]:.0f} % of "
        "the values are "
        f"within {ABOUT_ONE_PERCENT:g} % of the truth at 50 s and {100.0 * near[100]:.0f} % at 100 s, where the "
        "largest "
        f"error is {end.max():.1f} %; in the first run, that of the figures, the largest is {first.max():.1f} % at 50 "
        "s "
        f"and {end[0].max():.1f} % at 100 s. {ITERATIONS} iterations of {STEP} s end at {ITERATIONS * STEP:.0f} s, "
        f"while the figures run for {FIGURE_END_S:.0f} s: what the search does afterwards is not said"
    )
    claim = (
        "Parameters fluctuate less from 50 s, most are near the theoretical values at 100 s, and all coincide with "
        "them afterwards (figures 8 to 11)"
    )
    if end.max() <= ABOUT_ONE_PERCENT:
        return Claim(claim, Verdict.CONFIRMED, text)
    return Claim(claim, Verdict.REFUTED if near[100] <= MOST_SHARE else Verdict.UNKNOWABLE, text)
