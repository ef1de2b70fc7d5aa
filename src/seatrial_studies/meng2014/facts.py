"""Facts of the page, by the keys under which the rows of `study.toml` name them."""

from collections.abc import Mapping

import numpy as np

from seatrial.core.results import Curve
from seatrial.core.values import Array
from seatrial.numerics.optimise import CloudSettings
from seatrial.physics.models import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.simulate import trajectories
from seatrial_studies.controller_cost import (
    controller_rows,
    largest_excess,
    uncontrolled_excess,
)
from seatrial_studies.heave_pitch_search import RepeatedSearches, candidate_matrices, is_smaller
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
)
from seatrial_studies.seaway import HEAVE_NOISE, PITCH_NOISE
from seatrial_studies.study_page import Facts, FactTable

FACTS = FactTable[CloudSwarmEvidence]()
ICPSO, PSO = SwarmAlgorithm.ICPSO, SwarmAlgorithm.PSO
# deg, heading of the figures
FIGURE_HEADING = 135
# iterations of the figure of convergence: later nothing moves; our choice
_DRAWN_ITERATIONS = 300
# smallest excess that is drawn, a tenth of what the noise explains; our choice
_LEAST_EXCESS = 6e-5
_BASE_METHOD = "PSO by eq. (4), the base method"


@FACTS.declare
def searches(evidence: CloudSwarmEvidence) -> Facts:
    """What every row may name: runs, and errors, stuck runs and iterations needed of each swarm."""
    reproduction = evidence.reproduction
    swarms = {
        "cloud": evidence.off_centre(ICPSO),
        "plain": evidence.off_centre(PSO),
        "printed": reproduction.unweighted_searches,
        "steady": reproduction.of_variant(CloudVariant.STEADY_WEIGHT),
        "unmutated": reproduction.of_variant(CloudVariant.NO_MUTATION),
    }
    described = {name: _swarm(evidence, swarm) for name, swarm in swarms.items()}
    cloud, plain = (described[name]["needed"] for name in ("cloud", "plain"))
    printed, weighted = swarms["printed"], swarms["cloud"]
    return {
        **described,
        "count": cloud.size,
        "faster": int(np.sum(cloud < plain)),
        "slower": int(np.sum(cloud > plain)),
        "is_faster": is_smaller(cloud, plain),
        "more_stuck": described["plain"]["stuck"] - described["cloud"]["stuck"],
        "more_stuck_unmutated": described["unmutated"]["stuck"] - described["cloud"]["stuck"],
        "smaller_by_chance": [
            f"{h}°" for h in HEADINGS if np.mean(printed[h].mean_error) < np.mean(weighted[h].mean_error)
        ],
        "runs": reproduction.run_count,
        "iterations": reproduction.iterations,
        "is_quick": (reproduction.run_count, reproduction.iterations) != (RUNS.value, ITERATIONS.value),
    }


def _swarm(evidence: CloudSwarmEvidence, swarm: Mapping[int, RepeatedSearches]) -> Facts:
    needed = evidence.iterations_needed(swarm)
    median = float(np.median(needed))
    return {
        "errors": [float(np.mean(f.mean_error)) for f in swarm.values()],
        "stuck": int(evidence.is_stuck(swarm).sum()),
        "needed": needed,
        "median": f"{median:.0f}" if np.isfinite(median) else "never",
    }


@FACTS.declare
def accuracy(evidence: CloudSwarmEvidence) -> Facts:
    """Our fit beside the cloud swarm: errors over the Cramer-Rao bound, work, time."""
    fits = evidence.output_error.values()
    evaluations = max(f.evaluations for f in fits)
    cloud = evidence.off_centre(ICPSO)
    return {
        "b53": [float(f.mean_error[COEFFICIENTS.index("b53")]) for f in cloud.values()],
        "exact_error": max(float(np.max(np.abs(o.noise_free_errors))) for o in fits),
        "evaluations": evaluations,
        "simulated": evaluations * (1 + len(COEFFICIENTS)),
        "judged": int(cloud[HEADINGS[0]].evaluations[0]),
    }


@FACTS.declare
def weight(evidence: CloudSwarmEvidence) -> Facts:
    """What the printed constants let the cloud do to the inertia weight."""
    settings = CloudSettings()
    at_A, at_B = evidence.cloud_weight.at_ends
    used = abs(at_A - at_B) / (settings.w1 - settings.w2)
    return {"cloud_settings": settings, "expectation": 5 * settings.w1 - settings.w2, "used": used}


