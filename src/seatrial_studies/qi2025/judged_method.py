"""Claims of the method: hold, one-sample fitness, time; each verdict by a rule on numbers."""

import numpy as np

from seatrial.core.results import Claim, Verdict
from seatrial.physics.models.heave_pitch import COEFFICIENTS
from seatrial.physics.models.qi2025 import HEADINGS
from seatrial_studies.qi2025.evidence import Evidence, per_cent
from seatrial_studies.qi2025.published import SECONDS, Algorithm
from seatrial_studies.qi2025.repetition import ITERATIONS, SHOWN, Setting
from seatrial_studies.swarm_search import STEP

SHOWN_UNTIL = 200.0


def claims(seen: Evidence) -> tuple[Claim, ...]:
    """What is said of the way it is done."""
    return (hold(seen), one_sample(seen), unit(seen), eight_times(seen), in_time(seen), converged(seen))


def hold(seen: Evidence) -> Claim:
    """Refuted where holding costs more than ten times what a continuous force does."""
    held, sampled = (
        [100.0 * float(np.mean(np.abs(getattr(b, name)))) for b in seen.bias.values()] for name in ("held", "sampled")
    )
    return Claim(
        "A zero-order hold before the continuous variables discretises the whole system (eq. 8)",
        Verdict.REFUTED if min(held) > 10.0 * max(sampled) else Verdict.UNKNOWABLE,
        f"wave force is continuous: fitting motions every .5 s with a held force costs {per_cent(held)} mean error "
        f"without any noise; taken as continuous between the same samples {per_cent(sampled)}. The paper does not see "
        "it because its data are made with the same hold",
    )


def one_sample(seen: Evidence) -> Claim:
    """Refuted where a sample leaves directions open and searches by samples end far off."""
    rank, wide = seen.audited.step_rank, seen.single(Setting.OFF_CENTRE, Algorithm.IWHO)
    left = seen.made.searches[Setting.OFF_CENTRE, HEADINGS[0], Algorithm.IWHO]
    off = 100.0 * float(np.mean(np.abs(left.errors[0])))
    return Claim(
        "The smaller the fitness of eq. (28), the more accurate the parameters",
        Verdict.REFUTED if rank < len(COEFFICIENTS) and min(wide) > 1.0 else Verdict.UNKNOWABLE,
        f"one step of two motions tells {rank} of {len(COEFFICIENTS)} directions. In a box of ±50 % off centre "
        f"a run at 90° ends with a fitness of {left.history[-1]:.1e} and coefficients {off:.0f} % off; mean over "
        f"runs {per_cent(wide)}",
    )


def unit(seen: Evidence) -> Claim:
    """Not to be told: the print does not say."""
    told = "; ".join(
        f"{a} {per_cent(seen.single(Setting.PAPER, a))} in rad, {per_cent(seen.single(Setting.DEGREES, a))} in degrees"
        for a in Algorithm
    )
    return Claim(
        "Heave and pitch can be added as eq. (28) does",
        Verdict.UNKNOWABLE,
        "metres and an angle are added and the angle's unit is not printed; mean errors of single runs in the box "
        f"about the truth: {told}",
    )


def eight_times(seen: Evidence) -> Claim:
    """Refuted where PSO does not take twice as long on one simulator."""
    printed = float(np.mean([SECONDS[h][Algorithm.PSO] / SECONDS[h][Algorithm.WHO] for h in HEADINGS]))
    times = {a: seen.seconds(a) for a in Algorithm}
    return Claim(
        "PSO takes eight times as long as WHO and IWHO",
        Verdict.REFUTED if times[Algorithm.PSO] < 2.0 * times[Algorithm.WHO] else Verdict.UNKNOWABLE,
        f"table 5 has {printed:.1f}; on one simulator PSO, WHO and IWHO take "
        f"{', '.join(f'{1e3 * t:.0f}' for t in times.values())} ms, judging as many candidates",
    )


def in_time(seen: Evidence) -> Claim:
    """Confirmed where a run takes less than the record it is made on."""
    seconds, record = seen.seconds(Algorithm.IWHO), ITERATIONS * STEP
    return Claim(
        "The method is real-time",
        Verdict.CONFIRMED if seconds < record else Verdict.REFUTED,
        f"{ITERATIONS} iterations, {record:.0f} s of samples, take {1e3 * seconds:.0f} ms here; our fit of the whole "
        f"record takes {1e3 * seen.own_seconds:.1f} ms. What is in time is not thereby right",
    )


def converged(seen: Evidence) -> Claim:
    """Not to be told: the figures run on after the last iteration."""
    found = seen.made.searches[Setting.PAPER, SHOWN, Algorithm.IWHO]
    errors = 100.0 * np.abs(found.trace / found.truth - 1.0)
    at = {t: errors[min(round(t / STEP), len(errors)) - 1] for t in (50.0, 100.0)}
    return Claim(
        "Parameters converge by 50 s, and are the theoretical values from 100 s on (figures 8 to 11)",
        Verdict.UNKNOWABLE,
        f"{ITERATIONS} iterations of {STEP} s end at {ITERATIONS * STEP:.0f} s, while the figures run for "
        f"{SHOWN_UNTIL:.0f} s: what the search does after its last iteration is not said. Here (first run at 45°, "
        f"coefficients of 90° assumed) the errors are up to {at[50.0].max():.1f} % at 50 s and "
        f"{at[100.0].max():.1f} % at 100 s",
    )
