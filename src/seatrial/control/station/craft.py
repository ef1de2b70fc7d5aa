"""A craft that keeps its station: thrusters, allocation of forces to them, and what they can hold."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from seatrial.control.ship import jacobian_at
from seatrial.core.equations import Model
from seatrial.core.results.station import StationCapability, StationThruster
from seatrial.core.values import Array, InputError
from seatrial.physics.models.thrust_orders import (
    inertia_matrix,
    thrust_configuration,
    with_outside_forces,
)
from seatrial.physics.models.thruster_layout import AngleInput, Thruster, ThrusterLayout, layout_of

# A craft with thrusters at rest, as station keeping needs it: matrices, thrusters with their limits, lags.

_SHARES = 201  # of full command at which thrust is tabled; chosen
_ACROSS = 0.5 * np.pi  # rad: direction of the second component of an azimuth thruster's thrust
_WEAKEST = 0.02  # of the largest singular value of B, scaled, below which a direction counts as not driven; chosen
_AXES = ("surge", "sway", "yaw")
_OWN_CURRENT = ("current_north", "current_east")
_VELOCITIES = ("u", "v", "r")


@dataclass(frozen=True, eq=False)
class ThrustTable:
    """One thruster in water at rest: share of full command (n,), rising, over thrust (n,) from astern to ahead.

    Thrust is in the unit of force of the model, N or N for each kg of M_u. A dead band is a step of the share at 0.
    """

    share: Array
    thrust: Array

    @property
    def least(self) -> float:
        """The thrust full astern, zero or negative."""
        return float(self.thrust[0])

    @property
    def most(self) -> float:
        """The thrust full ahead."""
        return float(self.thrust[-1])


@dataclass(frozen=True, eq=False)
class StationCraft:
    """A craft with thrusters on station.

    model: identified, of a layout; covariance: of its free parameters (k, k) or (0, 0); limit: share of full command
    that may be used.
    """

    model: Model
    covariance: Array
    limit: float = 1.0

    @cached_property
    def layout(self) -> ThrusterLayout:
        """The thrusters."""
        return layout_of(self.model)

    @property
    def thrusters(self) -> tuple[Thruster, ...]:
        """The thrusters, in the order of the layout."""
        return self.layout.thrusters

    @property
    def force_unit(self) -> str:
        """N, or N/kg where no thrust is known in newtons."""
        return "N" if self.layout.has_bollard else "N/kg"

    @property
    def lever(self) -> float:
        """Half the length [m]: a yaw error counts as what it moves the ends of the hull."""
        return 0.5 * self.layout.length

    @cached_property
    def pushed_model(self) -> Model:
        """The model with inputs for forces from outside."""
        return with_outside_forces(self.model)

    @cached_property
    def inertia(self) -> Array:
        """M (3, 3)."""
        return inertia_matrix(self.model)

    @cached_property
    def damping(self) -> Array:
        """D (3, 3), linear damping in water at rest: that of the model's Jacobian."""
        slopes = jacobian_at(self.model, np.zeros((1, len(self.model.states))), self.resting_inputs, of_outputs=False)
        rows = [self.model.states.index(name) for name in _VELOCITIES]
        return np.asarray(-self.inertia @ slopes[0][np.ix_(rows, rows)], dtype=np.float64)

    @cached_property
    def is_azimuth(self) -> tuple[bool, ...]:
        """Whether each thruster turns."""
        return tuple(isinstance(t.angle, AngleInput) for t in self.thrusters)

    @cached_property
    def owner(self) -> tuple[int, ...]:
        """Of each column of `configuration` its thruster: an azimuth thruster has two, ahead and to starboard."""
        return tuple(i for i, turns in enumerate(self.is_azimuth) for _ in range(2 if turns else 1))

    @cached_property
    def configuration(self) -> Array:
        """B (3, m): surge, sway and yaw of unit thrust of each component (Fossen 2021, section 9.2)."""
        thrusters, angles = [self.thrusters[i] for i in self.owner], list[float]()
        for thruster in self.thrusters:
            angles += [0.0, _ACROSS] if isinstance(thruster.angle, AngleInput) else [thruster.angle]
        return thrust_configuration(self.model, thrusters, angles)

    @cached_property
    def tables(self) -> tuple[ThrustTable, ...]:
        """Share of full command over thrust of each thruster within the limit, in water at rest."""
        return tuple(self._table(t, turns) for t, turns in zip(self.thrusters, self.is_azimuth, strict=True))

    @cached_property
    def lags(self) -> Array:
        """Time constant of each component of `configuration` [s], (m,): of thrust, and of turning for azimuths."""
        return np.array([
            max(self._lag(i, "tau"), self._lag(i, "tau_down")) + (self._lag(i, "tau_a") if self.is_azimuth[i] else 0.0)
            for i in self.owner
        ])  # fmt: skip

    @property
    def delay(self) -> float:
        """The longest delay of a thruster's command [s]."""
        return max(self._coefficient(t, "delay") if t.delay else 0.0 for t in self.thrusters)

    @cached_property
    def resting_inputs(self) -> Array:
        """Inputs (nu,) with all commands at rest, azimuths ahead, nominal voltage, still air."""
        values = dict.fromkeys(self.model.input_names, 0.0) | {
            t.command.channel: t.command.zero for t in self.thrusters
        }
        if "voltage" in values:
            values["voltage"] = self.model.parameters["V_0"].value
        return np.array(list(values.values()), dtype=np.float64)

    def in_current(self, speed: float, direction: float) -> Array:
        """Return the state (nx,) of the craft kept in a current [m/s] from a direction off the bow [rad]."""
        state = np.zeros(len(self.model.states))
        state[self.model.states.index("u")] = speed * math.cos(direction)
        state[self.model.states.index("v")] = speed * math.sin(direction)
        return state

    def ordered(self, state: Array, thrust: Array) -> tuple[Array, Array]:
        """Return state (nx,) and inputs (nu,) with the thrust of each component (m,) ordered and settled."""
        settled, inputs = state.copy(), self.resting_inputs.copy()
        states, channels = self.model.states, self.model.input_names

        def put(values: Array, names: Sequence[str], name: str, value: float) -> None:
            if name in names:
                values[names.index(name)] = value

        for i, thruster in enumerate(self.thrusters):
            parts, command = thrust[[k for k, owner in enumerate(self.owner) if owner == i]], thruster.command
            if isinstance(thruster.angle, AngleInput):
                angle, size = math.atan2(parts[1], parts[0]), math.hypot(*parts)
                put(settled, states, f"a_{thruster.name}", angle)
                put(inputs, channels, thruster.angle.channel, angle)
            else:
                size = float(parts[0])
            share = float(np.interp(size, self.tables[i].thrust, self.tables[i].share))
            for name in ("c", "late_1", "late_2"):
                put(settled, states, f"{name}_{thruster.name}", share)
            put(inputs, channels, command.channel, command.zero + command.span * share)
        return settled, inputs

    def with_values(self, values: dict[str, float]) -> "StationCraft":
        """Return the craft with other parameters."""
        return replace(self, model=without_current(self.model.with_values(values)))

    def _coefficient(self, thruster: Thruster, symbol: str) -> float:
        return self.model.parameters.value_of(symbol + self.layout.suffix(thruster), 0.0)

    def _lag(self, place: int, symbol: str) -> float:
        thruster = self.thrusters[place]
        has_it = thruster.lag if symbol != "tau_a" else isinstance(thruster.angle, AngleInput) and thruster.angle.lag
        return self._coefficient(thruster, symbol) if has_it else 0.0

    def _table(self, thruster: Thruster, turns: bool) -> ThrustTable:
        model = self.model
        even = np.linspace(0.0 if turns else -1.0, 1.0, _SHARES)
        share = self.limit * even * np.abs(even)  # close about zero, where the inverse of most curves is steep
        states, inputs = np.zeros((_SHARES, len(model.states))), np.tile(self.resting_inputs, (_SHARES, 1))
        if f"c_{thruster.name}" in model.states:
            states[:, model.states.index(f"c_{thruster.name}")] = share
        command = thruster.command
        inputs[:, model.input_names.index(command.channel)] = command.zero + command.span * share
        return ThrustTable(share, np.maximum.accumulate(model.forces(states, inputs)[f"T_{thruster.name}"]))


