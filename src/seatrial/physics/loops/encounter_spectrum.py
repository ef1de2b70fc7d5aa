"""What a sea does to a ship without control: energy of the output over the frequencies at which waves are met.

Integrals run over the wave frequency with responses taken at |omega_e(omega)|: the Jacobian d omega / d omega_e, which
is singular in following seas, never appears. Waves beyond twelve times the peak's frequency are left out; where no hull
averages them, their slopes would add up without end.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.physics.hydro.excitation import Complex, encounter_frequency
from seatrial.physics.loops import quadrature
from seatrial.physics.loops.block import Block
from seatrial.physics.loops.wave_effect import WaveEffect, WaveSlope
from seatrial.physics.sea.encounter import speed_factor
from seatrial.physics.sea.spectrum import Spectrum

_DIRECTIONS = 513  # directions of a short-crested sea on the finest grid; chosen
_MIN_NODES, _REDUCED_NODES, _MAX_NODES = 48, 512, 12288  # frequencies: first grid, reduced grid, finest grid; chosen
_ACCURACY, _ACCURACY_OF_REDUCED = 1e-10, 1e-9  # relative, of variances on all nodes and on the reduced ones; chosen
# relative, of variances over directions and in one of them; chosen
_ACCURACY_OF_DIRECTIONS, _ACCURACY_OF_ONE = 1e-6, 1e-8
_NEGLIGIBLE_EXPONENT = 36.0  # exp(-36) is 2e-16, rounding
_DAMPING_DIVISOR = 2.0  # of the sharpened response: feedback may leave half of the damping; chosen
_HELD_POLE = 0.01  # rad/s: an integrator that feedback holds is taken to be no faster; chosen
_LOWEST_FREQUENCY = 1e-9  # rad/s: a wave that keeps up with the ship
_NO_EFFECT = 1e-12  # share of the sea's variance that counts as none: rounding
_REACH = 12.0  # highest wave frequency over the modal one, as said above
WAVE_SLOPE = WaveSlope()
_KEPT_RESPONSES = 16  # blocks whose sharpened form is kept: every direction of a sea takes it; chosen
_FIRST_STRIDE = 8  # directions left out between those of the first grid; chosen


@dataclass(frozen=True, eq=False)
class PointSpectrum:
    """What a sea does at a point while the actuator rests, q, beside the disturbance w of the loop; both (n,).

    energy: shares of the variance of q; cross: shares of E[q conj(w)], complex amplitudes at |omega_e|.
    """

    energy: Array
    cross: Complex


@dataclass(frozen=True, eq=False)
class EncounterSpectrum:
    """A disturbance that a loop meets, node by node of a quadrature.

    Attributes:
        omega_e: |frequency of encounter| [rad/s]; energy: share of the disturbance's variance at each node [unit^2],
            both (n,); single ones may be negative where many nodes were gathered on few.
        description: the sea in words.
        points: what the same sea does at the loop's points, in their order.
    """

    omega_e: Array
    energy: Array
    description: str = ""
    points: tuple[PointSpectrum, ...] = ()

    @property
    def variance(self) -> float:
        """Of the disturbance."""
        return float(np.sum(self.energy))

    def response_variance(self, block: Block) -> float:
        """Return the variance of what the block makes of the disturbance."""
        return float(np.sum(np.abs(block.frequency_response(self.omega_e)) ** 2 * self.energy))

    def mean_frequency(self, block: Block) -> float:
        """Return the mean of omega_e [rad/s] over the energy of what the block makes of the disturbance."""
        energy = np.abs(block.frequency_response(self.omega_e)) ** 2 * self.energy
        return float(np.sum(self.omega_e * energy) / np.sum(energy))


def sea_disturbance(
    spectrum: Spectrum,
    U: float,
    beta: float,
    response: Block,
    effect: WaveEffect = WAVE_SLOPE,
    *,
    spreading: float | None = None,
    at_points: tuple[WaveEffect, ...] = (),
) -> EncounterSpectrum:
    """Return what the waves of a sea do to a loop, |effect|^2 S(omega): by default their slope across the ship [rad].

    Args:
        U: m/s; beta: rad, 0 following, pi / 2 beam, pi head.
        response: from the disturbance to the motion; nodes suffice for variances of its angle and rate with half of its
            damping. A loop much nearer to instability, or slower, is resolved by its own closed-loop response D S.
        spreading: exponent s of a short-crested sea, cos^2s over +- 90 deg; None: long-crested.
        at_points: what the waves do at the loop's points.

    Raises:
        InputError: speed, heading or spreading out of sense, or a sea without any effect on the loop.
    """
    effects = (effect, *at_points)
    said = f"{spectrum.name}, {math.degrees(beta):.0f} deg"
    if spreading is None:
        nodes = _long_crested_nodes(spectrum, U, beta, response, effects, _ACCURACY)
        made = _from_rows(*_reduced_nodes(*nodes, response, _ACCURACY_OF_REDUCED), said)
    else:
        nodes = _ShortCrestedNodes(spectrum, U, beta, response, effects, spreading).converged_nodes()
        made = _from_rows(*_reduced_nodes(*nodes, response, _ACCURACY_OF_DIRECTIONS), f"{said}, short-crested")
    if not made.variance > _NO_EFFECT * spectrum.moment(0):
        raise InputError(
            f"the sea has no {effect.name} at a heading of {math.degrees(beta):.0f} deg; "
            "take another heading, or a short-crested sea"
        )
    return made


def disturbance_spectrum(
    density: Callable[[Array], Array], lower: float, upper: float, response: Block, description: str
) -> EncounterSpectrum:
    """Return exposure to a disturbance of one-sided `density` [unit^2 s/rad] over the frequency of encounter itself."""
    nodes = _converged_nodes(lambda w: density(w)[None], lambda w: w, (lower, upper), response, _ACCURACY)
    return _from_rows(*nodes, description)


def _from_rows(omega_e: Array, rows: Array, description: str) -> EncounterSpectrum:
    """Return the spectrum of rows (1 + 3 p, n): the disturbance's energy; of each point energy, cross in two parts."""
    points = tuple(PointSpectrum(rows[i], rows[i + 1] + 1j * rows[i + 2]) for i in range(1, len(rows), 3))
    return EncounterSpectrum(omega_e, rows[0], description, points)


