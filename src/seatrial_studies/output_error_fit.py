"""Our estimator on the data of the papers' searches: output error by Levenberg-Marquardt from the physics start."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array
from seatrial.estimation.problem import LinearOutputError, Segments
from seatrial.numerics.optimise import Optimum, levenberg_marquardt
from seatrial.physics.models import physical_start_values
from seatrial_studies.seaway import HEAVE_NOISE, PITCH_NOISE
from seatrial_studies.swarm_search import STEP, SearchData

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
