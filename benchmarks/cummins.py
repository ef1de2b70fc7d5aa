"""Heave and pitch with memory (Cummins 1962): a truth with frequency-dependent coefficients, in the time domain.

At rest (M + A_inf) x'' + int_0^t K(t - s) x'(s) ds + C x = F. Ogilvie 1964 ties it to the frequency domain:
K(t) = 2 / pi int_0^inf B(w) cos(w t) dw, A(w) = A_inf - 1 / w int_0^inf K(t) sin(w t) dt,
B(w) = int_0^inf K(t) cos(w t) dt. At the speed U the terms of strip theory are the same heave force of the water fed by
z' + U theta, and a moment of -U times its time integral; the kernel of that integral is
J(t) = int_0^t K33 = 2 / pi int_0^inf B33(w) / w sin(w t) dw. Axes as in `Excitation`: z up, pitch bow down.
"""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

from seatrial.core.values import Array, InputError
from seatrial.physics.hydro.capytaine_data import HullData
from seatrial.physics.hydro.excitation import MAX_SHIP_SPEED

_UNRESOLVED_SHARE = 0.6
_NEGLIGIBLE_SHARE = 1e-3
_STEPS_PER_PERIOD = 60


@dataclass(frozen=True)
class RetardationFunctions:
    """What the water remembers, at rest.

    Attributes:
        dt: s.
        K: retardation functions (n, 2, 2) at 0, dt, ...; J: (n,) the time integral of K33.
        A_inf: added mass at infinite frequency (2, 2).
    """

    dt: float
    K: Array
    J: Array
    A_inf: Array

    def coefficients(self, omega: Array) -> tuple[Array, Array]:
        """Added mass and damping (k, 2, 2) that this memory means at rest (Ogilvie 1964), by the trapezoidal rule."""
        t = self.dt * np.arange(len(self.K))
        weight = np.full(t.size, self.dt)
        weight[[0, -1]] *= 0.5
        turned = np.exp(-1j * np.outer(omega, t)) * weight
        Z = np.einsum("kt,tij->kij", turned, self.K)
        return self.A_inf + Z.imag / omega[:, None, None], Z.real


def retardation_functions(data: HullData, dt: float, duration: float) -> RetardationFunctions:
    """Retardation functions of `duration` seconds from the damping, A_inf from added mass and kernel (Ogilvie 1964).

    Below the data the damping goes to zero as omega cubed, as for any floating body in deep water; above it falls by
    the power law of its last fifth, no slower than omega^-2 and no faster than omega^-7.

    Raises:
        InputError: a step or length out of sense, or damping that is still over 60 % of its largest at the end.
    """
    if not (dt > 0.0 and duration > 10 * dt and np.isfinite(duration)):
        raise InputError("the memory needs a positive time step [s] and a length of more than ten of them")
    known, damping = _extrapolated_damping(data)
    omega = np.linspace(0.0, known[-1], 1 + int(np.ceil(known[-1] * 8 * duration / np.pi)))
    B = PchipInterpolator(known, damping)(omega)
    t = dt * np.arange(round(duration / dt) + 1)
    step = np.full(omega.size, omega[1])
    step[[0, -1]] *= 0.5
    cosine = np.cos(np.outer(t, omega)) * (2 / np.pi * step)
    K = np.einsum("tw,wij->tij", cosine, B)
    J = (np.sinc(np.outer(t, omega) / np.pi) * t[:, None] * (2 / np.pi * step)) @ B[:, 0, 0]
    without = RetardationFunctions(dt, K, J, np.zeros((2, 2)))
    A_inf = np.mean(data.added_mass - without.coefficients(data.omega)[0], axis=0)
    return RetardationFunctions(dt, K, J, A_inf)


