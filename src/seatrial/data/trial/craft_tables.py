"""What drives and steers a craft: `[[thruster]]` and `[feedback]` of a trial file, values in Python."""

import fnmatch
import math
from collections.abc import Sequence
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Field, TypeAdapter, model_validator
from pydantic.dataclasses import dataclass

from seatrial.core.values import NOTATION, Array, InputError, Record, Ship, channel_hint, si_unit
from seatrial.data.trial.amounts import (
    STRICT_FIELDS,
    Amount,
    Angle,
    InSi,
    PositiveLength,
    StrictTable,
    raises_input_error,
)
from seatrial.physics.models.thruster_layout import (
    DEFAULT_LAG,
    AngleInput,
    CommandInput,
    Damping,
    Rudder,
    ThrustCurve,
    Thruster,
    ThrusterLayout,
)

# `[[thruster]]`: a craft's thrusters as a trial file describes them, made the layout of the model `thrusters`.

CommandUnit = Literal["us", "percent", "rpm", "rps", "1"]

_ZERO_AND_SPAN: dict[CommandUnit, tuple[float, float | None]] = {
    "us": (1500.0, 400.0), "percent": (0.0, 100.0), "rpm": (0.0, None), "rps": (0.0, None), "1": (0.0, 1.0),
}  # fmt: skip
"""Reading at rest and from there to full ahead where the file does not say: RC servo pulses 1100 to 1900 us; shares."""

_RPM = 1.0 / 60.0  # rps, by definition
_SMALLEST_ARM = 1e-9  # m; rounding
_AREAS = frozenset({"A_T", "A_L"})
_ADDED_SHARE = 1.05  # M_u over the mass, start: a slender hull adds some 5 % in surge; chosen


class CommandTable(StrictTable):
    """Channel of a command, and which of its readings are rest and full ahead.

    Attributes:
        channel: ``command_1`` and so on.
        unit: of the readings; ``1``: shares of full command.
        positive: what a reading above `zero` does.
        zero: reading at rest; without it: 1500 us, else 0.
        span: from there to full ahead; without it: 400 us, 100 percent, 1.
    """

    channel: str
    unit: CommandUnit = "1"
    zero: float | None = None
    span: Annotated[float, Field(gt=0)] | None = None
    positive: Literal["ahead", "astern"] = "ahead"


class AngleTable(StrictTable):
    """The direction of a thruster follows a channel.

    Attributes:
        channel: ``alpha_1`` and so on, or ``delta``.
        lag: time constant [s].
        rate: fastest turn [rad/s].
    """

    channel: str
    lag: Annotated[float, Field(ge=0)] = 0.0
    rate: Annotated[float, InSi("rad/s", is_positive=True)] | None = None


def _angle(value: object) -> object:
    """A table with a channel, or an angle as anywhere else."""
    if isinstance(value, dict) and "channel" in value:
        return AngleTable.model_validate(value)
    return TypeAdapter(Angle).validate_python(value)


class RudderTable(StrictTable):
    """The rudder of the MMG method behind a screw.

    Attributes:
        channel: of its angle.
        x: forward of the origin [m].
        area: movable [m^2].
        span: height of the rudder [m].
    """

    channel: str = "delta"
    x: Annotated[float, InSi("m")]
    area: Annotated[float, Field(gt=0)]
    span: PositiveLength


