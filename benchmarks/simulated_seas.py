"""Craft in gusts and waves for `waves.py` and `criteria.py`, simulated exactly and without the package's simulator.

Gusts and waves are linear systems driven by white noise, taken over a step by the matrix exponential (Van Loan 1978,
IEEE Trans. Autom. Control 23(3), 395-404); craft that are linear with them, others by Runge-Kutta steps of 0.05 s.
Inputs run straight from sample to sample within the rate of their machinery, as the package reads a record, so that
timing (another benchmark's subject) errs nowhere. Waves reach the sensors (an angle and its rate, positions and speeds,
on which the helm acts as well) or are forces. `simulated` returns what instruments record and the motion beneath.
The same seed draws the same gusts, waves and noise, whatever their size.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.linalg import block_diag, expm, solve_continuous_lyapunov

import seatrial as st

Array = NDArray[np.float64]
Rates = Callable[[Sequence[float], Sequence[float]], tuple[float, float, float]]
"""Accelerations of u, v, r from (u, v, r) and the inputs."""
Manoeuvre = Literal["zigzag", "steps", "autopilot", "station"]
MOTIONS = ("u", "v", "r")
GRAVITY = 9.81  # m/s^2, standard gravity
RESOLUTION = math.radians(0.1)  # rad, step of the recorded heading: a compass that sends tenths of a degree
SUBSTEP = {True: 0.1, False: 0.05}  # s, linear: for the track only; Runge-Kutta: halved, no recorded digit changes
WAVE_DAMPING = 0.1  # 1, of the narrow-band processes, as in the spectra of Fossen 2011, section 8.2.6
SWELL = 0.6  # 1, frequency of the swell over that of the sea; chosen
MEMORY = 5.0  # s, of the gusts, as in the benchmark problem nomoto-gusts
MODERATE = 0.3  # 1, rms of moderate gusts over what the helm does, as there
LEG = (60.0, 120.0)  # s, shortest and longest time on a course, at a step or at a place; chosen
PLACE = 2.0  # m, farthest next place of station keeping, north and east; chosen
RATE_FILTER = 2.0  # s, lag of the helm's derivative of the heading; chosen


@dataclass(frozen=True)
class Sea:
    """Waves: rms of the yaw they cause [rad], frequency of encounter [rad/s], one or two peaks, and how they enter."""

    rms: float = 0.0
    frequency: float = 0.8
    peaks: int = 1
    is_force: bool = False

    @property
    def frequencies(self) -> tuple[float, ...]:
        """Of the peaks: the sea's, and the swell's."""
        return (self.frequency, SWELL * self.frequency)

    @property
    def shares(self) -> tuple[float, ...]:
        """Of the peaks in the rms: half of the variance each where there are two."""
        return (1.0, 0.0) if self.peaks == 1 else (math.sqrt(0.5), math.sqrt(0.5))


@dataclass(frozen=True)
class Conditions:
    """How a craft is steered, what disturbs it, and how it is recorded.

    Attributes:
        gusts: rms of a first-order Markov acceleration over the craft's `gust`; rate: of the record [Hz].
        seconds: of the record; 0: the craft's own. channels: that are recorded besides the inputs.
        lag: of a filter in the compass [s]; backlash: of the rudder [rad]; zero: of its recorded angle [rad].
        is_order: whether the order is recorded in place of the angle; spikes, lost: shares of rows.
    """

    manoeuvre: Manoeuvre = "zigzag"
    sea: Sea = Sea()
    gusts: float = 0.0
    rate: float = 1.0
    channels: tuple[str, ...] = ("psi", "u")
    seconds: float = 0.0
    lag: float = 0.0
    backlash: float = 0.0
    zero: float = 0.0
    is_order: bool = False
    spikes: float = 0.0
    lost: float = 0.0


@dataclass(frozen=True)
class Helm:
    """How inputs are worked, SI: for rudder craft one scalar times `share` about `mean`.

    Attributes:
        amplitude: of steps; executes: rudder and heading of the zigzag; limit, slew: of an input, a second.
        gain, rate_gain: of the autopilot: input over heading error, and over yaw rate [s].
        station: thrusters' commands over (forward [m], starboard [m], heading [rad]) errors, (inputs, 3); empty: none.
        station_rate: s, derivative over proportional gain there.
    """

    share: tuple[float, ...]
    mean: tuple[float, ...]
    amplitude: float
    executes: tuple[float, float]
    limit: float
    slew: float
    gain: float
    rate_gain: float
    course: float = math.radians(20.0)  # rad, largest change of course; chosen
    is_each: bool = False
    station: tuple[tuple[float, float, float], ...] = ()
    station_rate: float = 4.0


@dataclass(frozen=True, eq=False)
class Craft:
    """A craft whose equations are known.

    Attributes:
        model: to be fitted, with the true values; rates: the same equations, written anew.
        linear: matrices (A, B) of states whose first is r, where yaw is linear and u constant.
        start: u at the start [m/s]; gust: accelerations by a gust of size 1; time_constant: of yaw [s].
        noise: channel -> standard deviation, SI; prior: spread of a prior of each coefficient; 0: none.
    """

    name: str
    model: st.Model
    ship: st.Ship
    inputs: tuple[str, ...]
    helm: Helm
    start: float
    gust: tuple[float, float, float]
    time_constant: float
    noise: Mapping[str, float]
    seconds: float
    guess: Mapping[str, float] = field(default_factory=dict)
    rates: Rates | None = None
    linear: tuple[Array, Array] | None = None
    prior: float = 0.0

    @property
    def truth(self) -> dict[str, float]:
        """True values of the free coefficients."""
        return {p.name: p.value for p in self.model.parameters.free}


@dataclass(frozen=True, eq=False)
class SimulatedRun:
    """What instruments record of a run, and the craft's motion at the same rows beneath waves and noise, channel -> SI.

    step: s between rows, lost rows counted.
    """

    record: st.Record
    motion: Mapping[str, Array]
    step: float


def discretised(A: Array, noise: Array, step: float) -> tuple[Array, Array]:
    """Return transition and covariance over a step of dx = A x dt + dw, cov dw = noise dt (Van Loan 1978)."""
    n = len(A)
    block = expm(np.block([[-A, noise], [np.zeros((n, n)), A.T]]) * step)
    transition = block[n:, n:].T
    return transition, transition @ block[:n, n:]


def disturbances(sea: Sea) -> tuple[Array, Array]:
    """Return matrix and noise of three gusts, then pairs (angle, rate) by motion and peak: all of unit variance.

    First order: x' = -x / memory + w. Second: xi' = eta, eta' = -omega^2 xi - 2 zeta omega eta + w
    (Saelid et al. 1983; Fossen 2011, section 8.2.6), of variance 1 for xi, omega^2 for eta.
    """
    gust = -np.eye(3) / MEMORY
    pairs = [np.array([[0.0, 1.0], [-(w**2), -2.0 * WAVE_DAMPING * w]]) for _ in MOTIONS for w in sea.frequencies]
    sizes = [size for _ in MOTIONS for w in sea.frequencies for size in (0.0, 4.0 * WAVE_DAMPING * w**3)]
    return block_diag(gust, *pairs), np.diag([2.0 / MEMORY] * 3 + sizes)


def sensor_rows(sea: Sea, length: float) -> tuple[Array, Array]:
    """Return what makes displacements (north, east, yaw) and their rates of the disturbances' states, (3, 15) each."""
    angle, rate = np.zeros((3, 15)), np.zeros((3, 15))
    for motion in range(3):
        for peak, (w, share) in enumerate(zip(sea.frequencies, sea.shares, strict=True)):
            arm = 1.0 if motion == 2 else min(GRAVITY / w**2, 0.5 * length)  # m a rad: 1/k in deep water, or L/2
            column = 3 + 4 * motion + 2 * peak
            angle[motion, column] = rate[motion, column + 1] = 0.0 if sea.is_force else sea.rms * share * arm
    return angle, rate


