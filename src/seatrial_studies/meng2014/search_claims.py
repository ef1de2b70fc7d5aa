"""Claims of accuracy and speed of the swarms, each verdict by a rule on the numbers of the searches."""

import numpy as np
from numpy.typing import NDArray

from seatrial.core.results import Claim, Verdict
from seatrial.core.values import Array
from seatrial.numerics.optimise import CloudSettings
from seatrial_studies.meng2014.evidence import CloudSwarmEvidence, error_text
from seatrial_studies.meng2014.reproduction import HEADINGS, BoxPlacement, CloudVariant, SwarmAlgorithm
from seatrial_studies.sign_test import is_smaller

# runs of one swarm stuck and not of the other in the same sea and box: fewer may be chance (sign test, 5 %)
SIGN_TEST_RUNS = 5
# share of an error that further iterations must take off; our choice
NOTABLE_SHARE = 0.05
# share of the range of the weight that its middle band must use to be called adaptive; our choice
ADAPTIVE_SHARE = 0.25


def claims(evidence: CloudSwarmEvidence) -> tuple[Claim, ...]:
    """What the paper says of its swarm."""
    return (
        error_range_claim(evidence),
        premature_convergence_claim(evidence),
        convergence_speed_claim(evidence),
        convergence_accuracy_claim(evidence),
        mutation_claim(evidence),
        adaptive_weight_claim(evidence),
        iterations_claim(evidence),
    )


def error_range_claim(evidence: CloudSwarmEvidence) -> Claim:
    """Undecidable: the table is lost; the evidence is ours."""
    narrow, wide = error_shares(evidence, BoxPlacement.CENTRED), error_shares(evidence, BoxPlacement.OFF_CENTRE)
    return Claim(
        "Errors are mostly within 5 %, some about 10 % (table 1)",
        Verdict.UNKNOWABLE,
        "table 1 is lost in the text at hand, the search box is not printed. Here, in a box of ±10 % about the truth "
        f"{100 * narrow[0]:.0f} % of the values are within 5 % and none can be beyond 10; in one of ±50 % off centre "
        f"{100 * wide[0]:.0f} % are, and {100 * wide[1]:.0f} % are beyond 10 %",
    )


def error_shares(evidence: CloudSwarmEvidence, setting: BoxPlacement) -> tuple[float, float]:
    """Return the shares of ICPSO's values within 5 % and beyond 10 %."""
    errors = np.abs([evidence.reproduction.searches[setting, h, SwarmAlgorithm.ICPSO].errors for h in HEADINGS])
    return float(np.mean(errors <= 0.05)), float(np.mean(errors > 0.1))


def premature_convergence_claim(evidence: CloudSwarmEvidence) -> Claim:
    """By the runs where just one of the two swarms is stuck."""
    swarms = {a: evidence.off_centre(a) for a in SwarmAlgorithm}
    cloud, plain = (evidence.is_stuck(swarms[a]) for a in SwarmAlgorithm)
    return Claim(
        "The cloud keeps the swarm from converging too early",
        premature_convergence_verdict(cloud, plain),
        f"mean error off centre at 0/45/90/135/180°: ICPSO {error_text(swarms[SwarmAlgorithm.ICPSO])}, plain "
        f"PSO with a constant inertia {error_text(swarms[SwarmAlgorithm.PSO])}. {_same_minimum(evidence)}Runs "
        "stuck above the better "
        f"fitness of the two: {cloud.sum()} and {plain.sum()} of {plain.size}; {SIGN_TEST_RUNS} more of one "
        "than of the other would decide. Against CPSO, its parent, it cannot be judged: no source at hand prints its "
        "law",
    )


def _same_minimum(evidence: CloudSwarmEvidence) -> str:
    """Return where both swarms end, if most runs end at the same point."""
    same = 100.0 * evidence.same_minimum_share
    return f"In {same:.0f} % of the runs both end in the same minimum, which the noise decides. " if same > 50.0 else ""


def premature_convergence_verdict(cloud: NDArray[np.bool_], plain: NDArray[np.bool_]) -> Verdict:
    """Whether the cloud helps, by the runs where just one of the two is stuck."""
    only_plain, only_cloud = int(np.sum(plain & ~cloud)), int(np.sum(cloud & ~plain))
    if only_plain - only_cloud >= SIGN_TEST_RUNS:
        return Verdict.CONFIRMED
    if only_cloud - only_plain >= SIGN_TEST_RUNS:
        return Verdict.REFUTED
    return Verdict.UNKNOWABLE


