"""What the record says of the unknowns: twelve of the print, and changes of the eight that it does not see."""

import numpy as np

from seatrial.estimation.problem import LinearOutputError
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.physics.models import HEAVE_PITCH_STIFFNESSES
from seatrial_studies.meng2014.evidence import TwelveUnknowns, UndetectedChange
from seatrial_studies.meng2014.reproduction import HEADINGS, SEA_STATE_3
from seatrial_studies.output_error_fit import MOTION_NOISE, output_error_problem, with_physics_start
from seatrial_studies.swarm_search import SearchData, simulate_search_data

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
