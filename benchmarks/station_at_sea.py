"""A place kept by a controller written from the [station] of gains.toml alone: are distance and margins the page's?

The simulator is this file's own: surge, sway and yaw with thrusters that lag, lose thrust with speed and have limits;
water that flows from every direction in turn and varies, gusts. Margins are its own, too: the plant's slopes by
differences at the thrust that holds the current, its pose sampled, the controller's difference equations in z.
"""

import math
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from measure import Line, at_most
from scipy.linalg import expm
from second_simulator import DEGREE, PEAK, QUICK, RMS, gauss_markov, print_lines, tuning_of

from seatrial.control.front import Effort
from seatrial.core.values import Array, Ship
from seatrial.data.folder.gains_file import gains_toml
from seatrial.data.folder.model_file import ModelFile
from seatrial.physics.models.thruster_layout import (
    AngleInput,
    CommandInput,
    Damping,
    ThrustCurve,
    Thruster,
    ThrusterLayout,
)
from seatrial.physics.models.thrusters import thrusters

SHORT = 0.07  # step of the simulator over the thrusters' lag, at most
SEEDS, COUNTED, RUN_IN = 3, 100.0, 8.0  # realisations for each direction; time constants of current, of the integral
ROUNDS = 30  # after which the thrusters hold the current
FREQUENCIES = 600  # at which the simulator's Ms is read off
DIFFERENCE, SECANT = 1e-5, 0.01  # for slopes: of pose and velocities, of the largest thrust


@dataclass(frozen=True)
class StationRig:
    """A craft with equal thrusters, SI: places and directions (fixed, or None: it turns), curves, lags, hull, weather.

    The lag is the same up and down, so that there is a linear plant; noise: of the compass, deg rms of each sample.
    """

    name: str
    length: float
    mass: tuple[float, float, float]
    places: tuple[tuple[float, float, float | None], ...]
    thrust: tuple[float, float]
    exponents: tuple[float, float]
    lag: float
    losses: tuple[float, float]
    damping: dict[str, float]
    dead_time: float
    current: float
    current_rms: float
    bandwidth: float
    gust: float
    gust_bandwidth: float
    turning_lag: float = 0.0
    noise: float = 0.0

    @property
    def model(self) -> ModelFile:
        """The craft as an identified model."""
        kind = ThrustCurve.QUADRATIC if self.exponents == (2.0, 2.0) else ThrustCurve.POWER
        layout = ThrusterLayout(
            tuple(
                Thruster(f"t_{k}", x, y, CommandInput(f"command_{k}"),
                         AngleInput(f"alpha_{k}", self.turning_lag) if angle is None else angle, curve=kind,
                         lag=self.lag, bollard=self.thrust[0] if k == 1 else 0.0, same_as="" if k == 1 else "t_1")
                for k, (x, y, angle) in enumerate(self.places, start=1)
            ), Damping.FULL, self.length, self.mass[0],
        )  # fmt: skip
        values = dict(zip(("M_u", "M_v", "M_r"), self.mass, strict=True)) | self.damping
        values |= {"tau": self.lag, "tau_down": self.lag, "k_f": self.thrust[0], "k_b": self.thrust[1]}
        values |= {"k_J": self.losses[0], "k_4": self.losses[1]}
        if kind is ThrustCurve.POWER:
            values |= dict(zip(("p_f", "p_b"), self.exponents, strict=True))
        if self.turning_lag:
            values["tau_a"] = self.turning_lag
        return ModelFile(thrusters(layout).with_values(values), ship=Ship(self.name, {"L": self.length}))

    def loop_file(self) -> str:
        """Return the loop file; what disturbs its heading loop is next to nothing."""
        return f"""
[plant]
model = "model.toml"
[controller]
kind = "pid"
parts = ["KP", "KD"]
[controller.gains.KP]
lower = 1e-3
[actuator]
limit = 0.5
dead_time = {self.dead_time}
[[slow_disturbances]]
rms = 1e-6
bandwidth = 0.2
[demand]
change = 0.3
[station]
current = {self.current}
current_rms = {self.current_rms}
bandwidth = {self.bandwidth}
gust = {self.gust}
gust_bandwidth = {self.gust_bandwidth}
{f'[sensors]{chr(10)}noise = {{ value = {self.noise}, unit = "deg" }}' if self.noise else ""}
"""


