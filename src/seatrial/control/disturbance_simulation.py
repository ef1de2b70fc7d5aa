"""A servo loop kept steady in what disturbs it: simulated with its actuator's limits beside linear theory."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import accumulate

import numpy as np

from seatrial.control.gain_evaluation import gain_evaluator
from seatrial.control.seaway_simulation import effect_amplitudes, frequency_band, sum_harmonics, wave_components
from seatrial.control.task import Seaway, SlowDisturbance, TuningTask
from seatrial.core.results.tuning import DisturbanceSimulation
from seatrial.core.values import Array, DivergedError
from seatrial.numerics.workers import map_in_threads
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops import TransferLoop, plant_model
from seatrial.physics.simulate.closed_loop import (
    UNLIMITED,
    ActuatorLimits,
    ClosedLoop,
    sample_noise,
    simulation_step,
    steps_a_sample,
)

SEEDS = 8  # realisations; chosen
_ACCURACY = (
    0.01  # standard error of the output's rms over all realisations, as a share: a fifth of what matters; chosen
)
_BINS = 200  # of the output's density over the logarithm of the frequency; chosen
_STEP_SHARE = 0.1  # of the fastest pole's time constant, of a step; chosen
_MOST_STEPS = 1_000_000  # of a realisation; chosen
_RUN_IN = 5.0  # correlation times of the output, before what is counted; chosen
_EDGE = 1e-9  # share by which the bins reach beyond the outermost frequencies: rounding
LEAST_FREQUENCY = 1e-9  # rad/s: a wave that keeps up with the ship
SIGNALS = ("output", "actuator", "actuator_rate")


@dataclass(frozen=True)
class DisturbanceClock:
    """Step [s], number of samples of a realisation, and the first that is counted."""

    dt: float
    count: int
    first: int


def simulate_disturbances(
    task: TuningTask, loop: TransferLoop, gains: Array, seed: int
) -> tuple[DisturbanceSimulation, ...]:
    """Return each of the task's disturbances with the gains (g,) of a stable loop: predicted, without and with limits.

    The plant is that of linear theory, so that only the limits of angle and rate are new: what they cost is seen by
    itself. Seas are sums of harmonics, slow disturbances exact steps of their process.
    """
    predicted = np.sqrt(gain_evaluator(task, loop).evaluate(gains[None]).variances[0, :, :3])
    limits = ActuatorLimits(task.constraints.limit, task.constraints.rate)
    return tuple(
        _simulate(met, met.disturbed(task.loop_at(met.U, loop)).with_gains(gains), limits, expected, seed)
        for met, expected in zip(task.disturbances, predicted, strict=True)
    )


def _simulate(
    met: Seaway | SlowDisturbance, loop: TransferLoop, limits: ActuatorLimits, expected: Array, seed: int
) -> DisturbanceSimulation:
    """Return one disturbance before a loop; expected: rms by linear theory, (3,)."""
    clock, model = disturbance_clock(met, loop), plant_model(loop)
    actuator, disturbance = model.input_names
    run = ClosedLoop(model, loop, loop.gain_values, clock.dt, actuator, disturbance, loop.output)

    def of_one(number: int) -> Array:
        series = disturbance_realisation(met, loop, clock, number)
        noise = None if loop.sampling is None else sample_noise(loop.sampling, clock.count, number)
        return np.stack([_mean_squares(run, series, clock, each, noise) for each in (UNLIMITED, limits)])

    free, held = np.stack(map_in_threads(of_one, [seed + k for k in range(SEEDS)]), axis=1)
    rms = np.sqrt(free.mean(axis=0))
    error = free.std(axis=0, ddof=1) / math.sqrt(SEEDS) / (2.0 * rms)
    columns = (expected, rms, np.sqrt(held.mean(axis=0)), error)
    return DisturbanceSimulation(met.description, SEEDS, *(named_signals(column) for column in columns))


def named_signals(values: Array) -> dict[str, float]:
    """Return rms of output, actuator and its rate by name."""
    return dict(zip(SIGNALS, values.tolist(), strict=True))


def disturbance_clock(
    met: Seaway | SlowDisturbance, loop: TransferLoop, inner: TransferLoop | None = None
) -> DisturbanceClock:
    """Return steps short for the fastest pole, a run-in, and enough of the output to know its rms.

    inner: a loop within this one, which is what is integrated.
    """
    spectrum = met.exposure(loop)
    omega = spectrum.omega_e
    energy = spectrum.energy * np.abs(_response(loop, omega)) ** 2
    poles = loop.closed_loop_poles
    stepped = loop if inner is None else inner
    moving = poles if stepped.sampling is None else np.concatenate([stepped.plant.poles, stepped.disturbance.poles])
    dt = simulation_step(stepped.sampling, _STEP_SHARE / float(np.abs(moving).max()))
    time = correlation_time(omega, energy)
    counted = time_to_know(time, SEEDS)
    first = math.ceil(_RUN_IN * time / dt)
    count = min(first + math.ceil(counted / dt), _MOST_STEPS)
    return DisturbanceClock(dt, count, min(first, count // 2))


def time_to_know(correlation: float, runs: int) -> float:
    """Return how long [s] each of some runs lasts for an rms over all of them to be known to `_ACCURACY`.

    The rms of a Gaussian signal has the variance time / (2 T) of its square (Bendat & Piersol 2010, section 8.2).
    """
    return correlation / (2.0 * _ACCURACY**2 * runs)


def correlation_time(omega: Array, energy: Array) -> float:
    """Return pi int S^2 / (int S)^2 [s] of a one-sided density S: over a time T the variance is known to 2 time / T.

    (Bendat & Piersol 2010, Random Data, section 8.2.) Poles that hardly move the output do not lengthen it. omega,
    energy: (n,), S d omega.
    """
    w = np.maximum(omega, LEAST_FREQUENCY)
    edges = np.geomspace(w.min() * (1.0 - _EDGE), w.max() * (1.0 + _EDGE), _BINS + 1)
    share = np.histogram(w, edges, weights=energy)[0] / np.sum(energy)
    return math.pi * float(np.sum(share**2 / np.diff(edges)))


def _response(loop: TransferLoop, omega: Array) -> Complex:
    """Return D S at omega [rad/s], kept from zero where the plant integrates."""
    w = np.maximum(omega, LEAST_FREQUENCY)
    return loop.disturbance.frequency_response(w) / (1.0 + loop.open_loop(w))


def disturbance_realisation(
    met: Seaway | SlowDisturbance,
    loop: TransferLoop,
    clock: DisturbanceClock,
    number: int,
    response: Callable[[Array], Complex | Array] | None = None,
) -> Array:
    """Return a disturbance (n,) at the samples of a clock, from that seed.

    response: over |omega_e| (n,), of what is counted, whose waves are taken; by default the loop's output.
    """
    rng = np.random.default_rng(number)
    if isinstance(met, SlowDisturbance):
        return met.rms * gauss_markov(met.bandwidth, clock.dt, clock.count, rng)
    lines = wave_components(met, rng, frequency_band(met, response or (lambda omega: _response(loop, omega))))
    return sum_harmonics(lines.omega_e, effect_amplitudes(lines, met.effect), clock.dt, clock.count)


def gauss_markov(bandwidth: float, dt: float, count: int, rng: np.random.Generator) -> Array:
    """Return exact steps of a first-order Gauss-Markov process of unit rms (Gelb 1974, section 3.8), (count,)."""
    stay = math.exp(-bandwidth * dt)
    kicks = math.sqrt(1.0 - stay**2) * rng.standard_normal(count)
    return np.fromiter(accumulate(kicks.tolist(), lambda now, kick: stay * now + kick), np.float64, count)


def actuator_rate(run: ClosedLoop, moved: Array) -> Array:
    """Return the rate of the actuator (n,) from step to step, of a sampled controller from sample to sample.

    An order that is held moves an actuator in steps, whose rate within them is that of the actuator and not the loop's.
    """
    sampling = run.loop.sampling
    every = 1 if sampling is None else steps_a_sample(sampling, run.dt)
    return (moved[every:] - moved[:-every]) / (every * run.dt)


def _mean_squares(
    run: ClosedLoop, disturbance: Array, clock: DisturbanceClock, limits: ActuatorLimits, noise: Array | None
) -> Array:
    """Return mean squares of output, actuator and its rate, (3,); infinite where the limits let the loop run away."""
    first = clock.first
    try:
        states, moved = run.run(disturbance, limits, noise=noise)
    except DivergedError:
        return np.full(len(SIGNALS), np.inf)
    output, rate = states[first:, run.model.states.index(run.output)], actuator_rate(run, moved[first:])
    squares = [float(np.mean(signal**2)) for signal in (output, moved[first:], rate)]
    return np.array(squares)
