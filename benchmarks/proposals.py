"""Voyages of ships with fins that differ from the model, in seas that change: what gains are proposed, and their worth.

Each voyage is a ship drawn from what the loop file says is uncertain. Every two hours the last 20 minutes, simulated
line by line (linear, Gaussian, with a sensor's noise) with the gains proposed last, are looked at; what is proposed is
judged on the true ship in the sea of the next look, two hours later on the same course. The known sea is that of the
schedule's gains at the true speed, heading and height. `python benchmarks/proposals.py HOURS SEED`
"""

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path

import numpy as np
from measure import Line, at_most

from seatrial import api
from seatrial.control.proposals import Stretch, look
from seatrial.control.schedule import GainSchedule, gain_schedule, schedule
from seatrial.control.task import ScheduleGrid, Seaway, TuningTask
from seatrial.control.verification.stabiliser import natural_period, prior_deviations
from seatrial.core.results.online import Proposal
from seatrial.core.results.ship_motions import IntervalEstimate
from seatrial.core.values import Array
from seatrial.estimation.sea import altered_loop, sea_spectrum
from seatrial.numerics.workers import map_in_processes
from seatrial.physics.hydro.excitation import G, encounter_frequency
from seatrial.physics.loops import TransferLoop
from seatrial.physics.loops.structures import PUBLISHED_GAINS

EXAMPLE = Path(__file__).parents[1] / "examples" / "fin_stabiliser.toml"
HOURS = 200  # simulated: four minutes of a core; 1000 take twenty
VOYAGE_H, LOOK_H, STRETCH_S = 10.0, 2.0, 1200.0  # h, h, s
NOISE = 1e-3  # rad, of a roll sensor
SEED = 22
SPEEDS = tuple(v / 1.943844 for v in (14.0, 18.0, 22.0))  # m/s, of 14, 18 and 22 kn
HEADINGS = tuple(math.radians(a) for a in (20.0, 45.0, 67.5, 90.0, 112.5, 135.0, 160.0))
HEIGHTS = (1.0, 2.0, 3.3, 4.5, 6.0)  # m
STEEPNESS, SPREAD = math.log(0.02), 0.5  # logarithm of 2 pi H / (g T^2) of the seas, and its deviation
FIRST_HEIGHTS = math.log(1.5), math.log(5.0)  # of a voyage's first sea, m
DRIFT = 0.2, 0.2  # deviations of the logarithms of height and steepness from one look to the next
TURNS = 0.3  # share of the looks before which course and speed were changed
LINES = 12000  # of a simulated sea, several in each step of a transform of the stretch
LONGEST = 0.4  # times the frequency of the peak: the longest waves of a simulated sea
FINER = 8  # times the frequencies of a transform of the stretch, on which its lines stand


@dataclass(frozen=True)
class Weather:
    """Speed [m/s], heading [rad], logarithms of height [m] and steepness, and of gamma - 1."""

    U: float
    beta: float
    height: float
    steepness: float
    peak: float

    @property
    def sea(self) -> Array:
        """Return logarithms of height and peak period, and of gamma - 1, (3,)."""
        period = 0.5 * (math.log(2.0 * math.pi / G) + self.height - self.steepness)
        return np.array([self.height, period, self.peak])

    def later(self, rng: np.random.Generator) -> "Weather":
        """Return that of the next look on the same course."""
        height, steepness = (
            value + rng.normal(0.0, step) for value, step in zip((self.height, self.steepness), DRIFT, strict=True)
        )
        return replace(self, height=height, steepness=min(max(steepness, STEEPNESS - 1.0), STEEPNESS + 1.0))

    def turned(self, rng: np.random.Generator) -> "Weather":
        """Return it on another course, at another speed."""
        return replace(self, U=float(rng.uniform(SPEEDS[0], SPEEDS[-1])), beta=_heading(rng))


def _heading(rng: np.random.Generator) -> float:
    return float(rng.uniform(0.02, math.pi - 0.02))


def first_weather(rng: np.random.Generator) -> Weather:
    """Return that at the start of a voyage."""
    peak = float(np.clip(rng.normal(0.0, 1.5), -4.5, 2.5))
    weather = Weather(SPEEDS[0], 1.0, float(rng.uniform(*FIRST_HEIGHTS)), float(rng.normal(STEEPNESS, SPREAD)), peak)
    return weather.turned(rng)


