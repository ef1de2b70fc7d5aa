"""Vector instructions on slots: a slot is LANES numbers side by side in a flat float64 array, one for each candidate.

Written for LLVM directly: left to itself it takes loops of eight apart into scalars before it looks for vectors. All
lanes undergo the same instructions; a product and its sum may contract to a fused multiply-add, nothing is reordered.
"""

from collections.abc import Callable

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

LANES = 8  # numbers of float64 in a register of 512 bits
_VECTOR = ir.VectorType(ir.DoubleType(), LANES)
_CONTRACT = ("contract",)
_ALIGNMENT = 8  # bytes of a float64, which is all that is promised of an array


def aligned_scratch(slots: int) -> np.ndarray:
    """Return uninitialised slots, each on a boundary of its own size: loads across cache lines are slow (measured)."""
    buffer = np.empty((slots + 1) * LANES)
    skip = -buffer.__array_interface__["data"][0] % (buffer.itemsize * LANES) // buffer.itemsize
    return buffer[skip : skip + slots * LANES]


def _instruction(definition: Callable[..., object]) -> Callable[..., None]:
    """Return an instruction as compiled code sees it: without Numba's context, its first argument here."""
    return intrinsic(definition)


class _SlotAccess:
    """Loads and stores of slots of the array that is the first argument."""

    def __init__(self, context, builder, signature, arguments) -> None:
        self.builder = builder
        self.data = context.make_array(signature.args[0])(context, builder, arguments[0]).data

    def _pointer(self, slot):
        first = self.builder.mul(slot, ir.Constant(slot.type, LANES))
        return self.builder.bitcast(self.builder.gep(self.data, [first]), _VECTOR.as_pointer())

    def load(self, slot):
        return self.builder.load(self._pointer(slot), align=_ALIGNMENT, typ=_VECTOR)

    def store(self, value, slot) -> None:
        self.builder.store(value, self._pointer(slot), align=_ALIGNMENT)

    def broadcast(self, number):
        index = ir.IntType(32)  # bits of a lane's number, as LLVM has them
        one = self.builder.insert_element(ir.Constant(_VECTOR, ir.Undefined), number, ir.Constant(index, 0))
        mask = ir.Constant(ir.VectorType(index, LANES), [0] * LANES)
        return self.builder.shuffle_vector(one, ir.Constant(_VECTOR, ir.Undefined), mask)


@_instruction
def dot(_context, w, out, a, b, stride, count):
    """Set w[out] = sum over k < count of w[a + k] w[b + k stride], k ascending."""

    def generate(context, builder, signature, arguments):
        _, out, a, b, stride, count = arguments
        slots = _SlotAccess(context, builder, signature, arguments)
        total = cgutils.alloca_once_value(builder, ir.Constant(_VECTOR, [0.0] * LANES))
        builder.store(ir.Constant(_VECTOR, [0.0] * LANES), total)
        with cgutils.for_range(builder, count) as loop:
            left = slots.load(builder.add(a, loop.index))
            right = slots.load(builder.add(b, builder.mul(loop.index, stride)))
            product = builder.fmul(left, right, flags=_CONTRACT)
            builder.store(builder.fadd(builder.load(total), product, flags=_CONTRACT), total)
        slots.store(builder.load(total), out)
        return context.get_dummy_value()

    return types.void(w, *[types.int64] * len((out, a, b, stride, count))), generate


@_instruction
def add_scaled(_context, w, out, a, a_stride, numbers, first, stride, count):  # noqa: ARG001
    """Add w[out] += sum over k < count of numbers[first + k stride] w[a + k a_stride], k ascending."""

    def generate(context, builder, signature, arguments):
        _, out, a, a_stride, numbers, at, at_stride, count = arguments
        slots = _SlotAccess(context, builder, signature, arguments)
        data = context.make_array(signature.args[4])(context, builder, numbers).data
        total = cgutils.alloca_once(builder, _VECTOR)
        builder.store(slots.load(out), total)
        with cgutils.for_range(builder, count) as loop:
            place = builder.gep(data, [builder.add(at, builder.mul(loop.index, at_stride))])
            left = slots.broadcast(builder.load(place))
            right = slots.load(builder.add(a, builder.mul(loop.index, a_stride)))
            product = builder.fmul(left, right, flags=_CONTRACT)
            builder.store(builder.fadd(builder.load(total), product, flags=_CONTRACT), total)
        slots.store(builder.load(total), out)
        return context.get_dummy_value()

    return types.void(w, *[types.int64] * 3, numbers, *[types.int64] * 3), generate


@_instruction
def broadcast(_context, w, out, number):  # noqa: ARG001
    """Set w[out] = number in every lane."""

    def generate(context, builder, signature, arguments):
        slots = _SlotAccess(context, builder, signature, arguments)
        slots.store(slots.broadcast(arguments[2]), arguments[1])
        return context.get_dummy_value()

    return types.void(w, types.int64, types.float64), generate


@_instruction
def add_squared_difference(_context, w, out, a, number, factor):  # noqa: ARG001
    """Add w[out] += factor (w[a] - number)^2."""

    def generate(context, builder, signature, arguments):
        slots = _SlotAccess(context, builder, signature, arguments)
        off = builder.fsub(slots.load(arguments[2]), slots.broadcast(arguments[3]))
        scaled = builder.fmul(slots.broadcast(arguments[4]), off)
        product = builder.fmul(scaled, off, flags=_CONTRACT)
        slots.store(builder.fadd(slots.load(arguments[1]), product, flags=_CONTRACT), arguments[1])
        return context.get_dummy_value()

    return types.void(w, types.int64, types.int64, types.float64, types.float64), generate


@_instruction
def copy_where_greater(_context, w, out, a, counts, threshold):  # noqa: ARG001
    """Set w[out] = w[a] in the lanes where w[counts] > threshold."""

    def generate(context, builder, signature, arguments):
        _, out, a, counts, done = arguments
        slots = _SlotAccess(context, builder, signature, arguments)
        wanted = builder.fcmp_ordered(">", slots.load(counts), slots.broadcast(done))
        slots.store(builder.select(wanted, slots.load(a), slots.load(out)), out)
        return context.get_dummy_value()

    return types.void(w, types.int64, types.int64, types.int64, types.float64), generate
