"""Searches for heave-pitch coefficients as the papers have them, and output error on the same data."""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import cache, partial

import numpy as np
from scipy.stats import binomtest

from seatrial.core.equations import Model
from seatrial.core.values import Array
from seatrial.estimation.problem import LinearOutputError, Segments
from seatrial.estimation.search import (
    Fitness,
    JudgedRun,
    LinearCandidates,
    one_sample_fitness,
    run_search,
    whole_record_fitness,
)
from seatrial.numerics.optimise import Box, Optimum, Population, levenberg_marquardt
from seatrial.physics.models import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models import heave_pitch_zoh, physical_start_values
from seatrial.physics.sea import ittc, realise
from seatrial.physics.simulate import Forcing, LinearBatch
from seatrial_studies.seaway import (
    FIN,
    HEAVE_NOISE,
    PITCH_NOISE,
    SIGNIFICANT_HEIGHT,
    SPEED,
    box_hull,
    fin_commands,
    theoretical_coefficients,
)

# Which of two paired samples is the smaller one: the sign test.

SIGNIFICANCE = 0.05
"""Probability with which chance alone gives a verdict; our choice."""


def is_smaller(one: Array, other: Array) -> bool:
    """Return whether `one` is smaller in more pairs than chance explains (one-sided sign test); ties do not count."""
    wins, losses = int(np.sum(one < other)), int(np.sum(one > other))
    return wins + losses > 0 and float(binomtest(wins, wins + losses, alternative="greater").pvalue) < SIGNIFICANCE


# Swarms that look for heave-pitch coefficients as the papers have them: data, fitness, boxes, repeated searches.

# s, sampling interval of the papers' records
STEP = 0.5
# half widths of the search box, shares of the truth; our choice
NARROW_HALF_WIDTH, WIDE_HALF_WIDTH = 0.1, 0.5
# samples of 200 s, both ends counted
SAMPLES = 401
# F3 and M5 among the model's inputs, z and theta among its states
WAVE_FORCE_INPUTS, HEAVE_AND_PITCH = (0, 1), (0, 2)


def held_force_ship(heading: int, *, printed_sign: bool = False) -> Model:
    """The papers' ship, wave force held; at 0 and 45 degrees the coefficients of the 90 degree column, assumed."""
    known = theoretical_coefficients(heading if heading >= 90 else 90, printed_sign=printed_sign)
    return known.applied_to(heave_pitch_zoh())


@dataclass(frozen=True, eq=False)
class SearchData:
    """One sea met by the ship at one heading, as the papers simulate it: samples every 0.5 s, forces held.

    Attributes:
        truth: (8,), in the order of COEFFICIENTS; states: (n, 4), noise-free; measured: (n, 2), with noise if any.
        forces: F3 [N] and M5 [N m] of waves and fin, (n, 2), in the model's axes.
    """

    heading: int
    model: Model
    truth: Array
    states: Array
    measured: Array
    forces: Array

    @property
    def forcing(self) -> Forcing:
        """Return the forcing that all candidates meet."""
        return Forcing(self.forces, STEP, is_held=True)


def simulate_search_data(
    heading: int,
    rng: np.random.Generator,
    *,
    height: float = SIGNIFICANT_HEIGHT,
    samples: int = SAMPLES,
    has_fin: bool = False,
    noise: tuple[float, float] = (0.0, 0.0),
    printed_sign: bool = False,
    ship: Model | None = None,
) -> SearchData:
    """Return a realisation of 30 equally spaced lines (Qi et al. 2025, eq. (14)) met by the ship, from rest.

    ship: the truth; without it the papers' ship at that heading.
    """
    model = ship or held_force_ship(heading, printed_sign=printed_sign)
    lines = realise(ittc(height), SPEED, math.radians(heading), rng)
    when = np.arange(samples) * STEP
    turning = np.exp(1j * np.outer(when, lines.omega_e))
    forces = -(turning @ lines.forces(box_hull())).real
    if has_fin:
        angle = fin_commands(samples, STEP, rng)
        lift = -FIN["lift_1"] * angle
        forces = forces + np.stack([lift, -FIN["x_f1"] * lift], axis=1)
    inputs = np.zeros((samples, 4))
    inputs[:, :2] = forces
    batch = LinearBatch(model, inputs, np.array([0, samples]), STEP, model.states)
    states = batch.simulate(0, 1, np.zeros((1, 4)), model.parameters.values[None], np.empty((1, 0)))[0]
    measured = states[:, [0, 2]] + rng.standard_normal((samples, 2)) * noise
    truth = np.array([model.parameters[n].value for n in COEFFICIENTS])
    return SearchData(heading, model, truth, states, measured, np.ascontiguousarray(forces))


