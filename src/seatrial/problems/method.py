"""Methods that are entered against the problems: built-in, installed, or of a user's file or module."""

import hashlib
import importlib
import importlib.util
import inspect
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType, ModuleType
from typing import Any

import numpy as np

from seatrial._plugins import installed, load_plugin
from seatrial.core.values import InputError, spelling_hint
from seatrial.core.values.files import is_file
from seatrial.problems import built_in
from seatrial.problems.ask_tell import Asking, searched
from seatrial.problems.posed import PosedProblem

OPTIMISER_GROUP = "seatrial.optimisers"
Estimator = Callable[[PosedProblem, np.random.Generator], Any]
"""Returns values (d,), or values and their covariance (d, d) or None."""


@dataclass(frozen=True, eq=False)
class EnteredMethod:
    """A method under the name by which it was entered.

    Attributes:
        source: where it was published, or the file or module that defines it.
        digest: changes with whatever may change its answers, besides the versions of seatrial and its packages.
        is_built_in: whether it comes with seatrial.
        estimate: problem and random numbers -> answer, as `Estimator`; an optimiser is wrapped.
        suits: whether it can be entered against a problem.
    """

    name: str
    source: str
    digest: str
    is_built_in: bool
    estimate: Estimator
    suits: Callable[[PosedProblem], bool] = lambda _: True


def built_in_methods() -> Mapping[str, EnteredMethod]:
    """Return the methods that come with seatrial, by name; nothing of other packages is imported."""
    entries = built_in.ENTRIES
    methods = (EnteredMethod(e.name, e.source, e.digest(), True, e.estimate, e.suits) for e in entries)
    return MappingProxyType({method.name: method for method in methods})


@cache
def method_named(text: str) -> EnteredMethod:
    """Return a method: a built-in or installed one by its name, ``FILE.py``, ``FILE.py:Name`` or ``module:Name``.

    A file or module is executed. Its class has `ask` and `tell` (an optimiser, made from a box and a generator) or
    `estimate` (made without arguments); a function is called as `estimate`.

    Raises:
        InputError: no such name, file or module; it fails; nothing in it is a method, or several are.
    """
    if text in (methods := built_in_methods()):
        return methods[text]
    if text in (names := installed(OPTIMISER_GROUP)):
        package = names[text].dist
        digest = f"{package.name} {package.version}" if package else ""
        return _method(text, load_plugin(OPTIMISER_GROUP, text, InputError), names[text].value, digest)
    place, _, name = text.rpartition(":") if ":" in text[2:] else (text, "", "")  # 2: letters of a drive, C:
    if place.endswith(".py"):
        module = _module_of_file(Path(place))
    elif name:
        module = _module(place)
    else:
        hint = spelling_hint(text, [*methods, *names])
        raise InputError(f"there is no method '{text}'{hint}; or give FILE.py, FILE.py:Name or module:Name")
    return _method(text, _member(module, name, place), text, _source_digest(module))


def entered_method(member: Any) -> EnteredMethod:
    """Return a class or function of this process as a method, to try it; benchmarks take it by its file."""
    return _method(member.__name__, member, f"{member.__module__}:{member.__name__}", "")


def _method(name: str, member: Any, source: str, digest: str) -> EnteredMethod:
    """Return an object of a user as a method."""
    if _is_optimiser(member):
        return EnteredMethod(
            name, source, digest, False, lambda problem, rng: searched(member(problem.box, rng), problem)
        )
    if isinstance(member, type):
        create: Any = member
        return EnteredMethod(name, source, digest, False, lambda problem, rng: create().estimate(problem, rng))
    return EnteredMethod(name, source, digest, False, member)


def _is_optimiser(member: Any) -> bool:
    """Whether it makes optimisers; a factory that is no class states that it returns one."""
    if inspect.isclass(member):
        return issubclass(member, Asking)
    return inspect.isfunction(member) and _is_optimiser(inspect.signature(member).return_annotation)


def _member(module: ModuleType, name: str, place: str) -> Any:
    """Return the method that a module defines."""
    if name:
        if not hasattr(module, name):
            raise InputError(f"'{place}' defines no '{name}'; give one of {_listed(module)}")
        return getattr(module, name)
    names = _method_names(module)
    if len(names) != 1:
        several = f"several methods ({', '.join(names)})" if names else "no class with ask and tell, or with estimate"
        raise InputError(f"'{place}' defines {several}; name one: {place}:Name")
    return getattr(module, names[0])


def _method_names(module: ModuleType) -> list[str]:
    """Return the names of classes with ask and tell or estimate, and of a function `estimate`."""
    local = {n: v for n, v in vars(module).items() if getattr(v, "__module__", "") == module.__name__}
    public = {n: v for n, v in local.items() if not n.startswith("_")}
    classes = [n for n, v in public.items() if inspect.isclass(v) and (_is_optimiser(v) or hasattr(v, "estimate"))]
    return [*classes, *(n for n, v in public.items() if n == "estimate" and inspect.isfunction(v))]


def _listed(module: ModuleType) -> str:
    return ", ".join(_method_names(module)) or "none: it has no class with ask and tell, or with estimate"


def _module_of_file(path: Path) -> ModuleType:
    """Execute a file as a module of its own."""
    if not is_file(path):
        raise InputError(f"method file {path} does not exist; give the path of a Python file")
    name = (
        f"seatrial_method_{path.stem}_{hashlib.sha256(path.read_bytes()).hexdigest()[:16]}"  # 16 digits: no two alike
    )
    if name in sys.modules:
        return sys.modules[name]
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # dataclasses look their module up there
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        del sys.modules[name]
        raise InputError(f"method file {path} fails: {type(error).__name__}: {error}; correct it") from error
    return module


def _module(name: str) -> ModuleType:
    try:
        return importlib.import_module(name)
    except Exception as error:
        raise InputError(f"module '{name}' of the method cannot be imported: {error}; install or correct it") from error


def _source_digest(module: ModuleType) -> str:
    """Return the SHA-256 of a module's file, hexadecimal."""
    file = module.__file__
    return hashlib.sha256(Path(file).read_bytes()).hexdigest() if file else ""
