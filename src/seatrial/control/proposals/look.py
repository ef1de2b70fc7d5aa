"""A stretch of steady speed and heading in, a proposal out: sea, craft and gains, or why there are none."""

import math
from dataclasses import dataclass

import numpy as np

from seatrial.control.proposals.gain_schedule import GainSchedule
from seatrial.control.proposals.propose import ChosenGains, estimated, propose_gains
from seatrial.control.task import Seaway, TuningTask
from seatrial.control.verification.legs import natural_period
from seatrial.control.verification.stabiliser import prior_deviations
from seatrial.core.results.online import CraftFactor, HeadingRange, Proposal, SeaEstimate
from seatrial.core.values import Array
from seatrial.estimation.problem.spectral_likelihood import hann_transform
from seatrial.estimation.sea import (
    BIN_STRIDE,
    HEADING_CELL,
    MotionSpectrum,
    ObservedLeg,
    SeaLikelihood,
    ShipInSea,
    draw_ship_in_sea,
    stretch_spectra,
)

SEGMENT_PERIODS = 24.0  # natural periods in a segment of those by which gains are regressed; chosen
SHORTEST_PERIODS = 80.0  # natural periods that a stretch must hold: five segments and more; chosen
RATE = 12.0  # samples a natural period that the spectra need; chosen
_LOWEST, _HIGHEST = 0.25, 3.0  # frequencies over the natural one that are looked at; chosen
_QUIET = 4.0  # frequency over the natural one above which there are sensors alone; chosen
_LAST = 0.9  # of the highest frequency, above which there are sensors alone where the samples are slow; chosen
_LEAST_MOTION = math.radians(0.15)  # rms of a motion below which sensors and gusts are as large; chosen
_STILL = 0.02  # of the output's rms, below which the actuator counts as still; chosen
_LEAST_COHERENCE = 0.6  # of the actuator with what any gains of the loop order of the output; chosen
_CELLS = round(math.pi / HEADING_CELL)  # of headings from following to head seas
_GAP = 3  # from a cell to the next of the same range at most, in cells: two between them may be empty; chosen
_PROBABILITY = 0.95  # of the headings that are given
_NARROW = math.radians(45.0)  # width of a range of headings up to which the heading is determined; chosen
_NAMES = ("gain of the actuator", "natural frequency", "damping")


@dataclass(frozen=True, eq=False)
class Stretch:
    """A stretch of record: output and actuator every dt [s], SI, (n, 2), from `start` [s] at a mean speed U [m/s]."""

    start: float
    dt: float
    values: Array
    U: float

    @property
    def stop(self) -> float:
        """Return the time of the last sample [s]."""
        return self.start + self.dt * (len(self.values) - 1)


def look(
    task: TuningTask, schedule: GainSchedule, stretch: Stretch, current: Array | None = None, seed: int = 0
) -> Proposal:
    """Return what is proposed after a stretch; `current`: gains (g,) proposed before.

    Raises:
        InputError: the stretch is too short, or has gaps.
    """
    reason = _why_not(task, stretch)
    if reason:
        return no_proposal(task, stretch.start, stretch.stop, reason, stretch.U)
    observed = _observed(task, stretch)
    coherence = _following(observed, stretch)
    if coherence < _LEAST_COHERENCE:
        reason = (
            f"'{task.loop.actuator}' does not follow '{task.loop.output}' by any gains of this loop (coherence "
            f"{coherence:.2f}): is it the loop that is on, and are both channels positive as the notation has them?"
        )
        return no_proposal(task, stretch.start, stretch.stop, reason, stretch.U)
    rng = np.random.default_rng(seed)
    draws = draw_ship_in_sea(_sea_likelihood(task, stretch, observed), rng)
    choice = propose_gains(task, schedule, draws, stretch.U, current)
    is_chosen = isinstance(choice, ChosenGains)
    return Proposal(
        loop=task.name,
        start=stretch.start,
        stop=stretch.stop,
        gains=dict(zip(schedule.names, choice.gains.tolist(), strict=True)) if is_chosen else {},
        reasons=choice.reasons,
        gain_units={gain.name: gain.unit for gain in task.loop.gains},
        is_new=is_chosen and choice.is_new,
        U=stretch.U,
        sea=sea_estimate(draws),
        craft=tuple(
            CraftFactor(name, estimated(np.exp(column))) for name, column in zip(_NAMES, draws.ships.T, strict=True)
        ),
        margins=choice.margins if is_chosen else None,
    )


def no_proposal(task: TuningTask, start: float, stop: float, reason: str, U: float = math.nan) -> Proposal:
    """Return a proposal without gains, and why."""
    return Proposal(task.name, start, stop, {}, (reason,), U=U)


