"""Records cut into segments, and the states with which these begin."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import Channel, InputError, Record
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import (
    LastPoint,
    compared_outputs,
    cut_segments,
    initial_state_weights,
    measured_initial_states,
    start_velocity,
)
from seatrial.physics.models import model_named
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.sensors import Sensors, with_sensors


def record(name: str, rows: int, dt: float = 0.5, port: bool = False) -> Record:
    time = dt * np.arange(rows)
    made = Record.from_arrays(name, time, {"r": np.sin(time), "psi": np.cos(time), "delta": 0.1 * time})
    return made.with_channel("delta", Channel(-0.1 * time, "rad", "body", "port")) if port else made


@pytest.fixture
def model() -> Model:
    return nomoto()


def test_neighbours_share_one_sample_and_nothing_is_lost(model: Model) -> None:
    data = cut_segments(model, [record("a", 101)], ("r", "psi"), 12.0)
    assert data.count == round(50.0 / 12.0)
    pieces = [data.measured[a:b] for a, b in pairwise(data.offsets)]
    for one, two in pairwise(pieces):
        np.testing.assert_array_equal(one[-1], two[0])
    joined = np.concatenate([pieces[0], *(p[1:] for p in pieces[1:])])
    np.testing.assert_array_equal(joined, record("a", 101).matrix(("r", "psi")))
    assert np.ptp(np.diff(data.offsets)) <= 1


def test_whole_runs_and_runs_shorter_than_a_segment(model: Model) -> None:
    whole = cut_segments(model, [record("a", 30), record("b", 50)], ("r",), None)
    np.testing.assert_array_equal(whole.offsets, [0, 30, 80])
    assert cut_segments(model, [record("a", 30)], ("r",), 1e6).count == 1


def test_runs_and_sessions_are_stated_apart(model: Model) -> None:
    data = cut_segments(
        model, [record("a", 41), record("b", 41), record("c", 41)], ("r",), 10.0, ["day 2", "day 1", "day 2"]
    )
    np.testing.assert_array_equal(data.run, [0, 0, 1, 1, 2, 2])
    np.testing.assert_array_equal(data.session, [0, 0, 1, 1, 0, 0])
    assert data.sessions == ("day 2", "day 1")
    assert data.runs == ("a", "b", "c")


def test_inputs_take_the_models_sign(model: Model) -> None:
    one, other = (cut_segments(model, [record("a", 21, port=p)], ("r",), None).inputs for p in (False, True))
    np.testing.assert_array_equal(one, other)


def test_a_channel_that_was_not_measured_is_nan(model: Model) -> None:
    data = cut_segments(model, [record("a", 21), record("b", 21).without("r")], ("r", "psi"), None)
    assert np.all(np.isfinite(data.measured[:21]))
    assert np.all(np.isnan(data.measured[21:, 0]))
    assert np.all(np.isfinite(data.measured[21:, 1]))


def test_outputs_are_those_the_records_hold(model: Model) -> None:
    records = [record("a", 21), record("b", 21).without("r")]
    assert compared_outputs(model, records) == ("r", "psi")
    assert compared_outputs(model, records, ("psi",)) == ("psi",)
    with pytest.raises(InputError, match=r"channel 'phi' cannot be compared; known are r, psi"):
        compared_outputs(model, records, ("phi",))
    with pytest.raises(InputError, match="no record holds any output of model 'nomoto': r, psi, x0, y0"):
        compared_outputs(model, [records[0].without("r", "psi")])


def test_positions_are_left_out_while_a_steering_model_has_no_speed(model: Model) -> None:
    time = np.arange(0.0, 20.0, 0.5)
    tracked = Record.from_arrays("track", time, {name: np.zeros(40) for name in ("r", "psi", "x0", "y0", "delta")})
    assert compared_outputs(model, [tracked]) == ("r", "psi")
    assert compared_outputs(model.with_values({"U": 2.0}), [tracked]) == ("r", "psi", "x0", "y0")
    with pytest.raises(InputError, match=r"'x0' cannot be compared: .* while its speed U is 0; give U"):
        compared_outputs(model, [tracked], ("r", "x0"))


def test_rates_that_differ_and_short_records_are_refused(model: Model) -> None:
    with pytest.raises(InputError, match=r"record 'b' has a time step of 0\.25 s, the first one 0\.5 s"):
        cut_segments(model, [record("a", 21), record("b", 21, dt=0.25)], ("r",), None)
    with pytest.raises(InputError, match="record 'a' has 2 samples; at least three"):
        cut_segments(model, [record("a", 2)], ("r",), None)


def test_segments_are_taken_in_any_order_and_number(model: Model) -> None:
    data = cut_segments(model, [record("a", 41), record("b", 61)], ("r", "psi"), 10.0)
    taken = data.selected(np.array([3, 0, 3]))
    assert taken.count == 3 and taken.runs == data.runs
    np.testing.assert_array_equal(taken.run, [1, 0, 1])
    for place, chosen in enumerate((3, 0, 3)):
        one = slice(*taken.offsets[place : place + 2])
        other = slice(*data.offsets[chosen : chosen + 2])
        np.testing.assert_array_equal(taken.measured[one], data.measured[other])
        np.testing.assert_array_equal(taken.inputs[one], data.inputs[other])


def test_a_segment_taken_twice_costs_twice(model: Model) -> None:
    data = cut_segments(model, [record("a", 41)], ("r", "psi"), 10.0)
    problem = OutputError(model, data, np.array([0.1, 0.1]), workers=1)
    shared, local = problem.start(), problem.measured_initial_states()
    single = replace(problem, data=data.selected(np.array([1]))).cost(shared, local[[1]])
    double = replace(problem, data=data.selected(np.array([1, 1]))).cost(shared, local[[1, 1]])
    assert double == pytest.approx(2.0 * single, rel=1e-12)


def test_positions_that_a_receiver_holds_count_once() -> None:
    time = 0.1 * np.arange(6)
    x0 = np.array([0.0, 0.0, 0.2, 0.2, 0.2, 0.5])
    y0 = np.array([1.0, 1.0, 1.0, 1.0, 1.1, 1.1])
    run = Record.from_arrays("run", time, {"psi": np.zeros(6), "x0": x0, "y0": y0, "delta": 0.1 * time})
    model = with_sensors(nomoto().with_values({"U": 1.0}), Sensors(position_hold=True))
    data = cut_segments(model, [run], ("psi", "x0", "y0"), None)
    np.testing.assert_array_equal(np.isnan(data.measured[:, 1]), [False, True, False, True, False, False])
    np.testing.assert_array_equal(np.isnan(data.measured[:, 1]), np.isnan(data.measured[:, 2]))
    assert not np.any(np.isnan(data.measured[:, 0]))


DT = 0.1


def track(rng: np.random.Generator) -> tuple[np.ndarray, ...]:
    """A circle of 20 m at 2 m/s in a drift of 6 deg: psi, north, east, yaw rate, with noise of 2 cm."""
    t = DT * np.arange(201)
    course = 0.4 + 0.1 * t
    north, east = 20.0 * np.sin(course), -20.0 * np.cos(course)
    noise = 0.02 * rng.standard_normal((2, len(t)))
    return t, course - np.radians(6.0), north + noise[0], east + noise[1]


def test_the_velocity_of_a_track_is_in_the_axes_of_the_craft(rng: np.random.Generator) -> None:
    _, psi, north, east = track(rng)
    # by hand: 2 m/s along the course, which is 6 deg to starboard of the heading
    u, v = start_velocity(north, east, psi, DT)
    assert (u, v) == pytest.approx((2.0 * np.cos(np.radians(6.0)), 2.0 * np.sin(np.radians(6.0))), abs=0.05)
    north[3:9] = np.nan
    assert start_velocity(north, east, psi, DT)[0] == pytest.approx(u, abs=0.05)
    assert start_velocity(np.full(50, np.nan), east[:50], psi[:50], DT) == (0.0, 0.0)


def test_segments_of_a_track_begin_under_way_and_not_at_rest(rng: np.random.Generator) -> None:
    t, psi, north, east = track(rng)
    channels = {"psi": psi, "x0": north, "y0": east, "delta": 0.0 * t, "v_j": 0.0 * t}
    data = cut_segments(model_named("waterjet"), [Record.from_arrays("a", t, channels)], ("psi", "x0", "y0"), 5.0)
    local = measured_initial_states(data, ("u", "v", "r", "psi", "x0", "y0"))
    assert data.count == 4
    np.testing.assert_allclose(np.hypot(local[:, 0], local[:, 1]), 2.0, atol=0.1)
    np.testing.assert_array_equal(local[:, 2], 0.0)  # of a yaw rate, nothing is known
    np.testing.assert_array_equal(local[:, 3], psi[data.offsets[:-1] - np.arange(data.count)])


def test_a_thin_beginning_starts_with_the_fixes_of_the_run_and_a_prior(rng: np.random.Generator) -> None:
    """Fixes of 1 Hz in rows of 10 Hz: a segment of 2 s holds two of them."""
    t, psi, north, east = track(rng)
    channels = {"psi": psi, "x0": north, "y0": east, "delta": 0.0 * t, "v_j": 0.0 * t}
    record = Record.from_arrays("a", t, channels)
    for name in ("x0", "y0"):
        record = record.with_channel(name, record.channel(name).with_measured(np.arange(len(t)) % 10 == 4))
    data = cut_segments(model_named("waterjet"), [record], ("psi", "x0", "y0"), 2.0)
    local = measured_initial_states(data, ("u", "v", "x0", "y0"))
    np.testing.assert_allclose(np.hypot(local[:, 0], local[:, 1]), 2.0, atol=0.3)
    rows = data.offsets[:-1] - np.arange(data.count)
    np.testing.assert_allclose(local[1:, 2], north[rows][1:], atol=0.2)  # straight between the fixes about them
    weights = initial_state_weights(data, ("u", "v", "x0", "y0"))
    assert np.all(weights[:, 0] > 0.0) and np.all(weights[:, 2] > 0.0)
    assert not initial_state_weights(cut_segments(model_named("waterjet"), [record], ("psi",), 2.0), ("u",)).any()


def test_what_was_worked_out_at_the_last_point_is_worked_out_once() -> None:
    last, asked = LastPoint[int](), list[str]()

    def part(point: str, first: int) -> int:
        return last.part((point,), (first, first + 1), lambda: asked.append(f"{point}{first}") or len(asked))

    assert [part("a", 0), part("a", 1), part("a", 0), part("b", 0), part("b", 0), part("a", 0)] == [1, 2, 1, 3, 3, 4]
    assert asked == ["a0", "a1", "b0", "a0"]


def test_outputs_at_a_point_do_not_depend_on_what_was_simulated_before(model: Model) -> None:
    data = cut_segments(model, [record("a", 41), record("b", 31)], ("psi", "r"), 5.0)
    problem = OutputError(model, data, np.ones(2))
    local, point = problem.measured_initial_states(), problem.start()
    first, elsewhere = problem.simulated_outputs(point, local), problem.simulated_outputs(1.1 * point, local)
    again = replace(problem, noise=2.0 * np.ones(2)).simulated_outputs(point, local)
    np.testing.assert_array_equal(again, first)
    assert not np.array_equal(elsewhere, first)
    assert not np.array_equal(replace(problem, substeps=4).simulated_outputs(point, local), first)
