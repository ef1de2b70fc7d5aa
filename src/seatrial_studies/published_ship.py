"""The ship of Qi et al. 2025 and Meng et al. 2014: its speed, sea and coefficients at the headings of the tables."""

from dataclasses import replace

from seatrial.core.values import InputError
from seatrial.physics.models import PARAMETER_SETS, ParameterSet, parameter_set

_SET_PREFIX = "qi2025-"
SPEED = 18.0 * 1852.0 / 3600.0
"""Speed of the ship, m/s: 18 kn (Qi et al. 2025, section 4)."""
SIGNIFICANT_HEIGHT = 2.27
"""Significant height of the sea, m (Qi et al. 2025, section 4)."""
HEADINGS = tuple(int(name.removeprefix(_SET_PREFIX)) for name in PARAMETER_SETS if name.startswith(_SET_PREFIX))
"""Headings to the waves of tables 2 to 4, degrees; 180 is head sea."""
B53_NOTE = "b53 is negative; its magnitude is shown, as the paper prints it."
"""What a table or figure with b53 by magnitude says below it."""
SHIP = parameter_set(f"{_SET_PREFIX}{HEADINGS[0]}").ship


def theoretical_coefficients(heading: int, *, printed_sign: bool = False) -> ParameterSet:
    """Return the theoretical coefficients at a heading of the tables; b53 negative unless `printed_sign`.

    Args:
        heading: degrees.
        printed_sign: take b53 positive, as the tables print it.

    Raises:
        InputError: the paper gives none at this heading.
    """
    if heading not in HEADINGS:
        raise InputError(f"Qi et al. 2025 give no theoretical values at {heading} degrees; known are 90, 135, 180")
    published = parameter_set(f"{_SET_PREFIX}{heading}")
    if not printed_sign:
        return published
    values = {**published.values, "b53": -published.values["b53"]}
    return replace(published, values=values, note="b53 positive as printed")
