"""The Lewis form: a ship-like section from beam, draught and area (Lewis 1929; Tasai 1959)."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from seatrial.core.values import Array, InputError


@dataclass(frozen=True)
class LewisForm:
    """Section x + i y = i M (e^(alpha - i theta) + ...), x to the side from the centre line, y down from the waterline.

    Attributes:
        scale: M, m.
        a1, a3: coefficients of the map; both zero for the half circle.
        beam, draught: m.
    """

    scale: float
    a1: float
    a3: float
    beam: float
    draught: float

    @classmethod
    def from_dimensions(cls, beam: float, draught: float, area_coefficient: float) -> Self:
        """Return the form with that beam, draught [m] and area / (beam draught).

        a1, a3 from B / 2d and sigma (von Kerczek & Tuck 1969, J. Ship Research 13, 284-289).

        Raises:
            InputError: sizes are not positive, or no Lewis form has that area.
        """
        if not (beam > 0.0 and draught > 0.0 and area_coefficient > 0.0):
            raise InputError("a section needs a positive beam, draught and area coefficient")
        ratio = (0.5 * beam - draught) / (0.5 * beam + draught)
        c = 3.0 + 4.0 * area_coefficient / math.pi + (1.0 - 4.0 * area_coefficient / math.pi) * ratio**2
        if c > 4.5:
            raise InputError(
                f"no Lewis form has the area coefficient {area_coefficient:g} at beam {beam:g} m and draught "
                f"{draught:g} m; lower it"
            )
        a3 = (3.0 - c + math.sqrt(9.0 - 2.0 * c)) / c
        a1 = ratio * (1.0 + a3)
        return cls(0.5 * beam / (1.0 + a1 + a3), a1, a3, beam, draught)

    def points(self, theta: Array) -> tuple[Array, Array]:
        """x, y [m] of the contour; theta from 0 at the keel to pi / 2 at the waterline."""
        x = (1.0 + self.a1) * np.sin(theta) - self.a3 * np.sin(3.0 * theta)
        y = (1.0 - self.a1) * np.cos(theta) + self.a3 * np.cos(3.0 * theta)
        return self.scale * x, self.scale * y

    def tangents(self, theta: Array) -> tuple[Array, Array]:
        """dx/dtheta, dy/dtheta [m]."""
        x = (1.0 + self.a1) * np.cos(theta) - 3.0 * self.a3 * np.cos(3.0 * theta)
        y = -(1.0 - self.a1) * np.sin(theta) - 3.0 * self.a3 * np.sin(3.0 * theta)
        return self.scale * x, self.scale * y

    @property
    def area(self) -> float:
        """m^2: pi/2 M^2 (1 - a1^2 - 3 a3^2)."""
        return 0.5 * math.pi * self.scale**2 * (1.0 - self.a1**2 - 3.0 * self.a3**2)