def wide_schedule(task: TuningTask) -> GainSchedule:
    """Return the example's schedule over more headings and heights."""
    grid = ScheduleGrid(SPEEDS, HEADINGS, HEIGHTS)
    return gain_schedule(schedule(task, grid, {}, SEED, lambda _: None).points, task.loop.gains.names)


def stretch(task: TuningTask, loop: TransferLoop, weather: Weather, rng: np.random.Generator) -> Stretch:
    """Return 20 minutes of roll and fin angle of a loop at its gains, from lines of its own spectrum."""
    dt = natural_period(task.loop) / 12.0
    count = round(STRETCH_S / dt)
    spectrum, seaway = sea_spectrum(weather.sea), next(met for met in task.disturbances if isinstance(met, Seaway))
    # up to the shortest waves that move the ship: those of following seas are met at frequencies of the roll, too
    edges = np.linspace(LONGEST * spectrum.modal_frequency, seaway.effect.frequency_range[1], LINES + 1)
    omega = edges[:-1] + np.diff(edges) * rng.random(LINES)
    met = np.abs(encounter_frequency(omega, weather.U, weather.beta))
    size = np.sqrt(spectrum.density(omega) * (edges[1] - edges[0]))
    size = size * np.abs(seaway.effect.amplitude(omega, weather.U, weather.beta))
    slope = size * (rng.standard_normal(len(omega)) + 1j * rng.standard_normal(len(omega)))
    roll = loop.disturbance.frequency_response(met) * slope
    places = np.round(met * FINER * count * dt / (2.0 * math.pi)).astype(int)
    inside = places < FINER * count // 2
    lines = np.zeros(FINER * count // 2 + 1, dtype=np.complex128)
    np.add.at(lines, places[inside], (len(lines) - 1) * roll[inside])
    grid = 2.0 * math.pi / (FINER * count * dt) * np.arange(len(lines))
    grid[0] = grid[1]  # a controller may integrate; the mean does not count
    read = lines + np.fft.rfft(rng.normal(0.0, NOISE, FINER * count))
    controller = loop.gain_values @ loop.controller_terms(grid)
    # what the sensor reads, noise and all, is what the fins follow: (D w + e) / (1 + P K)
    read = read / (1.0 + controller * loop.plant.frequency_response(grid))
    values = np.fft.irfft(np.stack([read, -controller * read], axis=1), axis=0)[:count]
    return Stretch(0.0, dt, values, weather.U)


@dataclass(frozen=True, eq=False)
class Look:
    """One look: what was proposed, in which weather, and what the true ship makes of it in the sea of the next.

    cost, known: rms of roll over that without control, with the gains proposed and with those of the known sea; NaN
    where none are proposed. is_stable: whether the true ship is with the gains proposed.
    """

    weather: Weather
    ship: Array
    proposal: Proposal
    cost: float
    known: float
    is_stable: bool


def voyage(task: TuningTask, gains: GainSchedule, seed: int, looks: int) -> list[Look]:
    """Return the looks of one voyage."""
    rng = np.random.default_rng([SEED, seed])
    ship, weather = rng.normal(0.0, prior_deviations(task)), first_weather(rng)
    on = np.array([PUBLISHED_GAINS[name] for name in task.loop.gains.names])
    proposed, made = None, []
    for _ in range(looks):
        weather = weather.turned(rng) if rng.random() < TURNS else weather
        loop = altered_loop(task.loop_at(weather.U), ship)
        proposal = look(task, gains, stretch(task, loop.with_gains(on), weather, rng), proposed, seed)
        later = weather.later(rng)
        cost = known = math.nan
        is_stable = True
        if proposal.has_gains:
            on = proposed = np.array(list(proposal.gains.values()))
            is_stable = float(loop.with_gains(on).closed_loop_poles.real.max()) < 0.0
            cost, known = (_cost(task, loop.with_gains(k), later) for k in (on, _known_gains(gains, later)))
        made.append(Look(weather, ship, proposal, cost, known, is_stable))
        weather = later
    return made


def _known_gains(gains: GainSchedule, weather: Weather) -> Array:
    """Return the schedule's gains in this weather; at its edge where the weather lies beyond."""
    condition = (weather.U, weather.beta, math.exp(weather.height))
    return gains.gains_at(np.array([[np.clip(c, *gains.limits(k)) for k, c in enumerate(condition)]]))[0]


def _cost(task: TuningTask, loop: TransferLoop, weather: Weather) -> float:
    """Return the rms of roll over that without control, by a sum over the waves; infinite where it is unstable."""
    if float(loop.closed_loop_poles.real.max()) >= 0.0:
        return math.inf
    spectrum, seaway = sea_spectrum(weather.sea), next(met for met in task.disturbances if isinstance(met, Seaway))
    omega = np.linspace(LONGEST * spectrum.modal_frequency, seaway.effect.frequency_range[1], LINES)
    met = np.abs(encounter_frequency(omega, weather.U, weather.beta))
    slope = np.abs(seaway.effect.amplitude(omega, weather.U, weather.beta)) ** 2 * spectrum.density(omega)
    free = np.abs(loop.disturbance.frequency_response(met)) ** 2 * slope
    return math.sqrt(float(np.sum(free / np.abs(1.0 + loop.open_loop(met)) ** 2) / np.sum(free)))


def run(hours: int = HOURS, first: int = 0) -> list[Line]:
    """Return what `hours` of voyages show; the first voyage's seed is `first`."""
    gains, seeds = wide_schedule(fin_task()), range(first, first + round(hours / VOYAGE_H))
    voyages = map_in_processes(partial(_voyage, gains, round(VOYAGE_H / LOOK_H)), seeds)
    return lines(hours, [one for looks in voyages for one in looks])


@cache
def fin_task() -> TuningTask:
    """Return the example's task; read once in each process."""
    return api.load_loop(EXAMPLE)


def _voyage(gains: GainSchedule, looks: int, seed: int) -> list[Look]:
    return voyage(fin_task(), gains, seed, looks)


def lines(hours: int, every: Sequence[Look]) -> list[Line]:
    """Return the table of all looks."""
    seen = [one for one in every if one.proposal.sea is not None]
    offered = [one for one in every if one.proposal.has_gains]
    inside = {name: 100.0 * float(np.mean([_is_inside(one, name) for one in seen])) for name in _QUANTITIES}
    narrow = [one for one in seen if one.proposal.sea is not None and one.proposal.sea.is_heading_determined]
    ratio = sum(one.cost for one in offered) / sum(one.known for one in offered)
    draws = sum(
        one.proposal.margins.draws - one.proposal.margins.stable_draws for one in offered if one.proposal.margins
    )
    made = [
        at_most(f"{hours} h: unstable proposals on the true ship", sum(not one.is_stable for one in offered), "", 0.0),
        at_most("crafts drawn that a proposal leaves unstable", float(draws), "", 0.0),
        at_most("roll left over that by gains of the known sea, two hours later", ratio, "", 1.15),
        Line("looks with a sea estimated", 100.0 * len(seen) / len(every), "%"),
        Line("looks with gains proposed", 100.0 * len(offered) / len(every), "%"),
        Line("proposals that are new", 100.0 * float(np.mean([one.proposal.is_new for one in offered])), "%"),
        Line("seas whose heading is determined", 100.0 * len(narrow) / len(seen), "%"),
    ]
    for name, share in inside.items():
        made.append(Line(f"{name} inside its 95 % interval", share, "%", "93 to 97 %", 93.0 <= share <= 97.0))
    return made


_QUANTITIES = ("height", "peak period", "heading", "craft")


def _is_inside(one: Look, name: str) -> float:
    """Return whether the truth lies in the interval; for the craft, share of its three factors."""
    sea, weather = one.proposal.sea, one.weather
    assert sea is not None
    if name == "heading":
        return any(r.lower <= weather.beta <= r.upper for r in sea.headings)
    if name == "craft":
        factors = zip(one.proposal.craft, np.exp(one.ship).tolist(), strict=True)
        return float(np.mean([_holds(craft.factor, value) for craft, value in factors]))
    which = 0 if name == "height" else 1
    return _holds((sea.height, sea.period)[which], math.exp(weather.sea[which]))


def _holds(interval: IntervalEstimate, value: float) -> bool:
    return interval.lower <= value <= interval.upper


if __name__ == "__main__":
    for line in run(*map(int, sys.argv[1:])):
        print(f"{line.quantity:<66} {line.value:>10.4g} {line.unit:<10} {line.verdict}")