def without_current(model: Model) -> Model:
    """Return the model in water at rest: on station the water's motion is that of the demand."""
    return model.with_values({name: 0.0 for name in _OWN_CURRENT if name in model.parameters})


def refuse_under_actuated(craft: StationCraft) -> None:
    """Refuse a craft that has no thrust in some direction: position and heading need surge, sway and yaw.

    Raises:
        InputError: what is not driven, by which thrusters.
    """
    arm = np.array([1.0, 1.0, 1.0 / craft.lever])
    most = np.array([max(table.most, -table.least) for table in craft.tables])[list(craft.owner)]
    scaled = arm[:, None] * craft.configuration * most / most.max()
    axes, sizes, _ = np.linalg.svd(scaled, full_matrices=True)
    sizes = np.concatenate([sizes, np.zeros(3 - len(sizes))])
    if sizes[2] > _WEAKEST * sizes[0]:
        return
    missing = _AXES[int(np.argmax(np.abs(axes[:, 2])))]
    names = ", ".join(f"'{t.name}'" for t in craft.thrusters)
    raise InputError(
        f"station: thrusters {names} give no {missing} of their own, and so keep heading, speed and track, but no "
        "position; leave [station] out, or add one that pushes sideways (tunnel, azimuth, or set at an angle)"
    )


