"""The table of names: every language has every quantity, no heading means two, every pattern is one."""

import re
from collections import defaultdict

import numpy as np
import pytest

from seatrial.data.readings import name_table, without_codes


def test_every_language_has_a_heading_of_every_quantity() -> None:
    languages = name_table()["languages"]
    quantities = set().union(*languages.values())
    assert {name: sorted(quantities - set(words)) for name, words in languages.items() if quantities - set(words)} == {}
    assert all(words.split() for language in languages.values() for words in language.values())


def test_no_heading_means_two_quantities() -> None:
    meanings = defaultdict[str, set[str]](set)
    for language in name_table()["languages"].values():
        for quantity, words in language.items():
            for word in words.split():
                assert re.fullmatch(r"[a-z0-9_]+", word), "small letters without accents"
                meanings[word].add(quantity)
    assert {word: sorted(quantities) for word, quantities in meanings.items() if len(quantities) > 1} == {}


@pytest.mark.parametrize(
    ("symbol", "usual", "code", "emptied"),
    [("psi", 359.0, 511.0, True), ("cog", 359.9, 360.0, False), ("cog", 180.0, 360.0, True), ("r", 3.0, -128.0, True),
     ("sog", 9.0, 102.3, True), ("lat", 54.0, 91.0, True), ("delta", 3.0, 511.0, False)],
)  # fmt: skip
def test_a_code_of_a_standard_is_no_reading_where_readings_jump_to_it(
    symbol: str, usual: float, code: float, emptied: bool
) -> None:
    cells = usual + 0.1 * np.sin(np.arange(50.0))
    cells[20:23] = code
    assert bool(np.isnan(without_codes(symbol, cells)[20:23]).all()) is emptied
    assert np.isfinite(np.delete(without_codes(symbol, cells), [20, 21, 22])).all()
