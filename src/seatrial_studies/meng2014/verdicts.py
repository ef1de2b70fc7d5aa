"""Claims of the paper with their evidence, checks of our own numbers, and the answer to the page's question."""

import numpy as np
from numpy.typing import NDArray

from seatrial.core.results import Check, Claim, Verdict
from seatrial.core.text import significant
from seatrial.core.values import Array
from seatrial.numerics.optimise import CloudSettings
from seatrial.physics.models import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial_studies.controller_cost import largest_excess, uncontrolled_excess_text
from seatrial_studies.declarations import TIME_IS_NO_VERDICT
from seatrial_studies.heave_pitch_search import is_smaller
from seatrial_studies.meng2014.reproduction import (
    BEAM_WAVES,
    HEADINGS,
    ITERATIONS,
    ONE_FIN,
    RUNS,
    WAVES_AND_FIN,
    BoxPlacement,
    CloudSwarmEvidence,
    CloudVariant,
    SwarmAlgorithm,
    error_text,
)
from seatrial_studies.seaway import HEAVE_NOISE, PITCH_NOISE

# Claims of accuracy and speed of the swarms, each verdict by a rule on the numbers of the searches.

# runs of one swarm stuck and not of the other in the same sea and box: fewer may be chance (sign test, 5 %)
SIGN_TEST_RUNS = 5
# share of an error that further iterations must take off; our choice
NOTABLE_SHARE = 0.05
# share of the range of the weight that its middle band must use to be called adaptive; our choice
ADAPTIVE_SHARE = 0.25


def search_claims(evidence: CloudSwarmEvidence) -> tuple[Claim, ...]:
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


OUR_LAWS = "with the laws of the weight and of mutation assumed here, in our box, noise and sea"
"""Where a claim of the cloud holds: eq. (6) and what is said of mutation are lost in our copy."""


def of_our_laws(claim: str, verdict: Verdict, evidence: str) -> Claim:
    """Return a claim of the cloud, whose laws are lost in our copy: ours can bear it out, but refute nothing."""
    if verdict is Verdict.CONFIRMED:
        return Claim(claim, Verdict.HOLDS_IN_OWN_SETTING, evidence, OUR_LAWS)
    return Claim(claim, Verdict.UNKNOWABLE, evidence)


