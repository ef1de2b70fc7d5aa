"""A sea in a file: the spectrum by its name and what it needs."""

from collections.abc import Callable
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from seatrial.core.values import InputError
from seatrial.data.trial.amounts import PositiveDuration, PositiveLength, StrictTable
from seatrial.physics.sea.sea_state import sea_state
from seatrial.physics.sea.spectrum import Spectrum, bretschneider, ittc, ittc_two_parameter, jonswap

_NEEDED = {"ittc": {"height"}, "sea-state": {"state"}}
_NEEDED_BY_OTHERS = {"height", "period"}


class SeaTable(StrictTable):
    """A spectrum; `height` is the significant one, `period` the mean T_1 for ittc2, else that of the peak."""

    spectrum: Literal["ittc", "ittc2", "bretschneider", "jonswap", "sea-state"] = "ittc"
    height: PositiveLength | None = None
    period: PositiveDuration | None = None
    gamma: float = 3.3  # mean peak enhancement of JONSWAP, Hasselmann et al. 1973
    state: Annotated[int, Field(ge=0, le=9)] | None = None  # sea states of the WMO code

    @model_validator(mode="after")
    def _keys_of_the_spectrum(self) -> Self:
        needed = _NEEDED.get(self.spectrum, _NEEDED_BY_OTHERS)
        given = {key for key in ("height", "period", "state") if getattr(self, key) is not None}
        for key in sorted(needed - given):
            raise ValueError(f"spectrum '{self.spectrum}' needs a {key}")
        for key in sorted(given - needed):
            raise ValueError(f"spectrum '{self.spectrum}' has no {key}")
        return self

    def to_spectrum(self, where: str) -> Spectrum:
        """Return the spectrum; `where` is the key of the table, for messages.

        Raises:
            InputError: a sea state without waves, or a peak enhancement out of range.
        """
        height, period = self.height or 0.0, self.period or 0.0
        match self.spectrum:
            case "sea-state":
                return _with_key(where, lambda: sea_state(self.state or 0).spectrum())
            case "ittc":
                return ittc(height)
            case "ittc2":
                return ittc_two_parameter(height, period)
            case "bretschneider":
                return bretschneider(height, period)
            case "jonswap":
                return _with_key(f"{where}.gamma", lambda: jonswap(height, period, self.gamma))


def _with_key(where: str, make: Callable[[], Spectrum]) -> Spectrum:
    try:
        return make()
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