class _ShortCrestedNodes:
    """A short-crested sea: trapezoids over its directions, doubled until variances of angle and rate stand still."""

    def __init__(
        self, spectrum: Spectrum, U: float, beta: float, response: Block, effects: tuple[WaveEffect, ...],
        exponent: float,
    ) -> None:  # fmt: skip
        if not exponent > 0.0:
            raise InputError(f"the spreading exponent s of a short-crested sea must be positive, not {exponent:g}")
        speed_factor(U, beta)
        self._nodes_by_direction: dict[int, tuple[Array, Array]] = {}
        self._one_direction = lambda away: _long_crested_nodes(
            spectrum, U, math.acos(math.cos(beta + away)), response, effects, _ACCURACY_OF_ONE
        )
        self._response, self._exponent = response, exponent
        # cos^2s is below 1e-13 beyond
        self._half_spread = math.acos(10.0 ** (-6.5 / exponent))

    def converged_nodes(self) -> tuple[Array, Array]:
        """Return |frequencies of encounter| and energies."""
        before, stride = np.full(2, np.inf), _FIRST_STRIDE
        while True:
            omega_e, rows = self._nodes_at_stride(stride)
            now = _variances(omega_e, rows[0], self._response)
            if np.all(np.abs(now - before) <= _ACCURACY_OF_DIRECTIONS * now) or stride == 1:
                return omega_e, rows
            before, stride = now, stride // 2

    def _nodes_at_stride(self, stride: int) -> tuple[Array, Array]:
        """Return frequencies and energies of every `stride`-th of the finest directions."""
        places = range(0, _DIRECTIONS, stride)
        away = np.linspace(-self._half_spread, self._half_spread, _DIRECTIONS)[::stride]
        shares = quadrature.weights(len(places)) * np.cos(away) ** (2.0 * self._exponent)
        shares /= shares.sum()
        for place, angle in zip(places, away, strict=True):
            if place not in self._nodes_by_direction:
                self._nodes_by_direction[place] = self._one_direction(float(angle))
        parts = [self._nodes_by_direction[place] for place in places]
        rows = [share * rows for share, (_, rows) in zip(shares, parts, strict=True)]
        return np.concatenate([omega_e for omega_e, _ in parts]), np.concatenate(rows, axis=1)


