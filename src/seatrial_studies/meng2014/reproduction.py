"""The paper's searches made again, and what they and the records show of the coefficients."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from enum import Enum, StrEnum
from functools import partial

import numpy as np
from numpy.typing import NDArray

from seatrial.core.values import Array, ProgressReporter
from seatrial.estimation.problem import LinearOutputError
from seatrial.estimation.search import Fitness
from seatrial.numerics.optimise import (
    Box,
    CloudParticleSwarm,
    CloudSettings,
    Optimiser,
    ParticleSwarm,
    Population,
    SwarmSettings,
    levenberg_marquardt,
    search,
)
from seatrial.physics.models import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models import HEAVE_PITCH_STIFFNESSES
from seatrial.problems import centred_box, off_centre_box
from seatrial_studies.controller_cost import ControllerCost, pitch_controller_costs
from seatrial_studies.heave_pitch_search import (
    MOTION_NOISE,
    NARROW_HALF_WIDTH,
    WIDE_HALF_WIDTH,
    OutputErrorResults,
    RepeatedSearches,
    SearchData,
    output_error_problem,
    repeat_searches,
    simulate_search_data,
    whole_record_objective,
    with_physics_start,
)
from seatrial_studies.seaway import HEAVE_NOISE, PITCH_NOISE
from seatrial_studies.study_file import read_study, study_setting

# The paper's searches made again, beside plain particle swarms, in boxes about the truth and beside it.

SOURCE = read_study("meng2014").source
SwarmFactory = Callable[[Box, np.random.Generator], Population]
# deg, headings of the paper's tables
HEADINGS = (0, 45, 90, 135, 180)
SEA_STATE_3 = study_setting("meng2014", "sea_state_3", float).value
NOISE = (HEAVE_NOISE, PITCH_NOISE)
ITERATIONS, RUNS = study_setting("meng2014", "iterations", int), study_setting("meng2014", "runs", int)
SHORTER_SHARES = study_setting("meng2014", "shorter_shares", list).value


class SwarmAlgorithm(StrEnum):
    """The paper's swarm, and the plain one with inertia that it springs from."""

    ICPSO = "ICPSO"
    PSO = "PSO"


class BoxPlacement(Enum):
    """Where is searched; the paper's box is not in our copy."""

    OFF_CENTRE = "±50 %, truth off centre"
    CENTRED = "±10 % about the truth"


def optimisers(iterations: int) -> dict[SwarmAlgorithm, SwarmFactory]:
    """As the paper sets them: 60 particles, c1 = c2 = 2.05, A 0.15, B 0.93, p_m 0.2; PSO with the constriction's."""
    return {
        SwarmAlgorithm.ICPSO: partial(CloudParticleSwarm, settings=CloudSettings(iterations=iterations)),
        SwarmAlgorithm.PSO: partial(ParticleSwarm, settings=SwarmSettings(population=60, iterations=iterations)),
    }


class CloudVariant(StrEnum):
    """ICPSO with one of its two uses of the cloud left out."""

    STEADY_WEIGHT = "ICPSO, weight without randomness (He = 0)"
    NO_MUTATION = "ICPSO without mutation"


@dataclass(frozen=True, eq=False)
class CloudSwarmReproduction:
    """Searches by setting, heading and algorithm; the seas by heading.

    Attributes:
        shorter_searches: of ICPSO off centre with fewer iterations, by their number and heading.
        unweighted_searches: off centre by eq. (4) as it is printed, without an inertia weight, by heading.
        variants: of ICPSO off centre, by variant and heading.
        noise_free_searches: of ICPSO off centre in the first sea without noise, by number of iterations and heading.
        iterations: of a search.
    """

    searches: dict[tuple[BoxPlacement, int, SwarmAlgorithm], RepeatedSearches]
    seas: dict[int, list[SearchData]]
    shorter_searches: dict[tuple[int, int], RepeatedSearches]
    unweighted_searches: dict[int, RepeatedSearches]
    variants: dict[tuple[CloudVariant, int], RepeatedSearches]
    noise_free_searches: dict[tuple[int, int], RepeatedSearches]
    iterations: int

    @property
    def run_count(self) -> int:
        """Return the runs at each heading."""
        return len(next(iter(self.seas.values())))

    def of_variant(self, variant: CloudVariant) -> dict[int, RepeatedSearches]:
        """Return the searches of a variant of ICPSO by heading."""
        return {heading: self.variants[variant, heading] for heading in HEADINGS}

    def excess_fitness(self, heading: int, searches: RepeatedSearches) -> Array:
        """Fitness off centre after each iteration over the better end of both swarms, less 1; (runs, iterations)."""
        ends = [self.searches[BoxPlacement.OFF_CENTRE, heading, a].histories[:, -1] for a in SwarmAlgorithm]
        return searches.histories / np.min(ends, axis=0)[:, None] - 1.0


