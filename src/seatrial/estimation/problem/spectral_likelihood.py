"""Likelihood of motions whose waves nobody measured (Whittle 1953; Brillinger 1975): of one sea, or of none known."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array
from seatrial.numerics.kernels.linear import affine_matrices
from seatrial.numerics.optimise import NormalEquations
from seatrial.physics.simulate.linear import Complex

# What problems have in common whose unknowns are a model's free parameters and nothing else.


@dataclass(frozen=True, eq=False)
class FreeParameterProblem:
    """Names, bounds and start of the unknowns, and all parameter values at a point."""

    model: Model

    @property
    def free(self) -> tuple[str, ...]:
        """Names of the unknowns."""
        return self.model.parameters.free_names

    @property
    def lower(self) -> Array:
        """Lower bounds."""
        return np.array([p.lower for p in self.model.parameters.free])

    @property
    def upper(self) -> Array:
        """Upper bounds."""
        return np.array([p.upper for p in self.model.parameters.free])

    def start(self) -> Array:
        """Return the model's own values."""
        return np.array([p.value for p in self.model.parameters.free])

    @cached_property
    def _free_indices(self) -> list[int]:
        return [self.model.parameters.index(n) for n in self.free]

    def _parameter_values(self, shared: Array) -> Array:
        """Return all of the model's parameters with the unknowns at `shared`."""
        values = self.model.parameters.values
        values[self._free_indices] = shared
        return values


# Likelihood of motions whose waves nobody measured, from the spectrum of the sea (Whittle 1953; Brillinger 1981).

# a Hann window spreads each frequency over its neighbours: that many times fewer of them are independent
WINDOW_CORRELATION = 35.0 / 18.0
# points a bin at which the model is evaluated before the window's leakage smears it, over that many bins either way
POINTS_PER_BIN = 4
_LEAKAGE_BINS = 8  # bins either way, as above


@dataclass(frozen=True, eq=False)
class DifferentiatedResponse:
    """H = (i omega - A)^-1 B of some states, (n, ny, nu), and dH, (q, n, ny, nu), signed omega, exp(+i omega t)."""

    H: Complex
    dH: Complex


def frequency_response(
    model: Model, values: Array, omega: Array, outputs: tuple[str, ...], free: tuple[str, ...]
) -> DifferentiatedResponse:
    """Return the response of states `outputs` at all parameter values (np,), differentiated by those named `free`.

    dH = R dA H + R dB with the resolvent R = (i omega - A)^-1.
    """
    nx, nu = len(model.states), len(model.inputs)
    wanted = np.array([model.parameters.index(n) for n in free], dtype=np.int64)
    rates, slopes = affine_matrices(model.compiled.rates_tangent, nx, nx, nu, wanted, values)
    resolvent = np.linalg.inv(1j * omega[:, None, None] * np.eye(nx) - rates[:, :nx])
    H = resolvent @ rates[:, nx:-1]
    driven = slopes[:, None, :, :nx] @ H[None] + slopes[:, None, :, nx:-1]
    rows = [model.states.index(o) for o in outputs]
    return DifferentiatedResponse(H[:, rows], (resolvent[None] @ driven)[:, :, rows])


