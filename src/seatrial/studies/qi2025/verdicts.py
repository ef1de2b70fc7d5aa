"""Claims of the paper with their evidence, and checks of our own numbers."""

import numpy as np

from seatrial.models.qi2025 import HEADINGS, SPEED
from seatrial.results import Check, Claim, Verdict
from seatrial.studies.own_fit import Ours
from seatrial.studies.qi2025.audit import Audit
from seatrial.studies.qi2025.published import FIGURES_1_2, FIGURES_6_7, SECONDS, Algorithm, misprinted, printed_error
from seatrial.studies.qi2025.repetition import Repetition, Setting
from seatrial.studies.qi2025.tables import mean_recomputed
from seatrial.values import Array

NEAR = 0.005
GUESS = 5.0


def per_cent(values: list[float]) -> str:
    """Numbers at the three headings."""
    return "/".join(f"{v:.2f}" for v in values) + " %"


def of_setting(made: Repetition, setting: Setting, algorithm: Algorithm, *, of_mean: bool) -> list[float]:
    """Mean error over the coefficients at each heading, per cent: of the mean of the runs, or of single runs."""
    found = [made.searches[setting, h, algorithm] for h in HEADINGS]
    return [100.0 * float(np.mean(f.error_of_mean if of_mean else f.mean_error)) for f in found]


def at_lower(made: Repetition, setting: Setting, algorithm: Algorithm) -> float:
    """Share of all found values that lie on the lower bound."""
    found = [made.searches[setting, h, algorithm] for h in HEADINGS]
    return float(np.mean([np.abs(f.points / f.lower - 1.0) < NEAR for f in found]))


def claims(
    made: Repetition, audited: Audit, own: dict[int, Ours], bias: dict[int, tuple[Array, Array]]
) -> tuple[Claim, ...]:
    """Each with what it rests on."""
    return (*_of_accuracy(made), *_of_print(audited), *_of_method(made, own, bias))


def _of_accuracy(made: Repetition) -> list[Claim]:
    printed = [mean_recomputed(h, Algorithm.IWHO) for h in HEADINGS]
    narrow = of_setting(made, Setting.PAPER, Algorithm.IWHO, of_mean=True)
    single = of_setting(made, Setting.PAPER, Algorithm.IWHO, of_mean=False)
    wide = of_setting(made, Setting.OFF_CENTRE, Algorithm.IWHO, of_mean=False)
    who = of_setting(made, Setting.PAPER, Algorithm.WHO, of_mean=True)
    whole = {a: of_setting(made, Setting.WHOLE_OFF_CENTRE, a, of_mean=False) for a in Algorithm}
    better = sum(w < i for w, i in zip(whole[Algorithm.WHO], whole[Algorithm.IWHO], strict=True))
    return [
        Claim("IWHO identifies with errors of about 1 %", Verdict.REFUTED,
              f"the tables print the error of the mean of ten runs ({per_cent(printed)} at 90/135/180 deg). Here, in "
              f"a box "
              f"of +-10 % centred on the truth, it is {per_cent(narrow)}, a single run is {per_cent(single)} off; in a "
              f"box of +-50 % whose centre is not the truth {per_cent(wide)}. A random guess in the +-10 % box has 5 "
              f"%"),
        Claim("IWHO is far more accurate than WHO", Verdict.REFUTED,
              f"only with one sample an iteration and a box about the truth (WHO {per_cent(who)}, IWHO "
              f"{per_cent(narrow)}, "
              f"error of the mean); with the whole record and an off-centre box WHO is the better one at {better} of 3 "
              f"headings (WHO {per_cent(whole[Algorithm.WHO])}, IWHO {per_cent(whole[Algorithm.IWHO])})"),
        Claim("PSO's errors reach 60 %, far beyond what engineering allows", Verdict.REFUTED,
              f"with the whole record, the box off centre, PSO's mean error is {per_cent(whole[Algorithm.PSO])}, the "
              "smallest of the three; its omega, c1, c2 are not printed, ours are the constriction's"),
    ]  # fmt: skip


def _of_print(audited: Audit) -> list[Claim]:
    right = ", ".join(f"{audited.speeds[h][0]:.3f}" for h in HEADINGS)
    wrong = ", ".join(f"{audited.speeds[h][1]:.2f}" for h in HEADINGS)
    effects = [100.0 * e for pair in audited.sign_effect.values() for e in pair]
    hit, total = audited.saturated
    heave, pitch = audited.extremes
    return [
        Claim("b53 is positive, as tables 2 to 4 print it", Verdict.REFUTED,
              f"strip theory makes (b35 + |b53|) / (2 a33) the speed if b53 is negative: {right} m/s, the paper's 18 "
              f"kn "
              f"being {SPEED:.3f}; with the printed sign it is {wrong} m/s. The sign changes the motions by "
              f"{min(effects):.0f} to {max(effects):.0f} % rms"),
        Claim("The printed relative errors follow from the printed values", Verdict.REFUTED,
              f"{len(misprinted())} of 72 do not, see the table"),
        Claim("WHO's estimates came out of a free search", Verdict.REFUTED,
              f"{hit} of its {total} values at 90 and 135 deg lie between -10 and -9.3 % of the truth: clipped at the "
              "lower end of a box of +-10 % about the truth. The box is not printed"),
        Claim("At 45 deg the ship heaves within .3 m and pitches within .3 deg (figures 1, 2)", Verdict.UNKNOWABLE,
              f"figures 6 and 7 show {FIGURES_6_7[0]} m and {FIGURES_6_7[1]} deg of the same condition, figures 1 and "
              f"2 "
              f"{FIGURES_1_2[0]} m and {FIGURES_1_2[1]} deg: they contradict one another. Force coefficients and the "
              f"coefficients at 45 deg are not printed; with the closed form and those of 90 deg (assumed) "
              f"{heave:.2f} m and "
              f"{pitch:.1f} deg are reached. A ship following .3 m waves of this sea would pitch "
              f"{audited.kinematic:.2f} deg"),
        Claim("The fitness falls, rebounding at iterations 50 and 150 (figure 5)", Verdict.REFUTED,
              "a best-so-far cannot rise; the curve is the error at the sample of each iteration (eq. 28), which "
              "grows where "
              "the motions are large: it measures the sea, not the search"),
        Claim("The sea is the two-parameter ITTC spectrum with B = 3.11 / h^3", Verdict.REFUTED,
              "it is the one-parameter form, and only h^2 gives the stated significant height (2.27 m)"),
    ]  # fmt: skip