class ThrusterTable(StrictTable):
    """One `[[thruster]]`.

    Attributes:
        name: part of the names of its force and coefficients.
        x: forward of the origin [m].
        y: to starboard [m].
        angle: direction of thrust, clockwise from ahead: fixed, or a channel that it follows.
        command: the channel that orders it, and which readings are rest and full ahead.
        curve: thrust over command: ``power`` with an exponent estimated, ``quadratic``, ``linear``, straight lines
            between coefficients at `knots`, or K_T over J of a rate in rpm or rps (``open-water``; needs ship.m).
        knots: shares of full command, as -1, -0.5, 0, 0.5, 1.
        diameter: of the screw of an ``open-water`` curve.
        lag: s, where the search starts; 0: none.
        delay: s, where the search starts: the order is late by two equal time constants in a row of this sum.
        dead_band: share of full command without thrust; fixed unless `free` of the model names ``dead``.
        bollard: thrust at full command in water at rest, with which forces are in newtons.
        same_as: the thruster whose coefficients it shares.
        rudder: behind a screw of an ``open-water`` curve.
    """

    name: str
    x: Annotated[float, InSi("m")]
    y: Annotated[float, InSi("m")]
    angle: Annotated[
        float | AngleTable, BeforeValidator(_angle, json_schema_input_type=float | Amount | AngleTable)
    ] = 0.0
    command: CommandTable
    curve: ThrustCurve = ThrustCurve.POWER
    knots: tuple[float, ...] = ()
    diameter: PositiveLength | None = None
    lag: Annotated[float, Field(ge=0)] = DEFAULT_LAG
    delay: Annotated[float, Field(ge=0)] = 0.0
    dead_band: Annotated[float, Field(ge=0, lt=1)] = 0.0
    bollard: Annotated[float, InSi("N", is_positive=True)] | None = None
    same_as: str = ""
    rudder: RudderTable | None = None

    @model_validator(mode="after")
    def _angle_in_radians(self) -> Self:
        if isinstance(self.angle, float) and abs(self.angle) > 2.0 * math.pi:
            raise ValueError(
                f"angle = {self.angle:g} is in rad and more than a full turn; "
                f'write angle = {{ value = {self.angle:g}, unit = "deg" }}'
            )
        return self


def thruster_layout(tables: tuple[ThrusterTable, ...], ship: Ship, damping: Damping) -> ThrusterLayout:
    """Return the layout of a craft; wind acts where the ship has A_T or A_L, the batteries' voltage where it has V_0.

    Raises:
        InputError: no thruster; a channel, a curve or a sharing that cannot be; the mass missing where it is needed.
    """
    thrusters = tuple(_thruster(table) for table in tables)
    _require_turning(thrusters)
    has_wind = bool(_AREAS & set(ship.particulars))
    reason = _needs_newtons(thrusters, has_wind=has_wind)
    if reason and "m" not in ship.particulars:
        raise InputError(f"{reason}; give the craft's mass, ship.m [kg]")
    mass = _ADDED_SHARE * ship.particulars["m"] if reason else 1.0
    return ThrusterLayout(thrusters, damping, ship.length, mass, has_wind, "V_0" in ship.particulars)


def _require_turning(thrusters: Sequence[Thruster]) -> None:
    """Raises:
    InputError: several fixed thrusters all push through the origin, so that none turns the craft.
    """
    if len(thrusters) < 2 or any(t.rudder or isinstance(t.angle, AngleInput) or _arm(t) for t in thrusters):
        return
    names = ", ".join(f"'{t.name}'" for t in thrusters)
    raise InputError(f"thrusters {names} all push through the origin and none turns the craft; state x and y of each")


def _arm(thruster: Thruster) -> bool:
    """Whether a fixed thruster pushes beside the origin, x sin a - y cos a (Fossen 2021, section 9.2)."""
    angle = thruster.angle if isinstance(thruster.angle, float) else 0.0
    return abs(thruster.x * math.sin(angle) - thruster.y * math.cos(angle)) > _SMALLEST_ARM


def _needs_newtons(thrusters: Sequence[Thruster], *, has_wind: bool) -> str:
    """Return what gives forces in newtons, so that masses are needed; empty: nothing does."""
    named = [t.name for t in thrusters if t.bollard or t.curve is ThrustCurve.OPEN_WATER]
    if named:
        return f"thruster '{named[0]}' has its thrust in newtons"
    return "the wind on ship.A_T and ship.A_L is a force in newtons" if has_wind else ""


def _thruster(table: ThrusterTable) -> Thruster:
    where = f"thruster '{table.name}'"
    angle = table.angle
    if isinstance(angle, AngleTable):
        angle = AngleInput(_channel(angle.channel, "rad", f"{where}: angle"), angle.lag, angle.rate)
    return Thruster(
        table.name, table.x, table.y, _command(table, where), angle, table.curve, table.knots, table.diameter or 0.0,
        table.lag, table.dead_band, table.bollard or 0.0, table.same_as, table.delay, _rudder(table, where),
    )  # fmt: skip


