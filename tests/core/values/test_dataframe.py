"""Records from data frames: units, frames, signs and time stamps as declared, and what does not fit is refused."""

import numpy as np
import pandas as pd
import pytest

from seatrial.core.values import InputError, Record

TIME = np.arange(0.0, 5.0, 0.5)


@pytest.fixture
def logged() -> pd.DataFrame:
    """A log as a data logger writes it: degrees, knots, a port-positive rudder, time in ms."""
    return pd.DataFrame({"t_ms": 1e3 * TIME, "speed": np.full(10, 10.0), "rudder": np.linspace(-35.0, 35.0, 10)})


def test_declared_units_signs_and_places_arrive(logged: pd.DataFrame) -> None:
    record = Record.from_dataframe(
        logged,
        "run 1",
        time="t_ms",
        columns={"u": "speed", "delta": "rudder"},
        units={"time": "ms", "u": "kn", "delta": "deg"},
        positive={"delta": "port"},
        reference_points={"u": 1.5},
    )
    assert record.name == "run 1"
    np.testing.assert_allclose(record.time, TIME)
    np.testing.assert_allclose(record["u"], 10.0 * 1852.0 / 3600.0)
    np.testing.assert_allclose(record["delta"], np.radians(logged["rudder"]))
    assert (record.channel("delta").positive, record.channel("delta").label) == ("port", "rudder")
    assert record.channel("u").reference_point == 1.5


def test_an_earth_fixed_velocity_counts_to_the_north() -> None:
    frame = pd.DataFrame({"u": np.ones(10)}, index=TIME)
    channel = Record.from_dataframe(frame, frames={"u": "earth"}).channel("u")
    assert (channel.frame, channel.positive) == ("earth", "north")


@pytest.mark.parametrize(
    "stamps",
    [pd.Timestamp("2025-03-01 12:00") + pd.to_timedelta(TIME, unit="s"), pd.to_timedelta(TIME + 7.0, unit="s")],
    ids=["dates", "durations"],
)
def test_dates_and_durations_count_from_the_first(stamps: pd.Index) -> None:
    record = Record.from_dataframe(pd.DataFrame({"r": np.zeros(10)}, index=stamps))
    np.testing.assert_allclose(record.time, TIME)


def test_a_declaration_overrides_the_metadata_of_the_frame() -> None:
    before = Record.from_arrays("run", TIME, {"delta": 0.1 * TIME})
    after = Record.from_dataframe(before.to_dataframe(), positive={"delta": "port"})
    assert (after.name, after.channel("delta").positive) == ("run", "port")
    np.testing.assert_array_equal(after["delta"], before["delta"])


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"time": "t"}, r"no column 't'"),
        ({"columns": {"u": "spede"}}, r"no column 'spede'; did you mean 'speed'"),
        ({}, r"unknown channel 't_ms'"),
        ({"columns": {"u": "speed"}, "units": {"v": "kn"}}, r"units names the channel 'v'"),
        ({"columns": {"u": "speed"}, "units": {"u": "deg"}}, r"'u' is measured in m/s; unit 'deg' does not fit"),
        ({"columns": {"u": "speed"}, "units": {"u": "knots"}}, r"unknown unit 'knots'"),
        ({"columns": {"u": "speed"}, "frames": {"u": "ship"}}, r"must be body, earth or none, not 'ship'"),
        ({"columns": {"u": "speed"}, "positive": {"u": "port"}}, r"'u' is forward or aft, not 'port'"),
    ],
)
def test_what_does_not_fit_is_refused(logged: pd.DataFrame, arguments: dict, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        Record.from_dataframe(logged, **arguments)


def test_text_is_refused(logged: pd.DataFrame) -> None:
    with pytest.raises(InputError, match="column 'speed' of the data frame holds text"):
        Record.from_dataframe(logged.assign(speed="fast"), columns={"u": "speed"})
    with pytest.raises(InputError, match="neither numbers nor dates"):
        Record.from_dataframe(logged.assign(t_ms="noon"), time="t_ms", columns={"u": "speed"})
