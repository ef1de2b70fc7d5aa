"""Coefficients from logs of simulated ships, with clean and with faulty sensors.

    python benchmarks/independent_ships.py [SEEDS] [WORDS]

`python benchmarks/run.py independent_ships` is the short form: one seed of the two cheapest craft. 20 seeds are what
the documentation rests on; WORDS in the name of a cell select cells.

Each simulator states its equations below, or in `sample_rates`, and takes Runge-Kutta steps of 5 ms to 50 ms, none of
the package's own. A cell is a craft and a fault of its sensors: the share of 95 % intervals that hold the truth, and
the findings that name the fault. The whole of `identify` runs, as for a user who states nothing of the fault.
"""

import math
import sys
import time
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from measure import Line, at_least
from sample_rates import NOMOTO, ROLL, USV, nomoto_rates, roll_rates, simulated, usv_rates
from scipy.interpolate import CubicSpline

from seatrial.core.values import Array, InputError, Record, Ship
from seatrial.data.trial import EstimateSettings, Run, Trial
from seatrial.estimation.identify import identify
from seatrial.physics.models import model_named

Rates = Callable[[Array, Array], Array]
Inputs = Callable[[Array, np.random.Generator], Array]


@dataclass(frozen=True)
class Fault:
    """What instruments do to the motion of a craft of length 1; nothing by default.

    Attributes:
        late: s, by which the receiver is late; lever: of its antenna forward, lengths of the craft.
        heading_filter: s, time constant of the compass's; bias: of the yaw rate [rad/s]; scale: share it is too high.
        wander: m, of a receiver's error with a memory of 120 s.
    """

    late: float = 0.0
    lever: float = 0.0
    heading_filter: float = 0.0
    bias: float = 0.0
    scale: float = 0.0
    wander: float = 0.0


FAULTS = {
    "clean": Fault(),
    "receiver 0.7 s late": Fault(late=0.7),
    "antenna a fifth of the length off": Fault(lever=0.2),
    "compass behind a filter of 0.5 s": Fault(heading_filter=0.5),
    "yaw rate biased by 0.8 deg/s": Fault(bias=math.radians(0.8)),
    "yaw rate 2 % high": Fault(scale=0.02),
    "receiver that wanders by 1 m": Fault(wander=1.0),
}
MEMORY = 120.0  # s, of a receiver's wandering error


@dataclass(frozen=True)
class Craft:
    """A simulator, the model that is to find its coefficients, and how it is tried.

    Attributes:
        states: channel of each state, empty: it is not recorded; spread: noise of each channel, SI.
        inputs: names, and their values at the samples (rows, nu) of a run.
        truth: the coefficients that are found; held: others of the model that differ from its own values.
        freed: further coefficients that the estimate frees.
        starts: initial states of the runs; step: of the simulator [s].
        positive: directions of inputs that are not the notation's.
        fine: parts of a sample over which inputs are held, 1: as recorded.
    """

    model: str
    rates: Rates
    states: tuple[str, ...]
    spread: Mapping[str, float]
    input_names: tuple[str, ...]
    inputs: Inputs
    truth: Mapping[str, float]
    starts: tuple[tuple[float, ...], ...]
    length: float
    duration: float
    rate: float
    held: Mapping[str, float]
    freed: tuple[str, ...] = ()
    step: float = 0.005
    fine: int = 1
    positive: Mapping[str, str] = field(default_factory=dict)


def steps(largest: tuple[float, ...], seconds: tuple[int, int], least: float = -1.0) -> Inputs:
    """Return inputs in steps between `least` and 1 times these, each held for so many seconds, at rest first."""

    def drawn(clock: Array, rng: np.random.Generator) -> Array:
        dt, columns = clock[1] - clock[0], []
        lengths = rng.integers(*seconds, 2 + int(clock[-1] / seconds[0]))
        for one in largest:
            levels = one * rng.uniform(least, 1.0, len(lengths))
            columns.append(np.repeat(levels, np.rint(lengths / dt).astype(int))[: len(clock)])
        return np.stack(columns, axis=1)

    return drawn


