"""The documentation stays short: words, and lengths of sentences, as `benchmarks/measure_docs.py` counts them."""

from measure_docs import APART, by_hand, count_words, counted, median_words, pages, sentences

MOST_WORDS = 43_500  # as `wc -w` counts, outside what scripts write; chosen, and may only fall
LONGEST, MEDIAN = 40, 18  # words of a sentence, chosen
COUNTS = [counted(path) for path in pages()]


def test_pages_have_no_more_words_than_before() -> None:
    assert sum(page.words for page in COUNTS) <= MOST_WORDS


def test_no_sentence_has_more_than_forty_words() -> None:
    pages_and_root = [*COUNTS, *map(counted, APART)]
    long = [f"{p.name}: {s[:90]}" for p in pages_and_root for s in p.sentences if count_words(s) > LONGEST]
    assert long == []


def test_half_of_all_sentences_have_eighteen_words_or_fewer() -> None:
    assert median_words(COUNTS) <= MEDIAN


def test_what_counts_as_written_by_hand_and_as_a_sentence() -> None:
    """So that the lists above cannot become lists of nothing."""
    text = (
        "# A heading\n\nOne `a b c` is here, [as](page.md) stated. Two are\nthere: all of them.\n\n"
        "```toml\nname = 1\n```\n\n| key | what it is |\n|---|---|\n| `x` | A cell. It has two. |\n\n"
        "```console\n$ seatrial models\nabkowitz and more\n```\n\n"
        "<!-- written by x.py -->\nwords\n<!-- end -->\nThe end.\n"
    )
    own = by_hand(text)
    assert "seatrial models" in own and "abkowitz" not in own and "The end" in own and "\nwords" not in own
    assert list(sentences(own)) == [
        "One X is here, as stated.", "Two are there: all of them.", "key", "what it is", "X", "A cell.",
        "It has two.", "The end.",
    ]  # fmt: skip
