"""A model of one's own: a Python file that the user names on the command line; nothing else is ever executed."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

from seatrial.equations import Model
from seatrial.values import InputError


def own_model(path: str | Path) -> Model:
    """The model a Python file defines: its global `model`, a `Model` or a function that returns one.

    Raises:
        InputError: no such file, an error in it (with its line), or no model in it.
    """
    path = Path(path)
    module = _executed(path)
    found = getattr(module, "model", None)
    if callable(found) and not isinstance(found, Model):
        found = found()
    if not isinstance(found, Model):
        raise InputError(f"'{path}' defines no model; end it with: model = sheet.model()")
    return found


def _executed(path: Path) -> ModuleType:
    if not path.is_file():
        raise InputError(f"model file '{path}' does not exist; check the path after --model")
    name = f"seatrial_own_{path.stem}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise InputError(f"'{path}' is no Python file; --model takes FILE.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except InputError as error:
        raise InputError(f"'{path}': {error}") from None
    except Exception as error:
        raise InputError(f"'{path}', line {_line(error, path)}: {type(error).__name__}: {error}; mend it") from error
    return module


def _line(error: Exception, path: Path) -> int:
    """The last line of the user's own file on the way to the error."""
    if isinstance(error, SyntaxError):
        return error.lineno or 0
    line, step = 0, error.__traceback__
    while step is not None:
        if Path(step.tb_frame.f_code.co_filename) == path:
            line = step.tb_lineno
        step = step.tb_next
    return line
