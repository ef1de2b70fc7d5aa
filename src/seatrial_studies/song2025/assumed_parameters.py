"""Whether the signs of table 2 are misprints under other values of what the paper leaves open."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from seatrial.physics.models import waterjet
from seatrial_studies.song2025.craft_models import (
    CORRECTED,
    TRUTH,
    CoefficientSet,
    manoeuvre_record,
    replay_inputs,
    simulate_manoeuvre,
)
from seatrial_studies.song2025.generalisation import prediction_accuracy
from seatrial_studies.song2025.published import PublishedManoeuvre, Table2Column

TURN_PROGRAMME = "turning-circle:20"
FRESH_WATER = 1000.0


@dataclass(frozen=True)
class AssumedParameters:
    """Values of parameters that table 1 does not give."""

    label: str
    values: Mapping[str, float] = field(default_factory=dict)


def assumed_parameter_sets() -> tuple[AssumedParameters, ...]:
    """Our own; fresh water; each of the others a third less and more (the nozzle 0.05 L farther and nearer).

    J_z acts in sum with I_z alone.
    """
    p = waterjet().parameters
    made = [AssumedParameters("ours"), AssumedParameters("fresh water", {"rho": FRESH_WATER})]
    for name in ("m_x", "m_y", "I_z", "A_j"):
        made += [AssumedParameters(f"{name} {f:.2f} times", {name: f * p[name].value}) for f in (2.0 / 3.0, 4.0 / 3.0)]
    made += [AssumedParameters(f"x_T {f:.2f} L", {"x_T": f * p["L"].value}) for f in (-0.5, -0.4)]
    return tuple(made)


@dataclass(frozen=True)
class SignCheck:
    """What the signs do under one choice.

    Attributes:
        yaw_rates: deg/s at the end of a 20 deg turn to starboard, CFD column, N_v corrected and as printed.
        completes_zigzag: whether the 20/20 zigzag is completed, N_v corrected and as printed.
        divergence_time: s in the 35/35 zigzag on the truth's nozzle history, improved column, N_v corrected;
            infinite where the motion stays bounded.
        corrected_cc: the same with the sign of Y_vv changed, against the CFD column under the same choice.
    """

    assumption: str
    yaw_rates: tuple[float, float]
    completes_zigzag: tuple[bool, bool]
    divergence_time: float
    corrected_cc: dict[str, float]

    @property
    def confirms_misprints(self) -> bool:
        """The printed N_v reverses the turn and stops the zigzag, the printed Y_vv diverges; corrected, neither."""
        corrected, printed = self.yaw_rates
        return (
            corrected > 0.0 > printed and self.completes_zigzag == (True, False) and math.isfinite(self.divergence_time)
        )


def check_signs(assumption: AssumedParameters) -> SignCheck:
    """Return what the signs do under one choice (some 0.4 s)."""
    readings = (TRUTH, CoefficientSet(Table2Column.CFD), CoefficientSet(Table2Column.IMPROVED, ("N_v",)), CORRECTED[2])
    corrected, printed, driven, improved = (r.craft().with_values(assumption.values) for r in readings)
    zigzag = manoeuvre_record(corrected, PublishedManoeuvre.ZIGZAG_35)
    again = replay_inputs(driven, zigzag)
    return SignCheck(
        assumption.label,
        (
            _degrees_per_second(manoeuvre_record(corrected, TURN_PROGRAMME)["r"][-1]),
            _degrees_per_second(manoeuvre_record(printed, TURN_PROGRAMME)["r"][-1]),
        ),
        (
            simulate_manoeuvre(corrected, PublishedManoeuvre.ZIGZAG_20).is_completed,
            simulate_manoeuvre(printed, PublishedManoeuvre.ZIGZAG_20).is_completed,
        ),
        math.inf if len(again) == len(zigzag) else float(again.time[-1]),
        prediction_accuracy(zigzag, replay_inputs(improved, zigzag)).cc,
    )


def _degrees_per_second(radians: float) -> float:
    return math.degrees(float(radians))
