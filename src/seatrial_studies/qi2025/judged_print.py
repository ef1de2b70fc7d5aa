"""Claims that the paper's own numbers can be held against, each verdict by a rule."""

import numpy as np

from seatrial.core.results import Claim, Verdict
from seatrial.physics.models.qi2025 import HEADINGS, SIGNIFICANT_HEIGHT, SPEED
from seatrial_studies.qi2025.evidence import Evidence, per_cent
from seatrial_studies.qi2025.published import (
    FIGURE_5_TOP,
    FIGURES_1_2,
    FIGURES_6_7,
    PRINTED,
    REBOUNDS,
    Algorithm,
    misprinted,
)
from seatrial_studies.qi2025.repetition import SHOWN, Setting


def claims(seen: Evidence) -> tuple[Claim, ...]:
    """Tables, figures, formulas."""
    return (sign(seen), recomputed(), free_search(seen), motions(seen), rebounds(seen), spectrum(seen))


def sign(seen: Evidence) -> Claim:
    """Refuted where strip theory meets the paper's speed with a negative b53 only."""
    speeds, effects = seen.audited.speeds, [100.0 * e for pair in seen.audited.sign_effect.values() for e in pair]
    is_negative = all(abs(right - SPEED) < 0.02 < abs(wrong - SPEED) for right, wrong in speeds.values())
    right, wrong = (", ".join(f"{speeds[h][j]:.{3 - j}f}" for h in HEADINGS) for j in (0, 1))
    return Claim(
        "b53 is positive, as tables 2 to 4 print it",
        Verdict.REFUTED if is_negative else Verdict.UNKNOWABLE,
        f"strip theory makes (b35 + |b53|) / (2 a33) the speed if b53 is negative: {right} m/s, the paper's 18 kn "
        f"being {SPEED:.3f}; with the printed sign it is {wrong} m/s. The sign changes the motions by "
        f"{min(effects):.0f} to {max(effects):.0f} % rms",
    )


def recomputed() -> Claim:
    """Confirmed where all follow."""
    wrong = misprinted()
    return Claim(
        "The printed relative errors follow from the printed values",
        Verdict.REFUTED if wrong else Verdict.CONFIRMED,
        f"{len(wrong)} of {PRINTED} do not; the largest difference is "
        f"{max((abs(a - b) for *_, a, b in wrong), default=0.0):.2f} points, see the table",
    )


def free_search(seen: Evidence) -> Claim:
    """Refuted where most of WHO's values lie at the end of a box about the truth."""
    hit, total = seen.audited.saturated
    true, own = (seen.saturated_means(s) for s in (Setting.PAPER, Setting.CARRIED))
    who = per_cent(seen.of_mean(Setting.CARRIED, Algorithm.WHO))
    return Claim(
        "WHO's estimates came out of a search that did not know the truth",
        Verdict.REFUTED if hit > total / 2 else Verdict.UNKNOWABLE,
        f"{hit} of its {total} values at 90 and 135° lie between -10 and -9.3 % of the truth: clipped at the "
        "lower end of a box of ±10 % about the truth, which is not printed. Here its runs have "
        f"{100 * seen.at_lower(Setting.PAPER, Algorithm.WHO):.0f} % of their values on that bound if candidates step "
        f"from the true state, {100 * seen.at_lower(Setting.CARRIED, Algorithm.WHO):.0f} % if from the identified "
        f"model's own (error of the mean {who}); of {total} means of ten, {true} and {own} are as far out as those "
        "printed",
    )


def motions(seen: Evidence) -> Claim:
    """Not to be told where the paper's figures of one condition contradict one another."""
    heave, pitch = seen.audited.extremes
    contradict = FIGURES_1_2 != FIGURES_6_7
    return Claim(
        "At 45° the ship heaves within .3 m and pitches within .3° (figures 1, 2)",
        Verdict.UNKNOWABLE if contradict or heave > FIGURES_1_2[0] else Verdict.CONFIRMED,
        f"figures 6 and 7 show {FIGURES_6_7[0]} m and {FIGURES_6_7[1]}° of the same condition: they contradict "
        "figures 1 and 2. Force coefficients and the coefficients at 45° are not printed; with the closed form "
        f"and those of 90°, assumed, {heave:.2f} m and {pitch:.1f}° are reached. A ship that follows waves of "
        f".3 m at the modal frequency pitches {seen.audited.kinematic:.2f}°",
    )


def rebounds(seen: Evidence) -> Claim:
    """Refuted where the best of a remembered fitness never rises and that of a fitness of one sample does."""
    rises = {s: _rises(seen, s) for s in (Setting.REMEMBERED, Setting.CARRIED, Setting.DEGREES)}
    steps = len(seen.made.searches[Setting.CARRIED, SHOWN, Algorithm.IWHO].history) - 1
    top = {s: _top(seen, s) for s in (Setting.DEGREES, Setting.CARRIED)}
    refuted = rises[Setting.REMEMBERED] == 0 < rises[Setting.CARRIED]
    return Claim(
        f"The best fitness falls, but rebounds at iterations {REBOUNDS[0]} and {REBOUNDS[1]} (figure 5)",
        Verdict.REFUTED if refuted else Verdict.UNKNOWABLE,
        f"the best so far cannot rise: remembered, it rises {rises[Setting.REMEMBERED]} times in {steps} iterations. "
        f"Judged by a sample of each iteration's own it rises {rises[Setting.DEGREES]} times from the true state, "
        f"{rises[Setting.CARRIED]} times from the identified model's: the curve is the error at a sample, no measure "
        f"of the search. After iteration 20 the largest is {top[Setting.DEGREES]:.5f} and {top[Setting.CARRIED]:.4f}; "
        f"the paper's axis ends at {FIGURE_5_TOP}, so its candidates hardly stepped from the true state (45°, "
        "coefficients of 90° assumed, pitch in degrees)",
    )


def spectrum(seen: Evidence) -> Claim:
    """Refuted where the printed exponent misses the stated height by more than 1 %."""
    printed, mended = seen.audited.heights
    return Claim(
        "The sea is the two-parameter ITTC spectrum with B = 3.11 / h\u00b3 (eq. 13)",
        Verdict.REFUTED if abs(printed / SIGNIFICANT_HEIGHT - 1.0) > 0.01 else Verdict.CONFIRMED,
        f"it has one parameter, and its significant height is {printed:.2f} m for the stated {SIGNIFICANT_HEIGHT} m; "
        f"with h\u00b2 it is {mended:.2f} m",
    )


def _rises(seen: Evidence, setting: Setting) -> int:
    return int(np.sum(np.diff(seen.made.searches[setting, SHOWN, Algorithm.IWHO].history) > 0.0))


def _top(seen: Evidence, setting: Setting) -> float:
    return float(seen.made.searches[setting, SHOWN, Algorithm.IWHO].history[20:].max())