class PitchUnit(Enum):
    """In what unit pitch enters the fitness beside metres of heave; the papers do not say."""

    DEGREES = math.radians(1.0)
    RADIANS = 1.0


@cache
def _known_ship() -> Model:
    """The ship of which only the eight coefficients are unknown; those it has here do not matter."""
    return held_force_ship(90)


def candidates_for(
    data: SearchData, pitch_unit: PitchUnit = PitchUnit.DEGREES, *, starts_from_truth: bool = False
) -> LinearCandidates:
    """Return candidates for the eight coefficients, judged by one sea from rest, everything else as in the ship.

    starts_from_truth: whether a step from sample to sample begins in the true state.
    """
    run = JudgedRun(data.forcing, data.states[0], data.measured, data.states if starts_from_truth else None)
    return LinearCandidates(
        _known_ship(), COEFFICIENTS, WAVE_FORCE_INPUTS, (run,), HEAVE_AND_PITCH, np.array([1.0, pitch_unit.value])
    )


def candidate_matrices(points: Array) -> tuple[Array, Array]:
    """Return A and B of candidates (count, 8), everything else as in the ship."""
    candidates = LinearCandidates(_known_ship(), COEFFICIENTS, WAVE_FORCE_INPUTS, (), HEAVE_AND_PITCH, np.ones(2))
    return candidates.matrices(points)


def one_sample_objective(data: SearchData, optimiser: Population, pitch_unit: PitchUnit = PitchUnit.DEGREES) -> Fitness:
    """Eq. (28): iteration k compares sample k alone, one step from the true state before it (our choice: generous)."""
    return one_sample_fitness(candidates_for(data, pitch_unit, starts_from_truth=True), optimiser)


def whole_record_objective(data: SearchData, pitch_unit: PitchUnit = PitchUnit.DEGREES) -> Fitness:
    """Eq. (27): root mean square over the whole record."""
    return whole_record_fitness(candidates_for(data, pitch_unit))


@dataclass(frozen=True, eq=False)
class RepeatedSearches:
    """Repeated searches of one optimiser for one truth.

    Attributes:
        points: what each run found, (runs, 8); evaluations: candidates that each judged, (runs,).
        seconds: time of one run, median.
        traces: best point of each run after each iteration, (runs, iterations, 8).
        histories: best fitness of each run after each iteration, (runs, iterations).
        lower_bounds: lower ends of each run's box, by magnitude, (runs, 8).
    """

    truth: Array
    points: Array
    evaluations: Array
    lower_bounds: Array
    seconds: float
    traces: Array
    histories: Array

    @property
    def trace(self) -> Array:
        """Return the best point after each iteration of the first run, (iterations, 8)."""
        return self.traces[0]

    @property
    def best_fitness(self) -> Array:
        """Return the best fitness of the first run after each iteration, (iterations,)."""
        return self.histories[0]

    @property
    def errors(self) -> Array:
        """Return the relative errors of all runs, (runs, 8)."""
        return self.points / self.truth - 1.0

    @property
    def error_of_mean(self) -> Array:
        """Return the relative error of the mean of the runs, as the papers print it, (8,)."""
        return np.abs(np.mean(self.points, axis=0) / self.truth - 1.0)

    @property
    def mean_error(self) -> Array:
        """Return the mean of the runs' relative errors, (8,)."""
        return np.mean(np.abs(self.errors), axis=0)

    @property
    def scatter(self) -> float:
        """Return the standard deviation over the runs, relative to the truth, mean over the coefficients."""
        return float(np.mean(np.std(self.errors, axis=0, ddof=1)))


