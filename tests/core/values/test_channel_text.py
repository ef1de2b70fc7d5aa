"""Channels have letters, meanings and units of people; headings have no jumps."""

import numpy as np

from seatrial.core.values.notation import (
    channel_label,
    channel_letter,
    channel_meaning,
    channel_unit,
    display_values,
    reading_order,
    unit_text,
)


def test_units_are_those_of_people() -> None:
    assert [unit_text(si) for si in ("rad", "rad/s", "kg m^2", "m^3", "1")] == ["deg", "deg/s", "kg m²", "m³", ""]
    assert (channel_unit("psi"), channel_unit("something")) == ("rad", "1")


def test_names_of_channels() -> None:
    assert channel_meaning("psi") == "heading" and channel_meaning("something") == "something"
    assert channel_letter("psi") == "ψ" and channel_letter("u") == "u"
    assert channel_label("psi", "rad") == "ψ [deg]" and channel_label("something", "1") == "something"
    assert channel_label("", "rad") == "[deg]"


def test_a_wrapped_heading_has_no_jumps() -> None:
    heading = np.linspace(0.0, 4.0 * np.pi, 200)
    wrapped = np.angle(np.exp(1j * heading))
    wrapped[50] = np.nan
    values = display_values("psi", wrapped, "rad")
    assert np.nanmax(np.abs(values - np.degrees(heading))) < 1e-9 and np.isnan(values[50])
    assert np.ptp(display_values("u", wrapped[:50], "m/s") - wrapped[:50]) == 0.0


def test_positions_are_no_curves_and_unknown_channels_come_last() -> None:
    assert reading_order(["x0", "something", "u", "psi", "y0", "u"]) == ["psi", "u", "something"]
