"""Controllers simulated in what disturbs them, with what their actuators cannot do."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial

import numpy as np
from scipy.special import stdtrit

from seatrial.control.gain_evaluation import gain_evaluator
from seatrial.control.task import OUTPUT, Seaway, SimulationSettings, SlowDisturbance, TuningTask
from seatrial.core.results.tuning import DisturbanceSimulation, PairedDifference, SeawaySimulation
from seatrial.core.values import Array, Channel, DivergedError, InputError, Record, frozen
from seatrial.numerics.kernels.linear import replay
from seatrial.numerics.workers import map_in_threads
from seatrial.physics.hydro.excitation import Complex, encounter_frequency
from seatrial.physics.loops import LoopSignal, TransferLoop, WaveEffect
from seatrial.physics.loops.loop_states import plant_model
from seatrial.physics.sea.realise import Spacing, WaveComponents, realise, short_crested
from seatrial.physics.simulate.closed_loop import (
    UNLIMITED,
    ActuatorLimits,
    ClosedLoop,
    sample_noise,
    simulation_step,
    steps_a_sample,
)

# A stabiliser at sea, with what its fins cannot do: every controller meets the same seas, so that pairs are compared.

LONG_CRESTED_LINES, SHORT_CRESTED_LINES = 800, 1600  # wave components of a simulated sea; chosen
RUN_IN_SECONDS = 100.0  # before what is counted: several swings of any ship; chosen
UNCONTROLLED = "uncontrolled"
MOTION = "motion"
"""Channel of the motion that counts where that is not the output."""
_ENERGY_SHARE = 1e-4  # share of the energy cut at either end of the spectrum; chosen
_REACH, _FREQUENCIES = 12.0, 4001  # highest frequency over the modal one that is looked at, and how many; chosen
# rad: an effect is felt most from abeam, or where it is not felt there, on the quarter
_FELT_HEADINGS = (0.5 * math.pi, 0.25 * math.pi)
_KEPT_SEAS = 8  # sets of seas kept in memory: one for each setting in use; chosen
_CONFIDENCE = 0.95  # level of the intervals of means over seeds
_ACTUATOR_STREAM = 13  # of random numbers, apart from those of the seas and the noise of the same seed; chosen


def simulate_in_seaway(task: TuningTask, loop: TransferLoop, name: str, gains: Array, seed: int) -> SeawaySimulation:
    """A controller in the task's first sea: reductions of the output's rms, and the first of the seas as a record.

    Args:
        loop: the structure that the gains (g,) belong to, on the task's plant at the task's speed.
        seed: of the first sea; controllers with the same seed meet the same seas.

    Raises:
        InputError: the task has no sea or no trials, or the sea does not move the ship.
        DivergedError: the loop runs away.
    """
    stages = actuator_stages(task.actuator_limits)
    reductions, energies = _seaway_trials(task, loop, gains, seed, lambda _: (loop, stages))
    seaway, trials = _sea_and_trials(task)
    steered = closed_loop(task, loop, gains, seaway.U, trials.dt)
    met = disturbance_series(seaway, trials, seed)[0]
    first = round(RUN_IN_SECONDS / trials.dt)
    shown = _without_run_in(_record(task, steered, f"{name}, first sea", met, seaway, task.actuator_limits), first)
    still = replace(steered, gains=np.zeros(len(gains)))
    alone = _without_run_in(_record(task, still, "without control", met, seaway, UNLIMITED), first)
    uncontrolled = {f"{name}_{UNCONTROLLED}": alone.channel(name) for name in (loop.output, MOTION) if name in alone}
    shown = replace(shown, channels={**shown.channels, **uncontrolled})
    linear, limited, stalled = (frozen(column) for column in reductions.T)
    drive, drag = (frozen(column) if np.isfinite(column).all() else np.empty(0) for column in energies.T)
    return SeawaySimulation(name, linear, limited, stalled, shown, drive, drag)


def seaway_reductions(
    task: TuningTask, loop: TransferLoop, gains: Array, seed: int, stages: slice = slice(None)
) -> Array:
    """Return reductions of the output's rms in each sea against no control there, (seeds, stages).

    The actuator is drawn from the task's spread, evenly, in each sea anew and for every controller alike.

    stages: of `actuator_stages`. Raises what `simulate_in_seaway` does.
    """
    spread = task.uncertainty.actuator

    def actuator(number: int) -> tuple[TransferLoop, Sequence[ActuatorLimits]]:
        place = np.random.default_rng([number, _ACTUATOR_STREAM]).uniform(-1.0, 1.0, 3)
        limits, there = spread.actuator_at(place, task.actuator_limits, loop)
        return there, actuator_stages(limits)[stages]

    return _seaway_trials(task, loop, gains, seed, actuator)[0]


def actuator_stages(limits: ActuatorLimits) -> tuple[ActuatorLimits, ActuatorLimits, ActuatorLimits]:
    """Return the actuator without limits, with those of angle and rate, and with stall as well."""
    return UNLIMITED, limits.without_stall, limits


def _seaway_trials(
    task: TuningTask, loop: TransferLoop, gains: Array, seed: int,
    actuator: Callable[[int], tuple[TransferLoop, Sequence[ActuatorLimits]]],
) -> tuple[Array, Array]:  # fmt: skip
    """Return reductions, and J in an hour by drive and drag at the last stage, (seeds, 2); nan undeclared.

    actuator: of the sea of a seed, the loop with its dead time and the stages of its limits.
    """
    seaway, trials = _sea_and_trials(task)
    steered = closed_loop(task, loop, gains, seaway.U, trials.dt)
    seas = disturbance_series(seaway, trials, seed)

    def of_one(number: int) -> Array:
        there, stages = actuator(seed + number)
        run = steered if there is loop else replace(steered, loop=replace(steered.loop, sampling=there.sampling))
        runs: dict[ActuatorLimits, tuple[float, Array]] = {}
        for limits in stages:
            runs[limits] = runs.get(limits) or _trial(task, run, seas[number], seaway, limits, seed + number)
        made = [runs[limits] for limits in stages]
        return np.array([*(rms for rms, _ in made), *_hourly_energies(task, run, made[-1][1], seaway.U)])

    free = np.array(_uncontrolled_rms(task, seaway, seed))
    columns = np.array(map_in_threads(of_one, range(len(seas))))
    return 1.0 - columns[:, :-2] / free[:, None], columns[:, -2:]


def _hourly_energies(task: TuningTask, run: ClosedLoop, angles: Array, U: float) -> tuple[float, float]:
    """Return J in an hour by the drive and by the drag of the actuator's angles (n,) after the run-in, at U [m/s].

    Rates are those from step to step. Without a servo they are those from sample to sample: an actuator that follows
    an order at once would take any work.
    """
    every = 1 if run.loop.servo else steps_a_sample(run.loop.required_sampling, run.dt)
    step = every * run.dt
    drive = math.nan if task.drive is None else task.drive.hourly_energy(np.diff(angles[::every]) / step, step)
    return drive, math.nan if task.surface is None else task.surface.hourly_energy(float(np.mean(angles**2)), U)


def _sea_and_trials(task: TuningTask) -> tuple[Seaway, SimulationSettings]:
    seaway = next((met for met in task.disturbances if isinstance(met, Seaway)), None)
    if seaway is None or task.simulation is None:
        raise InputError("to simulate a stabiliser the tuning needs a sea and trials; give both, or leave trials out")
    return seaway, task.simulation


@lru_cache(maxsize=_KEPT_SEAS)
def _uncontrolled_rms(task: TuningTask, seaway: Seaway, seed: int) -> tuple[float, ...]:
    """Return the rms of the motion that counts without control in each sea: the same for every controller."""
    assert task.simulation is not None
    still = closed_loop(task, task.loop, np.zeros(len(task.loop.terms)), seaway.U, task.simulation.dt)
    seas = list(disturbance_series(seaway, task.simulation, seed))
    made = tuple(map_in_threads(lambda sea: _trial(task, still, sea, seaway, UNLIMITED, seed)[0], seas))
    if not min(made) > 0.0:
        raise InputError(f"the sea '{seaway.description}' does not move the ship; take another heading or a higher sea")
    return made


def _trial(
    task: TuningTask, run: ClosedLoop, sea: Array, seaway: Seaway, limits: ActuatorLimits, seed: int
) -> tuple[float, Array]:
    """Return the rms of the motion that counts and the actuator's angles of a run in a sea (1 + p, n).

    After the run-in; seed: of the noise.
    """
    noise = sample_noise(run.loop.required_sampling, sea.shape[1], seed)
    states, angles = run.run(*_disturbed_by(run, sea, seaway, limits), noise=noise)
    first = round(RUN_IN_SECONDS / run.dt)
    return float(np.std(_motion(task, run, states, sea, seaway)[first:])), angles[first:]


def _disturbed_by(
    run: ClosedLoop, sea: Array, seaway: Seaway, limits: ActuatorLimits
) -> tuple[Array, ActuatorLimits, Array | None]:
    """Return the disturbance, the limits and the reference with which to run in a sea (1 + p, n).

    A motion of the hull is no input of its model: the controller sees it as a reference of opposite sign.
    """
    if not seaway.is_output:
        return sea[0], limits, None
    return np.zeros(sea.shape[1]), limits, run.start[run.model.states.index(run.output)] - sea[0]


def _motion(task: TuningTask, run: ClosedLoop, states: Array, sea: Array, seaway: Seaway) -> Array:
    """Return the motion that counts (n,): the output, or the acceleration at a point by second differences."""
    names, row = run.model.states, task.motion.variances[0]
    if row.signal is not LoopSignal.POINT:
        return states[:, names.index(run.output)] + (sea[0] if seaway.is_output else 0.0)
    place = [point.x for point in task.loop.points].index(row.x)
    by_fins = states[:, names.index("z")] - row.x * states[:, names.index("theta")]
    inner = np.diff(by_fins + sea[1 + place], 2) / run.dt**2
    return np.concatenate([inner[:1], inner, inner[-1:]])


def _record(task: TuningTask, run: ClosedLoop, name: str, sea: Array, seaway: Seaway, limits: ActuatorLimits) -> Record:
    """Return a run in a sea as a record; of a hull in waves its output, the actuator and the motion that counts."""
    made = run.record(name, *_disturbed_by(run, sea, seaway, limits))
    if not seaway.is_output:
        return made
    output = made.channel(run.output)
    shown = {
        run.output: replace(output, values=frozen(output.values + sea[0])),
        run.actuator: made.channel(run.actuator),
    }
    if task.motion is not OUTPUT:
        states = np.stack([made[state] for state in run.model.states], axis=1)
        shown[MOTION] = Channel(frozen(_motion(task, run, states, sea, seaway)), "m/s^2", "body", "down")
    return replace(made, channels=shown)


def compare_pairwise(chosen: SeawaySimulation, other: SeawaySimulation, stage: str) -> PairedDifference:
    """Reduction of one controller minus that of another, sea by sea: mean and Student's 95 % interval of the mean.

    stage: ``linear``, ``limited`` or ``stalled``.
    """
    columns = ("linear", "limited", "stalled")
    if stage not in columns:
        raise InputError(f"controllers in simulation are compared {', '.join(columns)}, not '{stage}'")
    return _paired_difference(chosen, other, stage, getattr(chosen, stage), getattr(other, stage))


def energy_saving(chosen: SeawaySimulation, other: SeawaySimulation) -> PairedDifference:
    """J in an hour that one controller needs less than another, drive and drag as far as declared, sea by sea."""
    needs = [np.sum([part for part in (one.drive_energy, one.drag_energy) if len(part)], axis=0)
             for one in (other, chosen)]  # fmt: skip
    return _paired_difference(chosen, other, "stalled", *needs)


def _paired_difference(
    chosen: SeawaySimulation, other: SeawaySimulation, stage: str, one: Array, two: Array
) -> PairedDifference:
    """Return one - two (n,) over seas: mean and Student's 95 % interval of the mean."""
    if one.shape != two.shape or len(one) < 2:
        raise InputError(f"'{chosen.name}' and '{other.name}' need the same seas to be compared, two or more")
    gap = one - two
    mean, n = float(np.mean(gap)), len(gap)
    half = float(stdtrit(n - 1, 0.5 + 0.5 * _CONFIDENCE) * np.std(gap, ddof=1) / math.sqrt(n))
    return PairedDifference(other.name, stage, mean, mean - half, mean + half, n)


