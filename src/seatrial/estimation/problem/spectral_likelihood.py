"""Likelihood of motions whose waves nobody measured, from the spectrum of the sea (Whittle 1953; Brillinger 1981).

At each frequency the Fourier transform of the motions is complex normal: its mean is the answer to the inputs that are
known (a fin), its covariance that of the waves, H S_F H*, and of the sensors. Minus twice the logarithm of the
likelihood is, up to a constant, 2 sum [log det S + (d - m)* S^-1 (d - m)]; its curvature is the Fisher information.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array
from seatrial.estimation.problem.free_parameters import FreeParameterProblem
from seatrial.numerics.kernels.linear import affine_matrices
from seatrial.numerics.optimise import NormalEquations
from seatrial.physics.simulate.linear import Complex

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
