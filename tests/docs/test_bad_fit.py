"""The page on bad fits explains every code of a finding that the package gives, and no other."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from seatrial.data.check.consequences import CONSEQUENCES

REPOSITORY = Path(__file__).parents[2]
PAGE = REPOSITORY / "docs" / "bad-fit.md"
CODE = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")


@cache
def codes_of_source() -> set[str]:
    """Second arguments of `Finding` and of helpers that hand one on as `code`; those whose consequence is stated."""
    texts = (path.read_text(encoding="utf-8") for path in (REPOSITORY / "src" / "seatrial").rglob("*.py"))
    trees = [ast.parse(text) for text in texts if "finding" in text.lower() or "_warning(" in text]
    constants = {name: text for tree in trees for name, text in _named_texts(tree)}
    codes = set(CONSEQUENCES)
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


def test_every_code_of_the_source_is_on_the_page_and_no_other() -> None:
    listed = re.findall(
        r"^\| `([a-z0-9-]+)` \|", PAGE.read_text(encoding="utf-8").partition("## Codes")[2], re.MULTILINE
    )
    assert len(listed) == len(set(listed))
    assert set(listed) == codes_of_source()


def test_codes_of_helpers_and_of_names_are_seen() -> None:
    assert {
        "closure",
        "small-closure",
        "not-read",
        "wrong-frame",
        "gain-on-bound",
        "course-unstable",
    } <= codes_of_source()
