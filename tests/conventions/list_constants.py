"""List numeric constants that do not say what they are: `python tests/conventions/list_constants.py [--count]`.

A constant needs its unit, its meaning and its origin in words: a comment on its line, alone on the line above it, or on
the first or last line of its statement, a docstring below it, the description of its field, its line under "Args:" or
"Attributes:", or, in a model's sheet, the text beside the value. What needs no words: the numbers in `PLAIN`, indices,
exponents, and version numbers.
"""

import ast
import io
import re
import sys
import tokenize
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.conventions.source_tree import SourceFile, parameters, source_files

# Counting, halving, per cent, the turn in degrees: these say themselves.
PLAIN = frozenset({0, 1, 2, 3, 4, 0.5, 0.25, 10, 100, 90, 180, 360})
# Two words are the least that can hold a meaning, as in "[m] draught".
_FEWEST_WORDS = 2
_WORD = re.compile(r"[A-Za-zµ°]{2,}|\b[msNAVKWJ]\b")  # or a unit
_DIRECTIVE = re.compile(r"# (?:fmt|noqa|type)\b:?.*")  # addressed to a tool


@dataclass(frozen=True)
class BareConstant:
    """A number without words: its file and line, whether it has a name, and the line's text."""

    folder: str
    place: str
    is_named: bool
    line: str


def bare_constants(files: Iterable[SourceFile]) -> list[BareConstant]:
    """Return the numeric constants of files that nothing explains."""
    return [constant for file in files for constant in _of_file(file)]


def _of_file(file: SourceFile) -> Iterator[BareConstant]:
    lines = file.text.splitlines()
    comments = _comment_lines(file.text)
    comments |= {number + 1 for number in comments if lines[number - 1].lstrip().startswith("#")}
    parents = {child: node for node in ast.walk(file.tree) for child in ast.iter_child_nodes(node)}
    for node in ast.walk(file.tree):
        if not isinstance(node, ast.Constant) or not _is_number(node.value) or abs(node.value) in PLAIN:
            continue
        above = list(_ancestors(node, parents))
        if _is_index_or_exponent(node, above) or _is_explained(node, above, comments):
            continue
        is_named = not any(isinstance(a, ast.FunctionDef | ast.Lambda) for a in above)
        yield BareConstant(file.folder, file.place(node), is_named, lines[node.lineno - 1].strip())


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _ancestors(node: ast.AST, parents: dict[ast.AST, ast.AST]) -> Iterator[ast.AST]:
    while node in parents:
        node = parents[node]
        yield node


def _comment_lines(text: str) -> set[int]:
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    comments = ((t.start[0], _DIRECTIVE.sub("", t.string)) for t in tokens if t.type == tokenize.COMMENT)
    return {line for line, words in comments if len(_WORD.findall(words)) >= _FEWEST_WORDS}


def _is_index_or_exponent(node: ast.AST, above: list[ast.AST]) -> bool:
    child = node
    for parent in above:
        if isinstance(parent, ast.Subscript) and child is parent.slice:
            return not any(isinstance(a, ast.Call) for a in ast.walk(parent.slice))
        if isinstance(parent, ast.BinOp) and isinstance(parent.op, ast.Pow) and child is parent.right:
            return True
        if isinstance(parent, ast.FormattedValue | ast.stmt):
            return isinstance(parent, ast.FormattedValue)
        child = parent
    return False


def _is_explained(node: ast.Constant, above: list[ast.AST], comments: set[int]) -> bool:
    if node.lineno in comments:
        return True
    statement = next(a for a in above if isinstance(a, ast.stmt))
    last = statement.lineno if hasattr(statement, "body") else statement.end_lineno
    return (
        bool({statement.lineno, last} & comments)
        or _has_text_beside(above)
        or _is_described(statement, above)
        or _is_documented_default(node, above)
    )


def _has_text_beside(above: list[ast.AST]) -> bool:
    """Return whether the number stands in a call with a text of some words, as a parameter of a sheet does."""
    calls = (a for a in above if isinstance(a, ast.Call))
    texts = (t.value for call in calls for t in [*call.args, *(k.value for k in call.keywords)] if _is_text(t))
    return any(len(_WORD.findall(text)) >= _FEWEST_WORDS for text in texts)


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def _is_described(statement: ast.stmt, above: list[ast.AST]) -> bool:
    """Return whether a docstring follows the assignment or its class documents the field."""
    owner = above[above.index(statement) + 1] if statement in above[:-1] else None
    body = getattr(owner, "body", [])
    if statement not in body or isinstance(statement, ast.FunctionDef | ast.ClassDef):
        return False
    following = body[body.index(statement) + 1 : body.index(statement) + 2]
    if following and isinstance(following[0], ast.Expr) and _is_text(following[0].value):
        return True
    if isinstance(owner, ast.ClassDef) and isinstance(statement, ast.AnnAssign):
        return _names_in_docstring(owner, ast.unparse(statement.target))
    return False


def _is_documented_default(node: ast.Constant, above: list[ast.AST]) -> bool:
    """Return whether the number is a parameter's default and the docstring's "Args:" describes that parameter."""
    function = next((a for a in above if isinstance(a, ast.FunctionDef)), None)
    if function is None or not any(isinstance(a, ast.arguments) for a in above):
        return False
    return any(parameter.lineno == node.lineno and _names_in_docstring(function, parameter.arg)
               for parameter in parameters(function))  # fmt: skip


def _names_in_docstring(node: ast.ClassDef | ast.FunctionDef, name: str) -> bool:
    text = ast.get_docstring(node) or ""
    return re.search(rf"^\s*{re.escape(name)}:|^\s+.*\b{re.escape(name)}\b.*:", text, re.MULTILINE) is not None


def main() -> None:
    """Print the constants without words by place, or with `--count` their number by subpackage."""
    constants = bare_constants(source_files("seatrial"))
    if "--count" in sys.argv[1:]:
        for folder, count in sorted(Counter(c.folder for c in constants).items()):
            print(f"{count:5d} {folder or 'seatrial'}")
    else:
        for constant in constants:
            print(f"{constant.place}: {constant.line}")
    named = sum(c.is_named for c in constants)
    print(f"{len(constants)} numeric constants say nothing of themselves: {named} named, {len(constants) - named} not")


if __name__ == "__main__":
    main()