WATERJET = {
    "X_uu": -0.03125, "X_vv": 0.04657, "X_rr": 0.00414, "Y_v": -0.27670, "Y_r": 0.08811, "Y_vv": -1.00740,
    "Y_vr": -0.16437, "Y_rr": -0.07020, "N_v": -0.17080, "N_r": -0.05240, "N_rr": -0.04350,
}  # fmt: skip
"""Song et al. 2025, table 2, the sign of N_v turned."""
_L, _D, _M, _RHO = 9.8, 0.71, 5540.0, 1025.0  # m, m, kg, kg/m^3: the same source


def waterjet_rates(x: Array, inputs: Array) -> Array:
    """A craft of 9.8 m with a jet that turns at its stern (Song et al. 2025, eqs. (1) to (3), misprints corrected)."""
    u, v, r, psi, _, _ = x
    delta, v_j = inputs
    c, speed, q, w = WATERJET, math.hypot(u, v), 0.5 * _RHO * _L * _D, _L * r
    jet = _RHO * 0.035 * v_j * (v_j - u)
    X = q * (c["X_uu"] * u**2 + c["X_vv"] * v**2 + c["X_rr"] * w**2) + jet * math.cos(delta)
    Y = q * (c["Y_v"] * v * speed + c["Y_r"] * w * speed + c["Y_vv"] * v * abs(v) + c["Y_vr"] * abs(v) * w
             + c["Y_rr"] * w * abs(w)) + jet * math.sin(delta)  # fmt: skip
    N = q * _L * (c["N_v"] * v * speed + c["N_r"] * w * speed + c["N_rr"] * w * abs(w))
    N -= 0.45 * _L * jet * math.sin(delta)
    m_u, m_v = 1.0281 * _M, 1.785 * _M
    inertia = _M * (0.25 * _L) ** 2 + 0.0699 * _M * _L**2
    north, east = u * math.cos(psi) - v * math.sin(psi), u * math.sin(psi) + v * math.cos(psi)
    return np.array([(X + m_v * v * r) / m_u, (Y - m_u * u * r) / m_v, N / inertia, r, north, east])


def jet_inputs(clock: Array, rng: np.random.Generator) -> Array:
    """Steps of the nozzle to 17 deg, of the jet from 8 to 12 m/s."""
    return steps((0.3, 2.0), (6, 20))(clock, rng) + np.array([0.0, 10.0])


def ship_inputs(clock: Array, rng: np.random.Generator) -> Array:
    """Steps of the rudder to 30 deg, which slews by 3 deg/s; the propeller turns at 1.9 to 2.3 1/s."""
    ordered = steps((0.5, 0.2), (30, 120))(clock, rng)
    most, delta = math.radians(3.0) * (clock[1] - clock[0]), np.zeros(len(clock))
    for k in range(1, len(clock)):
        delta[k] = delta[k - 1] + np.clip(ordered[k, 0] - delta[k - 1], -most, most)
    return np.stack([delta, 2.1 + ordered[:, 1]], axis=1)


SHIP = {
    "R_0": 0.022, "X_vv": -0.04, "X_vr": 0.002, "X_rr": 0.011, "X_vvvv": 0.771, "Y_v": -0.315, "Y_r": 0.083,
    "Y_vvv": -1.607, "Y_vvr": 0.379, "Y_vrr": -0.391, "Y_rrr": 0.008, "N_v": -0.137, "N_r": -0.059, "N_vvv": -0.030,
    "N_vvr": -0.294, "N_vrr": 0.055, "N_rrr": -0.013,
}  # fmt: skip
"""KVLCC2 of Yasukawa & Yoshimura 2015, table 3, with a tenth more damping in yaw, so that it holds its course."""
SHIP_PARTS = {
    "L": 100.0, "d": 6.5, "rho": 1025.0, "m": 9.77e6, "x_G": 3.5, "I_z": 9.77e6 * 25.0**2, "D_P": 3.1, "H_R": 4.9,
    "A_R": 11.0, "m_x_prime": 0.022, "m_y_prime": 0.223, "J_z_prime": 0.011, "t_P": 0.22, "w_P0": 0.40, "k_0": 0.2931,
    "k_1": -0.2753, "k_2": -0.1385, "t_R": 0.387, "a_H": 0.312, "x_H_prime": -0.464, "epsilon": 1.09, "kappa": 0.5,
    "gamma_R_plus": 0.64, "gamma_R_minus": 0.395, "l_R_prime": -0.71, "f_alpha": 2.747, "C_1": 0.0, "C_2_plus": 1.0,
    "C_2_minus": 1.0,
}  # fmt: skip
"""The same source, at a length of 100 m."""