def error_range_claim(evidence: CloudSwarmEvidence) -> Claim:
    """Undecidable: the table is lost; the evidence is ours."""
    narrow, wide = error_shares(evidence, BoxPlacement.CENTRED), error_shares(evidence, BoxPlacement.OFF_CENTRE)
    return Claim(
        "Errors are mostly within 5 %, some about 10 % (simulation, table 1)",
        Verdict.UNKNOWABLE,
        "table 1 is lost in our copy, and the search box stands nowhere in what is left of it. Here, in a box of ±10 "
        "% about the truth "
        f"{100 * narrow[0]:.0f} % of the values are within 5 % and none can be beyond 10. In one of ±50 % off centre "
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
    return of_our_laws(
        "The cloud keeps the swarm from converging too early (abstract, introduction)",
        premature_convergence_verdict(cloud, plain),
        f"mean error off centre at 0/45/90/135/180°: ICPSO {error_text(swarms[SwarmAlgorithm.ICPSO])}, plain "
        f"PSO with a constant inertia {error_text(swarms[SwarmAlgorithm.PSO])}. {_same_minimum(evidence)}Runs "
        "stuck above the better "
        f"fitness of the two: {cloud.sum()} and {plain.sum()} of {plain.size}; {SIGN_TEST_RUNS} more of one "
        "than of the other would decide. The laws of weight and mutation are lost in our copy and assumed. Against "
        "CPSO, "
        "its parent, it cannot be judged: no source at hand prints its law",
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
    claim = "The cloud makes the swarm converge faster (abstract)"
    text = (
        f"iterations until the better fitness of both swarms is reached within noise, median over {cloud.size} runs "
        f"off centre: ICPSO {_median_text(cloud)}, plain PSO with a constant inertia {_median_text(plain)} (ICPSO "
        f"faster in {int(np.sum(cloud < plain))} runs, slower in {int(np.sum(cloud > plain))}), PSO by eq. (4) "
        f"alone {_median_text(printed)}, ICPSO without its mutations "
        f"{_median_text(evidence.iterations_needed(unmutated))}; figure 'Convergence'. A law without an inertia weight "
        "hardly converges and is no rival. The laws of weight and mutation, box and size of the noise are not in our "
        "copy "
        "and assumed; against CPSO, its parent, it cannot be judged"
    )
    return of_our_laws(claim, Verdict.CONFIRMED if is_smaller(cloud, plain) else Verdict.UNKNOWABLE, text)


def convergence_accuracy_claim(evidence: CloudSwarmEvidence) -> Claim:
    """By a sign test on the fitness with which each run ends, differences within noise left out."""
    cloud, plain = (np.array([f.histories[:, -1] for f in evidence.off_centre(a).values()]) for a in SwarmAlgorithm)
    notable = np.where(np.abs(cloud / plain - 1.0) > evidence.noise_allowance, cloud, plain)
    claim = "The cloud improves the accuracy of convergence (abstract)"
    text = (
        f"mean errors off centre at 0/45/90/135/180°: ICPSO {error_text(evidence.off_centre(SwarmAlgorithm.ICPSO))}, "
        f"plain PSO with a constant inertia {error_text(evidence.off_centre(SwarmAlgorithm.PSO))}. By more than "
        f"noise explains ICPSO ends with the smaller fitness in {int(np.sum(notable < plain))} of {cloud.size} runs, "
        f"with the larger in {int(np.sum(notable > plain))}. {_same_minimum(evidence)}Judged by a sign test on the "
        "fitness; laws of the cloud, box and noise are assumed, CPSO cannot be compared"
    )
    return of_our_laws(claim, Verdict.CONFIRMED if is_smaller(notable, plain) else Verdict.UNKNOWABLE, text)


def mutation_claim(evidence: CloudSwarmEvidence) -> Claim:
    """By the runs where just one of ICPSO with mutation and without is stuck."""
    without = {h: evidence.reproduction.variants[CloudVariant.NO_MUTATION, h] for h in HEADINGS}
    pair = (evidence.off_centre(SwarmAlgorithm.ICPSO), without)
    stuck = [evidence.is_stuck(searches) for searches in pair]
    needed = [evidence.iterations_needed(searches) for searches in pair]
    return of_our_laws(
        "Mutation by the cloud keeps the swarm diverse, out of local minima (conclusions)",
        premature_convergence_verdict(stuck[0], stuck[1]),
        f"of {stuck[0].size} runs off centre {stuck[0].sum()} are stuck with mutation, {stuck[1].sum()} without; "
        "median "
        f"iterations needed {_median_text(needed[0])} with it, {_median_text(needed[1])} without, mean error "
        f"{error_text(pair[0])} and {error_text(pair[1])} at 0/45/90/135/180°. Where no run is stuck, diversity has "
        "nothing to show; the law of mutation is lost in our copy, ours is assumed",
    )


def _median_text(iterations: Array) -> str:
    median = float(np.median(iterations))
    return f"{median:.0f}" if np.isfinite(median) else "never"


def adaptive_weight_claim(evidence: CloudSwarmEvidence) -> Claim:
    """Undecidable: the form of eq. (6) is lost in our copy; the evidence is of the form assumed."""
    settings, weight = CloudSettings(), evidence.cloud_weight
    used = abs(weight.at_ends[0] - weight.at_ends[1]) / (settings.w1 - settings.w2)
    below, middle, above = (100.0 * share for share in weight.band_shares)
    steady = {h: evidence.reproduction.variants[CloudVariant.STEADY_WEIGHT, h] for h in HEADINGS}
    needed = [evidence.iterations_needed(f) for f in (evidence.off_centre(SwarmAlgorithm.ICPSO), steady)]
    return Claim(
        "The normal cloud adjusts the inertia weight adaptively between 0.9 and 0.4 (eq. 6)",
        Verdict.UNKNOWABLE,
        "eq. (6) is lost in our copy but for its constants. In the form that is ascribed to Wei et al. 2009, "
        "unverified, "
        f"and with the printed Ex = 5 w1 - w2 = {5 * settings.w1 - settings.w2:.1f} and En = {settings.En:g} the "
        f"ratio r, at most 1, lies far from Ex on the flank of a wide cloud: from A = {settings.A} to B = "
        f"{settings.B} the weight goes from {weight.at_ends[0]:.3f} to {weight.at_ends[1]:.3f}, {100.0 * used:.0f} % "
        f"of its range, and 95 % of its draws lie in {weight.central[0]:.2f} to {weight.central[1]:.2f} (mean "
        f"{weight.mean:.3f}). In the searches {below:.0f} % of the particles are below A, {middle:.0f} % in the "
        f"band, {above:.0f} % above B, where it is {settings.w2}. The weight is in effect two constants, "
        f"{settings.w2} and about {weight.mean:.1f}: less than {100.0 * ADAPTIVE_SHARE:.0f} % of the range would "
        "hardly be "
        "called adaptive, but another form may use more. Without the "
        "cloud's randomness (He = 0) the median of iterations "
        f"needed is {_median_text(needed[1])} instead of {_median_text(needed[0])}, the mean error "
        f"{error_text(steady)}",
    )


def iterations_claim(evidence: CloudSwarmEvidence) -> Claim:
    """Confirmed where the last iterations take 5 % off the error in noise; else the noise decides, which is assumed."""
    noisy, quiet = error_by_iterations(evidence), noise_free_error_by_iterations(evidence)
    before, last = list(noisy.values())[-2:]
    floor = float(np.mean([evidence.output_error_percent(h) for h in HEADINGS]))
    return Claim(
        "More iterations may reduce the error further (simulation)",
        iterations_verdict(last / before),
        f"with the assumed noise the mean error off centre after {_by_iterations(noisy, 2)} iterations; what noise "
        f"leaves to our fit of the same records: {floor:.2f} %. Without noise after {_by_iterations(quiet, 4)}. Box "
        "and "
        "size of the noise are not in our copy, and it is they that decide at which number of iterations nothing is "
        "left to "
        "gain",
    )


def iterations_verdict(noisy_ratio: float) -> Verdict:
    """Return the verdict on errors after all iterations over those after half of them: what may be is not refuted."""
    if noisy_ratio < 1.0 - NOTABLE_SHARE:
        return Verdict.CONFIRMED
    return Verdict.UNKNOWABLE


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


# Claims of the model, the law and the record, each verdict by a rule on numbers.

# relative curvature below which a direction is lost in rounding
SINGULAR_CURVATURE = 1e-11
# relative error below which a coefficient counts as found without noise; our choice
FOUND_ERROR = 1e-4


def model_claims(evidence: CloudSwarmEvidence) -> tuple[Claim, ...]:
    """What the paper says of unknowns, law and record."""
    return (
        twelve_unknowns_claim(evidence),
        velocity_law_claim(evidence),
        coinciding_curves_claim(evidence),
        theory_as_truth_claim(),
    )


def twelve_unknowns_claim(evidence: CloudSwarmEvidence) -> Claim:
    """Held in waves with a fin, where all twelve are found; refuted where even these leave a direction open."""
    flat, errors = evidence.twelve_unknowns.curvatures, evidence.twelve_unknowns.errors
    beam, fin, both = (flat[name] for name in (BEAM_WAVES, ONE_FIN, WAVES_AND_FIN))
    text = (
        f"waves and a moving fin together identify twelve (flattest direction {significant(both, 1)} of the steepest), "
        f"and our fit finds all of them without noise within {significant(max(errors.values()), 1)} at all five "
        f"headings; beam waves alone could not ({significant(beam, 1)}), nor one fin alone ({significant(fin, 1)}). "
        "So the eight that the paper searches are identifiable, and the four stiffnesses could be, too. Box, noise and "
        "wave height are assumed"
    )
    claim = (
        "Of the twelve unknown parameters eight need identification; the four stiffnesses follow from theory (method)"
    )
    if both < SINGULAR_CURVATURE or max(errors.values()) > FOUND_ERROR:
        return Claim(claim, Verdict.REFUTED, text)
    if max(beam, fin) < SINGULAR_CURVATURE:
        return Claim(claim, Verdict.HOLDS_IN_OWN_SETTING, text, "waves and a moving fin together, both known")
    return Claim(claim, Verdict.CONFIRMED, text)


def velocity_law_claim(evidence: CloudSwarmEvidence) -> Claim:
    """Undecidable: eq. (4) is the base method, and how the weight of eq. (6) enters it is lost in our copy."""
    printed = evidence.reproduction.unweighted_searches
    stuck = evidence.is_stuck(printed)
    return Claim(
        "PSO moves by eqs. (4) and (5); ICPSO adjusts the inertia weight of that law by eq. (6)",
        Verdict.UNKNOWABLE,
        "eqs. (4) and (5) are the base method, as Kennedy & Eberhart (1995) have it, without a weight; where that of "
        "eq. "
        "(6) enters stands in what is lost of our copy. Assumed is that it multiplies the velocity (Shi & Eberhart "
        "1998). "
        "The base method alone, with c1 = c2 = 2.05, does not settle: velocities do not die "
        f"out, {stuck.sum()} of {stuck.size} runs end above the least fitness, the mean error off centre is "
        f"{error_text(printed)}, with the weight "
        f"{error_text(evidence.off_centre(SwarmAlgorithm.ICPSO))}{_less_by_chance(evidence)}",
    )


def _less_by_chance(evidence: CloudSwarmEvidence) -> str:
    """Return the headings at which the law as printed has the smaller error, though its fitness is worse."""
    printed, weighted = evidence.reproduction.unweighted_searches, evidence.off_centre(SwarmAlgorithm.ICPSO)
    less = [f"{h}°" for h, f in printed.items() if np.mean(f.mean_error) < np.mean(weighted[h].mean_error)]
    return f"; smaller as printed at {', '.join(less)}, where noise decides and the fitness is worse" if less else ""


def coinciding_curves_claim(evidence: CloudSwarmEvidence) -> Claim:
    """Held for motions in the sea of the record; that of coefficients it shows little is part of the setting."""
    wrong = 100.0 * np.abs(evidence.undetected_change.relative_change)
    worst = COEFFICIENTS[int(np.argmax(wrong))]
    heave, pitch = evidence.undetected_change.heave_rms, evidence.undetected_change.pitch_rms
    hidden = wrong.max() > 10.0 and heave <= HEAVE_NOISE and pitch <= np.degrees(PITCH_NOISE)
    return Claim(
        "Curves that nearly coincide (figures 2, 3) show that the dynamics are described rather accurately "
        "(simulation)",
        Verdict.HOLDS_IN_OWN_SETTING if hidden else Verdict.UNKNOWABLE,
        f"of motions, yes; of the coefficients they show little. With coefficients up to {wrong.max():.0f} % off "
        f"({worst}) the motion at 135° differs from the true one by "
        f"{100 * heave:.1f} cm and {pitch:.3f}° rms; the noise is {100 * HEAVE_NOISE:.0f} cm and "
        f"{np.degrees(PITCH_NOISE):.2f}°. To the eye that is within the noise; a fit of the whole record separates "
        "them",
        "motions in the sea of the record; another sea or the coefficients themselves are not shown" if hidden else "",
    )


def theory_as_truth_claim() -> Claim:
    """Undecidable: nothing is printed."""
    return Claim(
        "Coefficients from theory at 0, 45, 90, 135 and 180° serve as truth (simulation)",
        Verdict.UNKNOWABLE,
        "they would stand in table 1, which is lost in our copy; assumed are those of Qi et al. 2025, which has none "
        "at 0 and 45°: there those of 90°. "
        "The table 'Assumed' lists what else is",
    )


# Claims of the paper with their evidence, and checks of our own numbers.

# limits of our own checks, set beforehand: share within 5 %, ratio of times, relative error without noise, rms of
# errors over the Cramer-Rao bound
MOST_SHARE, LEAST_TIME_RATIO, EXACT_ERROR, BOUND_RATIO_RANGE = 0.5, 50.0, 1e-9, (0.7, 1.3)
# records simulated by ICPSO over those by our fit, each slope counted as one; our choice
LEAST_EVALUATION_RATIO = 50.0


def claims(evidence: CloudSwarmEvidence) -> tuple[Claim, ...]:
    """Return the claims, each with its evidence."""
    return (*search_claims(evidence), *model_claims(evidence))


def checks(evidence: CloudSwarmEvidence) -> tuple[Check, ...]:
    """Ours; each can fail. Both estimates are near the noise: at one heading, few runs order them by chance."""
    ours, flat = evidence.output_error_ratio, evidence.twelve_unknowns.curvatures
    exact = max(float(np.max(np.abs(o.noise_free_errors))) for o in evidence.output_error.values())
    share = error_shares(evidence, BoxPlacement.CENTRED)[0]
    return (
        Check.between("our errors over the Cramer-Rao bound", ours, *BOUND_RATIO_RANGE),
        Check.at_most("the same, not above ICPSO's off centre", ours, evidence.swarm_ratio),
        Check.at_most("our largest relative error, noise-free", exact, EXACT_ERROR),
        *(
            Check.at_most(f"flattest direction of twelve unknowns, {name}", flat[name], SINGULAR_CURVATURE)
            for name in (BEAM_WAVES, ONE_FIN)
        ),
        Check(
            "ICPSO's values within 5 %, ±10 % about the truth, share", share, f"above {MOST_SHARE}", share > MOST_SHARE
        ),
        Check.at_least("ICPSO's time over ours", evidence.time_ratio, LEAST_TIME_RATIO).withdrawn(TIME_IS_NO_VERDICT),
        Check.at_least(
            "records simulated by ICPSO over those by our fit", evidence.simulation_ratio, LEAST_EVALUATION_RATIO
        ),
    )


# What the page answers to its question, from the numbers of the verdicts.


def answer(evidence: CloudSwarmEvidence) -> tuple[str, ...]:
    """Return the sentences, the most important first; before them that of a quick version."""
    sentences = (_accuracy, _cloud, _least_squares, _cost)
    return (*_quick_version(evidence), *(sentence(evidence) for sentence in sentences), _print())


def _quick_version(evidence: CloudSwarmEvidence) -> tuple[str, ...]:
    """Return what a quick version has fewer of; nothing of the whole one."""
    runs, iterations = evidence.reproduction.run_count, evidence.reproduction.iterations
    if (runs, iterations) == (RUNS, ITERATIONS):
        return ()
    return (
        f"This is the quick version: {runs} runs of {iterations} iterations at each heading; the whole version has "
        f"{RUNS} of {ITERATIONS}, the paper prints {ITERATIONS} iterations.",
    )


def _accuracy(evidence: CloudSwarmEvidence) -> str:
    searches = evidence.off_centre(SwarmAlgorithm.ICPSO)
    stuck = evidence.is_stuck(searches)
    b53 = "/".join(f"{100.0 * f.mean_error[COEFFICIENTS.index('b53')]:.0f}" for f in searches.values())
    return (
        "With ship, wave height, box and noise assumed: yes, as well as the noise allows, but b53 is poorly "
        "determined at 0 "
        f"and 45°: it is {b53} % off at 0/45/90/135/180°. In a box of ±50 % off centre, with 1 cm and 0.02° of noise, "
        f"the improved cloud particle swarm (ICPSO) ends {error_text(searches)} off in the mean over the coefficients. "
        f"That is {significant(evidence.swarm_ratio, 2)} times the Cramér-Rao bound; {stuck.sum()} of {stuck.size} "
        "runs end in a worse minimum."
    )


def _cloud(evidence: CloudSwarmEvidence) -> str:
    cloud, plain = (evidence.iterations_needed(evidence.off_centre(a)) for a in SwarmAlgorithm)
    unmutated = {h: evidence.reproduction.variants[CloudVariant.NO_MUTATION, h] for h in HEADINGS}
    weight = evidence.cloud_weight
    return (
        "With the cloud's laws assumed, as eq. (6) is lost in our copy, the cloud adds little: the inertia weight is "
        "in "
        f"effect two constants, 0.4 and about {weight.mean:.1f}. "
        "Against particle swarm optimisation (PSO) with a constant inertia ICPSO needs fewer iterations in "
        f"{int(np.sum(cloud < plain))} of {cloud.size} runs, more in {int(np.sum(cloud > plain))}. The median is "
        f"{np.median(cloud):.0f} with its mutations, {np.median(evidence.iterations_needed(unmutated)):.0f} without. "
        "Its parent, cloud adaptive particle swarm optimisation (CPSO), could not be compared: no source at hand "
        "prints its law."
    )


def _least_squares(evidence: CloudSwarmEvidence) -> str:
    fits = evidence.output_error.values()
    evaluations = max(f.evaluations for f in fits)
    judged = int(evidence.off_centre(SwarmAlgorithm.ICPSO)[HEADINGS[0]].evaluations[0])
    return (
        "Least squares on the motions over the whole record reaches "
        f"{significant(evidence.output_error_ratio, 2)} times that bound in at most {evaluations} "
        f"evaluations with slopes, {evaluations * (1 + len(COEFFICIENTS))} simulated records if each slope counts as "
        "one; "
        f"a run of ICPSO simulates {judged}."
    )


def _cost(evidence: CloudSwarmEvidence) -> str:
    swarms = largest_excess(evidence.controllers, lambda method: "PSO" in method)
    ours = largest_excess(evidence.controllers, lambda method: method.startswith("ours"))
    return (
        "For the fin controller tried here the differences are small. Tuned on the coefficients of any of the swarms "
        f"it costs at most {significant(100.0 * swarms, 1)} % more on the true ship than tuned on the truth, on ours "
        f"{significant(100.0 * ours, 1)} %. Without control the cost is "
        f"{uncontrolled_excess_text(evidence.controllers)} more."
    )


def _print() -> str:
    return (
        "None of the paper's own numbers can be checked: table 1, figures and eqs. (1) to (3), (6) and (7) are lost "
        "in our "
        "copy. It gives sea state 3 and 18 kn; ship, wave height, size of the noise and box are assumed."
    )
