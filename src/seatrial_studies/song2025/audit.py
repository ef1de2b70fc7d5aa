"""What the paper's own equations and numbers say when they are worked through again: every misprint with evidence."""

from collections.abc import Sequence
from dataclasses import dataclass

from seatrial_studies.song2025.audited_equations import (
    Condition,
    Dimensions,
    Regression,
    Thrust,
    condition,
    dimensions,
    parentheses,
    regressions,
    thrust,
)
from seatrial_studies.song2025.audited_motions import (
    OneSided,
    ReversedTurn,
    Undamped,
    one_sided,
    reversed_turn,
    undamped,
)
from seatrial_studies.song2025.audited_tables import (
    Conditions,
    Implied,
    Mass,
    conditions,
    implied_by_table_4,
    mass,
)
from seatrial_studies.song2025.choices import Choice, Held, held
from seatrial_studies.song2025.crafts import reference
from seatrial_studies.song2025.published import Equation, Run

FRESH, SALT = 1000.0, 1025.0


@dataclass(frozen=True, eq=False)
class Audit:
    """Numbers behind the verdicts on the print; no random number is drawn.

    Attributes:
        turn: sign of N_v, table 2.
        undamped: sign of Y_vv, table 2, improved column.
        one_sided: alpha v in eq. (3), |v| and |r| in eq. (2).
        dimensions: of eq. (2).
        parentheses: equation -> by what eq. (1) is too large without them.
        regressions: eq. (14) mended, and with each misprint alone.
        condition: eq. (27), sway.
        conditions: table 3.
        masses: table 1, in fresh and in salt water.
        thrust: the balance at the stated speed.
        implied: table 4.
        held: the signs of N_v and Y_vv again, under other choices.
    """

    turn: ReversedTurn
    undamped: Undamped
    one_sided: OneSided
    dimensions: Dimensions
    parentheses: dict[Equation, float]
    regressions: tuple[Regression, ...]
    condition: Condition
    conditions: Conditions
    masses: tuple[Mass, Mass]
    thrust: Thrust
    implied: tuple[Implied, ...]
    held: tuple[Held, ...]


def audit(others: Sequence[Choice]) -> Audit:
    """Everything: some 3 s, and .4 s for each of the `others` (`choices()` or some of them)."""
    series = reference(Run.CONSECUTIVE)
    of_features = conditions(series)
    return Audit(
        reversed_turn(),
        undamped(),
        one_sided(),
        dimensions(),
        parentheses(),
        regressions(series),
        condition(of_features.correlations[Equation.SWAY]),
        of_features,
        (mass(FRESH), mass(SALT)),
        thrust(),
        implied_by_table_4(),
        tuple(held(choice) for choice in others),
    )
