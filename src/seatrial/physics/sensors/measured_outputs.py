"""A model with what its instruments show, as outputs ``_measured``; and a run corrected for the current."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.equations.bindings import Binding, ModelEquations
from seatrial.core.equations.model import MEASURED, measured_name, stored_equations
from seatrial.core.results.prediction import EstimatedCurrent
from seatrial.core.values import Array, InputError, Parameter, Parameters, Prior, Record
from seatrial.physics.manoeuvres import to_starboard
from seatrial.physics.sensors.settings import Compass, Late, Sensors, VelocityReference

if TYPE_CHECKING:
    import sympy as sp


# A model with what its instruments show: for each channel they change, an output of that name with ``_measured``.

SENSOR_SOURCE = "sensor model"
"""Source of the coefficients of instruments, by which they differ from the craft's own."""
_CURRENT = ("current_north", "current_east")
_DEVIATION, _RATE_BIAS, _RATE_SCALE, _LAG = 0.2, 0.02, 0.05, 1.0
"""Prior standard deviations: of compass coefficients [rad], a yaw rate's bias [rad/s] and scale, a lag [s]; chosen."""
_MIN_LAG = 0.1
"""Least lag [s] that time constants can hold at 10 Hz; chosen."""


def with_sensors(model: Model, sensors: Sensors) -> Model:
    """Return the model with the outputs that its instruments show, their coefficients free.

    Raises:
        InputError: the model lacks a state that an instrument measures, or has sensors already.
    """
    if not sensors.changes_outputs:
        return model
    if model.equations.sensors:
        raise InputError(f"model '{model.name}' has sensors already; give the model without them")
    parameters = _parameters(sensors)
    for state in sorted(_required_states(sensors)):
        if state not in model.states:
            raise InputError(f"model '{model.name}' has no state '{state}'; leave its sensor out of [sensors]")
    layout = model.equations.layout  # no part of the hash
    key = (model.equation_hash, layout, "sensors", sensors.text())
    equations = stored_equations(key, lambda: _Writer(model, sensors, parameters).equations(), [Path(__file__).parent])
    return replace(model, equations=equations, parameters=Parameters((*model.parameters, *parameters)))


def without_sensors(model: Model) -> Model:
    """Return the model whose channels show its states, as it was before `with_sensors`."""
    sensor_parameters, old = {p.name for p in model.parameters if p.source == SENSOR_SOURCE}, model.equations
    equations = replace(
        old, rates=tuple(b for b in old.rates if b.source != SENSOR_SOURCE),
        bindings=tuple(b for b in old.bindings if b.source != SENSOR_SOURCE),
        outputs=tuple(o for o in old.outputs if not o.endswith(MEASURED)),
        parameters=tuple(n for n in old.parameters if n not in sensor_parameters), sensors="",
    )  # fmt: skip
    kept = Parameters(tuple(p for p in model.parameters if p.name not in sensor_parameters))
    return replace(model, equations=equations, parameters=kept)


_LATE_STATES = {Late.RECEIVER: {"x0", "y0", "psi", "r"}, Late.HEADING: {"psi"}, Late.YAW_RATE: {"r"}}
"""States that the delay of an instrument is reckoned by."""


def _required_states(sensors: Sensors) -> set[str]:
    required: set[str] = set().union(*(_LATE_STATES[late] for late in sensors.late))
    if sensors.compass is not Compass.TRUE:
        required |= {"psi"}
    if sensors.velocity is VelocityReference.GROUND or sensors.velocity_lag:
        required |= {"u", "v", "r", "psi"}
    if sensors.yaw_rate_bias or sensors.yaw_rate_scale:
        required |= {"r"}
    return required | ({"x0", "y0", "psi", "r"} if sensors.antenna else set())


