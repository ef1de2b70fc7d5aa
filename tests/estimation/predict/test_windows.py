"""Windows simulated open loop: cut where they must be, exact for the truth, one that diverges harms no other."""

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.data.trial import EstimateSettings
from seatrial.estimation.estimate import Runs
from seatrial.estimation.estimate.assemble import output_error_problem
from seatrial.estimation.predict.open_loop import open_loop_runs
from seatrial.estimation.predict.windows import MIN_STEPS, Windows, simulate_windows, start_states
from seatrial.estimation.problem.output_error import OutputError
from seatrial.physics.models import model_named
from seatrial.physics.simulate.replay import replay

SECONDS = 1.0  # of a window, from which its initial state is estimated


@pytest.fixture(scope="module")
def records() -> list[Record]:
    """Two runs of 25 and 12 s of two thrusters worked by steps, without noise."""
    model = model_named("thrusters")
    runs = []
    for name, steps in (("long", 25), ("short", 12)):
        commands = np.repeat(np.random.default_rng(steps).uniform(-1.0, 1.0, size=(steps, 2)), 10, axis=0)
        inputs = {"command_1": commands[:, 0], "command_2": commands[:, 1]}
        planned = Record.from_arrays(name, 0.1 * np.arange(len(commands)), inputs)
        start = dict.fromkeys(model.states, 0.0) | {"c_port": commands[0, 0], "c_starboard": commands[0, 1]}
        runs.append(replay(model, planned, start, substeps=1))  # as the problem below takes
    return runs


@pytest.fixture(scope="module")
def problem(records: list[Record]) -> OutputError:
    runs = Runs.one_session_each(records, 1.0)
    model = model_named("thrusters")
    return output_error_problem(model, runs, 10.0, EstimateSettings().with_known_timing(model.input_names))


def nothing(records: list[Record]) -> np.ndarray:
    return np.zeros((len(records), 0))


def test_windows_follow_one_another_and_the_remainder_is_dropped(records: list[Record]) -> None:
    windows = Windows.cut(records, 10.0)
    assert windows.run.tolist() == [0, 0, 1]
    assert [piece.time[0] for piece in windows.pieces] == pytest.approx([0.0, 10.0, 0.0])
    assert all(piece.duration == pytest.approx(10.0) for piece in windows.pieces)
    assert Windows.cut(records, 10.0, each=1).run.tolist() == [0, 1]
    assert Windows.cut(records, 15.0).run.tolist() == [0], "a run shorter than a window has none"
    assert windows.evenly_spread(2).first.tolist() == [0, 0]
    assert windows.beginnings(1.0).steps == 10
    assert windows.beginnings(0.1).steps == MIN_STEPS
    whole = Windows.of_record(records[1])
    np.testing.assert_array_equal(whole.pieces[0].time, records[1].time)


def test_the_truth_predicts_its_own_windows_with_thrusters_as_the_whole_run_left_them(
    records: list[Record], problem: OutputError
) -> None:
    model, windows = model_named("thrusters"), Windows.cut(records, 10.0)
    runs = open_loop_runs(problem, model, windows, nothing(records), SECONDS)
    for piece, run in zip(windows.pieces, runs, strict=True):
        for channel in ("u", "r", "psi", "x0"):
            np.testing.assert_allclose(run.record[channel], piece[channel], atol=1e-6)
    wrong = open_loop_runs(problem, model.with_values({"k_f": 1.2}), windows, nothing(records), SECONDS)
    assert all(np.max(np.abs(run.record["u"] - p["u"])) > 0.01 for p, run in zip(windows.pieces, wrong, strict=True))


def test_all_windows_at_once_are_each_alone(records: list[Record], problem: OutputError) -> None:
    model, windows = model_named("thrusters").with_values({"k_f": 1.1}), Windows.cut(records, 10.0)
    states = start_states(problem, model, windows, nothing(records), SECONDS)
    for i in range(len(windows)):
        alone = start_states(problem, model, windows.selected(slice(i, i + 1)), nothing(records), SECONDS)
        np.testing.assert_allclose(alone.values[0], states.values[i], atol=1e-6)


def test_as_measured_where_no_seconds_are_used(records: list[Record], problem: OutputError) -> None:
    windows = Windows.cut(records, 10.0)
    states = start_states(problem, model_named("thrusters"), windows, nothing(records), 0.0)
    u = model_named("thrusters").states.index("u")
    assert states.values[:, u].tolist() == [piece["u"][0] for piece in windows.pieces]


def test_a_window_that_diverges_harms_no_other(records: list[Record], problem: OutputError) -> None:
    broken = records[0].with_channel(
        "u", records[0].channel("u").with_values(np.where(records[0].time < 1.1, 1e9, 0.5))
    )
    model, windows = model_named("thrusters"), Windows.cut([broken, records[1]], 10.0)
    states = start_states(problem, model, windows, nothing(records), SECONDS)
    sound = start_states(problem, model, Windows.cut([records[1]], 10.0), nothing(records[1:]), SECONDS)
    np.testing.assert_allclose(states.values[2], sound.values[0], atol=1e-6)
    assert np.isfinite(simulate_windows(problem, model, windows, nothing(records), states.values)[2]).all()
