"""A trial file drafted from logs of a craft that is simulated: units, frames and signs as planted, nothing silent."""

import os
import re
import sys
from pathlib import Path

import numpy as np
import openpyxl
import pytest
from tests.data.draft.craft import two_thrusters
from tests.data.read.samples import SAMPLES

from seatrial.api import check, draft_trial, survey_log
from seatrial.core.values import Array, InputError, Severity
from seatrial.data.draft import ColumnGuess, find_stretches, guess_columns
from seatrial.data.draft.guess import recognised_columns
from seatrial.data.draft.naming import guess_by_name
from seatrial.data.draft.runs_of_logs import zone_offsets
from seatrial.data.draft.survey import column_values, time_column
from seatrial.data.read.formats.text import text_layout
from seatrial.data.trial import load_runs

DEGREE, KNOT = np.pi / 180.0, 1852.0 / 3600.0
STEP = 0.2


def motion() -> dict[str, Array]:
    """A zigzag, a straight run and a circle by Nomoto's first-order equation; SI, starboard positive."""
    time = STEP * np.arange(2400)
    delta = np.where(time < 180.0, 0.3 * np.sign(np.sin(0.12 * time)), np.where(time < 260.0, 0.0, 0.35))
    r, psi = np.zeros(time.size), np.zeros(time.size)
    for k in range(1, time.size):
        r[k] = r[k - 1] + STEP * (0.15 * delta[k - 1] - r[k - 1]) / 6.0
        psi[k] = psi[k - 1] + STEP * r[k - 1]
    u = np.full(time.size, 4.0) - 20.0 * r**2
    v = -8.0 * r
    north, east = u * np.cos(psi) - v * np.sin(psi), u * np.sin(psi) + v * np.cos(psi)
    x0, y0 = (STEP * np.concatenate([[0.0], np.cumsum(w)[:-1]]) for w in (north, east))
    return {"t": time, "delta": delta, "r": r, "psi": psi, "u": u, "v": v, "north": north, "east": east,
            "x0": x0, "y0": y0}  # fmt: skip


TRUTH = motion()
BASE = {"time": TRUTH["t"], "north": TRUTH["x0"], "east": TRUTH["y0"], "heading": np.mod(TRUTH["psi"] / DEGREE, 360.0)}


def write(path: Path, columns: dict[str, Array]) -> Path:
    rows = np.column_stack(list(columns.values())).tolist()
    lines = [",".join(columns), *(",".join(f"{x:.13g}" for x in row) for row in rows)]
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


def guesses(path: Path) -> dict[str, ColumnGuess]:
    (part,) = draft_trial(path).guesses
    return {guess.symbol: guess for guess in part if guess.is_used}


def test_angles_of_a_telephone_are_roll_pitch_and_a_heading_that_is_not_needed(tmp_path: Path) -> None:
    """Azimuth, pitch, roll in degrees: a pitch below a degree goes by its neighbours."""
    time = 0.05 * np.arange(2000)
    roll = 9.0 * np.exp(-time / 40.0) * np.cos(1.1 * time)
    columns = {"time": time, "Azimuth": 212.0 + 0.1 * np.sin(time), "Pitch": 0.7 + 0.02 * np.cos(time), "Roll": roll}
    draft = draft_trial(write(tmp_path / "run.csv", columns))
    used = {guess.symbol: guess for guess in draft.guesses[0] if guess.is_used}
    assert set(used) == {"theta", "phi"} and {one.unit for one in used.values()} == {"deg"}
    assert 'name = "roll"' in draft.text and not draft.open_questions
    assert "Azimuth (psi, nothing that steers is recorded" in draft.text


