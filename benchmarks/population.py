"""Fitness of a population of 40 heave-pitch candidates over 400 samples, beside JAX, NumPy, SciPy and python-control.

The job is the same for all: continuous matrices in, fitness out. For JAX and NumPy the march alone, with the discrete
matrices given, is reported as well, with our march alone.
"""

import subprocess
import tempfile
from pathlib import Path

import numpy as np
from against_shipmmg import peers_python
from measure import Line, at_least, at_most, fastest
from scipy.linalg import expm
from scipy.signal import lsim

from seatrial.numerics.kernels.linear_population import misfit
from seatrial.physics.models import heave_pitch_zoh
from seatrial.physics.models.published import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models.published import theoretical_coefficients
from seatrial.physics.simulate.population import (
    Forcing,
    affine_population_matrices,
    discretised_ramp,
    fitness,
    one_sample_fitness,
    trajectories,
)

HERE = Path(__file__).parent
COUNT, SAMPLES, DT = 40, 400, 0.5
START, SIGMA = np.zeros(4), np.array([0.01, 3.5e-4])


def discretised_by_scipy(A: np.ndarray, B: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Phi and [G0 | G1] by one call of SciPy's exponential for all block matrices (Van Loan 1978)."""
    block = np.zeros((len(A), 8, 8))
    block[:, :4, :4], block[:, :4, 4:6], block[:, 4:6, 6:] = A * DT, B * DT, np.eye(2)
    whole = expm(block)
    ramp = whole[:, :4, 6:]
    return whole[:, :4, :4], np.concatenate([whole[:, :4, 4:6] - ramp, ramp], axis=2)


def by_numpy(phi: np.ndarray, gamma: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Heave and pitch (count, samples, 2): all candidates at once, step after step."""
    x, y = np.zeros((len(phi), 4, 1)), np.empty((len(phi), len(v), 2))
    driven = np.einsum("cij,kj->kci", gamma, v)[..., None]
    for k in range(len(v)):
        y[:, k] = x[:, ::2, 0]
        x = phi @ x + driven[k]
    return y


def by_lsim(A: np.ndarray, B: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Heave and pitch (count, samples, 2), one candidate after the other."""
    t, C, D = np.arange(len(u)) * DT, np.eye(4)[[0, 2]], np.zeros((2, 2))
    return np.stack([lsim((a, b, C, D), u, t, START)[1] for a, b in zip(A, B, strict=True)])


def sum_of_squares(y: np.ndarray, measured: np.ndarray) -> np.ndarray:
    """Fitness (count,) of stored trajectories."""
    return (((y - measured) / SIGMA) ** 2).sum(axis=(1, 2))


def run() -> list[Line]:
    """Times of ours, ratios to the others, agreement of the motions."""
    rng = np.random.default_rng(20251)
    model = theoretical_coefficients(90).applied_to(heave_pitch_zoh())
    parameters = np.tile(model.parameters.values, (COUNT, 1))
    unknown = [model.parameters.index(name) for name in COEFFICIENTS]
    parameters[:, unknown] *= 1.0 + 0.1 * rng.uniform(-1.0, 1.0, (COUNT, 8))
    A, B = affine_population_matrices(model, parameters, (0, 1))
    u = np.sin(np.outer(np.arange(SAMPLES) * DT, [0.9, 1.3])) * [2e5, 2e6]
    forcing, held = Forcing(u, DT, is_held=False), Forcing(u, DT, is_held=True)
    y = trajectories(A, B, forcing, START)
    measured = y[0] + rng.normal(size=y[0].shape) * SIGMA
    phi, G0, G1 = discretised_ramp(A, B, DT)
    gamma, v = np.concatenate([G0, G1], axis=2), forcing.rows
    seconds = fastest(lambda: fitness(A, B, forcing, START, measured, SIGMA), 200)
    in_hold = fastest(lambda: fitness(A, B, held, START, measured, SIGMA), 200)
    stored = fastest(lambda: trajectories(A, B, forcing, START), 200)
    prepared = fastest(lambda: affine_population_matrices(model, parameters, (0, 1)), 200)
    one = fastest(lambda: one_sample_fitness(A, B, held, 9, y[0, 9, [0, 0, 1, 1]], measured[10], SIGMA), 200)
    what = f"{COUNT} candidates, {SAMPLES} samples"
    lines = [
        at_least(f"{what}: simulations a second, inputs held", COUNT / in_hold / 1e3, "k/s", 500.0),
        at_least(f"{what}: the same, inputs straight", COUNT / seconds / 1e3, "k/s", 500.0),
        Line("fitness of the population, inputs straight", 1e6 * seconds, "us"),
        Line("trajectories of the population", 1e6 * stored, "us"),
        Line("fitness of one sample", 1e6 * one, "us"),
        Line("matrices from coefficients", 1e6 * prepared, "us"),
    ]
    alone = _march_alone(phi, gamma, forcing, measured)
    numpy_seconds = fastest(lambda: sum_of_squares(by_numpy(*discretised_by_scipy(A, B), v), measured), 20)
    numpy_march = fastest(lambda: sum_of_squares(by_numpy(phi, gamma, v), measured), 20)
    lsim_seconds = fastest(lambda: sum_of_squares(by_lsim(A, B, u), measured), 3)
    lines += [
        at_least("ratio, NumPy vectorised over candidates", numpy_seconds / seconds, "x", 50.0),
        Line("ratio, NumPy, march alone", numpy_march / alone, "x"),
        at_least("ratio, scipy.signal.lsim", lsim_seconds / seconds, "x", 500.0),
        at_most("motion off NumPy, of the largest", _largest_difference(y, by_numpy(phi, gamma, v)), "", 1e-12),
        at_most("motion off lsim, of the largest", _largest_difference(y, by_lsim(A, B, u)), "", 1e-12),
    ]
    task = {"A": A, "B": B, "phi": phi, "gamma": gamma, "u": u, "v": v, "dt": DT, "start": START}
    return [*lines, *_peers({**task, "measured": measured, "sigma": SIGMA}, seconds, alone, y)]


def _largest_difference(y: np.ndarray, other: np.ndarray) -> float:
    return float((np.abs(y - other).max(axis=(0, 1)) / np.abs(other).max(axis=(0, 1))).max())


def _march_alone(phi: np.ndarray, gamma: np.ndarray, forcing: Forcing, measured: np.ndarray) -> float:
    seen, weight, cost = np.full((SAMPLES, 4), np.nan), np.ones(4), np.empty(COUNT)
    seen[:, ::2] = measured
    start = np.zeros((COUNT, 4))
    return fastest(lambda: misfit(phi, gamma, forcing.rows, 1, start, seen, weight, cost), 200)


def _peers(task: dict[str, np.ndarray], seconds: float, alone: float, y: np.ndarray) -> list[Line]:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        try:
            python = peers_python(folder / "peers")
        except subprocess.CalledProcessError:
            print("  left out: the peers' packages could not be installed")
            return []
        np.savez(folder / "task.npz", **task)
        subprocess.run([python, HERE / "peer_population.py", folder], check=True)
        theirs = dict(np.load(folder / "peer.npz"))
    return [
        at_least("ratio, JAX (vmap, scan, compiled)", float(theirs["jax_seconds"]) / seconds, "x", 10.0),
        Line("ratio, JAX, march alone", float(theirs["jax_march_seconds"]) / alone, "x"),
        at_least("ratio, python-control forced_response", float(theirs["control_seconds"]) / seconds, "x", 500.0),
        at_most("motion off JAX, of the largest", _largest_difference(y, theirs["jax"]), "", 1e-12),
        at_most("motion off python-control, of the largest", _largest_difference(y, theirs["control"]), "", 1e-12),
    ]
