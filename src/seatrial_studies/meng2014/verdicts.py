"""Claims of the paper with their evidence, and checks of our own numbers."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seatrial.core.results import Check, Claim, Verdict
from seatrial.core.values import Array
from seatrial.physics.models import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial_studies.meng2014.reproduction import HEADINGS, BoxPlacement, CloudSwarmReproduction, SwarmAlgorithm
from seatrial_studies.output_error_fit import OutputErrorResults
from seatrial_studies.seaway import HEAVE_NOISE, PITCH_NOISE

# relative curvature below which a direction is lost in rounding
SINGULAR_CURVATURE = 1e-11
MOST_SHARE = 0.5
# runs of one swarm stuck and not of the other in the same sea and box: fewer may be chance (sign test, 5 %)
SIGN_TEST_RUNS = 5
LEAST_TIME_RATIO = 50.0


@dataclass(frozen=True, eq=False)
class UndetectedChange:
    """Wrong coefficients that follow the record: relative changes (8,), rms of heave [m] and of pitch [deg]."""

    relative_change: Array
    heave_rms: float
    pitch_rms: float


@dataclass(frozen=True, eq=False)
class CloudSwarmEvidence:
    """All numbers of the study; `twelve`: flattest curvature of the twelve unknowns by what moves the ship."""

    reproduction: CloudSwarmReproduction
    output_error: dict[int, OutputErrorResults]
    twelve_unknowns: dict[str, float]
    undetected_change: UndetectedChange

    def mean_error(self, setting: BoxPlacement, algorithm: SwarmAlgorithm, heading: int) -> float:
        """Return the mean relative error over coefficients and runs, per cent."""
        return 100.0 * float(np.mean(self.reproduction.searches[setting, heading, algorithm].mean_error))

    def mean_error_text(self, setting: BoxPlacement, algorithm: SwarmAlgorithm) -> str:
        """At all headings."""
        return "/".join(f"{self.mean_error(setting, algorithm, h):.1f}" for h in HEADINGS) + " %"

    @property
    def output_error_ratio(self) -> float:
        """Return the root mean square of our errors in noise over their Cramer-Rao bound, all headings."""
        return float(np.sqrt(np.mean([self.output_error[h].error_over_bound ** 2 for h in HEADINGS])))

    @property
    def swarm_ratio(self) -> float:
        """Return the same of ICPSO's errors off centre."""
        found = [
            (
                self.reproduction.searches[BoxPlacement.OFF_CENTRE, h, SwarmAlgorithm.ICPSO].errors,
                self.output_error[h].cramer_rao_bound,
            )
            for h in HEADINGS
        ]
        return float(np.sqrt(np.mean([(errors / bound) ** 2 for errors, bound in found])))

    @property
    def time_ratio(self) -> float:
        """Time of a run of ICPSO over that of our noise-free fit, mean over the headings."""
        swarm = [self.reproduction.searches[BoxPlacement.OFF_CENTRE, h, SwarmAlgorithm.ICPSO].seconds for h in HEADINGS]
        return float(np.mean(swarm) / np.mean([self.output_error[h].seconds for h in HEADINGS]))

    def output_error_percent(self, heading: int) -> float:
        """Ours with the same noise, per cent."""
        return 100.0 * float(np.mean(np.abs(self.output_error[heading].noisy_errors)))


def _error_shares(evidence: CloudSwarmEvidence, setting: BoxPlacement) -> tuple[float, float]:
    """Shares of ICPSO's values within 5 % and beyond 10 %."""
    errors = np.abs([evidence.reproduction.searches[setting, h, SwarmAlgorithm.ICPSO].errors for h in HEADINGS])
    return float(np.mean(errors <= 0.05)), float(np.mean(errors > 0.1))


def _noise_allowance(evidence: CloudSwarmEvidence) -> float:
    """What noise excuses: a sum of squares of n residuals larger by one variance, a root mean square by 1 / (2 n)."""
    return 0.5 / evidence.reproduction.seas[HEADINGS[0]][0].measured.size


def _converged_prematurely(evidence: CloudSwarmEvidence, algorithm: SwarmAlgorithm) -> NDArray[np.bool_]:
    """Runs off centre that end above the better fitness of both by more than noise excuses, (headings, runs)."""
    return np.array([evidence.reproduction.excess_fitness(h, algorithm) > _noise_allowance(evidence) for h in HEADINGS])


