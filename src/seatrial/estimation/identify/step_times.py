"""When inputs that are held changed within a sample: estimated where the records show it, and inside the intervals.

A log shows a new order at the first sample behind it. The share of the sample before in which it was in force already
is anything from 0 to 1: an unknown of each step, that no later sample takes back.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, Finding, Record, Severity
from seatrial.core.values.arrays import step_rows
from seatrial.data.trial import Role
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.point_estimate import (
    PointEstimate,
    effective_inflation,
    residual_correlation,
    residual_spread,
)
from seatrial.estimation.identify.identification import Identification, InputStep
from seatrial.estimation.identify.score_test import (
    Candidate,
    added_input,
    output_error_estimate,
    own_criterion,
    score_test,
)
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.prediction_error import join_segments
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.physics.simulate.replay import inputs_of

_MEAN, _VARIANCE = 0.5, 1.0 / 12.0  # of a share that may be anything from 0 to 1: the uniform distribution's
_ROWS_BEFORE = 2  # of a step's own, to which one that is earlier reaches: those of its interpolation
_MOST_STEPS = 300  # of all runs; chosen: with more, each is a small part of what the records show
_ROUNDS = 5  # of shares by one step of the gradient and a short search in turn; chosen
_EVALUATIONS = 12  # of each of these searches; chosen
_STEP = 0.1  # of a step of an input, of differences by its share; chosen


def _moved_step(share: float) -> Array:
    """Return what an earlier step adds to the two rows before its own and to that, over its size, (3,).

    By cubic convolution (Keys 1981, IEEE Trans. ASSP 29, 1153, eq. (8)) area, first and second moment are those of a
    step `share` of a sample earlier.
    """
    near = 1.0 + (1.0 - share) ** 2 * (1.5 * (1.0 - share) - 2.5)  # Keys, eq. (8), within a sample
    far, last = (2.0 - d * (4.0 - d * (2.5 - 0.5 * d)) for d in (2.0 - share, 1.0 + share))  # the same, beyond one
    return np.array([far, near + far, -last])


def _inputs_of_steps(steps: Sequence[InputStep], records: Sequence[Record]) -> list[Array]:
    """What steps add to the inputs of each run where they are earlier by their shares of a sample, (rows, nu)."""
    added = [np.zeros((len(record), len(steps[0].size))) for record in records]
    for step in steps:
        added[step.run][step.row - _ROWS_BEFORE : step.row + 1] += np.outer(_moved_step(step.share), step.size)
    return added


def _candidates(steps: Sequence[InputStep], records: Sequence[Record]) -> list[Candidate]:
    """Further shares of steps, each a candidate of a score test."""
    made = []
    for step in steps:
        slope = (_moved_step(step.share + _STEP) - _moved_step(step.share - _STEP)) / (2.0 * _STEP)
        added = [np.zeros((len(record), len(step.size))) for record in records]
        added[step.run][step.row - _ROWS_BEFORE : step.row + 1] = np.outer(slope, step.size)
        made.append(added_input(f"step at row {step.row} of {records[step.run].name}", added, _STEP))
    return made


def open_steps(task: Identification) -> tuple[tuple[str, ...], tuple[InputStep, ...]]:
    """Return the inputs that training runs hold, of which nobody says when they change, and their steps, run by run.

    Inputs that change in one row do so at one time: they come in one message.
    """
    problem, records = task.beginning.shooting.problem, task.runs.records
    model = problem.model
    late = {n.correction.input for n in problem.nuisances if n.correction.kind == "delay" and n.is_spread_fixed}
    declared = {n for n in late for r in records if n in r and r.channel(n).between}
    names = tuple(n for n in model.input_names if n in model.held and n in late - declared)
    columns = [model.input_names.index(n) for n in names]
    steps = []
    for run, record in enumerate(records):
        inputs = inputs_of(model, record)
        rows = np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *(step_rows(inputs[:, j]) for j in columns)]))
        for row in rows[rows >= _ROWS_BEFORE].tolist():
            size = np.zeros(inputs.shape[1])
            size[columns] = inputs[row, columns] - inputs[row - 1, columns]
            steps.append(InputStep(run, row, size, _MEAN))
    return names, tuple(steps)


def with_step_times(task: Identification) -> Identification:
    """Return the task whose held inputs change within samples where its records are much likelier so.

    The training runs change as estimated, the others in the middle of a sample.
    """
    names, steps = open_steps(task)
    if not steps or len(steps) > _MOST_STEPS:
        return task
    try:
        steps = _timed_steps(task, names, steps)
    except (ArithmeticError, np.linalg.LinAlgError):  # of a simulation that leaves what a computer can hold
        return task
    if not steps:
        return task
    trained, records = [r for r in task.records if r.role is Role.TRAIN], []
    for one in task.records:
        run = next((k for k, other in enumerate(trained) if other is one), -1)
        shares = {s.row: s.share for s in steps if s.run == run}
        records.append(replace(one, record=_with_shares(one.record, names, shares, task.outputs)))
    others = tuple(f for f in task.findings if f.code != "stepped-input")
    findings = (*others, _finding(names, steps))
    return replace(task, records=tuple(records), steps=steps, findings=findings, near=task.beginning)


def _with_shares(record: Record, names: Sequence[str], shares: Mapping[int, float], outputs: Sequence[str]) -> Record:
    """The record with inputs that change within the sample before each step, by rows; in its middle where unknown.

    Outputs at both ends of that sample are left out: moments of the input make those behind it right, not these.
    """
    for name in names:
        if name in record:
            channel = record.channel(name)
            values = channel.values.copy()
            for row in shares or step_rows(channel.values).tolist():
                if row >= _ROWS_BEFORE:
                    size = channel.values[row] - channel.values[row - 1]
                    values[row - _ROWS_BEFORE : row + 1] += size * _moved_step(shares.get(row, _MEAN))
            record = record.with_channel(name, replace(channel.with_values(values), between="held"))
    for symbol in [n for n in outputs if n in record and shares]:
        is_measured = np.isfinite(record.measured(symbol))
        is_measured[[row - k for row in shares for k in (0, 1)]] = False
        record = record.with_channel(symbol, record.channel(symbol).with_measured(is_measured))
    return record


def _finding(names: Sequence[str], steps: Sequence[InputStep]) -> Finding:
    return Finding(
        Severity.INFO, "stepped-input", f"{enumeration(names, len(names))} change between samples, not at them: the "
        f"times of {len(steps)} steps are estimated",
        f"on average {np.mean([s.share for s in steps]):.2f} of a sample before the row that shows the step",
        "record orders as often as they change; declare between where they change at samples",
    )  # fmt: skip


def _timed_steps(task: Identification, names: Sequence[str], steps: tuple[InputStep, ...]) -> tuple[InputStep, ...]:
    """The steps with their shares; none where the records are hardly likelier with these than without.

    They are likelier by more than one for each share, each an unknown (Akaike 1974), in effective samples.
    """
    is_part = task.beginning.runs is not task.runs  # of long records: the estimate over all of them
    before = output_error_estimate(task.estimation) if is_part else task.beginning.shooting
    records = task.runs.records
    plain, first = join_segments(before.problem)
    local = before.optimum.local[first]
    alone = levenberg_marquardt(plain, before.common_parameters, local, evaluations=_EVALUATIONS)
    problem, residuals = plain, PointEstimate(plain, alone).residuals()
    spread = residual_spread(plain, residuals)
    late_steps = tuple(replace(s, share=_STEP) for s in steps)
    test = score_test(
        PointEstimate(replace(plain, noise=spread, inflation=None), alone), _candidates(late_steps, records)
    )
    if test.joint((_MEAN**2 + _VARIANCE) * np.eye(len(steps)))[2] < 2.0 * len(steps):
        return ()
    point = _without_lead(plain, alone.solution.point, names)
    for _ in range(_ROUNDS):
        problem = added_input("", _inputs_of_steps(steps, records)).problem_with(plain, 1.0)
        optimum = levenberg_marquardt(problem, point, local, evaluations=_EVALUATIONS)
        residuals = PointEstimate(problem, optimum).residuals()
        if not np.all(np.isfinite(np.nan_to_num(residuals))):
            return ()
        plain = replace(plain, noise=residual_spread(problem, residuals), inflation=None)
        timed = PointEstimate(replace(problem, noise=plain.noise, inflation=None), optimum)
        moves, by_moves = _moves(timed, steps, records)
        shares = np.clip([s.share + m for s, m in zip(steps, moves.tolist(), strict=True)], 0.0, 1.0)
        steps = tuple(replace(s, share=float(share)) for s, share in zip(steps, shares, strict=True))
        point, local = np.clip(optimum.solution.point + by_moves, problem.lower, problem.upper), optimum.local
    colour = effective_inflation(residual_correlation(problem, residuals)[1])
    samples = np.isfinite(problem.data.measured).sum(axis=0) / (1.0 if colour is None else colour)
    return steps if float(samples @ np.log(spread / plain.noise)) > len(steps) else ()


def _moves(estimate: PointEstimate, steps: Sequence[InputStep], records: Sequence[Record]) -> tuple[Array, Array]:
    """By how much shares change in one step of the gradient, and the common parameters with them."""
    test = score_test(estimate, _candidates(steps, records))
    pull = test.gradient + (np.array([s.share for s in steps]) - _MEAN) / _VARIANCE
    moves: Array = -np.linalg.solve(test.curvature + np.eye(len(steps)) / _VARIANCE, pull).astype(np.float64)
    return moves, test.by_candidates @ moves


def _without_lead(problem: OutputError, point: Array, names: Sequence[str]) -> Array:
    """The point without delays of these inputs, which stand for the mean of their shares."""
    moved = point.copy()
    own = moved[len(problem.free) :].reshape(-1, problem.unknowns_per_session)
    for j, nuisance in enumerate(problem.nuisances, start=len(problem.session_parameters)):
        if nuisance.correction.kind == "delay" and nuisance.correction.input in names:
            own[:, j] = 0.0
    return moved


def with_open_step_times(estimation: Estimation, task: Identification) -> Estimation:
    """Return the estimation whose intervals hold what the records leave open of the shares of steps."""
    if not task.steps:
        return estimation
    candidates = _candidates(task.steps, task.runs.records)
    test = score_test(own_criterion(estimation), candidates)
    covariance = test.joint(_VARIANCE * np.eye(len(candidates)))[1]
    moves = test.by_candidates[: len(estimation.estimate.problem.free)]
    return estimation.widened(moves @ covariance @ moves.T, "times of steps within samples")
