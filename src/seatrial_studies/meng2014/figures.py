"""Figures: curves of the paper, convergence of all swarms, histories of coefficients."""

import numpy as np

from seatrial.core.results import Curve, Figure
from seatrial.core.values import Array
from seatrial.physics.models import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.simulate import trajectories
from seatrial_studies.meng2014.evidence import CloudSwarmEvidence
from seatrial_studies.meng2014.reproduction import HEADINGS, BoxPlacement, SwarmAlgorithm
from seatrial_studies.swarm_search import STEP, RepeatedSearches, candidate_matrices

# deg, heading of the figures
FIGURE_HEADING = 135
# iterations of the figure of convergence: later nothing moves; our choice
_DRAWN_ITERATIONS = 300
# smallest excess that is drawn, a tenth of what the noise explains; our choice
_LEAST_EXCESS = 6e-5


def figures(evidence: CloudSwarmEvidence) -> tuple[Figure, ...]:
    """Figures 2 and 3, convergence, and histories."""
    return (*_curves(evidence), _convergence(evidence), _history(evidence))


def _curves(evidence: CloudSwarmEvidence) -> list[Figure]:
    data = evidence.reproduction.seas[FIGURE_HEADING][0]
    found = evidence.reproduction.searches[BoxPlacement.OFF_CENTRE, FIGURE_HEADING, SwarmAlgorithm.ICPSO]
    A, B = candidate_matrices(found.points[:1])
    y = trajectories(A, B, data.forcing, np.zeros(4))[0]
    samples = np.arange(len(y), dtype=np.float64)
    made = []
    note = (
        f"{FIGURE_HEADING}\u00b0 (assumed, the paper does not say), first run of ICPSO, box \u00b150 % off centre, a "
        f"sample every {STEP} s: the simulated truth with its noise, and the motion by the identified coefficients. "
        "That they coincide says little of the coefficients."
    )
    for j, factor, title, unit in (
        (0, 100.0, "Figure 2: heave", "cm"),
        (1, float(np.degrees(1.0)), "Figure 3: pitch", "deg"),
    ):
        measured = Curve("truth with noise, simulated", samples, -factor * data.measured[:, j])
        identified = Curve("identified", samples, -factor * y[:, j])
        made.append(Figure(title, "sample", unit, (measured, identified), note))
    return made


def _convergence(evidence: CloudSwarmEvidence) -> Figure:
    made = evidence.reproduction
    swarms = {str(a): evidence.off_centre(a) for a in SwarmAlgorithm}
    swarms["PSO by eq. (4) as printed"] = made.unweighted_searches
    curves = []
    for name, searches in swarms.items():
        excess = _median_excess(evidence, searches)[:_DRAWN_ITERATIONS]
        curves.append(Curve(name, np.arange(len(excess), dtype=np.float64), np.log10(excess)))
    drawn = np.arange(min(_DRAWN_ITERATIONS, made.iterations), dtype=np.float64)
    curves.append(Curve("within noise", drawn, np.full(len(drawn), np.log10(evidence.noise_allowance))))
    note = (
        "Median over all headings and runs of the best fitness over the less of the two with which ICPSO and PSO end "
        "in the same "
        f"sea and box, less 1, its first {_DRAWN_ITERATIONS} iterations; box \u00b150 % off centre."
    )
    return Figure("Convergence", "iteration", "log10 of the excess of the fitness", tuple(curves), note)


def _median_excess(evidence: CloudSwarmEvidence, searches: dict[int, RepeatedSearches]) -> Array:
    excess = np.concatenate([evidence.reproduction.excess_fitness(h, searches[h]) for h in HEADINGS])
    return np.maximum(np.median(excess, axis=0), _LEAST_EXCESS)


def _history(evidence: CloudSwarmEvidence) -> Figure:
    found = evidence.reproduction.searches[BoxPlacement.OFF_CENTRE, FIGURE_HEADING, SwarmAlgorithm.ICPSO]
    iterations = np.arange(len(found.trace), dtype=np.float64)
    errors = 100.0 * (found.trace / found.truth - 1.0)
    names = ("a33", "a55", "b33", "b55", "b53")
    curves = tuple(Curve(n, iterations, errors[:, COEFFICIENTS.index(n)]) for n in names)
    return Figure(
        "Histories of coefficients", "iteration", "error, %", curves, f"ICPSO, {FIGURE_HEADING}\u00b0, first run."
    )
