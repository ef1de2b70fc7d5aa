"""Loops whose answers are known, and the variances of any loop by Lyapunov's equation."""

import math

import numpy as np
from scipy.linalg import solve_continuous_lyapunov

from seatrial.core.values import Array, Parameter, Parameters
from seatrial.physics.loops import Block, LoopSignal, Term, TransferLoop
from seatrial.physics.loops.loop import controllable_form
from seatrial.physics.loops.loop_states import state_space
from seatrial.physics.loops.objective import variance
from seatrial.physics.loops.performance import distinct_variances

ROLL = variance("roll", "rad^2", LoopSignal.OUTPUT)
FIN = variance("fin", "rad^2", LoopSignal.ACTUATOR)
RATE = variance("rate", "rad^2/s^2", LoopSignal.ACTUATOR, 1)
ROWS = distinct_variances((ROLL, FIN, RATE))[0]
# a disturbance of white noise of one-sided density 1 through a filter: its variances have a closed form
SHAPED = Block("sea", (1.0, 0.0), (1.0, 0.54, 0.81))


def second_order(damping: float, gain: float = 1.0) -> TransferLoop:
    """L = k / (s (s + 2 zeta)), disturbed at the output of 1 / (s + 2 zeta)^2."""
    return TransferLoop(
        "second order",
        sensor=(),
        terms=(Term("k", Block("proportional")),),
        filters=(),
        servo=(),
        plant=Block("plant", (1.0,), (1.0, 2.0 * damping, 0.0)),
        disturbance=Block("met", (1.0,), (1.0, 2.0 * damping, damping**2)),
        gains=Parameters((Parameter("k", gain, "1", 0.0, 4.0, free=True),)),
    )


def lyapunov_variances(loop: TransferLoop, gains: Array, shaped: Block = SHAPED) -> Array:
    """Variances of output, actuator and actuator rate, (3,); white noise of one-sided density 1 has intensity pi."""
    made = state_space(loop)
    fa, fb, fc, _ = controllable_form(shaped)
    n, m = len(made.b), len(fb)
    A = np.zeros((n + m, n + m))
    A[:n, :n], A[:n, n:], A[n:, n:] = made.closed_loop_matrix(gains), np.outer(made.b, fc), fa
    b = np.concatenate([np.zeros(n), fb])
    X = solve_continuous_lyapunov(A, -math.pi * np.outer(b, b))
    output, actuator = (np.concatenate([row, np.zeros(m)]) for row in (made.c, made.actuator_row(gains)))
    return np.array([row @ X @ row for row in (output, actuator, actuator @ A)])
