"""Docstrings of classes describe attributes that there are."""

import ast
import re
from collections.abc import Iterator

from tests.conventions.source_tree import PACKAGES, SourceFile, source_files

_SECTION = re.compile(r"^Attributes:\n((?:(?: .*)?\n?)+)", re.MULTILINE)
# `dt: s; substeps: steps in each`, `state, inputs: trim`, with shapes in brackets left out
_ENTRY = re.compile(r"(?:^    |; )([A-Za-z]\w*(?:, [A-Za-z]\w*)*):", re.MULTILINE)
_BRACKETS = re.compile(r" ?\([^()]*\)")
_VALUES = frozenset({"None", "NaN", "empty", "infinite"})  # what is said of a value, as in "; None: not known"


def _classes() -> dict[str, tuple[SourceFile, ast.ClassDef]]:
    files = [file for package in PACKAGES for file in source_files(package)]
    return {node.name: (file, node) for file in files for node in file.nodes if isinstance(node, ast.ClassDef)}


def _documented(docstring: str) -> Iterator[str]:
    for section in _SECTION.findall(docstring):
        for names in _ENTRY.findall(_BRACKETS.sub("", section)):
            yield from names.split(", ")


def _members(node: ast.ClassDef, classes: dict[str, tuple[SourceFile, ast.ClassDef]]) -> set[str]:
    """Fields, properties and attributes of a class and of the classes that it extends."""
    names = {n.attr for n in ast.walk(node) if isinstance(n, ast.Attribute) and isinstance(n.ctx, ast.Store)}
    for item in node.body:
        if isinstance(item, ast.AnnAssign) and isinstance(item.target, ast.Name):
            names.add(item.target.id)
        elif isinstance(item, ast.Assign):
            names |= {target.id for target in item.targets if isinstance(target, ast.Name)}
        elif isinstance(item, ast.FunctionDef):
            names.add(item.name)
    for base in node.bases:
        name = ast.unparse(base).partition("[")[0].rpartition(".")[2]
        if name in classes and name != node.name:
            names |= _members(classes[name][1], classes)
    return names


def test_every_attribute_that_is_documented_exists() -> None:
    classes = _classes()
    absent = {
        f"{file.place(node)} {node.name}": names
        for file, node in classes.values()
        if (names := sorted(set(_documented(ast.get_docstring(node) or "")) - _members(node, classes) - _VALUES))
    }
    assert absent == {}


def test_what_counts_as_documented() -> None:
    text = "Attributes:\n    dt: s; substeps: steps in each.\n    value (k,), spread (k, k): numbers; 0: none.\n"
    assert list(_documented(text)) == ["dt", "substeps", "value", "spread"]
