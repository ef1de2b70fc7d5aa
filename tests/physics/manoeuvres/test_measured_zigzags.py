"""The manoeuvres of two measured series are recognised and their measures are plausible."""

import math

import pytest

RUNS = ("Z_05_01", "Z_10_01", "Z_10_05", "Z_15_01", "Z_15_05", "Z_20_05", "Z_25_05", "Z_30_05", "Z_35_05")
SIDED = ("Z_10_10_P", "Z_10_10_S", "Z_20_10_P", "Z_20_10_S")


@pytest.mark.parametrize("name", [*RUNS, *SIDED])
def test_hsva_zigzags(hsva, name: str) -> None:
    from seatrial.physics.manoeuvres import ManoeuvreKind, measures, recognise_manoeuvre
    from seatrial.physics.manoeuvres.imo import switching_heading
    from seatrial.physics.manoeuvres.recognition import ObservedManoeuvre

    record = hsva(name)
    seen = ObservedManoeuvre.from_record(record)
    assert recognise_manoeuvre(record) is ManoeuvreKind.ZIGZAG
    rudder, heading = (float(part) for part in name.split("_")[1:3])
    found = measures(record, 7.0)
    assert found["rudder_deg"] == pytest.approx(rudder, abs=0.1)
    # the rudder moves some 0.3 s after the switching heading was reached
    assert heading <= switching_heading(seen) <= heading + 3.0
    assert math.copysign(1.0, seen.holds[0].angle) == (-1.0 if name.endswith("P") else 1.0)
    assert 1.0 < found["overshoot_1_deg"] < 13.0
    assert found["approach_speed"] == pytest.approx(1.177, abs=0.01)
    assert found["overshoot_2_deg"] > found["overshoot_1_deg"]


def test_hsva_ten_ten_repeats_and_criteria(hsva) -> None:
    from seatrial.physics.manoeuvres import imo_criteria

    for name in ("Z_10_10_P", "Z_10_10_S"):
        found = {c.name: c for c in imo_criteria(hsva(name), 7.0, scale=45.7, switching=math.radians(10.0))}
        assert found["overshoot_1_deg"].value == pytest.approx(9.7, abs=0.3)
        assert found["overshoot_1_deg"].limit == 20.0
        assert found["initial_turning_L"].value == pytest.approx(1.7, abs=0.1)


@pytest.mark.parametrize(
    ("name", "kind", "side"),
    [
        ("turning/turn_14-Oct-2020_15_06_53", "turning-circle", -1),
        ("turning/turn_14-Sep-2020_13_39_32", "turning-circle", 1),
        ("zigzag/zigzag_31-Jul-2020_13_22_52", "zigzag", 1),
        ("zigzag/zigzag_31-Jul-2020_13_50_28", "zigzag", -1),
        ("zigzag/zigzag_31-Jul-2020_14_03_39", "zigzag", -1),
        ("berthing/berthing_12-Nov-2020_11_07_23", "other", 0),
    ],
)
def test_esso_osaka_runs_with_course_keeping_before_them(esso, name: str, kind: str, side: int) -> None:
    from seatrial.physics.manoeuvres.recognition import ObservedManoeuvre

    seen = ObservedManoeuvre.from_record(esso(name))
    assert seen.kind == kind
    if side:
        assert (
            math.copysign(1.0, seen.longest_hold[0].angle if kind == "turning-circle" else seen.holds[0].angle) == side
        )


def test_esso_osaka_turns_to_starboard_and_port_agree(esso) -> None:
    from seatrial.physics.manoeuvres import measures

    starboard = measures(esso("turning/turn_14-Sep-2020_13_39_32"), 3.0)
    port = measures(esso("turning/turn_14-Sep-2020_14_16_04"), 3.0)
    assert starboard["tactical_diameter_L"] == pytest.approx(port["tactical_diameter_L"], rel=0.1)
    assert 2.0 < port["advance_L"] < starboard["advance_L"] < 3.0
