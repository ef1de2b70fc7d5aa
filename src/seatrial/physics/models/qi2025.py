"""The ship of Qi et al. 2025: particulars of its table 1, "theoretical values" of its tables 2 to 4.

The tables print b53 without a sign. Strip theory says b35 = b0 + U a33, b53 = b0 - U a33, so (b35 + |b53|) / (2 a33)
must be the speed: it is 9.269, 9.266, 9.267 m/s at the three headings, the 18 kn of the paper, only if b53 is negative.
"""

from seatrial.core.values import Ship
from seatrial.physics.models.heave_pitch_coefficients import HEAVE_PITCH_COEFFICIENTS
from seatrial.physics.models.parameter_set import ParameterSet

SOURCE = "Qi et al. 2025, improved wild horse optimizer, tables 1-4"
# L from I5/m = (0.25 L)^2, B from the section area of table 1 over the draught
SHIP = Ship(
    "ship of Qi et al. 2025",
    {"L": 60.0, "B": 16.2 / 2.27, "d": 2.27, "m": 4.42e5, "I5": 9.945e7,
     "c33": 3.15e6, "c35": 6.83e6, "c53": 6.83e6, "c55": 6.54e8},
    SOURCE,
)  # fmt: skip
# in the order of HEAVE_PITCH_COEFFICIENTS, magnitudes as printed
_PRINTED_COEFFICIENTS = {
    90: (8.045e5, 7.753e6, 2.595e8, 1.479e7, 9.369e5, 1.159e7, 2.885e8, 3.324e6),
    135: (6.311e5, 3.281e6, 1.525e8, 7.865e6, 8.033e5, 9.429e6, 2.091e8, 2.267e6),
    180: (6.101e5, 2.663e6, 1.377e8, 6.611e6, 7.400e5, 8.951e6, 1.873e8, 2.356e6),
}
HEADINGS = tuple(_PRINTED_COEFFICIENTS)


def theoretical_coefficients(heading: int) -> ParameterSet:
    """Return the theoretical coefficients at a heading to the waves of 90, 135 or 180 degrees, 18 kn; b53 negative.

    Raises:
        KeyError: the paper gives none at this heading.
    """
    values = dict(zip(HEAVE_PITCH_COEFFICIENTS, _PRINTED_COEFFICIENTS[heading], strict=True))
    values["b53"] = -values["b53"]
    note = "b53 negative by strip theory; the tables drop the sign"
    return ParameterSet(f"qi2025-{heading}", "heave_pitch", SHIP, values, SOURCE, note)
