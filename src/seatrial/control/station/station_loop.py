"""The linear loop of station keeping about a steady current: gains by pole placement, sensitivity, margins.

About the heading kept, with x = (eta, nu) of the model's Jacobian, thrusters' lags H and the dead time T,

    eta = S (P d + P_w w),   S = (I + P A C)^-1,   A = B H B+ e^(-s T)

P from forces d, P_w from the water's velocity w (Fossen 2021, section 15.3, linearised; Skogestad & Postlethwaite 2005,
section 3.2, sensitivity of several loops). A current turns with the craft's heading: P has its moment, C what the force
that the integral has gathered does when the craft turns.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from seatrial.control.ship import jacobian_at
from seatrial.control.station.craft import StationCraft
from seatrial.core.values import Array
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.simulate.craft_control import StationGains

DAMPING = 1.0  # relative damping of the pole pair of each degree of freedom: no overshoot; chosen
INTEGRAL_SHARE = (
    0.1  # real pole of the integral over the natural frequency (Fossen 2021, Algorithm 15.2: K_i = w/10 K_p)
)
FILTER_SHARE = 0.1  # time constant of the velocity's filter times the natural frequency: 6 deg of phase there; chosen
# secants to where an eigenvalue has size one, and share of a gap that each stays inside; chosen
_REFINEMENTS, _INSIDE = 6, 1e-3
_HOLDING_ROUNDS = 6  # after which thrusters, whose thrust falls with the water's speed, hold the current; chosen
_TURN = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])  # dR'/dpsi at psi = 0


def place_poles(inertia: Array, damping: Array, omega: Array) -> StationGains:
    """Return the gains that give each degree of freedom (s^2 + 2 zeta w s + w^2)(s + rho w), thrusters without lags.

    K_p = M (1 + 2 zeta rho) w^2, K_i = M rho w^3, K_d = M (2 zeta + rho) w - D: Algorithm 15.2 of Fossen (2021) with
    the pole of the integral placed, too. Where the hull damps more than that, K_d has no less than zero.

    inertia, damping: M, D (3, 3); omega: w of surge, sway and yaw [rad/s], (3,).
    """
    W = np.diag(omega)
    KD = inertia @ W * (2.0 * DAMPING + INTEGRAL_SHARE) - damping
    enough = np.diag(KD) < 0.0
    KD[enough] = 0.0
    return StationGains(
        inertia @ W**2 * (1.0 + 2.0 * DAMPING * INTEGRAL_SHARE), inertia @ W**3 * INTEGRAL_SHARE, KD,
        FILTER_SHARE / omega,
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class StationPoint:
    """A craft kept in a steady current: A of x' = A x, x = (eta, nu), (6, 6), and the force that holds it, (3,).

    grids: frequencies [rad/s] that many loops are judged on, whose responses are kept.
    """

    craft: StationCraft
    A: Array
    holding: Array
    grids: tuple[Array, ...] = ()

    @cached_property
    def force_input(self) -> Array:
        """What a force does to the rates of x, (6, 3)."""
        return np.asarray(np.concatenate([np.zeros((3, 3)), np.linalg.inv(self.craft.inertia)]), dtype=np.float64)

    def responses(self, omega: Array) -> tuple[Complex, Complex]:
        """Return P and P_w, (n, 3, 3) each, at omega [rad/s]."""
        tabulated = next((both for grid, both in zip(self.grids, self._on_grids, strict=True) if grid is omega), None)
        return self._evaluated(omega) if tabulated is None else tabulated

    @cached_property
    def _on_grids(self) -> tuple[tuple[Complex, Complex], ...]:
        return tuple(map(self._evaluated, self.grids))

    def _evaluated(self, omega: Array) -> tuple[Complex, Complex]:
        inverse = np.linalg.inv(1j * omega[:, None, None] * np.eye(len(self.A)) - self.A)[:, :3]
        return _complex(inverse @ self.force_input), _complex(inverse[:, :, :3])


def station_point(craft: StationCraft, speed: float, direction: float, inverse: Array) -> StationPoint:
    """Return a craft held in a current [m/s] from a direction off the bow [rad]; at rest in still water at 0.

    inverse: (m, 3), by which the force that holds it is shared out.
    """
    flow, names = craft.in_current(speed, direction), craft.model.states
    rows, rates = [names.index(name) for name in ("x0", "y0", "psi", "u", "v", "r")], np.empty(len(names))
    holding, (state, inputs) = np.zeros(3), craft.ordered(flow, np.zeros(len(craft.owner)))
    for _ in range(_HOLDING_ROUNDS):
        craft.model.compiled.rates(0.0, state, inputs, craft.model.parameters.values, rates)
        holding = holding - craft.inertia @ rates[rows[3:]]
        state, inputs = craft.ordered(flow, inverse @ holding)
    slopes = jacobian_at(craft.model, state[None], inputs, of_outputs=False)
    return StationPoint(craft, slopes[0][np.ix_(rows, rows)].copy(), holding)


@dataclass(frozen=True, eq=False)
class StationLoop:
    """Gains on a craft in a current, shared out by an inverse (m, 3) that may be another craft's; dead_time: T [s].

    slope: thrust that the craft gives for each unit ordered, of each component (m,); frequencies [rad/s] of margins.
    """

    point: StationPoint
    gains: StationGains
    inverse: Array
    dead_time: float
    slope: Array
    frequencies: Array

    @property
    def craft(self) -> StationCraft:
        """The craft."""
        return self.point.craft

    @cached_property
    def turning(self) -> Array:
        """Column of the heading that the gathered integral adds to K_p: -K_i dR'/dpsi K_i^-1 tau, (3, 3)."""
        g, column = self.gains, np.zeros((3, 3))
        column[:, 2] = -g.KI @ _TURN @ np.linalg.solve(g.KI, self.point.holding)
        return column

    def controller(self, omega: Array) -> Complex:
        """Return C, (n, 3, 3): K_p + K_i / s + K_d s / (T_f s + 1), with what turning does."""
        s, g = 1j * omega[:, None, None], self.gains
        return g.KP + self.turning + g.KI / s + g.KD * (s / (g.lag[None, None, :] * s + 1.0))

    def thrusts(self, omega: Array) -> Complex:
        """Return what the thrusters' components are ordered for each unit of the error, -B+ C, (n, m, 3)."""
        return -self.inverse @ self.controller(omega)

    def open_loop(self, omega: Array, dead_time: float | None = None) -> Complex:
        """Return P A C, (n, 3, 3), with the loop's dead time or another [s]."""
        late = np.exp(-1j * omega * (self.dead_time if dead_time is None else dead_time))
        lag = self.slope * late[:, None] / (1.0 + 1j * omega[:, None] * self.craft.lags)
        A = (self.craft.configuration[None] * lag[:, None, :]) @ self.inverse
        return self.point.responses(omega)[0] @ A @ self.controller(omega)

    def sensitivity(self, omega: Array) -> Complex:
        """Return S, (n, 3, 3)."""
        return _complex(np.linalg.inv(np.eye(3) + self.open_loop(omega)))

    @cached_property
    def _loop_on_grid(self) -> Complex:
        """P A C without dead time on the frequencies of margins."""
        return self.open_loop(self.frequencies, 0.0)

    @cached_property
    def closed_loop_poles(self) -> Complex:
        """Poles without dead time, of pose, velocities, thrusters, filters and integrals."""
        return _complex(np.linalg.eigvals(self.state_matrix))

    @property
    def state_matrix(self) -> Array:
        """A of x' = A x, x = (eta, nu, thrusts of the components with a lag, filtered error, integral)."""
        craft, g = self.craft, self.gains
        lagging, at_once = np.flatnonzero(craft.lags > 0.0), np.flatnonzero(craft.lags == 0.0)
        m = len(lagging)
        # states: pose and velocities (6), thrusts (m), filtered error (3), integral (3)
        n = 12 + m
        # their places
        eta, T, z, q = (slice(a, b) for a, b in ((0, 3), (6, 6 + m), (6 + m, 9 + m), (9 + m, n)))
        fast, push = np.diag(1.0 / g.lag), self.point.force_input @ craft.configuration
        # orders of the components: -B+ (K_p e + K_i q + K_d (e - z) / T_f), z the filtered error
        order = np.zeros((len(craft.lags), n))
        order[:, eta], order[:, q] = -self.inverse @ (g.KP + self.turning + g.KD @ fast), -self.inverse @ g.KI
        order[:, z] = self.inverse @ g.KD @ fast
        order *= self.slope[:, None]
        A = np.zeros((n, n))
        A[:6, :6], A[:6, T] = self.point.A, push[:, lagging]
        A[:6] += push[:, at_once] @ order[at_once]
        A[T] = order[lagging] / craft.lags[lagging, None]
        A[T, T] -= np.diag(1.0 / craft.lags[lagging])
        A[z, eta], A[z, z], A[q, eta] = fast, -fast, np.eye(3)
        return A

    @cached_property
    def tolerated_dead_time(self) -> float:
        """Dead time [s] of all thrusters at once until the loop is unstable; zero where it is without any.

        An eigenvalue of P A C has size one there and the phase pi (generalised Nyquist criterion, Skogestad &
        Postlethwaite 2005, theorem 4.9). Between frequencies by secants of the logarithms.
        """
        if self.closed_loop_poles.real.max() >= 0.0:
            return 0.0
        omega, values = self.frequencies, _sorted_eigenvalues(self._loop_on_grid)
        sizes = np.log(np.abs(values))
        before, branch = np.nonzero(np.diff(np.sign(sizes), axis=0))
        if not len(before):
            return math.inf
        low, high = omega[before], omega[before + 1]
        size_low, size_high = sizes[before, branch], sizes[before + 1, branch]
        crossing, value = low, values[before, branch]
        for _ in range(_REFINEMENTS):
            crossing = low * (high / low) ** np.clip(size_low / (size_low - size_high), _INSIDE, 1.0 - _INSIDE)
            value = _sorted_eigenvalues(self.open_loop(crossing, 0.0))[np.arange(len(crossing)), branch]
            size = np.log(np.abs(value))
            is_before = size * size_low > 0.0
            low, size_low = np.where(is_before, crossing, low), np.where(is_before, size, size_low)
            high, size_high = np.where(is_before, high, crossing), np.where(is_before, size_high, size)
        lags = (math.pi + np.angle(value)) % (2.0 * math.pi)
        return float((lags / crossing).min())

    @property
    def is_stable(self) -> bool:
        """Whether the loop is stable with its dead time."""
        return self.tolerated_dead_time > self.dead_time

    def peaks(self) -> Array:
        """Return the largest |S_ii| of surge, sway and yaw, each loop broken with the others closed, and that of all.

        The last is the largest singular value of S, yaw times half the length; infinite where unstable. (4,)
        """
        if not self.is_stable:
            return np.full(4, np.inf)
        late = np.exp(-1j * self.frequencies * self.dead_time)[:, None, None]
        S = np.linalg.inv(np.eye(3) + self._loop_on_grid * late)
        arm = np.array([1.0, 1.0, self.craft.lever])
        joint = np.linalg.norm(S * arm[:, None] / arm, ord=2, axis=(1, 2)).max()
        return np.array([*np.abs(np.diagonal(S, axis1=1, axis2=2)).max(axis=0), joint])


def _sorted_eigenvalues(matrices: Complex) -> Complex:
    """Return the eigenvalues of matrices (n, 3, 3), the smallest first, (n, 3)."""
    eigenvalues = np.linalg.eigvals(matrices)
    return _complex(np.take_along_axis(eigenvalues, np.argsort(np.abs(eigenvalues), axis=1), axis=1))


def _complex(values: object) -> Complex:
    return np.asarray(values, dtype=np.complex128)
