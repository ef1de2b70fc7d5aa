"""A stabiliser at sea, with what its fins cannot do: every controller meets the same seas, so that pairs are compared.

A sea is a sum of harmonics; the effective wave slope of each line is k |sin(beta)| F a, in quadrature with its
elevation, met at its own signed frequency of encounter.
"""

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
from scipy.stats import t as student

from seatrial.control.task import Seaway, Task, Trials
from seatrial.core.results.tuning import Paired, Sailed
from seatrial.core.values import Array, InputError, Record, frozen
from seatrial.numerics.workers import mapped
from seatrial.physics.hydro.dispersion import G
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops import TransferLoop
from seatrial.physics.loops.state_space import plant_model
from seatrial.physics.sea.realise import Lines, Spacing, realise, short_crested
from seatrial.physics.simulate.closed_loop import FREE, ActuatorLimits, ClosedLoop

LINES, SPREAD_LINES = 800, 1600
RUN_IN = 100.0
WITHOUT = "uncontrolled"
_FAINT = 1e-4
_CONFIDENCE = 0.95


def sailed(task: Task, loop: TransferLoop, name: str, gains: Array, seed: int) -> Sailed:
    """A controller in the task's first sea: reductions of the output's rms, of each seed against no control there.

    Args:
        loop: the structure that the gains (g,) belong to, on the task's plant at the task's speed.
        seed: of the first sea; controllers with the same seed meet the same seas.

    Raises:
        InputError: the task has no sea or no trials, or the sea does not move the ship.
        DivergedError: the loop runs away.
    """
    seaway = next((met for met in task.met if isinstance(met, Seaway)), None)
    if seaway is None or task.trials is None:
        raise InputError("to simulate a stabiliser the tuning needs a sea and trials; give both, or leave trials out")
    trials = task.trials
    steered = ship_of(task, loop, gains, seaway.U, trials.dt)
    still = replace(steered, gains=np.zeros(len(gains)))
    r = task.restriction
    everything = ActuatorLimits(r.limit, r.rate, r.stall)
    met = seas(seaway, trials, seed)
    first = round(RUN_IN / trials.dt)

    def size(run: ClosedLoop, sea: Array, limits: ActuatorLimits) -> float:
        states, _ = run.run(sea, limits)
        return float(np.std(states[first:, run.model.states.index(run.output)]))

    def of_one(sea: Array) -> list[float]:
        alone = size(still, sea, FREE)
        if not alone > 0.0:
            raise InputError(f"the sea '{seaway.said}' does not move the ship; take another heading or a higher sea")
        return [1.0 - size(steered, sea, limits) / alone for limits in (FREE, everything.without_stall, everything)]

    reductions = np.array(mapped(of_one, list(met)))
    shown = _cut(steered.record(f"{name}, first sea", met[0], everything), first)
    alone = _cut(still.record("without control", met[0], FREE), first).channel(loop.output)
    shown = replace(shown, channels={**shown.channels, f"{loop.output}_{WITHOUT}": alone})
    linear, limited, stalled = (frozen(column) for column in reductions.T)
    return Sailed(name, linear, limited, stalled, shown)


def paired(chosen: Sailed, other: Sailed, what: str) -> Paired:
    """Reduction of one controller minus that of another, sea by sea: mean and Student's 95 % interval of the mean.

    what: ``linear``, ``limited`` or ``stalled``.

    Raises:
        InputError: no such column, other numbers of seas, or fewer than two.
    """
    columns = ("linear", "limited", "stalled")
    if what not in columns:
        raise InputError(f"controllers in simulation are compared {', '.join(columns)}, not '{what}'")
    one, two = getattr(chosen, what), getattr(other, what)
    if one.shape != two.shape or len(one) < 2:
        raise InputError(f"'{chosen.name}' and '{other.name}' need the same seas to be compared, two or more")
    gap = one - two
    mean, n = float(np.mean(gap)), len(gap)
    half = float(student.ppf(0.5 + 0.5 * _CONFIDENCE, n - 1) * np.std(gap, ddof=1) / math.sqrt(n))
    return Paired(other.name, what, mean, mean - half, mean + half, n)


