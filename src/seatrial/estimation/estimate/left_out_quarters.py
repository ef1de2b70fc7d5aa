"""How far off a criterion's estimate is on what it did not see: a quarter of every training run, left out in turn.

What an estimate would be without a quarter follows by one Newton step (Pregibon 1981, Ann. Stat. 9, 705). The quarter
is then simulated from its recorded inputs, as a whole and in windows, each from a state that its first seconds show.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from seatrial.core.values import Array, Index
from seatrial.estimation.estimate.newton_refinement import step_within
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.estimate.process_noise import ProcessNoise
from seatrial.estimation.estimate.runs import Runs
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import Segments, segments_between
from seatrial.numerics.optimise import levenberg_marquardt

QUARTERS = 4
"""Parts of each run that are left out in turn; chosen."""
_FEWEST_ROWS = 8  # rows of the shortest quarter that is judged; chosen
_FEWEST_WINDOWS = 4  # of the shortest quarter; chosen
_LEAST_START = 4  # rows that show where a window begins, at least; chosen
_EVALUATIONS = 40  # of the search for states at which windows begin; chosen: a few are enough
_HEADING, _POSITION = ("psi",), ("x0", "y0")


@dataclass(frozen=True)
class WindowSeconds:
    """Length of the windows in which a quarter is simulated, and of their beginnings, which show their first state."""

    length: float
    beginning: float


def are_judged(runs: Runs) -> bool:
    """Return whether quarters of the shortest run are long enough to say anything."""
    return min(len(r) for r in runs.records) >= QUARTERS * _FEWEST_ROWS


def output_error_points(estimate: PointEstimate) -> Array:
    """Return the shared unknowns of an output-error estimate without each quarter of the runs, (QUARTERS, k)."""
    problem, point = estimate.problem, estimate.common_parameters
    quarter, points = _quarters(problem.data), []
    for left_out in range(QUARTERS):
        measured = np.where((quarter == left_out)[:, None], np.nan, problem.data.measured)
        kept = [s for s, (a, b) in enumerate(pairwise(problem.data.offsets)) if np.isfinite(measured[a:b]).any()]
        rest = replace(problem, data=replace(problem.data, measured=measured).selected(np.array(kept)))
        gradient, hessian = rest.normal(point, estimate.optimum.local[kept]).without_local()
        normal = replace(estimate.optimum.normal, gradient=gradient, hessian=hessian)
        points.append(point + step_within((problem.lower - point, problem.upper - point), normal)[0])
    return np.array(points)


def innovation_points(noise: ProcessNoise) -> Array:
    """Return the same of a prediction-error estimate, (QUARTERS, k): likelihoods of samples add up."""
    problem, point, whole = noise.problem, noise.optimum.solution.point, noise.optimum.normal
    exact = problem if problem.steps is not None else replace(
        problem, steps=problem.difference_steps(point, whole.hessian)
    )  # fmt: skip
    parts = replace(exact, is_one_sided=True).part_normals(point, _quarters(problem.runs.data), QUARTERS)
    room, points = (problem.lower - point, problem.upper - point), []
    for gradient, hessian in parts:
        rest = replace(whole, gradient=-gradient, hessian=whole.hessian - hessian)
        points.append((point + step_within(room, rest)[0])[noise.common_indices])
    return np.array(points)


def left_out_errors(problem: OutputError, points: Array, runs: Runs, seconds: WindowSeconds) -> Array:
    """Return logarithms of rms errors of each quarter by the unknowns without it, (QUARTERS, lengths, kinds).

    Lengths: quarters as a whole, and windows where a quarter is longer than one. Kinds: heading and position, or
    without both every channel. Errors below half the resolution of a channel's values count as that; infinite where a
    simulation diverges.
    """
    return np.array([_errors_of_quarter(problem, points[k], runs, seconds, k) for k in range(QUARTERS)])


def kinds_of(outputs: Sequence[str]) -> list[tuple[str, ...]]:
    """Return the groups of channels whose errors are pooled."""
    steered = [tuple(c for c in kind if c in outputs) for kind in (_HEADING, _POSITION)]
    return [kind for kind in steered if kind] or [(c,) for c in outputs]


def _errors_of_quarter(problem: OutputError, point: Array, runs: Runs, seconds: WindowSeconds, k: int) -> Array:
    dt, shortest = runs.records[0].dt, min(len(r) for r in runs.records) // QUARTERS
    steps = max(min(round(seconds.length / dt), shortest // _FEWEST_WINDOWS), 2 * _LEAST_START)
    quarters = [tuple(round(part * len(r) / QUARTERS) for part in (k, k + 1)) for r in runs.records]
    lengths = [[[(a, b)] for a, b in quarters], [_cut(a, b, steps) for a, b in quarters]]
    return np.array([
        _rms_logarithms(problem, point, runs, bounds, max(min(round(seconds.beginning / dt), steps // 2), _LEAST_START))
        for bounds in lengths if any(bounds)
    ])  # fmt: skip


def _cut(first: int, last: int, steps: int) -> list[tuple[int, int]]:
    """Windows of so many steps between two rows; none where only one would fit."""
    count = (last - 1 - first) // steps
    return [(first + n * steps, first + (n + 1) * steps + 1) for n in range(count)] if count > 1 else []


def _rms_logarithms(
    problem: OutputError, point: Array, runs: Runs, bounds: Sequence[Sequence[tuple[int, int]]], beginning: int
) -> Array:
    """Logarithm of the error of each kind over all windows together, the states at their begin searched first."""
    data = segments_between(problem.model, runs.records, problem.data.outputs, bounds, runs.sessions)
    windows = replace(problem, data=data, pinned=point, inflation=None)
    row = np.concatenate([np.arange(n) for n in np.diff(data.offsets)])
    early = replace(windows, data=replace(data, measured=np.where((row < beginning)[:, None], data.measured, np.nan)))
    local = early.measured_initial_states()
    if np.isfinite(early.cost(point, local)):
        local = levenberg_marquardt(early, point, local, evaluations=_EVALUATIONS).local
    error = windows.simulated_outputs(point, local) - data.measured
    floor = 0.5 * np.sqrt(12.0) * problem.data.rounding_noise  # half a step of the values
    logarithms = []
    for kind in kinds_of(data.outputs):
        columns = [data.outputs.index(c) for c in kind]
        is_lost = ~np.isfinite(error[:, columns]) & np.isfinite(data.measured[:, columns])
        square = np.inf if np.any(is_lost) else float(np.sum(np.nanmean(error[:, columns] ** 2, axis=0)))
        logarithms.append(0.5 * np.log(max(square, float(np.sum(floor[columns] ** 2)), np.finfo(float).tiny)))
    return np.array(logarithms)


def _quarters(data: Segments) -> Index:
    """Quarter of its run in which each row lies, (rows,)."""
    quarter = np.zeros(int(data.offsets[-1]), dtype=np.int64)
    for run in range(len(data.runs)):
        segments = data.run_segments(run)
        total = sum(int(data.offsets[s + 1] - data.offsets[s]) - 1 for s in segments) + 1
        before = 0
        for s in segments:  # neighbouring segments share a sample
            a, b = int(data.offsets[s]), int(data.offsets[s + 1])
            quarter[a:b] = QUARTERS * (before + np.arange(b - a)) // total
            before += b - a - 1
    return quarter