def ship_rates(x: Array, inputs: Array) -> Array:
    """A ship of 100 m by the MMG standard method (Yasukawa & Yoshimura 2015), midship, one propeller, one rudder."""
    u, v, r, psi, _, _ = x
    delta, n = inputs
    c, p = SHIP, SHIP_PARTS
    L, U = p["L"], math.hypot(u, v)
    q, v_, r_, beta = 0.5 * p["rho"] * L * p["d"], v / U, r * L / U, -math.atan2(v, u)
    X = q * U**2 * (-c["R_0"] + c["X_vv"] * v_**2 + c["X_vr"] * v_ * r_ + c["X_rr"] * r_**2 + c["X_vvvv"] * v_**4)
    Y, N = (
        q * U**2 * (c[f"{k}_v"] * v_ + c[f"{k}_r"] * r_ + c[f"{k}_vvv"] * v_**3 + c[f"{k}_vvr"] * v_**2 * r_
                    + c[f"{k}_vrr"] * v_ * r_**2 + c[f"{k}_rrr"] * r_**3)
        for k in ("Y", "N")
    )  # fmt: skip
    N *= L
    u_p = u * (1.0 - p["w_P0"])
    J = u_p / (n * p["D_P"])
    thrust = p["rho"] * n**2 * p["D_P"] ** 4 * (p["k_0"] + p["k_1"] * J + p["k_2"] * J**2)
    eta, K_T = p["D_P"] / p["H_R"], thrust / (p["rho"] * n**2 * p["D_P"] ** 4)
    faster = p["kappa"] * (math.sqrt(1.0 + 8.0 * K_T / (math.pi * J**2)) - 1.0)
    u_r = p["epsilon"] * u_p * math.sqrt(eta * (1.0 + faster) ** 2 + 1.0 - eta)
    beta_r = beta - p["l_R_prime"] * r_
    v_r = U * (p["gamma_R_plus"] if beta_r > 0.0 else p["gamma_R_minus"]) * beta_r
    angle = delta - math.atan2(v_r, u_r)
    F = 0.5 * p["rho"] * p["A_R"] * (u_r**2 + v_r**2) * p["f_alpha"] * math.sin(angle)
    X += (1.0 - p["t_P"]) * thrust - (1.0 - p["t_R"]) * F * math.sin(delta)
    Y -= (1.0 + p["a_H"]) * F * math.cos(delta)
    N += (0.5 - p["a_H"] * p["x_H_prime"]) * L * F * math.cos(delta)  # the rudder half a length aft
    m, g = p["m"], p["x_G"]
    m_u, m_v = m + p["m_x_prime"] * q * L, m + p["m_y_prime"] * q * L
    m_r = p["I_z"] + m * g**2 + p["J_z_prime"] * q * L**3
    X_m, Y_m, N_m = X + m_v * v * r + m * g * r**2, Y - m_u * u * r, N - m * g * u * r
    v_dot, r_dot = np.linalg.solve([[m_v, m * g], [m * g, m_r]], [Y_m, N_m])
    north, east = u * math.cos(psi) - v * math.sin(psi), u * math.sin(psi) + v * math.cos(psi)
    return np.array([X_m / m_u, v_dot, r_dot, r, north, east])


HULL = {
    "a33": 2500.0, "a35": 600.0, "a55": 8000.0, "a53": 300.0, "b33": 6000.0, "b35": 2000.0, "b55": 15000.0,
    "b53": -1500.0,
}  # fmt: skip
"""Of a craft of 8 m, kg, kg m, kg m^2 and these over s; chosen: both motions swing in 1.6 s and die out within two."""
HULL_PARTS = {"m": 3000.0, "I5": 9000.0, "c33": 9e4, "c35": -1e4, "c53": -1e4, "c55": 2.5e5}


