"""A linear loop simulated in time: output, actuator and actuator rate, met by one series of the disturbance."""

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.numerics.kernels.linear import replay
from seatrial.numerics.kernels.propagate import propagators
from seatrial.physics.loops.loop_states import StateSpace


def loop_record(states: StateSpace, gains: Array, disturbance: Array, dt: float) -> Array:
    """Return output, actuator and actuator rate (n, 3) with the gains (g,), from rest, by a compiled scalar loop.

    The disturbance (n,) is held over each step of `dt` [s]: x_{k+1} = e^(A h) x_k + h phi_1(A h) b w_k, exact.

    Raises:
        InputError: a disturbance of fewer than two samples or with gaps.
    """
    if len(disturbance) < 2 or not np.isfinite(disturbance).all():
        raise InputError("the disturbance of a loop needs two samples or more, without gaps")
    A, row = states.closed_loop_matrix(gains), states.actuator_row(gains)
    n = len(A)
    held = propagators(A, np.zeros((0, n, n)), dt)[0]
    rows = np.stack([states.c, row, row @ A])
    direct = np.array([[0.0], [0.0], [row @ states.b]])
    out, failed = np.empty((len(disturbance), 3)), np.full(1, -1, dtype=np.int64)
    inputs = np.ascontiguousarray(disturbance, dtype=np.float64)[:, None]
    replay(
        held[:1].copy(), (held[1] @ states.b)[None, :, None], np.zeros((1, n, 1)), rows[None], direct[None],
        np.zeros(1, dtype=np.int64), inputs, np.array([0, len(disturbance)]), 1, np.zeros((1, n)), out, failed,
    )  # fmt: skip
    return out
