"""What a craft's instruments do to its motion, as a trial declares it: the table `[sensors]`, and a value in Python."""

from collections.abc import Mapping
from enum import StrEnum
from typing import Annotated

from pydantic import BeforeValidator, ConfigDict, Field, TypeAdapter
from pydantic.dataclasses import dataclass as validated


class Compass(StrEnum):
    """How the heading that the compass shows differs from the craft's."""

    TRUE = "true"
    OFFSET = "offset"
    HARMONIC = "harmonic"


class VelocityReference(StrEnum):
    """What u and v are in the records: through the water, or a receiver's over ground turned by the compass."""

    WATER = "water"
    GROUND = "ground"


class Late(StrEnum):
    """An instrument that may be late: the receiver by a delay of all that is its own, others by a filter."""

    RECEIVER = "receiver"
    HEADING = "heading"
    YAW_RATE = "yaw_rate"


TIMED_CHANNELS = {Late.RECEIVER: ("x0", "y0"), Late.HEADING: ("psi",), Late.YAW_RATE: ("r",)}
"""Channels of an instrument whose timing its lag is."""


LAG_START = {Late.RECEIVER: 0.0, Late.HEADING: 0.5, Late.YAW_RATE: 0.5}
"""Lag [s] at which a search begins where none is given; chosen."""


def _as_starts(late: object) -> object:
    """Names of instruments as a mapping to where the search for their lags begins."""
    return {n: LAG_START.get(n, 0.0) for n in late} if isinstance(late, list | tuple) else late


Starts = Annotated[Mapping[Late, float], BeforeValidator(_as_starts)]
"""Instrument -> lag [s] at which a search begins; a list of instruments stands for `LAG_START`."""


_STRICT = ConfigDict(extra="forbid", allow_inf_nan=False)


@validated(frozen=True, config=_STRICT)
class Antenna:
    """Place of the receiver's antenna forward and to starboard of the origin [m], where the estimate starts.

    Attributes:
        x, y: forward and to starboard [m].
        sd: standard deviation of either, before any record [m].
    """

    x: float = 0.0
    y: float = 0.0
    sd: Annotated[float, Field(gt=0.0)] = 0.5  # m: a place that was measured aboard; chosen


@validated(frozen=True, kw_only=True, config=_STRICT)
class Sensors:
    """`[sensors]`: what stands between motion and records. Its coefficients are free unless `[model.fixed]` has them.

    Attributes:
        compass: ``offset`` estimates compass_A, ``harmonic`` also compass_B and compass_C: the compass shows
            psi - e with e = A + B sin(shown) + C cos(shown).
        velocity: what u and v are: ``water``, or ``ground``: over ground, turned by the compass's heading.
        velocity_lag: start value of the time by which u and v are late [s]; 0: they are not.
        late: instruments whose lag is estimated (lag_receiver, lag_heading, lag_yaw_rate) -> its start value [s]. The
            readings of a receiver are moved ahead by its start value, so that what is left of its lag is short.
        yaw_rate_bias: whether r_bias is added to the yaw rate.
        yaw_rate_scale: whether the yaw rate is shown 1 + r_scale times.
        antenna: place of the receiver's antenna, to which position (and u, v over ground) refer; None: the origin.
        position_hold: whether positions stay between the receiver's fixes: a repeated pair counts as not measured.
    """

    compass: Compass = Compass.TRUE
    velocity: VelocityReference = VelocityReference.WATER
    velocity_lag: Annotated[float, Field(ge=0.0)] = 0.0
    late: Starts = Field(default_factory=dict)
    yaw_rate_bias: bool = False
    yaw_rate_scale: bool = False
    antenna: Antenna | None = None
    position_hold: bool = False

    @property
    def changes_outputs(self) -> bool:
        """Whether any channel shows something else than the state of its name."""
        return self != Sensors()

    def text(self) -> str:
        """Return the settings as JSON, from which `from_text` makes them again."""
        return TypeAdapter(Sensors).dump_json(self).decode()

    @classmethod
    def from_text(cls, text: str) -> "Sensors":
        """Return the settings that `text` wrote, perfect instruments of an empty one; ValueError where it is none."""
        return TypeAdapter(cls).validate_json(text) if text else cls()

    def line(self, key: str) -> str:
        """Return the line under [sensors] that states one of its settings."""
        import tomlkit

        value = TypeAdapter(Sensors).dump_python(self, mode="json")[key]
        table = tomlkit.inline_table()
        if isinstance(value, dict):
            table.update(value)
            return f"{key} = {table.as_string()}"
        return f"{key} = {tomlkit.item(value).as_string()}"
