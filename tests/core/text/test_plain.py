"""Plain text has no typographic signs, its numbers can be read back, its columns line up."""

import pytest

from seatrial.core.text.numbers import exact
from seatrial.core.text.plain import aligned, ascii_text


@pytest.mark.parametrize("value", [-3.2e-7, 12345.6, 4.5e12, -0.25, 0.0])
def test_numbers_can_be_read_back(value: float) -> None:
    assert float(ascii_text(exact(value))) == value


def test_signs_have_plain_forms() -> None:
    assert ascii_text("10⁻³ kg m² ± 5 …") == "10^-3 kg m^2 ± 5 ..."
    assert ascii_text("−9.5°, ∞ – ×") == "-9.5 deg, inf - x"


def test_columns_line_up() -> None:
    lines = aligned([["name", "value", ""], ["a", "1.5", "note"], ["longer", "-12.25", ""]], flush_left=(0, 2))
    assert lines == ["name     value", "a          1.5  note", "longer  -12.25"]
    assert aligned([]) == []