@pytest.mark.parametrize(
    ("unit", "sign"), [("rad/s", 1.0), ("deg/s", 1.0), ("deg/min", 1.0), ("deg/s", -1.0), ("deg/min", -1.0)]
)
def test_the_unit_and_sign_of_a_yaw_rate_follow_from_the_heading(unit: str, sign: float, tmp_path: Path) -> None:
    size = {"rad/s": 1.0, "deg/s": 1.0 / DEGREE, "deg/min": 60.0 / DEGREE}[unit]
    result = guesses(write(tmp_path / "run.csv", BASE | {"ROT": sign * size * TRUTH["r"]}))
    assert (result["r"].unit, result["r"].positive, result["r"].is_open) == (unit, "" if sign > 0 else "port", False)
    assert (result["psi"].unit, result["x0"].symbol) == ("deg", "x0")


@pytest.mark.parametrize("symbols", [("u", "v"), ("north", "east")])
@pytest.mark.parametrize("size", [1.0, KNOT])
def test_the_frame_and_unit_of_velocities_follow_from_the_track(
    symbols: tuple[str, str], size: float, tmp_path: Path
) -> None:
    velocities = {name: TRUTH[symbol] / size for name, symbol in zip("uv", symbols, strict=True)}
    result = guesses(write(tmp_path / "run.csv", BASE | velocities))
    for symbol in ("u", "v"):
        guess = result[symbol]
        assert guess.frame == ("body" if symbols[0] == "u" else "earth") and not guess.is_open
        assert guess.unit == ("m/s" if size == 1.0 else "kn")


@pytest.mark.parametrize(("sign", "positive"), [(1.0, ""), (-1.0, "port")])
def test_the_sign_of_a_rudder_follows_from_the_turn(sign: float, positive: str, tmp_path: Path) -> None:
    result = guesses(write(tmp_path / "run.csv", BASE | {"rudder [deg]": sign * TRUTH["delta"] / DEGREE}))
    assert (result["delta"].unit, result["delta"].positive, result["delta"].is_open) == ("deg", positive, False)


def test_what_the_numbers_do_not_show_stays_open_with_both_readings(tmp_path: Path) -> None:
    columns = {"time": TRUTH["t"], "heading": 0.01 * TRUTH["psi"], "depth": TRUTH["u"], "n": TRUTH["u"]}
    draft = draft_trial(write(tmp_path / "run.csv", columns), folder=tmp_path)
    assert {guess.symbol for guess in draft.open_questions} == {"psi", "n"}
    assert '# channels.psi = { column = "heading", unit = "rad" }' in draft.text and 'or unit = "deg"' in draft.text
    assert "# not used, names not recognised: depth" in draft.text


def test_a_unit_behind_a_stroke_is_that_of_a_stated_column(tmp_path: Path) -> None:
    columns = {"time/s": TRUTH["t"], "LVDT/mm": 1e3 * TRUTH["u"], "a/(m/s)": TRUTH["u"], "b": TRUTH["u"]}
    path = write(tmp_path / "run.csv", columns)
    draft = draft_trial(path, folder=tmp_path, columns=("LVDT/mm=z", "a/(m/s)=u"))
    assert '{ column = "LVDT/mm", unit = "mm"' in draft.text and '{ column = "a/(m/s)", unit = "m/s"' in draft.text


def test_what_is_stated_of_a_craft_stands_in_a_draft_without_a_model(tmp_path: Path) -> None:
    path = write(tmp_path / "run.csv", {"time": TRUTH["t"], "heading [deg]": TRUTH["psi"] / DEGREE})
    assert "[ship]" not in draft_trial(path, folder=tmp_path).text
    text = draft_trial(path, folder=tmp_path, length=9.5, name="launch").text
    assert 'name = "launch"\nL = 9.5' in text and "[model]" not in text
    (tmp_path / "trial.toml").write_text(text, encoding="utf-8")
    assert not [finding for finding in check(tmp_path / "trial.toml") if finding.severity is Severity.ERROR]