def heave_pitch_rates(x: Array, force: Array) -> Array:
    """Linear heave and pitch by forces of waves (Salvesen, Tuck & Faltinsen 1970, eq. (1))."""
    z, z_dot, theta, theta_dot = x
    c, p = HULL, HULL_PARTS
    mass = [[p["m"] + c["a33"], c["a35"]], [c["a53"], p["I5"] + c["a55"]]]
    Z = force[0] - c["b33"] * z_dot - c["b35"] * theta_dot - p["c33"] * z - p["c35"] * theta
    M = force[1] - c["b53"] * z_dot - c["b55"] * theta_dot - p["c53"] * z - p["c55"] * theta
    heave, pitch = np.linalg.solve(mass, [Z, M])
    return np.array([z_dot, heave, theta_dot, pitch])


def wave_inputs(clock: Array, rng: np.random.Generator) -> Array:
    """Force and moment of eight waves of 1.5 to 6 rad/s [N, N m]."""
    omega, phase = np.linspace(1.5, 6.0, 8), rng.uniform(0.0, 2.0 * math.pi, (2, 8))
    return np.stack([
        size * np.sin(np.outer(clock, omega) + at).sum(axis=1) for size, at in zip((2e3, 4e3), phase, strict=True)
    ], axis=1)  # fmt: skip


def usv_inputs(clock: Array, rng: np.random.Generator) -> Array:
    """Steps of both thrusters, independent of one another, from rest."""
    ordered = steps((1.0, 1.0), (3, 8))(clock, rng)
    ordered[0] = 0.0
    return ordered


def none_moves(clock: Array, rng: np.random.Generator) -> Array:  # noqa: ARG001
    """Return no inputs."""
    return np.zeros((len(clock), 0))


_DEG = math.radians(1.0)
SHOWN = ("u", "v", "r", "psi", "x0", "y0")
CRAFTS = {
    "roll decay": Craft(
        "roll", roll_rates, ("phi", "p"), {"phi": 0.1 * _DEG}, (), none_moves, ROLL,
        ((15.0 * _DEG, 0.0), (-12.0 * _DEG, 0.0), (10.0 * _DEG, 0.0)), 30.0, 90.0, 5.0, {}, ("phi_0",),
    ),
    "Nomoto boat": Craft(
        "nomoto", nomoto_rates, ("r", "psi"), {"r": 0.2 * _DEG, "psi": 0.5 * _DEG}, ("delta",),
        steps((0.5,), (4, 10)), NOMOTO, ((0.0, 0.0), (0.0, 0.0)), 2.0, 200.0, 10.0, {},
    ),
    "USV with two thrusters": Craft(
        "thrusters", usv_rates, (*SHOWN, "", ""),
        {"u": 0.02, "v": 0.02, "r": _DEG, "psi": _DEG, "x0": 0.1, "y0": 0.1}, ("command_1", "command_2"),
        usv_inputs, USV, ((0.0,) * 8, (0.0,) * 8), 1.2, 200.0, 5.0, {},
    ),
    "waterjet": Craft(
        "waterjet", waterjet_rates, SHOWN,
        {"u": 0.02, "v": 0.02, "r": 0.1 * _DEG, "psi": 0.2 * _DEG, "x0": 0.5, "y0": 0.5}, ("delta", "v_j"),
        jet_inputs, WATERJET, ((5.0, 0.0, 0.0, 0.0, 0.0, 0.0), (5.0, 0.0, 0.0, 1.0, 0.0, 0.0)), 9.8, 250.0, 5.0, {},
        positive={"delta": "port"},
    ),
    "heave and pitch": Craft(
        "heave_pitch", heave_pitch_rates, ("z", "", "theta", ""), {"z": 0.005, "theta": 0.1 * _DEG}, ("F3", "M5"),
        wave_inputs, HULL, ((0.0,) * 4, (0.0,) * 4), 8.0, 120.0, 20.0, HULL_PARTS, fine=10,
        positive={"F3": "down", "M5": "bow up"},
    ),
    "MMG ship": Craft(
        "mmg", ship_rates, SHOWN,
        {"u": 0.05, "v": 0.05, "r": 0.02 * _DEG, "psi": 0.1 * _DEG, "x0": 1.0, "y0": 1.0}, ("delta", "n"),
        ship_inputs, SHIP, ((6.0, 0.0, 0.0, 0.0, 0.0, 0.0), (6.0, 0.0, 0.0, 1.0, 0.0, 0.0)), 100.0, 900.0, 1.0,
        SHIP_PARTS, step=0.05,
    ),
}  # fmt: skip