_CORNERS = tuple((x, y, turn) for x, y, turn in (
    (0.45, -0.35, math.pi / 4), (0.45, 0.35, -math.pi / 4), (-0.45, 0.35, math.pi / 4), (-0.45, -0.35, -math.pi / 4)
))  # fmt: skip
RIGS = (
    StationRig(
        "four thrusters at 45 deg", 1.2, (60.0, 90.0, 9.0), _CORNERS, (60.0, 45.0), (1.8, 1.6), 0.3, (0.8, 0.05),
        {"X_u": -8.0, "X_uu": -30.0, "Y_v": -20.0, "Y_vv": -90.0, "N_r": -5.0, "N_rr": -6.0, "N_ur": -6.0,
         "Y_uv": -30.0, "N_uv": 12.0},
        dead_time=0.1, current=0.25, current_rms=0.04, bandwidth=0.05, gust=5.0, gust_bandwidth=0.2, noise=0.5,
    ),
    StationRig(
        "supply vessel, two screws and two tunnels", 80.0, (4.6e6, 8.0e6, 2.6e9),
        ((-36.0, -6.0, 0.0), (-36.0, 6.0, 0.0), (30.0, 0.0, math.pi / 2), (-30.0, 0.0, math.pi / 2)), (4e5, 3e5),
        (2.0, 2.0), 4.0, (60.0, 0.005), {"X_u": -3e4, "X_uu": -1.2e4, "Y_v": -1e5, "Y_vv": -3.2e5, "N_r": -6e7,
         "N_rr": -1.5e10, "N_ur": -1.5e8, "N_uv": 3.2e6, "Y_uv": -1e5},
        dead_time=0.5, current=0.5, current_rms=0.1, bandwidth=0.005, gust=3e4, gust_bandwidth=0.05,
    ),
    StationRig(
        "catamaran of 5 m, four azimuths", 5.0, (600.0, 900.0, 1300.0),
        ((1.8, -0.8, None), (1.8, 0.8, None), (-1.8, 0.8, None), (-1.8, -0.8, None)), (150.0, 120.0), (2.0, 2.0), 0.35,
        (0.5, 0.1), {"X_u": -18.0, "X_uu": -50.0, "Y_v": -40.0, "Y_vv": -150.0, "N_r": -120.0, "N_rr": -150.0,
                     "N_ur": -100.0, "N_uv": 280.0, "Y_uv": -60.0},
        dead_time=0.2, current=0.3, current_rms=0.05, bandwidth=0.05, gust=15.0, gust_bandwidth=0.2, turning_lag=0.5,
    ),
)  # fmt: skip


class Hull:
    """Rates of u, v, r, psi, north, east, then of each thruster's share of full command and direction, (k, n) each."""

    def __init__(self, rig: StationRig) -> None:
        self.rig, self.count = rig, len(rig.places)
        self.turns = rig.places[0][2] is None

    def rates(self, x: Array, orders: Array, water: Array, push: Array) -> Array:
        """Return the rates at states, orders of shares and directions (2 m, n), water's velocity (2, n), forces."""
        rig, m = self.rig, self.count
        u, v, r, psi = x[:4]
        X, Y, N = push
        X, Y, N = X + 0.0 * u, Y + 0.0 * u, N + 0.0 * u
        for i, (place_x, place_y, fixed) in enumerate(rig.places):
            c, a = x[6 + i], x[6 + m + i] if fixed is None else fixed
            T = self.thrust(c, (u - place_y * r) * np.cos(a) + (v + place_x * r) * np.sin(a))
            X, Y = X + T * np.cos(a), Y + T * np.sin(a)
            N = N + T * (place_x * np.sin(a) - place_y * np.cos(a))
        d = {"N_ur": 0.0, "N_uv": 0.0, "Y_uv": 0.0} | rig.damping
        X = X + (d["X_u"] + d["X_uu"] * np.abs(u)) * u
        Y = Y + (d["Y_v"] + d["Y_vv"] * np.abs(v) + d["Y_uv"] * np.abs(u)) * v
        N = N + (d["N_r"] + d["N_rr"] * np.abs(r) + d["N_ur"] * np.abs(u)) * r + d["N_uv"] * u * v
        M_u, M_v, M_r = rig.mass
        shares = (orders[:m] - x[6 : 6 + m]) / rig.lag
        turning = (orders[m:] - x[6 + m :]) / rig.turning_lag if self.turns else np.zeros_like(x[6 + m :])
        return np.concatenate([
            [(X + M_v * v * r) / M_u, (Y - M_u * u * r) / M_v, (N + (M_u - M_v) * u * v) / M_r, r],
            [u * np.cos(psi) - v * np.sin(psi) + water[0], u * np.sin(psi) + v * np.cos(psi) + water[1]],
            shares, turning,
        ])  # fmt: skip

    def thrust(self, c: Array, w: Array) -> Array:
        """Return the thrust of shares of full command at a speed along it through the water."""
        (ahead, astern), (up, down), (loss, decay) = self.rig.thrust, self.rig.exponents, self.rig.losses
        still = ahead * np.abs(c) ** up
        back = -astern * np.abs(c) ** down * np.exp(-decay * w**2)
        return np.where(c > 0.0, still - loss * np.sqrt(still) * w, back)


