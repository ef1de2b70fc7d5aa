"""A sampled controller in steps: its blocks by Tustin's rule, sensor and servo exactly, the dead time as a queue."""

import math
from collections.abc import Mapping

import numpy as np
from scipy.linalg import expm

from seatrial.core.values import Array, InputError
from seatrial.numerics.kernels import feedback as kernel
from seatrial.physics.loops import Block, TransferLoop
from seatrial.physics.loops.block import controllable_form, in_series
from seatrial.physics.loops.discrete import difference_equation, holding_terms
from seatrial.physics.loops.sampling import Sampling

_WHOLE = 1e-6  # of a sample: a step that divides it
_TRIED = 40  # numbers of steps a sample that are tried, for one in which the dead time is whole; chosen
_NEAR = 0.02  # of a step: a dead time that counts as whole; chosen
_NOISE_STREAM = 12  # of random numbers, apart from those of disturbances of the same seed; chosen
_FINEST = 0.2  # of the dead time, the longest step where there is one; chosen


def simulation_step(sampling: Sampling | None, longest: float) -> float:
    """Return the longest step [s] up to `longest` that divides the sample time, and the dead time as well as can be."""
    if sampling is None:
        return longest
    T, dead = sampling.sample_s, sampling.dead_time
    least = max(1, math.ceil(T / min(longest, _FINEST * dead if dead else math.inf) - _WHOLE))
    counts = range(least, least + _TRIED)
    misses = {count: abs(dead * count / T - round(dead * count / T)) for count in counts}
    return T / next((count for count, miss in misses.items() if miss < _NEAR), min(misses, key=misses.__getitem__))


def steps_a_sample(sampling: Sampling, dt: float) -> int:
    """Return how many steps of dt [s] make a sample.

    Raises:
        InputError: they do not make one.
    """
    every = round(sampling.sample_s / dt)
    if every < 1 or abs(every * dt - sampling.sample_s) > _WHOLE * sampling.sample_s:
        raise InputError(
            f"steps of {dt:g} s do not make a sample of {sampling.sample_s:g} s; give a step that divides it"
        )
    return every


def sample_noise(sampling: Sampling, count: int, seed: int) -> Array:
    """Return the noise of so many samples, (n,)."""
    if not sampling.noise:
        return np.zeros(count)
    return sampling.noise * np.random.default_rng([seed, _NOISE_STREAM]).standard_normal(count)


def sampled_body(
    loop: TransferLoop, gains: Array, dt: float, rate: float, noise: Array
) -> tuple[Array, Mapping[int, float]]:
    """Return what `sampled_controller` reads behind the head of its memory, and the entries of the head for it.

    rate: of the actuator, per second; noise: of each sample.
    """
    assert loop.sampling is not None
    T, every = loop.sampling.sample_s, steps_a_sample(loop.sampling, dt)
    sensor, sensor_order = _sensor(in_series("sensor", loop.sensor), dt)
    servo, servo_order = _servo(in_series("servo", loop.servo), dt)
    holds, sign = holding_terms(loop)
    terms = [
        _block(term.block, T, float(gain), sign if held else 0.0)
        for gain, term, held in zip(gains, loop.terms, holds, strict=True)
    ]
    blocks = np.concatenate([*terms, *(_block(block, T, 1.0, 0.0) for block in loop.filters)])
    queue = round(loop.sampling.dead_time / dt)
    servo_at = kernel.HEAD_SIZE + len(sensor)
    blocks_at = servo_at + len(servo)
    queue_at = blocks_at + len(blocks)
    body = np.concatenate([sensor, servo, blocks, np.zeros(queue), noise])
    values = {
        kernel.EVERY: every,
        kernel.SENSOR: kernel.HEAD_SIZE,
        kernel.SENSOR_ORDER: sensor_order,
        kernel.SERVO: servo_at,
        kernel.SERVO_ORDER: servo_order,
        kernel.BLOCKS: blocks_at,
        kernel.TERM_COUNT: len(loop.terms),
        kernel.FILTER_COUNT: len(loop.filters),
        kernel.QUEUE: queue_at,
        kernel.QUEUE_SIZE: queue,
        kernel.NOISE: queue_at + queue,
        kernel.RESOLUTION: loop.sampling.resolution,
        kernel.SAMPLE_SLEW: rate * T,
    }
    return body, values


def _block(block: Block, T: float, gain: float, holds: float) -> Array:
    made = difference_equation(block, T)
    n = len(made.a) - 1
    return np.concatenate([[n, gain, holds, 0.0], made.b, made.a, np.zeros(n)])


def _sensor(block: Block, dt: float) -> tuple[Array, int]:
    """Return a sensor for an input that runs straight over each step (Franklin, Powell & Workman 1998, section 6.3)."""
    A, b, c, d = controllable_form(block)
    n = len(b)
    whole = np.zeros((n + 2, n + 2))
    whole[:n, :n], whole[:n, n], whole[n, n + 1] = A * dt, b * dt, 1.0
    made = np.asarray(expm(whole), dtype=np.float64)
    held, ramp = made[:n, n], made[:n, n + 1]
    return np.concatenate([made[:n, :n].T.ravel(), held - ramp, ramp, c, [d], np.zeros(2 * n + 1)]), n


def _servo(block: Block, dt: float) -> tuple[Array, int]:
    """Return a servo for an input that is held over each step."""
    A, b, c, d = controllable_form(block)
    n = len(b)
    whole = np.zeros((n + 1, n + 1))
    whole[:n, :n], whole[:n, n] = A * dt, b * dt
    made = np.asarray(expm(whole), dtype=np.float64)
    return np.concatenate([made[:n, :n].T.ravel(), made[:n, n], c, [d], np.zeros(2 * n)]), n
