"""The sampled loop about the trim: its frequency response, its margins, and whether it is stable."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import expm

from seatrial.core.values import Array
from seatrial.exporting.ardupilot.gains import CascadeGains, filter_share
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops import Block, controllable_form

_FREQUENCIES = 4000  # at which margins are read off, evenly in the logarithm; chosen
_LOWEST = 1e-3  # of the plant's slowest pole, and as near to the Nyquist frequency; chosen
AT_ORIGIN = 1e-9  # of the largest pole, below which one counts as an integrator: rounding


@dataclass(frozen=True, eq=False)
class SampledPlant:
    """x[k+1] = A x[k] + b a[k] behind a hold, a the share of full steering or throttle; rows of angle and rate.

    Attributes:
        A, b: (n, n), (n,); dt: s.
        angle, rate: rows (n,) of what the outer gain and the AC_PID see: heading and yaw rate, or nothing and speed.
        slowest: rad/s, of its poles off the origin.
    """

    A: Array
    b: Array
    angle: Array
    rate: Array
    dt: float
    slowest: float

    @cached_property
    def frequencies(self) -> Array:
        """Frequencies at which margins are read off, up to the Nyquist frequency [rad/s]."""
        fastest = math.pi / self.dt
        return np.geomspace(_LOWEST * min(self.slowest, fastest), fastest * (1.0 - _LOWEST), _FREQUENCIES)

    @cached_property
    def responses(self) -> tuple[Complex, Complex]:
        """Responses of angle and rate at `frequencies`."""
        return self.responses_at(self.frequencies)

    def responses_at(self, omega: Array) -> tuple[Complex, Complex]:
        """Return the responses of angle and rate to the actuator at omega [rad/s], (m,)."""
        z = np.exp(1j * omega * self.dt)
        b = np.tile(self.b[:, None], (len(z), 1, 1))
        motion = np.linalg.solve(z[:, None, None] * np.eye(len(self.b)) - self.A, b)[..., 0]
        angle, rate = (np.asarray(motion @ row, dtype=np.complex128) for row in (self.angle, self.rate))
        return angle, rate


@dataclass(frozen=True)
class SampledMargins:
    """Of a sampled loop broken at the actuator: Ms, gain as a factor, phase [rad], delay [s]; infinite for any."""

    Ms: float
    gain: float
    phase: float
    delay: float


def sampled_heading(plant: Block, dt: float) -> SampledPlant:
    """Return a plant from steering to heading, with its yaw rate, behind a hold of dt [s]."""
    rate = Block("yaw rate", (*plant.num, 0.0), plant.den)
    return _sampled(plant, controllable_form(plant)[2], controllable_form(rate)[2], dt)


def sampled_speed(plant: Block, dt: float) -> SampledPlant:
    """Return a plant from throttle to speed behind a hold of dt [s]."""
    c = controllable_form(plant)[2]
    return _sampled(plant, np.zeros(len(c)), c, dt)


def _sampled(plant: Block, angle: Array, rate: Array, dt: float) -> SampledPlant:
    A, b, _, _ = controllable_form(plant)
    n, sizes = len(b), np.abs(plant.poles)
    block = np.zeros((n + 1, n + 1))
    block[:n, :n], block[:n, n] = A, b
    stepped: Array = np.asarray(expm(dt * block), dtype=np.float64)
    slowest = float(sizes[sizes > AT_ORIGIN * sizes.max()].min())
    return SampledPlant(stepped[:n, :n], stepped[:n, n], angle, rate, dt, slowest)


def open_loop(plant: SampledPlant, gains: CascadeGains, omega: Array | None = None) -> Complex:
    """Return L at omega [rad/s], (m,), below the Nyquist frequency; the actuator acts a sample late.

    omega: by default the plant's `frequencies`.
    """
    at_default = omega is None
    z = np.exp(1j * (plant.frequencies if at_default else omega) * plant.dt)
    angle, rate = plant.responses if at_default else plant.responses_at(omega)
    pid, dt = gains.rate, plant.dt
    targeted, filtered, smoothed = (
        share / (1.0 - (1.0 - share) / z)
        for share in (filter_share(f, dt) for f in (pid.target_filter, pid.error_filter, pid.derivative_filter))
    )
    backward = 1.0 - 1.0 / z
    terms = pid.P + pid.I * dt / backward + pid.D * smoothed * backward / dt
    wanted = gains.angle_P * targeted * angle
    return np.asarray((terms * filtered * (wanted + rate) + pid.FF * wanted) / z, dtype=np.complex128)


def closed_loop_matrix(plant: SampledPlant, gains: CascadeGains) -> Array:
    """Return the matrix of a sample of the closed loop, (n + 5, n + 5), without the limits of `controller`.

    Its states are those of the plant, the order, and target, error, derivative and integral of the AC_PID.
    """
    n, pid, dt = len(plant.b), gains.rate, plant.dt
    unit = np.eye(n + len(("order", "target", "error", "derivative", "integral")))
    x, order, target, error, derivative, integral = unit[:n], *unit[n:]
    aT, aE, aD = (filter_share(f, dt) for f in (pid.target_filter, pid.error_filter, pid.derivative_filter))
    new_target = target + aT * (-gains.angle_P * plant.angle @ x - target)
    new_error = error + aE * (new_target - plant.rate @ x - error)
    new_derivative = derivative + aD * ((new_error - error) / dt - derivative)
    new_integral = integral + pid.I * dt * new_error
    new_order = pid.P * new_error + new_integral + pid.D * new_derivative + pid.FF * new_target
    moved = plant.A @ x + np.outer(plant.b, order)
    rows = np.vstack([moved, new_order, new_target, new_error, new_derivative, new_integral])
    return np.asarray(rows, dtype=np.float64)


def is_stable(plant: SampledPlant, gains: CascadeGains) -> bool:
    """Return whether every pole lies inside the unit circle; an integral that nothing feeds does not count."""
    rows = closed_loop_matrix(plant, gains)
    rows = rows if gains.rate.I else rows[:-1, :-1]
    return bool(np.abs(np.linalg.eigvals(rows)).max() < 1.0)


def sampled_margins(plant: SampledPlant, gains: CascadeGains) -> SampledMargins:
    """Return the margins at the gains; Ms infinite, the others NaN, where the loop is unstable."""
    if not is_stable(plant, gains):
        return SampledMargins(math.inf, math.nan, math.nan, math.nan)
    omega, L = plant.frequencies, open_loop(plant, gains)
    axis, circle = _crossings(L.imag), _crossings(np.abs(L) - 1.0)
    factors = -1.0 / _between(L.real, axis)
    phase = np.mod(np.interp(circle, np.arange(len(L)), np.unwrap(np.angle(L))) + math.pi, 2.0 * math.pi)
    return SampledMargins(
        float(np.max(1.0 / np.abs(1.0 + L))),
        float(np.min(factors[factors > 1.0], initial=math.inf)),
        float(np.min(np.minimum(phase, 2.0 * math.pi - phase), initial=math.inf)),
        float(np.min(phase / _between(omega, circle), initial=math.inf)),
    )


def _crossings(values: Array) -> Array:
    """Return places between samples at which values change their sign, linearly."""
    before = np.flatnonzero(np.diff(np.sign(values)))
    return before + values[before] / (values[before] - values[before + 1])


def _between(values: Array, places: Array) -> Array:
    return np.interp(places, np.arange(len(values)), values)