def closed_loop(task: TuningTask, loop: TransferLoop, gains: Array, U: float, dt: float) -> ClosedLoop:
    """The controller before the task's vessel at U [m/s], or before its plant where only transfer functions are known.

    Raises:
        InputError: the vessel's model has no input for the sea, or does not suit a loop.
    """
    values, vessel = np.asarray(gains, dtype=np.float64), task.trimmed_ship
    at = task.loop_at(U, loop)
    if vessel is None:
        model = plant_model(at)
        return ClosedLoop(model, at, values, dt, model.input_names[0], model.input_names[1], at.output)
    if not vessel.disturbance and not any(isinstance(met, Seaway) and met.is_output for met in task.disturbances):
        raise InputError(f"model '{vessel.model.name}' has no input for the sea; name one as the plant's disturbance")
    effect = at.plant.num[0] / loop.plant.num[0]
    return ClosedLoop(
        vessel.model, at, values, dt, vessel.actuator, vessel.disturbance, vessel.output, vessel.state, vessel.inputs,
        effect,
    )  # fmt: skip


@lru_cache(maxsize=_KEPT_SEAS)
def disturbance_series(seaway: Seaway, trials: SimulationSettings, seed: int) -> tuple[Array, ...]:
    """Return the disturbance of each seed and what the sea does at points, a run-in of `RUN_IN_SECONDS` first.

    Each (1 + p, n), read-only.
    """
    count = round((RUN_IN_SECONDS + trials.duration) / trials.dt) + 1
    band = frequency_band(seaway)

    def of_one(number: int) -> Array:
        lines = wave_components(seaway, np.random.default_rng(number), band)
        effects = (seaway.effect, *seaway.at_points)
        rows = [sum_harmonics(lines.omega_e, effect_amplitudes(lines, effect), trials.dt, count) for effect in effects]
        return frozen(np.array(rows))

    return tuple(map_in_threads(of_one, [seed + k for k in range(trials.seeds)]))


