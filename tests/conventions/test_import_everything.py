"""Every submodule can be imported and hides no public name; scripts import what there is."""

import ast
import importlib
import subprocess
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import pytest
from tests.conventions.source_tree import REPOSITORY

SCRIPT = """
import importlib, inspect, pkgutil
import seatrial

names = getattr(seatrial, "__all__", ())
before = {name: getattr(seatrial, name) for name in names}
for module in pkgutil.walk_packages(seatrial.__path__, "seatrial."):
    importlib.import_module(module.name)
for name in names:
    assert getattr(seatrial, name) is before[name], f"seatrial.{name} is hidden by a module of that name"
    if not inspect.ismodule(before[name]):
        assert callable(before[name]), f"seatrial.{name} is neither a function, a class nor a subpackage"
print(len(names))
"""

SCRIPTS = sorted(path for folder in ("benchmarks", "docs", "examples") for path in (REPOSITORY / folder).rglob("*.py"))


def defined_names(path: Path) -> set[str]:
    """Return the names that a script defines or imports."""
    return {
        name
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        for name in (
            [node.name] if isinstance(node, ast.FunctionDef | ast.ClassDef)
            else [node.id] if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
            else [a.asname or a.name for a in node.names] if isinstance(node, ast.Import | ast.ImportFrom)
            else []
        )
    }  # fmt: skip


def missing_imports(text: str, folder: Path) -> Iterator[str]:
    """Return what a script imports, from the package or a script beside it, by names that are not there."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom) and node.module and (beside := folder / f"{node.module}.py").is_file():
            yield from sorted(f"{node.module}.{a.name}" for a in node.names if a.name not in defined_names(beside))
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("seatrial"):
            module = importlib.import_module(node.module)
            for name in (f"{node.module}.{alias.name}" for alias in node.names):
                is_module = hasattr(module, "__path__") and find_spec(name) is not None
                if not is_module and not hasattr(module, name.rpartition(".")[2]):
                    yield name


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: str(path.relative_to(REPOSITORY)))
def test_scripts_import_what_there_is(path: Path) -> None:
    assert list(missing_imports(path.read_text(encoding="utf-8"), path.parent)) == []


def test_a_name_that_moved_is_missed() -> None:
    text = "from seatrial.core.values import Record, Elsewhere\nfrom measure import Line, elsewhere"
    assert list(missing_imports(text, REPOSITORY / "benchmarks")) == [
        "seatrial.core.values.Elsewhere", "measure.elsewhere"
    ]  # fmt: skip


def test_no_submodule_hides_a_public_name() -> None:
    done = subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    assert int(done.stdout) == 0 or int(done.stdout) >= 40, "the public names of seatrial"
