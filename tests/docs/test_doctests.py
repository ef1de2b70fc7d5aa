"""The examples of interactive sessions on pages give what stands below them."""

import doctest
import re
import sys
from pathlib import Path

import pytest

import seatrial

REPOSITORY = Path(__file__).parents[2]
sys.path.insert(0, str(REPOSITORY / "docs"))
from examples_of_names import examples_of_names  # noqa: E402  # a module next to the pages

SESSION = re.compile(r"^```pycon\n(.*?)^```", re.MULTILINE | re.DOTALL)
DOCS = REPOSITORY / "docs"
SLOW = DOCS / "name_examples" / "slow.txt"
PAGES = sorted(
    p for p in (*DOCS.rglob("*.md"), *SLOW.parent.glob("*.txt")) if SESSION.search(p.read_text(encoding="utf-8"))
)


@pytest.mark.parametrize(
    "page",
    [pytest.param(p, marks=pytest.mark.long) if p == SLOW else p for p in PAGES],
    ids=lambda p: str(p.relative_to(REPOSITORY)),
)
def test_sessions_print_what_the_page_shows(page: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(REPOSITORY)
    text = "\n".join(SESSION.findall(page.read_text(encoding="utf-8")))
    test = doctest.DocTestParser().get_doctest(text, {}, page.name, str(page), 0)
    lines: list[str] = []
    doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(test, out=lines.append)
    assert test.examples and not lines, "".join(lines)


def test_every_public_name_has_an_example() -> None:
    names = re.findall(r"^## (\w+)$", "".join(p.read_text(encoding="utf-8") for p in SLOW.parent.glob("*.txt")), re.M)
    assert sorted(names) == sorted(seatrial.__all__)


def test_an_example_stands_alone_on_the_page_of_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(REPOSITORY)
    sessions = examples_of_names()
    assert sessions["load_loop"].startswith(">>> import seatrial as st\n>>> task = ")
    for name in ("Fit", "Sheet", "Problem"):
        lines: list[str] = []
        test = doctest.DocTestParser().get_doctest(sessions[name], {}, name, None, 0)
        doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(test, out=lines.append)
        assert lines == [], name
