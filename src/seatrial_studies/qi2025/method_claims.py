"""Claims of the method: hold, one-sample fitness, time; each verdict by a rule on numbers."""

import numpy as np

from seatrial.core.results import Claim, Verdict
from seatrial.physics.models import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial_studies.published_ship import HEADINGS
from seatrial_studies.qi2025.evidence import WildHorseEvidence, percent_text
from seatrial_studies.qi2025.published import PRINTED_SECONDS, SearchAlgorithm
from seatrial_studies.qi2025.reproduction import FIGURE_HEADING, ITERATIONS, SearchSetting
from seatrial_studies.swarm_search import STEP

# s, end of the figures' time axis
FIGURE_END_S = 200.0


def claims(evidence: WildHorseEvidence) -> tuple[Claim, ...]:
    """What is said of the way it is done."""
    return (
        hold_claim(evidence),
        one_sample_claim(evidence),
        pitch_unit_claim(evidence),
        computing_time_claim(evidence),
        real_time_claim(evidence),
        convergence_claim(evidence),
    )


def hold_claim(evidence: WildHorseEvidence) -> Claim:
    """Refuted where holding costs more than ten times what a continuous force does."""
    held, sampled = (
        [100.0 * float(np.mean(np.abs(getattr(b, name)))) for b in evidence.hold_bias.values()]
        for name in ("held", "sampled")
    )
    return Claim(
        "A zero-order hold before the continuous variables discretises the whole system (eq. 8)",
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
        f"a run at 90° ends with a fitness of {left.best_fitness[-1]:.1e} and coefficients {off:.0f} % off; mean over "
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
    """Refuted where PSO does not take twice as long on one simulator."""
    printed = float(
        np.mean([PRINTED_SECONDS[h][SearchAlgorithm.PSO] / PRINTED_SECONDS[h][SearchAlgorithm.WHO] for h in HEADINGS])
    )
    times = {a: evidence.search_seconds(a) for a in SearchAlgorithm}
    return Claim(
        "PSO takes eight times as long as WHO and IWHO",
        Verdict.REFUTED if times[SearchAlgorithm.PSO] < 2.0 * times[SearchAlgorithm.WHO] else Verdict.UNKNOWABLE,
        f"table 5 has {printed:.1f}; on one simulator PSO, WHO and IWHO take "
        f"{', '.join(f'{1e3 * t:.0f}' for t in times.values())} ms, judging as many candidates",
    )


def real_time_claim(evidence: WildHorseEvidence) -> Claim:
    """Confirmed where a run takes less than the record it is made on."""
    seconds, record = evidence.search_seconds(SearchAlgorithm.IWHO), ITERATIONS * STEP
    return Claim(
        "The method is real-time",
        Verdict.CONFIRMED if seconds < record else Verdict.REFUTED,
        f"{ITERATIONS} iterations, {record:.0f} s of samples, take {1e3 * seconds:.0f} ms here; our fit of the whole "
        f"record takes {1e3 * evidence.output_error_seconds:.1f} ms. What is in time is not thereby right",
    )


def convergence_claim(evidence: WildHorseEvidence) -> Claim:
    """Undecidable: the figures run on after the last iteration."""
    found = evidence.reproduction.searches[SearchSetting.PAPER, FIGURE_HEADING, SearchAlgorithm.IWHO]
    errors = 100.0 * np.abs(found.trace / found.truth - 1.0)
    at = {t: errors[min(round(t / STEP), len(errors)) - 1] for t in (50.0, 100.0)}
    return Claim(
        "Parameters converge by 50 s, and are the theoretical values from 100 s on (figures 8 to 11)",
        Verdict.UNKNOWABLE,
        f"{ITERATIONS} iterations of {STEP} s end at {ITERATIONS * STEP:.0f} s, while the figures run for "
        f"{FIGURE_END_S:.0f} s: what the search does after its last iteration is not said. Here (first run at 45°, "
        f"coefficients of 90° assumed) the errors are up to {at[50.0].max():.1f} % at 50 s and "
        f"{at[100.0].max():.1f} % at 100 s",
    )
