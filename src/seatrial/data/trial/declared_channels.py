"""Channels that a trial file declares for models of its own: what they mean, unit, side, whether they are orders."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from seatrial.core.values import NOTATION, InputError, si_unit
from seatrial.core.values.between import Between, Kind
from seatrial.core.values.notation import OPPOSITE, Quantity
from seatrial.data.read.quantities import LOG_QUANTITIES
from seatrial.data.trial.schema import DeclaredChannel


@dataclass(frozen=True)
class DeclaredQuantity:
    """What a declared channel means, who sets it, and how it runs between samples."""

    quantity: Quantity
    kind: Kind
    between: Between = ""

    def require_side(self, positive: str | None, where: str) -> None:
        """Refuse a column whose positive direction is neither the declared one nor its opposite.

        Raises:
            InputError: which directions there are.
        """
        own = self.quantity.positive
        sides = [own, *([OPPOSITE[own]] if own in OPPOSITE else [])]
        if positive is not None and positive not in sides:
            raise InputError(f"{where}.positive: '{positive}' is none of {' and '.join(sides)}; correct it")


Declared = Mapping[str, DeclaredQuantity]
"""Symbol -> what the trial file declares."""
NO_DECLARED: Declared = MappingProxyType({})


def declared_channels(tables: Mapping[str, DeclaredChannel]) -> Declared:
    """Return the channels of `[channels]` by symbol.

    Raises:
        InputError: a name that is no identifier, or one that the notation table has.
    """
    return {symbol: _declared(symbol, table) for symbol, table in tables.items()}


def _declared(symbol: str, table: DeclaredChannel) -> DeclaredQuantity:
    if not (symbol.isidentifier() and symbol.isascii()):
        raise InputError(f"channels.'{symbol}': a channel is named by letters, digits and _; choose another name")
    known = NOTATION.get(symbol) or LOG_QUANTITIES.get(symbol)
    if known is not None:
        raise InputError(f"channels.{symbol} is known already ({known.meaning}); use it undeclared, or rename yours")
    unit = si_unit(table.unit)[1]
    meaning = Quantity(symbol, table.meaning, unit, table.frame, table.positive, symbol, symbol)
    return DeclaredQuantity(meaning, table.kind, table.between or "")