def reproduce_searches(*, quick: bool, seed: int, report_progress: ProgressReporter) -> CloudSwarmReproduction:
    """Five runs of 1000 iterations; `quick`: three of 400."""
    runs, iterations = RUNS.in_version(quick=quick), ITERATIONS.in_version(quick=quick)
    report_progress("seas")
    seas = {heading: [_sea(heading, run, seed, NOISE) for run in range(runs)] for heading in HEADINGS}
    searches = {}
    for setting in BoxPlacement:
        report_progress(f"searches: {setting.value}")
        for heading, met in seas.items():
            for algorithm, make in optimisers(iterations).items():
                searches[setting, heading, algorithm] = _search(met, make, seed, setting)
    lengths = [round(share * iterations) for share in (*SHORTER_SHARES, 1.0)]
    report_progress("fewer iterations, and without noise")
    shorter, quiet = {}, {}
    for few in lengths:
        make = optimisers(few)[SwarmAlgorithm.ICPSO]
        for heading, met in seas.items():
            if few < iterations:
                shorter[few, heading] = _search(met, make, seed)
            quiet[few, heading] = _search([_sea(heading, 0, seed, (0.0, 0.0))], make, seed)
    report_progress("the law as printed, and the cloud left out")
    unweighted = {heading: _search(met, _unweighted_swarm(iterations), seed) for heading, met in seas.items()}
    variants = {
        (variant, heading): _search(met, _variant(variant, iterations), seed)
        for variant in CloudVariant
        for heading, met in seas.items()
    }
    return CloudSwarmReproduction(searches, seas, shorter, unweighted, variants, quiet, iterations)


def _sea(heading: int, run: int, seed: int, noise: tuple[float, float]) -> SearchData:
    rng = np.random.default_rng([seed, heading, run])
    return simulate_search_data(heading, rng, height=SEA_STATE_3, has_fin=True, noise=noise)


def _search(
    seas: list[SearchData], make: SwarmFactory, seed: int, setting: BoxPlacement = BoxPlacement.OFF_CENTRE
) -> RepeatedSearches:
    return repeat_searches(seas, _boxes(setting, seas, seed), make, _objective, seed)


def _unweighted_swarm(iterations: int) -> SwarmFactory:
    """Eq. (4) as printed: the velocity counts whole; velocities limited as ICPSO's."""
    cloud = CloudSettings()
    plain = SwarmSettings(cloud.population, iterations, 1.0, cloud.c1, cloud.c2, cloud.velocity_limit)
    return partial(ParticleSwarm, settings=plain)


def _variant(variant: CloudVariant, iterations: int) -> SwarmFactory:
    whole = CloudSettings(iterations=iterations)
    settings = {
        CloudVariant.STEADY_WEIGHT: replace(whole, He=0.0),
        CloudVariant.NO_MUTATION: replace(whole, p_m=0.0),
    }[variant]
    return partial(CloudParticleSwarm, settings=settings)


def _boxes(setting: BoxPlacement, seas: list[SearchData], seed: int) -> list[Box]:
    if setting is BoxPlacement.OFF_CENTRE:
        return off_centre_boxes(seas, seed)
    return [centred_box(seas[0].truth, NARROW_HALF_WIDTH)] * len(seas)


def off_centre_boxes(seas: list[SearchData], seed: int) -> list[Box]:
    """Return the box of each run off centre."""
    truth = seas[0].truth
    return [off_centre_box(truth, WIDE_HALF_WIDTH, np.random.default_rng([seed, 7, run])) for run in range(len(seas))]


def _objective(data: SearchData, _: Population) -> Fitness:
    return whole_record_objective(data)


# What the printed constants let the cloud do: the inertia weight of eq. (6), by formula and in the searches.