def _parameters(sensors: Sensors) -> tuple[Parameter, ...]:
    """The coefficients of the instruments."""

    def one(name: str, value: float, unit: str, meaning: str, spread: float, lower: float = float("-inf")) -> Parameter:
        prior = Prior(value, spread, SENSOR_SOURCE)
        return Parameter(name, value, unit, lower, float("inf"), spread, prior, True, SENSOR_SOURCE, meaning, "")

    items = []
    if sensors.compass is not Compass.TRUE:
        items.append(one("compass_A", 0.0, "rad", "heading over that of the compass", _DEVIATION))
    if sensors.compass is Compass.HARMONIC:
        items.append(one("compass_B", 0.0, "rad", "deviation with the sine of the heading shown", _DEVIATION))
        items.append(one("compass_C", 0.0, "rad", "deviation with its cosine", _DEVIATION))
    if sensors.yaw_rate_bias:
        items.append(one("r_bias", 0.0, "rad/s", "yaw rate shown over the true one", _RATE_BIAS))
    if sensors.yaw_rate_scale:
        items.append(one("r_scale", 0.0, "1", "share by which the yaw rate shown is too large", _RATE_SCALE))
    if sensors.antenna is not None:
        place = sensors.antenna
        items.append(one("x_antenna", place.x, "m", "antenna forward of the origin", place.sd))
        items.append(one("y_antenna", place.y, "m", "antenna to starboard", place.sd))
    for late, start in sensors.late.items():
        least = float("-inf") if late is Late.RECEIVER else _MIN_LAG
        meaning = f"time by which the {late.replace('_', ' ')} is late"
        items.append(one(lag_name(late), max(start, least), "s", meaning, _LAG, least))
    if sensors.velocity_lag:
        lag = max(sensors.velocity_lag, _MIN_LAG)
        items.append(one("lag_velocity", lag, "s", "time by which u and v are late", lag, _MIN_LAG))
    return tuple(items)


def lag_name(late: Late) -> str:
    """Name of the parameter that holds the delay of an instrument."""
    return f"lag_{late}"


@dataclass(frozen=True, eq=False)
class _Motion:
    u: "sp.Expr"
    v: "sp.Expr"


