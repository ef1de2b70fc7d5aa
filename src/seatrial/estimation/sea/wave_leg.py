"""One stretch of steady speed and heading in waves that nobody measured: its likelihood in closed loop (Whittle).

What the motion would be without the actuator, y - P a, is the response to the waves alone. Its density is that of a sea
through the ship. Where the actuator follows the output, a = -K y and something of its own, the density of y is |S|^2
times that, and the determinant of this change belongs into the likelihood (identification in closed loop: Ljung 1999,
System Identification, section 13.4). K is the one that the stretch itself shows, limits and all.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.sea.encountered_sea import SEA_UNKNOWNS, EncounteredSea
from seatrial.estimation.sea.plant_factors import PLANT_FACTORS, altered_loop
from seatrial.estimation.sea.stretch_spectra import StretchSpectra
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops import Block, TransferLoop

SHIP_COUNT, SEA_COUNT = len(PLANT_FACTORS), len(SEA_UNKNOWNS)
STEP = 1e-4  # of logarithmic unknowns, for central differences; chosen
_FLOOR = 1e-5  # of the largest density: sensors and whatever else the sea does not explain; chosen
_PERIODS = np.geomspace(0.4, 2.5, 15)  # peak periods to begin from, over the one expected; chosen


@dataclass(frozen=True, eq=False)
class LegLikelihood:
    """Minus the logarithm of a leg's likelihood, up to a constant; logarithms of densities and plant, each (k,)."""

    cost: float
    log_free: Array
    log_controlled: Array
    plant: Complex


@dataclass(frozen=True, eq=False)
class WaveLeg:
    """A stretch of steady speed and heading.

    Attributes:
        spectra: of output and actuator, in that order; sea: the nodes for its frequencies.
        loop: its plant and disturbance are those at the leg's speed.
        expected_period: s, of the sea's peak, from which the search starts.
    """

    spectra: StretchSpectra
    sea: EncounteredSea
    loop: TransferLoop
    expected_period: float

    @cached_property
    def _densities(self) -> tuple[Array, Array, Complex]:
        outputs, actuators = (self.spectra.cross_density(k, k).real for k in (0, 1))
        return outputs, actuators, self.spectra.cross_density(1, 0)

    @property
    def controller(self) -> Complex:
        """Return K of a = -K y as the leg shows it, (k,); zero where the actuator stood still."""
        return -self._densities[2] / self._densities[0]

    @property
    def independent_actuator(self) -> Array:
        """Return the density of what the actuator does besides following the output, (k,): limits, orders, sensors."""
        outputs, actuators, cross = self._densities
        return actuators - np.abs(cross) ** 2 / outputs

    def free_density(self, plant: Block) -> Array:
        """Return the density of y - P a, (k,)."""
        outputs, actuators, cross = self._densities
        P = plant.frequency_response(self.spectra.omega)
        return outputs - 2.0 * np.real(P * cross) + np.abs(P) ** 2 * actuators

    def likelihood(self, ship: Array, sea: Array) -> LegLikelihood:
        """Return the likelihood at factors on the ship (3,) and unknowns of the sea (3,)."""
        loop = altered_loop(self.loop, ship)
        gain = np.abs(loop.disturbance.frequency_response(self.sea.omega_e)) ** 2
        free = np.log(self.sea.density(sea, gain) + _FLOOR * float(np.max(self._densities[0])))
        P = loop.plant.frequency_response(self.spectra.omega)
        controlled = free - 2.0 * np.log(np.abs(1.0 + P * self.controller))
        misfit = self.free_density(loop.plant) * np.exp(-free)
        return LegLikelihood(self.spectra.information * float(np.sum(controlled + misfit)), free, controlled, P)

    def equations(self, ship: Array, sea: Array) -> tuple[Array, Array]:
        """Return gradient (6,) and Fisher information (6, 6) of the cost, over the ship's and the sea's unknowns.

        What the actuator does besides following the output moves the ship as a known input does: the second term.
        """
        steps = STEP * np.eye(SHIP_COUNT + SEA_COUNT)
        ends = [
            [self.likelihood(ship + sign * s[:SHIP_COUNT], sea + sign * s[SHIP_COUNT:]) for sign in (1.0, -1.0)]
            for s in steps
        ]
        gradient = np.array([up.cost - down.cost for up, down in ends]) / (2.0 * STEP)
        slopes = np.array([up.log_controlled - down.log_controlled for up, down in ends]) / (2.0 * STEP)
        moved = np.array([up.plant - down.plant for up, down in ends]) / (2.0 * STEP)
        weight = self.independent_actuator * np.exp(-self.likelihood(ship, sea).log_free)
        fisher = slopes @ slopes.T + 2.0 * np.real((moved * weight) @ moved.conj().T)
        return gradient, self.spectra.information * fisher

    def start(self, ship: Array, peak: float) -> Array:
        """Return the sea (3,) of the best of some peak periods, its height by the energy of the motion."""
        points = [np.array([0.0, np.log(self.expected_period * ratio), peak]) for ratio in _PERIODS]
        observed = self.free_density(altered_loop(self.loop, ship).plant)
        for point in points:
            point[0] = 0.5 * np.log(np.mean(observed * np.exp(-self.likelihood(ship, point).log_free)))
        return min(points, key=lambda point: self.likelihood(ship, point).cost)