class OwnKeeper:
    """A station keeper as one codes it from gains.toml, for n craft at once."""

    def __init__(self, text: str, count: int) -> None:
        self.table: dict[str, Any] = tomllib.loads(text)["station"]
        table = self.table
        self.T, self.dead_time = table["sample_s"], table["dead_time_s"]
        self.KP, self.KI, self.KD = (np.array(table[name]) for name in ("KP", "KI", "KD"))
        lag = np.array(table["filter_lag_s"])
        self.past, self.forward = (2.0 * lag - self.T) / (2.0 * lag + self.T), 2.0 / (2.0 * lag + self.T)
        self.q, self.v, self.before = np.zeros((3, count)), np.zeros((3, count)), np.zeros((3, count))
        self.thrusters = table["thrusters"]
        self.direction = np.zeros((len(self.thrusters), count))

    def order(self, pose: Array) -> tuple[Array, Array, Array]:
        """Return shares and directions (2 m, n), thrusts over the largest (m, n), and the share that is given (n,)."""
        cos, sin = np.cos(pose[2]), np.sin(pose[2])

        def body(x: Array) -> Array:
            return np.array([cos * x[0] + sin * x[1], cos * x[1] - sin * x[0], x[2]])

        self.v = self.past[:, None] * self.v + self.forward[:, None] * body(pose - self.before)
        q = self.q + 0.5 * self.T * (pose + self.before)
        self.before = pose
        tau = -(self.KP @ body(pose) + self.KI @ body(q) + self.KD @ self.v)
        parts = [np.array(one["inverse"]) @ tau for one in self.thrusters]
        given = np.ones(pose.shape[1])
        for part, one in zip(parts, self.thrusters, strict=True):
            size = part[0] if len(part) == 1 else np.hypot(*part)
            most = np.where(size > 0.0, one["thrust"][-1], one["thrust"][0])
            given = np.minimum(given, np.where(np.abs(size) > 1e-12, most / np.where(size == 0.0, 1.0, size), 1.0))
        self.q = np.where(given < 1.0, self.q, q)
        shares, thrusts = [], []
        for i, (part, one) in enumerate(zip(parts, self.thrusters, strict=True)):
            part, largest = part * given, max(one["thrust"][-1], -one["thrust"][0])
            if len(part) == 2:
                turn = np.arctan2(part[1], part[0]) - self.direction[i]
                turn -= 2.0 * math.pi * np.floor((turn + math.pi) / (2.0 * math.pi))
                part = np.hypot(*part)[None]
                self.direction[i] += np.where(part[0] > 1e-3 * largest, turn, 0.0)
            shares.append(np.interp(part[0], one["thrust"], one["share"]))
            thrusts.append(part[0] / largest)
        return np.concatenate([shares, self.direction]), np.array(thrusts), given

    def response(self, z: Array, turned: Array) -> Array:
        """Return -tau over the pose in z (k, 3, 3); turned: what the gathered integral adds to a heading's column."""
        integral = 0.5 * self.T * (z + 1.0) / (z - 1.0)
        rate = self.forward * ((z - 1.0)[:, None] / (z[:, None] - self.past))
        return self.KP + turned + self.KI * integral[:, None, None] + self.KD * rate[:, None, :]