def repeat_searches(
    seas: list[SearchData],
    boxes: list[Box],
    make_optimiser: Callable[[Box, np.random.Generator], Population],
    make_objective: Callable[[SearchData, Population], Fitness],
    seed: int,
    first_run: int = 0,
) -> RepeatedSearches:
    """One run in each sea and box, each with a generator of its own, numbered from `first_run`."""
    finished, clock = [], [time.perf_counter()]
    for run, (data, box) in enumerate(zip(seas, boxes, strict=True), start=first_run):
        finished.append(run_search(box, make_optimiser, partial(make_objective, data), seed, run))
        clock.append(time.perf_counter())
    seconds = float(np.median(np.diff(clock)))
    truth = seas[0].truth
    lower = np.array([np.where(truth > 0, b.lower, b.upper) for b in boxes])
    points = np.array([f.solution.point for f in finished])
    evaluations = np.array([f.solution.evaluations for f in finished])
    histories = np.array([f.solution.history for f in finished])
    traces = np.array([f.trace for f in finished])
    return RepeatedSearches(truth, points, evaluations, lower, seconds, traces, histories)


# Our estimator on the data of the papers' searches: output error by Levenberg-Marquardt from the physics start.

MOTION_NOISE = np.array([HEAVE_NOISE, PITCH_NOISE])
# tolerance at which the fit of noise-free data ends; our choice
_EXACT = 1e-8


@dataclass(frozen=True, eq=False)
class OutputErrorResults:
    """Relative errors of each run, (runs, 8), noise-free and with 1 cm / 0.02 deg.

    Attributes:
        cramer_rao_bound: standard errors of the Cramer-Rao bound over the truth, (runs, 8).
        seconds: median time of a noise-free fit; evaluations: of one, the most over the runs.
    """

    noise_free_errors: Array
    noisy_errors: Array
    cramer_rao_bound: Array
    seconds: float
    evaluations: int

    @property
    def error_over_bound(self) -> float:
        """Return the root mean square of the errors in noise over their bound."""
        return float(np.sqrt(np.mean((self.noisy_errors / self.cramer_rao_bound) ** 2)))


def with_physics_start(model: Model) -> Model:
    """Return the model with the coefficients of the physics start."""
    known = dict(zip(model.parameters.names, map(float, model.parameters.values), strict=True))
    return model.with_values(physical_start_values(known))


def output_error_problem(data: SearchData, measured: Array) -> LinearOutputError:
    """Return the run from rest, as the searches have it; coefficients start from physics."""
    inputs = np.zeros((len(data.forces), 4))
    inputs[:, :2] = data.forces
    one = np.zeros(1, dtype=np.int64)
    whole = np.array([0, len(inputs)], dtype=np.int64)
    segments = Segments(inputs, measured, whole, one, one, ("run",), ("run",), ("z", "theta"), STEP)
    return LinearOutputError(with_physics_start(data.model), segments, MOTION_NOISE, np.zeros(4))


def fit_output_error(problem: LinearOutputError, negligible: float = 1e-6) -> Optimum:
    """Return the optimum from the start."""
    return levenberg_marquardt(problem, problem.start(), problem.given_initial_states(), negligible=negligible)


def _with_noise(data: SearchData, rng: np.random.Generator) -> Array:
    """What was measured; with a draw of noise where the sensors had none."""
    if np.array_equal(data.measured, data.states[:, [0, 2]]):
        return data.measured + MOTION_NOISE * rng.standard_normal(data.measured.shape)
    return data.measured


def output_error_results(seas: Sequence[SearchData], seed: int) -> OutputErrorResults:
    """Return all seas of one heading, without noise and with a draw of it."""
    exact, noisy, bound, seconds, evaluations = [], [], [], [], 0
    for run, data in enumerate(seas):
        clean = output_error_problem(data, data.states[:, [0, 2]])
        fit_output_error(clean, _EXACT)  # what is prepared once a record does not count
        begun = time.perf_counter()
        found = fit_output_error(clean, _EXACT)
        seconds.append(time.perf_counter() - begun)
        evaluations = max(evaluations, found.solution.evaluations)
        exact.append(found.solution.point / data.truth - 1.0)
        bound.append(np.sqrt(np.diag(np.linalg.inv(found.normal.hessian))) / np.abs(data.truth))
        measured = _with_noise(data, np.random.default_rng([seed, 11, data.heading, run]))
        disturbed = replace(clean, data=replace(clean.data, measured=measured))
        noisy.append(fit_output_error(disturbed).solution.point / data.truth - 1.0)
    return OutputErrorResults(np.array(exact), np.array(noisy), np.array(bound), float(np.median(seconds)), evaluations)
