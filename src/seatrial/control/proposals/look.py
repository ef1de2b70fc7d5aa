"""A stretch of steady speed and heading in, a proposal out: sea, craft and gains, or why there are none."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from seatrial.control.proposals.gain_schedule import GainSchedule
from seatrial.control.proposals.propose import ChosenGains, estimated, propose_gains
from seatrial.control.task import Seaway, TuningTask
from seatrial.control.verification.legs import natural_period
from seatrial.control.verification.stabiliser import prior_deviations
from seatrial.core.results.proposal import CraftFactor, HeadingRange, Proposal, SeaEstimate
from seatrial.core.values import Array
from seatrial.estimation.sea import (
    ObservedLeg,
    ShipInSea,
    WaveLeg,
    draw_ship_in_sea,
    encountered_sea,
    stretch_spectra,
)

SEGMENT_PERIODS = 24.0  # natural periods in a segment: following seas gather in a few bins; chosen
SHORTEST_PERIODS = 80.0  # natural periods that a stretch must hold: five segments and more; chosen
RATE = 12.0  # samples a natural period that the spectra need; chosen
_LOWEST, _HIGHEST = 0.25, 3.0  # frequencies over the natural one that are looked at; chosen
_QUIET = 4.0  # frequency over the natural one above which there are sensors alone; chosen
_LAST = 0.9  # of the highest frequency, above which there are sensors alone where the samples are slow; chosen
_LEAST_MOTION = math.radians(0.15)  # rms of a motion below which sensors and gusts are as large; chosen
_STILL = 0.02  # of the output's rms, below which the actuator counts as still; chosen
_LEAST_COHERENCE = 0.6  # of the actuator with what any gains of the loop order of the output; chosen
_CELLS = 36  # of headings from following to head seas; chosen
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
    draws = draw_ship_in_sea(leg_by_heading(task, stretch), prior_deviations(task), rng)
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


def leg_by_heading(task: TuningTask, stretch: Stretch) -> Callable[[float], WaveLeg]:
    """Return a function of the heading [rad] that gives the stretch as met at it."""
    seaway = next(met for met in task.disturbances if isinstance(met, Seaway))
    observed = _observed(task, stretch)
    expected = 2.0 * math.pi / seaway.spectrum.modal_frequency

    def leg_at(beta: float) -> WaveLeg:
        sea = encountered_sea(observed.spectra.omega, stretch.U, beta, seaway.effect)
        return WaveLeg(observed, sea, expected)

    return leg_at


def _observed(task: TuningTask, stretch: Stretch) -> ObservedLeg:
    """Return the band of the spectra in which the craft answers waves, with the density of what else is in it."""
    period = natural_period(task.loop)
    natural = 2.0 * math.pi / period
    spectra = stretch_spectra(stretch.values, stretch.dt, SEGMENT_PERIODS * period)
    density = spectra.cross_density(0, 0).real
    quiet = density[spectra.omega > min(_QUIET * natural, _LAST * spectra.omega[-1])]
    band = spectra.band_limited(_LOWEST * natural, _HIGHEST * natural)
    return ObservedLeg(band, task.loop_at(stretch.U), float(np.median(quiet)))


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
    """Return the fewest cells of headings that hold 95 % of draws (n,), neighbours together, the likeliest range first.

    Cells are five degrees wide.
    """
    edges = np.linspace(0.0, math.pi, _CELLS + 1)
    shares = np.histogram(headings, edges)[0] / len(headings)
    order = np.argsort(-shares, kind="stable")
    cells = np.sort(order[: int(np.searchsorted(np.cumsum(shares[order]), _PROBABILITY)) + 1])
    runs = np.split(cells, np.flatnonzero(np.diff(cells) > 1) + 1)
    ranges = [HeadingRange(float(edges[run[0]]), float(edges[run[-1] + 1]), float(np.sum(shares[run]))) for run in runs]
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
