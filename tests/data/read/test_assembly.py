"""Columns of several topics on one base, and channels derived from positions, courses and attitudes."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial.core.values import Array, InputError, Record
from seatrial.data.check import canonical_record
from seatrial.data.read import ColumnSpec, Layout, Log, topic_table
from seatrial.data.read.assemble import LogSource, assemble_record, record_of_sources
from seatrial.data.read.layout import Geometry

DEGREE = np.pi / 180.0
TIME = np.arange(0.0, 20.0, 0.1)


def log(**topics: dict[str, Array]) -> Log:
    return Log("run.log", tuple(topic_table("run.log", topic, columns) for topic, columns in topics.items()))


def layout(*columns: ColumnSpec, geometry: Geometry = Geometry()) -> Layout:  # noqa: B008
    return Layout("text", ColumnSpec("time", "", "s"), columns, geometry=geometry)


def derived(columns: dict[str, tuple[Array, str]], geometry: Geometry = Geometry(), frame: str = "") -> Record:  # noqa: B008
    """The record of one topic with these columns, named after their symbols."""
    specs = [ColumnSpec(symbol, symbol, unit, frame) for symbol, (_, unit) in columns.items()]
    table = {"time": TIME} | {symbol: values for symbol, (values, _) in columns.items()}
    return assemble_record(log(nav=table), layout(*specs, geometry=geometry), "")


def test_topics_meet_on_the_base_of_the_slowest_and_commands_are_held() -> None:
    slow, order_time = TIME[::5] + 0.03, np.array([-1.0, 4.02, 11.98])
    topics = log(
        gnss={"time": slow, "speed": 2.0 + 0.1 * slow},
        gyro={"time": TIME, "psi": np.mod(20.0 * TIME, 360.0)},
        order={"time": order_time, "pwm": np.array([1500.0, 1700.0, 1300.0])},
    )
    command = ColumnSpec("command_1", "order/pwm", "us", zero=1500.0, span=400.0, kind="command")
    columns = (ColumnSpec("u", "gnss/speed", "m/s"), ColumnSpec("psi", "gyro/psi", "deg"), command)
    record = assemble_record(topics, layout(*columns), "")
    np.testing.assert_allclose(record.time, slow[slow <= TIME[-1]], atol=1e-9)
    np.testing.assert_allclose(record["u"], 2.0 + 0.1 * record.time, atol=1e-9)
    np.testing.assert_allclose(record["psi"], 20.0 * DEGREE * record.time, atol=1e-9)
    expected = np.select([record.time < 4.02, record.time < 11.98], [0.0, 0.5], -0.5)
    np.testing.assert_array_equal(record["command_1"], expected)


def test_a_gap_stays_a_gap() -> None:
    here = (TIME < 5.0) | (TIME > 9.0)
    topics = log(a={"time": TIME[here], "x": TIME[here]}, b={"time": TIME, "y": TIME})
    columns = (ColumnSpec("u", "a/x", "m/s"), ColumnSpec("v", "b/y", "m/s"))
    record = assemble_record(topics, layout(*columns), "")
    inside = (record.time > 4.95) & (record.time < 9.05)
    assert np.isnan(record["u"][inside]).all() and np.isfinite(record["u"][~inside]).all()


def test_sources_of_several_files_have_their_own_clocks() -> None:
    one, other = log(a={"time": TIME, "x": np.sin(TIME)}), log(b={"time": TIME - 100.0, "y": np.sin(TIME)})
    sources = [
        LogSource(one, layout(ColumnSpec("u", "x", "m/s"))),
        LogSource(other, layout(ColumnSpec("v", "y", "m/s"))),
    ]
    with pytest.raises(InputError, match=r"'u' and 'v' do not overlap in time.*clock_offset"):
        record_of_sources("run", sources)
    twice = [sources[0], LogSource(other, layout(ColumnSpec("u", "y", "m/s")))]
    with pytest.raises(InputError, match="channel 'u' is given by two sources"):
        record_of_sources("run", twice)


def test_latitude_and_longitude_lie_on_the_plane_at_the_first_fix() -> None:
    # Snyder 1987, USGS PP 1395, table 3: a degree of latitude at 60 N is 111 412 m, of longitude 55 800 m
    lat, lon = 60.0 + 1e-3 * TIME / TIME[-1], 10.0 + 2e-3 * TIME / TIME[-1]
    record = derived({"lat": (lat, "deg"), "lon": (lon, "deg")})
    assert record["x0"][0] == 0.0 and record["y0"][0] == 0.0
    np.testing.assert_allclose([record["x0"][-1], record["y0"][-1]], [111.412, 111.600], atol=0.02)
    moved = derived({"lat": (lat, "deg"), "lon": (lon, "deg")}, Geometry(origin=(60.001 * DEGREE, 10.0 * DEGREE)))
    np.testing.assert_allclose(moved["x0"] - record["x0"], -111.412, atol=0.02)


def test_course_and_speed_are_earth_fixed_velocities() -> None:
    record = derived({"sog": (np.full(200, 10.0), "kn"), "cog": (np.full(200, 30.0), "deg")})
    speed = 10.0 * 1852.0 / 3600.0
    np.testing.assert_allclose(record["u"], speed * np.cos(30.0 * DEGREE))
    np.testing.assert_allclose(record["v"], speed * np.sin(30.0 * DEGREE))
    assert record.channel("u").frame == "earth" and record.channel("v").positive == "east"


def test_an_apparent_wind_less_the_velocity_over_ground_is_the_true_wind() -> None:
    """By hand: a craft that goes north at 10 kn meets a wind of 10 kn from the east at 45 deg off the bow, 14.14 kn."""
    same = np.ones(200)
    columns = {"wind_speed_relative": (np.sqrt(200.0) * same, "kn"), "wind_direction_relative": (45.0 * same, "deg"),
               "sog": (10.0 * same, "kn"), "cog": (0.0 * same, "deg"), "psi": (0.0 * same, "deg")}  # fmt: skip
    record = derived(columns)
    np.testing.assert_allclose(record["wind_speed"], 10.0 * 1852.0 / 3600.0, rtol=1e-12)
    np.testing.assert_allclose(np.degrees(record["wind_direction"]), 90.0, rtol=1e-12)
    assert "wind_speed" not in derived({k: v for k, v in columns.items() if k != "psi"})


def test_a_magnetic_heading_needs_the_variation() -> None:
    heading = {"psi_magnetic": (20.0 + TIME, "deg")}
    record = derived(heading, Geometry(variation=3.0 * DEGREE))
    np.testing.assert_allclose(record["psi"], (23.0 + TIME) * DEGREE)
    with pytest.raises(InputError, match="a magnetic heading needs the variation"):
        derived(heading)


@pytest.mark.parametrize("frame", ["", "enu"])
def test_quaternions_of_either_frame_give_the_same_angles(frame: str) -> None:
    psi, theta, phi = 0.05 * TIME, 0.1 * np.sin(TIME), 0.2 * np.cos(TIME)
    attitude = Rotation.from_euler("ZYX", np.column_stack([psi, theta, phi]))
    if frame:  # from forward-starboard-down in north-east-down to forward-port-up in east-north-up
        to_enu, to_flu = Rotation.from_matrix([[0, 1, 0], [1, 0, 0], [0, 0, -1]]), Rotation.from_euler("x", np.pi)
        attitude = to_enu * attitude * to_flu
    x, y, z, w = attitude.as_quat().T
    columns = {"q_w": (w, "1"), "q_x": (x, "1"), "q_y": (y, "1"), "q_z": (z, "1")}
    record = derived(columns, frame=frame)
    for symbol, angle in (("psi", psi), ("theta", theta), ("phi", phi)):
        np.testing.assert_allclose(np.unwrap(record[symbol]), angle, atol=1e-9)


def test_a_pose_in_the_plane_has_a_heading_alone_and_one_with_a_gap_keeps_its_roll() -> None:
    half, flat = 0.05 * TIME, 0.0 * TIME
    plane = {"q_w": (np.cos(half), "1"), "q_x": (flat, "1"), "q_y": (flat, "1"), "q_z": (np.sin(half), "1")}
    assert set(derived(plane).channels) == {"psi"}
    roll = np.full(len(TIME), 0.1)
    roll[0] = np.nan
    rolled = {"q_w": (np.cos(roll), "1"), "q_x": (np.sin(roll), "1"), "q_y": (flat, "1"), "q_z": (flat, "1")}
    record = derived(rolled)
    np.testing.assert_allclose(record["phi"][1:], 0.2)
    assert "theta" not in record


def test_enu_axes_are_turned_north_east() -> None:
    columns = {"x0": (TIME, "m"), "y0": (2.0 * TIME, "m"), "psi": (0.1 * TIME, "rad"), "r": (0.1 + 0 * TIME, "rad/s")}
    record = derived(columns, frame="enu")
    np.testing.assert_allclose(record["x0"], 2.0 * TIME)
    np.testing.assert_allclose(record["y0"], TIME)
    np.testing.assert_allclose(record["psi"], np.pi / 2.0 - 0.1 * TIME)
    np.testing.assert_allclose(record["r"], -0.1)


def test_an_antenna_beside_the_centre_line_is_moved_to_it() -> None:
    """A craft that spins on the spot: the track of the antenna is a circle, that of the craft a point."""
    radius, rate = 2.0, 0.3
    psi = rate * TIME
    degree_m = (111_412.0, 55_800.0)  # at 60 N, as above
    lat, lon = 60.0 - radius * np.sin(psi) / degree_m[0], 10.0 + radius * np.cos(psi) / degree_m[1]
    course, speed = np.pi + psi, np.full(200, radius * rate)
    columns = {"lat": (lat, "deg"), "lon": (lon, "deg"), "psi": (psi, "rad"), "r": (rate + 0 * TIME, "rad/s"),
               "sog": (speed, "m/s"), "cog": (course, "rad")}  # fmt: skip
    record = derived(columns, Geometry(antenna_y=radius))
    for symbol in ("x0", "y0", "u", "v"):
        assert np.ptp(record[symbol]) < 5e-3, symbol


def test_positions_on_a_plane_are_the_antenna_s_unless_they_come_with_velocities_or_state_a_place() -> None:
    """Easting and northing of a craft that spins on the spot: a circle around it, whatever axes they are in."""
    ahead, aside, rate = 3.0, 2.0, 0.3
    psi = rate * TIME
    x0 = ahead * np.cos(psi) - aside * np.sin(psi)
    y0 = ahead * np.sin(psi) + aside * np.cos(psi)
    track = {"x0": (x0, "m"), "y0": (y0, "m"), "psi": (psi, "rad")}
    moved = derived(track, Geometry(antenna_x=ahead, antenna_y=aside))
    assert moved.channel("x0").reference_point == moved.channel("y0").reference_point == ahead
    at_midship = canonical_record(moved, 0.0)
    for symbol in ("x0", "y0"):
        np.testing.assert_allclose(at_midship[symbol], 0.0, atol=1e-9)
    speeds = {"u": (0.0 * TIME, "m/s"), "v": (0.0 * TIME, "m/s")}
    pose = derived(track | speeds, Geometry(antenna_x=ahead, antenna_y=aside))
    np.testing.assert_array_equal(pose["x0"], x0)
    assert pose.channel("x0").reference_point == 0.0


@pytest.mark.parametrize(
    ("columns", "sentence"),
    [
        (("lat",), "channel 'lat' needs 'lon' as well"),
        (("cog",), "channel 'cog' needs 'sog' as well"),
        (("stw", "sog", "cog"), "'stw' and 'sog' both give the speed 'u'"),
        (("q_w", "q_x", "q_y"), "the quaternion lacks 'q_z'"),
        (("stw", "u"), "channel 'u' is given, and follows from other columns as well"),
        (("latitude",), "unknown channel 'latitude'; write lat"),
        (("rot",), 'write r with unit = "deg/min"'),
    ],
)
def test_what_cannot_be_derived_is_refused(columns: tuple[str, ...], sentence: str) -> None:
    units = {"lat": "deg", "cog": "deg", "stw": "m/s", "sog": "m/s", "u": "m/s"}
    with pytest.raises(InputError, match=sentence):
        derived({symbol: (TIME + 1.0, units.get(symbol, "1")) for symbol in columns})