def force_rows(conditions: Conditions, craft: Craft) -> Array:
    """Return what makes accelerations of u, v, r of the disturbances' states, (3, 15).

    A narrow-band force is the pair's rate, which has no energy at rest, as first-order loads; its size gives the
    craft's yaw the sea's rms at that frequency by its time constant.
    """
    rows, sea = np.zeros((3, 15)), conditions.sea
    rows[:, :3] = conditions.gusts * np.diag(craft.gust)
    if not sea.is_force:
        return rows
    length = craft.ship.particulars["L"]
    for motion in range(3):
        for peak, (w, share) in enumerate(zip(sea.frequencies, sea.shares, strict=True)):
            arm = math.hypot(w, 1.0 / craft.time_constant) if motion == 2 else w * min(GRAVITY / w**2, 0.5 * length)
            rows[motion, 3 + 4 * motion + 2 * peak + 1] = sea.rms * share * arm
    return rows


@dataclass(frozen=True, eq=False)
class _Noise:
    """A path of the disturbances in fine steps, (rows, 15), and the white draws of each step, (rows, 15)."""

    path: Array
    draws: Array


def _noise(sea: Sea, step: float, rows: int, rng: np.random.Generator) -> _Noise:
    A, noise = disturbances(sea)
    transition, covariance = discretised(A, noise, step)
    root = np.linalg.cholesky(covariance)
    draws = rng.standard_normal((rows, len(A)))
    kicks, path = draws @ root.T, np.empty((rows, len(A)))
    path[0] = np.linalg.cholesky(solve_continuous_lyapunov(A, -noise)) @ rng.standard_normal(len(A))
    for k in range(rows - 1):
        path[k + 1] = transition @ path[k] + kicks[k]
    return _Noise(path, draws)


