"""Every public function is reached from a test file of its own subpackage.

Reached is a function whose name stands in a test under the folder of the same name, or in a definition that such a test
names; then everything in its subpackage that a reached definition names. Commands of the command line count as named by
the text of their name.
"""

import ast
from collections import defaultdict
from functools import cache

from tests.conventions.source_tree import REPOSITORY, SourceFile, parsed, source_files, used_names

# Layers that consist of subpackages; the others are one subpackage each, whatever folders they have.
LAYERS_OF_SUBPACKAGES = ("core", "data", "estimation", "numerics", "physics")

# Function, and why no test of its own subpackage reaches it.
_COMPILED = "compiled core of one caller that lays out its many arrays; tested through that caller"
_WINDOW = "step of the recursive estimator; tests/estimation/identify/test_online.py runs each on streams"
EXCEPTIONS: dict[str, str] = {
    ": export_lazily": "every subpackage that exports names runs it on import",
    "core/equations: is_cached": "decides what is compiled ahead; tests/core/equations/test_cache.py",
    "data: write_demo": "tests/api/test_api.py loads what it writes",
    "data/folder: findings_document": "`seatrial check --json` writes it: tests/cli",
    "data/read: serve": "runs in the process that reads each binary format; tests/data/read/test_formats.py",
    "data/trial: trial_schema": "docs/write_schemas.py writes the published schema with it",
    "estimation/estimate: better_estimate": _WINDOW,
    "estimation/estimate: cold_start": _WINDOW,
    "estimation/estimate: force_consistency": "tests/estimation/identify/test_fusion.py reads its findings",
    "estimation/estimate: newton_step": "a bound under gusts takes it; tests/problems/test_craft_problems.py runs that",
    "estimation/estimate: refuse_diverging": _WINDOW,
    "estimation/estimate: refuse_unmeasured_waves": "its sentence is that of tests/estimation/identify/test_waves.py",
    "estimation/estimate: refuse_roll_in_unmeasured_waves": "its sentence is that of identify/test_roll_by_fins.py",
    "estimation/estimate: warm_start": _WINDOW,
    "numerics/kernels: filter_linear": _COMPILED,
    "numerics/kernels: filter_runge_kutta": _COMPILED,
    "numerics/kernels: load_kernels": "starts compiled code ahead of its use; whatever simulates runs it",
    "numerics/kernels: residuals_and_jacobian": _COMPILED,
    "numerics: distrust": "tests/core/equations/test_cache.py damages entries of every kind",
    "numerics: open_regular": "tests/core/equations/test_cache.py damages entries of every kind",
}


@cache
def _definitions(folder: str | None = None) -> dict[str, set[str]]:
    """Return the names that each top-level definition uses, by its name; of one subpackage, or of all."""
    uses: dict[str, set[str]] = defaultdict(set)
    for file in source_files("seatrial"):
        if folder in (None, _subpackage(file)):
            for node in file.tree.body:
                for name in _defined_names(node):
                    uses[name] |= used_names(node) - {name}
    return uses


def _subpackage(file: SourceFile) -> str:
    layer, *inner = file.folder.split("/")
    return "/".join([layer, *inner[:1]]) if layer in LAYERS_OF_SUBPACKAGES else layer


def _defined_names(node: ast.stmt) -> list[str]:
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return [node.name]
    if isinstance(node, ast.Assign):
        return [target.id for target in node.targets if isinstance(target, ast.Name)]
    if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
        return [node.target.id]
    return []


def _reached(folder: str) -> set[str]:
    """Return the names that tests of a subpackage use, and all that these use inside the subpackage."""
    paths = [*(REPOSITORY / "tests" / folder).rglob("*.py")] if folder else []
    if folder in ("", "api"):  # the names of `seatrial` itself are those of `seatrial.api`
        paths += (REPOSITORY / "tests").glob("*.py")
    if folder == "cli":  # the fixture that runs commands
        paths.append(REPOSITORY / "tests" / "conftest.py")
    trees = [parsed(path).tree for path in paths]
    reached = set().union(*(used_names(tree) for tree in trees))
    if folder == "cli":
        reached |= {
            n.value for t in trees for n in ast.walk(t) if isinstance(n, ast.Constant) and isinstance(n.value, str)
        }
    reached |= set().union(*(_definitions()[name] for name in reached & _definitions().keys()))
    waiting = list(reached)
    while waiting:
        new = _definitions(folder).get(waiting.pop(), set()) - reached
        reached |= new
        waiting += new
    return reached


def _public_functions() -> list[tuple[str, str]]:
    """Return subpackage and name of every public function of the package."""
    return [
        (_subpackage(file), node.name)
        for file in source_files("seatrial")
        for node in file.tree.body
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_")
    ]


def test_every_public_function_is_reached_from_tests_of_its_subpackage() -> None:
    reached = {folder: _reached(folder) for folder in {folder for folder, _ in _public_functions()}}
    unreached = {f"{folder}: {name}" for folder, name in _public_functions() if name not in reached[folder]}
    assert sorted(unreached - EXCEPTIONS.keys()) == []
    assert sorted(EXCEPTIONS.keys() - unreached) == [], "reached by now: strike them from the exceptions"
