"""What regular waves alone cannot identify: added mass, damping and excitation when nothing ties them together."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.values import Array
from seatrial_studies.section2d.oscillator import MeasuredResponse

ORDER = 2


def untied_mass_error(
    observations: Sequence[MeasuredResponse], inertia: float, stiffness: float, order: int = ORDER
) -> float:
    """Return the standard error [kg, kg m^2] of an added mass when the excitation is only known to be smooth.

    Unknown: added mass, damping, the excitation's log amplitude and phase, each a polynomial of that order in
    frequency; neither Haskind's relation nor a shape. Linearised at the theory, with each response's own spread; the
    error is that at the mean frequency. Infinite where the periods do not determine the unknowns at all.
    """
    omegas = np.array([o.omega for o in observations])
    spread = np.array([o.relative_sd for o in observations])
    scaled = (omegas - omegas.mean()) / max(float(np.ptp(omegas)), 1e-9)
    smooth = np.stack([scaled**k for k in range(order + 1)], axis=1)
    impedance = np.array(
        [
            stiffness - o.omega**2 * (inertia + o.theory.added_mass) + 1j * o.omega * o.theory.damping
            for o in observations
        ]
    )
    by_mass, by_damping = omegas**2 / impedance, -1j * omegas / impedance
    rows = (
        np.column_stack([by_mass[:, None] * smooth, by_damping[:, None] * smooth, smooth, 1j * smooth])
        / spread[:, None]
    )
    jacobian: Array = np.concatenate([rows.real, rows.imag])
    sizes = np.linalg.norm(jacobian, axis=0)
    values = np.linalg.svd(jacobian / sizes, compute_uv=False)
    if len(values) < jacobian.shape[1] or values[-1] < 1e-9 * values[0]:
        return float("inf")
    information = (jacobian / sizes).T @ (jacobian / sizes)
    return float(np.sqrt(np.linalg.inv(information)[0, 0]) / sizes[0])
