"""Columns are recognised by names that people give them."""

import pytest

from seatrial.data.draft.naming import guess_by_name


@pytest.mark.parametrize(
    ("name", "symbol", "unit"),
    [
        ("Speed fwd [kn]", "u", "kn"),
        ("Forward speed (m/s)", "u", "m/s"),
        ("Speed stbd [kn]", "v", "kn"),
        ("lateral velocity", "v", ""),
        ("Shaft [rpm]", "n", "rpm"),
        ("Wave probe LCG [mm]", "zeta", "mm"),
        ("Heave LCG [mm]", "z", "mm"),
    ],
)
def test_speeds_along_and_across_and_the_rate_of_the_shaft_are_recognised(name: str, symbol: str, unit: str) -> None:
    guess = guess_by_name("", name, "")
    assert guess is not None
    assert (guess.symbol, guess.unit) == (symbol, unit)


@pytest.mark.parametrize(
    ("name", "symbol"),
    [
        ("pwm_port", "command_1"),
        ("stbd_thruster", "command_2"),
        ("left motor pwm", "command_1"),
        ("servo3_raw", "command_3"),
        ("battery_v", "voltage"),
        ("batt", "voltage"),
        ("compass", "psi"),
        ("Kurs HDG [°]", "psi"),
        ("Heading by compass (deg)", "psi"),
        ("Comp hdg (deg)", "psi"),
        ("Ship's head (deg)", "psi"),
        ("Rudder blade (deg)", "delta"),
        ("Rudder position", "delta"),
        ("rudder feedback", "delta"),
        ("battery voltage [V]", "voltage"),
        ("RudderAngle", "delta"),
        ("Rudder Port", "delta"),
        ("RPM Stbd", "n"),
        ("port_shaft_rpm", "n"),
        ("ShaftRPM", "n"),
        ("LogSpeed", "stw"),
        ("SpeedOverGround", "sog"),
        ("GPSCourse", "cog"),
        ("Gyro", "psi"),
        ("thrustPort", "command_1"),
        ("motorL", "command_1"),
        ("thr_r", "command_2"),
        ("PWM_L [us]", "command_1"),
        ("WindSpeedTrue", "wind_speed"),
    ],
)
def test_commands_batteries_and_words_set_apart_by_capitals_are_recognised(name: str, symbol: str) -> None:
    guess = guess_by_name("", name, "")
    assert guess is not None
    assert guess.symbol == symbol


def test_a_letter_names_the_side_of_a_thruster() -> None:
    left, right = guess_by_name("", "motorL", ""), guess_by_name("", "escR", "")
    assert left is not None and right is not None and (left.side, right.side) == ("port", "starboard")
    assert guess_by_name("", "temp_L", "") is None


def test_a_topic_of_orders_has_those_of_thrusters_alone() -> None:
    left = guess_by_name("thrusters_left_cmd", "thr_left", "")
    assert left is not None and left.symbol == "command_1"
    assert guess_by_name("heading_setpoint", "heading", "") is None


def test_the_rate_of_an_engine_is_recognised_and_not_taken_for_that_of_the_propeller() -> None:
    guess = guess_by_name("", "Engine rpm", "")
    assert guess is not None
    assert (guess.symbol, guess.unit) == ("n", "rpm")
    assert "propeller turns over engine turns" in guess.rule.unused_because


def test_a_speed_of_the_wind_is_no_speed_of_the_craft() -> None:
    guess = guess_by_name("", "Wind speed fwd", "")
    assert guess is not None and guess.symbol == "wind_speed" and "apparent" in guess.rule.other_reading


@pytest.mark.parametrize(
    ("name", "side"), [("thr_port", "port"), ("stbd_thruster", "starboard"), ("left motor pwm", "port"), ("motor1", "")]
)
def test_the_side_of_a_thruster_is_that_of_its_name(name: str, side: str) -> None:
    guess = guess_by_name("", name, "")
    assert guess is not None and guess.side == side


@pytest.mark.parametrize(
    ("name", "symbol", "unit"),
    [
        ("Gyro heading", "psi", ""),
        ("GPS1 SOG (kn)", "sog", "kn"),
        ("GNSS2 Longitude", "lon", ""),
        ("gps speed [m/s]", "sog", "m/s"),
        ("GPS course", "cog", ""),
        ("IMU yaw rate (deg/s)", "r", "deg/s"),
        ("Heading true", "psi", ""),
        ("heading_deg_t", "psi", ""),
        ("Rudder actual", "delta", ""),
        ("Wind app. spd", "wind_speed_relative", ""),
        ("Wind rel. Geschw. [m/s]", "wind_speed_relative", "m/s"),
        ("Windrichtung scheinbar [°]", "wind_direction_relative", "deg"),
        ("Wahre Windrichtung [°]", "wind_direction", "deg"),
        ("Wind Direction (deg)", "wind_direction", "deg"),
        ("Heading gyro (deg)", "psi", "deg"),
        ("Kurs rw [°]", "psi", "deg"),
        ("Spd", "sog", ""),
        ("GCrs", "cog", ""),
        ("GyrZ", "r", ""),
        ("C1_left", "command_1", ""),
        ("C3_right", "command_2", ""),
        ("apparent wind direction", "wind_direction_relative", ""),
        ("gyro_z", "r", ""),
        ("Navigation Latitude", "lat", ""),
        ("Motion Roll (deg)", "phi", "deg"),
    ],
)
def test_an_instrument_before_a_name_and_how_it_was_taken_behind_it_change_nothing(
    name: str, symbol: str, unit: str
) -> None:
    guess = guess_by_name("", name, "")
    assert guess is not None and (guess.symbol, guess.unit) == (symbol, unit)


@pytest.mark.parametrize("name", ["Gyro X (deg/s)", "Accel Y (m/s2)", "x [deg]", "surge [m]"])
def test_a_unit_of_another_motion_is_another_quantity(name: str) -> None:
    assert guess_by_name("", name, "") is None
