"""The thrusters of a craft, their places, commands and curves, and how an angle of them steers it."""

import json
import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from enum import StrEnum
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np
from pydantic import TypeAdapter

from seatrial.core.equations import Model
from seatrial.core.values import Channel, InputError, Record, spelling_hint
from seatrial.core.values.notation import OPPOSITE

# The thrusters of a craft, their places, commands and curves: what its equations depend on.

MIN_LAG = 0.05
"""Least time constant of a thruster [s] that equations with a state for it can hold at 10 Hz; chosen."""

MIN_DELAY = 2.0 * MIN_LAG
"""Least delay [s] that two time constants in a row can hold at 10 Hz; chosen."""

DEFAULT_LAG = 0.2
"""Time constant of a small electric thruster [s] where a search starts; chosen."""


class ThrustCurve(StrEnum):
    """How thrust follows the command."""

    POWER = "power"
    QUADRATIC = "quadratic"
    LINEAR = "linear"
    KNOTS = "knots"
    OPEN_WATER = "open-water"


class Damping(StrEnum):
    """Which forces of the hull there are."""

    DIAGONAL = "diagonal"
    FULL = "full"
    CROSS_FLOW = "cross-flow"


@dataclass(frozen=True)
class AngleInput:
    """The channel in which a thruster's direction is recorded or ordered.

    Attributes:
        channel: such as ``alpha_1`` [rad], the direction of thrust clockwise from ahead.
        lag: start value of the time constant with which the thruster follows [s]; 0: it is where the channel says.
        rate: the fastest it turns [rad/s]; None: no limit.
    """

    channel: str
    lag: float = 0.0
    rate: float | None = None


@dataclass(frozen=True)
class CommandInput:
    """The channel of a thruster's command: (channel - zero) / span is 1 at full ahead, -1 at full astern.

    Attributes:
        channel: such as ``command_1``.
        zero: reading at rest; span: from there to full ahead, negative where the channel grows to full astern. Both in
            the channel's SI unit.
    """

    channel: str
    zero: float = 0.0
    span: float = 1.0


@dataclass(frozen=True)
class Rudder:
    """The rudder behind a screw.

    Attributes:
        channel: of its angle [rad, positive turns to starboard], such as ``delta``.
        x: place forward of the origin [m]; it stands as far to the side as the screw.
        area: movable [m^2]; span: height [m].
    """

    channel: str
    x: float
    area: float
    span: float


@dataclass(frozen=True)
class Thruster:
    """One thruster.

    Attributes:
        name: an identifier; states, forces and coefficients carry it.
        x, y: place forward and to starboard of the origin [m].
        angle: direction of its thrust clockwise from ahead [rad], or the channel that gives it.
        curve: of thrust over command.
        knots: commands (shares of full command, rising through 0) at which the curve of ``knots`` has a coefficient.
        diameter: of the propeller [m], for ``open-water``.
        lag: start value of the time constant of spinning up and down [s]; 0: thrust follows the command at once.
        delay: start value of the time by which it follows its command late [s]; 0: none.
        dead_band: share of full command below which there is no thrust.
        bollard: thrust at full command ahead in water at rest [N], measured; 0: unknown.
        same_as: name of the thruster whose coefficients it shares; empty: it has its own.
        rudder: behind it, where its curve is ``open-water``.
    """

    name: str
    x: float
    y: float
    command: CommandInput
    angle: float | AngleInput = 0.0
    curve: ThrustCurve = ThrustCurve.POWER
    knots: tuple[float, ...] = ()
    diameter: float = 0.0
    lag: float = DEFAULT_LAG
    dead_band: float = 0.0
    bollard: float = 0.0
    same_as: str = ""
    delay: float = 0.0
    rudder: Rudder | None = None

    def __post_init__(self) -> None:
        where = f"thruster '{self.name}'"
        if not self.name.isidentifier() or not self.name.isascii():
            raise InputError(f"{where}: its name is part of names of forces; use letters, digits and _ only")
        if self.command.span == 0.0:
            raise InputError(f"{where}: command.span is 0; give the reading at full ahead minus that at rest")
        if not 0.0 <= self.dead_band < 1.0:
            raise InputError(f"{where}: dead_band is a share of full command, at least 0 and below 1")
        if self.lag and self.lag < MIN_LAG:
            raise InputError(f"{where}: lag = {self.lag:g} s; give 0 for none, or {MIN_LAG:g} s and more")
        if self.delay and self.delay < MIN_DELAY:
            raise InputError(f"{where}: delay = {self.delay:g} s; give 0 for none, or {MIN_DELAY:g} s and more")
        if self.rudder is not None and self.curve is not ThrustCurve.OPEN_WATER:
            raise InputError(f'{where}: a rudder needs the slipstream of its screw; add curve = "open-water"')
        if self.curve is ThrustCurve.OPEN_WATER and not self.diameter > 0.0:
            raise InputError(f"{where}: an open-water curve needs the propeller's diameter; add diameter = ... [m]")
        if self.curve is ThrustCurve.KNOTS:
            _require_knots(where, self.knots)