def _of_method(made: Repetition, own: dict[int, Ours], bias: dict[int, tuple[Array, Array]]) -> list[Claim]:
    held = [100.0 * float(np.mean(np.abs(h))) for h, _ in bias.values()]
    rad = of_setting(made, Setting.PAPER, Algorithm.IWHO, of_mean=False)
    deg = of_setting(made, Setting.DEGREES, Algorithm.IWHO, of_mean=False)
    times = {a: np.mean([made.searches[Setting.PAPER, h, a].seconds for h in HEADINGS]) for a in Algorithm}
    printed = np.mean([SECONDS[h][Algorithm.PSO] / SECONDS[h][Algorithm.WHO] for h in HEADINGS])
    fit = float(np.mean([o.seconds for o in own.values()]))
    return [
        Claim("A zero-order hold before the continuous variables discretises the whole system (eq. 8)", Verdict.REFUTED,
              f"wave force is continuous: fitting motions every .5 s with a held force costs {per_cent(held)} mean "
              f"error "
              "without any noise; the paper does not see it because its data are made with the same hold"),
        Claim("One sample judges a candidate (eq. 28)", Verdict.REFUTED,
              "it has 2 residuals for 8 unknowns; results depend on the unit in which pitch enters, which is not "
              "printed: "
              f"IWHO's mean error is {per_cent(rad)} in rad, {per_cent(deg)} in degrees"),
        Claim("PSO takes eight times as long as WHO and IWHO", Verdict.REFUTED,
              f"table 5 has {printed:.1f}; on one simulator PSO, WHO and IWHO take {1e3 * times[Algorithm.PSO]:.0f}, "
              f"{1e3 * times[Algorithm.WHO]:.0f} and {1e3 * times[Algorithm.IWHO]:.0f} ms"),
        Claim("The method is real-time", Verdict.CONFIRMED,
              f"200 iterations, the paper's 100 s of samples, take {1e3 * times[Algorithm.IWHO]:.0f} ms here; our fit "
              f"of the "
              f"whole record takes {1e3 * fit:.1f} ms. What is in time is not thereby right"),
        Claim("The parameters converge within 100 s", Verdict.UNKNOWABLE,
              "200 iterations of .5 s are 100 s, while figures run for 200 s; what the search does after its last "
              "iteration "
              "is not said"),
    ]  # fmt: skip


def _below(errors: Array, heading: int) -> int:
    """Coefficients whose mean error (runs, 8) is below IWHO's printed one."""
    return int(np.sum(100.0 * np.mean(np.abs(errors), axis=0) < printed_error(heading, Algorithm.IWHO)))


def checks(made: Repetition, own: dict[int, Ours]) -> tuple[Check, ...]:
    """Ours; each can fail."""
    found = []
    for h, value in zip(HEADINGS, of_setting(made, Setting.PAPER, Algorithm.IWHO, of_mean=True), strict=True):
        limit = 3.0 * {90: 0.20, 135: 0.16, 180: 0.28}[h]
        found.append(Check(f"IWHO's error of the mean of runs at {h} deg, %", value, limit, value <= limit))
    share = at_lower(made, Setting.PAPER, Algorithm.WHO)
    found.append(Check("WHO's values on the lower bound, share", share, ">= 0.1", share >= 0.1))
    below, noisy = (sum(_below(e, h) for h, e in pairs.items()) for pairs in (
        {h: own[h].exact for h in HEADINGS}, {h: own[h].noisy for h in HEADINGS}))  # fmt: skip
    found.append(Check("ours below IWHO's printed errors, noise-free, of 24", below, ">= 24", below >= 24))
    found.append(Check("the same in 1 cm / .02 deg of noise, of 24", noisy, "reported", noisy >= 0))
    largest = max(float(np.max(np.abs(o.exact))) for o in own.values())
    found.append(Check("our largest relative error, noise-free", largest, 1e-9, largest <= 1e-9))
    iwho = np.mean([made.searches[Setting.PAPER, h, Algorithm.IWHO].seconds for h in HEADINGS])
    ratio = float(iwho / np.mean([o.seconds for o in own.values()]))
    found.append(Check("IWHO's time over ours", ratio, ">= 50", ratio >= 50))
    size = float(np.sqrt(np.mean([own[h].ratio ** 2 for h in HEADINGS])))
    found.append(Check("our errors in noise over the Cramer-Rao bound", size, "0.7 to 1.3", 0.7 <= size <= 1.3))
    return tuple(found)
