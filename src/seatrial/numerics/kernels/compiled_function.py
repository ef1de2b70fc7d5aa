"""A compiled function with its address looked up once: Numba's look-up at every call takes 20 us (measured)."""

from collections.abc import Callable

from numba.core import types
from numba.core.typing.templates import Signature
from numba.experimental.function_type import _get_wrapper_address

from seatrial.numerics.kernels.types import TANGENT, TANGENT_SIGNATURE


class TangentPointer(types.WrapperAddressProtocol):
    """The argument of kernels where a function with its Jacobian is wanted."""

    _numba_type_ = TANGENT

    def __init__(self, function: Callable[..., None]) -> None:
        self.function = function  # kept, as the address lives no longer than its code
        self._address = _get_wrapper_address(function, TANGENT_SIGNATURE)

    def __wrapper_address__(self) -> int:
        """Return the address of the compiled code."""
        return self._address

    def signature(self) -> Signature:
        """Return the signature of every function with a Jacobian."""
        return TANGENT_SIGNATURE
