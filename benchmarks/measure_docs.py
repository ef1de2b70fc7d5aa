"""Words, figures, sentences and weight of the documentation, page by page.

`python benchmarks/measure_docs.py` prints a row for each page under docs/, the longest first. Written by hand is what
stands outside two kinds of text: between a comment `written by SCRIPT` and the next comment `end` (or the end of the
page), and what commands print in blocks `console`. A word has a letter or a digit; signs of a table are none.
"""

import argparse
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from statistics import median

DOCS = Path(__file__).parents[1] / "docs"
BUILT = ("gallery", "api")
"""Folders of docs that the build fills."""
LEAST_WORDS = 5
"""Words of a sentence from which it counts for the median: shorter ones are names and cells of tables; chosen."""

GENERATED = re.compile(r"<!-- written by .*?-->.*?(?:<!-- end.*?-->|\Z)", re.DOTALL)
CONSOLE = re.compile(r"^```console\n.*?^```", re.MULTILINE | re.DOTALL)
PRINTED = re.compile(r"^(?!\$ |```).*\n", re.MULTILINE)
FIGURE = re.compile(r"!\[[^\]]*\]\([^)]+\)|^(?:```|:::+)\{(?:figure|image)\}", re.MULTILINE)
NO_PROSE = re.compile(
    r"^(?:```|~~~).*?^(?:```|~~~)|^---\n.*?^---\n|^:::.*?$|^:[\w-]+:.*?$|^ {4,}\S.*?$|^#.*?$|\$\$.*?\$\$|<!--.*?-->",
    re.MULTILINE | re.DOTALL,
)
ONE_WORD = re.compile(r"`[^`]*`|\$[^$]+\$")
LINK = re.compile(r"!?\[([^\]]*)\]\([^)]*\)")
BLOCK_END = re.compile(r"\n\s*\n|\n\s*(?:[-*]|\d+\.) |(?<!\\)\||:\n")
SENTENCE_END = re.compile(r"(?<=[.?!])[\"')*]*\s+(?=[^a-z])")
WORD = re.compile(r"\S*\w\S*")


@dataclass(frozen=True)
class PageCount:
    """What is counted on a page.

    Attributes:
        words: written by hand.
        generated: words written by scripts and printed by commands.
        figures: pictures.
        sentences: those written by hand.
        weight: of the page's text and its pictures, bytes.
    """

    name: str
    words: int
    generated: int
    figures: int
    sentences: tuple[str, ...]
    weight: int

    @property
    def longest(self) -> int:
        """Words of the longest sentence."""
        return max(map(count_words, self.sentences), default=0)


def pages() -> list[Path]:
    """Return the pages under docs/, without those that the build writes."""
    return sorted(p for p in DOCS.rglob("*.md") if p.relative_to(DOCS).parts[0] not in BUILT)


def counted(path: Path) -> PageCount:
    """Return the counts of a page."""
    text = path.read_text(encoding="utf-8")
    own = by_hand(text)
    words = count_words(own)
    pictures = [(path.parent / name).resolve() for name in re.findall(r"!\[[^\]]*\]\(([^)\s]+)", text)]
    weight = sum(p.stat().st_size for p in [path, *pictures] if p.is_file())
    return PageCount(
        path.relative_to(DOCS).as_posix(), words, count_words(text) - words, len(FIGURE.findall(text)),
        tuple(sentences(own)), weight,
    )  # fmt: skip


def by_hand(text: str) -> str:
    """Return what of a page is written by hand."""
    return CONSOLE.sub(lambda block: PRINTED.sub("", block[0]), GENERATED.sub("", text))


def count_words(text: str) -> int:
    """Return the number of words of a text."""
    return len(WORD.findall(text))


def sentences(text: str) -> Iterator[str]:
    """Yield the sentences of paragraphs, lists and tables; code and a formula between signs count as one word."""
    prose = LINK.sub(r"\1", ONE_WORD.sub("X", NO_PROSE.sub("\n\n", text)))
    for block in BLOCK_END.split(prose):
        for sentence in SENTENCE_END.split(block):
            if count_words(sentence):
                yield " ".join(sentence.split())


def median_words(counts: list[PageCount]) -> float:
    """Return the median length of all sentences that have more than a few words."""
    lengths = [n for page in counts for s in page.sentences if (n := count_words(s)) >= LEAST_WORDS]
    return median(lengths)


def main(arguments: list[str]) -> None:
    """Print a row for each page, and the sums."""
    parser = argparse.ArgumentParser(description="words, figures, sentences and weight of the documentation")
    parser.add_argument("--long", type=int, metavar="WORDS", help="print the sentences that have more words")
    options = parser.parse_args(arguments)
    counts = sorted(map(counted, pages()), key=lambda page: page.words, reverse=True)
    print(f"{'page':34}{'words':>8}{'generated':>11}{'figures':>9}{'longest':>9}{'kB':>7}")
    for p in counts:
        print(f"{p.name:34}{p.words:8}{p.generated:11}{p.figures:9}{p.longest:9}{p.weight / 1e3:7.0f}")
    total = sum(p.words for p in counts), sum(p.generated for p in counts)
    print(f"{len(counts)} pages: {total[0]} words by hand, {total[1]} generated")
    print(f"{sum(p.figures > 0 for p in counts)} pages with a figure")
    print(f"sentences: median {median_words(counts):g} words, longest {max(p.longest for p in counts)}")
    if options.long is not None:
        for p in counts:
            for sentence in p.sentences:
                if (n := count_words(sentence)) > options.long:
                    print(f"{p.name}: {n}: {sentence}")


if __name__ == "__main__":
    main(sys.argv[1:])
