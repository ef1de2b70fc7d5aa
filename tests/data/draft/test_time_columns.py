"""The column of time stamps in every form that loggers write: one clock of two minutes at 10 Hz, past midnight."""

from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from seatrial.data.draft.naming import guess_by_name
from seatrial.data.draft.survey import survey_log

START = datetime(2026, 5, 14, 23, 59, 0, tzinfo=UTC)
MOMENTS = [START + timedelta(seconds=0.1 * k) for k in range(1200)]
SINCE_1970 = [round(moment.timestamp() * 10.0) for moment in MOMENTS]  # tenths of a second

FORMS = {
    "time": [moment.strftime("%Y-%m-%dT%H:%M:%S.%f")[:-3] + "Z" for moment in MOMENTS],
    "utc": [moment.strftime("%Y/%m/%d %H:%M:%S.%f") for moment in MOMENTS],
    "epoch": [f"{tenths / 10:.1f}" for tenths in SINCE_1970],
    "timestamp": [f"{tenths}00000000" for tenths in SINCE_1970],
    "timestamp_ms": [f"{tenths}00" for tenths in SINCE_1970],
    "unix [us]": [f"{tenths}00000" for tenths in SINCE_1970],
    "date,time": [moment.strftime("%Y-%m-%d,%H:%M:%S.%f") for moment in MOMENTS],
    "secs,nsecs": [f"{tenths // 10},{tenths % 10}00000000" for tenths in SINCE_1970],
    "stamp.sec,stamp.nanosec": [f"{tenths // 10},{tenths % 10}00000000" for tenths in SINCE_1970],
    "gps_week,tow": [f"2418,{345540.0 + 0.1 * k:.1f}" for k in range(1200)],
    "time ": [f"{46156.9993 + 0.1 * k / 86400.0:.9f}" for k in range(1200)],  # Excel
    "utc_hhmmss": [moment.strftime("%H%M%S.%f") for moment in MOMENTS],
    "time_s": [f"{0.1 * k:.1f}" for k in range(1200)],
}


@pytest.mark.parametrize("header", FORMS)
def test_each_form_of_a_clock_is_recognised_with_its_unit(header: str, tmp_path: Path) -> None:
    rows = "\n".join(f"{stamp},{np.sin(0.1 * k):.6f}" for k, stamp in enumerate(FORMS[header]))
    (tmp_path / "run.csv").write_text(f"{header},surge\n{rows}\n", encoding="utf-8")
    (topic,) = survey_log(tmp_path / "run.csv").topics
    assert (topic.rate, topic.duration) == (pytest.approx(10.0, rel=1e-3), pytest.approx(119.9, abs=1e-3))
    assert [column.name for column in topic.columns] == ["surge"]


def test_a_unit_in_the_line_of_units_is_that_of_the_time(tmp_path: Path) -> None:
    rows = "\n".join(f"{100 * k},{np.sin(0.1 * k):.6f}" for k in range(400))
    (tmp_path / "run.csv").write_text(f"t,surge\nms,m/s\n{rows}\n", encoding="utf-8")
    (topic,) = survey_log(tmp_path / "run.csv").topics
    assert (topic.rate, topic.time_note) == (pytest.approx(10.0, rel=1e-3), "named 't', with its unit")


@pytest.mark.parametrize(("step", "unit"), [(10.0, "s"), (0.02, "s")])
def test_seconds_from_the_start_are_no_clock_of_digits_and_no_days(step: float, unit: str, tmp_path: Path) -> None:
    rows = "\n".join(f"{20000.0 + step * k:.2f},{k % 7}" for k in range(900))
    (tmp_path / "run.csv").write_text(f"time_s,surge\n{rows}\n", encoding="utf-8")
    (topic,) = survey_log(tmp_path / "run.csv").topics
    assert topic.time is not None and topic.time.unit == unit and topic.rate == pytest.approx(1.0 / step, rel=1e-3)


@pytest.mark.parametrize(
    ("name", "symbol", "unit"),
    [("yaw_rate_deg_s", "r", "deg/s"), ("rot_deg_min", "r", "deg/min"), ("u_m_s", "u", "m/s"), ("v_ms", "v", "m/s"),
     ("x_north_m", "x0", "m"), ("y_east_m", "y0", "m"), ("gyro_z_rad_s", "r", "rad/s"), ("sog_kn", "sog", "kn"),
     ("imu/gyro_z_rad_s", "r", "rad/s"), ("cmd/port_percent", "command_1", "percent"),
     ("cmd/stbd_percent", "command_2", "percent")],
)  # fmt: skip
def test_units_behind_a_name_are_part_of_it(name: str, symbol: str, unit: str) -> None:
    guess = guess_by_name("", name, "")
    assert guess is not None and (guess.symbol, guess.unit) == (symbol, unit)


@pytest.mark.parametrize(("cell", "is_read"), [("08/10/2026", False), ("8.10.2026", True), ("2026-10-08", True)])
@pytest.mark.parametrize(("date", "time"), [("Fecha", "Hora"), ("Dato", "Klokke"), ("Data", "Ora")])
def test_a_date_that_is_not_read_is_named(date: str, time: str, cell: str, is_read: bool, tmp_path: Path) -> None:
    rows = "\n".join(f"{cell};09:12:{k:02d};{k}" for k in range(40))
    (tmp_path / "run.csv").write_text(f"{date};{time};surge\n{rows}\n", encoding="utf-8")
    (topic,) = survey_log(tmp_path / "run.csv").topics
    assert topic.time is not None and topic.time.source == time and topic.text_columns == ()
    assert getattr(topic.time, "date", "") == (date if is_read else "")
    assert topic.faults == (() if is_read else (f"'{date}': '{cell}' is no date that is read; as 2026-10-08 or "
                                                "8.10.2026 it would be",))  # fmt: skip