def ship_of(task: Task, loop: TransferLoop, gains: Array, U: float, dt: float) -> ClosedLoop:
    """The controller before the task's vessel at U [m/s], or before its plant where only transfer functions are known.

    Raises:
        InputError: the vessel's model has no input for the sea, or does not suit a loop.
    """
    values, vessel = np.asarray(gains, dtype=np.float64), task.vessel
    at = task.loop_at(U, loop)
    if vessel is None:
        model = plant_model(at)
        return ClosedLoop(model, at, values, dt, model.input_names[0], model.input_names[1], at.output)
    if not vessel.disturbance:
        raise InputError(f"model '{vessel.model.name}' has no input for the sea; name one as the plant's disturbance")
    effect = at.plant.num[0] / loop.plant.num[0]
    return ClosedLoop(
        vessel.model, at, values, dt, vessel.actuator, vessel.disturbance, vessel.output, vessel.state, vessel.inputs,
        effect,
    )  # fmt: skip


@lru_cache(maxsize=8)
def seas(seaway: Seaway, trials: Trials, seed: int) -> tuple[Array, ...]:
    """Effective wave slope [rad] of each seed, a run-in of `RUN_IN` s first; each (n,), read-only."""
    count = round((RUN_IN + trials.duration) / trials.dt) + 1
    band = waves_across(seaway)

    def of_one(number: int) -> Array:
        lines = lines_of(seaway, np.random.default_rng(number), band)
        return frozen(summed(lines.encounter, slopes(lines, seaway), trials.dt, count))

    return tuple(mapped(of_one, [seed + k for k in range(trials.seeds)]))


def lines_of(seaway: Seaway, rng: np.random.Generator, band: tuple[float, float]) -> Lines:
    """Harmonics of one sea, jittered, so that it does not repeat."""
    count = LINES if seaway.spreading is None else SPREAD_LINES
    lines = realise(seaway.spectrum, seaway.U, seaway.beta, rng, count=count, spacing=Spacing.JITTERED, band=band)
    return lines if seaway.spreading is None else short_crested(lines, rng, seaway.spreading)


def slopes(lines: Lines, seaway: Seaway) -> Complex:
    """Complex amplitudes of the effective wave slope [rad], (n,); the hull's factor at each heading."""
    k = lines.omega**2 / G
    factor: Array = np.ones(len(k))
    if seaway.hull is not None:
        hull, met = seaway.hull, zip(lines.omega, lines.direction, strict=True)
        factor = np.array([float(hull.at(omega, float(beta))) for omega, beta in met])
    return 1j * k * np.abs(np.sin(lines.direction)) * factor * lines.amplitude


def summed(omega: Array, amplitude: Complex, dt: float, count: int) -> Array:
    """Re sum a exp(i omega t) at t = 0, dt, ... (count,): a product of two tables instead of count x n cosines."""
    width = math.isqrt(count - 1) + 1
    within = dt * omega[:, None] * np.arange(width)
    before = dt * width * omega[:, None] * np.arange(-(-count // width)) + np.angle(amplitude)[:, None]
    size = np.abs(amplitude)[:, None]
    made = (size * np.cos(before)).T @ np.cos(within) - (size * np.sin(before)).T @ np.sin(within)
    return made.ravel()[:count]


def waves_across(seaway: Seaway) -> tuple[float, float]:
    """Frequencies [rad/s] of all waves with a slope to speak of, up to twelve times the modal one."""
    peak = seaway.spectrum.modal_frequency
    omega = np.linspace(0.0, 12.0 * peak, 4001)[1:]
    factor = np.ones(len(omega)) if seaway.hull is None else seaway.hull.at(omega, 0.5 * math.pi)
    share = np.cumsum(omega**4 * factor**2 * seaway.spectrum.density(omega))
    share /= share[-1]
    ends = np.searchsorted(share, [_FAINT, 1.0 - _FAINT])
    return float(omega[ends[0]]), float(omega[ends[1]])


def _cut(record: Record, first: int) -> Record:
    """Without its first samples, beginning at zero again."""
    kept = record.rows(slice(first, None))
    return replace(kept, time=frozen(kept.time - kept.time[0]))