def _sea_likelihood(task: TuningTask, stretch: Stretch, observed: ObservedLeg) -> SeaLikelihood:
    """Return the likelihood of the stretch in the sea of the task whose height, period and heading are not known."""
    seaway = next(met for met in task.disturbances if isinstance(met, Seaway))
    expected = 2.0 * math.pi / seaway.spectrum.modal_frequency
    motion = _motion_spectrum(task, stretch, observed)
    return SeaLikelihood(motion, task.loop_at(stretch.U), stretch.U, seaway.effect, expected, prior_deviations(task))


def _observed(task: TuningTask, stretch: Stretch) -> ObservedLeg:
    """Return the spectra of segments, by which gains are regressed."""
    period = natural_period(task.loop)
    spectra = stretch_spectra(stretch.values, stretch.dt, SEGMENT_PERIODS * period)
    natural = 2.0 * math.pi / period
    return ObservedLeg(spectra.band_limited(_LOWEST * natural, _HIGHEST * natural), task.loop_at(stretch.U))


def _motion_spectrum(task: TuningTask, stretch: Stretch, observed: ObservedLeg) -> MotionSpectrum:
    """Return the band of the whole stretch's transform in which the craft answers waves, and the noise above it."""
    natural = 2.0 * math.pi / natural_period(task.loop)
    omega, transforms = hann_transform(stretch.values, stretch.dt)
    density = np.abs(transforms[:, 0]) ** 2
    kept = np.flatnonzero((omega >= _LOWEST * natural) & (omega <= _HIGHEST * natural))[::BIN_STRIDE]
    quiet = omega > min(_QUIET * natural, _LAST * float(omega[-1]))
    followed = observed.controller_at(omega[quiet]) * observed.loop.plant.frequency_response(omega[quiet])
    band = omega[kept]
    return MotionSpectrum(
        omega=band,
        step=float(omega[1] - omega[0]),
        density=density[kept],
        controller=observed.controller_at(band),
        independent_actuator=np.interp(band, observed.spectra.omega, observed.independent_actuator),
        noise=float(np.mean(density[quiet] * np.abs(1.0 + followed) ** 2)),
    )


def sea_estimate(draws: ShipInSea) -> SeaEstimate:
    """Return height, period and heading with their intervals."""
    ranges = likeliest_headings(draws.headings)
    return SeaEstimate(
        height=estimated(np.exp(draws.seas[:, 0])),
        period=estimated(np.exp(draws.seas[:, 1])),
        heading=estimated(draws.headings),
        headings=ranges,
        is_heading_determined=len(ranges) == 1 and ranges[0].upper - ranges[0].lower <= _NARROW,
    )


def likeliest_headings(headings: Array) -> tuple[HeadingRange, ...]:
    """Return the fewest degrees of heading that hold 95 % of draws (n,) as ranges, the likeliest first.

    Ranges up to two degrees apart are one.
    """
    edges = np.linspace(0.0, math.pi, _CELLS + 1)
    shares = np.histogram(headings, edges)[0] / len(headings)
    order = np.argsort(-shares, kind="stable")
    cells = np.sort(order[: int(np.searchsorted(np.cumsum(shares[order]), _PROBABILITY)) + 1])
    runs = np.split(cells, np.flatnonzero(np.diff(cells) > _GAP) + 1)
    ends = [(int(run[0]), int(run[-1]) + 1) for run in runs]
    ranges = [HeadingRange(float(edges[i]), float(edges[j]), float(np.sum(shares[i:j]))) for i, j in ends]
    return tuple(sorted(ranges, key=lambda one: -one.probability))


def _why_not(task: TuningTask, stretch: Stretch) -> str:
    """Return why nothing can be estimated of a stretch; nothing where it can."""
    needed = SHORTEST_PERIODS * natural_period(task.loop)
    length = stretch.stop - stretch.start
    if length < needed:
        return f"the stretch takes {length:.0f} s; {needed:.0f} s at one speed and heading are needed"
    rms = float(np.std(stretch.values[:, 0]))
    if rms < _LEAST_MOTION:
        return (
            f"'{task.loop.output}' moves {math.degrees(rms):.2g} deg rms; below {math.degrees(_LEAST_MOTION):.2g} deg "
            "the motion shows too little of sea and craft"
        )
    return ""


def _following(leg: ObservedLeg, stretch: Stretch) -> float:
    """Return the coherence of the actuator with what the leg's gains order; 1 where the actuator stood still."""
    outputs, actuators = np.std(stretch.values, axis=0)
    if actuators < _STILL * outputs:
        return 1.0
    moved = leg.spectra.cross_density(1, 1).real
    return math.sqrt(max(0.0, 1.0 - float(np.sum(leg.independent_actuator) / np.sum(moved))))
