"""One exact change of parameters, with its law for finite steps: scalings about zero or another centre, and shifts.

Scalings are the usual form of what cannot be identified (Castro & de Boer 2020, PLoS Comput. Biol. 16, e1008248).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import gcd, lcm

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array

EXACT = 1e-7
"""Relative error of a law below which it counts as exact: rounding gives 1e-10."""

_LARGEST_DENOMINATOR = 12  # of a rational exponent in a law; chosen


@dataclass(frozen=True)
class Generator:
    """One exact change: d theta_i / d s = power_i theta_i + shift_i leaves every compared output as it is.

    Attributes:
        power: by parameter, small integers; with a shift of 0 the parameter is multiplied by e^(power s).
        shift: by parameter, SI.
        is_finite: whether that holds for finite steps; if not, `shift` is the direction at the model's values.
        hidden_states: those that nobody measures and that have to change as well.
        centred_terms: parameter -> how it is written where it scales about another centre than 0, ``m + m_x``.
    """

    power: dict[str, int]
    shift: dict[str, float]
    is_finite: bool
    hidden_states: tuple[str, ...]
    centred_terms: dict[str, str]

    @property
    def parameters(self) -> tuple[str, ...]:
        """Those that change, in the order of the model."""
        return tuple(self.power)

    def centre(self, name: str) -> float:
        """The value about which a parameter scales."""
        return -self.shift[name] / self.power[name] if self.shift[name] else 0.0

    def transformed_model(self, model: Model, step: float) -> Model:
        """The model after a finite step s, with the same outputs if the hidden states start where they now belong."""
        values = {}
        for name in self.parameters:
            value, power = model.parameters[name].value, self.power[name]
            centre = self.centre(name) if power else 0.0
            growth = np.exp(power * step)
            values[name] = centre + (value - centre) * growth if power else value + self.shift[name] * step
        return model.with_values(values)

    def relative_change(self, model: Model) -> dict[str, float]:
        """Parameter -> relative change for a unit step; absolute where the value is zero and is not multiplied."""
        made = {}
        for name in self.parameters:
            value, power, shift = model.parameters[name].value, self.power[name], self.shift[name]
            made[name] = float(power + shift / value) if value else float(shift or power)
        return made

    @property
    def description_length(self) -> int:
        """How long it takes to say: factors that differ, shifts, members, centres."""
        factors = {p for p in self.power.values() if p}
        shifts = sum(1 for p in self.power.values() if not p)
        centres = sum(1 for n, p in self.power.items() if p and self.shift[n])
        return 10 * (len(factors) + shifts) + len(self.power) + 3 * centres


def centred_term(centre: float, name: str, value: float) -> str:
    if centre < 0.0:
        return f"{-centre:.4g} + {name}"
    return f"{centre:.4g} - {name}" if value < centre else f"{name} - {centre:.4g}"


def affine_law(theta: Array, delta: Array) -> tuple[list[int], list[float]] | None:
    """delta_i = power_i theta_i + shift_i at all points, with integer powers after multiplication by one number."""
    powers, shifts = [], []
    for x, y in zip(theta.T, delta.T, strict=True):
        about, scale = x - np.mean(x), np.abs(y).max()
        slope = float(about @ y / (about @ about)) if about.any() else 0.0
        power = Fraction(slope).limit_denominator(_LARGEST_DENOMINATOR)
        level = float(np.mean(y - float(power) * x))
        if np.abs(y - float(power) * x - level).max() > EXACT * scale:
            return None
        powers.append(power)
        shifts.append(0.0 if abs(level) < EXACT * scale else level)
    return _integer_powers(powers, shifts)


def _integer_powers(powers: Sequence[Fraction], shifts: Sequence[float]) -> tuple[list[int], list[float]]:
    """Integer powers without a common divisor, the majority positive."""
    many = lcm(*(p.denominator for p in powers))
    numbers = [int(p * many) for p in powers]
    factor = many / (gcd(*numbers) or 1) * (-1.0 if sum(np.sign(numbers)) < 0 else 1.0)
    return [round(float(p) * factor) for p in powers], [s * factor if s else 0.0 for s in shifts]


def combine_generators(one: Generator, other: Generator, sign: int, order: Sequence[str]) -> Generator:
    """Both at once."""
    power = {n: one.power.get(n, 0) + sign * other.power.get(n, 0) for n in order}
    parts = {n: (one.shift.get(n, 0.0), sign * other.shift.get(n, 0.0)) for n in order}
    shift = {n: 0.0 if abs(a + b) < EXACT * max(abs(a), abs(b)) else a + b for n, (a, b) in parts.items()}
    kept = [n for n in order if power[n] or shift[n]]
    names = {n: w for n, w in (other.centred_terms | one.centred_terms).items() if n in kept and power[n] and shift[n]}
    return Generator({n: power[n] for n in kept}, {n: shift[n] for n in kept}, True, (), names)