class _Writer:
    """Writes the outputs of one model's instruments."""

    def __init__(self, model: Model, sensors: Sensors, parameters: Sequence[Parameter]) -> None:
        self.model, self.sensors = model, sensors
        self.names = tuple(p.name for p in parameters)
        self.bindings: list[Binding] = []
        self.rates: list[Binding] = []
        self.outputs: list[str] = []

    def equations(self) -> ModelEquations:
        """Return the model's equations with the outputs."""
        sensors, old = self.sensors, self.model.equations
        deviation = self._deviation()
        if sensors.compass is not Compass.TRUE or Late.HEADING in sensors.late:
            self._output("psi", self._filtered(Late.HEADING, "psi") - deviation, "rad")
        if sensors.velocity is VelocityReference.GROUND or sensors.velocity_lag:
            self._velocities(deviation)
        if sensors.yaw_rate_bias or sensors.yaw_rate_scale or Late.YAW_RATE in sensors.late:
            self._yaw_rate()
        if sensors.antenna is not None or Late.RECEIVER in sensors.late:
            self._positions()
        return replace(
            old, rates=(*old.rates, *self.rates), bindings=(*old.bindings, *self.bindings),
            outputs=(*old.outputs, *self.outputs), parameters=(*old.parameters, *self.names), sensors=sensors.text(),
        )  # fmt: skip

    def _bind(self, name: str, expression: "sp.Expr", unit: str = "1") -> "sp.Symbol":
        self.bindings.append(Binding.from_expression(name, expression, SENSOR_SOURCE, unit))
        return _symbol(name)

    def _output(self, channel: str, expression: "sp.Expr", unit: str) -> None:
        self._bind(measured_name(channel), expression, unit)
        self.outputs.append(measured_name(channel))

    def _deviation(self) -> "sp.Expr":
        """e at the heading shown, by two steps of psi_shown = psi - e(psi_shown) from the true heading."""
        import sympy as sp

        if self.sensors.compass is Compass.TRUE:
            return sp.Integer(0)
        if self.sensors.compass is Compass.OFFSET:
            return _symbol("compass_A")
        A, B, C = (_symbol(f"compass_{letter}") for letter in "ABC")
        psi = _symbol("psi")
        first = self._bind("deviation_1", A + B * sp.sin(psi) + C * sp.cos(psi), "rad")
        heading = self._bind("shown_1", psi - first, "rad")
        second = self._bind("deviation_2", A + B * sp.sin(heading) + C * sp.cos(heading), "rad")
        heading = self._bind("shown_2", psi - second, "rad")
        return self._bind("deviation", A + B * sp.sin(heading) + C * sp.cos(heading), "rad")

    def _lag(self, late: Late) -> "sp.Expr":
        """The lag of an instrument; of a receiver what is left of it once its readings are moved."""
        import sympy as sp

        if late not in self.sensors.late:
            return sp.Integer(0)
        moved = self.sensors.late[late] if late is Late.RECEIVER else 0.0
        return _symbol(lag_name(late)) - moved if moved else _symbol(lag_name(late))

    def _rate(self, state: str) -> "sp.Expr":
        return next(b.expression for b in self.model.equations.rates if b.name == state)

    def _filtered(self, late: Late, channel: str) -> "sp.Expr":
        """The channel, behind a filter of first order where its instrument is late."""
        if late not in self.sensors.late:
            return _symbol(channel)
        return self._follower(late_name(channel), _symbol(channel), self._lag(late))

    def _follower(self, name: str, source: "sp.Expr", constant: "sp.Expr") -> "sp.Symbol":
        """A state of that name that follows `source` with a time constant."""
        self.rates.append(Binding.from_expression(name, (source - _symbol(name)) / constant, SENSOR_SOURCE))
        return _symbol(name)

    def _yaw_rate(self) -> None:
        sensors, rate = self.sensors, self._filtered(Late.YAW_RATE, "r")
        if sensors.yaw_rate_scale:
            rate = rate * (1 + _symbol("r_scale"))
        self._output("r", rate + _symbol("r_bias") if sensors.yaw_rate_bias else rate, "rad/s")

    def _positions(self) -> None:
        """Where the antenna was a lag ago: back along the arc on which the heading halfway lies."""
        import sympy as sp

        lag, psi, r = self._lag(Late.RECEIVER), _symbol("psi"), _symbol("r")
        heading, has_antenna = psi - lag * r, self.sensors.antenna is not None
        x, y = (_symbol("x_antenna"), _symbol("y_antenna")) if has_antenna else (sp.Integer(0), sp.Integer(0))
        lever = {"x0": x * sp.cos(heading) - y * sp.sin(heading), "y0": x * sp.sin(heading) + y * sp.cos(heading)}
        for channel, arm in lever.items():
            way = lag * self._rate(channel).subs(psi, psi - lag * r / 2)
            self._output(channel, _symbol(channel) - way + arm, "m")

    def _velocities(self, deviation: "sp.Expr") -> None:
        import sympy as sp

        motion = _Motion(_symbol("u"), _symbol("v"))
        if self.sensors.velocity is VelocityReference.GROUND:
            lag = self._lag(Late.RECEIVER)  # in which the heading that resolves them has moved on by lag r
            turned = deviation - lag * _symbol("r")
            motion = self._turned(self._at_antenna(self._over_ground(self._late_motion())), turned)
        for channel, value in (("u", motion.u), ("v", motion.v)):
            late = self._late(channel, value) if self.sensors.velocity_lag else value
            self._output(channel, sp.sympify(late), "m/s")

    def _over_ground(self, motion: _Motion) -> _Motion:
        import sympy as sp

        if not set(_CURRENT) <= set(self.model.parameters.names):
            return motion
        north, east = (_symbol(name) for name in _CURRENT)
        sine, cosine = sp.sin(_symbol("psi")), sp.cos(_symbol("psi"))
        return _Motion(motion.u + north * cosine + east * sine, motion.v - north * sine + east * cosine)

    def _at_antenna(self, motion: _Motion) -> _Motion:
        if self.sensors.antenna is None:
            return motion
        r = _symbol("r")
        return _Motion(motion.u - _symbol("y_antenna") * r, motion.v + _symbol("x_antenna") * r)

    def _late_motion(self) -> _Motion:
        u, v = _symbol("u"), _symbol("v")
        if Late.RECEIVER not in self.sensors.late:
            return _Motion(u, v)
        lag = self._lag(Late.RECEIVER)
        ahead, across = (self._bind(f"{s}_acceleration", self._rate(s), "m/s^2") for s in ("u", "v"))
        return _Motion(u - lag * ahead, v - lag * across)

    def _turned(self, motion: _Motion, deviation: "sp.Expr") -> _Motion:
        import sympy as sp

        ahead, across = self._bind("u_ground", motion.u, "m/s"), self._bind("v_ground", motion.v, "m/s")
        sine, cosine = sp.sin(deviation), sp.cos(deviation)
        return _Motion(ahead * cosine - across * sine, ahead * sine + across * cosine)

    def _late(self, channel: str, value: "sp.Expr") -> "sp.Symbol":
        """Two time constants in a row, each half the lag: states `u_late_1`, `u_late`."""
        half = _symbol("lag_velocity") / 2
        first = self._follower(f"{channel}_late_1", self._bind(f"{channel}_prompt", value, "m/s"), half)
        return self._follower(late_name(channel), first, half)