# draws of En' and r for the quantiles; ends of the central 95 %
_DRAWS, _CENTRAL_95 = 200_000, (0.025, 0.975)


@dataclass(frozen=True)
class CloudWeight:
    """The weight in the middle band A <= r <= B of r = f_best / f.

    Attributes:
        at_ends: weight at r = A and at r = B with En' = En.
        central: ends of the central 95 % of its draws, r uniform in the band, En' ~ N(En, He).
        mean, deviation: of these draws.
        band_shares: of all particles and iterations of the searches, below A, in the band, above B.
    """

    at_ends: tuple[float, float]
    central: tuple[float, float]
    mean: float
    deviation: float
    band_shares: tuple[float, float, float]


def cloud_weight(searches: list[tuple[SearchData, Box]], iterations: int, seed: int) -> CloudWeight:
    """Return the weight by formula, and the bands in which the particles of ICPSO's searches are."""
    settings = CloudSettings(iterations=iterations)
    rng = np.random.default_rng([seed, 37])
    ratio = rng.uniform(settings.A, settings.B, _DRAWS)
    weight = inertia_weight(ratio, rng.normal(settings.En, settings.He, _DRAWS), settings)
    low, high = np.quantile(weight, _CENTRAL_95)
    ends = inertia_weight(np.array([settings.A, settings.B]), np.full(2, settings.En), settings)
    ratios = np.concatenate([_fitness_ratios(data, box, settings, [seed, k]) for k, (data, box) in enumerate(searches)])
    below, above = float(np.mean(ratios < settings.A)), float(np.mean(ratios > settings.B))
    return CloudWeight(
        (float(ends[0]), float(ends[1])),
        (float(low), float(high)),
        float(weight.mean()),
        float(weight.std()),
        (below, 1.0 - below - above, above),
    )


def inertia_weight(ratio: Array, entropy: Array, settings: CloudSettings) -> Array:
    """Return eq. (6) in the middle band: w1 - (w1 - w2) exp(-(r - Ex)^2 / (2 En'^2)), Ex = 5 w1 - w2."""
    expectation = 5.0 * settings.w1 - settings.w2
    drop = np.exp(-0.5 * ((ratio - expectation) / entropy) ** 2)
    return settings.w1 - (settings.w1 - settings.w2) * drop


def _fitness_ratios(data: SearchData, box: Box, settings: CloudSettings, seed: list[int]) -> Array:
    """Best fitness so far over that of each particle, at every iteration, (iterations x population,)."""
    optimiser: Optimiser = CloudParticleSwarm(box, np.random.default_rng(seed), settings)
    objective = whole_record_objective(data)
    ratios: list[Array] = []
    best = np.inf

    def recorded(points: Array) -> Array:
        nonlocal best
        fitness = objective(points)
        best = min(best, float(fitness.min()))
        ratios.append(best / fitness)
        return fitness

    search(optimiser, recorded)
    return np.concatenate(ratios)


# Everything the verdicts rest on, and the few numbers they share.

SAME_POINT = study_setting("meng2014", "same_point", float).value


@dataclass(frozen=True, eq=False)
class UndetectedChange:
    """Wrong coefficients that follow the record: relative changes (8,), rms of heave [m] and of pitch [deg]."""

    relative_change: Array
    heave_rms: float
    pitch_rms: float


@dataclass(frozen=True, eq=False)
class TwelveUnknowns:
    """The twelve unknowns of the print.

    Attributes:
        curvatures: of the flattest direction over the steepest, by what moves the ship; 1: equally steep.
        errors: largest relative error of our noise-free fit of all twelve in waves with a fin, by heading.
    """

    curvatures: dict[str, float]
    errors: dict[int, float]