def simulate_cummins(
    retardation: RetardationFunctions, mass: Array, stiffness: Array, U: float, forces: Array
) -> Array:
    """States [z, z', theta, theta'] (n, 4) from rest under forces (n, 2) given at 0, dt, ..., of the memory's step.

    Newmark's average acceleration with the convolution by the trapezoidal rule, both of second order in dt.

    Args:
        mass: of the ship alone, (2, 2) [kg, kg m, kg m^2]; stiffness: (2, 2).
        U: m/s.

    Raises:
        InputError: a shape or number out of sense, or a step that leaves fewer than 60 to the fastest natural period.
    """
    _check_inputs(mass, stiffness, U, forces)
    dt, kernel, inertia, damping, restoring = retardation.dt, *_at_speed(retardation, mass, stiffness, U)
    fastest = float(np.sqrt(np.max(np.abs(np.linalg.eigvals(np.linalg.solve(inertia, restoring))))))
    if fastest * dt > 2 * np.pi / _STEPS_PER_PERIOD:
        raise InputError(
            f"a step of {dt:g} s is too long for a natural frequency of {fastest:.3g} rad/s; take at most "
            f"{2 * np.pi / _STEPS_PER_PERIOD / fastest:.2g} s"
        )
    n, depth = len(forces), len(kernel)
    feel = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])
    carried = np.array([[0.0, 0.0], [0.0, 0.0], [0.0, U]])
    now = 0.5 * dt * kernel[0]
    left = inertia + 0.5 * dt * (damping + now @ feel) + 0.25 * dt**2 * (restoring + now @ carried)
    solve = np.linalg.inv(left)
    x, v, w = np.zeros((n, 2)), np.zeros((n, 2)), np.zeros((n, 3))
    a = np.linalg.solve(inertia, forces[0])
    reverse = np.ascontiguousarray(kernel[::-1].transpose(0, 2, 1)).reshape(-1, 2)
    for i in range(1, n):
        m = min(i, depth - 1)
        past = dt * (w[i - m : i].ravel() @ reverse[3 * (depth - 1 - m) : 3 * (depth - 1)])
        half, full = v[i - 1] + 0.5 * dt * a, x[i - 1] + dt * v[i - 1] + 0.25 * dt**2 * a
        known = forces[i] - past - damping @ half - restoring @ full - now @ (feel @ half + carried @ full)
        a = solve @ known
        v[i], x[i] = half + 0.5 * dt * a, full + 0.25 * dt**2 * a
        w[i] = feel @ v[i] + carried @ x[i]
    return np.column_stack([x[:, 0], v[:, 0], x[:, 1], v[:, 1]])


def _at_speed(
    retardation: RetardationFunctions, mass: Array, stiffness: Array, U: float
) -> tuple[Array, Array, Array, Array]:
    """Kernel (n, 2, 3) on (z', theta', U theta), inertia, damping, stiffness."""
    K, J, a33 = retardation.K, retardation.J, retardation.A_inf[0, 0]
    upper = np.stack([K[:, 0, 0], K[:, 0, 1], K[:, 0, 0]], axis=-1)
    lower = np.stack([K[:, 1, 0] - U * J, K[:, 1, 1], -U * J], axis=-1)
    damping = np.array([[0.0, U * a33], [-U * a33, 0.0]])
    restoring = stiffness - np.array([[0.0, 0.0], [0.0, U**2 * a33]])
    return np.stack([upper, lower], axis=1), mass + retardation.A_inf, damping, restoring


def _extrapolated_damping(data: HullData) -> tuple[Array, Array]:
    """Damping on a grid from zero to where it has died out."""
    omega, B = data.omega, data.damping
    largest = np.abs(B).max(axis=0)
    for j, what in ((0, "heave"), (1, "pitch")):
        if abs(B[-1, j, j]) > _UNRESOLVED_SHARE * largest[j, j]:
            raise InputError(
                f"the hull data stop at {omega[-1]:g} rad/s, where the damping of {what} is still "
                f"{abs(B[-1, j, j]) / largest[j, j]:.0%} of its largest; compute higher frequencies for the memory"
            )
    below = np.linspace(0.0, omega[0], 6)[:-1]
    last = slice(-max(3, omega.size // 5), None)
    power = [-np.polyfit(np.log(omega[last]), np.log(np.maximum(B[last, j, j], 1e-300)), 1)[0] for j in (0, 1)]
    p = float(np.clip(min(power), 2.0, 7.0))
    above = np.linspace(1.0, _NEGLIGIBLE_SHARE ** (-1 / p), 200)[1:]
    ends = (B[:1] * (below / omega[0])[:, None, None] ** 3, B[-1:] * above[:, None, None] ** -p)
    return np.concatenate([below, omega, omega[-1] * above]), np.concatenate([ends[0], B, ends[1]])


def _check_inputs(mass: Array, stiffness: Array, U: float, forces: Array) -> None:
    if np.shape(mass) != (2, 2) or np.shape(stiffness) != (2, 2):
        raise InputError("mass and stiffness of heave and pitch must have the shape (2, 2)")
    if np.ndim(forces) != 2 or np.shape(forces)[1] != 2 or not np.all(np.isfinite(forces)):
        raise InputError("forces must be finite, with two columns, heave force [N] and pitch moment [N m]")
    if not (np.isfinite(U) and 0.0 <= U <= MAX_SHIP_SPEED):
        raise InputError(f"the ship speed must lie between 0 and {MAX_SHIP_SPEED:g} m/s, not {U:g}; is it in knots?")