def test_the_drafted_file_is_read_and_checked_without_model_and_ship(tmp_path: Path) -> None:
    columns = BASE | {"rot_deg_s": TRUTH["r"] / DEGREE, "odd 'name'\\": TRUTH["u"], "rudder": TRUTH["delta"] / DEGREE}
    write(tmp_path / "a.csv", columns)
    write(tmp_path / "b.csv", columns)
    draft = draft_trial(tmp_path / "a.csv", tmp_path / "b.csv", folder=tmp_path)
    (tmp_path / "trial.toml").write_text(draft.text, encoding="utf-8")
    runs = load_runs(tmp_path / "trial.toml")
    assert [run.name for run in runs] == ["a", "b"]
    np.testing.assert_allclose(runs[0].raw_record()["delta"], TRUTH["delta"], atol=1e-6)
    findings = check(tmp_path / "trial.toml")
    assert findings[-1].code == "model" and "key 'ship.L' is missing" in findings[-1].advice
    assert not [one for one in findings if one.severity.value == "error"]


def test_manoeuvres_are_found_and_become_runs(tmp_path: Path) -> None:
    draft = draft_trial(write(tmp_path / "run.csv", BASE), folder=tmp_path)
    zigzag, straight, circle = draft.stretches[0]
    assert (zigzag.name, straight.name, circle.name) == ("zigzag1", "straight1", "circle_starboard_1")
    assert zigzag.start < 20.0 and 150.0 < zigzag.stop < 210.0
    assert 230.0 < circle.start < 255.0 and circle.stop > 450.0  # from the approach on; the rudder is put over at 260 s
    assert '\n    { name = "zigzag1", from = "' in draft.text
    assert find_stretches([], None) == ()


def test_sources_of_several_kinds_make_one_run(tmp_path: Path) -> None:
    write(tmp_path / "gnss.csv", {key: BASE[key] for key in ("time", "north", "east")})
    write(tmp_path / "compass.csv", {key: BASE[key] for key in ("time", "heading")})
    draft = draft_trial(tmp_path, folder=tmp_path)
    (tmp_path / "trial.toml").write_text(draft.text, encoding="utf-8")
    runs = load_runs(tmp_path / "trial.toml")
    assert [run.name for run in runs] == ["zigzag1", "circle_starboard_1"]
    assert set(runs[0].raw_record().channels) == {"x0", "y0", "psi"}


def test_messages_of_loggers_are_known(tmp_path: Path) -> None:
    SAMPLES["run.bin"].write(tmp_path / "run.bin")
    SAMPLES["run.nmea"].write(tmp_path / "run.nmea")
    by_source = {guess.source: guess for guess in guess_columns(survey_log(tmp_path / "run.bin"))}
    assert (by_source["XKF1/VN"].symbol, by_source["XKF1/VN"].frame) == ("u", "earth")
    assert {guess.symbol for guess in guess_columns(survey_log(tmp_path / "run.nmea"))} >= {"psi", "sog", "cog"}
    assert guess_by_name("vehicle_rates_setpoint", "roll", "", "ulog") is None
    assert guess_by_name("speed_reference", "yaw", "", "rosbag") is None


def test_header_separator_and_encoding_are_recognised(tmp_path: Path) -> None:
    text = "Fähre, Versuch 3\n14.05.2026\nZeit;Kurs;Tiefe\n0,0;12,5;3\n0,2;12,6;3\n0,4;12,7;3\n"
    (tmp_path / "run.csv").write_bytes(text.encode("cp1252"))
    layout = text_layout(tmp_path / "run.csv")
    assert (layout.header_lines, layout.encoding) == (3, "cp1252")
    survey = survey_log(tmp_path / "run.csv")
    (topic,) = survey.topics
    assert [column.name for column in topic.columns] == ["Kurs", "Tiefe"] and topic.rate == pytest.approx(5.0)
    (table,) = survey.log.tables
    assert time_column(table, layout)[1] == "named 'Zeit', unit by its step"
    values = column_values(table, 1)
    assert values is not None and values.tolist() == [12.5, 12.6, 12.7]
    (tmp_path / "run.csv").write_text("no numbers\nat all\n", encoding="utf-8")
    with pytest.raises(InputError, match="has no rows of numbers"):
        text_layout(tmp_path / "run.csv")


