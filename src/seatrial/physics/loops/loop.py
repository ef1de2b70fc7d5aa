"""A feedback loop that is rational in s and linear in its gains."""

from dataclasses import dataclass, replace
from functools import cached_property, reduce
from typing import Self

import numpy as np

from seatrial.core.values import Array, InputError, Parameters, frozen
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops.block import Block, in_series


@dataclass(frozen=True)
class Term:
    """One part of the controller: the gain of that name times the block."""

    gain: str
    block: Block


@dataclass(frozen=True)
class HullPoint:
    """The downward motion of the hull x metres forward of its origin, z - x theta, that the actuator also makes.

    plant: from the actuator to it.
    """

    x: float
    plant: Block


@dataclass(frozen=True, eq=False)
class TransferLoop:
    """Negative feedback from an output y to the actuator a that moves it, against a disturbance w.

        y = P a + D w,   a = -K y,   K = servo * filters * (sum of gain_i term_i) * sensor,   L = P K,   S = 1 / (1 + L)

    so that y = D S w, a = -K D S w. Angles are radians, gains as the field gives them.

    Attributes:
        sensor: from y to what the terms see; filters: common to all terms (notches); servo: from order to actuator.
        terms: parallel, one for each gain.
        plant: P, from the actuator to the output; disturbance: D, from w to the output.
        gains: one parameter for each term, in order: value, bounds, free or fixed.
        output, actuator, disturbance_input: symbols of y, a and w.
        points: what the actuator also moves, to be made small but not fed back.

    Raises:
        InputError: gains and terms do not go together, or a gain lacks a bound.
    """

    name: str
    sensor: tuple[Block, ...]
    terms: tuple[Term, ...]
    filters: tuple[Block, ...]
    servo: tuple[Block, ...]
    plant: Block
    disturbance: Block
    gains: Parameters
    output: str = "phi"
    actuator: str = "alpha_f"
    disturbance_input: str = "alpha_w"
    points: tuple[HullPoint, ...] = ()

    def __post_init__(self) -> None:
        if tuple(term.gain for term in self.terms) != self.gains.names or not self.terms:
            raise InputError(f"loop '{self.name}': give one gain for each term of the controller, in the same order")
        for gain in self.gains.free:
            if not np.isfinite(gain.upper - gain.lower):
                raise InputError(f"loop '{self.name}': gain {gain.name} needs finite bounds to be tuned")

    @property
    def gain_values(self) -> Array:
        """The gains, shape (g,)."""
        return self.gains.values

    def with_gains(self, values: Array) -> Self:
        """Return the same loop with all gains given, shape (g,)."""
        return replace(self, gains=self.gains.with_values(dict(zip(self.gains.names, values, strict=True))))

    @cached_property
    def chain(self) -> Block:
        """Everything of L but the terms: sensor, filters, servo, plant."""
        return in_series("chain", (*self.sensor, *self.filters, *self.servo, self.plant))

    @cached_property
    def _common(self) -> Block:
        """Everything of the controller but the terms."""
        return in_series("common", (*self.sensor, *self.filters, *self.servo))

    @cached_property
    def polynomials(self) -> tuple[Array, Array]:
        """d(s), shape (n + 1,), and n_i(s), shape (g, n + 1), highest power first: L = sum gain_i n_i / d.

        The closed loop has the characteristic polynomial d + sum gain_i n_i. Nothing cancels.
        """
        dens = list(dict.fromkeys(term.block.den for term in self.terms))
        common = reduce(np.polymul, dens, np.array(self.chain.den))
        numerators = np.zeros((len(self.terms), len(common)))
        for row, term in zip(numerators, self.terms, strict=True):
            others = [den for den in dens if den != term.block.den]
            made = np.atleast_1d(reduce(np.polymul, [term.block.num, *others], np.array(self.chain.num)))
            row[len(row) - len(made) :] = made
        return frozen(common), frozen(numerators)

    def controller_terms(self, omega: Array) -> Complex:
        """Return what each gain multiplies between y and a, shape (g, n), at omega (n,) [rad/s]."""
        common = self._common.frequency_response(omega)
        return np.stack([term.block.frequency_response(omega) * common for term in self.terms])

    def open_loop_terms(self, omega: Array) -> Complex:
        """Return L_i, shape (g, n): L = sum gain_i L_i."""
        return self.controller_terms(omega) * self.plant.frequency_response(omega)

    def open_loop(self, omega: Array) -> Complex:
        """Return L at its gains, shape (n,)."""
        return self.gain_values @ self.open_loop_terms(omega)

    @property
    def closed_loop_poles(self) -> Complex:
        """Roots of the characteristic polynomial at the loop's gains, rad/s."""
        d, n = self.polynomials
        return np.asarray(np.roots(d + self.gain_values @ n), dtype=np.complex128)
