"""Names say what they stand for: public class names are unique, and none is a word that names nothing."""

import ast
from collections import defaultdict

from tests.conventions.source_tree import PACKAGES, SourceFile, functions, parameters, source_files

# Participles and particles: as a name each leaves open what was made, found or taken.
EMPTY_WORDS = frozenset(
    "made found known told seen said own others at of what how begin whole left taken drawn shown".split()  # noqa: SIM905
)


# In figures `left` is a side, next to `right` and `top`.
SIDES = ("left",)


def _files() -> list[SourceFile]:
    return [file for package in PACKAGES for file in source_files(package)]


def test_a_public_class_name_stands_for_one_thing() -> None:
    places: dict[str, list[str]] = defaultdict(list)
    for file in _files():
        for node in file.nodes:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                places[node.name].append(file.place(node))
    assert {name: where for name, where in places.items() if len(where) > 1} == {}


def test_no_class_function_attribute_or_parameter_is_a_word_that_names_nothing() -> None:
    empty = [
        f"{place} {name}"
        for file in _files()
        for place, name in _declared(file)
        if _is_empty(name) and not _is_side(file, name)
    ]
    assert empty == []


def test_no_module_is_a_word_that_names_nothing() -> None:
    assert [str(file.path) for file in _files() if _is_empty(file.path.stem)] == []


def _is_side(file: SourceFile, name: str) -> bool:
    return name in SIDES and "figures" in file.folder


def _is_empty(name: str) -> bool:
    return name.strip("_").lower() in EMPTY_WORDS


def _declared(file: SourceFile) -> list[tuple[str, str]]:
    """Return place and name of everything a file declares for others to read."""
    declared = [(file.place(f), f.name) for f in functions(file.tree)]
    declared += [(file.place(a), a.arg) for f in functions(file.tree) for a in parameters(f)]
    for node in file.nodes:
        if isinstance(node, ast.ClassDef):
            declared.append((file.place(node), node.name))
            declared += [
                (file.place(field), field.target.id)
                for field in node.body
                if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name)
            ]
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            declared.append((file.place(node), node.attr))
    return declared
