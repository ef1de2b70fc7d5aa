"""Controllers with more structure on the same plant: a loop with band-pass and low-pass terms or a notch added."""

from dataclasses import replace

import numpy as np

from seatrial.control.loopfile.quantities import positive_value
from seatrial.control.loopfile.schema import ExtendedStructureTable, PassTable
from seatrial.core.values import InputError, Parameter, Parameters
from seatrial.physics.loops import Block, Term, TransferLoop
from seatrial.physics.loops.structures import (
    ADDED_GAINS,
    FREQUENCIES_AND_DAMPINGS,
    PUBLISHED_GAINS,
    ROLL,
    band_pass,
    five_gain_loop,
    low_pass,
    notch,
    with_filters,
    with_terms,
)

_STRUCTURE_KINDS = ("band-pass", "low-pass")
_NOTCH_DEFAULTS = 0.5, 0.1  # damping ratio and depth of a notch, as in `NotchTable`; chosen
_ROUNDING = 1e-9  # imaginary part over size of a pole, below which it does not swing


def extended_structure(
    loop: TransferLoop, table: ExtendedStructureTable, where: str, wave_frequency: float | None = None
) -> TransferLoop:
    """Return the loop with the filters of the table; band-pass and low-pass have gains of their own, KB and KL.

    Where the file does not set them they stand at the multiples of the plant's own frequency that were found for the
    published fins; a notch at the frequency [rad/s] at which waves move a ship that does not swing by itself. Without
    bounds the new gains may lie within the largest bound of the loop's own, to either side.
    """
    made = _with_terms(loop, table, where)
    if "notch" in table.add:
        made = with_filters(made, _notch(loop, table, where, wave_frequency))
    return replace(made, name=table.name or f"{loop.name} with {' and '.join(table.add)}")


def _with_terms(loop: TransferLoop, table: ExtendedStructureTable, where: str) -> TransferLoop:
    shapes = zip(
        ADDED_GAINS, _STRUCTURE_KINDS, (table.band_pass, table.low_pass), FREQUENCIES_AND_DAMPINGS, strict=True
    )
    made = {
        gain: _part(loop, kind, shape, default, where) for gain, kind, shape, default in shapes if kind in table.add
    }
    if not made:
        return loop
    lower, upper = _bounds(loop, table, where)
    is_published = loop.gains.names == tuple(PUBLISHED_GAINS) and len(made) == len(ADDED_GAINS)
    try:
        if is_published:
            full = five_gain_loop(loop, *made.values())
        else:
            gains = tuple(
                Parameter(name, 0.0, "1", -1.0, 1.0, free=True, source="loop file", meaning=f"gain of the {block.name}")
                for name, block in made.items()
            )
            full = with_terms(loop, *(Term(name, block) for name, block in made.items()), gains=gains)
    except InputError as error:
        raise InputError(f"{where}.add: {error}") from None
    gains = full.gains
    for name in made:
        gains = gains.bounded(name, lower, upper)
    return replace(
        full, gains=_clipped_to_bounds(gains.with_values({p.name: p.value for p in loop.gains if not p.free}))
    )


def _part(loop: TransferLoop, kind: str, shape: PassTable | None, default: tuple[float, float], where: str) -> Block:
    make = {"band-pass": band_pass, "low-pass": low_pass}[kind]
    if shape is None:
        own = abs(ROLL.poles[0])
        return make(default[0] / own * _natural_frequency(loop, f"{where}.{kind.replace('-', '_')}"), default[1])
    return make(positive_value(shape.omega, "rad/s", f"{where}.{kind.replace('-', '_')}.omega"), shape.damping)


def _notch(loop: TransferLoop, table: ExtendedStructureTable, where: str, wave_frequency: float | None) -> Block:
    if table.notch is None and wave_frequency is not None:
        return notch(wave_frequency, *_NOTCH_DEFAULTS)
    if table.notch is None:
        return notch(_natural_frequency(loop, f"{where}.notch"), *_NOTCH_DEFAULTS)
    omega = positive_value(table.notch.omega, "rad/s", f"{where}.notch.omega")
    return notch(omega, table.notch.damping, table.notch.depth)


def _clipped_to_bounds(gains: Parameters) -> Parameters:
    """Return values moved into their bounds."""
    return gains.with_values({p.name: min(max(p.value, p.lower), p.upper) for p in gains.free})


def _bounds(loop: TransferLoop, table: ExtendedStructureTable, where: str) -> tuple[float, float]:
    reach = max(max(abs(p.lower), abs(p.upper)) for p in loop.gains.free)
    lower = -reach if table.lower is None else table.lower
    upper = reach if table.upper is None else table.upper
    if not lower < upper:
        raise InputError(f"{where}: lower = {lower:g} is not below upper = {upper:g}; give the smaller first")
    return lower, upper


def _natural_frequency(loop: TransferLoop, where: str) -> float:
    """Return the frequency of the least damped pair of poles of the disturbance's block [rad/s]."""
    poles = loop.disturbance.poles
    swinging = poles[poles.imag > _ROUNDING * np.abs(poles)]
    if not swinging.size:
        raise InputError(f"{where}: nothing swings by itself that could set its frequency; give omega and damping")
    return float(np.abs(swinging[np.argmin(-swinging.real / np.abs(swinging))]))