@dataclass(frozen=True, eq=False)
class SpectralLikelihood(FreeParameterProblem):
    """Unknowns: the free parameters of an affine model. It is a `LeastSquares` problem without local unknowns.

    Attributes:
        omega: (k,), rad/s, of encounter, positive, evenly spaced.
        motion_transforms: of the outputs, (k, ny), scaled to one-sided densities; input_transforms: of inputs that
            were recorded, (k, nu), in the model's signs.
        fine_omega, input_densities: POINTS_PER_BIN and beyond either end, (m,), and densities there of the inputs
            that were not recorded, one-sided, (m, nu, nu), in the model's signs.
        noise: standard deviation of each output, (ny,), SI; dt: s.
    """

    omega: Array
    outputs: tuple[str, ...]
    motion_transforms: Complex
    input_transforms: Complex
    fine_omega: Array
    input_densities: Complex
    noise: Array
    dt: float

    @cached_property
    def _hold_transfer(self) -> Complex:
        """Transfer of holding a sample for dt, (k,)."""
        turned = 1j * self.omega * self.dt
        return (1.0 - np.exp(-turned)) / turned

    def _held_inputs(self) -> Complex:
        held = np.array([i.is_held for i in self.model.inputs])
        return np.where(held, self.input_transforms * self._hold_transfer[:, None], self.input_transforms)

    def cost(self, shared: Array, local: Array) -> float:
        """Return the minus the logarithm of the likelihood, up to a constant."""
        return self.normal(shared, local).cost

    def normal(self, shared: Array, local: Array) -> NormalEquations:
        """Return cost, gradient and Fisher information at a point."""
        values = self._parameter_values(shared)
        inputs = self._held_inputs()
        found = frequency_response(self.model, values, self.omega, self.outputs, self.free)
        spread = frequency_response(self.model, values, self.fine_omega, self.outputs, self.free)
        left, answered, S = self._residual_and_covariance(found, spread, inputs)
        inverse = np.linalg.inv(S)
        pulled = np.einsum("kxy,ky->kx", inverse, left)
        sign, size = np.linalg.slogdet(S)
        if not np.all(np.isfinite(size)) or np.any(np.abs(sign) < 0.5):
            return NormalEquations(
                np.inf, np.zeros(len(shared)), np.eye(len(shared)), local, *_no_local_unknowns(local, len(shared))
            )
        cost = float(np.sum(size) + np.einsum("ky,ky->", left.conj(), pulled).real)
        half = apply_leakage(spread.dH @ answered[None])
        dS = half + half.conj().swapaxes(2, 3)
        dm = np.einsum("qkyu,ku->qky", found.dH, inputs)
        scaled = inverse[None] @ dS
        gradient = np.einsum("qkyy->q", scaled).real
        gradient -= np.einsum("ky,qkyx,kx->q", pulled.conj(), dS, pulled).real
        gradient -= 2.0 * np.einsum("qky,ky->q", dm.conj(), pulled).real
        fisher = np.einsum("qkxy,pkyx->qp", scaled, scaled).real
        fisher += 2.0 * np.einsum("qkx,kxy,pky->qp", dm.conj(), inverse, dm).real
        scale = 1.0 / WINDOW_CORRELATION
        return NormalEquations(
            scale * cost, scale * gradient, scale * fisher, local, *_no_local_unknowns(local, len(shared))
        )

    def misfit(self, shared: Array) -> Array:
        """(d - m)* S^-1 (d - m) over the number of outputs at each frequency, (k,): 1 in the mean if all is right."""
        values = self._parameter_values(shared)
        found, spread = (
            frequency_response(self.model, values, w, self.outputs, ()) for w in (self.omega, self.fine_omega)
        )
        left, _, S = self._residual_and_covariance(found, spread, self._held_inputs())
        return np.einsum("kx,kxy,ky->k", left.conj(), np.linalg.inv(S), left).real / len(self.outputs)

    def _residual_and_covariance(
        self, bin_response: DifferentiatedResponse, fine_response: DifferentiatedResponse, held_inputs: Complex
    ) -> tuple[Complex, Complex, Complex]:
        """Return motions less their mean, S_F H* on the fine grid, and the covariance S."""
        left = self.motion_transforms - np.einsum("kyu,ku->ky", bin_response.H, held_inputs)
        answered = self.input_densities @ fine_response.H.conj().swapaxes(1, 2)
        return (
            left,
            answered,
            apply_leakage((fine_response.H @ answered)[None])[0] + np.diag(self.noise**2) * self.dt / np.pi,
        )


def _no_local_unknowns(local: Array, size: int) -> tuple[Array, Array]:
    return np.zeros((*local.shape, 0)), np.zeros((0, size, local.shape[-1]))


def fine_grid(omega: Array) -> Array:
    """Return the frequencies at which the model of the waves is needed for those of the transform."""
    step = omega[1] - omega[0]
    count = (len(omega) - 1 + 2 * _LEAKAGE_BINS) * POINTS_PER_BIN + 1
    return omega[0] - _LEAKAGE_BINS * step + np.arange(count) * step / POINTS_PER_BIN


