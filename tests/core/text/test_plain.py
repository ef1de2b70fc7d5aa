"""Plain text has no typographic signs, its numbers can be read back, its columns line up."""

import pytest

from seatrial.core.text.numbers import exact
from seatrial.core.text.plain import aligned, ascii_text, safe_text, wrapped


@pytest.mark.parametrize("value", [-3.2e-7, 12345.6, 4.5e12, -0.25, 0.0])
def test_numbers_can_be_read_back(value: float) -> None:
    assert float(ascii_text(exact(value))) == value


def test_signs_have_plain_forms() -> None:
    assert ascii_text("10⁻³ kg m² ± 5 …") == "10^-3 kg m^2 ± 5 ..."
    assert ascii_text("−9.5°, ∞ – ×") == "-9.5 deg, inf - x"
    assert ascii_text("‘as it’ → “χ² ≤ 3”") == "'as it' -> \"chi^2 <= 3\""


def test_what_steers_a_terminal_is_a_question_mark() -> None:
    assert safe_text("a\x1b[31m\u202e\udcffb\tc\n") == "a?[31m??b\tc\n"
    assert ascii_text("dérive \x9b ✓ 5°") == "dérive ? ✓ 5 deg"


def test_columns_line_up() -> None:
    lines = aligned([["name", "value", ""], ["a", "1.5", "note"], ["longer", "-12.25", ""]], flush_left=(0, 2))
    assert lines == ["name     value", "a          1.5  note", "longer  -12.25"]
    assert aligned([]) == []


ROWS = [["quantity", "first", "second", "note"], ["a", "1.5", "-2.25", "words that go on and on and on"]]


def test_a_column_of_words_goes_on_over_further_lines() -> None:
    lines = aligned(ROWS, flush_left=(0, 3), width=44)
    assert max(map(len, lines)) <= 44
    assert lines[1].startswith("a           1.5   -2.25  words that")
    assert lines[2].startswith(" " * 26) and lines[2].strip()


def test_numbers_that_do_not_fit_stand_in_a_second_table() -> None:
    lines = aligned([["x", "123456789", "987654321"], ["y", "1", "2"]], width=15)
    assert lines == ["x  123456789", "y          1", "x  987654321", "y          2"]


def test_names_of_columns_go_on_over_further_lines_before_anything_else() -> None:
    rows = [["controller", "reduced %", "rate sat. %"], ["chosen", "34.5", "19.9"], ["as published", "7.2", ""]]
    assert aligned(rows, width=34) == [
        "                         rate sat.",
        "controller    reduced %          %",
        "chosen             34.5       19.9",
        "as published        7.2",
    ]
    assert aligned(rows, width=40)[0] == "controller    reduced %  rate sat. %"


def test_later_lines_of_a_sentence_stand_further_in() -> None:
    assert wrapped("one two three four five", None, "  ") == ["  one two three four five"]
    assert wrapped("one two three four five", 16, "  ") == ["  one two three", "    four five"]
