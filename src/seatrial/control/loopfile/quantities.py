"""Amounts of a loop file in SI units, tested for their kind; every sentence begins with the key."""

import math

from seatrial.core.values import NOTATION, InputError, si_unit
from seatrial.data.trial.amounts import Amount

_HALF_TURN = math.pi
_RATES = {"rad": "rad/s", "m": "m/s", "m/s": "m/s^2"}


def symbol_unit(symbol: str) -> str:
    """SI unit of a symbol of the notation; 1 for others."""
    return NOTATION[symbol].unit if symbol in NOTATION else "1"


def rate_unit(unit: str) -> str:
    """SI unit of the rate of what is measured in `unit`."""
    return _RATES.get(unit, f"{unit} per s")


def si_value(quantity: Amount, unit: str, where: str) -> float:
    """The amount in SI, which must be of the kind that `unit` measures.

    Raises:
        InputError: its unit is of another kind.
    """
    if quantity.unit is None:
        return quantity.value
    factor, kind = si_unit(quantity.unit)
    if kind != unit:
        raise InputError(f"{where}: '{quantity.unit}' is no unit of what is measured in {unit}; write one that is")
    return quantity.value * factor


def positive_value(quantity: Amount, unit: str, where: str) -> float:
    """As `si_value`, above zero.

    Raises:
        InputError: it is not.
    """
    value = si_value(quantity, unit, where)
    if not value > 0.0:
        raise InputError(f"{where} = {quantity.value:g} is not positive; give a positive one")
    return value


def angle_value(quantity: Amount, where: str, example: float = 22.0) -> float:
    """A positive angle below half a turn [rad].

    Raises:
        InputError: it is not; degrees were probably meant.
    """
    value = positive_value(quantity, "rad", where)
    if value >= _HALF_TURN:
        raise InputError(_not_an_angle(quantity, where, example))
    return value


def rate_value(quantity: Amount, unit: str, where: str) -> float:
    """A positive rate of what is measured in `unit`, SI; a bare number of half a turn a second was meant in degrees.

    Raises:
        InputError: it is not positive, of another kind, or such a number.
    """
    value = positive_value(quantity, rate_unit(unit), where)
    if unit == "rad" and quantity.unit is None and value >= _HALF_TURN:
        raise InputError(
            f"{where} = {value:g} is half a turn a second or more; write it with its unit, such as "
            f'{{ value = {value:g}, unit = "deg/s" }}'
        )
    return value


def heading_value(quantity: Amount, where: str) -> float:
    """A heading to the waves, 0 following to pi head [rad].

    Raises:
        InputError: it lies outside.
    """
    value = si_value(quantity, "rad", where)
    if not -1e-9 <= value <= math.pi + 1e-9:
        raise InputError(
            f"{where} = {quantity.value:g} is no heading to the waves from 0 (following) to half a turn (head); "
            'write it with its unit, such as { value = 90, unit = "deg" }'
        )
    return min(max(value, 0.0), math.pi)


def _not_an_angle(quantity: Amount, where: str, example: float) -> str:
    return (
        f"{where} = {quantity.value:g} is half a turn or more; write it with its unit, such as "
        f'{{ value = {example:g}, unit = "deg" }}'
    )