def _require_knots(where: str, knots: tuple[float, ...]) -> None:
    if len(knots) < 3 or 0.0 not in knots or any(b <= a for a, b in pairwise(knots)):
        raise InputError(
            f"{where}: give knots as rising shares of full command through 0, such as [-1, -0.5, 0, 0.5, 1]"
        )


def _structure(thruster: Thruster) -> tuple[object, ...]:
    """What thrusters that share coefficients have in common."""
    return thruster.curve, thruster.knots, bool(thruster.lag), bool(thruster.delay)


@dataclass(frozen=True)
class ThrusterLayout:
    """The thrusters of a craft and which other forces its equations have.

    Attributes:
        damping: of the hull.
        length: of the hull [m], over which cross-flow acts.
        mass: start value of M_u [kg]: 1 unless something is known in newtons.
        has_wind: whether wind acts on areas above water.
        has_voltage: whether thrust changes with the batteries' voltage, channel ``voltage``.
    """

    thrusters: tuple[Thruster, ...]
    damping: Damping = Damping.FULL
    length: float = 1.0
    mass: float = 1.0
    has_wind: bool = False
    has_voltage: bool = False

    def __post_init__(self) -> None:
        names = [thruster.name for thruster in self.thrusters]
        if not names:
            raise InputError("the craft has no thruster; add a [[thruster]] block for each")
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise InputError(f"two thrusters are called '{twice[0]}'; give each a name of its own")
        for thruster in self.thrusters:
            if thruster.same_as:
                self._require_leader(thruster, names)

    def _require_leader(self, thruster: Thruster, names: list[str]) -> None:
        where, leader = f"thruster '{thruster.name}': same_as", thruster.same_as
        if leader not in names or leader == thruster.name:
            other_names = [name for name in names if name != thruster.name]
            raise InputError(f"{where} = '{leader}' is no other thruster{spelling_hint(leader, other_names)}")
        first = self.thrusters[names.index(leader)]
        if first.same_as:
            raise InputError(f"{where}: '{leader}' shares the coefficients of '{first.same_as}'; name that one")
        if thruster.bollard and thruster.bollard != first.bollard:
            raise InputError(f"{where}: it has the thrust of '{leader}'; give bollard there")
        if _structure(first) != _structure(thruster):
            raise InputError(
                f"{where}: it and '{leader}' have different curves, knots, lags or delays; give both the same"
            )

    @property
    def has_bollard(self) -> bool:
        """Whether the thrust of some thruster is known in newtons, so that motions show masses and forces."""
        return any(thruster.bollard > 0.0 for thruster in self.thrusters)

    @property
    def has_rudders(self) -> bool:
        """Whether a rudder stands behind some screw."""
        return any(thruster.rudder is not None for thruster in self.thrusters)

    @cached_property
    def leaders(self) -> tuple[Thruster, ...]:
        """The thrusters that have coefficients of their own."""
        return tuple(thruster for thruster in self.thrusters if not thruster.same_as)

    def leader(self, thruster: Thruster) -> Thruster:
        """Return the thruster whose coefficients one has: itself, or that of `same_as`."""
        return next(t for t in self.thrusters if t.name == (thruster.same_as or thruster.name))

    def suffix(self, thruster: Thruster) -> str:
        """Return what names of its coefficients end with: nothing where all thrusters share one set."""
        return f"_{thruster.same_as or thruster.name}" if len(self.leaders) > 1 else ""

    def text(self) -> str:
        """Return the layout as JSON, from which `from_text` makes it again."""
        return json.dumps(asdict(self))

    @classmethod
    def from_text(cls, text: str) -> "ThrusterLayout":
        """Return the layout that `text` wrote; raises ValueError where it is none."""
        return _read_layout(text)


