"""A warning where stated particulars do not belong to one hull: an inertia of another length, more mass than water."""

import math

from seatrial.core.text.numbers import significant
from seatrial.core.values import Finding, Severity, Ship
from seatrial.physics.hydro.dispersion import SEA_WATER

_GYRADII = (0.2, 0.3)  # of the length, in yaw and pitch; chosen: ITTC 7.5-02-07-02.1 takes 0.25 where nothing is known
_USUAL_GYRADIUS = 0.25
_FULLEST = 1.1  # C_b of a box, and a tenth for appendages and trim; chosen
_INERTIAS = ("I_z", "I5")
_DIGITS = 4  # significant, of an advised value


def hull_value_findings(ship: Ship) -> tuple[Finding, ...]:
    """Return warnings `hull-values`: a radius of gyration that ships do not have, more mass than a box of water."""
    values = ship.particulars
    mass, length = values.get("m"), values.get("L")
    if not mass or not length:
        return ()
    findings = [
        _gyradius_finding(name, values[name], mass, length) for name in _INERTIAS if values.get(name, 0.0) > 0.0
    ]
    box = values.get("rho", SEA_WATER) * length * values.get("B", math.inf) * values.get("d", math.inf)
    if mass > _FULLEST * box:
        water = significant(box, _DIGITS)
        message = f"m = {significant(mass, _DIGITS)} kg is more than the {water} kg of water in a box of L, B and d"
        findings.append(_finding(message, "correct m, L, B or d under [ship]"))
    return tuple(finding for finding in findings if finding is not None)


def _gyradius_finding(name: str, inertia: float, mass: float, length: float) -> Finding | None:
    radius = math.sqrt(inertia / mass) / length
    low, high = _GYRADII
    if low <= radius <= high:
        return None
    usual = significant(mass * (_USUAL_GYRADIUS * length) ** 2, _DIGITS)
    stated = f"{name} = {significant(inertia, _DIGITS)} kg m^2 with m = {significant(mass, _DIGITS)} kg"
    return _finding(
        f"{stated} is a radius of gyration of {significant(radius, 2)} L, ships have {low:g} to {high:g}",
        f"{name} = {usual} under [ship] for {_USUAL_GYRADIUS:g} L; or correct m or L",
    )


def _finding(message: str, advice: str) -> Finding:
    return Finding(Severity.WARNING, "hull-values", message, "", advice, "coefficients scale with stated inertias")
