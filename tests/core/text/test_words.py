"""Counts, lists and sentences; text from elsewhere is safe to show."""

from hypothesis import given
from hypothesis import strategies as st

from seatrial.core.text.words import common_prefix, counted, enumeration, ordinal, printable, sentence


def test_numbers_in_words() -> None:
    assert [ordinal(n) for n in (1, 2, 3, 4, 11, 12, 21, 112)] == [
        "1st", "2nd", "3rd", "4th", "11th", "12th", "21st", "112th",
    ]  # fmt: skip
    assert [counted(n, "run") for n in (0, 1, 2)] == ["no runs", "1 run", "2 runs"]


def test_lists_end_with_and() -> None:
    assert [enumeration(list(items)) for items in ("", "a", "ab", "abc")] == ["", "a", "a and b", "a, b and c"]
    assert enumeration(list("abcdefgh")) == "a, b, c, d, e and 3 more"
    assert enumeration(list("abcde"), 4) == "a, b, c and 2 more"


def test_sentences_keep_the_names_they_begin_with() -> None:
    assert sentence("m_x is fixed") == "m_x is fixed."
    assert sentence("m is fixed", ["m"]) == "m is fixed."
    assert sentence("all are known.") == "All are known."
    assert sentence("") == ""


def test_names_lose_their_common_beginning_only() -> None:
    assert common_prefix(["HSVA_KVLCC2_Z_05_01", "HSVA_KVLCC2_Z_10_05"]) == "HSVA_KVLCC2_Z_"
    assert common_prefix(["zigzag", "turn"]) == "" and common_prefix(["alone_in_the_world"]) == ""


@given(st.text(max_size=500))
def test_printable_text_has_no_control_characters_and_an_end(text: str) -> None:
    shown = printable(text)
    assert all(c.isprintable() or c.isspace() for c in shown)
    assert len(shown) <= 300 and "\x1b" not in shown and "\n" not in shown
