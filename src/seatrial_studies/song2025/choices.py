"""Whether the signs of table 2 are misprints under other values of what the paper leaves open."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from seatrial.physics.models.waterjet import waterjet
from seatrial_studies.song2025.crafts import MENDED, TRUTH, Reading, replayed, sailed, whole
from seatrial_studies.song2025.generalisation import accuracy
from seatrial_studies.song2025.published import Column, Run

TURN = "turning-circle:20"
FRESH_WATER = 1000.0


@dataclass(frozen=True)
class Choice:
    """Values of parameters that table 1 does not give."""

    words: str
    values: Mapping[str, float] = field(default_factory=dict)


def choices() -> tuple[Choice, ...]:
    """Our own; fresh water; each of the others a third less and more (the nozzle .05 L farther and nearer).

    J_z acts in sum with I_z alone.
    """
    p = waterjet().parameters
    made = [Choice("ours"), Choice("fresh water", {"rho": FRESH_WATER})]
    for name in ("m_x", "m_y", "I_z", "A_j"):
        made += [Choice(f"{name} {f:.2f} times", {name: f * p[name].value}) for f in (2.0 / 3.0, 4.0 / 3.0)]
    made += [Choice(f"x_T {f:.2f} L", {"x_T": f * p["L"].value}) for f in (-0.5, -0.4)]
    return tuple(made)


@dataclass(frozen=True)
class Held:
    """What the signs do under one choice.

    Attributes:
        yaw_rates: deg/s at the end of a 20 deg turn to starboard, CFD column, N_v mended and as printed.
        finishes: whether the 20/20 zigzag does, N_v mended and as printed.
        diverges: s in the 35/35 zigzag on the truth's nozzle history, improved column, N_v mended; infinite where not.
        cc: the same with Y_vv turned, against the CFD column under the same choice.
    """

    choice: str
    yaw_rates: tuple[float, float]
    finishes: tuple[bool, bool]
    diverges: float
    cc: dict[str, float]

    @property
    def confirms(self) -> bool:
        """The printed N_v reverses the turn and stops the zigzag, the printed Y_vv diverges; mended, none of these."""
        mended, printed = self.yaw_rates
        return mended > 0.0 > printed and self.finishes == (True, False) and math.isfinite(self.diverges)


def held(choice: Choice) -> Held:
    """One choice (some .4 s)."""
    readings = (TRUTH, Reading(Column.CFD), Reading(Column.IMPROVED, ("N_v",)), MENDED[2])
    mended, printed, driven, improved = (r.craft().with_values(choice.values) for r in readings)
    zigzag = whole(mended, Run.ZIGZAG_35)
    again = replayed(driven, zigzag)
    return Held(
        choice.words,
        (_yaw_rate(whole(mended, TURN)["r"][-1]), _yaw_rate(whole(printed, TURN)["r"][-1])),
        (sailed(mended, Run.ZIGZAG_20).finished, sailed(printed, Run.ZIGZAG_20).finished),
        math.inf if len(again) == len(zigzag) else float(again.time[-1]),
        accuracy(zigzag, replayed(improved, zigzag)).cc,
    )


def _yaw_rate(radians: float) -> float:
    return math.degrees(float(radians))