def _long_crested_nodes(
    spectrum: Spectrum, U: float, beta: float, response: Block, effects: tuple[WaveEffect, ...], accuracy: float
) -> tuple[Array, Array]:
    speed_factor(U, beta)

    def density(omega: Array) -> Array:
        w, *elsewhere = (effect.amplitude(omega, U, beta) for effect in effects)
        rows = [np.abs(w) ** 2]
        overtaken = encounter_frequency(omega, U, beta) < 0.0
        for q in elsewhere:
            cross = q * w.conj()
            rows += [np.abs(q) ** 2, cross.real, np.where(overtaken, -cross.imag, cross.imag)]
        return np.stack(rows) * spectrum.density(omega)

    def encounter(omega: Array) -> Array:
        return np.abs(encounter_frequency(omega, U, beta))

    lowest, highest = effects[0].frequency_range
    lower = max((spectrum.B / _NEGLIGIBLE_EXPONENT) ** 0.25, lowest)
    upper = min(_REACH * spectrum.modal_frequency, highest)
    peak = spectrum.modal_frequency
    # a raised peak is sharp and has a kink
    inner = () if spectrum.gamma == 1.0 else (0.65 * peak, peak, 1.45 * peak)
    return _converged_nodes(
        density, encounter, (lower, *inner, max(upper, min(2.0 * peak, highest))), response, accuracy
    )


def _converged_nodes(
    density: Callable[[Array], Array],
    encounter: Callable[[Array], Array],
    edges: tuple[float, ...],
    response: Block,
    accuracy: float,
) -> tuple[Array, Array]:
    """Trapezoids over log(omega), refined until the sharpened response's variances of angle and rate stand still."""
    sharp, before, count = _with_less_damping(response), np.full(2, np.inf), _MIN_NODES
    while True:
        omega, width = quadrature.nodes(edges, count)
        omega_e, rows = np.maximum(encounter(omega), _LOWEST_FREQUENCY), density(omega) * width
        now = _variances(omega_e, rows[0], sharp)
        if np.all(np.abs(now - before) <= accuracy * now) or count > _MAX_NODES:
            return omega_e, rows
        before, count = now, 3 * count // 2


def _reduced_nodes(omega_e: Array, rows: Array, response: Block, accuracy: float) -> tuple[Array, Array]:
    """Return fewer nodes, as long as the sharpened response does not notice."""
    sharp, count = _with_less_damping(response), _REDUCED_NODES
    true = _variances(omega_e, rows[0], sharp)
    while count < len(omega_e):
        omega, made = quadrature.gather_nodes(omega_e, rows, count)
        if np.all(np.abs(_variances(omega, made[0], sharp) - true) <= accuracy * true):
            return omega, made
        count *= 2
    return omega_e, rows


@lru_cache(maxsize=_KEPT_RESPONSES)
def _with_less_damping(response: Block) -> Block:
    """Return the block with half of its damping, as feedback may leave it; what runs away or integrates as if held."""
    poles = response.poles
    slowest = np.min(np.abs(poles[poles != 0.0]), initial=_HELD_POLE)
    damped = np.where(poles == 0.0, -slowest, -np.abs(poles.real) / _DAMPING_DIVISOR)
    return replace(response, den=tuple(response.den[0] * np.atleast_1d(np.poly(damped + 1j * poles.imag).real)))


def _variances(omega_e: Array, energy: Array, response: Block) -> Array:
    """Return the variances of the response's angle and rate."""
    size = np.abs(response.frequency_response(omega_e)) ** 2 * energy
    return np.array([size.sum(), (omega_e**2 * size).sum()])
