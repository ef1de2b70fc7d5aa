"""Time stamps in every form a logger writes give the same seconds."""

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial.data.read.clock import stamps
from seatrial.data.read.layout import ColumnSpec, TimeSpec
from seatrial.data.read.log import RawTable

START = 1_778_750_400.0  # 2026-05-14T09:20:00Z
STEPS = [0.0, 0.1, 0.25, 61.5]


def read(time: ColumnSpec, **columns: list) -> np.ndarray:
    return stamps(RawTable("run.csv", tuple(columns), tuple(columns.values())), time).seconds


def spec(unit: str = "s", **more: str) -> TimeSpec:
    return TimeSpec("time", "t", unit, **more)


@pytest.mark.parametrize(
    "texts",
    [
        ["2026-05-14T09:20:00.000Z", "2026-05-14T09:20:00.100Z", "2026-05-14T09:20:00.250Z",
         "2026-05-14T09:21:01.500Z"],
        ["2026-05-14 09:20:00", "2026-05-14 09:20:00.1", "2026-05-14 09:20:00.25", "2026-05-14 09:21:01.5"],
        ["2026/05/14 09:20:00.000", "2026/05/14 09:20:00.100", "2026/05/14 09:20:00.250", "2026/05/14 09:21:01.500"],
        ["2026-05-14T11:20:00.0+02:00", "2026-05-14T11:20:00.1+02:00", "2026-05-14T11:20:00.25+02:00",
         "2026-05-14T11:21:01.5+02:00"],
    ],
)  # fmt: skip
@pytest.mark.parametrize("unit", ["s", "utc"])
def test_dates_and_times(texts: list[str], unit: str) -> None:
    np.testing.assert_allclose(read(spec(unit), t=texts) - START, STEPS, atol=1e-6)


@pytest.mark.parametrize(("unit", "size"), [("s", 1.0), ("ms", 1e3), ("us", 1e6), ("ns", 1e9)])
def test_numbers_since_1970(unit: str, size: float) -> None:
    np.testing.assert_allclose(read(spec(unit), t=[(START + step) * size for step in STEPS]) - START, STEPS, atol=1e-6)


def test_two_columns() -> None:
    clock = ["09:20:00.000", "09:20:00.100", "09:20:00.250", "09:21:01.500"]
    np.testing.assert_allclose(read(spec(date="day"), t=clock, day=["2026-05-14"] * 4) - START, STEPS, atol=1e-6)
    nanoseconds, seconds = [0, 100_000_000, 250_000_000, 500_000_000], [START, START, START, START + 61.0]
    np.testing.assert_allclose(read(spec(nanoseconds="n"), t=seconds, n=nanoseconds) - START, STEPS, atol=1e-6)
    # 2026-05-14 is a Thursday of GNSS week 2418, without leap seconds
    week = [2418.0] * 4
    of_week = [4.0 * 86400.0 + 9 * 3600.0 + 20 * 60.0 + step for step in STEPS]
    np.testing.assert_allclose(read(spec(week="w"), t=of_week, w=week) - START, STEPS, atol=1e-6)


def test_excel_days_and_hhmmss_past_midnight() -> None:
    days = [START / 86400.0 + 25569.0 + step / 86400.0 for step in STEPS]
    np.testing.assert_allclose(read(spec("excel"), t=days) - START, STEPS, atol=1e-4)
    np.testing.assert_allclose(read(spec("hhmmss"), t=[235959.5, 0.0, 100.25]), [86399.5, 86400.0, 86460.25])
    np.testing.assert_allclose(read(spec(), t=["23:59:59.5", "00:00:00", "00:01:00.25"]), [86399.5, 86400.0, 86460.25])


def test_fractions_that_were_not_padded_are_numbers_of_nanoseconds() -> None:
    texts = ["2025/04/11 12:08:16.27081965", "2025/04/11 12:08:16.134415684", "2025/04/11 12:08:16.250000000"]
    table = RawTable("run.csv", ("t",), (texts,))
    read = stamps(table, spec())
    np.testing.assert_allclose(np.diff(read.seconds), [0.107333719, 0.115584316], atol=1e-6)
    assert "fractions of 1 time stamps" in read.note


def test_fractions_of_varying_length_that_run_forward_stay_decimal() -> None:
    texts = ["2025-04-11T12:08:16.1", "2025-04-11T12:08:16.15", "2025-04-11T12:08:16.2"]
    np.testing.assert_allclose(np.diff(read(spec(), t=texts)), 0.05, atol=1e-6)


def test_stamps_of_one_length_and_of_several_give_the_same_bits() -> None:
    nanoseconds = [1_234_567, 270_819_650, 270_819_651, 999_999_999]
    alike = [f"2026/05/14 09:20:00.{part:09d}UTC" for part in nanoseconds]
    mixed = [*alike[:-1], "2026-05-14T09:20:00.99999999900"]
    np.testing.assert_array_equal(read(spec(), t=alike), read(spec(), t=mixed))
    np.testing.assert_array_equal(read(spec(), t=[alike[0], "", alike[1]])[[0, 2]], read(spec(), t=alike)[:2])
    assert np.isnan(read(spec(), t=[alike[0], "", alike[1]])[1])
    np.testing.assert_array_equal(read(spec(), t=["1969-12-31T23:59:59.25Z"] * 2), [-0.75, -0.75])


def test_the_offset_of_a_clock_is_added() -> None:
    np.testing.assert_allclose(read(TimeSpec("time", "t", "s", clock_offset=-0.5), t=[1.0, 2.0]), [0.5, 1.5])


@pytest.mark.parametrize(
    ("texts", "sentence"),
    [
        (["2026-05-14T09:20:00", "soon"], "row 2, column 't': 'soon' is no date and time"),
        (["2026-05-14T09:20:00", "2026-13-14T09:20:00"], "is no date and time"),
        (["today", "soon"], "'today' is not a number"),
    ],
)
def test_what_is_no_time_is_refused(texts: list[str], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        read(spec(), t=texts)
    with pytest.raises(InputError, match="is no date and time; give the unit of the number"):
        read(spec("utc"), t=["1.0", "2.0"])
