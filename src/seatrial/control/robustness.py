"""A controller on ships that differ from the model: those drawn from the fit, and the corners of a box about it."""

import math
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from seatrial.control.ship import SEED, draw_parameters, loops_drawn
from seatrial.control.task import PlantUncertainty, TuningTask
from seatrial.core.results.tuning import Robustness
from seatrial.core.values import Array
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops import Block, TransferLoop, margins
from seatrial.physics.loops.performance import frequency_band

SHIPS = 1000  # drawn from the covariance of the fit; chosen
_POINTS = 1000  # frequencies, evenly in the logarithm, on which the largest |S| of each ship is sought; chosen


@dataclass(frozen=True)
class _Corner:
    """Factors of the plant's gain and time constants, and a dead time [s]."""

    gain: float
    time: float
    dead_time: float

    @property
    def text(self) -> str:
        return f"gain {self.gain:.3g}, time constants {self.time:.3g}, dead time {self.dead_time:.3g} s"


def robustness(task: TuningTask, loop: TransferLoop, name: str, gains: Array, draws: int = SHIPS) -> Robustness:
    """Return how the gains (g,) of a loop hold ships drawn from the fit, and the corners of the task's uncertainty.

    A corner has the plant's gain, its time constants and its dead time at one end each; a ship drawn counts as stable
    on the straight course and starting either turn.
    """
    own = loop.with_gains(gains)
    omega = np.geomspace(*frequency_band(own), _POINTS)
    drawn_Ms, stable = _of_draws(task, loop, gains, omega, draws)
    corners = _corners(task.uncertainty, loop)
    peaks = [_corner_Ms(own, corner, omega) for corner in corners]
    worst = int(np.argmax(peaks))
    return Robustness(
        name, len(stable), sum(stable), drawn_Ms, len(corners), sum(map(math.isfinite, peaks)), peaks[worst],
        corners[worst].text,
    )  # fmt: skip


def _of_draws(
    task: TuningTask, loop: TransferLoop, gains: Array, omega: Array, draws: int
) -> tuple[float, tuple[bool, ...]]:
    """Return the largest Ms of the ships drawn and whether each is stable; infinite where one is not."""
    if task.trimmed_ship is None:
        return math.nan, ()
    samples = draw_parameters(task.trimmed_ship, draws, SEED)
    without_trim = samples.draws - len(samples.ships)
    stable = (*samples.stable_ships(loop, gains), *[False] * without_trim)
    if not stable:
        return math.nan, ()
    if not all(stable):
        return math.inf, stable
    terms = loop.term_responses(omega)
    return max(_peak(gains @ (terms * one.path_response(omega))) for one in loops_drawn(loop, samples)), stable


def _corners(box: PlantUncertainty, loop: TransferLoop) -> list[_Corner]:
    """Return the corners of a box; without a dead time of its own up to that of the loop."""
    gains, times = ({1.0 - share, 1.0 + share} for share in (box.gain, box.time))
    declared = 0.0 if loop.sampling is None else loop.sampling.dead_time
    latest = declared if box.dead_time is None else box.dead_time
    return [_Corner(*one) for one in product(sorted(gains), sorted(times), sorted({0.0, latest}))]


def _corner_Ms(loop: TransferLoop, corner: _Corner, omega: Array) -> float:
    """Return Ms of one corner; infinite where it is unstable.

    The dead time is that of a sampled loop; one in continuous time is stable up to its delay margin.
    """
    there = replace(loop, plant=slowed_plant(loop.plant, corner.time).scaled(corner.gain))
    late = corner.dead_time
    if there.sampling is not None:
        there, late = replace(there, sampling=replace(there.sampling, dead_time=late)), 0.0
    bare = margins(there)
    if not bare.is_stable or bare.delay <= late:
        return math.inf
    return _peak(there.open_loop(omega) * np.exp(-1j * omega * late))


def slowed_plant(plant: Block, factor: float) -> Block:
    """Return the plant with all its time constants times `factor`, and the same answer to slow inputs.

    P(factor s), times the factor for each integrator: K / (s (T s + 1)) becomes K / (s (factor T s + 1)).
    """
    integrators = next(i for i, c in enumerate(reversed(plant.den)) if c)
    return plant.stretched(factor).scaled(factor**integrators)


def _peak(open_loop: Complex) -> float:
    return max(float(np.max(1.0 / np.abs(1.0 + open_loop))), 1.0)