def test_no_logs_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no log to draft a trial of"):
        draft_trial(tmp_path)


@pytest.mark.skipif(sys.platform != "linux", reason="names of files are text, not bytes")
def test_a_name_that_no_trial_file_can_hold_is_refused(tmp_path: Path) -> None:
    path = tmp_path / os.fsdecode(b"run_\xff.csv")
    path.write_text("t,u\n0,1\n1,1\n2,1\n")
    with pytest.raises(InputError, match=r"run_\\udcff.csv' is no name in UTF-8"):
        draft_trial(path)


def test_folders_of_topics_name_their_thrusters_and_axes_that_are_open_leave_sides_open(tmp_path: Path) -> None:
    half = 0.5 * (np.pi / 2.0 - TRUTH["psi"])
    for k in (1, 2):
        folder = tmp_path / f"actuators/actuator_{k}"
        folder.mkdir(parents=True)
        write(folder / "azimuth_angle.csv", {"time": TRUTH["t"], "data": 100.0 * k + TRUTH["psi"]})
    pose = {
        "pose_position_x": TRUTH["y0"],
        "pose_position_y": TRUTH["x0"],
        "pose_orientation_x": 0.0 * half,
        "pose_orientation_y": 0.0 * half,
        "pose_orientation_z": np.sin(half),
        "pose_orientation_w": np.cos(half),
    }
    twist = {"twist_linear_x": TRUTH["u"], "twist_angular_z": -TRUTH["r"]}
    write(tmp_path / "pose.csv", {"time": TRUTH["t"]} | pose)
    write(tmp_path / "twist_body.csv", {"time": TRUTH["t"]} | twist)
    used = {g.symbol: g for part in draft_trial(tmp_path).guesses for g in part if g.is_used}
    assert (used["alpha_1"].unit, used["alpha_2"].unit) == ("deg", "deg") and not used["alpha_2"].is_open
    assert used["x0"].is_open and used["q_w"].is_open and used["r"].is_open and not used["u"].is_open


def test_columns_without_names_are_recognised_by_what_they_do(tmp_path: Path) -> None:
    columns = [TRUTH["t"], TRUTH["x0"], TRUTH["y0"], TRUTH["psi"] / DEGREE, TRUTH["north"], TRUTH["east"]]
    columns += [TRUTH["r"] / DEGREE, np.full(TRUTH["t"].size, 10.2), -TRUTH["delta"] / DEGREE]
    rows = [" ".join(f"{value:.9g}" for value in row) for row in np.column_stack(columns).tolist()]
    (tmp_path / "run.dat").write_text("\n".join(["towing tank", "zigzag", *rows]), encoding="utf-8")
    result = guesses(tmp_path / "run.dat")
    expected = {"x0": (2, "m"), "y0": (3, "m"), "psi": (4, "deg"), "u": (5, "m/s"), "v": (6, "m/s"),
                "r": (7, "deg/s"), "delta": (9, "deg")}  # fmt: skip
    assert {symbol: (guess.source, guess.unit) for symbol, guess in result.items()} == expected
    assert (result["u"].frame, result["delta"].positive) == ("earth", "port")
    assert not any(guess.is_open for guess in result.values())
    assert recognised_columns({}, STEP) == []


