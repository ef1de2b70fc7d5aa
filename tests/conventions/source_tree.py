"""The source as syntax trees, for the tests that hold it to its conventions."""

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

REPOSITORY = Path(__file__).parents[2]
SOURCE = REPOSITORY / "src"
PACKAGES = ("seatrial", "seatrial_studies")

Function = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass(frozen=True)
class SourceFile:
    """A Python file of the packages: its path, its text, its syntax tree, and the folder that holds the packages."""

    path: Path
    text: str
    tree: ast.Module
    root: Path = SOURCE

    @cached_property
    def nodes(self) -> tuple[ast.AST, ...]:
        """Return every node of the tree."""
        return tuple(ast.walk(self.tree))

    @cached_property
    def texts(self) -> tuple[str, ...]:
        """Return every string constant."""
        return tuple(n.value for n in self.nodes if isinstance(n, ast.Constant) and isinstance(n.value, str))

    @property
    def folder(self) -> str:
        """Return the subpackage with slashes, such as ``core/values``; empty at the top of a package."""
        return "/".join(self.path.relative_to(self.root).parts[1:-1])

    def place(self, node: ast.stmt | ast.expr | ast.arg) -> str:
        """Return where a node stands, as ``core/values/record.py:12``."""
        return f"{self.path.relative_to(self.root)}:{node.lineno}"


@cache
def source_files(package: str, root: Path = SOURCE) -> tuple[SourceFile, ...]:
    """Return every Python file of a package, parsed, ordered by path."""
    return tuple(parsed(path, root) for path in sorted((root / package).rglob("*.py")))


def parsed(path: Path, root: Path = SOURCE) -> SourceFile:
    """Return one file with its syntax tree."""
    text = path.read_text(encoding="utf-8")
    return SourceFile(path, text, ast.parse(text), root)


def functions(tree: ast.AST) -> Iterator[Function]:
    """Yield every function and method in a tree."""
    return (node for node in ast.walk(tree) if isinstance(node, Function))


def parameters(function: Function) -> Iterator[ast.arg]:
    """Yield the named parameters of a function."""
    arguments = function.args
    yield from (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)


def used_names(tree: ast.AST) -> set[str]:
    """Return every name, attribute and imported name that occurs in a tree."""
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Name):
            names.add(node.id)
        elif isinstance(node, ast.Attribute):
            names.add(node.attr)
        elif isinstance(node, ast.alias):
            names.add(node.name.rpartition(".")[2])
    return names
