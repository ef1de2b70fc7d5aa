"""Our estimator on the paper's data: output error from the physics start; and what holding the wave force costs."""

import time
from dataclasses import dataclass, replace

import numpy as np

from seatrial.equations import Model
from seatrial.models.heave_pitch import COEFFICIENTS, heave_pitch_held, physics_start
from seatrial.models.qi2025 import HEADINGS
from seatrial.optimise import levenberg_marquardt
from seatrial.problem.output_error import OutputError
from seatrial.problem.segments import Segments, cut
from seatrial.studies.seaway import HEAVE_NOISE, PITCH_NOISE, Voyage, ship
from seatrial.studies.seaway import sailed as at_sea
from seatrial.studies.swarm_search import STEP, Data
from seatrial.values import Array

NOISE = np.array([HEAVE_NOISE, PITCH_NOISE])
CONTINUOUS = Voyage(135, dt=0.1, every=5, has_fin=False, noise=(0.0, 0.0))


@dataclass(frozen=True, eq=False)
class Ours:
    """Relative errors of each run, (runs, 8), noise-free and with 1 cm / .02 deg, and the time of a noise-free fit [s].

    Attributes:
        bound: standard errors of the Cramer-Rao bound over the truth, (8,).
        evaluations: of a fit.
    """

    exact: Array
    noisy: Array
    bound: Array
    seconds: float
    evaluations: int


def started(model: Model) -> Model:
    """The model with the coefficients of the physics start."""
    known = dict(zip(model.parameters.names, map(float, model.parameters.values), strict=True))
    return model.with_values(physics_start(known))


def _problem(data: Data, measured: Array) -> OutputError:
    inputs = np.zeros((len(data.forces), 4))
    inputs[:, :2] = data.forces
    rows = len(inputs)
    segments = Segments(
        inputs, measured, np.array([0, rows]), np.zeros(1, dtype=np.int64), np.zeros(1, dtype=np.int64),
        ("run",), ("run",), ("z", "theta"), STEP,
    )  # fmt: skip
    return OutputError(started(data.model), segments, NOISE)


def ours(seas: list[Data], seed: int) -> Ours:
    """All seas of one heading, from the physics start, initial state free."""
    exact, noisy, seconds, evaluations, bound = [], [], [], 0, np.zeros(8)
    for run, data in enumerate(seas):
        problem = _problem(data, data.states[:, [0, 2]])
        begun = time.perf_counter()
        found = levenberg_marquardt(problem, problem.start(), problem.measured_starts(), negligible=1e-12)
        seconds.append(time.perf_counter() - begun)
        evaluations = found.solution.evaluations
        exact.append(found.solution.point / data.truth - 1.0)
        bound = np.sqrt(np.diag(np.linalg.inv(found.normal.reduced()[1]))) / np.abs(data.truth)
        rng = np.random.default_rng([seed, 11, data.heading, run])
        measured = problem.data.measured + NOISE * rng.standard_normal((len(data.states), 2))
        disturbed = replace(problem, data=replace(problem.data, measured=measured))
        again = levenberg_marquardt(disturbed, disturbed.start(), disturbed.measured_starts())
        noisy.append(again.solution.point / data.truth - 1.0)
    return Ours(np.array(exact), np.array(noisy), bound, float(np.median(seconds)), evaluations)


def hold_bias(seed: int) -> dict[int, tuple[Array, Array]]:
    """Errors without any noise of data from continuous waves at .5 s, by heading: held between samples, and exact."""
    made = {}
    for heading in HEADINGS:
        voyage = replace(CONTINUOUS, heading=heading)
        record = at_sea(voyage, np.random.default_rng([seed, 13, heading])).record
        truth = ship(heading)
        true = np.array([truth.parameters[n].value for n in COEFFICIENTS])
        coarse = record.rows(slice(None, None, voyage.every))
        held = heave_pitch_held().with_parameters(truth.parameters)
        errors = []
        for model, used in ((held, coarse), (truth, record)):
            problem = OutputError(started(model), cut(model, [used], ("z", "theta"), None), NOISE)
            found = levenberg_marquardt(problem, problem.start(), problem.measured_starts())
            errors.append(found.solution.point / true - 1.0)
        made[heading] = (errors[0], errors[1])
    return made
