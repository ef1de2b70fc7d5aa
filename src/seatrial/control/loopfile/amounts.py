"""Amounts of a loop file in SI units, tested for their kind; every sentence begins with the key."""

import math

from seatrial.core.values import NOTATION, InputError, si
from seatrial.data.trial.schema import Amount

_HALF_TURN = math.pi
_RATES = {"rad": "rad/s", "m": "m/s", "m/s": "m/s^2"}


def unit_of(symbol: str) -> str:
    """SI unit of a symbol of the notation; 1 for others."""
    return NOTATION[symbol].unit if symbol in NOTATION else "1"


def rate_unit(unit: str) -> str:
    """SI unit of the rate of what is measured in `unit`."""
    return _RATES.get(unit, f"{unit} per s")


def amount(given: Amount, unit: str, where: str) -> float:
    """The amount in SI, which must be of the kind that `unit` measures.

    Raises:
        InputError: its unit is of another kind.
    """
    if given.unit is None:
        return given.value
    factor, kind = si(given.unit)
    if kind != unit:
        raise InputError(f"{where}: '{given.unit}' is no unit of what is measured in {unit}; write one that is")
    return given.value * factor


def positive(given: Amount, unit: str, where: str) -> float:
    """As `amount`, above zero.

    Raises:
        InputError: it is not.
    """
    value = amount(given, unit, where)
    if not value > 0.0:
        raise InputError(f"{where} = {given.value:g} is not positive; give a positive one")
    return value


def angle(given: Amount, where: str, example: float = 22.0) -> float:
    """A positive angle below half a turn [rad].

    Raises:
        InputError: it is not; degrees were probably meant.
    """
    value = positive(given, "rad", where)
    if value >= _HALF_TURN:
        raise InputError(_not_an_angle(given, where, example))
    return value


def rate(given: Amount, unit: str, where: str) -> float:
    """A positive rate of what is measured in `unit`, SI; a bare number of half a turn a second was meant in degrees.

    Raises:
        InputError: it is not positive, of another kind, or such a number.
    """
    value = positive(given, rate_unit(unit), where)
    if unit == "rad" and given.unit is None and value >= _HALF_TURN:
        raise InputError(
            f"{where} = {value:g} is half a turn a second or more; write it with its unit, such as "
            f'{{ value = {value:g}, unit = "deg/s" }}'
        )
    return value


def heading(given: Amount, where: str) -> float:
    """A heading to the waves, 0 following to pi head [rad].

    Raises:
        InputError: it lies outside.
    """
    value = amount(given, "rad", where)
    if not -1e-9 <= value <= math.pi + 1e-9:
        raise InputError(
            f"{where} = {given.value:g} is no heading to the waves from 0 (following) to half a turn (head); "
            'write it with its unit, such as { value = 90, unit = "deg" }'
        )
    return min(max(value, 0.0), math.pi)


def _not_an_angle(given: Amount, where: str, example: float) -> str:
    return (
        f"{where} = {given.value:g} is half a turn or more; write it with its unit, such as "
        f'{{ value = {example:g}, unit = "deg" }}'
    )
