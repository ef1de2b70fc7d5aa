"""Sea states by number: heights of the WMO code, and the periods that go with them on the open ocean."""

from dataclasses import dataclass

from seatrial.core.values import InputError
from seatrial.physics.sea.spectrum import Spectrum, bretschneider


@dataclass(frozen=True)
class SeaState:
    """One row of the table.

    Attributes:
        number: 0 to 9.
        name: in the words of the WMO.
        lowest, highest: range of the significant height, m; the last has no upper end.
        significant_height: typical, m; none where the range has no middle.
        modal_period: most probable peak period, s; none where waves are ripples.
    """

    number: int
    name: str
    lowest: float
    highest: float
    significant_height: float | None
    modal_period: float | None

    def spectrum(self) -> Spectrum:
        """Return the Bretschneider spectrum of the typical height and period.

        Raises:
            InputError: the state has no typical height or no typical period (0, 1, 9).
        """
        if self.significant_height is None or self.modal_period is None:
            raise InputError(
                f"sea state {self.number} ({self.name}) has no typical height and period; give a height and a period"
            )
        return bretschneider(self.significant_height, self.modal_period)


# Ranges and names: WMO code table 3700. Typical heights and modal periods: Bales 1983, open North Atlantic
# (a transcription was at hand, not the report), with one row for 0 and 1.
_STATES = (
    SeaState(0, "calm (glassy)", 0.0, 0.0, 0.0, None),
    SeaState(1, "calm (rippled)", 0.0, 0.1, 0.05, None),
    SeaState(2, "smooth (wavelets)", 0.1, 0.5, 0.3, 7.5),
    SeaState(3, "slight", 0.5, 1.25, 0.88, 7.5),
    SeaState(4, "moderate", 1.25, 2.5, 1.88, 8.8),
    SeaState(5, "rough", 2.5, 4.0, 3.25, 9.7),
    SeaState(6, "very rough", 4.0, 6.0, 5.0, 12.4),
    SeaState(7, "high", 6.0, 9.0, 7.5, 15.0),
    SeaState(8, "very high", 9.0, 14.0, 11.5, 16.4),
    SeaState(9, "phenomenal", 14.0, float("inf"), None, 20.0),
)


def sea_state(number: int) -> SeaState:
    """Return the sea state of that number.

    Raises:
        InputError: the number is not one of 0 to 9.
    """
    if number not in range(len(_STATES)):
        raise InputError(f"there is no sea state {number}; sea states go from 0 to {len(_STATES) - 1}")
    return _STATES[number]
