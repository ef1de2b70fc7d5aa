"""Libraries that only some formats need."""

import importlib
from types import ModuleType

from seatrial.core.text.words import printable
from seatrial.core.values import InputError

_LONGEST_FAULT = 120  # letters of a library's message in ours; ours: some explain at length


def require_library(module: str, file: str, kind: str, extra: str) -> ModuleType:
    """Import a library of an extra; `kind` says what the file is, such as "a ROS bag".

    Raises:
        InputError: it is not installed; the sentence says how to.
    """
    try:
        return importlib.import_module(module)
    except ImportError:
        library = module.partition(".")[0]
        raise InputError(
            f"{file} is {kind}, which needs {library}; install it with: pip install 'seatrial[{extra}]'"
        ) from None


def fault_text(error: Exception) -> str:
    """Return what a library says of a damaged file: the kind of its error, and the beginning of its first line."""
    first = next(iter(str(error).splitlines()), "")
    return f"{type(error).__name__}: {printable(first, _LONGEST_FAULT)}"
