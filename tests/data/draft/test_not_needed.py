"""Columns that are known and not needed are named with the reason, where what replaces them is recorded."""

import pytest

from seatrial.data.draft.naming import columns_not_needed, not_needed_text


@pytest.mark.parametrize(
    ("name", "used", "words"),
    [
        ("GLOBAL_POSITION_INT/vx", {"lat"}, "positions show"),
        ("GLOBAL_POSITION_INT/hdg", {"psi"}, "heading"),
        ("GPS_RAW_INT/cog", {"lat"}, "receiver"),
        ("SERVO_OUTPUT_RAW/servo9_raw", set[str](), "disabled"),
        ("SteeringGear/rudder_order", {"delta"}, "an order"),
        ("Commanded rudder [deg]", {"delta"}, "an order"),
        ("Shaft/power", set[str](), "power"),
        ("Propeller torque (kNm)", set[str](), "torque"),
        ("speed_kmh", {"lat"}, "positions show"),
        ("hdop", set[str](), "receiver"),
        ("gFx", set[str](), "accelerations"),
        ("Accel X (m/s2)", set[str](), "accelerations"),
        ("Gyro X (deg/s)", {"phi"}, "roll angle"),
        ("Gyro Y (deg/s)", set[str](), "no model"),
    ],
)
def test_the_reason_is_given(name: str, used: set[str], words: str) -> None:
    assert words in columns_not_needed([name], used)[name]


@pytest.mark.parametrize("name", ["GLOBAL_POSITION_INT/vx", "rudder_order", "depth", "Powerful", "nav/vx"])
def test_what_may_be_needed_is_left_to_a_person(name: str) -> None:
    assert columns_not_needed([name], set()) == {}


def test_columns_of_one_reason_stand_together() -> None:
    names = ["SYS_STATUS/load", "GLOBAL_POSITION_INT/vx", "SYS_STATUS/errors_comm", "GLOBAL_POSITION_INT/vy"]
    reasons = columns_not_needed(names, {"lat"})
    assert not_needed_text(reasons).startswith("GLOBAL_POSITION_INT/vx and GLOBAL_POSITION_INT/vy (the positions show")
    assert not_needed_text(reasons, 1).endswith("; 2 more, in the file") and not_needed_text({}) == ""
