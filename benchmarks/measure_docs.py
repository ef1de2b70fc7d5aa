"""Words, figures, sentences, weight and overflow of the documentation, page by page.

`python benchmarks/measure_docs.py` prints a row for each page under docs/, the longest first. Words are those of
`wc -w`: whatever stands between spaces, signs of a table and code included. They count outside what a script writes
between a comment `written by SCRIPT` and the next comment `end` (or the end of the page). What commands print in blocks
`console` counts, as readers read it; its sentences do not. Apart from the pages stand README.md and CONTRIBUTING.md,
each with a row of its own. With `--site SITE` each page's row ends with the widths at which its built page sticks out
of the window, which needs Chromium and playwright.
"""

import argparse
import re
import shutil
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from measure_reports import WIDTH, WIDTHS

DOCS = Path(__file__).parents[1] / "docs"
APART = (DOCS.parent / "README.md", DOCS.parent / "CONTRIBUTING.md")
"""Pages that are not part of the documentation's count."""
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
WORD = re.compile(r"\w")


@dataclass(frozen=True)
class PageCount:
    """What is counted on a page.

    Attributes:
        words: outside what scripts write.
        generated: words that scripts write.
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
    words = count_words(GENERATED.sub("", text))
    pictures = [(path.parent / name).resolve() for name in re.findall(r"!\[[^\]]*\]\(([^)\s]+)", text)]
    weight = sum(p.stat().st_size for p in [path, *pictures] if p.is_file())
    name = path.relative_to(DOCS if path.is_relative_to(DOCS) else DOCS.parent).as_posix()
    figures, own = len(FIGURE.findall(text)), tuple(sentences(by_hand(text)))
    return PageCount(name, words, count_words(text) - words, figures, own, weight)


def by_hand(text: str) -> str:
    """Return what of a page is written by hand."""
    return CONSOLE.sub(lambda block: PRINTED.sub("", block[0]), GENERATED.sub("", text))


def count_words(text: str) -> int:
    """Return the number of words of a text, as `wc -w` counts them."""
    return len(text.split())


def sentences(text: str) -> Iterator[str]:
    """Yield the sentences of paragraphs, lists and tables; code and a formula between signs count as one word."""
    prose = LINK.sub(r"\1", ONE_WORD.sub("X", NO_PROSE.sub("\n\n", text)))
    for block in BLOCK_END.split(prose):
        for sentence in SENTENCE_END.split(block):
            if WORD.search(sentence):
                yield " ".join(sentence.split())


def median_words(counts: list[PageCount]) -> float:
    """Return the median length of all sentences that have more than a few words."""
    lengths = [n for page in counts for s in page.sentences if (n := count_words(s)) >= LEAST_WORDS]
    return median(lengths)


def cut_pages(site: Path, counts: list[PageCount]) -> dict[str, list[int]]:
    """Return for each page the widths at which its built page is wider than the window [px]."""
    from playwright.sync_api import sync_playwright

    cut: dict[str, list[int]] = {}
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        for width in WIDTHS:
            window = opened.new_page(viewport={"width": width, "height": 900})
            for page in counts:
                window.goto((site / page.name).with_suffix(".html").resolve().as_uri(), wait_until="load")
                if window.evaluate(WIDTH) > width:
                    cut.setdefault(page.name, []).append(width)
            window.close()
        opened.close()
    print(f"{len(cut)} of {len(counts)} pages are cut at {' or '.join(map(str, WIDTHS))} px")
    return cut


def main(arguments: list[str]) -> None:
    """Print a row for each page, and the sums."""
    parser = argparse.ArgumentParser(description="words, figures, sentences and weight of the documentation")
    parser.add_argument("--long", type=int, metavar="WORDS", help="print the sentences that have more words")
    parser.add_argument("--site", type=Path, help="the built pages, of which those that are cut are named")
    options = parser.parse_args(arguments)
    counts = sorted(map(counted, pages()), key=lambda page: page.words, reverse=True)
    cut = cut_pages(options.site, counts) if options.site else {}
    print(f"{'page':34}{'words':>8}{'generated':>11}{'figures':>9}{'longest':>9}{'kB':>7}{'  cut at' if cut else ''}")
    for p in [*counts, *map(counted, APART)]:
        row = f"{p.name:34}{p.words:8}{p.generated:11}{p.figures:9}{p.longest:9}{p.weight / 1e3:7.0f}"
        print(f"{row}  {' '.join(map(str, cut.get(p.name, ())))}".rstrip())
    total = sum(p.words for p in counts), sum(p.generated for p in counts)
    print(f"{len(counts)} pages, those of the repository's root apart: {total[0]} words, {total[1]} generated")
    print(f"{sum(p.figures > 0 for p in counts)} pages with a figure")
    print(f"sentences: median {median_words(counts):g} words, longest {max(p.longest for p in counts)}")
    if options.long is not None:
        for p in counts:
            for sentence in p.sentences:
                if (n := count_words(sentence)) > options.long:
                    print(f"{p.name}: {n}: {sentence}")


if __name__ == "__main__":
    main(sys.argv[1:])