def record(craft: Craft, k: int, fault: Fault, rng: np.random.Generator) -> Record:
    """Return a run as its instruments show it: motion by splines through the samples of a fine simulation."""
    clock = np.arange(round(craft.duration * craft.rate) + 1) / craft.rate
    seed, part = rng.integers(2**32), 1.0 / (craft.rate * craft.fine)
    inputs = craft.inputs(clock, np.random.default_rng(seed))
    acting = inputs
    if craft.fine > 1:  # continuous ones by their middle over each part
        acting = craft.inputs((np.arange((len(clock) - 1) * craft.fine + 1) + 0.5) * part, np.random.default_rng(seed))
    states = simulated(craft.rates, list(craft.starts[k]), acting, part, craft.step)[:: craft.fine]
    true = {name: CubicSpline(clock, x) for name, x in zip(craft.states, states.T, strict=True) if name}
    shown = {name: shown_channel(name, true, clock, fault, craft.length) for name in craft.spread}
    if fault.wander and "x0" in shown:
        for name in ("x0", "y0"):
            shown[name] = shown[name] + wandering(fault.wander, clock, rng)
    for name, spread in craft.spread.items():
        shown[name] = shown[name] + spread * rng.standard_normal(len(clock))
    made = Record.from_arrays(f"run_{k}", clock, shown | dict(zip(craft.input_names, inputs.T, strict=True)))
    is_smooth = craft.model in ("mmg", "heave_pitch")
    known = {n: replace(made.channel(n), between="" if is_smooth else "held") for n in craft.input_names}
    held = {n: replace(c, positive=craft.positive.get(n, c.positive)) for n, c in known.items()}
    return replace(made, channels={**made.channels, **held})


def shown_channel(name: str, true: Mapping[str, CubicSpline], clock: Array, fault: Fault, length: float) -> Array:
    """Return what an instrument shows without noise."""
    if name in ("x0", "y0"):
        then = clock - fault.late
        arm = np.cos(true["psi"](then)) if name == "x0" else np.sin(true["psi"](then))
        return np.asarray(true[name](then) + fault.lever * length * arm)
    if name == "psi" and fault.heading_filter:
        return filtered(true[name], clock, fault.heading_filter)
    if name == "r":
        return np.asarray((1.0 + fault.scale) * true[name](clock) + fault.bias)
    return np.asarray(true[name](clock))


def filtered(values: CubicSpline, clock: Array, constant: float) -> Array:
    """Return values behind a filter of first order, in steps of a fiftieth of a sample, settled where they begin."""
    fine = 50
    h = (clock[1] - clock[0]) / fine
    shown, y = np.empty(len(clock)), float(values(clock[0])) - constant * float(values(clock[0], 1))
    keep = math.exp(-h / constant)
    for k, start in enumerate(clock):
        shown[k] = y
        for value in values(start + h * (np.arange(fine) + 0.5)):
            y = keep * y + (1.0 - keep) * value
    return shown


def wandering(size: float, clock: Array, rng: np.random.Generator) -> Array:
    """Return an error of first order with a memory of `MEMORY`, (rows,)."""
    keep = math.exp(-(clock[1] - clock[0]) / MEMORY)
    error = size * rng.standard_normal(len(clock))
    for k in range(1, len(clock)):
        error[k] = keep * error[k - 1] + math.sqrt(1.0 - keep**2) * error[k]
    return error


