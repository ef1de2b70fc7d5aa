"""How channels run between samples: judged by their travel, declared, and kept through resampling."""

import numpy as np
import pandas as pd
import pytest

from seatrial.core.values import InputError, Record
from seatrial.core.values.arrays import held_rows, travel

TIME = 0.5 * np.arange(200)


def orders() -> np.ndarray:
    return 0.2 * np.sign(np.sin(2.0 * np.pi * (TIME + 0.1) / 20.0))


def slewing() -> np.ndarray:
    return np.clip(0.5 * np.sin(2.0 * np.pi * TIME / 20.0), -0.2, 0.2)


def test_orders_travel_in_steps_and_a_slewing_rudder_does_not(rng: np.random.Generator) -> None:
    noise = 0.003 * rng.normal(size=len(TIME))
    assert travel(orders()).is_stepped and travel(orders() + noise).is_stepped
    assert not travel(slewing()).is_stepped and not travel(slewing() + noise).is_stepped


def test_what_stands_still_is_not_stepped() -> None:
    assert not travel(np.full(20, 0.1)).is_stepped
    assert not travel(np.array([0.1])).is_stepped


def test_a_held_channel_keeps_its_area_at_a_lower_rate() -> None:
    values = orders()
    assert held_rows(values, 4).sum() * 4 == pytest.approx(values.sum())
    record = Record.from_arrays("run", TIME, {"delta": values, "psi": values})
    held = record.with_channel("delta", record.channel("delta").with_values(values))
    held = Record.from_dataframe(held.to_dataframe(), kind={"delta": "command"}).resampled(0.5)
    np.testing.assert_allclose(held["delta"], held_rows(values, 4))
    np.testing.assert_array_equal(held["psi"], values[::4])
    assert held.channel("delta").sample_s == pytest.approx(0.5)


def test_a_held_channel_takes_the_value_that_holds_at_another_rate() -> None:
    frame = Record.from_arrays("run", TIME, {"delta": orders()}).to_dataframe()
    made = Record.from_dataframe(frame, between={"delta": "held"}).resampled(3.0)
    assert set(np.unique(made["delta"])) == set(np.unique(orders()))


def test_a_data_frame_says_who_set_a_channel_and_how_it_runs() -> None:
    frame = Record.from_arrays("run", TIME, {"delta": orders()}).to_dataframe()
    command = Record.from_dataframe(frame, kind={"delta": "command"}).channel("delta")
    assert command.is_command and command.is_held
    straight = Record.from_dataframe(frame, kind={"delta": "command"}, between={"delta": "straight"})
    assert not straight.channel("delta").is_held
    again = Record.from_dataframe(straight.to_dataframe()).channel("delta")
    assert (again.kind, again.between) == ("command", "straight")
    with pytest.raises(InputError, match="held or straight"):
        Record.from_dataframe(frame, between={"delta": "linear"})


def test_metadata_of_an_undeclared_channel_stays_as_it_was() -> None:
    record = Record.from_arrays("run", TIME, {"delta": orders()})
    assert isinstance(record.to_dataframe(), pd.DataFrame)
    assert set(record.channel("delta").metadata) == {"unit", "frame", "positive", "reference_point", "label"}
