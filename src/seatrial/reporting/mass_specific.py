"""Units of a craft whose thrust is not known in newtons: its forces and masses are those on each kilogram."""

import re
from collections.abc import Iterator
from dataclasses import replace

from seatrial.core.results import Fit

_FACTOR = re.compile(r"(?P<name>[A-Za-z]+)(\^(?P<power>[\d.]+))?")


def with_mass_specific_units(fit: Fit) -> Fit:
    """Return the fit with the units that its coefficients have: those of the model, or these over kilograms.

    Without a thrust in newtons the equations hold for forces and masses over m + m_x.
    """
    if fit.thruster_craft is None or fit.thruster_craft.force_unit == "N":
        return fit
    return replace(fit, coefficients=tuple(replace(c, unit=mass_specific_unit(c.unit)) for c in fit.coefficients))


def mass_specific_unit(unit: str) -> str:
    """Return a unit over kilograms to the power in which it holds mass or force: ``kg m^2/s`` -> ``m^2/s``."""
    powers = dict(_powers(unit))
    mass = powers.get("kg", 0.0) + powers.get("N", 0.0)
    if not mass:
        return unit
    powers["kg"] = powers.get("kg", 0.0) - mass
    above = [_text(name, power) for name, power in powers.items() if power > 0.0]
    below = [_text(name, -power) for name, power in powers.items() if power < 0.0]
    if not below:
        return " ".join(above) or "1"
    divisor = below[0] if len(below) == 1 else f"({' '.join(below)})"
    return f"{' '.join(above) or '1'}/{divisor}"


def _powers(unit: str) -> Iterator[tuple[str, float]]:
    """Symbols of a unit with their powers, those below the line negative."""
    for sign, part in zip((1.0, -1.0), unit.split("/"), strict=False):
        for factor in _FACTOR.finditer(part):
            yield factor["name"], sign * float(factor["power"] or 1.0)


def _text(name: str, power: float) -> str:
    return name if power == 1.0 else f"{name}^{power:g}"
