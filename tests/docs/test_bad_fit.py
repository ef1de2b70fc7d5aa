"""The table of findings, and the page made from it, hold every code that the package gives, and no other."""

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from seatrial.core.values import finding_kinds

REPOSITORY = Path(__file__).parents[2]
CODE = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")


@cache
def codes_of_source() -> set[str]:
    """Second arguments of `Finding` and of helpers that hand one on as `code`."""
    texts = (path.read_text(encoding="utf-8") for path in (REPOSITORY / "src" / "seatrial").rglob("*.py"))
    trees = [ast.parse(text) for text in texts if "finding" in text.lower() or "_warning(" in text]
    constants = {name: text for tree in trees for name, text in _named_texts(tree)}
    codes = set[str]()
    for tree in trees:
        places = {"Finding": 1} | {
            function.name: [argument.arg for argument in function.args.args if argument.arg != "self"].index("code")
            for function in ast.walk(tree)
            if isinstance(function, ast.FunctionDef) and any(one.arg == "code" for one in function.args.args)
        }
        for call in (node for node in ast.walk(tree) if isinstance(node, ast.Call)):
            name = getattr(call.func, "id", getattr(call.func, "attr", ""))
            if name in places and len(call.args) > places[name]:
                codes |= set(_texts(call.args[places[name]], constants))
    return codes


def _named_texts(tree: ast.Module) -> Iterator[tuple[str, str]]:
    for node in tree.body:
        if isinstance(node, ast.Assign):
            targets, values = node.targets[0], node.value
            pairs = (
                zip(targets.elts, values.elts, strict=False)
                if (isinstance(targets, ast.Tuple) and isinstance(values, ast.Tuple))
                else [(targets, values)]
            )
            for target, value in pairs:
                if isinstance(target, ast.Name) and isinstance(value, ast.Constant) and isinstance(value.value, str):
                    yield target.id, value.value


def _texts(node: ast.expr, constants: dict[str, str]) -> Iterator[str]:
    """The codes an argument may be: a text, the name of one, or one of two."""
    for part in (node.body, node.orelse) if isinstance(node, ast.IfExp) else (node,):
        text = part.value if isinstance(part, ast.Constant) else constants.get(getattr(part, "id", ""), "")
        if isinstance(text, str) and CODE.fullmatch(text):
            yield text


def test_the_table_holds_every_code_of_the_source_and_no_other() -> None:
    sources = "".join(path.read_text(encoding="utf-8") for path in (REPOSITORY / "src" / "seatrial").rglob("*.py"))
    assert codes_of_source() <= set(finding_kinds())
    assert [code for code in finding_kinds() if f'"{code}"' not in sources] == []


def test_the_page_is_written_from_the_table() -> None:
    command = [sys.executable, "docs/write_codes.py", "--check"]
    assert subprocess.run(command, cwd=REPOSITORY, check=False).returncode == 0  # fixed arguments


def test_codes_of_helpers_and_of_names_are_seen() -> None:
    assert {
        "closure",
        "not-read",
        "gain-on-bound",
        "course-unstable",
    } <= codes_of_source()