@dataclass(frozen=True, eq=False)
class CloudSwarmEvidence:
    """All numbers of the study."""

    reproduction: CloudSwarmReproduction
    output_error: dict[int, OutputErrorResults]
    twelve_unknowns: TwelveUnknowns
    undetected_change: UndetectedChange
    cloud_weight: CloudWeight
    controllers: dict[int, tuple[ControllerCost, ...]]

    def off_centre(self, algorithm: SwarmAlgorithm) -> dict[int, RepeatedSearches]:
        """Return the searches in the box off centre by heading."""
        return {h: self.reproduction.searches[BoxPlacement.OFF_CENTRE, h, algorithm] for h in HEADINGS}

    def mean_error(self, setting: BoxPlacement, algorithm: SwarmAlgorithm, heading: int) -> float:
        """Return the mean relative error over coefficients and runs, per cent."""
        return 100.0 * float(np.mean(self.reproduction.searches[setting, heading, algorithm].mean_error))

    def output_error_percent(self, heading: int) -> float:
        """Ours with the same noise, per cent."""
        return 100.0 * float(np.mean(np.abs(self.output_error[heading].noisy_errors)))

    @property
    def noise_allowance(self) -> float:
        """Return the excess of fitness that the noise explains.

        A sum of squares of n residuals larger by one variance has a root larger by 1 / (2 n).
        """
        return 0.5 / self.reproduction.seas[HEADINGS[0]][0].measured.size

    def is_stuck(self, searches: Mapping[int, RepeatedSearches]) -> NDArray[np.bool_]:
        """Runs off centre that end above the better fitness of both swarms by more than noise, (headings, runs)."""
        ends = [self.reproduction.excess_fitness(h, found)[:, -1] for h, found in searches.items()]
        return np.array(ends) > self.noise_allowance

    def iterations_needed(self, searches: Mapping[int, RepeatedSearches]) -> Array:
        """Return the iteration at which runs reach that fitness within noise, (headings, runs); infinite if never."""
        excess = np.array([self.reproduction.excess_fitness(h, found) for h, found in searches.items()])
        reached = excess <= self.noise_allowance
        return np.where(reached.any(axis=2), reached.argmax(axis=2).astype(np.float64), np.inf)

    @property
    def output_error_ratio(self) -> float:
        """Return the root mean square of our errors in noise over their Cramer-Rao bound, all headings."""
        return float(np.sqrt(np.mean([self.output_error[h].error_over_bound ** 2 for h in HEADINGS])))

    @property
    def same_minimum_share(self) -> float:
        """Return the share of runs off centre in which both swarms end at the same point."""
        icpso, pso = (self.off_centre(a) for a in SwarmAlgorithm)
        away = [np.abs(icpso[h].errors - pso[h].errors).max(axis=1) for h in HEADINGS]
        return float(np.mean(np.array(away) < SAME_POINT))

    @property
    def swarm_ratio(self) -> float:
        """Return the same of ICPSO's errors off centre."""
        pairs = [
            (f.errors, self.output_error[h].cramer_rao_bound) for h, f in self.off_centre(SwarmAlgorithm.ICPSO).items()
        ]
        return float(np.sqrt(np.mean([(errors / bound) ** 2 for errors, bound in pairs])))

    @property
    def time_ratio(self) -> float:
        """Time of a run of ICPSO over that of our noise-free fit, mean over the headings."""
        swarm = [f.seconds for f in self.off_centre(SwarmAlgorithm.ICPSO).values()]
        return float(np.mean(swarm) / np.mean([self.output_error[h].seconds for h in HEADINGS]))

    @property
    def simulation_ratio(self) -> float:
        """Return the records that a run of ICPSO simulates over those of our fit, least over the headings.

        An evaluation of ours simulates the record and its slope by each coefficient.
        """
        swarm = self.off_centre(SwarmAlgorithm.ICPSO)
        simulated = {h: self.output_error[h].evaluations * (1 + len(COEFFICIENTS)) for h in HEADINGS}
        return min(float(swarm[h].evaluations[0]) / simulated[h] for h in HEADINGS)


# What the record says of the unknowns: twelve of the print, and changes of the eight that it does not see.

# a sea too low to move the ship [m]
CALM_SEA_HEIGHT = 1e-6
# shares by which the stiffnesses start beside their theory; at 0 and 45 degrees one of them ends in a local minimum
_STIFFNESS_OFFSETS = (0.1, -0.1)
# relative cost below which a step counts as none
_NEGLIGIBLE = 1e-10
BEAM_WAVES, ONE_FIN, WAVES_AND_FIN = "beam waves alone", "one fin alone", "waves and fin"