# Forces shared out over thrusters: by a weighted generalised inverse in the loop; what is possible by programming.

_SIDES = 32  # of the polygon inside the circle of an azimuth thruster's thrust: 0.5 % short of it; chosen
_AT_LIMIT = 1e-6  # share of a thruster's range within which it counts as at its limit: of the linear programme


def weights(craft: StationCraft) -> Array:
    """Return the largest thrust of each column of B, (m,): ahead or astern, whichever is larger."""
    return np.array([max(t.most, -t.least) for t in craft.tables])[list(craft.owner)]


def generalised_inverse(craft: StationCraft) -> Array:
    """Return the matrix (m, 3) that shares out a force with the least sum of (T_i / T_max,i)^2."""
    B, spread = craft.configuration, weights(craft) ** 2
    return spread[:, None] * B.T @ np.linalg.inv(B @ (spread[:, None] * B.T))


def thruster_orders(craft: StationCraft, inverse: Array) -> tuple[StationThruster, ...]:
    """Return how a controller orders each thruster: by its rows of an inverse (m, 3) and its table."""
    owner = np.array(craft.owner)
    return tuple(
        StationThruster(thruster.name, inverse[owner == i], table.share, table.thrust)
        for i, (thruster, table) in enumerate(zip(craft.thrusters, craft.tables, strict=True))
    )


def share_given(craft: StationCraft, inverse: Array, forces: Array) -> Array:
    """Return the share of each force (n, 3) that the generalised inverse gives within the limits, (n,)."""
    T = forces @ inverse.T
    share = np.full(len(forces), np.inf)
    for i, table in enumerate(craft.tables):
        components = [k for k, owner in enumerate(craft.owner) if owner == i]
        with np.errstate(divide="ignore"):
            if craft.is_azimuth[i]:
                given = table.most / np.linalg.norm(T[:, components], axis=1)
            else:
                given = np.where(T[:, components[0]] > 0.0, table.most, -table.least) / np.abs(T[:, components[0]])
        share = np.minimum(share, given)
    return share


