"""One stretch of steady speed and heading in waves that nobody measured: its likelihood in closed loop (Whittle).

The output is S (D w + P e): waves w through the ship's response D, and what the actuator does besides following the
output, a = -K y + e, through the plant P, all divided by the loop's 1 + P K (identification in closed loop: Ljung 1999,
System Identification, section 13.4). K is that of the gains which the stretch itself shows, limits and all.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.sea.encountered_sea import SEA_UNKNOWNS, EncounteredSea
from seatrial.estimation.sea.plant_factors import PLANT_FACTORS, altered_loop
from seatrial.estimation.sea.stretch_spectra import StretchSpectra
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops import TransferLoop

SHIP_COUNT, SEA_COUNT = len(PLANT_FACTORS), len(SEA_UNKNOWNS)
STEP = 1e-4  # of logarithmic unknowns, for central differences; chosen
_FLOOR = 1e-5  # of the largest density: sensors and whatever else the sea does not explain; chosen
_PERIODS = np.geomspace(0.4, 2.5, 15)  # peak periods to begin from, over the one expected; chosen
_ALIKE = 1e-3  # of the strongest combination of the controller's terms, below which one is not in the stretch; chosen


@dataclass(frozen=True, eq=False)
class LegLikelihood:
    """Minus the logarithm of a leg's likelihood, up to a constant; logarithm of the output's density, (k,)."""

    cost: float
    log_density: Array


@dataclass(frozen=True, eq=False)
class ShipResponses:
    """Of one ship with its loop closed: |S D|^2 at the nodes, and the density that S P e has, (k,)."""

    gain: Array
    by_actuator: Array


@dataclass(frozen=True, eq=False)
class ObservedLeg:
    """What a stretch shows, whatever sea it was in.

    Attributes:
        spectra: of output and actuator, in that order.
        loop: its plant and disturbance are those at the leg's speed; of its gains the values do not count.
    """

    spectra: StretchSpectra
    loop: TransferLoop

    @cached_property
    def gains(self) -> Array:
        """Return the loop's gains as the leg shows them, (g,): actuator regressed on each term of the output.

        Combinations of which the stretch holds nothing stay at zero.
        """
        outputs, actuators = (self.spectra.transforms[:, :, k] for k in (0, 1))
        terms = -self.loop.controller_terms(self.spectra.omega)[:, None, :] * outputs
        rows = terms.reshape(len(terms), -1).T
        size = np.linalg.norm(rows, axis=0)
        both = np.concatenate([rows.real, rows.imag]) / size
        wanted = actuators.ravel()
        return np.asarray(np.linalg.lstsq(both, np.concatenate([wanted.real, wanted.imag]), rcond=_ALIKE)[0] / size)

    @cached_property
    def output_density(self) -> Array:
        """Return the density of the output, (k,)."""
        return self.spectra.cross_density(0, 0).real

    @cached_property
    def controller(self) -> Complex:
        """Return K of a = -K y at the frequencies of the spectra, (k,)."""
        return self.controller_at(self.spectra.omega)

    def controller_at(self, omega: Array) -> Complex:
        """Return K of a = -K y at the gains that the leg shows, (k,)."""
        return np.asarray(self.gains @ self.loop.controller_terms(omega), dtype=np.complex128)

    @cached_property
    def independent_actuator(self) -> Array:
        """Return the density of what the actuator does besides following the output, (k,): limits, orders, sensors."""
        ordered = -self.controller[:, None] * self.spectra.transforms[:, :, 0].T
        return np.mean(np.abs(self.spectra.transforms[:, :, 1].T - ordered) ** 2, axis=1)


@dataclass(frozen=True, eq=False)
class WaveLeg:
    """A stretch of steady speed and heading.

    Attributes:
        observed: its spectra and its loop; sea: the nodes for its frequencies.
        expected_period: s, of the sea's peak, from which the search starts.
    """

    observed: ObservedLeg
    sea: EncounteredSea
    expected_period: float

    @property
    def spectra(self) -> StretchSpectra:
        """Return the spectra of output and actuator."""
        return self.observed.spectra

    @cached_property
    def _node_controller(self) -> Complex:
        return self.observed.controller_at(self.sea.omega_e)

    def likelihood(self, ship: Array, sea: Array) -> LegLikelihood:
        """Return the likelihood at factors on the ship (3,) and unknowns of the sea (3,)."""
        return self._likelihood(self.responses(ship), self.sea.disturbance_energy(sea))

    def responses(self, ship: Array) -> ShipResponses:
        """Return the responses of the ship with these factors (3,)."""
        loop = altered_loop(self.observed.loop, ship)
        closed = 1.0 + loop.plant.frequency_response(self.sea.omega_e) * self._node_controller
        gain = np.abs(loop.disturbance.frequency_response(self.sea.omega_e) / closed) ** 2
        P = loop.plant.frequency_response(self.spectra.omega)
        moved = np.abs(P / (1.0 + P * self.observed.controller)) ** 2 * self.observed.independent_actuator
        return ShipResponses(gain, moved + _FLOOR * float(np.max(self.observed.output_density)))

    def _likelihood(self, ship: ShipResponses, energy: Array) -> LegLikelihood:
        """Return the likelihood of a ship met by waves of that energy at each node, (n,)."""
        density = self.sea.leakage @ (ship.gain * energy) + ship.by_actuator
        terms = np.log(density) + self.observed.output_density / density
        return LegLikelihood(self.spectra.information * float(np.sum(terms)), np.log(density))

    def equations(self, ship: Array, sea: Array) -> tuple[Array, Array]:
        """Return gradient (6,) and Fisher information (6, 6) of the cost, over the ship's and the sea's unknowns."""
        here, energy = self.responses(ship), self.sea.disturbance_energy(sea)
        ends = [
            *([self._likelihood(self.responses(ship + sign * step), energy) for sign in (1.0, -1.0)]
              for step in STEP * np.eye(SHIP_COUNT)),
            *([self._likelihood(here, self.sea.disturbance_energy(sea + sign * step)) for sign in (1.0, -1.0)]
              for step in STEP * np.eye(SEA_COUNT)),
        ]  # fmt: skip
        gradient = np.array([up.cost - down.cost for up, down in ends]) / (2.0 * STEP)
        slopes = np.array([up.log_density - down.log_density for up, down in ends]) / (2.0 * STEP)
        return gradient, self.spectra.information * slopes @ slopes.T

    def start(self, ship: Array, peak: float) -> Array:
        """Return the sea (3,) of the best of some peak periods, its height by the energy of the motion."""
        points = [np.array([0.0, np.log(self.expected_period * ratio), peak]) for ratio in _PERIODS]
        responses = self.responses(ship)
        for point in points:
            density = np.exp(self._likelihood(responses, self.sea.disturbance_energy(point)).log_density)
            point[0] = 0.5 * np.log(np.mean(self.observed.output_density / density))
        return min(points, key=lambda point: self._likelihood(responses, self.sea.disturbance_energy(point)).cost)
