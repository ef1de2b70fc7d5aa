"""Channels and the outputs that instruments show of them."""

from seatrial.core.equations.model import channel_of, measured_name


def test_a_channel_and_what_its_instrument_shows_are_names_of_one_another() -> None:
    assert channel_of(measured_name("psi")) == channel_of("psi") == "psi"
