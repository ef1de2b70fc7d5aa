"""A function of states and inputs along a record, row by row."""

from numba import void

from seatrial.numerics.kernels.kernel import kernel
from seatrial.numerics.kernels.types import F8, FUNCTION, MATRIX, OPTIONS, VECTOR


@kernel(void(FUNCTION, MATRIX, MATRIX, VECTOR, F8, MATRIX), **OPTIONS)
def evaluate(f, states, inputs, p, dt, out):
    """Evaluate f at every row of states and inputs: rates, outputs or bindings along a record."""
    for row in range(states.shape[0]):
        f(row * dt, states[row], inputs[row], p, out[row])