@dataclass(frozen=True)
class Kept:
    """What the simulator measures: rms and 95 % circle of the distance [m], rms of heading [rad] and of thrusts."""

    position: float
    radius: float
    heading: float
    thrust: float
    cut: float


def keep(rig: StationRig, text: str, directions: Array) -> Kept:
    """Return how the craft keeps its place in a current from every direction."""
    came_from = np.repeat(directions, SEEDS)
    hull, keeper = Hull(rig), OwnKeeper(text, len(came_from))
    parts = math.ceil(keeper.T / (SHORT * rig.lag))
    dt, m, n = keeper.T / parts, len(rig.places), len(came_from)
    run_in = RUN_IN * float((np.diag(keeper.KP) / np.diag(keeper.KI)).max())
    count, first = math.ceil((run_in + COUNTED / rig.bandwidth) / keeper.T), math.ceil(run_in / keeper.T)
    rng = np.random.default_rng(47)

    def series(rms: float, bandwidth: float) -> Array:
        return np.array([gauss_markov(rms, bandwidth, keeper.T, count, rng) for _ in range(n)]).T

    water = [
        series(rig.current_rms, rig.bandwidth) - rig.current * side for side in (np.cos(came_from), np.sin(came_from))
    ]
    gusts = [series(rig.gust, rig.gust_bandwidth) for _ in range(2)]
    x = np.zeros((6 + 2 * m, n))
    x[0], x[1] = rig.current * np.cos(came_from), rig.current * np.sin(came_from)
    waiting = [np.zeros((2 * m, n))] * round(keeper.dead_time / dt)
    pose, used, given = np.empty((count, 3, n)), np.empty((count, m, n)), np.empty((count, n))
    for k in range(count):
        pose[k] = x[4], x[5], x[3]
        seen = pose[k] + np.outer([0.0, 0.0, rig.noise * DEGREE], rng.standard_normal(n))
        order, used[k], given[k] = keeper.order(seen)
        flow, push = np.array([water[0][k], water[1][k]]), np.array([gusts[0][k], gusts[1][k], np.zeros(n)])
        for _ in range(parts):
            waiting.append(order)
            acting = waiting.pop(0)
            middle = x + 0.5 * dt * hull.rates(x, acting, flow, push)
            x = x + dt * hull.rates(middle, acting, flow, push)
    distance = np.hypot(pose[first:, 0], pose[first:, 1])
    heading, thrust = pose[first:, 2], used[first:]
    return Kept(
        *(float(value) for value in (np.sqrt(np.mean(distance**2)), np.percentile(distance, 95.0),
          np.sqrt(np.mean(heading**2)), np.sqrt(np.mean(thrust**2)), np.mean(given[first:] < 1.0)))
    )  # fmt: skip