def posed(craft: Craft, fault: Fault, seed: int) -> Trial:
    """Return the trial of a craft's logs by a user who states nothing of the fault, but that the inputs are on time."""
    model = model_named(craft.model)
    sizes = {n: v for n, v in craft.held.items() if n in model.parameters}
    model = model.with_values(sizes, source="measured")
    if craft.model in ("mmg", "heave_pitch"):  # which have no values of their own
        model = model.with_values({n: 0.8 * v for n, v in craft.truth.items()})
    model = model.with_parameters(model.parameters.only_free([*craft.truth, *craft.freed]))
    rng = np.random.default_rng([seed, round(10 * craft.rate)])
    runs = tuple(Run(record(craft, k, fault, rng)) for k in range(len(craft.starts)))
    settings = EstimateSettings().with_known_timing(model.input_names)
    return Trial(Ship(craft.model, {"L": craft.length}), runs, model, settings)


NAMING = ("sensor-error", "input-delay", "antenna-place", "contradiction", "not-white", "not-converged")
"""Findings that a user may take for the cause, or that say that there is one."""


@dataclass(frozen=True)
class Cell:
    """Share of intervals that hold the truth, their count, the largest error in half widths, findings, and CPU s."""

    held: float
    count: int
    largest: float
    findings: Mapping[str, int]
    seconds: float

    def __str__(self) -> str:
        said = ", ".join(f"{code} {n}" for code, n in self.findings.items()) or "none"
        return (
            f"{100.0 * self.held:.0f} % of {self.count} intervals, largest error {self.largest:.2f} half widths, "
            f"{self.seconds:.0f} s; findings: {said}"
        )


def cell(craft: Craft, fault: Fault, seeds: range) -> Cell:
    """Return what the fits of some seeds come to; an interval that is not given holds the truth."""
    away, said, began = [], Counter[str](), time.process_time()
    for seed in seeds:
        try:
            fit = identify(posed(craft, fault, seed))
        except InputError as error:  # the checks name what is wrong, and the edit
            said[f"refused: {error}"] += 1
            continue
        said.update({f.code for f in fit.findings if f.code in NAMING or "converge" in f.message})
        for c in fit.coefficients:
            if c.name in craft.truth and c.lower is not None and c.upper is not None:
                away.append(abs(c.estimate - craft.truth[c.name]) / (0.5 * (c.upper - c.lower)))
    seconds = (time.process_time() - began) / len(seeds)
    held, largest = (float(np.mean(np.array(away) <= 1.0)), max(away)) if away else (1.0, 0.0)
    return Cell(held, len(away), largest, dict(said), seconds)


def cells(words: str = "") -> list[tuple[str, Craft, Fault]]:
    """Return the cells whose names hold the words: a fault belongs to a craft that records what it touches."""
    found = []
    for name, craft in CRAFTS.items():
        for said, fault in FAULTS.items():
            touched = {"x0"} if fault.late or fault.lever or fault.wander else {"psi"} if fault.heading_filter else (
                {"r"} if fault.bias or fault.scale else set()
            )  # fmt: skip
            if touched <= craft.spread.keys() and words in (title := f"{name}, {said}"):
                found.append((title, craft, fault))
    return found


LEAST_POOLED = 0.85
"""Of the 16 intervals of the short sample and its faults, 95 % each: two standard errors below; chosen."""


def run() -> list[Line]:
    """Return the coverage of the roll decay and the Nomoto boat with one seed."""
    lines, counts = [], []
    for title, craft, fault in cells():
        if craft.model in ("roll", "nomoto"):
            made = cell(craft, fault, range(1))
            counts.append((made.held * made.count, made.count))
            lines.append(Line(f"{title}, intervals that hold the truth", made.held, "1"))
    held, count = np.sum(counts, axis=0)
    return [*lines, at_least("roll decay and boat, intervals that hold the truth", held / count, "1", LEAST_POOLED)]


def main(seeds: int, words: str) -> None:
    """Print a line for each cell, and the pooled share."""
    held = count = 0.0
    for title, craft, fault in cells(words):
        made = cell(craft, fault, range(seeds))
        held, count = held + made.held * made.count, count + made.count
        print(f"{title}: {made}", flush=True)
    print(f"all: {100.0 * held / count:.1f} % of {count:.0f} intervals hold the truth")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 20, sys.argv[2] if len(sys.argv) > 2 else "")