def _rudder(table: ThrusterTable, where: str) -> Rudder | None:
    rudder = table.rudder
    if rudder is None:
        return None
    return Rudder(_channel(rudder.channel, "rad", f"{where}: rudder"), rudder.x, rudder.area, rudder.span)


def _command(table: ThrusterTable, where: str) -> CommandInput:
    command = table.command
    turns = command.unit in ("rpm", "rps")
    factor = _RPM if command.unit == "rpm" else 1.0
    zero, span = _ZERO_AND_SPAN[command.unit]
    if table.curve is ThrustCurve.OPEN_WATER:
        if not turns:
            raise InputError(
                f"{where}: an open-water curve is one over the rate of turning; give a command in rpm or rps"
            )
        span = 1.0 / factor  # the share of full command is then the rate in rps
    span = span if command.span is None else command.span
    if span is None:
        raise InputError(f"{where}: add command.span, the {command.unit} at full command")
    sign = 1.0 if command.positive == "ahead" else -1.0
    channel = _channel(command.channel, "rps" if turns else "1", f"{where}: command")
    return CommandInput(channel, factor * (zero if command.zero is None else command.zero), sign * factor * span)


def _channel(name: str, unit: str, where: str) -> str:
    suited = sorted(s for s, q in NOTATION.items() if q.unit == unit)
    if name not in suited:
        raise InputError(f"{where}: '{name}' is no channel in {unit}{channel_hint(name, suited)}")
    return name


def layout_text(model_name: str, damping: Damping | None, tables: tuple[ThrusterTable, ...], ship: Ship) -> str:
    """Return the text of a craft's layout for `model_named`; empty for a model without thrusters.

    Raises:
        InputError: thrusters without the model, the model without thrusters, or as `thruster_layout`.
    """
    if model_name != "thrusters":
        if tables or damping is not None:
            key = "[[thruster]]" if tables else "model.damping"
            raise InputError(f"{key} is of the model 'thrusters' and the model is '{model_name}'; change one of them")
        return ""
    return thruster_layout(tables, ship, damping or Damping.FULL).text()


# The controller that was on while runs were recorded: table `[feedback]` of a trial file, a value in Python.

RATE_OF = {"psi": "r", "phi": "p", "theta": "theta_dot"}
"""Channel that a controller holds -> the channel of its rate."""

# relative difference of two sample times that are one; chosen: clocks of loggers
_SAMPLE_TOLERANCE = 0.01


def _as_patterns(value: object) -> object:
    return (value,) if isinstance(value, str) else value


@raises_input_error
@dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class ControllerGains:
    """`[feedback.controller]`: gain (reference - output) - rate_gain (rate of the output) + integral_gain (integral).

    Attributes:
        gain: input over output, SI; rate_gain: the same times s; integral_gain: the same over s.
        sample_s: time between two orders [s].
    """

    gain: float
    rate_gain: float = 0.0
    integral_gain: float = 0.0
    sample_s: Annotated[float, Field(gt=0)]

    def order(self, error: Array, rate: Array) -> Array:
        """Return what the controller orders without limits, SI; error (rows,) of the output, its rate (rows,)."""
        integral = (error.cumsum() - 0.5 * (error[0] + error)) * self.sample_s  # trapezoids
        return self.gain * error - self.rate_gain * rate + self.integral_gain * integral