def test_columns_whose_names_say_nothing_are_known_by_the_heading(tmp_path: Path) -> None:
    """The derivative of the heading is its rate; what the yaw acceleration follows stays open; noise is neither."""
    noise = np.random.default_rng(3).standard_normal(TRUTH["t"].size)
    columns = {"time": TRUTH["t"], "heading_deg": TRUTH["psi"] / DEGREE, "q7": noise}
    write(tmp_path / "a.csv", {**columns, "q1": TRUTH["r"] / DEGREE, "q2": -TRUTH["delta"] / DEGREE})
    draft = draft_trial(tmp_path / "a.csv")
    used = {g.symbol: g for part in draft.guesses for g in part if g.is_used}
    assert (used["r"].source, used["r"].unit, used["r"].is_open) == ("q1", "deg/s", False)
    assert (used["delta"].source, used["delta"].positive, used["delta"].is_open) == ("q2", "port", True)
    assert draft.unrecognised == ("q7",)
    write(tmp_path / "b.csv", {**columns, "q2": noise, "rudder_deg": -TRUTH["delta"] / DEGREE})
    named = {g.symbol: g.source for part in draft_trial(tmp_path / "b.csv").guesses for g in part if g.is_used}
    assert named == {"psi": "heading_deg", "delta": "rudder_deg"}


def test_a_clock_in_local_time_is_moved_to_that_of_the_other_sources(tmp_path: Path) -> None:
    write(tmp_path / "gnss.csv", {key: BASE[key] for key in ("time", "north", "east")})
    write(tmp_path / "gyro.csv", {"time": TRUTH["t"], "rot_deg_s": TRUTH["r"] / DEGREE})
    write(tmp_path / "compass.csv", {"time": TRUTH["t"] + 7200.0, "heading": BASE["heading"]})
    draft = draft_trial(tmp_path, folder=tmp_path)
    assert "clock_offset = -7200    # its clock runs 7200 s ahead" in draft.text
    (tmp_path / "trial.toml").write_text(draft.text, encoding="utf-8")
    record = load_runs(tmp_path / "trial.toml")[0].raw_record()
    np.testing.assert_allclose(np.unwrap(record["psi"]), TRUTH["psi"][: len(record)], atol=1e-6)
    surveys = [survey_log(tmp_path / "gnss.csv"), survey_log(tmp_path / "gyro.csv")]
    assert zone_offsets(surveys) == [0.0, 0.0]


def test_a_draft_of_which_all_is_open_says_what_to_choose(tmp_path: Path) -> None:
    columns = {"time": TRUTH["t"], "heading": 0.01 * TRUTH["psi"], "n": TRUTH["u"]}
    draft = draft_trial(write(tmp_path / "run.csv", columns), folder=tmp_path)
    (tmp_path / "trial.toml").write_text(draft.text, encoding="utf-8")
    with pytest.raises(InputError, match=r"no channel is declared, all 2 readings are open \(psi, n\); choose: below"):
        check(tmp_path / "trial.toml")


@pytest.mark.parametrize("name", ["Time UTC", "time_utc", "UTC time", "Timestamp UTC", "Date/Time", "stamp of row"])
def test_dates_with_times_are_the_time_whatever_the_column_is_called(name: str, tmp_path: Path) -> None:
    cells = [f"2024-05-01T10:{k // 60:02d}:{k % 60:02d}Z,{0.1 * k},2024-05-01" for k in range(90)]
    (tmp_path / "nav.csv").write_text("\n".join([f"{name},sog,day", *cells]), encoding="utf-8")
    (topic,) = survey_log(tmp_path / "nav.csv").topics
    assert topic.time is not None and (topic.time.source, topic.time.unit) == (name, "utc")
    assert topic.rate == pytest.approx(1.0)


def test_a_stated_antenna_is_written_where_a_receiver_shows_the_track(tmp_path: Path) -> None:
    draft = draft_trial(write(tmp_path / "run.csv", BASE), length=12.0, antenna=-2.5)
    assert "\nantenna = { x = -2.5, y = 0.0 }    # m forward of midship, as stated" in draft.text
    no_track = write(tmp_path / "turn.csv", {name: BASE[name] for name in ("time", "heading")})
    assert "\nantenna" not in draft_trial(no_track, length=12.0, antenna=-2.5).text
    pose = write(tmp_path / "pose.csv", BASE | {"surge": TRUTH["u"], "sway": TRUTH["v"]})
    text = draft_trial(pose, length=12.0, antenna=-2.5).text
    assert "\nantenna" not in text and "the stated antenna is not used" in text
    fixes = {name: BASE[name] for name in ("time", "heading")}
    fixes |= {"lat": 43.0 + TRUTH["x0"] / 111e3, "lon": 5.0 + TRUTH["y0"] / 81e3}
    gnss = write(tmp_path / "gnss.csv", fixes)
    assert (
        draft_trial(gnss, length=12.0).lacks_antenna and not draft_trial(gnss, length=12.0, antenna=0.0).lacks_antenna
    )


