"""What Yu et al. 2014 print: table 1, the searched box, what they say of it, and what they leave open."""

import math
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array
from seatrial.physics.loops import fin_loop

SOURCE = (
    "Yu Lijun, Liu Shaoying, Wang Hui, Xiong Chaodong: Energy optimization for the fin stabilizer system based on a "
    "genetic algorithm (in Chinese), CAAI Transactions on Intelligent Systems 9(4), 2014"
)


@dataclass(frozen=True)
class ControllerResult:
    """One controller's numbers of a row: roll [deg], fin rate [deg/s], reduction of the roll [%]."""

    roll: float
    rate: float
    reduction: float

    @property
    def uncontrolled(self) -> float:
        """Return the roll without fins [deg] that the other two imply."""
        return self.roll / (1.0 - 0.01 * self.reduction)

    @property
    def uncontrolled_bounds(self) -> tuple[float, float]:
        """What rounding to the printed digits leaves open of it."""
        low = (self.roll - 0.005) / (1.0 - 0.01 * (self.reduction - 0.005))
        return low, (self.roll + 0.005) / (1.0 - 0.01 * (self.reduction + 0.005))

    @property
    def log_values(self) -> Array:
        """Return logarithms of roll, fin rate and what is left of the roll, (3,)."""
        return np.log([self.roll, self.rate, 1.0 - 0.01 * self.reduction])


@dataclass(frozen=True)
class Table1Row:
    """One row of table 1: speed [kn], heading to the waves [deg], both controllers."""

    speed: float
    heading: float
    traditional: ControllerResult
    genetic: ControllerResult

    @property
    def name(self) -> str:
        """Return the name of the row as in the table."""
        return f"{self.speed:.0f} / {self.heading:.0f}"


TABLE_1 = (
    Table1Row(18.0, 45.0, ControllerResult(0.49, 5.3, 75.23), ControllerResult(0.47, 4.1, 76.35)),
    Table1Row(18.0, 90.0, ControllerResult(0.38, 5.07, 76.24), ControllerResult(0.39, 3.8, 75.92)),
    Table1Row(18.0, 135.0, ControllerResult(0.36, 4.7, 77.33), ControllerResult(0.35, 3.2, 79.58)),
    Table1Row(22.0, 45.0, ControllerResult(0.35, 3.2, 78.26), ControllerResult(0.33, 2.9, 80.38)),
    Table1Row(22.0, 90.0, ControllerResult(0.32, 2.4, 79.13), ControllerResult(0.31, 2.5, 82.96)),
    Table1Row(22.0, 135.0, ControllerResult(0.28, 2.6, 80.39), ControllerResult(0.25, 2.2, 84.43)),
)
DESIGN_ROW, DESIGN_ROW_AT_22_KN = TABLE_1[1], TABLE_1[4]

PUBLISHED_LOOP = fin_loop()
GAIN_NAMES = PUBLISHED_LOOP.gains.names
PUBLISHED_VALUES = PUBLISHED_LOOP.gain_values
LOWER, UPPER = (np.array(ends) for ends in zip(*((p.lower, p.upper) for p in PUBLISHED_LOOP.gains), strict=True))
HEIGHT = 3.3  # m, significant
FIN_LIMIT, SATURATION = 22.0, 0.2  # deg, probability
TARGET_DEG2 = 150.31  # as printed
TARGET = math.radians(1.0) ** 2 * TARGET_DEG2
INERTIA = 791.1611  # kg m^2
RECORD_SECONDS, STEP = 1000.0, 0.1  # s

# section 2.3, the fin
SPAN, ASPECT, THICKNESS, DENSITY = 1.18, 0.53, 0.15, 7800.0
CHORD, CHORD_OF_LEVER = 2.22, 2.2


@dataclass(frozen=True)
class FinGainStatement:
    """What the paper says, translated, and where."""

    source: str
    text: str


STATEMENTS = {
    "rate": FinGainStatement("section 4", "the fin rate under the traditional PID is larger than under the GA's"),
    "reduction": FinGainStatement("section 4", "the GA's roll reduction is slightly lower than the traditional PID's"),
    "energy": FinGainStatement("abstract, section 5", "the GA effectively lowers the stabiliser's energy loss"),
    "set": FinGainStatement("section 5", "where the PID was set, reduction drops slightly, energy is optimised"),
    "optimal": FinGainStatement(
        "sections 3, 5", "a set of optimal gains is found; the overall performance is the best"
    ),
    "search": FinGainStatement("section 3", "random weights escape local optima and slow search"),
    "global": FinGainStatement(
        "section 4", "the gains are optimal for all sea states and speeds: a global optimisation"
    ),
    "saturation": FinGainStatement("section 2.3", "the objectives secure a fin saturation of at most 20 %"),
    "loop": FinGainStatement("section 1", "K_alpha is approximated as a constant"),
}
