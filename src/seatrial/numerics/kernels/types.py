"""Kernel signatures, fixed for the project: one compiled integrator serves every model."""

from numba import types

F8 = types.float64
I8 = types.int64
VECTOR = types.Array(F8, 1, "C")
MATRIX = types.Array(F8, 2, "C")
CUBE = types.Array(F8, 3, "C")
QUARTIC = types.Array(F8, 4, "C")
INDEX = types.Array(I8, 1, "C")
TABLE = types.Array(I8, 2, "C")

# f(t, x, u, p, out): rates or outputs
FUNCTION_SIGNATURE = types.void(F8, VECTOR, VECTOR, VECTOR, VECTOR)
# f(t, x, u, p, out, jacobian): the same with its Jacobian, columns [x | u | p]
TANGENT_SIGNATURE = types.void(F8, VECTOR, VECTOR, VECTOR, VECTOR, MATRIX)
# command(t, x, memory, u): feedback, called once at the start of each step; writes u, may change memory
COMMAND_SIGNATURE = types.void(F8, VECTOR, VECTOR, VECTOR)

FUNCTION = types.FunctionType(FUNCTION_SIGNATURE)
TANGENT = types.FunctionType(TANGENT_SIGNATURE)
COMMAND = types.FunctionType(COMMAND_SIGNATURE)

OPTIONS = {"nogil": True, "error_model": "numpy", "fastmath": {"contract"}}

# kernels that allocate nothing take their scratch from the caller: without Numba's reference counting around every
# call through a pointer a step costs half (measured)
LEAN = {**OPTIONS, "_nrt": False}
