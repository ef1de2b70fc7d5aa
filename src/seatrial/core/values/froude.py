"""Froude similarity: a record of one scale, expressed at another."""

from dataclasses import replace

import numpy as np

from seatrial.core.values.errors import InputError
from seatrial.core.values.record import Record

# exponent of the length ratio by base unit, equal gravity and density (ITTC 2021, 7.5-02-06-01, Froude scaling)
_EXPONENTS = {"1": 0.0, "rad": 0.0, "m": 1.0, "s": 0.5, "rps": -0.5, "N": 3.0, "kg": 3.0}


def froude_factor(unit: str, ratio: float) -> float:
    """Return the factor from model to ship for a quantity of SI `unit` at length ratio `ratio` = L_ship / L_model.

    Raises:
        InputError: the ratio is not positive, or the unit has no known exponent.
    """
    if not (np.isfinite(ratio) and ratio > 0):
        raise InputError(f"scale must be a positive number, not {ratio:g}; give 45.7 for a model 1:45.7")
    return float(ratio ** _exponent(unit))


def _exponent(unit: str) -> float:
    """Return the exponent of a product of powers over another, such as ``kg m^2/s``."""
    total, sign = 0.0, 1.0
    for side in unit.split("/"):
        for factor in side.split():
            base, _, power = factor.partition("^")
            if base not in _EXPONENTS or not (power or "1").isdecimal():
                raise InputError(
                    f"no Froude exponent is known for unit '{unit}'; convert the channel to an SI unit first"
                )
            total += sign * _EXPONENTS[base] * int(power or "1")
        sign = -1.0
    return total


def froude_scaled(record: Record, ratio: float) -> Record:
    """Return the record at `ratio` times its scale (ratio > 1: model to ship; the inverse is `1 / ratio`).

    Lengths and reference points x ratio, time and velocities x ratio^1/2, rates x ratio^-1/2, forces x ratio^3,
    moments x ratio^4; equal water density at both scales.

    Raises:
        InputError: as `froude_factor`.
    """
    if ratio == 1.0:
        return record
    length, seconds = froude_factor("m", ratio), froude_factor("s", ratio)
    channels = {}
    for symbol, channel in record.channels.items():
        scaled = channel.with_values(channel.values * froude_factor(channel.unit, ratio))
        channels[symbol] = replace(
            scaled, reference_point=channel.reference_point * length, sample_s=channel.sample_s * seconds
        )
    time = record.time * seconds
    return replace(record, time=time, channels=channels).with_step(f"Froude-scaled by {ratio:g}")
