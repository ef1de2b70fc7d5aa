"""The registry of models: built-in ones, installed ones, and those of a Python file."""

import runpy
import traceback
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from seatrial._plugins import failure_text, installed, load_plugin
from seatrial.core.values import InputError, spelling_hint

if TYPE_CHECKING:
    from seatrial.core.equations import Model

ENTRY_POINT_GROUP = "seatrial.models"


def _waterjet() -> "Model":
    from seatrial.physics.models.waterjet import waterjet

    return waterjet()


def _nomoto() -> "Model":
    from seatrial.physics.models.nomoto import nomoto

    return nomoto()


def _nomoto2() -> "Model":
    from seatrial.physics.models.nomoto import nomoto2

    return nomoto2()


def _abkowitz() -> "Model":
    from seatrial.physics.models.abkowitz import abkowitz

    return abkowitz()


def _mmg() -> "Model":
    from seatrial.physics.models.mmg import mmg

    return mmg()


def _heave_pitch() -> "Model":
    from seatrial.physics.models.heave_pitch import heave_pitch

    return heave_pitch()


def _heave_pitch_zoh() -> "Model":
    from seatrial.physics.models.heave_pitch import heave_pitch_zoh

    return heave_pitch_zoh()


def _heave_pitch_strip() -> "Model":
    from seatrial.physics.models.heave_pitch import heave_pitch_strip

    return heave_pitch_strip()


def _roll() -> "Model":
    from seatrial.physics.models.roll import roll

    return roll()


def _thrusters(layout: str = "") -> "Model":
    from seatrial.physics.models.thruster_layout import CATAMARAN, ThrusterLayout
    from seatrial.physics.models.thrusters import thrusters

    return thrusters(ThrusterLayout.from_text(layout) if layout else CATAMARAN)


MODELS: dict[str, Callable[[], "Model"]] = {
    "waterjet": _waterjet, "nomoto": _nomoto, "nomoto2": _nomoto2, "abkowitz": _abkowitz, "mmg": _mmg,
    "heave_pitch": _heave_pitch, "heave_pitch_zoh": _heave_pitch_zoh, "heave_pitch_strip": _heave_pitch_strip,
    "roll": _roll, "thrusters": _thrusters,
}  # fmt: skip
LAYOUT_MODELS: dict[str, Callable[[str], "Model"]] = {"thrusters": _thrusters}
"""Models whose equations depend on a layout; without one they have a default."""


def _require_model(model: object, where: str) -> "Model":
    from seatrial.core.equations import Model

    if not isinstance(model, Model):
        raise InputError(f"{where} gave a {type(model).__name__}, not a Model; return what Sheet.model() gives")
    return model


@cache
def _built_in(name: str, layout: str) -> "Model":
    from seatrial.core.equations.manifest import stored_model

    if not layout:
        return stored_model((name,), MODELS[name], (Path(__file__).parent,))
    return stored_model((name, layout), lambda: LAYOUT_MODELS[name](layout), (Path(__file__).parent,))


def model_named(name: str, layout: str = "") -> "Model":
    """Return a built-in model, or one installed under the entry point group `seatrial.models`.

    layout: as `ThrusterLayout.text` writes it, for the model `thrusters`; empty: the model's default.

    Raises:
        InputError: there is no such model; the nearest name is given.
    """
    if layout and name not in LAYOUT_MODELS:
        raise InputError(f"model '{name}' has no thrusters to lay out; name the model 'thrusters'")
    if name in MODELS:
        return _built_in(name, layout)
    plugins = installed(ENTRY_POINT_GROUP)
    if name not in plugins:
        raise InputError(f"unknown model '{name}'{spelling_hint(name, sorted((*MODELS, *plugins)))}")
    factory = load_plugin(ENTRY_POINT_GROUP, name, InputError)
    try:
        model = factory()
    except Exception as error:
        raise InputError(failure_text(plugins[name], error)) from error
    return _require_model(model, f"installed model '{name}'")


def model_from_file(path: Path) -> "Model":
    """Return the model that a user's Python file defines by a function `model()`; the file is executed.

    Raises:
        InputError: the file is missing, fails, or defines no `model()` that returns a Model.
    """
    if not path.is_file():
        raise InputError(f"model file {path} does not exist; give the path of a Python file that defines model()")
    try:
        names = runpy.run_path(str(path))
        function = names.get("model")
        if not callable(function):
            raise InputError(f"model file {path} defines no function 'model'; add 'def model() -> Model'")
        model = function()
    except InputError:
        raise
    except Exception as error:
        line = next(
            (f.lineno for f in reversed(traceback.extract_tb(error.__traceback__)) if f.filename == str(path)), 0
        )
        place = f"{path}, line {line or getattr(error, 'lineno', 0)}"
        raise InputError(f"model file {place}: {type(error).__name__}: {error}; correct the file") from error
    return _require_model(model, f"model file {path}")
