"""Examples of public names, each made to stand alone by the lines of earlier ones that it needs."""

import ast
import doctest
import re
from collections.abc import Iterator
from pathlib import Path

FOLDER = Path(__file__).parent / "name_examples"
BLOCK = re.compile(r"^## (\w+)\n\n```pycon\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def examples_of_names() -> dict[str, str]:
    """Return the session of each public name, as a page shows it."""
    sessions: dict[str, str] = {}
    for page in sorted(FOLDER.glob("*.txt")):
        lines: list[doctest.Example] = []
        for name, text in BLOCK.findall(page.read_text(encoding="utf-8")):
            own = doctest.DocTestParser().get_examples(text)
            before = [line for line in _needed(own, lines) if line not in own]
            sessions[name] = "".join([*(_shown(line, "") for line in before), *(_shown(x, x.want) for x in own)])
            lines += own
    return sessions


def _needed(own: list[doctest.Example], earlier: list[doctest.Example]) -> list[doctest.Example]:
    """Return the earlier lines whose names a session uses, and those that they use in turn, in order."""
    wanted = set().union(*(_names(line, ast.Load) for line in own))
    kept: list[doctest.Example] = []
    for line in reversed(earlier):
        given = _names(line, ast.Store)
        if given & wanted or (line.source.startswith("sheet.") and "sheet" in wanted):
            kept.insert(0, line)
            wanted |= _names(line, ast.Load)
    return kept


def _names(line: doctest.Example, use: type[ast.expr_context]) -> set[str]:
    return set(_walk(ast.parse(line.source), use))


def _walk(tree: ast.AST, use: type[ast.expr_context]) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and isinstance(node.ctx, use):
            yield node.id
        if isinstance(node, ast.Import | ast.ImportFrom) and use is ast.Store:
            yield from (alias.asname or alias.name for alias in node.names)


def _shown(line: doctest.Example, want: str) -> str:
    first, *rest = line.source.splitlines()
    return "".join([f">>> {first}\n", *(f"... {text}\n" for text in rest), want])