@pytest.mark.parametrize("place", [0.0, 0.8])
def test_velocities_that_change_the_positions_are_the_antennas(place: float, tmp_path: Path) -> None:
    """Positions of an antenna 0.8 m ahead of midship, and velocities of it or, by an estimator, of midship."""
    craft = two_thrusters()
    c, s = np.cos(craft["psi"]), np.sin(craft["psi"])
    speeds = {"vn": craft["u"] * c - place * craft["r"] * s, "ve": craft["u"] * s + place * craft["r"] * c}
    north, east = craft["x0"] + 0.8 * c, craft["y0"] + 0.8 * s
    fixes = {
        "time": craft["t"],
        "yaw": np.degrees(craft["psi"]),
        "lat": 43.0 + north / 111.1e3,
        "lon": 5.0 + east / 81.5e3,
    }
    log = write(tmp_path / "log.csv", fixes | speeds | {"left": craft["left"], "right": craft["right"]})
    used = {g.symbol: g for part in draft_trial(log, length=2.0, antenna=0.8).guesses for g in part if g.is_used}
    assert [used[symbol].reference_point for symbol in ("u", "v")] == [place, place]
    text = draft_trial(log, length=2.0, antenna=0.8).text
    assert ("reference_point = 0.8" in text) == bool(place)


@pytest.mark.parametrize(
    ("first", "start", "is_settled"), [("left", 1.79e9, True), ("left", 0.0, True), ("right", 0.0, False)]
)
def test_axes_that_a_log_leaves_open_follow_from_the_names_of_its_thrusters(
    first: str, start: float, is_settled: bool, tmp_path: Path
) -> None:
    """Tables of a ROS recording: mirrored axes would put each thruster on the side its topic does not say."""
    craft, second = two_thrusters(), {"left": "right", "right": "left"}[first]
    half = 0.5 * (np.pi / 2.0 - craft["psi"])
    pose = {"pose.pose.position.x": craft["y0"], "pose.pose.position.y": craft["x0"]}
    turned = {"x": 0.0 * half, "y": 0.0 * half, "z": np.sin(half), "w": np.cos(half)}
    pose |= {f"pose.pose.orientation.{name}": values for name, values in turned.items()}
    twist = {
        "twist.twist.linear.x": craft["u"],
        "twist.twist.linear.y": 0.0 * half,
        "twist.twist.angular.z": -craft["r"],
    }
    write(tmp_path / "odometry.csv", {"time": start + craft["t"]} | pose | twist)
    for side, command in ((first, craft["left"]), (second, craft["right"])):
        write(tmp_path / f"thrusters_{side}_cmd.csv", {"time": start + craft["t"], "data": command})
    used = {g.symbol: g for part in draft_trial(tmp_path).guesses for g in part if g.is_used}
    assert {"command_1", "command_2"} <= set(used)
    assert not used["command_1"].is_open and not used["command_2"].is_open
    assert [used[symbol].is_open for symbol in ("x0", "q_w", "r")] == [not is_settled] * 3
    assert '[sensors]\nvelocity = "ground"    # as the positions change' in draft_trial(tmp_path, length=2.0).text


