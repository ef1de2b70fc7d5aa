"""The sway guide: what its force has in phase with the sway velocity, run by run, and how that goes with velocity.

Sway is taken from the spring tensions, which share the force's clock.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array
from seatrial_studies.section2d.harmonics import harmonics
from seatrial_studies.section2d.modes import jackknife_error
from seatrial_studies.section2d.responses import steady_samples
from seatrial_studies.section2d.runs import FlumeRun


@dataclass(frozen=True)
class Friction:
    """One run.

    Attributes:
        velocity: amplitude of sway velocity, m/s.
        damping: force against velocity over velocity, N s/m: linear damping of equal work.
        force: amplitude of that force, N.
        third_harmonic_ratio: third harmonic of the holding force over its first; 1/3 for dry friction alone.
    """

    run: str
    velocity: float
    damping: float
    force: float
    third_harmonic_ratio: float


@dataclass(frozen=True)
class Guide:
    """All runs; damping goes with exp(level) velocity^exponent: 0 linear, -1 dry friction, 1 quadratic."""

    runs: tuple[Friction, ...]
    exponent: float
    level: float
    error: float

    def velocity_at_damping(self, damping: float) -> float:
        """m/s at which the damping is that many N s/m."""
        return float(np.exp((np.log(damping) - self.level) / self.exponent))


def fit_guide_damping(runs: Sequence[FlumeRun], stiffness: float) -> Guide:
    """Of runs that sway freely.

    Args:
        stiffness: of the springs, N/m.

    Raises:
        InputError: a run's steady stretch holds no whole wave period.
    """
    made = tuple(f for f in (guide_friction(r, stiffness) for r in runs if r.scenario in (3, 4)) if f.damping > 0.0)
    if len(made) < 3:
        return Guide(made, float("nan"), float("nan"), float("nan"))
    points = np.log(np.array([(f.velocity, f.damping) for f in made]))
    left = [_fit_line(np.delete(points, k, axis=0))[0] for k in range(len(made))]
    return Guide(made, *_fit_line(points), jackknife_error(left))


def guide_friction(run: FlumeRun, stiffness: float) -> Friction:
    """One run's steady stretch.

    Raises:
        InputError: the stretch holds no whole wave period.
    """
    rows, record = steady_samples(run), run.record
    time = record.time[rows]
    sway = harmonics(time, (record["S_1"] - record["S_2"])[rows], run.omega).first / stiffness
    force = harmonics(time, record["F_y"][rows], run.omega)
    velocity = 1j * run.omega * sway
    damping = -(force.first / velocity).real
    third = float(abs(force.amplitudes[2]) / abs(force.first))
    return Friction(run.name, abs(velocity), damping, damping * abs(velocity), third)


def _fit_line(points: Array) -> tuple[float, float]:
    slope, level = np.polyfit(points[:, 0], points[:, 1], 1)
    return float(slope), float(level)
