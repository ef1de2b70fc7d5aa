"""Packages that import what they export when it is used first (PEP 562).

The stub ``__init__.pyi`` is the one list: every name that it imports is exported, to type checkers and at run time. In
``__init__.py`` stands a docstring and ``export_lazily(__name__)``.
"""

import ast
import sys
from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from pathlib import Path
from types import ModuleType


@dataclass(frozen=True)
class Origin:
    """Where an exported name comes from: a module and a name in it, or a submodule of it."""

    module: str
    name: str

    def imported(self, package: str) -> object:
        """Return the object, importing its module; `package` exports it."""
        if self.module != package:
            module = import_module(self.module)
            if hasattr(module, self.name):
                return getattr(module, self.name)
        return import_module(f"{self.module}.{self.name}")


class LazyPackage(ModuleType):
    """A package whose exported names are imported on access."""

    @cached_property
    def _origins(self) -> dict[str, Origin]:
        """Exported name -> origin, as the stub states it."""
        stub = ast.parse(Path(self.__file__ or "").with_suffix(".pyi").read_bytes())
        imports = [node for node in stub.body if isinstance(node, ast.ImportFrom)]
        return {a.asname or a.name: Origin(node.module or "", a.name) for node in imports for a in node.names}

    def __getattr__(self, name: str) -> object:
        if name == "__all__":
            return sorted(self._origins)
        if name not in self._origins:
            raise AttributeError(f"module '{self.__name__}' has no attribute '{name}'", name=name, obj=self)
        vars(self)[name] = value = self._origins[name].imported(self.__name__)
        return value

    def __setattr__(self, name: str, value: object) -> None:
        # importing a submodule binds it in its package, where it must not hide an exported function of the same name
        if not (isinstance(value, ModuleType) and name in self._origins):
            super().__setattr__(name, value)

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self._origins})


def export_lazily(package: str) -> None:
    """Let a package export the names of its stub, each imported when it is used first."""
    sys.modules[package].__class__ = LazyPackage