def convergence_speed_claim(evidence: CloudSwarmEvidence) -> Claim:
    """By a sign test on the iterations that each run needs, against the plain swarm with a constant inertia."""
    cloud, plain = (evidence.iterations_needed(evidence.off_centre(a)) for a in SwarmAlgorithm)
    printed = evidence.iterations_needed(evidence.reproduction.unweighted_searches)
    unmutated = {h: evidence.reproduction.variants[CloudVariant.NO_MUTATION, h] for h in HEADINGS}
    claim = "The cloud makes the swarm converge faster"
    text = (
        f"iterations until the better fitness of both swarms is reached within noise, median over {cloud.size} runs "
        f"off centre: ICPSO {_median_text(cloud)}, plain PSO with a constant inertia {_median_text(plain)} (ICPSO "
        f"faster in {int(np.sum(cloud < plain))} runs, slower in {int(np.sum(cloud > plain))}), PSO by eq. (4) as "
        f"printed {_median_text(printed)}, ICPSO without its mutations "
        f"{_median_text(evidence.iterations_needed(unmutated))}; figure 'Convergence'. A law without an inertia weight "
        "hardly converges and is no rival. PSO's inertia, box and noise are not printed; against CPSO, its parent, it "
        "cannot be judged"
    )
    if is_smaller(cloud, plain):
        return Claim(claim, Verdict.CONFIRMED, text)
    return Claim(claim, Verdict.REFUTED if is_smaller(plain, cloud) else Verdict.UNKNOWABLE, text)


def convergence_accuracy_claim(evidence: CloudSwarmEvidence) -> Claim:
    """By a sign test on the fitness with which each run ends, differences within noise left out, against the plain "
    "swarm with a constant inertia."""
    cloud, plain = (np.array([f.histories[:, -1] for f in evidence.off_centre(a).values()]) for a in SwarmAlgorithm)
    notable = np.where(np.abs(cloud / plain - 1.0) > evidence.noise_allowance, cloud, plain)
    claim = "The cloud improves the accuracy of convergence (abstract)"
    text = (
        f"mean errors off centre at 0/45/90/135/180°: ICPSO {error_text(evidence.off_centre(SwarmAlgorithm.ICPSO))}, "
        f"plain PSO with a constant inertia {error_text(evidence.off_centre(SwarmAlgorithm.PSO))}. By more than "
        f"noise explains ICPSO ends with the smaller fitness in {int(np.sum(notable < plain))} of {cloud.size} runs, "
        f"with the larger in {int(np.sum(notable > plain))}. {_same_minimum(evidence)}Judged by a sign test on the "
        "fitness; box and noise are assumed, CPSO cannot be compared"
    )
    if is_smaller(notable, plain):
        return Claim(claim, Verdict.CONFIRMED, text)
    return Claim(claim, Verdict.REFUTED if is_smaller(plain, notable) else Verdict.UNKNOWABLE, text)


def mutation_claim(evidence: CloudSwarmEvidence) -> Claim:
    """By the runs where just one of ICPSO with mutation and without is stuck."""
    without = {h: evidence.reproduction.variants[CloudVariant.NO_MUTATION, h] for h in HEADINGS}
    pair = (evidence.off_centre(SwarmAlgorithm.ICPSO), without)
    stuck = [evidence.is_stuck(searches) for searches in pair]
    needed = [evidence.iterations_needed(searches) for searches in pair]
    return Claim(
        "Mutation by the cloud keeps the swarm diverse, out of local minima",
        premature_convergence_verdict(stuck[0], stuck[1]),
        f"of {stuck[0].size} runs off centre {stuck[0].sum()} are stuck with mutation, {stuck[1].sum()} without; "
        "median "
        f"iterations needed {_median_text(needed[0])} with it, {_median_text(needed[1])} without, mean error "
        f"{error_text(pair[0])} and {error_text(pair[1])} at 0/45/90/135/180°. Where no run is stuck, diversity has "
        "nothing to show; the law of mutation is lost, ours is assumed",
    )


def _median_text(iterations: Array) -> str:
    median = float(np.median(iterations))
    return f"{median:.0f}" if np.isfinite(median) else "never"