def wave_components(seaway: Seaway, rng: np.random.Generator, band: tuple[float, float]) -> WaveComponents:
    """Return harmonics of one sea, jittered, so that it does not repeat."""
    count = LONG_CRESTED_LINES if seaway.spreading is None else SHORT_CRESTED_LINES
    lines = realise(seaway.spectrum, seaway.U, seaway.beta, rng, count=count, spacing=Spacing.JITTERED, band=band)
    return lines if seaway.spreading is None else short_crested(lines, rng, seaway.spreading)


def effect_amplitudes(lines: WaveComponents, effect: WaveEffect) -> Complex:
    """Return complex amplitudes of what each wave does, (n,), each at its own heading."""
    made = np.empty(len(lines.omega), dtype=np.complex128)
    for beta in np.unique(lines.direction):
        these = lines.direction == beta
        made[these] = effect.amplitude(lines.omega[these], lines.U, float(beta))
    return made * lines.amplitude


def sum_harmonics(omega: Array, amplitude: Complex, dt: float, count: int) -> Array:
    """Re sum a exp(i omega t) at t = 0, dt, ... (count,): a product of two tables instead of count x n cosines."""
    width = math.isqrt(count - 1) + 1
    within = dt * omega[:, None] * np.arange(width)
    before = dt * width * omega[:, None] * np.arange(-(-count // width)) + np.angle(amplitude)[:, None]
    size = np.abs(amplitude)[:, None]
    made = (size * np.cos(before)).T @ np.cos(within) - (size * np.sin(before)).T @ np.sin(within)
    return made.ravel()[:count]


def frequency_band(seaway: Seaway, response: Callable[[Array], Complex | Array] | None = None) -> tuple[float, float]:
    """Return frequencies [rad/s] of all waves that do much to the loop, up to twelve times the modal one.

    Where the effect is the motion of a hull, of all that its excitation knows: points of it may feel shorter waves.
    With a response (n,) over |omega_e| (n,), of all that do much to what responds: a ship answers most to waves that
    keep up with it, of which there are few.
    """
    peak = seaway.spectrum.modal_frequency
    omega = np.linspace(0.0, _REACH * peak, _FREQUENCIES)[1:]
    if seaway.is_output:
        lower, upper = seaway.effect.frequency_range
        size = np.where((omega >= lower) & (omega <= upper), 1.0, 0.0)
    elif response is not None:
        sizes = (_responded(seaway, response, omega, beta) for beta in seaway.directions)
        size = np.sum([*sizes], axis=0)
    else:
        sizes = (np.abs(seaway.effect.amplitude(omega, seaway.U, beta)) ** 2 for beta in _FELT_HEADINGS)
        size = next(one for one in sizes if one.any())
    share = np.cumsum(size * seaway.spectrum.density(omega))
    share /= share[-1]
    ends = np.searchsorted(share, [_ENERGY_SHARE, 1.0 - _ENERGY_SHARE])
    return float(omega[ends[0]]), float(omega[ends[1]])


def _responded(seaway: Seaway, response: Callable[[Array], Complex | Array], omega: Array, beta: float) -> Array:
    met = np.abs(encounter_frequency(omega, seaway.U, beta))
    return np.abs(seaway.effect.amplitude(omega, seaway.U, beta) * response(met)) ** 2


def _without_run_in(record: Record, first: int) -> Record:
    """Return the record without its first samples, beginning at zero again."""
    kept = record.rows(slice(first, None))
    return replace(kept, time=frozen(kept.time - kept.time[0]))


# A servo loop kept steady in what disturbs it: simulated with its actuator's limits beside linear theory.

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
    limits = task.actuator_limits.without_stall
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
    output = model.states.index(loop.output)

    def of_one(number: int, each: ActuatorLimits) -> tuple[Array, Array]:
        series = disturbance_realisation(met, loop, clock, number)
        noise = sample_noise(loop.required_sampling, clock.count, number)
        states, moved = run.run(series, each, noise=noise)
        return states[:, output], moved

    return rms_in_disturbance(met, run, of_one, clock, limits, expected, seed)


def rms_in_disturbance(
    met: Seaway | SlowDisturbance,
    run: ClosedLoop,
    of_one: Callable[[int, ActuatorLimits], tuple[Array, Array]],
    clock: DisturbanceClock,
    limits: ActuatorLimits,
    expected: Array,
    seed: int,
) -> DisturbanceSimulation:
    """Return rms of output, actuator and its rate of a loop in `SEEDS` realisations, without and with limits.

    of_one: output and actuator (n,) in the realisation of a number, within limits.
    expected: rms by linear theory, (3,).
    """

    def mean_squares(number: int) -> Array:
        return np.stack(
            [_mean_squares(run, partial(of_one, number, each), clock.first) for each in (UNLIMITED, limits)]
        )

    free, held = np.stack(map_in_threads(mean_squares, [seed + k for k in range(SEEDS)]), axis=1)
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
    stepped = loop if inner is None else inner
    fastest = float(np.abs(np.concatenate([stepped.plant.poles, stepped.disturbance.poles])).max())
    dt = simulation_step(stepped.required_sampling, _STEP_SHARE / fastest)
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
    one, last, out = np.ones((1, 1, 1)), np.full((1, 1, 1), stay), np.empty((count, 1))
    replay(
        last, one, 0.0 * one, last, one, np.zeros(1, dtype=np.int64), kicks[:, None], np.array([0, count]), 1,
        np.zeros((1, 1)), out, np.full(1, -1),
    )  # fmt: skip
    return out[:, 0]


def actuator_rate(run: ClosedLoop, moved: Array) -> Array:
    """Return the rate of the actuator (n,) from sample to sample.

    An order that is held moves an actuator in steps, whose rate within them is that of the actuator and not the loop's.
    """
    every = steps_a_sample(run.loop.required_sampling, run.dt)
    return (moved[every:] - moved[:-every]) / (every * run.dt)


def _mean_squares(run: ClosedLoop, simulated: Callable[[], tuple[Array, Array]], first: int) -> Array:
    """Return mean squares of output, actuator and its rate, (3,); infinite where the limits let the loop run away."""
    try:
        output, moved = simulated()
    except DivergedError:
        return np.full(len(SIGNALS), np.inf)
    signals = (output[first:], moved[first:], actuator_rate(run, moved[first:]))
    return np.array([float(np.mean(signal**2)) for signal in signals])
