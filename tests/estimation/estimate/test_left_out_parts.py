"""Errors on left-out parts: steps against refits, and what they are there for, an order recorded for the angle."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.criterion_choice import (
    Parts,
    WindowSeconds,
    innovation_points,
    kinds_of,
    left_out_errors,
    output_error_points,
)
from seatrial.estimation.estimate.fit import estimate_model
from seatrial.estimation.estimate.point_estimate import PointEstimate, fit_output_error
from seatrial.estimation.estimate.process_noise import fit_prediction_error
from seatrial.estimation.estimate.settings import EstimatorOptions
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.physics.models.nomoto import nomoto

K, T, DT, ROWS = 0.1, 8.0, 0.5, 1200
NOISE = np.radians(0.1)
PARTS = Parts(4, are_runs=False)


def record_of(rng: np.random.Generator, late: float = 0.0) -> Record:
    """Rudder that runs straight from sample to sample, ten steps each; late: lag between order and angle [s]."""
    order = np.repeat(rng.choice([-0.2, -0.1, 0.1, 0.2], ROWS // 40), 40)
    order = np.convolve(order, np.ones(8) / 8.0, "same")
    between = np.interp(np.arange(10 * ROWS) / 10.0 + 0.05, np.arange(ROWS), order)
    h, r, psi, delta = DT / 10.0, 0.0, 0.0, 0.0
    heading = np.empty(ROWS)
    for k in range(10 * ROWS):
        if k % 10 == 0:
            heading[k // 10] = psi
        delta += (between[k] - delta) * (1.0 - np.exp(-h / late) if late else 1.0)
        after = K * delta + (r - K * delta) * np.exp(-h / T)
        psi, r = psi + 0.5 * h * (r + after), after
    shown = heading + NOISE * rng.standard_normal(ROWS)
    return Record.from_arrays("run", DT * np.arange(ROWS), {"delta": order, "psi": shown})


@pytest.fixture(scope="module")
def estimate() -> PointEstimate:
    record = record_of(np.random.default_rng(4))
    data = cut_segments(nomoto(), [record], ("psi",), None)
    problem = OutputError(nomoto(), data, np.array([NOISE]), workers=1)
    return fit_output_error(problem, problem.start(), problem.measured_initial_states(), {"psi": NOISE})


def test_a_step_leads_to_the_refit_without_the_quarter(estimate: PointEstimate) -> None:
    points, problem = output_error_points(estimate, PARTS), estimate.problem
    assert points.shape == (PARTS.count, 2)
    for k in range(PARTS.count):
        measured = problem.data.measured.copy()
        measured[k * ROWS // PARTS.count : (k + 1) * ROWS // PARTS.count] = np.nan
        rest = replace(problem, data=replace(problem.data, measured=measured))
        refit = fit_output_error(rest, estimate.common_parameters, estimate.optimum.local, {"psi": NOISE})
        moved = refit.common_parameters - estimate.common_parameters
        np.testing.assert_allclose(points[k] - estimate.common_parameters, moved, rtol=0.1, atol=1e-4)


def test_without_a_disturbance_both_criteria_predict_alike(estimate: PointEstimate) -> None:
    noise = fit_prediction_error(estimate, {"psi": NOISE}, thorough=True)
    record = record_of(np.random.default_rng(4))
    runs, seconds = Runs.one_session_each([record], 40.0), WindowSeconds(10.0, 4.0)
    errors = left_out_errors(estimate.problem, output_error_points(estimate, PARTS), runs, PARTS, seconds)
    others = left_out_errors(noise.as_point_estimate().problem, innovation_points(noise, PARTS), runs, PARTS, seconds)
    assert errors.shape == others.shape == (PARTS.count, 2, 1)
    np.testing.assert_allclose(errors, others, atol=0.1)
    assert np.all(np.exp(errors) < 5.0 * NOISE)  # the state at which a window begins is known by a few samples


def test_an_order_in_place_of_the_angle_is_no_disturbance() -> None:
    """One-step prediction takes the machinery's lag for gusts and shifts K; what is predicted shows it."""
    record = record_of(np.random.default_rng(1), late=2.5)
    estimation = estimate_model(nomoto(), Runs.one_session_each([record], 40.0), options=EstimatorOptions(workers=1))
    assert estimation.estimate.common_parameters[0] == pytest.approx(K, rel=0.05)
    assert any("errors on quarters of the runs left out" in reason for reason in estimation.reasons)
    judged = {c.name: c.left_out_error for c in estimation.noise_model.candidates}
    assert judged["white"] is not None and judged["white"] > 1.25
    assert estimation.noise_model.disturbance not in ("white", "first-order Markov on r")