Stepper = Callable[[Array, Array, Array, int], Array]
"""State after a fine step from state, inputs at its beginning and end, and its number."""


def linear_stepper(
    craft: Craft, conditions: Conditions, noise: _Noise, step: float, rng: np.random.Generator
) -> Stepper:
    """Return exact steps of a linear craft together with its disturbances; states (..., psi), the first is r."""
    assert craft.linear is not None
    A, B = craft.linear
    D, disturbance_noise = disturbances(conditions.sea)
    own, others = len(A), len(D)
    coupling = np.zeros((own, others))
    coupling[0] = force_rows(conditions, craft)[2]
    whole = np.block([[D, np.zeros((others, own))], [coupling, A]])
    size = np.zeros_like(whole)
    size[:others, :others] = disturbance_noise
    transition, covariance = discretised(whole, size, step)
    root = np.linalg.cholesky(covariance[:others, :others])
    shared = np.linalg.solve(root, covariance[:others, others:]).T
    left, vectors = np.linalg.eigh(covariance[others:, others:] - shared @ shared.T)
    rest = vectors * np.sqrt(np.clip(left, 0.0, None))
    draws = rng.standard_normal((len(noise.path), own))
    pushed = noise.path @ transition[others:, :others].T + noise.draws @ shared.T + draws @ rest.T
    ramp = np.zeros((own + 2, own + 2))
    ramp[:own, :own], ramp[:own, own], ramp[own, own + 1] = A, B, 1.0
    moved = expm(ramp * step)[:own]

    def after(x: Array, begin: Array, end: Array, k: int) -> Array:
        return (
            moved[:, :own] @ x + moved[:, own] * begin[0] + moved[:, own + 1] * (end[0] - begin[0]) / step + pushed[k]
        )

    return after


def runge_kutta_stepper(craft: Craft, conditions: Conditions, noise: _Noise, step: float) -> Stepper:
    """Return steps of fourth order of (u, v, r, psi, x0, y0), inputs and accelerations of disturbances straight."""
    rates, pushed = craft.rates, noise.path @ force_rows(conditions, craft).T
    assert rates is not None

    def derivative(x: Array, inputs: Array, push: Array) -> Array:
        u, v, r, psi = x[:4].tolist()
        du, dv, dr = rates((u, v, r), inputs.tolist())
        c, s = math.cos(psi), math.sin(psi)  # Fossen 2021, eq. (2.50)
        return np.array([du + push[0], dv + push[1], dr + push[2], r, u * c - v * s, u * s + v * c])

    def after(x: Array, begin: Array, end: Array, k: int) -> Array:
        first, last = pushed[k], pushed[min(k + 1, len(pushed) - 1)]
        middle, mean = 0.5 * (begin + end), 0.5 * (first + last)
        a = derivative(x, begin, first)
        b = derivative(x + 0.5 * step * a, middle, mean)
        c = derivative(x + 0.5 * step * b, middle, mean)
        d = derivative(x + step * c, end, last)
        return x + step / 6.0 * (a + 2.0 * b + 2.0 * c + d)

    return after


