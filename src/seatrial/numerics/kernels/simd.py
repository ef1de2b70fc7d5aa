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
# slots that are summed side by side; chosen: more columns than 32 are rare
_TOGETHER = 4
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
def add_multiple(_context, w, out, a, number, b):  # noqa: ARG001
    """Set w[out] = w[a] + number w[b]."""

    def generate(context, builder, signature, arguments):
        _, out, a, number, b = arguments
        slots = _SlotAccess(context, builder, signature, arguments)
        product = builder.fmul(slots.broadcast(number), slots.load(b), flags=_CONTRACT)
        slots.store(builder.fadd(slots.load(a), product, flags=_CONTRACT), out)
        return context.get_dummy_value()

    return types.void(w, types.int64, types.int64, types.float64, types.int64), generate


@_instruction
def gather_scaled(_context, w, out, count, a, numbers, number_at, slot_at, first, last, b):  # noqa: ARG001
    """Set w[out + c] = sum over first <= m < last of numbers[number_at[m]] w[a + slot_at[m] + c] + w[b + c], c < count.

    m ascending, w[b + c] last. Up to `_TOGETHER` values of c are worked out at a time, which share their loads.
    """

    def generate(context, builder, signature, arguments):
        _, out, count, a, numbers, number_at, slot_at, first, last, b = arguments
        slots = _SlotAccess(context, builder, signature, arguments)
        data, number_at, slot_at = (
            context.make_array(kind)(context, builder, array).data
            for kind, array in zip(signature.args, arguments, strict=True)
            if array in (numbers, number_at, slot_at)
        )
        zero, one, together = (ir.Constant(count.type, number) for number in (0, 1, _TOGETHER))

        def sums(c, width):
            each = [ir.Constant(count.type, offset) for offset in range(width)]
            totals = [cgutils.alloca_once(builder, _VECTOR) for _ in each]
            for total in totals:
                builder.store(ir.Constant(_VECTOR, [0.0] * LANES), total)
            start = builder.add(a, c)
            with cgutils.for_range_slice(builder, first, last, one, first.type) as (m, _):
                number = builder.load(builder.gep(data, [builder.load(builder.gep(number_at, [m]))]))
                left = slots.broadcast(number)
                slot = builder.add(start, builder.load(builder.gep(slot_at, [m])))
                for offset, total in zip(each, totals, strict=True):
                    product = builder.fmul(left, slots.load(builder.add(slot, offset)), flags=_CONTRACT)
                    builder.store(builder.fadd(builder.load(total), product, flags=_CONTRACT), total)
            for offset, total in zip(each, totals, strict=True):
                here = builder.add(c, offset)
                last_term = slots.load(builder.add(b, here))
                slots.store(builder.fadd(builder.load(total), last_term, flags=_CONTRACT), builder.add(out, here))

        remaining = builder.srem(count, together)
        whole = builder.sub(count, remaining)
        with cgutils.for_range_slice(builder, zero, whole, together, count.type) as (c, _):
            sums(c, _TOGETHER)
        for width in range(1, _TOGETHER):
            with builder.if_then(builder.icmp_signed("==", remaining, ir.Constant(count.type, width))):
                sums(whole, width)
        return context.get_dummy_value()

    return types.void(w, *[types.int64] * 3, numbers, number_at, slot_at, *[types.int64] * 3), generate


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
