"""A boat with two fixed thrusters, simulated by hand, for drafts of its logs."""

import numpy as np

from seatrial.core.values import Array

STEP = 0.1  # s


def two_thrusters() -> dict[str, Array]:
    """Steps of the left and the right command, and the motion they give; SI, starboard positive."""
    time = STEP * np.arange(1500)
    left = np.sign(np.sin(0.11 * time)) * (0.5 + 0.4 * np.sign(np.sin(0.031 * time)))
    right = np.sign(np.cos(0.07 * time)) * (0.5 - 0.3 * np.sign(np.sin(0.043 * time)))
    u, r, psi, x0, y0 = (np.zeros(time.size) for _ in range(5))
    for k in range(1, time.size):
        pull = left[k - 1] * abs(left[k - 1]), right[k - 1] * abs(right[k - 1])
        u[k] = u[k - 1] + STEP * (0.4 * (pull[0] + pull[1]) - 0.3 * u[k - 1])
        r[k] = r[k - 1] + STEP * (0.8 * (pull[0] - pull[1]) - 1.2 * r[k - 1])
        psi[k] = psi[k - 1] + STEP * r[k - 1]
        x0[k] = x0[k - 1] + STEP * u[k - 1] * np.cos(psi[k - 1])
        y0[k] = y0[k - 1] + STEP * u[k - 1] * np.sin(psi[k - 1])
    return {"t": time, "left": left, "right": right, "u": u, "r": r, "psi": psi, "x0": x0, "y0": y0}
