"""A file's name against what its run shows."""

import pytest

from seatrial.data.draft.stretches import LogStretch, name_contradiction

CIRCLE = LogStretch("circle_port_1", 0.0, 300.0, "heading changes by 587 deg to port")
ZIGZAG = LogStretch("zigzag1", 0.0, 300.0, "11 turns to alternate sides")
STRAIGHT = LogStretch("straight1", 300.0, 400.0, "heading within 5 deg")


@pytest.mark.parametrize("name", ["03 Zigzag 20-20 first port", "run_zz20_2", "zz10", "ZigZag", "zig-zag 3"])
def test_a_zigzag_that_is_a_circle_is_named(name: str) -> None:
    assert name_contradiction(name, (CIRCLE, STRAIGHT)) == (
        "the name says zigzag, the motion does not: heading changes by 587 deg to port"
    )


@pytest.mark.parametrize(
    ("name", "stretches"),
    [
        ("zigzag 10", (STRAIGHT, ZIGZAG)),
        ("circle_35", (CIRCLE,)),
        ("buzz", (CIRCLE,)),
        ("run 7", (CIRCLE,)),
        ("zigzag and circle", (CIRCLE,)),
        ("zigzag", (STRAIGHT,)),
        ("zigzag", ()),
    ],
)
def test_a_name_that_agrees_or_says_nothing_is_none(name: str, stretches: tuple[LogStretch, ...]) -> None:
    assert name_contradiction(name, stretches) == ""
