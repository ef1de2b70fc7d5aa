"""Run by the peers' own Python: the populations of `task.npz` with JAX and python-control, into `peer.npz`.

Usage: python peer_population.py FOLDER
"""

import sys
import time
from collections.abc import Callable
from pathlib import Path

import control
import jax
import jax.numpy as jnp
import numpy as np

jax.config.update("jax_enable_x64", True)


def fastest(function: Callable[[], object], repeats: int) -> float:
    """Shortest of several runs [s], after one that compiles."""
    function()
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        function()
        times.append(time.perf_counter() - began)
    return min(times)


@jax.jit
def states(phi: jax.Array, gamma: jax.Array, v: jax.Array, start: jax.Array) -> jax.Array:
    """Heave and pitch (count, rows, 2) of all candidates: a scan over the steps, mapped over the candidates."""

    def one(e: jax.Array, g: jax.Array) -> jax.Array:
        def step(x: jax.Array, u: jax.Array) -> tuple[jax.Array, jax.Array]:
            return e @ x + g @ u, x[jnp.array([0, 2])]

        return jax.lax.scan(step, start, v)[1]

    return jax.vmap(one)(phi, gamma)


@jax.jit
def fitness(
    phi: jax.Array, gamma: jax.Array, v: jax.Array, start: jax.Array, measured: jax.Array, weight: jax.Array
) -> jax.Array:
    """Sum of weighted squared residuals, accumulated in the scan: nothing is stored."""

    def one(e: jax.Array, g: jax.Array) -> jax.Array:
        def step(carry: tuple[jax.Array, jax.Array], row: tuple[jax.Array, jax.Array]) -> tuple:
            (x, total), (u, seen) = carry, row
            off = x[jnp.array([0, 2])] - seen
            return (e @ x + g @ u, total + (weight * off * off).sum()), None

        return jax.lax.scan(step, (start, jnp.zeros(())), (v, measured))[0][1]

    return jax.vmap(one)(phi, gamma)


@jax.jit
def from_matrices(
    A: jax.Array, B: jax.Array, dt: float, v: jax.Array, start: jax.Array, measured: jax.Array, weight: jax.Array
) -> jax.Array:
    """The same with discretisation by one exponential of the block matrix (Van Loan 1978), mapped over candidates."""

    def discrete(a: jax.Array, b: jax.Array) -> tuple[jax.Array, jax.Array]:
        block = jnp.zeros((8, 8)).at[:4, :4].set(a * dt).at[:4, 4:6].set(b * dt).at[4:6, 6:].set(jnp.eye(2))
        whole = jax.scipy.linalg.expm(block)
        held, ramp = whole[:4, 4:6], whole[:4, 6:]
        return whole[:4, :4], jnp.hstack([held - ramp, ramp])

    return fitness(*jax.vmap(discrete)(A, B), v, start, measured, weight)


def controlled(A: np.ndarray, B: np.ndarray, t: np.ndarray, u: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Heave and pitch by python-control, one candidate after the other; inputs straight between samples."""
    C, D = np.eye(4)[[0, 2]], np.zeros((2, 2))
    systems = [control.ss(a, b, C, D) for a, b in zip(A, B, strict=True)]
    return np.stack([control.forced_response(system, t, u.T, start).outputs.T for system in systems])


def main(folder: Path) -> None:
    """Trajectories and times of both peers."""
    task = np.load(folder / "task.npz")
    phi, gamma, v, start = (jnp.asarray(task[name]) for name in ("phi", "gamma", "v", "start"))
    measured, weight = jnp.asarray(task["measured"]), jnp.asarray(1.0 / task["sigma"] ** 2)
    t = np.arange(len(task["u"])) * float(task["dt"])
    A, B, dt = jnp.asarray(task["A"]), jnp.asarray(task["B"]), float(task["dt"])
    run = (task["A"], task["B"], t, task["u"], task["start"])
    np.savez(
        folder / "peer.npz",
        jax=np.asarray(states(phi, gamma, v, start)),
        control=controlled(*run),
        jax_seconds=fastest(lambda: from_matrices(A, B, dt, v, start, measured, weight).block_until_ready(), 50),
        jax_march_seconds=fastest(lambda: fitness(phi, gamma, v, start, measured, weight).block_until_ready(), 50),
        control_seconds=fastest(lambda: controlled(*run), 3),
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]))
