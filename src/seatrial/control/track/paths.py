"""How rudder, heading order, waves and current reach heading and track of a craft with a heading loop, linearised.

The position across a track follows from heading and sway, y' = U psi + v (Fossen 2011, Handbook of Marine Craft
Hydrodynamics and Motion Control, section 10.3), so that both transfer functions share their denominator but for an
integrator: P_psi = a / d, P_y = b / (d s).
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from seatrial.control.ship.trimmed_ship import plant_and_disturbance, rate_response
from seatrial.control.task import TrimmedShip
from seatrial.core.values import Array, InputError
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops import Block, TransferLoop

EAST = "y0"
"""State that is the distance to starboard of a track to the north."""


@dataclass(frozen=True)
class Reach:
    """Transfer functions of one thing to the heading and to the distance from the track, without any control."""

    heading: Block
    track: Block


CURRENT = Reach(Block("current to psi", (0.0,)), Block("current to y0", (1.0,), (1.0, 0.0)))
"""A current across the track [m/s]: it carries the craft away and leaves its heading."""


@dataclass(frozen=True, eq=False)
class HeadingLoop:
    """A craft with the heading loop that its rudder is in, at that loop's own gains."""

    ship: TrimmedShip
    loop: TransferLoop

    @cached_property
    def rudder(self) -> Reach:
        """What the rudder does."""
        return Reach(self.loop.plant, plant_and_disturbance(replace(self.ship, output=EAST))[0])

    @cached_property
    def waves(self) -> Reach:
        """What a yaw acceleration [rad/s^2] does."""
        return Reach(rate_response(self.ship, "r"), rate_response(replace(self.ship, output=EAST), "r"))

    @cached_property
    def _controller(self) -> tuple[Array, Array]:
        """Numerator and denominator of the controller from the heading error to the rudder."""
        den, nums = replace(self.loop.continuous, plant=Block("none")).polynomials
        return self.loop.gain_values @ nums, den

    @cached_property
    def _characteristic(self) -> Array:
        """d k + a n of the heading loop with the controller n / k."""
        n, k = self._controller
        plant = self.rudder.heading
        return np.asarray(np.polyadd(np.polymul(plant.den, k), np.polymul(plant.num, n)), dtype=np.float64)

    def order_to_track(self) -> Block:
        """Return what the heading order does to the distance from the track, b n / (s (d k + a n))."""
        n, _ = self._controller
        b = _over(self.rudder.track, self.rudder.heading)
        num, den = np.polymul(b, n), np.polymul(self._characteristic, [1.0, 0.0])
        return _block("heading order to y0", num, den)

    def disturbance_to_track(self, reach: Reach) -> Block:
        """Return what a disturbance does to the distance from the track, the heading kept at its order.

        With g / d to the heading and h / (d s) to the track: (h (d k + a n) - b n g) / (d s (d k + a n)). The model's
        own poles d cancel exactly, which they must where it is unstable by itself.
        """
        if reach == CURRENT:
            return CURRENT.track
        n, _ = self._controller
        b, h = _over(self.rudder.track, self.rudder.heading), _over(reach.track, self.rudder.heading)
        g = np.array(reach.heading.num) * (self.rudder.heading.den[0] / reach.heading.den[0])
        num = np.polysub(np.polymul(h, self._characteristic), np.polymul(np.polymul(b, n), g))
        reduced, rest = np.polydiv(num, self.rudder.heading.den)
        if np.abs(rest).max(initial=0.0) > _REST * np.abs(num).max():
            raise InputError(
                f"'{reach.heading.name}' reaches states of model '{self.ship.model.name}' that its rudder does not: a "
                "track cannot be tuned in it; leave that disturbance out"
            )
        return _block(f"{reach.track.name}, heading kept", reduced, np.polymul(self._characteristic, [1.0, 0.0]))

    def rudder_response(self, reach: Reach, guidance: Complex, omega: Array) -> Complex:
        """Return rudder for a unit of a disturbance with psi_d = -guidance y, (n,), at omega (n,) [rad/s]."""
        K = self.loop.gain_values @ self.loop.continuous.controller_terms(omega)
        P, G = ((one.heading.frequency_response(omega), one.track.frequency_response(omega))
                for one in (self.rudder, reach))  # fmt: skip
        return -K * (G[0] + guidance * G[1]) / (1.0 + K * (P[0] + guidance * P[1]))


_REST = 1e-6  # of the largest coefficient, below which the rest of a division is rounding; chosen


def _over(track: Block, heading: Block) -> Array:
    """Return b of track = b / (d s), d the heading's denominator.

    Raises:
        InputError: the denominators are of other kinds.
    """
    common = np.polymul(heading.den, [1.0, 0.0]) / heading.den[0]
    if len(track.den) != len(common) or not np.allclose(np.array(track.den) / track.den[0], common, rtol=_REST):
        raise InputError(
            f"'{track.name}' and '{heading.name}' do not belong to one craft: the distance from a track is to be the "
            "integral of what heading and sway make of it; take a model with heading and position"
        )
    return np.array(track.num) * (heading.den[0] / track.den[0])


def _block(name: str, num: ArrayLike, den: ArrayLike) -> Block:
    """Return num / den with a leading 1 below."""
    above, below = np.asarray(num, dtype=np.float64), np.asarray(den, dtype=np.float64)
    return Block(name, tuple((above / below[0]).tolist()), tuple((below / below[0]).tolist()))