@lru_cache(maxsize=16)  # texts of crafts in use at once; chosen
def _read_layout(text: str) -> ThrusterLayout:
    return TypeAdapter(ThrusterLayout).validate_json(text)


CATAMARAN = ThrusterLayout(
    (
        Thruster("port", -0.5, -0.3, CommandInput("command_1"), same_as="starboard"),
        Thruster("starboard", -0.5, 0.3, CommandInput("command_2")),
    )
)
"""Two fixed thrusters with one curve: what the name ``thrusters`` stands for without a layout; chosen."""


# Steering by an angle: thrusters that turn, and rudders behind screws, as one order to starboard like a rudder's.

ORDER = "delta"
"""Channel and input of the order [rad], positive to starboard as a rudder's angle."""
_NO_ARM = 0.05
"""Arm along the craft over the longest one below which a thruster does not steer by its angle; chosen."""

_ABEAM = 0.5 * math.pi + 1e-6  # rad: thrust across the craft, and rounding


def steering_angles(layout: ThrusterLayout) -> dict[str, float]:
    """Return the channels of angles that steer a craft with their signs, the angle over the order to starboard.

    Empty where all thrusters are fixed.
    A channel that turns several thrusters has the sign of the sum of their arms.
    """
    arms: dict[str, float] = {}
    for channel, arm in _arms(layout):
        arms[channel] = arms.get(channel, 0.0) + arm
    longest = max(map(abs, arms.values()), default=0.0)
    return {channel: math.copysign(1.0, arm) for channel, arm in arms.items() if abs(arm) > _NO_ARM * longest}


def _arms(layout: ThrusterLayout) -> Iterator[tuple[str, float]]:
    """Channels of angles with the arm [m] by which thrust or lift at a positive angle turns the craft to starboard."""
    for thruster in layout.thrusters:
        if isinstance(thruster.angle, AngleInput):
            yield thruster.angle.channel, thruster.x
        if thruster.rudder is not None:
            yield thruster.rudder.channel, -thruster.rudder.x  # lift of a positive angle is to port


def layout_of(model: Model) -> ThrusterLayout:
    """Return where the thrusters of a model lie, which has some."""
    return ThrusterLayout.from_text(model.equations.layout)


def order_text(layout: ThrusterLayout) -> str:
    """Return what an order stands for: ``alpha_1 = -delta``; empty where the order is the angle itself."""
    signs = {1.0: "", -1.0: "-"}
    angles = [angle for angle in steering_angles(layout).items() if angle != (ORDER, 1.0)]
    return ", ".join(f"{channel} = {signs[sign]}{ORDER}" for channel, sign in angles)


def with_steering_order(record: Record, layout: ThrusterLayout) -> Record:
    """Return the record with `ORDER`, the mean of what its steering angles stand for, where it has all of these.

    A record that has the channel, one of a craft without such angles, and one in which an azimuth thruster turns beyond
    abeam, where it is no rudder any more, is returned as it is.
    """
    angles = steering_angles(layout)
    if not angles or ORDER in record or any(channel not in record for channel in angles):
        return record
    turned = [sign * _to_starboard(record.channel(channel)) for channel, sign in angles.items()]
    if np.nanmax(np.abs(turned), initial=0.0) > _ABEAM:
        return record
    return record.with_channel(ORDER, Channel.from_notation(ORDER, np.mean(turned, axis=0)))


def _to_starboard(channel: Channel) -> np.ndarray:
    return -channel.values if channel.positive == OPPOSITE["starboard"] else channel.values