def largest_force(craft: StationCraft, force: Array) -> tuple[float, tuple[str, ...]]:
    """Return how many times a force (3,) the thrusters give at most, by linear programming; exact for fixed thrusters.

    With the factor the thrusters at their limits. The circle of an azimuth thruster's thrust is a polygon inside it.
    """
    from scipy.optimize import linprog

    m, owner = len(craft.owner), craft.owner
    limits, bounds = [], []
    for i, table in enumerate(craft.tables):
        components = [k for k, index in enumerate(owner) if index == i]
        if not craft.is_azimuth[i]:
            bounds.append((table.least, table.most))
            continue
        bounds += [(None, None)] * 2
        for angle in 2.0 * np.pi * (np.arange(_SIDES) + 0.5) / _SIDES:
            row = np.zeros(m + 1)
            row[components] = np.cos(angle), np.sin(angle)
            limits.append((row, table.most * np.cos(np.pi / _SIDES)))
    cost = np.zeros(m + 1)
    cost[m] = -1.0
    scale = np.array([1.0, 1.0, 1.0 / craft.lever])
    equal = scale[:, None] * np.column_stack([craft.configuration, -force])
    optimum = linprog(
        cost, A_ub=np.array([row for row, _ in limits]) if limits else None,
        b_ub=np.array([most for _, most in limits]) if limits else None,
        A_eq=equal, b_eq=np.zeros(3), bounds=[*bounds, (0.0, None)], method="highs",
    )  # fmt: skip
    if optimum.x is None:
        return 0.0, ()
    return float(optimum.x[m]), _at_limit(craft, optimum.x[:m])


def _at_limit(craft: StationCraft, T: Array) -> tuple[str, ...]:
    names = []
    for i, (thruster, table) in enumerate(zip(craft.thrusters, craft.tables, strict=True)):
        thrust = T[[k for k, owner in enumerate(craft.owner) if owner == i]]
        slack = _AT_LIMIT * (table.most - table.least)
        size = float(np.linalg.norm(thrust)) if craft.is_azimuth[i] else float(thrust[0])
        most = table.most * np.cos(np.pi / _SIDES) if craft.is_azimuth[i] else table.most
        if size >= most - slack or (not craft.is_azimuth[i] and size <= table.least + slack):
            names.append(thruster.name)
    return tuple(names)


# What thrusters hold at most, by direction off the bow: a steady current, a force; static, as capability plots are.

_DIRECTIONS = 24  # every 15 degrees; chosen
_FIRST, _FASTEST = 0.5, 30.0  # m/s: where a search starts, and beyond any current; chosen
_ROUNDS, _ACCURACY = 30, 1e-4  # of a search, and relative change of speed that ends it; chosen
_POWER = 0.5  # of the force's factor that the speed takes: drag grows with its square at most


def current_force(craft: StationCraft, speed: float, direction: float) -> Array:
    """Return the force (3,) of a current from a direction off the bow [rad] on the craft, thrusters at rest."""
    model = craft.model
    rates = np.empty(len(model.states))
    model.compiled.rates(0.0, craft.in_current(speed, direction), craft.resting_inputs, model.parameters.values, rates)
    return craft.inertia @ rates[[model.states.index(name) for name in ("u", "v", "r")]]


def capability(craft: StationCraft, inverse: Array) -> StationCapability:
    """Return the current and the force that are held from all directions; inverse: of the loop (m, 3)."""
    directions = 2.0 * math.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    currents = np.array([_largest_current(craft, direction, None) for direction in directions])
    shared_out = np.array([_largest_current(craft, direction, inverse) for direction in directions])
    limiting = tuple(
        largest_force(craft, -current_force(craft, speed, direction))[1]
        for speed, direction in zip(currents, directions, strict=True)
    )
    forces = [largest_force(craft, np.array([math.cos(a), math.sin(a), 0.0]))[0] for a in directions]
    return StationCapability(directions, currents, shared_out, np.array(forces), limiting)


def _largest_current(craft: StationCraft, direction: float, inverse: Array | None) -> float:
    """Return the fastest current [m/s] that is held: by any sharing out, or by that of an inverse (m, 3)."""
    speed = _FIRST
    for _ in range(_ROUNDS):
        force = -current_force(craft, speed, direction)
        if inverse is None:
            factor = largest_force(craft, force)[0]
        else:
            factor = float(share_given(craft, inverse, force[None])[0])
        before, speed = speed, min(speed * factor**_POWER, _FASTEST)
        if abs(speed - before) <= _ACCURACY * before or speed == 0.0:
            break
    return speed
