"""Compiled functions with fixed signatures, whose machine code is loaded from the compile cache at their first use."""

# Numba annotates what may be overridden too narrowly, and not its settings:
# pyright: reportIncompatibleMethodOverride=false, reportAttributeAccessIssue=false

import hashlib
import logging
import pickle
import sys
from collections.abc import Callable, Mapping
from functools import cache, cached_property
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, cast

import numba
from numba import types
from numba.core import config
from numba.core import types as numba_types
from numba.core.caching import _Cache
from numba.core.compiler import CompileResult
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import CPUDispatcher
from numba.core.runtime.nrt import rtsys
from numba.core.serialize import dumps
from numba.core.typing.templates import Signature
from numba.experimental.function_type import _get_wrapper_address

from seatrial.numerics.kernels.cache import cache_folder, discard_entry, read_entry, source_digest, write_entry

# Kernel signatures, fixed for the project: one compiled integrator serves every model.

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


# A compiled function with its address looked up once: Numba's look-up at every call takes 20 us (measured).


class TangentPointer(numba_types.WrapperAddressProtocol):
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


# Compiled functions with one fixed signature, whose machine code is loaded from the compile cache at their first use.

_PACKAGE = Path(__file__).parents[2]
_log = logging.getLogger("seatrial")


@cache
def _announce_compiling() -> None:
    """Log, once in a process, why a first run takes longer."""
    _log.info("compiling for this machine, some 15 s; the machine code is kept, and later runs begin at once")


def _source_digest(function: FunctionType) -> bytes:
    """Return the digest of the texts that decide the machine code of a function: its own, and those of the kernels.

    Machine code holds that of the functions it calls, so any change in this folder, or in the function's own folder
    where that belongs to the package, compiles it again. A generated module holds its digest as `SOURCE_DIGEST`.
    """
    given = function.__globals__.get("SOURCE_DIGEST")
    if given is None:
        file = Path(function.__code__.co_filename)
        given = source_digest(file.parent if file.is_relative_to(_PACKAGE) else file)
    return source_digest(Path(__file__).parent) + given


class _Machine(_Cache):
    """Machine code of one function in the compile cache, in place of Numba's index and data files."""

    def __init__(self, function: FunctionType, options: Mapping[str, Any]) -> None:
        self._function, self._options = function, options
        self._enabled = function.__closure__ is None  # what a closure holds is not in the name of the entry

    @property
    def cache_path(self) -> str:
        return str(cache_folder())

    def _name(self, signature: Signature, codegen: Any) -> str:
        """Return the name of the entry: everything that decides the machine code is in it."""
        f = self._function
        options = {k: sorted(v) if isinstance(v, set) else v for k, v in sorted(self._options.items())}
        facts = (f.__module__, f.__qualname__, f.__code__.co_firstlineno, signature, options, codegen.magic_tuple(),
                 numba.__version__, sys.version)  # fmt: skip
        digest = hashlib.sha256(repr(facts).encode() + _source_digest(f)).hexdigest()
        return f"{f.__module__.rpartition('.')[2]}.{f.__qualname__}-{digest[:32]}.bin".replace("<", "").replace(">", "")

    def load_overload(self, sig: Signature, target_context: Any) -> CompileResult | None:
        """Return the compiled function, or None where it has to be compiled."""
        if not self._enabled:
            return None
        name = self._name(sig, target_context.codegen())
        content = read_entry(name)
        if content is None:
            _announce_compiling()
            return None
        rtsys.initialize(target_context)  # the code may call Numba's runtime, whose symbols have to be there
        try:
            return CompileResult._rebuild(target_context, *pickle.loads(content))
        except Exception as error:  # whatever a library may raise on bytes of another version of itself
            discard_entry(name, f"{type(error).__name__}: {error}")
            return None

    def save_overload(self, sig: Signature, data: CompileResult) -> None:
        """Keep the compiled function."""
        if self._enabled and not data.library.has_dynamic_globals:
            write_entry(self._name(sig, data.codegen), dumps(data._reduce()))

    def enable(self) -> None:
        """Read and write entries."""
        self._enabled = True

    def disable(self) -> None:
        """Stop reading and writing entries."""
        self._enabled = False

    def flush(self) -> None:
        """Do nothing: an entry is replaced when it is written again."""


class Kernel(CPUDispatcher):
    """A Numba function that has one signature and gets its machine code when that is first needed."""

    fixed: Signature

    def compile(self, sig: Signature | tuple[numba_types.Type, ...]) -> Any:
        """Load or compile the one signature; every request of Numba for code comes through here.

        Raises:
            TypeError: the arguments are of other types.
        """
        if isinstance(sig, tuple):
            for given, wanted in zip(sig, self.fixed.args, strict=True):
                if self.typingctx.can_convert(given, wanted) is None:
                    raise TypeError(f"{self.__name__}: an argument is {given}, where it takes {wanted}")
        with global_compiler_lock:
            if not self.overloads:
                super().compile(self.fixed)
                self.disable_compile()
        return self.overloads[self.fixed.args].entry_point

    def load(self) -> None:
        """Load or compile the machine code now."""
        self.compile(self.fixed)

    @cached_property
    def _numba_type_(self) -> numba_types.Dispatcher:
        return numba_types.Dispatcher(self)

    @cached_property
    def _result(self) -> CompileResult:
        """The compilation; its addresses are looked up once, where Numba would at every call: 20 us each (measured)."""
        self.load()
        result = self.overloads[self.fixed.args]
        result.library.get_pointer_to_function = cache(result.library.get_pointer_to_function)
        return result

    def get_compile_result(self, sig: Signature) -> CompileResult:  # noqa: ARG002
        """Return the one compilation there is; Numba looks it up by its types, at every call that passes a kernel."""
        return self._result

    def get_function_type(self) -> numba_types.FunctionType | None:
        """Return its type as an argument of other kernels, which Numba knows of compiled functions only."""
        self.load()
        return super().get_function_type()


def kernel(signature: Signature, **options: Any) -> Callable[[Callable[..., Any]], Kernel]:
    """Return a decorator that compiles a function for one signature, kept between processes.

    options: those of `numba.njit`, without `cache`.
    """

    def decorate(function: Callable[..., Any]) -> Kernel:
        if config.DISABLE_JIT:
            return cast(Kernel, function)
        made = Kernel(function, {}, {**options, "nopython": True, "boundscheck": None})
        made.fixed, made._cache = signature, _Machine(cast(FunctionType, function), options)
        return made

    return decorate


def load_kernels(module: ModuleType) -> None:
    """Load or compile the kernels of a module now."""
    for value in vars(module).values():
        if isinstance(value, Kernel):
            value.load()
