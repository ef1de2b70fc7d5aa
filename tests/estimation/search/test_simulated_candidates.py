"""Candidates of a non-linear model against the package's own problem, and one step against the simulator of records."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.values import Array, Record
from seatrial.estimation.problem import OutputError, cut_segments
from seatrial.estimation.search import JudgedRun, SimulatedCandidates
from seatrial.physics.models import model_named
from seatrial.physics.simulate import Forcing, inputs_of, trajectory

DT, SAMPLES = 0.5, 80
OUTPUTS, SIGMA = ("r", "psi"), np.array([0.01, 0.05])
MODEL = model_named("nomoto").with_values({"K": 0.15, "T": 8.0, "U": 2.0})
POINTS = np.array([[0.15, 8.0], [0.2, 6.0], [0.1, 11.0]])


def steered(phase: float) -> Record:
    time = DT * np.arange(SAMPLES)
    delta = 0.3 * np.clip(4.0 * np.sin(0.15 * time + phase), -1.0, 1.0)
    plan = Record.from_arrays("plan", time, {"delta": delta})
    states, _ = trajectory(MODEL, inputs_of(MODEL, plan), DT, np.zeros(len(MODEL.states)))
    channels = {"delta": delta} | {s: states[:, i] for i, s in enumerate(MODEL.states)}
    return Record.from_arrays(f"run {phase:g}", time, channels)


def judged(record: Record, *, with_states: bool = False) -> JudgedRun:
    measured = np.stack([record[name] for name in OUTPUTS], axis=1) + 0.003
    states = np.stack([record[name] for name in MODEL.states], axis=1) if with_states else None
    return JudgedRun(Forcing(inputs_of(MODEL, record), DT, is_held=True), np.zeros(len(MODEL.states)), measured, states)


def candidates(*runs: JudgedRun) -> SimulatedCandidates:
    return SimulatedCandidates(MODEL, ("K", "T"), runs, OUTPUTS, SIGMA)


def test_the_record_is_judged_as_by_the_packages_own_problem() -> None:
    records = [steered(0.0), steered(1.0)]
    data = cut_segments(MODEL, records, OUTPUTS, None)
    problem = OutputError(MODEL, replace(data, measured=data.measured + 0.003), SIGMA)
    rest = np.zeros((2, len(problem.starts)))
    expected = [np.sqrt(2.0 * problem.cost(point, rest) / data.measured.size) for point in POINTS]
    assert problem.free == ("K", "T")
    np.testing.assert_allclose(candidates(*map(judged, records)).record_rms(POINTS), expected, rtol=1e-10)


def test_a_candidate_that_cannot_be_simulated_is_infinitely_bad() -> None:
    unstable = np.array([[0.15, -1e-3]])
    one = candidates(judged(steered(0.0)))
    assert one.record_rms(unstable)[0] == np.inf


@pytest.mark.parametrize("step", [0, 17])
def test_a_sample_is_judged_by_one_step_of_the_simulator(step: int) -> None:
    record = steered(0.5)
    one = candidates(judged(record, with_states=True))
    state = one.given_state(step)
    assert state is not None
    inputs = inputs_of(MODEL, record)[step : step + 2]

    def reached(point: Array) -> Array:
        model = MODEL.with_values(dict(zip(("K", "T"), map(float, point), strict=True)))
        return trajectory(model, inputs, DT, state, substeps=1)[0][1]

    columns = [MODEL.states.index(name) for name in OUTPUTS]
    measured = one.runs[0].measured[step + 1]
    expected = [np.sqrt(np.mean(((reached(p)[columns] - measured) / SIGMA) ** 2)) for p in POINTS]
    np.testing.assert_allclose(one.step_rms(POINTS, step, state), expected, rtol=1e-9)
    np.testing.assert_allclose(one.advanced_state(POINTS[1], step, state), reached(POINTS[1]), rtol=1e-12)