@FACTS.declare
def error_shares(evidence: CloudSwarmEvidence) -> Facts:
    """Shares of ICPSO's values within 5 % and beyond 10 %, in both boxes."""
    narrow, wide = (
        np.abs([evidence.reproduction.searches[box, h, ICPSO].errors for h in HEADINGS])
        for box in (BoxPlacement.CENTRED, BoxPlacement.OFF_CENTRE)
    )
    within = float(np.mean(narrow <= 0.05))
    return {
        "narrow_within": within,
        "most_within": within > 0.5,
        "wide_within": float(np.mean(wide <= 0.05)),
        "wide_beyond": float(np.mean(wide > 0.1)),
    }


@FACTS.declare
def final_fitness(evidence: CloudSwarmEvidence) -> Facts:
    """Runs of ICPSO that end with a smaller or larger fitness than PSO's by more than noise explains."""
    cloud, plain = (np.array([f.histories[:, -1] for f in evidence.off_centre(a).values()]) for a in SwarmAlgorithm)
    notable = np.where(np.abs(cloud / plain - 1.0) > evidence.noise_allowance, cloud, plain)
    smaller, larger = int(np.sum(notable < plain)), int(np.sum(notable > plain))
    return {"smaller": smaller, "larger": larger, "is_smaller": is_smaller(notable, plain)}


@FACTS.declare
def errors_by_iterations(evidence: CloudSwarmEvidence) -> Facts:
    """Mean errors of ICPSO off centre over the headings, per cent, by its iterations, with noise and without."""
    reproduction = evidence.reproduction
    longest = {(reproduction.iterations, h): swarm for h, swarm in evidence.off_centre(ICPSO).items()}
    noisy = _mean_errors({**reproduction.shorter_searches, **longest})
    quiet = _mean_errors(reproduction.noise_free_searches)
    return {
        "noisy_errors": noisy,
        "quiet_errors": quiet,
        "noisy_ratio": noisy[-1]["error"] / noisy[-2]["error"],
        "floor": float(np.mean([evidence.output_error_percent(h) for h in HEADINGS])),
    }


def _mean_errors(by_iterations: Mapping[tuple[int, int], RepeatedSearches]) -> list[Facts]:
    numbers = sorted({iterations for iterations, _ in by_iterations})
    means = {n: 100.0 * float(np.mean([by_iterations[n, h].mean_error for h in HEADINGS])) for n in numbers}
    return [{"iterations": n, "error": error} for n, error in means.items()]


@FACTS.declare
def unknowns(evidence: CloudSwarmEvidence) -> Facts:
    """The twelve unknowns of the print: the flattest direction by what moves the ship, errors of a fit of all."""
    flat = evidence.twelve_unknowns.curvatures
    beam, fin, both = (flat[name] for name in (BEAM_WAVES, ONE_FIN, WAVES_AND_FIN))
    largest = max(evidence.twelve_unknowns.errors.values())
    return {"beam": beam, "fin": fin, "both": both, "alone": (beam, fin), "largest_error": largest}


@FACTS.declare
def undetected(evidence: CloudSwarmEvidence) -> Facts:
    """Coefficients far off whose motion follows the record."""
    change = evidence.undetected_change
    wrong = np.abs(change.relative_change)
    return {
        "largest": float(wrong.max()),
        "worst": COEFFICIENTS[int(np.argmax(wrong))],
        "heave_cm": 100.0 * change.heave_rms,
        "pitch_deg": change.pitch_rms,
        "heave_noise_cm": 100.0 * HEAVE_NOISE,
        "pitch_noise_deg": float(np.degrees(PITCH_NOISE)),
    }


@FACTS.declare
def controllers(evidence: CloudSwarmEvidence) -> Facts:
    """What controllers cost that are tuned on the coefficients of the swarms and on ours."""
    return {
        "rows": controller_rows({f"{h}°": costs for h, costs in evidence.controllers.items()}),
        "swarms": largest_excess(evidence.controllers, lambda method: "PSO" in method),
        "ours": largest_excess(evidence.controllers, lambda method: method.startswith("ours")),
        "idle": uncontrolled_excess(evidence.controllers),
    }


@FACTS.declare
def coefficients(evidence: CloudSwarmEvidence) -> list[Facts]:
    """Truth, what ICPSO finds in both boxes, and our errors beside the Cramer-Rao bound, at each heading."""
    groups = []
    for heading in HEADINGS:
        wide, narrow = (evidence.reproduction.searches[box, heading, ICPSO] for box in BoxPlacement)
        fit = evidence.output_error[heading]
        columns = (
            np.abs(wide.truth), np.abs(wide.points.mean(axis=0)), 100.0 * wide.mean_error,
            100.0 * narrow.mean_error, 100.0 * np.abs(fit.noisy_errors).mean(axis=0),
            100.0 * fit.cramer_rao_bound.mean(axis=0),
        )  # fmt: skip
        rows = zip(COEFFICIENTS, *(column.tolist() for column in columns), strict=True)
        groups.append({"heading": heading, "rows": list(rows)})
    return groups


