"""A craft with thrusters at rest, as station keeping needs it: matrices, thrusters with their limits, lags."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from seatrial.control.ship.trim import jacobian_at
from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError
from seatrial.physics.models.thrust_orders import (
    coefficient_or_zero,
    inertia_matrix,
    thrust_configuration,
    with_outside_forces,
)
from seatrial.physics.models.thruster_layout import AngleInput, Thruster, ThrusterLayout

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
        return ThrusterLayout.from_text(self.model.equations.layout)

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
        return coefficient_or_zero(self.model, symbol + self.layout.suffix(thruster))

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
        f"station: thrusters {names} give no {missing} of their own: a position and a heading are kept by forces ahead "
        "and to the side and a moment, each alone; such a craft can keep a heading, a speed and a track; leave "
        "[station] out, or add a thruster that pushes sideways (tunnel, azimuth, or one set at an angle)"
    )
