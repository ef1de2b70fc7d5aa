"""Texts are in the plain English of the field: retired words stand in no page and in no text of the packages."""

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from statistics import median

import pytest
from tests.conventions.joined_texts import joined_texts
from tests.conventions.source_tree import PACKAGES, REPOSITORY, parsed, source_files

PLAIN = {
    r"tells?|telling|told": "identify, estimate, show, distinguish, state",
    r"mend(?:s|ed|ing)?": "correct, repair",
    r"unrest": "disturbance",
    r"foretold|foretells?": "predicted",
    r"the house|rooms|storeys?": "the package, its subpackages, its layers",
    r"she|her|hers": "it, its, of a craft",
    r"sailed|sails": "simulated",
    r"bears": "tolerates, has a margin of",
    r"asked for": "required",
}
"""Words that are not used -> what is written instead. Names of classes, functions and parameters also leave out words
that do not state what is meant: made, found, known, seen, said, own, others, what, how, begin, whole, left, taken."""
RETIRED = re.compile(rf"\b({'|'.join(PLAIN)})\b", re.IGNORECASE)
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
            instead = next(plain for words, plain in PLAIN.items() if re.fullmatch(words, match[0], re.IGNORECASE))
            yield f"{number}: {match[0]}: write {instead}: {line.strip()[:100]}"


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(REPOSITORY)))
def test_no_page_uses_a_retired_word(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    if page.name == "CHANGELOG.md":
        text = re.sub(r"^\|.*$", "", text, flags=re.MULTILINE)  # tables of renamed things quote the old names
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


MOST_WORDS = 40  # of a sentence on a screen; chosen
MEDIAN_WORDS, LEAST_WORDS = 18, 5  # of sentences, chosen
# A formula, an edit or a table of a file, which is read by its signs.
FORMULA = re.compile(r"(?:^|\s)[=:]=?\s|\[\[|'' ")
SENTENCE_END = re.compile(r"(?<=[.?!])\s+")


def _sentences() -> Iterator[tuple[str, str]]:
    """Sentences of screens, error messages, verdicts and tables of texts, each with the place where it stands."""
    files = (file for package in PACKAGES for file in source_files(package))
    texts = [(file.place(node), text) for file in files for node, text in joined_texts(file)]
    for table in sorted((REPOSITORY / "src" / "seatrial").rglob("*.toml")):
        rows = tomllib.loads(table.read_text(encoding="utf-8"))
        texts += [(f"{table.name} [{key}]", text) for key, row in rows.items() if isinstance(row, dict)
                  for text in row.values() if isinstance(text, str)]  # fmt: skip
    for place, text in texts:
        yield from ((place, part) for part in SENTENCE_END.split(text) if not FORMULA.search(part))


def test_no_sentence_of_a_screen_has_more_than_forty_words() -> None:
    long = [(place, text) for place, text in _sentences() if len(text.split()) > MOST_WORDS]
    assert [f"{place}: {text[:100]}" for place, text in long] == []


def test_half_of_all_sentences_have_eighteen_words_or_fewer() -> None:
    """Of those of five words and more: shorter ones are names and headings."""
    lengths = [count for _, text in _sentences() if (count := len(text.split())) >= LEAST_WORDS]
    assert median(lengths) <= MEDIAN_WORDS


def test_the_parts_of_a_message_are_read_together(tmp_path: Path) -> None:
    """So that no long sentence hides in pieces: alternatives, names of the function, constants and what it calls."""
    source = tmp_path / "seatrial" / "log.py"
    source.parent.mkdir()
    source.write_text(
        '''HINT = "; correct " "it"
def refuse(name):
    """Refuse."""
    reason = f"'{name}' is no " + kind(name)
    raise InputError(f"{name}: " + (reason if name else "none") + HINT)
def kind(name):
    return "channel" if name else "channel of this log"
'''
    )
    texts = [text for _, text in joined_texts(parsed(source, tmp_path))]
    assert "X: 'X' is no channel of this log; correct it" in texts
    assert "Refuse." not in texts