@FACTS.declare
def mean_errors(evidence: CloudSwarmEvidence) -> Facts:
    """Mean errors of both swarms in both boxes, and ours."""
    boxes = [(box, a) for box in BoxPlacement for a in SwarmAlgorithm]
    return {
        "rows": [
            (f"{h}°", *(evidence.mean_error(box, a, h) for box, a in boxes), evidence.output_error_percent(h))
            for h in HEADINGS
        ]
    }


@FACTS.declare
def convergence(evidence: CloudSwarmEvidence) -> Facts:
    """Iterations that each swarm needs, medians at each heading."""
    rows = []
    for name, swarm in _swarms(evidence, with_variants=True).items():
        needed = evidence.iterations_needed(swarm)
        cells = [int(median) if np.isfinite(median) else None for median in np.median(needed, axis=1)]
        error = 100.0 * float(np.mean([f.mean_error for f in swarm.values()]))
        rows.append((name, *cells, int(np.sum(~np.isfinite(needed))), error))
    return {"rows": rows}


def _swarms(evidence: CloudSwarmEvidence, *, with_variants: bool) -> dict[str, dict[int, RepeatedSearches]]:
    swarms = {str(a): evidence.off_centre(a) for a in SwarmAlgorithm}
    variants = {str(v): evidence.reproduction.of_variant(v) for v in CloudVariant if with_variants}
    return {**swarms, **variants, _BASE_METHOD: evidence.reproduction.unweighted_searches}


@FACTS.declare
def times(evidence: CloudSwarmEvidence) -> Facts:
    """Seconds and judged candidates of a run."""
    rows = []
    for h in HEADINGS:
        swarms, fit = [evidence.off_centre(a)[h] for a in SwarmAlgorithm], evidence.output_error[h]
        judged = (*(int(f.evaluations[0]) for f in swarms), fit.evaluations)
        rows.append((f"{h}°", *(f.seconds for f in swarms), fit.seconds, *judged))
    return {"rows": rows}


@FACTS.declare
def motions(evidence: CloudSwarmEvidence) -> list[Facts]:
    """Heave and pitch over samples, true with noise and by the identified coefficients: the paper's figures 2, 3."""
    data = evidence.reproduction.seas[FIGURE_HEADING][0]
    A, B = candidate_matrices(evidence.off_centre(ICPSO)[FIGURE_HEADING].points[:1])
    identified = trajectories(A, B, data.forcing, np.zeros(4))[0]
    samples = np.arange(len(identified), dtype=np.float64)
    labels = (("Figure 2: heave", "cm", 100.0), ("Figure 3: pitch", "deg", float(np.degrees(1.0))))
    return [
        {
            "title": title,
            "unit": unit,
            "curves": (
                Curve("truth with noise, simulated", samples, -factor * data.measured[:, j]),
                Curve("identified", samples, -factor * identified[:, j]),
            ),
        }
        for j, (title, unit, factor) in enumerate(labels)
    ]


@FACTS.declare
def convergence_curves(evidence: CloudSwarmEvidence) -> Facts:
    """Excess of each swarm's fitness over iterations, and what the noise explains."""
    swarms = _swarms(evidence, with_variants=False)
    excess = {name: _median_excess(evidence, swarm)[:_DRAWN_ITERATIONS] for name, swarm in swarms.items()}
    count = min(_DRAWN_ITERATIONS, evidence.reproduction.iterations)
    excess["within noise"] = np.full(count, evidence.noise_allowance)
    curves = [Curve(name, np.arange(len(e), dtype=np.float64), np.log10(e)) for name, e in excess.items()]
    return {"curves": curves, "drawn_iterations": _DRAWN_ITERATIONS}


def _median_excess(evidence: CloudSwarmEvidence, swarm: Mapping[int, RepeatedSearches]) -> Array:
    excess = np.concatenate([evidence.reproduction.excess_fitness(h, swarm[h]) for h in HEADINGS])
    return np.maximum(np.median(excess, axis=0), _LEAST_EXCESS)


@FACTS.declare
def histories(evidence: CloudSwarmEvidence) -> Facts:
    """Errors of five coefficients over the iterations of the first run."""
    swarm = evidence.off_centre(ICPSO)[FIGURE_HEADING]
    iterations = np.arange(len(swarm.trace), dtype=np.float64)
    errors = 100.0 * (swarm.trace / swarm.truth - 1.0)
    names = ("a33", "a55", "b33", "b55", "b53")
    return {"curves": [Curve(n, iterations, errors[:, COEFFICIENTS.index(n)]) for n in names]}