def twelve_unknowns(seed: int) -> TwelveUnknowns:
    """Return the curvature of the flattest direction of all twelve, and errors of a noise-free fit of them."""
    rows = (
        (BEAM_WAVES, False, 90, SEA_STATE_3),
        (ONE_FIN, True, 135, CALM_SEA_HEIGHT),
        (WAVES_AND_FIN, True, 135, SEA_STATE_3),
    )
    curvatures = {}
    for name, has_fin, heading, height in rows:
        rng = np.random.default_rng([seed, 5])
        data = simulate_search_data(heading, rng, height=height, has_fin=has_fin)
        curvatures[name] = _least_relative_curvature(twelve_unknown_problem(data))
    errors = {}
    for heading in HEADINGS:
        rng = np.random.default_rng([seed, 6, heading])
        errors[heading] = _fit_error(simulate_search_data(heading, rng, height=SEA_STATE_3, has_fin=True))
    return TwelveUnknowns(curvatures, errors)


def twelve_unknown_problem(data: SearchData) -> LinearOutputError:
    """Return the noise-free run with all twelve coefficients free, stiffnesses at their true values."""
    clean = output_error_problem(data, data.states[:, [0, 2]])
    freed = data.model.parameters.freed(*HEAVE_PITCH_STIFFNESSES)
    return type(clean)(data.model.with_parameters(freed), clean.data, MOTION_NOISE, np.zeros(4))


def _least_relative_curvature(problem: LinearOutputError) -> float:
    hessian = problem.normal(problem.start(), problem.given_initial_states()).hessian
    scale = 1.0 / np.sqrt(np.diag(hessian))
    values = np.linalg.eigvalsh(hessian * scale[:, None] * scale[None, :])
    return float(abs(values[0]) / values[-1])


def _fit_error(data: SearchData) -> float:
    """Largest relative error of the twelve, the better of two starts: physics, stiffnesses on either side of theirs."""
    problem = twelve_unknown_problem(data)
    parameters = problem.model.parameters
    truth = np.array([parameters[name].value for name in parameters.free_names])
    is_stiffness = np.isin(parameters.free_names, list(HEAVE_PITCH_STIFFNESSES))
    physics = with_physics_start(problem.model).parameters
    begun = np.array([physics[name].value for name in parameters.free_names])
    solutions = [
        levenberg_marquardt(
            problem,
            np.where(is_stiffness, (1.0 + offset) * truth, begun),
            problem.given_initial_states(),
            negligible=_NEGLIGIBLE,
        ).solution
        for offset in _STIFFNESS_OFFSETS
    ]
    best = min(solutions, key=lambda solution: solution.value)
    return float(np.max(np.abs(best.point / truth - 1.0)))


def undetected_change(data: SearchData) -> UndetectedChange:
    """A step along the flattest direction of the eight, so long that the motions differ by no more than the noise."""
    clean = output_error_problem(data, data.states[:, [0, 2]])
    size = np.abs(data.truth)
    hessian = clean.normal(data.truth, clean.given_initial_states()).hessian * size[:, None] * size[None, :]
    values, vectors = np.linalg.eigh(hessian)
    change = vectors[:, 0] * np.sqrt(len(data.states) / values[0])
    moved = data.truth + change * size
    rms = np.sqrt(2.0 * clean.cost(moved, clean.given_initial_states()) / (2.0 * len(data.states)))
    return UndetectedChange(change, float(rms * MOTION_NOISE[0]), float(np.degrees(rms * MOTION_NOISE[1])))


# Controllers tuned on the coefficients of the swarms and on ours; the paper's own are lost with its table.


def controllers(
    reproduction: CloudSwarmReproduction, output_error: dict[int, OutputErrorResults], seed: int
) -> dict[int, tuple[ControllerCost, ...]]:
    """Return, by heading, controllers tuned on first runs off centre: of both swarms, of eq. (4) as printed, ours."""
    columns, truths = {}, {}
    for heading in HEADINGS:
        truths[heading] = reproduction.seas[heading][0].truth
        swarms = {a: reproduction.searches[BoxPlacement.OFF_CENTRE, heading, a] for a in SwarmAlgorithm}
        columns[heading] = {
            **{f"{a}, one run": found.points[0] for a, found in swarms.items()},
            "PSO by eq. (4), the base method, one run": reproduction.unweighted_searches[heading].points[0],
            "ours, one run": truths[heading] * (1.0 + output_error[heading].noisy_errors[0]),
        }
    return pitch_controller_costs(columns, truths, SEA_STATE_3, seed)