def adaptive_weight_claim(evidence: CloudSwarmEvidence) -> Claim:
    """Refuted where the middle band uses too little of the weight's range to adapt anything."""
    settings, weight = CloudSettings(), evidence.cloud_weight
    used = abs(weight.at_ends[0] - weight.at_ends[1]) / (settings.w1 - settings.w2)
    below, middle, above = (100.0 * share for share in weight.band_shares)
    steady = {h: evidence.reproduction.variants[CloudVariant.STEADY_WEIGHT, h] for h in HEADINGS}
    needed = [evidence.iterations_needed(f) for f in (evidence.off_centre(SwarmAlgorithm.ICPSO), steady)]
    return Claim(
        "The normal cloud adjusts the inertia weight adaptively between 0.9 and 0.4 (eq. 6)",
        Verdict.REFUTED if used < ADAPTIVE_SHARE else Verdict.CONFIRMED,
        f"with the printed Ex = 5 w1 - w2 = {5 * settings.w1 - settings.w2:.1f} and En = {settings.entropy:g} the "
        f"ratio r, at most 1, lies far from Ex on the flank of a wide cloud: from A = {settings.a} to B = "
        f"{settings.b} the weight goes from {weight.at_ends[0]:.3f} to {weight.at_ends[1]:.3f}, {100.0 * used:.0f} % "
        f"of its range, and 95 % of its draws lie in {weight.central[0]:.2f} to {weight.central[1]:.2f} (mean "
        f"{weight.mean:.3f}). In the searches {below:.0f} % of the particles are below A, {middle:.0f} % in the "
        f"band, {above:.0f} % above B, where it is {settings.w2}: it is in effect two constants, "
        f"{settings.w2} and about {weight.mean:.1f}, so ICPSO is close to a PSO with a constant inertia. Without the "
        "cloud's randomness (He = 0) the median of iterations "
        f"needed is {_median_text(needed[1])} instead of {_median_text(needed[0])}, the mean error "
        f"{error_text(steady)}. The form of eq. (6) is assumed, only its constants are printed",
    )


def iterations_claim(evidence: CloudSwarmEvidence) -> Claim:
    """Confirmed where the last iterations take 5 % off the error in noise; else the noise decides, which is assumed."""
    noisy, quiet = error_by_iterations(evidence), noise_free_error_by_iterations(evidence)
    before, last = list(noisy.values())[-2:]
    floor = float(np.mean([evidence.output_error_percent(h) for h in HEADINGS]))
    return Claim(
        "More iterations may reduce the error further",
        iterations_verdict(last / before, list(quiet.values())[-1] / list(quiet.values())[-2]),
        f"with the assumed noise the mean error off centre after {_by_iterations(noisy, 2)} iterations; what noise "
        f"leaves to our fit of the same records: {floor:.2f} %. Without noise after {_by_iterations(quiet, 4)}. Box, "
        "noise and sea are not printed, and it is they that decide at which number of iterations nothing is left to "
        "gain",
    )


def iterations_verdict(noisy_ratio: float, noise_free_ratio: float) -> Verdict:
    """Return the verdict on errors after all iterations over those after half of them."""
    if noisy_ratio < 1.0 - NOTABLE_SHARE:
        return Verdict.CONFIRMED
    return Verdict.UNKNOWABLE if noise_free_ratio < 1.0 - NOTABLE_SHARE else Verdict.REFUTED


def error_by_iterations(evidence: CloudSwarmEvidence) -> dict[int, float]:
    """Return the mean error of ICPSO off centre over the headings, per cent, by its iterations."""
    made = evidence.reproduction
    numbers = sorted({few for few, _ in made.shorter_searches})
    shorter = {n: 100.0 * float(np.mean([made.shorter_searches[n, h].mean_error for h in HEADINGS])) for n in numbers}
    full = [evidence.mean_error(BoxPlacement.OFF_CENTRE, SwarmAlgorithm.ICPSO, h) for h in HEADINGS]
    return shorter | {made.iterations: float(np.mean(full))}


def noise_free_error_by_iterations(evidence: CloudSwarmEvidence) -> dict[int, float]:
    """Return the same without noise, one run a heading."""
    made = evidence.reproduction
    numbers = sorted({few for few, _ in made.noise_free_searches})
    return {n: 100.0 * float(np.mean([made.noise_free_searches[n, h].mean_error for h in HEADINGS])) for n in numbers}


def _by_iterations(errors: dict[int, float], digits: int) -> str:
    return ", ".join(f"{n}: {value:.{digits}g} %" for n, value in errors.items())
