"""Texts are in the plain English of the field: retired words stand in no page and in no text of the packages."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.conventions.source_tree import PACKAGES, REPOSITORY, source_files

# docs/glossary.md gives the plain word for each.
RETIRED = re.compile(
    r"\b(tells?|telling|told|mend(?:s|ed|ing)?|unrest|foretold|foretells?|the house|rooms|storeys?|sailed|sails|bears"
    r"|asked for|she|her|hers)\b",
    re.IGNORECASE,
)
PAGES = sorted(
    [
        *REPOSITORY.glob("*.md"),
        *(p for p in (REPOSITORY / "docs").rglob("*.md") if p.parent.name != "gallery"),
        *(REPOSITORY / "docs" / "recipes").glob("*.py"),
        *(REPOSITORY / "examples").glob("*.toml"),
    ]
)
# How often retired words still stand in texts of src. It may only fall: lower it with every pass over a subpackage.
MOST_IN_SOURCE = 0


# A number without its leading zero, in prose; formats and parsers have such texts, and so has code between backticks.
BARE_DECIMAL = re.compile(r"(?<=[\s(\[|±,-])\.\d{1,6}(?![\w.])")
CODE = re.compile(r"```.*?```|`[^`\n]*`", re.DOTALL)

# The protocol of optimisers, by its name in the field.
ASK_AND_TELL = re.compile(r"ask(?:ing)?[ ,/-]+(?:and )?tell(?:ing)?|`?tell`? *\(|`tell`", re.IGNORECASE)


def _retired(text: str) -> Iterator[str]:
    for number, line in enumerate(ASK_AND_TELL.sub("", text).splitlines(), 1):
        for match in RETIRED.finditer(line):
            yield f"{number}: {match[0]}: {line.strip()[:100]}"


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(REPOSITORY)))
def test_no_page_uses_a_retired_word(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    if page.name == "CHANGELOG.md":
        text = re.sub(r"^\|.*$", "", text, flags=re.MULTILINE)  # tables of renamed things quote the old names
    if page.name == "glossary.md":
        text = text.partition("## Words that are not used")[0]
    assert list(_retired(text)) == []


def test_texts_of_the_packages_use_fewer_and_fewer_retired_words() -> None:
    count = 0
    for package in PACKAGES:
        for file in source_files(package):
            count += sum(1 for text in file.texts if RETIRED.search(text) for _ in _retired(text))
    assert count <= MOST_IN_SOURCE


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(REPOSITORY)))
def test_no_page_has_a_number_without_its_leading_zero(page: Path) -> None:
    prose = CODE.sub("", page.read_text(encoding="utf-8"))
    assert [line for line in prose.splitlines() if BARE_DECIMAL.search(line)] == []


def test_no_text_of_the_packages_has_a_number_without_its_leading_zero() -> None:
    bare = [
        f"{file.folder}: {line.strip()[:100]}"
        for package in PACKAGES
        for file in source_files(package)
        for text in file.texts
        for line in text.splitlines()
        if BARE_DECIMAL.search(line)
    ]
    assert bare == []


def test_what_counts_as_a_retired_word_or_a_bare_decimal() -> None:
    """So that the lists above cannot become lists of nothing."""
    assert [hit.split(": ")[1] for hit in _retired("They tell of unrest\nin the house.")] == [
        "tell",
        "unrest",
        "the house",
    ]
    assert list(_retired("ask and tell; intelligence; headings")) == []
    assert BARE_DECIMAL.search("a share of .28") and BARE_DECIMAL.search("(.5)") and BARE_DECIMAL.search("| -.2 |")
    assert not any(map(BARE_DECIMAL.search, ("0.28", "{:.1%}", "fig.2", "a .csv file", "eq. .5a")))
