"""What a sea does to a ship without control: energy of the output over the frequencies at which waves are met.

Integrals run over the wave frequency with responses taken at |omega_e(omega)|: the Jacobian d omega / d omega_e, which
is singular in following seas, never appears. Without a hull that averages them, waves beyond twelve times the peak's
frequency are left out; their slopes would add up without end.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.special import bernoulli

from seatrial.hydro.dispersion import G
from seatrial.hydro.excitation import encounter_frequency
from seatrial.loops.block import Block
from seatrial.sea.encounter import speed_factor
from seatrial.sea.spectrum import Spectrum
from seatrial.values import Array, InputError

_DIRECTIONS = 16
_FEWEST, _MOST = 48, 12288
_ACCURACY = 1e-10
_FAINT = 36.0
# rad/s: a wave that keeps up with the ship
_SLOWEST = 1e-9
# a spectrum may be cut where it is not faint: there trapezoids are of order 8 (Gregory)
_ENDS = 1.0 + np.linalg.solve(np.vander(np.arange(8.0), increasing=True).T, bernoulli(8)[1:] / np.arange(1.0, 9.0))


@dataclass(frozen=True)
class HullFactor:
    """How a hull averages the slope of waves shorter than itself; by a box of length L, breadth B, draught T [m].

    F = exp(-k T / 2) sinc(k B sin(beta) / 2) sinc(k L cos(beta) / 2), sinc(x) = sin(x) / x: the mean over half the
    draught, the breadth and the length, Froude-Krylov, of a box (Lloyd 1989, Seakeeping, effective wave slope).
    """

    L: float
    B: float
    T: float

    def at(self, omega: Array, beta: float) -> Array:
        """F [-] at wave frequencies omega [rad/s] and heading beta [rad, 0 following]."""
        k = omega**2 / G
        across, along = k * self.B * math.sin(beta) / (2.0 * math.pi), k * self.L * math.cos(beta) / (2.0 * math.pi)
        return np.exp(-k * self.T / 2.0) * np.sinc(across) * np.sinc(along)


@dataclass(frozen=True, eq=False)
class Exposure:
    """A disturbance that a loop meets, node by node of a quadrature.

    Attributes:
        omega_e: |frequency of encounter| [rad/s]; energy: share of the disturbance's variance at each node [unit^2],
            both (n,).
        said: the sea in words.
    """

    omega_e: Array
    energy: Array
    said: str = ""

    @property
    def variance(self) -> float:
        """Of the disturbance."""
        return float(np.sum(self.energy))

    def variance_of(self, block: Block) -> float:
        """Of what the block makes of the disturbance."""
        return float(np.sum(np.abs(block.at(self.omega_e)) ** 2 * self.energy))


def exposure(
    spectrum: Spectrum,
    U: float,
    beta: float,
    response: Block,
    hull: HullFactor | None = None,
    *,
    spreading: float | None = None,
) -> Exposure:
    """Effective wave slope [rad] that a ship meets; its spectrum is (omega^2 / g)^2 sin^2(beta) F^2 S(omega).

    Args:
        U: m/s; beta: rad, 0 following, pi / 2 beam, pi head.
        response: from the slope to the motion; nodes are doubled until its variances of angle and rate stand still. A
            loop much nearer to instability than it, or slower, is resolved by its own `TransferLoop.controlled`.
        spreading: exponent s of a short-crested sea, cos^2s over +- 90 deg; None: long-crested.

    Raises:
        InputError: speed, heading or spreading out of sense, or a sea without any slope across the ship.
    """
    if spreading is None:
        directions, shares = np.array([beta]), np.ones(1)
        said = f"{spectrum.name}, {math.degrees(beta):.0f} deg"
    else:
        directions, shares = _spread(beta, spreading)
        said = f"{spectrum.name}, {math.degrees(beta):.0f} deg, short-crested"
    parts = [
        _of_one(spectrum, U, angle, response, hull, share) for angle, share in zip(directions, shares, strict=True)
    ]
    made = Exposure(np.concatenate([w for w, _ in parts]), np.concatenate([e for _, e in parts]), said)
    if not made.variance > 1e-12 * spectrum.moment(0):
        raise InputError(
            f"the sea has no wave slope across the ship at a heading of {math.degrees(beta):.0f} deg; "
            "take another heading, or a short-crested sea"
        )
    return made


def over_nodes(density: Callable[[Array], Array], lower: float, upper: float, response: Block, said: str) -> Exposure:
    """Exposure to a disturbance of one-sided `density` [unit^2 s/rad] over the frequency of encounter itself."""
    return Exposure(*_settled(density, lambda w: w, (lower, upper), response), said)


def _spread(beta: float, exponent: float) -> tuple[Array, Array]:
    """Headings folded into 0 to pi and their shares: Gauss-Legendre over cos^2s."""
    if not exponent > 0.0:
        raise InputError(f"the spreading exponent s of a short-crested sea must be positive, not {exponent:g}")
    nodes, weights = np.polynomial.legendre.leggauss(_DIRECTIONS)
    shares = weights * np.cos(0.5 * math.pi * nodes) ** (2.0 * exponent)
    return np.arccos(np.cos(beta + 0.5 * math.pi * nodes)), shares / shares.sum()


def _of_one(
    spectrum: Spectrum, U: float, beta: float, response: Block, hull: HullFactor | None, share: float
) -> tuple[Array, Array]:
    speed_factor(U, beta)
    across = math.sin(beta) ** 2 if abs(math.sin(beta)) > 1e-9 else 0.0

    def density(omega: Array) -> Array:
        factor = 1.0 if hull is None else hull.at(omega, beta) ** 2
        return share * across * (omega**2 / G) ** 2 * factor * spectrum.density(omega)

    def met(omega: Array) -> Array:
        return np.abs(encounter_frequency(omega, U, beta))

    lower = (spectrum.B / _FAINT) ** 0.25
    upper = 12.0 * spectrum.modal_frequency
    if hull is not None:
        upper = min(upper, math.sqrt(0.5 * _FAINT * G / hull.T))
    peak = spectrum.modal_frequency
    # a raised peak is sharp and has a kink
    inner = () if spectrum.gamma == 1.0 else (0.65 * peak, peak, 1.45 * peak)
    return _settled(density, met, (lower, *inner, max(upper, 2.0 * peak)), response)


def _settled(
    density: Callable[[Array], Array], met: Callable[[Array], Array], edges: tuple[float, ...], response: Block
) -> tuple[Array, Array]:
    """Trapezoids over log(omega), doubled until the response's variances of angle and rate stand still."""
    before, count = np.full(2, np.inf), _FEWEST
    while True:
        omega, width = _nodes(edges, count)
        omega_e, energy = np.maximum(met(omega), _SLOWEST), density(omega) * width
        size = np.abs(response.at(omega_e)) ** 2 * energy
        now = np.array([size.sum(), (omega_e**2 * size).sum()])
        if np.all(np.abs(now - before) <= _ACCURACY * now) or count > _MOST:
            return omega_e, energy
        before, count = now, 2 * count


def _nodes(edges: tuple[float, ...], count: int) -> tuple[Array, Array]:
    """`count` nodes, between all edges as many, even in log(omega), and what each stands for, both rad/s."""
    omega: list[Array] = []
    width: list[Array] = []
    own = count // (len(edges) - 1)
    for low, high in pairwise(np.log(edges)):
        u, step = np.linspace(low, high, own, retstep=True)
        weights = np.ones(own)
        weights[: len(_ENDS)] *= _ENDS
        weights[: -len(_ENDS) - 1 : -1] *= _ENDS
        omega.append(np.exp(u))
        width.append(omega[-1] * weights * step)
    return np.concatenate(omega), np.concatenate(width)
