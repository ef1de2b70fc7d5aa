"""Radius of gyration in roll and metacentric height: one is given or assumed, the natural period gives the other."""

import math
from dataclasses import dataclass

from seatrial.core.results.ship_motions import IntervalEstimate
from seatrial.core.text.numbers import significant
from seatrial.core.values import Finding, Severity, Ship
from seatrial.physics.hydro.free_roll import gyradius_of, metacentric_height

GYRADIUS_WITH_ADDED_INERTIA, DRY_GYRADIUS, METACENTRIC_HEIGHT = "k_xx_prime", "k_xx", "GM"

# share of the moment of inertia that the water adds in roll, and radius of gyration with it over the breadth; chosen
ADDED_INERTIA_SHARE, GYRADIUS_OVER_BREADTH = (0.05, 0.18, 0.30), (0.35, 0.40, 0.45)


@dataclass(frozen=True)
class RollInertia:
    """Radius of gyration with added inertia [m], metacentric height [m], and what was given or assumed of them."""

    gyradius: IntervalEstimate | None
    metacentric_height: IntervalEstimate | None
    source: str


def roll_inertia(ship: Ship, c_1: IntervalEstimate) -> RollInertia:
    """Return GM by the ship's `k_xx_prime`, else by `k_xx`; the radius by its `GM`; else GM by the breadth.

    c_1: square of the natural frequency [1/s^2] with its 95 % interval.
    """
    particulars = ship.particulars
    if GYRADIUS_WITH_ADDED_INERTIA in particulars:
        k = particulars[GYRADIUS_WITH_ADDED_INERTIA]
        return _by_gyradius(c_1, (k, k, k), f"{GYRADIUS_WITH_ADDED_INERTIA} of the ship, {k:.4g} m, taken as exact")
    if DRY_GYRADIUS in particulars:
        dry = particulars[DRY_GYRADIUS]
        low, middle, high = (dry * math.sqrt(1.0 + share) for share in ADDED_INERTIA_SHARE)
        share = _range_text(ADDED_INERTIA_SHARE, 100.0)
        source = f"{DRY_GYRADIUS} of the ship, {dry:.4g} m, and an added inertia of {share} % of it, chosen"
        return _by_gyradius(c_1, (low, middle, high), f"{source}; {GYRADIUS_WITH_ADDED_INERTIA} would replace this")
    if METACENTRIC_HEIGHT in particulars:
        return _by_height(c_1, particulars[METACENTRIC_HEIGHT])
    if "B" in particulars:
        low, middle, high = (share * particulars["B"] for share in GYRADIUS_OVER_BREADTH)
        source = f"a radius of gyration of {_range_text(GYRADIUS_OVER_BREADTH, 1.0)} of the breadth, chosen"
        keys = f"{METACENTRIC_HEIGHT}, {GYRADIUS_WITH_ADDED_INERTIA} or {DRY_GYRADIUS}"
        return _by_gyradius(c_1, (low, middle, high), f"{source}; {keys} under [ship] would replace this")
    keys = f"{METACENTRIC_HEIGHT}, {GYRADIUS_WITH_ADDED_INERTIA}, {DRY_GYRADIUS} or B"
    return RollInertia(None, None, f"the inertia is not known; give {keys} under [ship]")


def gyradius_findings(ship: Ship, gyradius: IntervalEstimate | None) -> tuple[Finding, ...]:
    """Return a warning `roll-gyradius` where GM and the period give a radius that is unusual for the stated breadth."""
    values = ship.particulars
    if gyradius is None or METACENTRIC_HEIGHT not in values or not values.get("B", 0.0) > 0.0:
        return ()
    low, usual, high = (share * values["B"] for share in GYRADIUS_OVER_BREADTH)
    if low <= gyradius.value <= high:
        return ()
    share, height = gyradius.value / values["B"], values[METACENTRIC_HEIGHT]
    return (Finding(
        Severity.WARNING, "roll-gyradius", f"GM = {height:g} m and the period give a radius of gyration of "
        f"{significant(share, 2)} of the breadth, ships have {_range_text(GYRADIUS_OVER_BREADTH, 1.0)}", "",
        f"check GM, B and the loading of the tests: with {GYRADIUS_OVER_BREADTH[1]:g} of the breadth GM would be "
        f"{significant(height * (usual / gyradius.value) ** 2, 2)} m",
        "the radius, and moments in newton metres, follow the stated GM",
    ),)  # fmt: skip


def _by_gyradius(c_1: IntervalEstimate, radii: tuple[float, float, float], source: str) -> RollInertia:
    """radii: least, most likely and largest [m]; GM has the whole of their range in its own."""
    low, middle, high = radii
    height = IntervalEstimate(
        metacentric_height(c_1.value, middle), metacentric_height(c_1.lower, low), metacentric_height(c_1.upper, high)
    )
    return RollInertia(IntervalEstimate(middle, low, high), height, source)


def _by_height(c_1: IntervalEstimate, height: float) -> RollInertia:
    radius = IntervalEstimate(
        gyradius_of(c_1.value, height), gyradius_of(c_1.upper, height),
        gyradius_of(c_1.lower, height) if c_1.lower > 0.0 else math.inf,
    )  # fmt: skip
    source = (
        f"{METACENTRIC_HEIGHT} of the ship, {height:.4g} m, taken as exact (the radius goes with its root: half its "
        "error in per cent)"
    )
    return RollInertia(radius, IntervalEstimate(height, height, height), source)


def _range_text(values: tuple[float, float, float], factor: float) -> str:
    low, middle, high = (f"{factor * value:.3g}" for value in values)
    return f"{middle} ({low} to {high})"