def apply_leakage(density: Complex) -> Complex:
    """Return densities on the fine grid, (q, m, ny, ny), as the window shows them at the bins, (q, k, ny, ny)."""
    offset = np.arange(-_LEAKAGE_BINS * POINTS_PER_BIN, _LEAKAGE_BINS * POINTS_PER_BIN + 1) / POINTS_PER_BIN
    share = hann_leakage(offset)
    share /= np.sum(share)
    seen = np.lib.stride_tricks.sliding_window_view(density, len(share), axis=1)[:, ::POINTS_PER_BIN]
    return np.einsum("qkxys,s->qkxy", seen, share)


def hann_leakage(offset: Array) -> Array:
    """Return how much power a Hann window shows so many bins away, of any shape, over that in its own bin."""
    is_neighbour = np.abs(offset) == 1.0
    share = np.sinc(offset) / (1.0 - np.where(is_neighbour, 2.0, offset) ** 2)
    return np.where(is_neighbour, 0.5, share) ** 2


def hann_transform(values: Array, dt: float) -> tuple[Array, Complex]:
    """Return frequencies [rad/s] without zero and Nyquist, and transforms of the columns (n, m) under a Hann window.

    Scaled so that the mean of |d|^2 is the one-sided spectral density.
    """
    window = np.hanning(len(values))
    scale = np.sqrt(dt / (np.pi * np.sum(window**2)))
    found = scale * np.fft.rfft((values - np.mean(values, axis=0)) * window[:, None], axis=0)
    omega = np.asarray(2.0 * np.pi * np.fft.rfftfreq(len(values), dt), dtype=np.float64)
    return omega[2:-1], found[2:-1]


# Likelihood of roll in waves of which nothing is known but that they are one sea (Whittle 1953; Brillinger 1981).

DAMPING, RESTORING = 5, 6  # places among the unknowns
_SIGMA = (0.07, 0.09)  # peak widths of JONSWAP, Hasselmann et al. 1973
_STEP = 1e-5  # of the logarithmic unknowns, for central differences
_NO_LOCAL = np.zeros((0, 0))


