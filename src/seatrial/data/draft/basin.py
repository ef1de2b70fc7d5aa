"""Whether logs are of a free-running model in a basin, where no current runs and one model has one rudder zero."""

from collections.abc import Iterable

from seatrial.data.draft.column_guess import ColumnGuess
from seatrial.data.draft.ship_estimates import StatedSize

_OFTEN_FRESH = 12.0  # m, of the craft that are tried on lakes and in basins; chosen
_LONGEST_MODEL = 10.0  # m; chosen: the largest free-running models of ships have 7 to 8
_SATELLITES = frozenset({"lat", "lon", "sog", "cog"})  # what a receiver of satellites logs


def is_in_basin(guesses: Iterable[ColumnGuess], size: StatedSize) -> bool:
    """Return whether a craft is a model whose place was measured from the shore: x0, y0, and nothing of a receiver.

    guesses: of all sources of a run, used or not.
    """
    known = list(guesses)
    is_model = size.scale > 1.0 or 0.0 < size.length < _LONGEST_MODEL
    has_track = any(one.symbol == "x0" and one.is_used and one.frame != "enu" for one in known)
    is_over_ground = any(one.is_used and one.symbol == "u" and one.frame in ("earth", "enu") for one in known)
    return is_model and has_track and not is_over_ground and not any(one.symbol in _SATELLITES for one in known)


def may_be_in_fresh_water(size: StatedSize) -> bool:
    """Return whether a craft of this size is often tried in fresh water, and the density is not stated."""
    return not size.rho and (size.scale > 1.0 or 0.0 < size.length < _OFTEN_FRESH)
