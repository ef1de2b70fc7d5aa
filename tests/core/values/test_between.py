"""How channels run between samples: judged by their travel, declared, and kept through resampling."""

import numpy as np
import pandas as pd
import pytest

from seatrial.core.values import InputError, Record
from seatrial.core.values.arrays import early_turns, held_rows, step_rows, travel, with_corner_areas

TIME = 0.5 * np.arange(200)


def orders() -> np.ndarray:
    return 0.2 * np.sign(np.sin(2.0 * np.pi * (TIME + 0.1) / 20.0))


def slewing() -> np.ndarray:
    return np.clip(0.5 * np.sin(2.0 * np.pi * TIME / 20.0), -0.2, 0.2)


def test_orders_travel_in_steps_and_a_slewing_rudder_does_not(rng: np.random.Generator) -> None:
    noise = 0.003 * rng.normal(size=len(TIME))
    assert travel(orders()).is_stepped and travel(orders() + noise).is_stepped
    assert not travel(slewing()).is_stepped and not travel(slewing() + noise).is_stepped


def test_rows_that_steps_reach_are_those_that_show_them(rng: np.random.Generator) -> None:
    rows = np.flatnonzero(np.diff(orders())) + 1
    np.testing.assert_array_equal(step_rows(orders()), rows)
    np.testing.assert_array_equal(step_rows(orders() + 0.003 * rng.normal(size=len(TIME))), rows)
    assert step_rows(slewing()[:192]).size == step_rows(np.array([0.1])).size == 0


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


def ramps(time: np.ndarray, late: float) -> np.ndarray:
    """A machinery of 3.1 per second between held angles, four ramps, as it is at these times."""
    starts = np.array([10.0, 30.0, 50.0, 70.0]) + late
    return sum(np.clip(3.1 * (time - start), 0.0, 20.0) * (-1) ** k for k, start in enumerate(starts))


@pytest.mark.parametrize("late", [0.0, 0.3, 0.77])
@pytest.mark.parametrize("step", [0.0, 0.1])
def test_corners_within_a_sample_keep_their_area(late: float, step: float) -> None:
    coarse, fine = np.arange(0.0, 90.5), np.linspace(0.0, 90.0, 90001)
    written = ramps(coarse, late)
    values = step * np.round(written / step) if step else written
    areas = [np.trapezoid(ramps(fine, late)[: 1000 * n + 1], dx=1e-3) for n in (25, 45, 65, 90)]
    corrected = with_corner_areas(values)
    by_lines = [np.trapezoid(corrected[: n + 1]) for n in (25, 45, 65, 90)]
    np.testing.assert_allclose(by_lines, areas, atol=1e-3 if not step else 2.0 * step)


def test_what_has_no_greatest_rate_keeps_its_values(rng: np.random.Generator) -> None:
    for values in (orders(), np.sin(0.7 * TIME), rng.normal(size=200), np.full(20, 0.1), np.array([0.1]), slewing()):
        np.testing.assert_array_equal(with_corner_areas(values), values)


def test_moves_made_at_once_keep_their_area(rng: np.random.Generator) -> None:
    """A controller on the recorder's clock: a machinery of 3 a sample follows each order from the sample's start."""
    orders = rng.normal(scale=4.0, size=60)
    fine, angle = [0.0], 0.0
    for order in orders:
        for _ in range(100):
            angle += np.clip(order - angle, -0.03, 0.03)
            fine.append(angle)
    course = np.array(fine)
    samples = course[::100]
    early, middle = samples + early_turns(samples), slice(1, -1)
    areas = np.array([np.trapezoid(course[: 100 * n + 1], dx=0.01) for n in range(1, 60)])
    errors = [np.array([np.trapezoid(v[: n + 1]) for n in range(1, 60)]) - areas for v in (samples, early)]
    assert np.std(errors[1][middle]) < 0.3 * np.std(errors[0][middle])


def test_a_rudder_that_always_moves_at_one_rate_or_stands_has_no_course_left_open() -> None:
    for values in (np.zeros(9), np.array([1.0]), np.concatenate([np.arange(9.0), np.full(5, 8.0)])):
        assert not early_turns(values).any()
