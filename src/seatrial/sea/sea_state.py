"""Sea states by number: significant heights of WMO code 3700, most probable modal periods of the open ocean."""

from dataclasses import dataclass

from seatrial.values import InputError

SOURCE = "heights: WMO code table 3700; modal periods: Bales 1983, North Atlantic (STANAG 4194)"


@dataclass(frozen=True)
class SeaState:
    """Range of the significant height [m], its middle, and the most probable modal period [s]; None where calm."""

    number: int
    lowest: float
    highest: float
    modal_period: float | None

    @property
    def significant_height(self) -> float:
        """Middle of the range, m."""
        return 0.5 * (self.lowest + self.highest)


_STATES = (
    SeaState(0, 0.0, 0.0, None),
    SeaState(1, 0.0, 0.1, None),
    SeaState(2, 0.1, 0.5, 6.3),
    SeaState(3, 0.5, 1.25, 7.5),
    SeaState(4, 1.25, 2.5, 8.8),
    SeaState(5, 2.5, 4.0, 9.7),
    SeaState(6, 4.0, 6.0, 12.4),
    SeaState(7, 6.0, 9.0, 15.0),
    SeaState(8, 9.0, 14.0, 16.4),
)


def sea_state(number: int) -> SeaState:
    """The state of that number.

    Raises:
        InputError: there is none of that number.
    """
    if not 0 <= number < len(_STATES):
        raise InputError(f"there is no sea state {number}; give 0 to {len(_STATES) - 1}, or a significant height")
    return _STATES[number]
