"""Messages of bad input: short, and harmless on a terminal, whatever file they quote."""

import pickle

from seatrial.core.values import InputError


def test_a_message_that_quotes_a_long_text_is_cut_in_its_middle() -> None:
    text = str(InputError(f"there is no file '{'x' * 4000}'; check the name"))
    assert text.startswith("there is no file 'xxx")
    assert " … " in text
    assert text.endswith("xxx'; check the name")
    assert len(text) < 700


def test_what_would_steer_a_terminal_is_escaped() -> None:
    assert str(InputError("no column '\x1b[2J\u202e'")) == r"no column '\x1b[2J\u202e'"


def test_a_message_survives_the_way_between_processes() -> None:
    assert str(pickle.loads(pickle.dumps(InputError("a 'b'; c")))) == "a 'b'; c"