@dataclass(frozen=True, eq=False)
class UnknownWaves:
    """Unknowns: logarithms of level, w_p [rad/s], gamma, 1 + D/g [s^2], noise; then of b_1 [1/s], c_1 [1/s^2].

    Attributes:
        omega: (k,), rad/s, evenly spaced; power: |Fourier transform|^2 of roll at them, scaled to a one-sided density.
        reference_frequency: rad/s at which the level counts.
    """

    omega: Array
    power: Array
    reference_frequency: float

    @property
    def lower(self) -> Array:
        """Lower bounds."""
        c = self.reference_frequency
        # wide bounds of logarithms, in the order of the unknowns; chosen
        return np.array([-90.0, np.log(0.3 * c), 0.0, 0.0, -90.0, np.log(2e-3 * c), np.log(0.16 * c**2)])

    @property
    def upper(self) -> Array:
        """Upper bounds."""
        c = self.reference_frequency
        # wide bounds of logarithms, in the order of the unknowns; chosen
        return np.array([90.0, np.log(4.0 * c), np.log(10.0), np.log(20.0), 0.0, np.log(2.0 * c), np.log(6.0 * c**2)])

    @cached_property
    def _fine_omega(self) -> Array:
        return np.maximum(fine_grid(self.omega), 1e-2 * self.reference_frequency)  # rad/s over the peak, lowest; chosen

    def moment_density(self, point: Array, omega: Array) -> Array:
        """Return the density W of the waves' moment per inertia at omega, (n,)."""
        level, w_p, gamma, short = point[0], np.exp(point[1]), point[2], np.exp(point[3]) - 1.0
        sigma = np.where(omega < w_p, *_SIGMA)
        peak = np.exp(-0.5 * ((omega / w_p - 1.0) / sigma) ** 2)
        shape = -np.log(omega / self.reference_frequency) - 1.25 * (  # exponent of Pierson and Moskowitz 1964
            (w_p / omega) ** 4 - (w_p / self.reference_frequency) ** 4
        )
        return np.exp(level + shape + gamma * peak - short * (omega**2 - self.reference_frequency**2))

    def roll_density(self, point: Array, omega: Array) -> Array:
        """Return the density of roll without the sensor's noise, (n,)."""
        b, c = np.exp(point[[DAMPING, RESTORING]])
        return self.moment_density(point, omega) / ((c - omega**2) ** 2 + (b * omega) ** 2)

    def windowed_density(self, point: Array) -> Array:
        """Return the density as the window shows it at `omega`, (k,)."""
        seen = apply_leakage(_as_matrix(self.roll_density(point, self._fine_omega)[None]))[0, :, 0, 0]
        return np.asarray(seen.real, dtype=np.float64) + np.exp(point[4])

    def cost(self, shared: Array, local: Array) -> float:  # noqa: ARG002
        """Return the minus the logarithm of the likelihood, up to a constant."""
        density = self.windowed_density(shared)
        return float(np.sum(np.log(density) + self.power / density)) / WINDOW_CORRELATION

    def normal(self, shared: Array, local: Array) -> NormalEquations:
        """Return cost, gradient and Fisher information at a point."""
        density = self.windowed_density(shared)
        steps = _STEP * np.eye(len(shared))
        slopes = np.array([(self.windowed_density(shared + s) - self.windowed_density(shared - s)) for s in steps]) / (
            2.0 * _STEP
        )
        relative = slopes / density
        gradient = relative @ (1.0 - self.power / density) / WINDOW_CORRELATION
        hessian = relative @ relative.T / WINDOW_CORRELATION
        size = len(shared)
        return NormalEquations(
            self.cost(shared, local), gradient, hessian, _NO_LOCAL, np.zeros((0, 0, 0)), np.zeros((0, size, 0))
        )

    def start_points(self) -> list[Array]:
        """Return points to begin from: roll at, below and above the peak, waves longer and shorter than it."""
        near = np.abs(self.omega / self.reference_frequency - 1.0) < 0.1  # band about the peak; chosen
        # last bins, mostly noise; a positive level; chosen
        level, noise = np.log(np.mean(self.power[near])), np.log(max(np.median(self.power[-20:]), 1e-12))
        made = []
        for ratio in (0.8, 1.0, 1.25):  # natural frequencies over that of the peak; chosen
            c = (ratio * self.reference_frequency) ** 2
            b = 0.15 * np.sqrt(c)  # damping to begin from, 2 zeta; chosen
            moment = level + np.log((c - self.reference_frequency**2) ** 2 + (b * self.reference_frequency) ** 2)
            # peak shape and short waves to begin from; chosen
            made += [
                np.array([moment, np.log(w * self.reference_frequency), 0.3, 0.2, noise, np.log(b), np.log(c)])
                for w in (0.75, 1.15)
            ]  # wave peaks over that of the motion; chosen
        return [np.clip(point, self.lower, self.upper) for point in made]

    def band_limited(self, low: float, high: float) -> "UnknownWaves":
        """Return the same in a band of frequencies."""
        kept = (self.omega >= low) & (self.omega <= high)
        return replace(self, omega=self.omega[kept], power=self.power[kept])


@dataclass(frozen=True, eq=False)
class HeldUnknown:
    """The same with one unknown held at a value: the others are its unknowns."""

    problem: UnknownWaves
    place: int
    value: float

    @property
    def lower(self) -> Array:
        """Lower bounds."""
        return np.delete(self.problem.lower, self.place)

    @property
    def upper(self) -> Array:
        """Upper bounds."""
        return np.delete(self.problem.upper, self.place)

    def cost(self, shared: Array, local: Array) -> float:
        """Return the minus the logarithm of the likelihood, up to a constant."""
        return self.problem.cost(np.insert(shared, self.place, self.value), local)

    def normal(self, shared: Array, local: Array) -> NormalEquations:
        """Return cost, gradient and Fisher information at a point."""
        unheld = self.problem.normal(np.insert(shared, self.place, self.value), local)
        kept = np.delete(np.arange(len(shared) + 1), self.place)
        return replace(
            unheld,
            gradient=unheld.gradient[kept],
            hessian=unheld.hessian[np.ix_(kept, kept)],
            cross=unheld.cross[:, kept],
        )


def _as_matrix(density: Array) -> Complex:
    return np.asarray(density[:, :, None, None], dtype=np.complex128)
