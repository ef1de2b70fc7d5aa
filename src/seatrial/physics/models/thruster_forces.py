"""Force of one thruster: command, lag, curve, loss with speed, direction; and of the rudder behind it."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import sympy as sp

from seatrial.core.equations import Sheet
from seatrial.physics.models.forces import YASUKAWA, PlanarForce, RudderCoefficients, RudderFlow, normal_force
from seatrial.physics.models.thruster_layout import (
    MIN_DELAY,
    MIN_LAG,
    AngleInput,
    Rudder,
    ThrustCurve,
    Thruster,
    ThrusterLayout,
)

# Rudders behind the screws of a craft with thrusters, by the rudder of the MMG method.

Coefficient = Callable[..., sp.Symbol]

# start value by Yasukawa & Yoshimura 2015, table 3 (gamma_R: between its two sides), meaning, and whether it is free
_COEFFICIENTS = {
    "epsilon": (1.09, "wake ratio, rudder over propeller", False),
    "kappa": (0.5, "slipstream acceleration at the rudder", False),
    "kappa_astern": (0.0, "flow at the rudder over n D, propeller astern", False),
    "gamma_R": (0.5, "flow straightening", True),
    "l_R_prime": (-0.71, "effective position of the rudder over L", False),
    "t_R": (0.387, "steering resistance deduction", False),
    "a_H": (0.312, "rudder force increase", False),
    "x_H_prime": (-0.464, "position of the additional force over L", False),
}
_SCALE = 0.05
"""Size of a dimensionless coefficient that counts; chosen."""


@dataclass(frozen=True)
class Screw:
    """The propeller ahead of a rudder: rate, rate times diameter, diameter, axial inflow, own thrust, water density."""

    n: sp.Expr
    n_D: sp.Symbol
    D: sp.Symbol
    u_P: sp.Symbol
    thrust: sp.Symbol
    rho: sp.Symbol


@dataclass(frozen=True)
class CraftFlow:
    """Speed, drift angle, yaw rate times length, length, and the speed below which denominators are rounded off."""

    U: sp.Symbol
    beta: sp.Symbol
    r_L: sp.Symbol
    L: sp.Symbol
    U_0: sp.Symbol


def craft_flow(sheet: Sheet, u: sp.Symbol, v: sp.Symbol, r: sp.Symbol, L: sp.Symbol, U_0: sp.Symbol) -> CraftFlow:
    """Write speed and drift angle of the craft as rudders and wind take them."""
    ahead = sheet.bind("u_0", sp.sqrt(u**2 + U_0**2), "rounded off at rest", "m/s")
    return CraftFlow(
        sheet.bind("U", sp.sqrt(u**2 + v**2 + U_0**2), f"{YASUKAWA}, speed U", "m/s"),
        sheet.bind("beta", -sp.atan(v / ahead), f"{YASUKAWA}, drift angle", "rad"),
        sheet.bind("r_L", L * r, "r' U", "m/s"), L, U_0,
    )  # fmt: skip


def lift_gradient(rudder: Rudder) -> float:
    """Return the slope of the normal force coefficient, 6.13 A / (A + 2.25) with aspect ratio A (Fujii & Tuda 1961)."""
    aspect = rudder.span**2 / rudder.area
    return 6.13 * aspect / (aspect + 2.25)  # Fujii & Tuda 1961, dimensionless fit to rudders


def rudder_force(
    sheet: Sheet, thruster: Thruster, rudder: Rudder, delta: sp.Symbol, screw: Screw, flow: CraftFlow,
    coefficient: Coefficient,
) -> PlanarForce:  # fmt: skip
    """Write the force of the rudder behind one screw.

    coefficient: declares one that thrusters may share (symbol, value, unit, meaning, and whether it is free).
    """
    name, suffix = thruster.name, f"_{thruster.name}"
    A_R = sheet.parameter(f"A_R_{name}", rudder.area, "m^2", f"movable area of the rudder behind '{name}'", "layout")
    H_R = sheet.parameter(f"H_R_{name}", rudder.span, "m", f"span of the rudder behind '{name}'", "layout")
    x_R = sheet.parameter(f"x_R_{name}", rudder.x, "m", f"place of the rudder behind '{name}' forward", "layout")
    f_alpha = coefficient(
        "f_alpha", lift_gradient(rudder), "1", "gradient of the rudder's lift", lower=0.0, scale=_SCALE
    )
    c = {
        symbol: coefficient(symbol, value, "1", meaning, free=free, scale=_SCALE)
        for symbol, (value, meaning, free) in _COEFFICIENTS.items()
    }
    coefficients = RudderCoefficients(
        A_R, H_R, f_alpha, c["epsilon"], c["kappa"], c["kappa_astern"], c["gamma_R"], c["gamma_R"], c["l_R_prime"]
    )
    past = RudderFlow(
        flow.U, flow.beta, flow.r_L, flow.U_0, screw.rho, screw.n, screw.n_D, screw.D, screw.u_P, screw.thrust
    )
    force = normal_force(sheet, past, coefficients, delta, suffix)
    F_C = sheet.bind(f"F_C{suffix}", force.F_N * force.cosine, "athwartships part of the normal force", "N")
    source = f"{YASUKAWA}, rudder forces"
    X = sheet.bind(f"X_R{suffix}", -(1 - c["t_R"]) * force.F_N * force.sine, source, "N")
    Y = sheet.bind(f"Y_R{suffix}", -(1 + c["a_H"]) * F_C, source, "N")
    y = sp.Symbol(f"y_{name}", real=True)
    N = -(x_R + c["a_H"] * c["x_H_prime"] * flow.L) * F_C - y * X
    return PlanarForce(
        X, Y, sheet.bind(f"N_R{suffix}", N, f"{source}; the side of a rudder off the centre line", "N m")
    )


# Force of one thruster: command, lag, curve, loss with speed through the water, direction.

FOSSEN_THRUST = "Fossen 2021, section 9.2, thrust configuration"
FOSSEN_PROPELLER = "Fossen 2021, eq. (9.5), T = rho D^4 K_T(J) n |n|"
CURVE = "four-quadrant curve fitted to field records (docs/thrusters.md)"
LAG = "Fossen 2021, section 9.8, actuator of first order; time constants up and down"
DELAY = "delay as two equal time constants in a row, which delay by their sum"

_EXPONENT = {ThrustCurve.QUADRATIC: 2, ThrustCurve.LINEAR: 1}
_LAG_FACTOR = 25.0  # largest over starting time constant, chosen: beyond, a lag is a constant
_CHANGEOVER = 0.3
"""Command over its gap to the order about which spinning down changes to spinning up: wide enough that steps of a third
of a time constant resolve it; a sharper one gives the likelihood false optima (benchmarks/thrusters_truth.py)."""
_NO_GAP = 1e-12  # shares of full command to the fourth, which keep the changeover finite where order and command agree
_EXPONENT_START, _EXPONENTS = 1.5, (1.0, 4.0)
"""Exponent of a power curve where a search starts, and its bounds: from a linear one to far beyond a square; chosen."""
_OPEN_WATER = (0.4, -0.3, -0.1)
"""K_T polynomial in J where a search starts: a Wageningen B propeller of pitch ratio 0.9, roughly; chosen."""
_OPEN_WATER_ASTERN = -0.25
"""K_T astern where a search starts, two thirds of that ahead; chosen."""
_DIMENSIONLESS = 0.05
"""Size of a dimensionless coefficient that counts; chosen."""
_THRUST = 1.0  # N for each kg of M_u at full command, start: a craft that gains 1 m/s in a second; chosen


@dataclass(frozen=True)
class Water:
    """Velocity through the water and what else thrust depends on."""

    u: sp.Symbol
    v: sp.Symbol
    r: sp.Symbol
    voltage: sp.Expr


class ThrusterSheet:
    """Writes the thrusters of a layout on a sheet; thrusters that share coefficients declare them once."""

    def __init__(self, sheet: Sheet, layout: ThrusterLayout) -> None:
        self.sheet, self.layout = sheet, layout
        self._coefficients: dict[str, sp.Symbol] = {}
        self._inputs: dict[str, sp.Symbol] = {}
        self._screws: dict[str, Screw] = {}

    def force(self, thruster: Thruster, water: Water) -> PlanarForce:
        """Write command, direction, inflow, thrust and force of a thruster."""
        name, sheet = thruster.name, self.sheet
        share = self._share_of_full(thruster)
        a = self._direction(thruster)
        x = sheet.parameter(f"x_{name}", thruster.x, "m", f"place of '{name}' forward of the origin", "layout")
        y = sheet.parameter(f"y_{name}", thruster.y, "m", f"place of '{name}' to starboard", "layout")
        cosine = sheet.bind(f"cos_{name}", sp.cos(a), FOSSEN_THRUST)
        sine = sheet.bind(f"sin_{name}", sp.sin(a), FOSSEN_THRUST)
        w = sheet.bind(
            f"w_{name}", (water.u - y * water.r) * cosine + (water.v + x * water.r) * sine,
            "speed through the water along the thruster", "m/s",
        )  # fmt: skip
        T = sheet.output(f"T_{name}", self._thrust(thruster, share, w) * water.voltage, CURVE, "N")
        X = sheet.bind(f"X_{name}", T * cosine, FOSSEN_THRUST, "N")
        Y = sheet.bind(f"Y_{name}", T * sine, FOSSEN_THRUST, "N")
        return PlanarForce(X, Y, sheet.bind(f"N_{name}", x * Y - y * X, FOSSEN_THRUST, "N m"))

    def rudder_forces(self, flow: CraftFlow) -> list[PlanarForce]:
        """Write the forces of the rudders behind screws, whose thrusters are written already."""
        return [
            rudder_force(
                self.sheet, thruster, thruster.rudder, self._input(thruster.rudder.channel),
                self._screws[thruster.name], flow, partial(self._coefficient, thruster),
            )
            for thruster in self.layout.thrusters
            if thruster.rudder is not None
        ]  # fmt: skip

    def _coefficient(
        self, thruster: Thruster, symbol: str, value: float, unit: str, meaning: str, *,
        free: bool = True, lower: float = -math.inf, upper: float = math.inf, scale: float = 0.0,
    ) -> sp.Symbol:  # fmt: skip
        name = symbol + self.layout.suffix(thruster)
        if name not in self._coefficients:
            self._coefficients[name] = self.sheet.parameter(
                name, value, unit, meaning, CURVE, free=free, lower=lower, upper=upper, scale=scale
            )
        return self._coefficients[name]

    def _input(self, channel: str) -> sp.Symbol:
        if channel not in self._inputs:
            self._inputs[channel] = self.sheet.input(channel)
        return self._inputs[channel]

    def _share_of_full(self, thruster: Thruster) -> sp.Expr:
        """The command as a share of full command, behind its lag."""
        name, command, sheet = thruster.name, thruster.command, self.sheet
        zero = sheet.parameter(f"zero_{name}", command.zero, meaning="command at rest", source="layout", scale=0.02)
        span = sheet.parameter(f"span_{name}", command.span, meaning="full command from there", source="layout")
        order = sheet.bind(f"order_{name}", (self._input(command.channel) - zero) / span, "share of full command")
        if thruster.delay:
            order = self._delayed(thruster, order)
        if not thruster.lag:
            return order
        lag = self.layout.leader(thruster).lag
        upper = _LAG_FACTOR * lag
        tau, down = (
            self._coefficient(thruster, symbol, lag, "s", meaning, lower=MIN_LAG, upper=upper)
            for symbol, meaning in (("tau", "time constant of spinning up"), ("tau_down", "of spinning down"))
        )
        (c,) = sheet.states(f"c_{name}")
        gap = sheet.bind(f"gap_{name}", order - c, LAG)
        growth = sheet.bind(f"growth_{name}", gap * c, LAG)
        up = sheet.bind(
            f"up_{name}", (1 + growth / sp.sqrt(growth**2 + (_CHANGEOVER * gap**2) ** 2 + _NO_GAP)) / 2, LAG
        )
        sheet.rate(c, gap / (down + (tau - down) * up), LAG)
        return c

    def _delayed(self, thruster: Thruster, order: sp.Symbol) -> sp.Symbol:
        name, delay = thruster.name, self.layout.leader(thruster).delay
        half = self._coefficient(
            thruster, "delay", delay, "s", "delay of the command", lower=MIN_DELAY, upper=_LAG_FACTOR * delay
        ) / 2  # fmt: skip
        first, last = self.sheet.states(f"late_1_{name} late_2_{name}")
        self.sheet.rate(first, (order - first) / half, DELAY)
        self.sheet.rate(last, (first - last) / half, DELAY)
        return last

    def _direction(self, thruster: Thruster) -> sp.Expr:
        name, sheet = thruster.name, self.sheet
        if not isinstance(thruster.angle, AngleInput):
            return sheet.parameter(
                f"angle_{name}", thruster.angle, "rad", f"direction of '{name}'", "layout", scale=_DIMENSIONLESS
            )
        ordered = self._input(thruster.angle.channel)
        if not thruster.angle.lag:
            return ordered
        lag = self._coefficient(
            thruster, "tau_a", thruster.angle.lag, "s", "time constant of turning", lower=MIN_LAG,
            upper=_LAG_FACTOR * thruster.angle.lag,
        )  # fmt: skip
        (a,) = sheet.states(f"a_{name}")
        rate = sheet.bind(f"turn_{name}", (ordered - a) / lag, LAG, "rad/s")
        if thruster.angle.rate is not None:
            most = sheet.parameter(f"rate_{name}", thruster.angle.rate, "rad/s", f"fastest turn of '{name}'", "layout")
            rate = sp.Piecewise((most, rate > most), (-most, rate < -most), (rate, True))
        sheet.rate(a, rate, LAG)
        return a

    def _thrust(self, thruster: Thruster, c: sp.Expr, w: sp.Symbol) -> sp.Expr:
        if thruster.curve is ThrustCurve.OPEN_WATER:
            return self._open_water(thruster, c, w)
        ahead = self._still_knots(thruster, c) if thruster.curve is ThrustCurve.KNOTS else self._still(thruster, c)
        loss = self._coefficient(
            thruster, "k_J", 0.0, "N^0.5 s/m", "loss of thrust with speed ahead", scale=0.1, lower=0
        )
        decay = self._coefficient(
            thruster, "k_4", 0.0, "s^2/m^2", "loss of thrust astern with speed", scale=0.02, lower=0
        )
        root = self.sheet.bind(
            f"root_{thruster.name}", sp.Piecewise((sp.sqrt(ahead), ahead > 0), (0, True)), CURVE, "N^0.5"
        )
        return sp.Piecewise((ahead - loss * root * w, c > 0), (ahead * sp.exp(-decay * w**2), True))

    def _still(self, thruster: Thruster, c: sp.Expr) -> sp.Symbol:
        """Thrust in water at rest: powers of the share of full command beyond the dead band."""
        leader = self.layout.leader(thruster)
        dead = self._coefficient(
            thruster, "dead", leader.dead_band, "1", "share of full command without thrust", free=False, lower=0.0,
            upper=0.5,
        )  # fmt: skip
        start = _THRUST * self.layout.mass
        k = [
            self._coefficient(
                thruster,
                f"k_{way}",
                bollard or start,
                "N",
                f"thrust at full command {text}",
                lower=0.0,
                free=not bollard,
            )
            for way, text, bollard in (("f", "ahead", leader.bollard), ("b", "astern", 0.0))
        ]
        excess = self.sheet.bind(f"m_{thruster.name}", (sp.Abs(c) - dead) / (1 - dead), CURVE)
        p: list[sp.Expr] = [sp.Integer(_EXPONENT.get(thruster.curve, 0))] * 2
        if thruster.curve is ThrustCurve.POWER:
            p = [
                self._coefficient(
                    thruster,
                    f"p_{way}",
                    _EXPONENT_START,
                    "1",
                    f"exponent {text}",
                    lower=_EXPONENTS[0],
                    upper=_EXPONENTS[1],
                )
                for way, text in (("f", "ahead"), ("b", "astern"))
            ]
        thrust = sp.Piecewise((0, excess <= 0), (k[0] * excess ** p[0], c > 0), (-k[1] * excess ** p[1], True))
        return self.sheet.bind(f"still_{thruster.name}", thrust, CURVE, "N")

    def _still_knots(self, thruster: Thruster, c: sp.Expr) -> sp.Symbol:
        """Thrust in water at rest, straight between its values at the knots, the last slopes beyond them."""
        knots = thruster.knots
        values = [
            sp.Integer(0) if knot == 0.0 else self._coefficient(
                thruster, f"T_{i}", _THRUST * self.layout.mass * knot * abs(knot), "N", f"thrust at {knot:g} of full",
                scale=_DIMENSIONLESS * self.layout.mass,
            )
            for i, knot in enumerate(knots)
        ]  # fmt: skip
        pieces = []
        for i in range(len(knots) - 1):
            slope = (values[i + 1] - values[i]) / sp.Float(knots[i + 1] - knots[i])
            within = c < knots[i + 1] if i < len(knots) - 2 else True
            pieces.append((values[i] + slope * (c - sp.Float(knots[i])), within))
        return self.sheet.bind(f"still_{thruster.name}", sp.Piecewise(*pieces), CURVE, "N")

    def _open_water(self, thruster: Thruster, n: sp.Expr, w: sp.Symbol) -> sp.Expr:
        """Thrust of a propeller at n [rps]: a polynomial K_T(J) ahead, a constant K_T astern."""
        sheet, name = self.sheet, thruster.name
        D = sheet.parameter(f"D_{name}", thruster.diameter, "m", "propeller diameter", "layout")
        rho_t = self._coefficient(thruster, "rho_P", 1025.0, "kg/m^3", "density over the mass scale M_u", free=False)
        wake = self._coefficient(thruster, "w_P", 0.0, "1", "wake fraction", free=False, scale=0.1, upper=0.9)
        deduction = self._coefficient(thruster, "t_P", 0.0, "1", "thrust deduction", free=False, scale=0.1, upper=0.9)
        k = [
            self._coefficient(
                thruster, f"k_{i}", value, "1", f"K_T polynomial, J^{i}", scale=_DIMENSIONLESS, free=i < 2
            )
            for i, value in enumerate(_OPEN_WATER)
        ]
        back = self._coefficient(
            thruster, "k_0_astern", _OPEN_WATER_ASTERN, "1", "K_T astern", scale=_DIMENSIONLESS, upper=0.0
        )
        nD = sheet.bind(f"nD_{name}", n * D, FOSSEN_PROPELLER, "m/s")
        V = sheet.bind(f"V_{name}", w * (1 - wake), FOSSEN_PROPELLER, "m/s")
        K = sp.Piecewise((nD * (k[0] * nD + k[1] * V) + k[2] * V * sp.Abs(V), nD > 0), (back * nD**2, True))
        open_water = sheet.bind(f"own_{name}", rho_t * D**2 * K, FOSSEN_PROPELLER, "N")
        self._screws[name] = Screw(n, nD, D, V, open_water, rho_t)
        return (1 - deduction) * open_water
