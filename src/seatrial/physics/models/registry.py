"""The registry of models: built-in ones, installed ones, those of a Python file; and their machine code ahead."""

import os
import runpy
import subprocess
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from seatrial._plugins import failure_text, installed, load_plugin
from seatrial.core.values import InputError, spelling_hint
from seatrial.core.values.files import is_file
from seatrial.numerics.platform import usable_cores
from seatrial.physics import models

if TYPE_CHECKING:
    from seatrial.core.equations import Model


# The registry of models: built-in ones, installed ones, and those of a Python file.

ENTRY_POINT_GROUP = "seatrial.models"


def _thrusters(layout: str = "") -> "Model":
    from seatrial.physics.models.thruster_layout import CATAMARAN, ThrusterLayout
    from seatrial.physics.models.thrusters import thrusters

    return thrusters(ThrusterLayout.from_text(layout) if layout else CATAMARAN)


# each is imported when it is made first
MODELS: dict[str, Callable[[], "Model"]] = {
    "waterjet": lambda: models.waterjet(),
    "waterjet_candidates": lambda: models.waterjet_candidates(),
    "waterjet_twin": lambda: models.waterjet_twin(),
    "nomoto": lambda: models.nomoto(),
    "nomoto2": lambda: models.nomoto2(),
    "abkowitz": lambda: models.abkowitz(),
    "mmg": lambda: models.mmg(),
    "mmg_shallow": lambda: models.mmg_shallow(),
    "mmg_twin": lambda: models.mmg_twin(),
    "abkowitz_roll": lambda: models.abkowitz_roll(),
    "mmg_roll": lambda: models.mmg_roll(),
    "son_nomoto": lambda: models.son_nomoto(),
    "heave_pitch": lambda: models.heave_pitch(),
    "heave_pitch_zoh": lambda: models.heave_pitch_zoh(),
    "heave_pitch_strip": lambda: models.heave_pitch_strip(),
    "roll": lambda: models.roll(),
    "section": lambda: models.section(),
    "thrusters": _thrusters,
}
FAMILIES: Mapping[str, str] = {"mmg_twin": "mmg", "mmg_shallow": "mmg", "waterjet_twin": "waterjet"}
"""Model -> the one whose coefficients, primes and candidate terms it shares."""
LAYOUT_MODELS: dict[str, Callable[[str], "Model"]] = {"thrusters": _thrusters}
"""Models whose equations depend on a layout; without one they have a default."""


def family_of(name: str) -> str:
    """Return the model whose coefficients, primes and candidate terms a model shares; itself where there is none."""
    return FAMILIES.get(name, name)


def _require_model(model: object, where: str) -> "Model":
    from seatrial.core.equations import Model

    if not isinstance(model, Model):
        raise InputError(f"{where} gave a {type(model).__name__}, not a Model; return what Sheet.model() gives")
    return model


@cache
def _built_in(name: str, layout: str) -> "Model":
    from seatrial.core.equations.model import stored_model

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
    if not is_file(path):
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
        frames = reversed(traceback.extract_tb(error.__traceback__))
        line = next((f.lineno for f in frames if f.filename == str(path)), 0) or getattr(error, "lineno", 0)
        cause = f"{type(error).__name__}: {error}"
        raise InputError(f"model file {path}, line {line}: {cause}; correct the file") from error
    return _require_model(model, f"model file {path}")


@dataclass(frozen=True)
class ModelSummary:
    """One model by the name under which trial files and model files know it.

    Attributes:
        name: as in ``[model] name``.
        states, inputs: symbols in order; empty where the model cannot be loaded.
        source: citation of the equations.
        package: the package that installs it; empty for a built-in model.
        problem: why an installed model cannot be loaded; empty where it can.
    """

    name: str
    states: tuple[str, ...] = ()
    inputs: tuple[str, ...] = ()
    source: str = ""
    package: str = ""
    problem: str = ""


def model_summaries() -> tuple[ModelSummary, ...]:
    """Return the built-in models, then the installed ones, each in alphabetical order."""
    packages = {
        name: point.dist.name if point.dist is not None else "unknown"
        for name, point in installed(ENTRY_POINT_GROUP).items()
        if name not in MODELS
    }
    return (*(_summary(name, "") for name in sorted(MODELS)), *(_summary(*item) for item in packages.items()))


def _summary(name: str, package: str) -> ModelSummary:
    try:
        model = model_named(name)
    except InputError as error:
        return ModelSummary(name, package=package, problem=str(error))
    return ModelSummary(name, model.states, model.input_names, model.equations.source, package)


# The machine code of a model compiled in another process while this one compiles the integrators: half the wait.

_PROGRAM = "import sys; from seatrial.physics.models import model_named; model_named(sys.argv[1]).compiled.load()"
# the other process is given up after that: the largest model (MMG, 77 parameters) takes 6 s, measured
_PATIENCE_S = 20.0


@contextmanager
def precompile(name: str) -> Iterator[None]:
    """Compile a built-in model and its integrators while the body runs; at the end all of it is in the compile cache.

    Does nothing for other models, for one that is in the cache already, or on a single core. Whatever goes wrong in the
    other process goes wrong again here, where it is reported.
    """
    if name not in MODELS or usable_cores() < 2 or _is_cached(name):
        yield
        return
    from seatrial.numerics.kernels.cache import cache_folder

    environment = {**os.environ, "SEATRIAL_CACHE": str(cache_folder().parent)}
    command = [sys.executable, "-c", _PROGRAM, name]
    process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield
        _load_integrators(is_affine=model_named(name).is_affine)
        process.wait(_PATIENCE_S)
    except subprocess.TimeoutExpired:
        pass
    finally:
        process.kill()
        process.wait()


def _is_cached(name: str) -> bool:
    from seatrial.core.equations.bindings import is_cached

    return is_cached(model_named(name).equations)


def _load_integrators(*, is_affine: bool) -> None:
    from seatrial.numerics.kernels import integrate, linear
    from seatrial.numerics.kernels.kernel import load_kernels

    load_kernels(linear if is_affine else integrate)
