"""What is said of names that are no channel: the field's words are known, and nothing unrelated is offered."""

import difflib

import pytest

from seatrial.core.values import NOTATION, InputError, channel_hint, quantity
from seatrial.core.values.errors import MAX_LISTED, listed
from seatrial.core.values.notation import ALIASES
from seatrial.data.read.layout import LOG_QUANTITIES, log_quantity

SYMBOLS = sorted({*NOTATION, *LOG_QUANTITIES})


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("hdg", "write psi (true heading) or psi_magnetic"),
        ("ROT", 'write r with unit = "deg/min"'),
        ("rpm", 'write n with unit = "rpm", or rpm_1'),
        ("pwm", "write command_1 with zero and span"),
        ("utc", "write time = { column = ... } beside the channels"),
        ("latitude", "write lat"),
        ("SOG", "did you mean 'sog'?"),
        ("comand_1", "did you mean 'command_1'?"),
    ],
)
def test_words_of_the_field_are_answered_with_what_to_write(name: str, says: str) -> None:
    with pytest.raises(InputError) as error:
        log_quantity(name)
    assert says in str(error.value)


@pytest.mark.parametrize(("name", "says"), [("lat", "a record has 'x0'"), ("cog", "a record has 'v'"), ("yaw", "psi")])
def test_a_record_has_what_follows_from_a_measurement(name: str, says: str) -> None:
    with pytest.raises(InputError, match=says):
        quantity(name)


@pytest.mark.parametrize("name", [*ALIASES, "lat", "lon", "sog", "cog", "rud", "phl", "gps", "wind", "depth", "xyz"])
def test_no_unrelated_channel_is_offered(name: str) -> None:
    hint = channel_hint(name, sorted(NOTATION))
    if "did you mean" in hint:
        offered = hint.partition("'")[2].partition("'")[0]
        assert difflib.SequenceMatcher(None, name.lower(), offered.lower()).ratio() >= 0.75
    assert len(hint) < 250


def test_letters_in_another_order_are_meant_before_letters_that_differ() -> None:
    assert "did you mean 'lat'?" in channel_hint("lta", ["delta", "lat", "lon"])


def test_long_lists_are_cut_and_say_so() -> None:
    assert listed(["a", "b"]) == "a, b" and listed([]) == ""
    text = listed(SYMBOLS)
    assert len(text) < MAX_LISTED + 20 and text.endswith(" more")
