"""What the paper's own equations and numbers say when they are worked through again: every misprint with evidence."""

from collections.abc import Sequence
from dataclasses import dataclass

from seatrial_studies.song2025.assumed_parameters import AssumedParameters, SignCheck, check_signs
from seatrial_studies.song2025.audited_equations import (
    Equation14Fit,
    Equation27Readings,
    ForceDimensions,
    Thrust,
    balancing_thrust,
    equation_14_fits,
    equation_27_readings,
    force_dimensions,
    parenthesis_factors,
)
from seatrial_studies.song2025.audited_motions import (
    PortStarboardAsymmetry,
    ReversedTurn,
    UndampedSway,
    port_starboard_asymmetry,
    reversed_turn,
    undamped_sway,
)
from seatrial_studies.song2025.audited_tables import (
    FeatureConditions,
    Table1Mass,
    Table4Implication,
    feature_conditions,
    table_1_mass,
    table_4_implications,
)
from seatrial_studies.song2025.craft_models import reference_record
from seatrial_studies.song2025.published import MotionEquation, PublishedManoeuvre

# kg/m^3, customary densities
FRESH_WATER_DENSITY, SALT_WATER_DENSITY = 1000.0, 1025.0


@dataclass(frozen=True, eq=False)
class SupportVectorAudit:
    """Numbers behind the verdicts on the print; no random number is drawn.

    Attributes:
        reversed_turn: sign of N_v, table 2.
        undamped_sway: sign of Y_vv, table 2, improved column.
        asymmetry: alpha v in eq. (3), |v| and |r| in eq. (2).
        dimensions: of eq. (2).
        parenthesis_factors: equation -> by what eq. (1) is too large without them.
        equation_14_fits: eq. (14) corrected, and with each misprint alone.
        equation_27_readings: eq. (27), sway.
        table_3_conditions: table 3.
        table_1_masses: table 1, in fresh and in salt water.
        thrust: the balance at the stated speed.
        table_4_implications: table 4.
        sign_checks: the signs of N_v and Y_vv again, under other choices.
    """

    reversed_turn: ReversedTurn
    undamped_sway: UndampedSway
    asymmetry: PortStarboardAsymmetry
    dimensions: ForceDimensions
    parenthesis_factors: dict[MotionEquation, float]
    equation_14_fits: tuple[Equation14Fit, ...]
    equation_27_readings: Equation27Readings
    table_3_conditions: FeatureConditions
    table_1_masses: tuple[Table1Mass, Table1Mass]
    thrust: Thrust
    table_4_implications: tuple[Table4Implication, ...]
    sign_checks: tuple[SignCheck, ...]


def audit(assumptions: Sequence[AssumedParameters]) -> SupportVectorAudit:
    """Everything: some 3 s, and 0.4 s for each of the `others` (`choices()` or some of them)."""
    series = reference_record(PublishedManoeuvre.CONSECUTIVE)
    of_features = feature_conditions(series)
    return SupportVectorAudit(
        reversed_turn(),
        undamped_sway(),
        port_starboard_asymmetry(),
        force_dimensions(),
        parenthesis_factors(),
        equation_14_fits(series),
        equation_27_readings(of_features.correlations[MotionEquation.SWAY]),
        of_features,
        (table_1_mass(FRESH_WATER_DENSITY), table_1_mass(SALT_WATER_DENSITY)),
        balancing_thrust(),
        table_4_implications(),
        tuple(check_signs(choice) for choice in assumptions),
    )
