"""A transfer function of real coefficients: one block of a diagram."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.physics.hydro.excitation import Complex

_LEAST_SIZE = 1e-3  # rad/s, least scale of the states; chosen


@dataclass(frozen=True)
class Block:
    """num(s) / den(s), coefficients of s [rad/s] with the highest power first.

    Raises:
        InputError: a coefficient is not finite, the denominator is zero, or the numerator is of higher degree.
    """

    name: str
    num: tuple[float, ...] = (1.0,)
    den: tuple[float, ...] = (1.0,)
    source: str = ""

    def __post_init__(self) -> None:
        for side in ("num", "den"):
            given = tuple(float(c) for c in getattr(self, side))
            if not given or not all(math.isfinite(c) for c in given):
                raise InputError(f"block '{self.name}': '{side}' needs finite coefficients, highest power first")
            first = next((i for i, c in enumerate(given) if c != 0.0), len(given) - 1)
            object.__setattr__(self, side, given[first:])
        if self.den == (0.0,):
            raise InputError(
                f"block '{self.name}': the denominator is zero; give its coefficients, highest power first"
            )
        if len(self.num) > len(self.den):
            raise InputError(
                f"block '{self.name}': the numerator is of degree {len(self.num) - 1}, the denominator of "
                f"{len(self.den) - 1} only; add the lag that every real block has"
            )

    @property
    def order(self) -> int:
        """Number of its states."""
        return len(self.den) - 1

    @cached_property
    def poles(self) -> Complex:
        """Roots of the denominator, rad/s."""
        return np.asarray(np.roots(self.den), dtype=np.complex128)

    @property
    def gain(self) -> float:
        """At s = 0; infinite where it integrates."""
        return self.num[-1] / self.den[-1] if self.den[-1] else math.inf

    def frequency_response(self, omega: Array) -> Complex:
        """Return the frequency response at omega [rad/s], any shape."""
        s = 1j * np.asarray(omega, dtype=np.float64)
        return np.asarray(np.polyval(self.num, s) / np.polyval(self.den, s), dtype=np.complex128)

    def scaled(self, factor: float) -> "Block":
        """Return the block times a number."""
        return Block(self.name, tuple(factor * c for c in self.num), self.den, self.source)


def in_series(name: str, blocks: Iterable[Block]) -> Block:
    """Return the product of blocks; nothing cancels."""
    num, den = np.ones(1), np.ones(1)
    for block in blocks:
        num, den = np.polymul(num, block.num), np.polymul(den, block.den)
    return Block(name, tuple(num), tuple(den))


def controllable_form(block: Block) -> tuple[Array, Array, Array, float]:
    """Return A, b, c, d of a block: controllable form with each state scaled by the size of the poles."""
    den = np.array(block.den) / block.den[0]
    num = np.concatenate([np.zeros(len(den) - len(block.num)), np.array(block.num) / block.den[0]])
    n, d = block.order, float(num[0])
    size = max(float(np.abs(den[-1])) ** (1.0 / n), _LEAST_SIZE) if n and den[-1] else 1.0
    powers = size ** np.arange(n)
    A = np.diag(np.full(max(n - 1, 0), size), -1) if n else np.zeros((0, 0))
    b = np.zeros(n)
    if n:
        A[0] = -den[1:] / powers
        b[0] = 1.0
    return A, b, (num[1:] - d * den[1:]) / powers, d
