"""What the page answers to its question, from the numbers of the verdicts."""

import numpy as np

from seatrial.core.text import significant
from seatrial.physics.models import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial_studies.controller_cost import largest_excess, uncontrolled_excess_text
from seatrial_studies.meng2014.evidence import CloudSwarmEvidence, error_text
from seatrial_studies.meng2014.reproduction import HEADINGS, ITERATIONS, RUNS, CloudVariant, SwarmAlgorithm


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
        "With ship, sea, box and noise assumed: yes, as well as the noise allows, but b53 is poorly determined at 0 "
        f"and 45°: it is {b53} % off at 0/45/90/135/180°. In a box of ±50 % off centre, with 1 cm and 0.02° of noise, "
        f"the improved cloud particle swarm (ICPSO) ends {error_text(searches)} off in the mean over the coefficients, "
        f"{significant(evidence.swarm_ratio, 2)} times the Cramér-Rao bound; {stuck.sum()} of {stuck.size} runs end in "
        "a worse minimum."
    )


def _cloud(evidence: CloudSwarmEvidence) -> str:
    cloud, plain = (evidence.iterations_needed(evidence.off_centre(a)) for a in SwarmAlgorithm)
    unmutated = {h: evidence.reproduction.variants[CloudVariant.NO_MUTATION, h] for h in HEADINGS}
    weight = evidence.cloud_weight
    return (
        f"The cloud adds little: the inertia weight is in effect two constants, 0.4 and about {weight.mean:.1f}, and "
        "against particle swarm optimisation (PSO) with a constant inertia ICPSO needs fewer iterations in "
        f"{int(np.sum(cloud < plain))} of {cloud.size} runs, more in {int(np.sum(cloud > plain))}; with its mutations "
        f"{np.median(cloud):.0f} (median), without them {np.median(evidence.iterations_needed(unmutated)):.0f}. Its "
        "parent, cloud adaptive particle swarm optimisation (CPSO), could not be compared: no source at hand prints "
        "its law."
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
        "For the fin controller tried here the differences are small: tuned on the coefficients of any of the swarms "
        f"it costs at most {significant(100.0 * swarms, 1)} % more on the true ship than tuned on the truth, on ours "
        f"{significant(100.0 * ours, 1)} %; without control the cost is "
        f"{uncontrolled_excess_text(evidence.controllers)} more."
    )


def _print() -> str:
    return (
        "None of the paper's own numbers can be checked: its table 1 is lost in the text at hand, and ship, sea, noise "
        "and box are not printed; those here are assumed."
    )