def late_name(channel: str) -> str:
    """Return the name of the state that follows a channel late."""
    return f"{channel}_late"


def is_late(state: str) -> bool:
    """Return whether a state follows a channel late: it starts where the channel does."""
    return "_late" in state


def _symbol(name: str) -> "sp.Symbol":
    import sympy as sp

    return sp.Symbol(name, real=True)


# A run whose receiver's readings are moved to the time that they are of.


def with_timed_receiver(record: Record, sensors: Sensors, lag: float) -> Record:
    """Return the run whose receiver's readings are moved ahead by a lag [s], in whole samples.

    Positions move as they are. Velocities over ground are turned from the heading at which they were resolved to that
    of the sample to which they move.
    """
    rows = round(lag / record.dt) if lag else 0
    if not rows:
        return record
    read = np.arange(len(record)) + rows
    source = np.clip(read, 0, len(record) - 1)
    names = [c for c in ("x0", "y0") if c in record]
    if sensors.velocity is VelocityReference.GROUND:
        names += [c for c in ("u", "v") if c in record]
    was_measured = {c: np.isfinite(record.measured(c)) for c in names}
    values = {c: to_starboard(record, c)[source] for c in names}
    if {"u", "v"} <= values.keys() and "psi" in record:
        psi = to_starboard(record, "psi")
        turn = psi[source] - psi
        ahead, across = values["u"], values["v"]
        values["u"] = ahead * np.cos(turn) - across * np.sin(turn)
        values["v"] = ahead * np.sin(turn) + across * np.cos(turn)
    for c in names:
        channel = record.channel(c)
        sign = -1.0 if channel.positive == "port" else 1.0
        moved = channel.with_values(sign * values[c]).with_measured(was_measured[c][source] & (source == read))
        record = record.with_channel(c, moved)
    return record.with_step(f"readings of the receiver moved ahead by {rows * record.dt:g} s")


# A run corrected for the current: the drift of the water is taken off its track, and off velocities over ground.


def shows_ground_velocity(model: Model) -> bool:
    """Return whether u and v in records of this model's craft are over ground, so that a current is in them."""
    text = model.equations.sensors
    return bool(text) and Sensors.from_text(text).velocity is VelocityReference.GROUND


def without_current(record: Record, current: EstimatedCurrent | None, has_ground_velocity: bool) -> Record:
    """Return the run as it went through the water, from where it began; the record itself where no current is known.

    The position becomes that of the start plus the way through the water, x'(t) = x(t) - v_c t. u and v over ground
    lose the current's components along and across the heading that the compass showed.
    """
    if current is None:
        return record
    elapsed = record.time - record.time[0]
    for symbol, drift in (("x0", current.north), ("y0", current.east)):
        if symbol in record:
            record = _less(record, symbol, drift * elapsed)  # MSC/Circ.1053, 3.4.2.5
    if not has_ground_velocity or "psi" not in record:
        return record
    psi = to_starboard(record, "psi")
    ahead = current.north * np.cos(psi) + current.east * np.sin(psi)
    to_the_right = -current.north * np.sin(psi) + current.east * np.cos(psi)
    for symbol, part in (("u", ahead), ("v", to_the_right)):
        if symbol in record:
            record = _less(record, symbol, part)
    return record


def _less(record: Record, symbol: str, part: Array) -> Record:
    channel = record.channel(symbol)
    sign = -1.0 if channel.positive == "port" else 1.0
    return record.with_channel(symbol, channel.with_values(channel.values - sign * part))
