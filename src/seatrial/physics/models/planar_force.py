"""A force in the plane of motion, as symbols of a model's sheet."""

from dataclasses import dataclass

import sympy as sp


@dataclass(frozen=True)
class PlanarForce:
    """Forces ahead and to starboard, and the moment about the origin."""

    X: sp.Symbol
    Y: sp.Symbol
    N: sp.Symbol
