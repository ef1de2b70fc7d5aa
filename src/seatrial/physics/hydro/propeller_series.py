"""Open-water thrust of the Wageningen B series, as the quadratic in J that manoeuvring models take."""

import numpy as np

from seatrial.core.values import Array

OOSTERVELD = "Oosterveld & van Oossanen 1975, Int. Shipbuilding Progress 22(251), 251-262, B series at Re 2e6"
# coefficient, powers of J, P/D, A_E/A_0, Z: the thrust polynomial of the source, the same in two transcriptions
_THRUST = np.array([
    (0.00880496, 0, 0, 0, 0), (-0.204554, 1, 0, 0, 0), (0.166351, 0, 1, 0, 0), (0.158114, 0, 2, 0, 0),
    (-0.147581, 2, 0, 1, 0), (-0.481497, 1, 1, 1, 0), (0.415437, 0, 2, 1, 0), (0.0144043, 0, 0, 0, 1),
    (-0.0530054, 2, 0, 0, 1), (0.0143481, 0, 1, 0, 1), (0.0606826, 1, 1, 0, 1), (-0.0125894, 0, 0, 1, 1),
    (0.0109689, 1, 0, 1, 1), (-0.133698, 0, 3, 0, 0), (0.00638407, 0, 6, 0, 0), (-0.00132718, 2, 6, 0, 0),
    (0.168496, 3, 0, 1, 0), (-0.0507214, 0, 0, 2, 0), (0.0854559, 2, 0, 2, 0), (-0.0504475, 3, 0, 2, 0),
    (0.010465, 1, 6, 2, 0), (-0.00648272, 2, 6, 2, 0), (-0.00841728, 0, 3, 0, 1), (0.0168424, 1, 3, 0, 1),
    (-0.00102296, 3, 3, 0, 1), (-0.0317791, 0, 3, 1, 1), (0.018604, 1, 0, 2, 1), (-0.00410798, 0, 2, 2, 1),
    (-0.000606848, 0, 0, 0, 2), (-0.0049819, 1, 0, 0, 2), (0.0025983, 2, 0, 0, 2), (-0.000560528, 3, 0, 0, 2),
    (-0.00163652, 1, 2, 0, 2), (-0.000328787, 1, 6, 0, 2), (0.000116502, 2, 6, 0, 2), (0.000690904, 0, 0, 1, 2),
    (0.00421749, 0, 3, 1, 2), (0.0000565229, 3, 6, 1, 2), (-0.00146564, 0, 3, 2, 2),
])  # fmt: skip
_HIGHEST_J, _POINTS = 0.6, 25  # to which the quadratic is fitted, and where: a ship's propeller works at 0.2 to 0.5


def thrust_coefficient(J: Array, pitch_ratio: float, area_ratio: float, blades: int) -> Array:
    """Return K_T of a B-series propeller at the advance ratios J, shape (n,)."""
    size, powers = _THRUST[:, 0], _THRUST[:, 1:]
    factors = pitch_ratio ** powers[:, 1] * area_ratio ** powers[:, 2] * float(blades) ** powers[:, 3]
    return np.asarray(J, dtype=float)[:, None] ** powers[:, 0] @ (size * factors)


def thrust_quadratic(pitch_ratio: float, area_ratio: float, blades: int) -> tuple[float, float, float]:
    """Return k_0, k_1, k_2 of K_T = k_0 + k_1 J + k_2 J^2, least squares over J from 0 to 0.6."""
    J = np.linspace(0.0, _HIGHEST_J, _POINTS)
    k_2, k_1, k_0 = np.polyfit(J, thrust_coefficient(J, pitch_ratio, area_ratio, blades), 2)
    return float(k_0), float(k_1), float(k_2)