def test_sheets_of_a_workbook_with_the_same_columns_are_runs(tmp_path: Path) -> None:
    """A sheet of particulars is none; what one run shows of a column holds for all, each with its sheet's columns."""
    book = openpyxl.Workbook()
    particulars = book.active
    assert particulars is not None
    for row in (("Vessel", "cutter"), ("Lpp [m]", 12.0), ("Breadth [m]", 4.0)):
        particulars.append(row)
    rudder = TRUTH["delta"] / DEGREE
    columns = BASE | {"nozzle": rudder, "nozzle of the other jet": rudder + 0.5}
    groups = ["Navigation", *[""] * (len(BASE) - 1), "Port", "Starboard"]
    names = [*BASE, "nozzle [deg]", "nozzle [deg]"]
    for title, part in (("zigzag", slice(0, 900)), ("circle", slice(1300, 2400))):
        sheet = book.create_sheet(title)
        for row in (["trial of the cutter"], groups, names, *np.column_stack(list(columns.values()))[part].tolist()):
            sheet.append(row)
    book.save(tmp_path / "trials.xlsx")
    draft = draft_trial(tmp_path / "trials.xlsx", length=12.0)
    assert [run.name for run in draft.runs] == ["zigzag", "circle"]
    for name in ("zigzag", "circle"):
        pair = f'column = "{name}/Port nozzle [deg]", twin = "{name}/Starboard nozzle [deg]"'
        assert f"\nchannels.delta = {{ {pair}" in draft.text
    trial = tmp_path / "trial.toml"
    trial.write_text(draft.text, encoding="utf-8")
    assert [len(run.raw_record()) for run in load_runs(trial)] == [900, 1100]


def test_ranges_are_those_of_all_files(tmp_path: Path) -> None:
    swing = np.sin(TRUTH["t"])
    for name, degrees in (("a", 15.0), ("b", 35.0)):
        write(tmp_path / f"{name}.csv", {**BASE, "rudder": degrees * swing})
    guess = next(g for part in draft_trial(tmp_path).guesses for g in part if g.symbol == "delta")
    assert "from -35 to 35: degrees" in guess.evidence


def test_places_say_more_digits_where_both_ends_read_alike_and_show_a_course_without_a_speed(tmp_path: Path) -> None:
    place = {"latitude": 47.6 + TRUTH["x0"] / 111200.0 / 100.0, "longitude": 9.3 + TRUTH["y0"] / 75000.0 / 100.0}
    columns = {"time": TRUTH["t"], **place, "course_deg": BASE["heading"], "heading": BASE["heading"]}
    draft = draft_trial(write(tmp_path / "run.csv", columns))
    found = {guess.symbol: guess for part in draft.guesses for guess in part}
    ends = re.findall(r"from ([\d.]+) to ([\d.]+)", " ".join(found["lat"].evidence))
    assert len(ends) == 1 and ends[0][0] != ends[0][1]
    assert found["cog"].unused_because == "the positions show the course over ground"


def test_the_rate_of_an_engine_is_the_propellers_where_its_gear_is_stated(tmp_path: Path) -> None:
    write(tmp_path / "run.csv", {**BASE, "Engine rpm": 1500.0 + 0.0 * TRUTH["t"]})
    stated = draft_trial(tmp_path, length=30.0, gear=3.0)
    (guess,) = (g for part in stated.guesses for g in part if g.symbol == "n")
    assert guess.is_used and guess.scale == 1.0 / 3.0 and guess.unit == "rpm"
    assert not any(g.is_used for part in draft_trial(tmp_path).guesses for g in part if g.symbol == "n")


@pytest.mark.parametrize(("heading", "scale"), [("Shaft rpm", 1.0), ("Propellerturtall", 1.0), ("rpm", 1.0 / 3.0)])
def test_the_rate_of_a_shaft_is_the_propellers_whatever_gear_is_stated(
    heading: str, scale: float, tmp_path: Path
) -> None:
    write(tmp_path / "run.csv", {**BASE, heading: 500.0 + 0.0 * TRUTH["t"]})
    (guess,) = (g for part in draft_trial(tmp_path, length=30.0, gear=3.0).guesses for g in part if g.symbol == "n")
    assert guess.is_used and guess.scale == scale