def _premature_convergence_verdict(cloud: NDArray[np.bool_], plain: NDArray[np.bool_]) -> Verdict:
    """Whether the cloud helps, by the runs where just one of the two is stuck."""
    only_plain, only_cloud = int(np.sum(plain & ~cloud)), int(np.sum(cloud & ~plain))
    if only_plain - only_cloud >= SIGN_TEST_RUNS:
        return Verdict.CONFIRMED
    if only_cloud - only_plain >= SIGN_TEST_RUNS:
        return Verdict.REFUTED
    return Verdict.UNKNOWABLE


def _error_by_iterations(evidence: CloudSwarmEvidence) -> dict[int, float]:
    """Mean error of ICPSO off centre over the headings, per cent, by its iterations."""
    made = evidence.reproduction
    numbers = sorted({few for few, _ in made.shorter_searches})
    known = {n: 100.0 * float(np.mean([made.shorter_searches[n, h].mean_error for h in HEADINGS])) for n in numbers}
    whole = [evidence.mean_error(BoxPlacement.OFF_CENTRE, SwarmAlgorithm.ICPSO, h) for h in HEADINGS]
    return known | {made.iterations: float(np.mean(whole))}


def claims(evidence: CloudSwarmEvidence) -> tuple[Claim, ...]:
    """Return the claims, each with its evidence."""
    return (
        error_range_claim(evidence),
        premature_convergence_claim(evidence),
        iterations_claim(evidence),
        twelve_unknowns_claim(evidence),
        velocity_law_claim(evidence),
        coinciding_curves_claim(evidence),
        theory_as_truth_claim(),
    )


def error_range_claim(evidence: CloudSwarmEvidence) -> Claim:
    """Undecidable: the table is lost; the evidence is ours."""
    narrow, wide = _error_shares(evidence, BoxPlacement.CENTRED), _error_shares(evidence, BoxPlacement.OFF_CENTRE)
    return Claim(
        "Errors are mostly within 5 %, some about 10 % (table 1)",
        Verdict.UNKNOWABLE,
        "table 1 is lost in the text at hand, the search box is not printed. Here, in a box of ±10 % about the truth "
        f"{100 * narrow[0]:.0f} % of the values are within 5 % and none can be beyond 10; in one of ±50 % off centre "
        f"{100 * wide[0]:.0f} % are, and {100 * wide[1]:.0f} % are beyond 10 %",
    )


def premature_convergence_claim(evidence: CloudSwarmEvidence) -> Claim:
    """By the runs where just one of the two swarms is stuck."""
    own, plain = (_converged_prematurely(evidence, a) for a in SwarmAlgorithm)
    return Claim(
        "The cloud keeps the swarm from converging too early",
        _premature_convergence_verdict(own, plain),
        f"mean error off centre at 0/45/90/135/180°: ICPSO "
        f"{evidence.mean_error_text(BoxPlacement.OFF_CENTRE, SwarmAlgorithm.ICPSO)}, plain "
        f"PSO with a constant inertia "
        f"{evidence.mean_error_text(BoxPlacement.OFF_CENTRE, SwarmAlgorithm.PSO)}; runs stuck above the better "
        f"fitness of the two: {own.sum()} and {plain.sum()} of {plain.size}; {SIGN_TEST_RUNS} more of one "
        "than of the other "
        "would decide. Against CPSO, its parent, it cannot be judged",
    )


def iterations_claim(evidence: CloudSwarmEvidence) -> Claim:
    """Confirmed where the last iterations take 5 % off the error."""
    lengths = _error_by_iterations(evidence)
    before, last = list(lengths.values())[-2:]
    floor = float(np.mean([evidence.output_error_percent(h) for h in HEADINGS]))
    return Claim(
        "More iterations may reduce the error further",
        Verdict.CONFIRMED if last < 0.95 * before else Verdict.REFUTED,
        f"mean error off centre after {', '.join(f'{n}: {value:.2f} %' for n, value in lengths.items())} iterations; "
        f"what noise leaves to our fit of the same records: {floor:.2f} %",
    )


def twelve_unknowns_claim(evidence: CloudSwarmEvidence) -> Claim:
    """Refuted where either input alone leaves a direction open."""
    beam, fin, both = (
        evidence.twelve_unknowns[name] for name in ("beam waves alone", "one fin alone", "waves and fin")
    )
    return Claim(
        "Twelve parameters are to be identified",
        Verdict.REFUTED if max(beam, fin) < SINGULAR_CURVATURE else Verdict.UNKNOWABLE,
        "eight are, the stiffnesses being taken from theory. Beam waves alone could not identify twelve (flattest "
        f"direction {beam:.0e} of the steepest), nor could one fin alone ({fin:.0e}); waves and fin together could "
        f"({both:.0e})",
    )