class Steersman:
    """Works the inputs: returns what it orders at a sample from what it measures there."""

    def __init__(self, craft: Craft, manoeuvre: Manoeuvre, step: float, rng: np.random.Generator) -> None:
        self.helm, self.manoeuvre, self.step, self.rng = craft.helm, manoeuvre, step, rng
        self.until, self.reference, self.turn, self.filtered = -1.0, np.zeros(3), np.zeros(3), np.zeros(3)
        self.levels, self.side, self.is_first = np.zeros(len(self.helm.share)), 1.0, True

    def orders(self, time: float, measured: Array) -> Array:
        """Return the ordered inputs; measured: north, east [m], heading [rad]."""
        helm = self.helm
        if self.is_first:
            self.filtered, self.reference, self.is_first = measured.copy(), measured.copy(), False
        speed = (measured - self.filtered) / RATE_FILTER
        self.filtered += (1.0 - math.exp(-self.step / RATE_FILTER)) * (measured - self.filtered)
        if time >= self.until:
            self._next_leg(time)
        mean, share = np.array(helm.mean), np.array(helm.share)
        if self.manoeuvre == "steps":
            return np.clip(mean + self.levels, -1.0, 1.0) if helm.is_each else mean + share * self.levels[0]
        if self.manoeuvre == "station":
            return self._station(measured, speed)
        if self.manoeuvre == "zigzag":
            if self.side * (measured[2] - self.turn[2]) >= helm.executes[1]:
                self.side = -self.side
            return mean + share * self.side * helm.executes[0]
        error = self.reference[2] - measured[2]
        return mean + share * np.clip(helm.gain * error - helm.rate_gain * speed[2], -helm.limit, helm.limit)

    def _next_leg(self, time: float) -> None:
        draws = self.rng.uniform(-1.0, 1.0, 3 + len(self.levels))
        self.until = time + LEG[0] + (LEG[1] - LEG[0]) * 0.5 * (1.0 + draws[0])
        if self.manoeuvre == "steps":
            self.until = time + 0.25 * (self.until - time)  # shorter than a course, chosen
        self.levels = self.helm.amplitude * draws[3:]
        change = self.helm.course * (math.copysign(0.5, draws[1]) + 0.5 * draws[0])  # to either side
        self.reference = self.reference + np.array([PLACE * draws[1], PLACE * draws[2], change])

    def _station(self, measured: Array, speed: Array) -> Array:
        gap = self.reference - measured - self.helm.station_rate * speed
        c, s = math.cos(measured[2]), math.sin(measured[2])
        forces = np.array(self.helm.station) @ np.array([c * gap[0] + s * gap[1], c * gap[1] - s * gap[0], gap[2]])
        return np.clip(np.sign(forces) * np.sqrt(np.abs(forces)), -1.0, 1.0)


def simulated(craft: Craft, conditions: Conditions, seed: Sequence[int], name: str = "run") -> SimulatedRun:
    """Simulate a run of a craft and record it; the same seed gives the same bits."""
    streams = [np.random.default_rng(s) for s in np.random.SeedSequence(list(seed)).spawn(5)]
    step, is_linear = 1.0 / conditions.rate, craft.linear is not None
    parts = max(1, math.ceil(step / SUBSTEP[is_linear] - 1e-9))
    samples = round((conditions.seconds or craft.seconds) * conditions.rate) + 1
    fine = step / parts
    noise = _noise(conditions.sea, fine, (samples - 1) * parts + 1, streams[0])
    stepper = (
        linear_stepper(craft, conditions, noise, fine, streams[1])
        if is_linear else runge_kutta_stepper(craft, conditions, noise, fine)
    )  # fmt: skip
    angle, rate = sensor_rows(conditions.sea, craft.ship.particulars["L"])
    at = noise.path[::parts]
    white = {c: s * streams[2].standard_normal(samples) for c, s in craft.noise.items()}
    shown, inputs, orders = _steered(craft, conditions, stepper, parts, at @ angle.T, white, streams[3])
    measured = _measured(craft, conditions, shown, at @ rate.T, at @ angle.T, white)
    worked = _recorded_inputs(craft, conditions, inputs, orders)
    table = pd.DataFrame(measured | worked, index=step * np.arange(samples))
    table, rows = _spoilt(table, conditions, streams[4])
    kept = {c: v[rows] for c, v in shown.items()}
    positive = {"delta": "port"} if craft.name == "waterjet" else None
    return SimulatedRun(st.Record.from_dataframe(table, name, positive=positive), kept, step)