@raises_input_error
@dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class Feedback:
    """`[feedback]`: which input a controller worked, and what is known of it.

    Attributes:
        input: the input that it worked; output: the channel that it held.
        reference: the channel with what was ordered, or a constant, SI without a unit; None: not known.
        controller: its gains; None: not known.
        runs: patterns of the names of the runs in which it was on.
    """

    input: str
    output: str
    reference: str | Annotated[float, Field(strict=True)] | Amount | None = None
    controller: ControllerGains | None = None
    runs: Annotated[tuple[str, ...], BeforeValidator(_as_patterns), Field(min_length=1)] = ("*",)

    @model_validator(mode="after")
    def _constant_is_one_of_the_output(self) -> Self:
        unit = self.reference.unit if isinstance(self.reference, Amount) else None
        if unit is not None and self.output in NOTATION and si_unit(unit)[1] != NOTATION[self.output].unit:
            raise ValueError(f"reference: '{unit}' is no unit of '{self.output}'; write {NOTATION[self.output].unit}")
        return self

    @model_validator(mode="after")
    def _controller_is_complete(self) -> Self:
        if self.controller is not None and self.reference is None:
            raise ValueError(
                "a controller without a reference orders nothing that can be compared; add the reference, a channel or "
                "a constant, or leave the controller out"
            )
        if self.controller is not None and self.controller.rate_gain and self.output not in RATE_OF:
            raise ValueError(f"controller.rate_gain: no channel is the rate of '{self.output}'; leave it out")
        return self

    @property
    def constant(self) -> float | None:
        """Return the constant that was ordered, SI; None where it was none."""
        if isinstance(self.reference, Amount):
            return self.reference.in_si
        return None if isinstance(self.reference, str) else self.reference

    def concerns(self, record: Record) -> bool:
        """Return whether the controller was on in this run."""
        return any(fnmatch.fnmatchcase(record.name, pattern) for pattern in self.runs)

    def reference_of(self, record: Record) -> Array | None:
        """Return what was ordered, (rows,), SI; None where that is not known, or the controller was off."""
        if self.reference is None or not self.concerns(record):
            return None
        return record[self.reference] if isinstance(self.reference, str) else np.full(len(record), self.constant)

    def order_of(self, record: Record) -> Array | None:
        """Return what the controller orders in this run, (rows,), SI; None where it or its reference is not known."""
        reference = self.reference_of(record)
        if reference is None or self.controller is None:
            return None
        output, rate = record[self.output], RATE_OF.get(self.output, "")
        error = reference - output
        if record.channel(self.output).unit == "rad":  # both are unwrapped, each from its own first sample
            error = error - 2.0 * np.pi * np.round(np.median(error) / (2.0 * np.pi))
        return self.controller.order(error, record[rate] if rate in record else 0.0 * output)


def refuse_unusable_feedback(feedback: Feedback, records: Sequence[Record], where: str = "") -> None:
    """Refuse a declaration that the records do not allow.

    where: what the sentence begins with, such as the trial file.

    Raises:
        InputError: no run matches, a channel is missing in one, or the controller's sample time is not that of a run.
    """
    concerned = [record for record in records if feedback.concerns(record)]
    if not concerned:
        names = ", ".join(f"'{r.name}'" for r in records)
        raise InputError(f"{where}feedback.runs matches no training run; those are {names}")
    for record in concerned:
        for key, channel in _required_channels(feedback).items():
            if channel not in record:
                edit = f"add {channel} under [records.channels]"
                if key == "reference":
                    edit += ', or give a constant, reference = { value = 0, unit = "deg" }'
                raise InputError(f"{where}feedback.{key}: record '{record.name}' has no channel '{channel}'; {edit}")
        gains = feedback.controller
        if gains is not None and abs(gains.sample_s - record.dt) > _SAMPLE_TOLERANCE * record.dt:
            raise InputError(
                f"{where}feedback.controller.sample_s is {gains.sample_s:g} s, but record '{record.name}' has a sample "
                f"every {record.dt:g} s; write rate = {1.0 / gains.sample_s:.6g} under [estimate], or correct sample_s"
            )


def _required_channels(feedback: Feedback) -> dict[str, str]:
    """Key of the table -> channel that each run must hold."""
    channels = {"input": feedback.input, "output": feedback.output}
    if isinstance(feedback.reference, str):
        channels["reference"] = feedback.reference
    if feedback.controller is not None and feedback.controller.rate_gain and feedback.output in RATE_OF:
        channels["controller.rate_gain"] = RATE_OF[feedback.output]
    return channels