def velocity_law_claim(evidence: CloudSwarmEvidence) -> Claim:
    """Refuted where most runs by the law as printed end above the least fitness."""
    stuck = np.array(
        [evidence.reproduction.unweighted_excess_fitness(h) > _noise_allowance(evidence) for h in HEADINGS]
    )
    printed = [100.0 * float(np.mean(evidence.reproduction.unweighted_searches[h].mean_error)) for h in HEADINGS]
    return Claim(
        "The velocity law is eq. (4)",
        Verdict.REFUTED if np.mean(stuck) > 0.5 else Verdict.UNKNOWABLE,
        "it has no inertia weight, while eq. (6) adjusts one. As printed, with c1 = c2 = 2.05, velocities do not die "
        f"out: {stuck.sum()} of {stuck.size} runs end above the least fitness, the mean error off centre is "
        f"{'/'.join(f'{p:.1f}' for p in printed)} %, with the weight "
        f"{evidence.mean_error_text(BoxPlacement.OFF_CENTRE, SwarmAlgorithm.ICPSO)}. Eq. (6) itself is "
        "lost; assumed is the form of Wei et "
        "al. 2009. Its parent CPSO is left out: no source at hand prints its law",
    )


def coinciding_curves_claim(evidence: CloudSwarmEvidence) -> Claim:
    """Refuted where coefficients more than 10 % off follow the record within its noise."""
    wrong = 100.0 * np.abs(evidence.undetected_change.relative_change)
    worst = COEFFICIENTS[int(np.argmax(wrong))]
    heave, pitch = evidence.undetected_change.heave_rms, evidence.undetected_change.pitch_rms
    hidden = wrong.max() > 10.0 and heave <= HEAVE_NOISE and pitch <= np.degrees(PITCH_NOISE)
    return Claim(
        "Curves that coincide (figures 2, 3) show that the dynamics are described accurately",
        Verdict.REFUTED if hidden else Verdict.UNKNOWABLE,
        f"coefficients up to {wrong.max():.0f} % off ({worst}) follow the record at 135° within {100 * heave:.1f} cm "
        f"and {pitch:.3f}° rms; the noise is {100 * HEAVE_NOISE:.0f} cm and {np.degrees(PITCH_NOISE):.2f}°",
    )


def theory_as_truth_claim() -> Claim:
    """Undecidable: nothing is printed."""
    return Claim(
        "Theoretical values at 0, 45, 90, 135 and 180° serve as truth",
        Verdict.UNKNOWABLE,
        "they are not printed; assumed are those of Qi et al. 2025, which has none at 0 and 45°: there those of 90°. "
        "The table 'Assumed' lists what else is",
    )


def checks(evidence: CloudSwarmEvidence) -> tuple[Check, ...]:
    """Ours; each can fail. Both estimates are near the noise: at one heading, few runs order them by chance."""
    ours, swarm = evidence.output_error_ratio, evidence.swarm_ratio
    made = [
        Check("our errors over the Cramer-Rao bound", ours, "0.7 to 1.3", 0.7 <= ours <= 1.3),
        Check("the same, not above ICPSO's off centre", ours, swarm, ours <= swarm),
    ]
    exact = max(float(np.max(np.abs(o.noise_free_errors))) for o in evidence.output_error.values())
    made.append(Check("our largest relative error, noise-free", exact, 1e-9, exact <= 1e-9))
    for what in ("beam waves alone", "one fin alone"):
        flat = evidence.twelve_unknowns[what]
        made.append(
            Check(f"flattest direction of twelve unknowns, {what}", flat, SINGULAR_CURVATURE, flat < SINGULAR_CURVATURE)
        )
    share = _error_shares(evidence, BoxPlacement.CENTRED)[0]
    name = "ICPSO's values within 5 %, ±10 % about the truth, share"
    faster = evidence.time_ratio
    return (
        *made,
        Check(name, share, f"above {MOST_SHARE}", share > MOST_SHARE),
        Check("ICPSO's time over ours", faster, f"at least {LEAST_TIME_RATIO:g}", faster >= LEAST_TIME_RATIO),
    )