def test_kinds_of_channels() -> None:
    assert kinds_of(("u", "psi", "x0", "y0")) == [("psi",), ("x0", "y0")]
    assert kinds_of(("z", "theta")) == [("z",), ("theta",)]


def test_whole_runs_where_they_are_enough() -> None:
    record = record_of(np.random.default_rng(4))
    few, many = (Runs.one_session_each([record.renamed(f"run {k}") for k in range(n)], 40.0) for n in (3, 9))
    quarters, runs = Parts.for_runs(few), Parts.for_runs(many)
    assert quarters == Parts(4, are_runs=False) and quarters.rows(few, 1)[0] == (ROWS // 4, ROWS // 2)
    assert runs == Parts(8, are_runs=True)
    assert [b for _, b in runs.rows(many, 0)] == [ROWS, *[0] * 7, ROWS], "every eighth run"
    data = cut_segments(nomoto(), many.records, ("psi",), 50.0)
    pieces = np.split(runs.of_rows(data), data.offsets[1:-1])
    assert [set(piece) for piece in pieces] == [{r % 8} for r in data.run]
    assert Parts.for_runs(Runs.one_session_each([record.rows(slice(0, 30))], 40.0)) is None


def test_parts_of_uneven_length_and_without_a_channel(estimate: PointEstimate) -> None:
    """Quarters of 66 rows hold one or two of the shortest windows; a part without headings has no error of them."""
    record = record_of(np.random.default_rng(4)).rows(slice(0, 66))
    psi = np.where(np.arange(66) < 40, np.nan, record["psi"])
    gappy = record.with_channel("psi", record.channel("psi").with_values(psi))
    points = np.tile(estimate.common_parameters, (PARTS.count, 1))
    for one, missing in ((record, 0), (gappy, 2)):
        runs = Runs.one_session_each([one], 40.0)
        data = cut_segments(nomoto(), runs.records, ("psi",), None)
        problem = replace(estimate.problem, data=data)
        errors = left_out_errors(problem, points, runs, PARTS, WindowSeconds(10.0, 4.0))
        assert errors.shape == (PARTS.count, 2, 1)
        assert np.isnan(errors[:, 0, 0]).sum() == missing
        assert np.isfinite(errors[missing:]).all()


def test_an_error_beyond_the_motion_counts_as_the_motion(estimate: PointEstimate) -> None:
    """One step from an estimate may lead where a part diverges: that it fails there says no more than any failure."""
    runs, seconds = Runs.one_session_each([record_of(np.random.default_rng(4))], 40.0), WindowSeconds(10.0, 4.0)
    unstable, reversed_gain = (np.tile(point, (PARTS.count, 1)) for point in ([K, -0.01], [-K, 8.0]))
    failing, wrong = (left_out_errors(estimate.problem, p, runs, PARTS, seconds) for p in (unstable, reversed_gain))
    whole_parts = np.log([np.std(q) for q in np.array_split(runs.records[0]["psi"], PARTS.count)])
    np.testing.assert_allclose(failing[:, 0, 0], whole_parts, atol=0.05)
    assert np.all(wrong <= failing + 0.05)
