"""States that follow the commands alone: which they are, and where they stand at the start of a segment."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.values import Prior, Record
from seatrial.estimation.problem.output_error import Nuisance, OutputError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.physics.models import model_named
from seatrial.physics.simulate.batch import InputCorrection
from seatrial.physics.simulate.replay import inputs_of, replay
from seatrial.physics.simulate.states import (
    actuator_motion,
    actuator_states,
    hidden_states,
    measured_states,
    settled_actuators,
)

MEASURED = ("u", "v", "r", "psi", "x0", "y0")
OFFSET = (Nuisance(InputCorrection("command_1", "zero"), Prior(0.0, 0.1), "1"),)


@pytest.fixture(scope="module")
def record() -> Record:
    """Two thrusters worked by steps for 30 s at 10 Hz, from a command held long before."""
    model = model_named("thrusters")
    commands = np.repeat(np.random.default_rng(3).uniform(-1.0, 1.0, size=(10, 2)), 30, axis=0)
    steps = dict(zip(model.input_names, commands.T, strict=True))
    planned = Record.from_arrays("steps", 0.1 * np.arange(len(commands)), steps)
    start = dict.fromkeys(model.states, 0.0) | {"c_port": commands[0, 0], "c_starboard": commands[0, 1]}
    full = replay(model, planned, start, substeps=1)  # as the problem below takes
    return replace(full, channels={n: c for n, c in full.channels.items() if n in (*MEASURED, *model.input_names)})


def problem(record: Record) -> OutputError:
    model = model_named("thrusters")
    model = model.with_parameters(model.parameters.only_free(("tau", "tau_down", "k_f", "N_rr")))
    return OutputError(model, cut_segments(model, [record], MEASURED, 4.0), np.full(6, 0.05), OFFSET)


def test_lags_of_thrusters_follow_the_inputs_and_nothing_else_does() -> None:
    assert actuator_states(model_named("thrusters")) == ("c_port", "c_starboard")
    for name in ("waterjet", "nomoto", "nomoto2", "roll", "heave_pitch"):
        assert actuator_states(model_named(name)) == ()


def test_they_are_known_along_a_record(record: Record) -> None:
    model = model_named("thrusters")
    assert hidden_states(model, [record]) == ()
    states = measured_states(model, record)
    motion = actuator_motion(model, inputs_of(model, record), record.dt)
    np.testing.assert_array_equal(states[:, 6], motion["c_port"])
    assert motion["c_port"][0] == pytest.approx(record["command_1"][0], abs=1e-9)


def test_segments_start_where_the_run_brought_them(record: Record) -> None:
    cut = problem(record)
    assert cut.starts == MEASURED
    simulated = cut.simulated_outputs(cut.start(), cut.measured_initial_states())
    np.testing.assert_allclose(simulated, cut.data.measured, atol=1e-9)


def test_sensitivities_include_what_a_lag_does_before_a_segment(record: Record) -> None:
    cut = problem(record)
    shared, local = cut.start() + 0.02, cut.measured_initial_states()
    exact = cut.slopes(shared, local)
    for column in range(cut.size):
        step = np.zeros(cut.size)
        step[column] = 1e-6
        up, down = (cut.simulated_outputs(shared + sign * step, local) for sign in (1.0, -1.0))
        np.testing.assert_allclose(exact[:, :, column], (up - down) / 2e-6, atol=2e-7 * np.abs(exact).max())


def test_a_selection_of_segments_keeps_their_starts(record: Record) -> None:
    cut = problem(record)
    chosen = np.array([3, 1, 1])
    part = replace(cut, data=cut.data.selected(chosen))
    whole = cut.simulated_outputs(cut.start(), cut.measured_initial_states())
    rows = np.concatenate([np.arange(*cut.data.offsets[s : s + 2]) for s in chosen])
    np.testing.assert_allclose(
        part.simulated_outputs(part.start(), part.measured_initial_states()), whole[rows], atol=1e-9
    )


def test_actuators_settle_at_their_commands_and_nothing_else_moves() -> None:
    model = model_named("thrusters")
    state = settled_actuators(model, np.array([0.6, -0.3]))
    settled = dict(zip(model.states, state, strict=True))
    assert settled.pop("c_port") == pytest.approx(0.6, abs=1e-9)
    assert settled.pop("c_starboard") == pytest.approx(-0.3, abs=1e-9)
    assert not any(settled.values())
