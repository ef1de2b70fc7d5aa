"""Libraries that only some formats need."""

import importlib
from types import ModuleType

from seatrial.core.values import InputError


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