def largest_sensitivities(rig: StationRig, text: str, direction: float) -> Array:
    """Return the largest |S_ii| of surge, sway and yaw, and of the largest singular value of S, in one current."""
    hull, keeper, m = Hull(rig), OwnKeeper(text, 1), len(rig.places)
    flow = -rig.current * np.array([math.cos(direction), math.sin(direction)])

    inverse = np.concatenate([one["inverse"] for one in keeper.thrusters])

    def shares(thrusts: Array) -> Array:
        return np.array(
            [np.interp(T, one["thrust"], one["share"]) for T, one in zip(thrusts, keeper.thrusters, strict=True)]
        )

    def rates(x: Array) -> Array:
        return hull.rates(x[:, None], x[6:, None], flow[:, None], np.zeros((3, 1)))[:, 0]

    def held(thrusts: Array) -> Array:
        """Return the states of the craft that stands under settled thrusts, as ordered."""
        return np.concatenate([[*(-flow), 0.0, 0.0, 0.0, 0.0], shares(thrusts), np.zeros(m)])

    tau = np.zeros(3)
    for _ in range(ROUNDS):
        tau = tau - rates(held(inverse @ tau))[:3] * rig.mass
    x, T, size = held(inverse @ tau), inverse @ tau, 6 + m
    # secants of a hundredth of the largest thrust: at rest a curve of thrust has no slope, its inverse no end of it
    small = SECANT * np.array([one["thrust"][-1] for one in keeper.thrusters])
    high, low = shares(T + small), shares(T - small)
    A, B = np.zeros((size, size)), np.zeros((size, 3))
    for k in range(size):
        up, down = x.copy(), x.copy()
        up[k], down[k] = (x[k] + DIFFERENCE, x[k] - DIFFERENCE) if k < 6 else (high[k - 6], low[k - 6])
        A[:6, k] = (rates(up) - rates(down))[:6] / (up[k] - down[k])
    A[6:, 6:] = -np.eye(m) / rig.lag
    B[6:] = ((high - low) / (2.0 * small) / rig.lag)[:, None] * inverse
    omega = np.geomspace(1e-4, 0.999 * math.pi, FREQUENCIES) / keeper.T
    z = np.exp(1j * omega * keeper.T)
    P = _sampled(A, B, keeper.T, keeper.dead_time, z)[:, [4, 5, 3]]
    # R'(psi) q turns with the craft: q holds tau = -K_I q
    q, turned = -np.linalg.solve(keeper.KI, tau), np.zeros((3, 3))
    turned[:, 2] = keeper.KI @ np.array([q[1], -q[0], 0.0])
    S = np.linalg.inv(np.eye(3) + P @ keeper.response(z, turned))
    arm = np.array([1.0, 1.0, 0.5 * rig.length])
    joint = np.linalg.norm(S * arm[:, None] / arm, ord=2, axis=(1, 2)).max()
    return np.array([*np.abs(np.diagonal(S, axis1=1, axis2=2)).max(axis=0), joint])


def _sampled(A: Array, B: Array, T: float, dead_time: float, z: Array) -> Array:
    """Return states over an order of one sample that acts after a dead time, at z (n,), (n, k, 3)."""
    n, whole = len(A), math.floor(dead_time / T + 1e-9)
    late = dead_time - whole * T

    def step(t: float) -> tuple[Array, Array]:
        made = expm(np.block([[A * t, B * t], [np.zeros((3, n + 3))]]))
        return made[:n, :n], made[:n, n:]

    (first, before), (second, now) = step(late), step(T - late)
    inputs = now + (second @ before) / z[:, None, None]
    return np.linalg.solve(z[:, None, None] * np.eye(n) - second @ first, inputs) / z[:, None, None] ** whole


def lines_of(rigs: Sequence[StationRig], effort: Effort | None = None) -> list[Line]:
    """Return the lines of some craft."""
    lines = []
    for rig in rigs:
        _, tuning = tuning_of(rig.loop_file(), rig.model, effort)
        page, text = tuning.station, gains_toml(tuning)
        assert page is not None
        kept = keep(rig, text, page.trial.directions)
        has_margins = not rig.turning_lag  # thrusters that turn with each gust have no linear loop
        directions = page.trial.directions.tolist() if has_margins else []
        peaks = np.max([np.zeros(4), *(largest_sensitivities(rig, text, one) for one in directions)], axis=0)
        of_page = (page.margins.surge, page.margins.sway, page.margins.yaw, page.margins.joint)
        pairs = (
            (f"distance rms {page.trial.position:.3f} m", page.trial.position, kept.position),
            (f"circle of 95 % {page.trial.radius:.3f} m", page.trial.radius, kept.radius),
            (f"heading rms {page.trial.heading / DEGREE:.2f} deg", page.trial.heading, kept.heading),
            ("thrust rms", page.trial.thrust, kept.thrust),
        )
        lines += [
            at_most(f"{rig.name}: {what}, page over simulator", abs(100.0 * (said / made - 1.0)), "%", RMS)
            for what, said, made in pairs
        ]
        lines += [
            at_most(f"{rig.name}: Ms of {axis} {said:.2f}, page less simulator", abs(said - float(own)), "", PEAK)
            for axis, said, own in zip(("surge", "sway", "yaw", "all together"), of_page, peaks, strict=True)
            if has_margins
        ]
    return lines


def run() -> list[Line]:
    """Return the lines of the craft with fixed thrusters, a sample of all."""
    return lines_of(RIGS[:1], QUICK)


if __name__ == "__main__":
    for each in RIGS:
        print_lines(lines_of([each], QUICK))
