"""Amounts of a loop file in SI units, tested for their kind; every sentence begins with the key."""

import math

from seatrial.core.values import NOTATION, InputError, si_unit
from seatrial.data.trial.amounts import Amount

_HALF_TURN = math.pi
_ROUNDING = 1e-9  # rad by which a heading may lie outside
_RATES = {"rad": "rad/s", "m": "m/s", "m/s": "m/s^2"}


def symbol_unit(symbol: str) -> str:
    """Return the SI unit of a symbol of the notation; 1 for others."""
    return NOTATION[symbol].unit if symbol in NOTATION else "1"


def rate_unit(unit: str) -> str:
    """Return the SI unit of the rate of what is measured in `unit`."""
    return _RATES.get(unit, f"{unit} per s")


def si_value(quantity: Amount, unit: str, where: str) -> float:
    """Return the amount in SI, which must be of the kind that `unit` measures."""
    if quantity.unit is None:
        return quantity.value
    factor, kind = si_unit(quantity.unit)
    if kind != unit:
        raise InputError(f"{where}: '{quantity.unit}' is no unit of what is measured in {unit}; write one that is")
    return quantity.value * factor


def positive_value(quantity: Amount, unit: str, where: str) -> float:
    """Return the amount of `si_value`, which must be above zero."""
    value = si_value(quantity, unit, where)
    if not value > 0.0:
        raise InputError(f"{where} = {quantity.value:g} is not positive; give a positive one")
    return value


def angle_value(quantity: Amount, where: str, example: float = 22.0) -> float:  # deg; 22 is a usual limit of fins
    """Return a positive angle below half a turn [rad]; degrees were probably meant by others."""
    value = positive_value(quantity, "rad", where)
    if value >= _HALF_TURN:
        raise InputError(
            f"{where} = {quantity.value:g} is half a turn or more; write it with its unit, such as "
            f'{{ value = {example:g}, unit = "deg" }}'
        )
    return value


def rate_value(quantity: Amount, unit: str, where: str) -> float:
    """A positive rate of what is measured in `unit`, SI; a bare number of half a turn a second was meant in degrees."""
    value = positive_value(quantity, rate_unit(unit), where)
    if unit == "rad" and quantity.unit is None and value >= _HALF_TURN:
        raise InputError(
            f"{where} = {value:g} is half a turn a second or more; write it with its unit, such as "
            f'{{ value = {value:g}, unit = "deg/s" }}'
        )
    return value


def heading_value(quantity: Amount, where: str) -> float:
    """Return a heading to the waves, 0 following to pi head [rad]."""
    value = si_value(quantity, "rad", where)
    if not -_ROUNDING <= value <= math.pi + _ROUNDING:
        raise InputError(
            f"{where} = {quantity.value:g} is no heading to the waves from 0 (following) to half a turn (head); "
            'write it with its unit, such as { value = 90, unit = "deg" }'
        )
    return min(max(value, 0.0), math.pi)
