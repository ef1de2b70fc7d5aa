"""Mean squares of a loop in waves: as linear theory has them in a sea, and as the spectra of legs show them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.sea import EncounteredSea
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops import TransferLoop, reversals_per_hour

_LEAST_WAVES = 0.01  # of the largest density of the elevation, below which there are no waves; chosen


@dataclass(frozen=True)
class LoopMoments:
    """Mean squares, SI: of the output without control and with it, of the actuator, its rate and its acceleration."""

    free: float
    output: float
    actuator: float
    rate: float
    acceleration: float

    @property
    def reduction(self) -> float:
        """Return the share of the output's rms that control takes off."""
        return 1.0 - math.sqrt(self.output / self.free)

    @property
    def reversals(self) -> float:
        """Return how often the actuator turns back in an hour."""
        return reversals_per_hour(math.sqrt(self.rate), math.sqrt(self.acceleration))


def mean_moments(moments: Sequence[LoopMoments]) -> LoopMoments:
    """Return the mean of legs of equal weight."""
    rows = [(one.free, one.output, one.actuator, one.rate, one.acceleration) for one in moments]
    return LoopMoments(*np.mean(rows, axis=0).tolist())


def predicted_moments(loop: TransferLoop, sea: EncounteredSea, unknowns: Array) -> LoopMoments:
    """Return the moments of a loop at its gains in a sea of these unknowns (3,)."""
    omega = sea.omega_e
    free = np.abs(loop.disturbance.frequency_response(omega)) ** 2 * sea.disturbance_energy(unknowns)
    controller = loop.gain_values @ loop.controller_terms(omega)
    output = free / np.abs(1.0 + controller * loop.plant.frequency_response(omega)) ** 2
    actuator = np.abs(controller) ** 2 * output
    sums = (free, output, actuator, omega**2 * actuator, omega**4 * actuator)
    return LoopMoments(*(float(np.sum(part)) for part in sums))


def logged_moments(products: Complex, omega: Array, plant: Complex) -> LoopMoments:
    """Return the moments of a leg, its output without control as y - P a.

    products: (k, c, c), means over segments of transforms times conjugate transforms, output and actuator first;
    omega: (k,), rad/s; plant: P, (k,).
    """
    outputs, actuators = (np.real(products[:, place, place]) for place in (0, 1))
    free = outputs - 2.0 * np.real(plant * products[:, 1, 0]) + np.abs(plant) ** 2 * actuators
    step = float(omega[1] - omega[0])
    sums = (free, outputs, actuators, omega**2 * actuators, omega**4 * actuators)
    return LoopMoments(*(float(np.sum(part)) * step for part in sums))


def plain_reduction(on: Complex, off: Complex) -> float:
    """Return the reduction of the rms between mean products (k, c, c) with and without control."""
    controlled, free = (float(np.sum(np.real(part[:, 0, 0]))) for part in (on, off))
    return 1.0 - math.sqrt(controlled / free)


def reduction_by_waves(on: Complex, off: Complex) -> float:
    """Return the reduction with the motion without control carried to the waves met with it, frequency by frequency.

    on, off: mean products (k, 3, 3), the recorded elevation last. Frequencies at which there are no waves are left out.
    """
    waves_on, waves_off = (np.real(part[:, 2, 2]) for part in (on, off))
    strong = waves_off > _LEAST_WAVES * np.max(waves_off)
    carried = np.sum((np.real(off[:, 0, 0]) * waves_on)[strong] / waves_off[strong])
    return 1.0 - math.sqrt(float(np.sum(np.real(on[strong, 0, 0])) / carried))