def _steered(
    craft: Craft, conditions: Conditions, stepper: Stepper, parts: int, waves: Array, white: Mapping[str, Array],
    rng: np.random.Generator,
) -> tuple[dict[str, Array], Array, Array]:  # fmt: skip
    """Return motion at the samples, the inputs that act, and those that were ordered."""
    helm, step, is_linear = craft.helm, 1.0 / conditions.rate, craft.linear is not None
    steersman = Steersman(craft, conditions.manoeuvre, step, rng)
    x = np.zeros(6 if craft.linear is None else len(craft.linear[0]))
    if not is_linear and conditions.manoeuvre != "station":
        x[0] = craft.start
    heading, place = -1 if is_linear else 3, np.zeros(2)
    states, inputs, orders = [], [np.array(helm.mean)], []
    weights, fine, play = np.arange(parts + 1) / parts, step / parts, 0.5 * conditions.backlash
    acting = inputs[0]
    for k in range(len(waves)):
        states.append(np.concatenate([[craft.start, 0.0, x[0], x[-1]], place]) if is_linear else x)
        pose = np.array([*states[-1][4:6], x[heading]])
        sensed = pose + waves[k] + np.array([white["x0"][k], white["y0"][k], white["psi"][k]])
        orders.append(steersman.orders(k * step, sensed))
        if k == len(waves) - 1:
            break
        inputs.append(inputs[-1] + np.clip(orders[-1] - inputs[-1], -helm.slew * step, helm.slew * step))
        begin, acting = acting, np.clip(acting, inputs[-1] - play, inputs[-1] + play)
        turned = acting - begin
        for j in range(parts):
            before = x
            x = stepper(x, begin + weights[j] * turned, begin + weights[j + 1] * turned, k * parts + j)
            if is_linear:
                place = place + craft.start * _track(before, x, fine)
    names = ("u", "v", "r", "psi", "x0", "y0")
    return dict(zip(names, np.array(states).T, strict=True)), np.array(inputs), np.array(orders)


def _track(before: Array, after: Array, step: float) -> Array:
    """Return the way north and east at unit speed: Simpson's rule, the heading between by cubic Hermite, (2,)."""
    middle = 0.5 * (before[-1] + after[-1]) + step / 8.0 * (before[0] - after[0])
    angles, weights = np.array([before[-1], middle, after[-1]]), step / 6.0 * np.array([1.0, 4.0, 1.0])
    return np.array([weights @ np.cos(angles), weights @ np.sin(angles)])


def _measured(
    craft: Craft, conditions: Conditions, shown: Mapping[str, Array], rate: Array, angle: Array,
    white: Mapping[str, Array],
) -> dict[str, Array]:  # fmt: skip
    """Return the recorded channels: motion, the waves' own motion, white noise, and the compass's filter and steps."""
    c, s = np.cos(shown["psi"] + angle[:, 2]), np.sin(shown["psi"] + angle[:, 2])
    moved = {"u": c * rate[:, 0] + s * rate[:, 1], "v": c * rate[:, 1] - s * rate[:, 0], "r": rate[:, 2],
             "psi": angle[:, 2], "x0": angle[:, 0], "y0": angle[:, 1]}  # fmt: skip
    channels = {name: shown[name] + moved[name] for name in moved}
    if conditions.lag:
        channels["psi"] = _filtered(channels["psi"], conditions.lag * conditions.rate)
    recorded = {n: channels[n] + white[n] for n in channels if n in craft.noise and n in conditions.channels}
    recorded["psi"] = RESOLUTION * np.round(recorded["psi"] / RESOLUTION)
    return recorded


def _filtered(values: Array, samples: float) -> Array:
    """A lag of first order of so many samples, exact for values that run straight between samples."""
    keep, kept = math.exp(-1.0 / samples), values.copy()
    for k in range(1, len(values)):
        slope = values[k] - values[k - 1]
        kept[k] = values[k] - samples * slope + keep * (kept[k - 1] - values[k - 1] + samples * slope)
    return kept


def _recorded_inputs(craft: Craft, conditions: Conditions, inputs: Array, orders: Array) -> dict[str, Array]:
    """Return the recorded inputs: angles of the machinery before any backlash, or orders, with their zero."""
    values = orders if conditions.is_order else inputs
    return {name: values[:, i] - (conditions.zero if name == "delta" else 0.0) for i, name in enumerate(craft.inputs)}


def _spoilt(
    table: pd.DataFrame, conditions: Conditions, rng: np.random.Generator
) -> tuple[pd.DataFrame, NDArray[np.intp]]:
    """Return the table with spikes of the heading and without its lost rows, and the numbers of those that are left."""
    hit = rng.random(len(table)) < conditions.spikes
    size = math.radians(30.0) * rng.choice([-1.0, 1.0], len(table))  # rad, a spike; chosen
    kept = np.flatnonzero(rng.random(len(table)) >= conditions.lost)
    return table.assign(psi=table["psi"] + np.where(hit, size, 0.0)).iloc[kept], kept
