"""A feedback loop that is rational in s and linear in its gains."""

from dataclasses import dataclass, replace
from functools import cached_property, reduce
from typing import Self

import numpy as np

from seatrial.core.values import Array, InputError, Parameters, frozen
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops.block import Block, in_series
from seatrial.physics.loops.sampling import Sampling, held


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
        sampling: how the controller samples and holds, and the actuator's dead time; None: a controller in continuous
            time, without either. Of a sampled loop polynomials are those in w (see `physics.loops.sampling`), with S
            and L at the samples; frequencies and closed-loop poles are true ones.

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
    sampling: Sampling | None = None

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

    @property
    def continuous(self) -> Self:
        """Return the loop in continuous time: hold and dead time of a sampled one are a lag of its servo."""
        if self.sampling is None:
            return self
        return replace(self, servo=(*self.servo, self.sampling.lag), sampling=None)

    @cached_property
    def chain(self) -> Block:
        """Everything of L but the terms: sensor, filters, servo, plant; in w where the loop is sampled."""
        if self.sampling is not None:
            return in_series("chain", (*self.filters, self._held))
        return in_series("chain", (*self.sensor, *self.filters, *self.servo, self.plant))

    @cached_property
    def _held(self) -> Block:
        """From order to sample in w, of a sampled loop."""
        assert self.sampling is not None
        return held((*self.servo, self.plant, *self.sensor), self.sampling)

    @cached_property
    def _filtered(self) -> Block:
        """What acts on all terms in the controller."""
        return in_series("filters", self.filters)

    @cached_property
    def _around(self) -> Block:
        """What of sensor and servo is not part of the sampled controller."""
        return in_series("common", (*self.sensor, *self.servo))

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
        return self._term_responses(omega) * self._around_response(omega)

    def open_loop_terms(self, omega: Array) -> Complex:
        """Return L_i, shape (g, n): L = sum gain_i L_i."""
        if self.sampling is None:
            return self.controller_terms(omega) * self.plant.frequency_response(omega)
        return self._term_responses(omega) * self._held.frequency_response(self.sampling.in_w(omega))

    def plant_response(self, omega: Array) -> Complex:
        """Return P at omega (n,) [rad/s] so that L = P K: of a sampled loop what of the plant its samples show."""
        if self.sampling is None:
            return self.plant.frequency_response(omega)
        seen = self._held.frequency_response(self.sampling.in_w(omega))
        return np.asarray(seen / self._around_response(omega), dtype=np.complex128)

    def misreading_paths(self, omega: Array) -> tuple[Complex, Complex]:
        """Return output and actuator for an error in each sample of a sampled loop, over -L S, each (n,).

        It stands before the sensor until the next sample. Without a sensor they are 1 and 1 / P.
        """
        if self.sampling is None:
            raise InputError(f"loop '{self.name}' takes no samples, of which errors were known; give it a sample time")
        w = self.sampling.in_w(omega)
        seen = self._held.frequency_response(w)
        misread = held(self.sensor, replace(self.sampling, dead_time=0.0)).frequency_response(w) / seen
        moved = in_series("servo", self.servo).frequency_response(omega) * self.sampling.hold(omega)
        moving = held((*self.servo, self.plant), self.sampling).frequency_response(w)
        return moving * misread, moved * misread

    def _term_responses(self, omega: Array) -> Complex:
        """Return terms and filters, (g, n)."""
        at = omega if self.sampling is None else self.sampling.in_w(omega)
        common = self._filtered.frequency_response(at)
        return np.stack([term.block.frequency_response(at) * common for term in self.terms])

    def _around_response(self, omega: Array) -> Complex:
        """Return sensor, servo, hold and dead time, (n,)."""
        made = self._around.frequency_response(omega)
        return made if self.sampling is None else np.asarray(made * self.sampling.hold(omega), dtype=np.complex128)

    def open_loop(self, omega: Array) -> Complex:
        """Return L at its gains, shape (n,)."""
        return self.gain_values @ self.open_loop_terms(omega)

    @property
    def closed_loop_poles(self) -> Complex:
        """Roots of the characteristic polynomial at the loop's gains, rad/s."""
        d, n = self.polynomials
        found = np.asarray(np.roots(d + self.gain_values @ n), dtype=np.complex128)
        return found if self.sampling is None else self.sampling.from_w(found)
