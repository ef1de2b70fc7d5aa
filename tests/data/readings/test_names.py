"""The table of names: every language has every quantity, no heading means two, every pattern is one."""

import re
from collections import defaultdict

from seatrial.data.readings import name_table


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
