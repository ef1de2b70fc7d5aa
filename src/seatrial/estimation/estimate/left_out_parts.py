"""How far off a criterion's estimate is on what it did not see: training runs, or quarters of few, left out in turn.

What an estimate would be without a part follows by one Newton step (Pregibon 1981, Ann. Stat. 9, 705). The part is then
simulated from its recorded inputs, as a whole and in windows, each from a state that its first seconds show.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from seatrial.core.values import Array, Index
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.intervals import RUNS_FOR_JACKKNIFE
from seatrial.estimation.estimate.newton_refinement import step_within
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.estimate.process_noise import ProcessNoise
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import Segments, segments_between
from seatrial.numerics.optimise import levenberg_marquardt

_QUARTERS = 4  # parts of each run that are left out in turn where runs are few; chosen
_MOST_GROUPS = 8  # groups of whole runs that are left out in turn, at most; chosen
_FEWEST_ROWS = 8  # rows of the shortest part that is judged; chosen
_FEWEST_WINDOWS = 4  # of the shortest part; chosen
_LEAST_START = 4  # rows that show where a window begins, at least; chosen
_EVALUATIONS = 40  # of the search for states at which windows begin; chosen: a few are enough
_HEADING, _POSITION = ("psi",), ("x0", "y0")


@dataclass(frozen=True)
class WindowSeconds:
    """Length of the windows in which a quarter is simulated, and of their beginnings, which show their first state."""

    length: float
    beginning: float


@dataclass(frozen=True)
class Parts:
    """What is left out in turn: `count` groups of whole runs, every so many-th one, or so many pieces of every run."""

    count: int
    are_runs: bool

    @classmethod
    def for_runs(cls, runs: Runs) -> "Parts | None":
        """Return whole runs where they are enough for a jackknife, else quarters; None where these say nothing."""
        if len(runs) >= RUNS_FOR_JACKKNIFE:
            return cls(min(len(runs), _MOST_GROUPS), True)
        return cls(_QUARTERS, False) if min(map(len, runs.records)) >= _QUARTERS * _FEWEST_ROWS else None

    def __str__(self) -> str:
        return "runs left out" if self.are_runs else "quarters of the runs left out"

    def rows(self, runs: Runs, part: int) -> list[tuple[int, int]]:
        """Return of each run the first row of a part and the row behind its last; the same where it has none of it."""
        if self.are_runs:
            return [(0, len(r) if i % self.count == part else 0) for i, r in enumerate(runs.records)]
        edges = (part / self.count, (part + 1) / self.count)
        return [(round(edges[0] * len(r)), round(edges[1] * len(r))) for r in runs.records]

    def of_rows(self, data: Segments) -> Index:
        """Return the part to which each row of the segments belongs, (rows,)."""
        if self.are_runs:
            return np.repeat(data.run % self.count, np.diff(data.offsets))
        parts = np.zeros(int(data.offsets[-1]), dtype=np.int64)
        for run in range(len(data.runs)):
            segments, before = data.run_segments(run), 0
            total = sum(int(data.offsets[s + 1] - data.offsets[s]) - 1 for s in segments) + 1
            for s in segments:  # neighbouring segments share a sample
                a, b = int(data.offsets[s]), int(data.offsets[s + 1])
                parts[a:b] = self.count * (before + np.arange(b - a)) // total
                before += b - a - 1
        return parts


def output_error_points(estimate: PointEstimate, parts: Parts) -> Array:
    """Return the shared unknowns of an output-error estimate without each part, (parts, k)."""
    problem, point = estimate.problem, estimate.common_parameters
    of_rows, points = parts.of_rows(problem.data), []
    for left_out in range(parts.count):
        measured = np.where((of_rows == left_out)[:, None], np.nan, problem.data.measured)
        kept = [s for s, (a, b) in enumerate(pairwise(problem.data.offsets)) if np.isfinite(measured[a:b]).any()]
        rest = replace(problem, data=replace(problem.data, measured=measured).selected(np.array(kept)))
        gradient, hessian = rest.normal(point, estimate.optimum.local[kept]).without_local()
        normal = replace(estimate.optimum.normal, gradient=gradient, hessian=hessian)
        points.append(point + step_within((problem.lower - point, problem.upper - point), normal)[0])
    return np.array(points)


def innovation_points(noise: ProcessNoise, parts: Parts) -> Array:
    """Return the same of a prediction-error estimate, (parts, k): likelihoods of samples add up."""
    problem, point, whole = noise.problem, noise.optimum.solution.point, noise.optimum.normal
    exact = problem if problem.steps is not None else replace(
        problem, steps=problem.difference_steps(point, whole.hessian)
    )  # fmt: skip
    of_rows = parts.of_rows(problem.runs.data)
    normals = replace(exact, is_one_sided=True).part_normals(point, of_rows, parts.count)
    room, points = (problem.lower - point, problem.upper - point), []
    for gradient, hessian in normals:
        rest = replace(whole, gradient=-gradient, hessian=whole.hessian - hessian)
        points.append((point + step_within(room, rest)[0])[noise.common_indices])
    return np.array(points)


def left_out_errors(
    problem: OutputError, points: Array, runs: Runs, parts: Parts, seconds: WindowSeconds
) -> Array:  # fmt: skip
    """Return logarithms of rms errors of each part by the unknowns without it, (parts, lengths, kinds).

    Lengths: parts as a whole, and windows, where these are too long the whole again. Kinds: heading and position, or
    without both every channel; NaN where a part has no sample of one. Errors below half the resolution of a channel's
    values count as that, errors beyond the motion itself as it: how far a prediction fails, one step from the estimate,
    says nothing more.
    """
    return np.array([_errors_of_part(problem, points[k], runs, seconds, parts, k) for k in range(parts.count)])


def kinds_of(outputs: Sequence[str]) -> list[tuple[str, ...]]:
    """Return the groups of channels whose errors are pooled."""
    steered = [tuple(c for c in kind if c in outputs) for kind in (_HEADING, _POSITION)]
    return [kind for kind in steered if kind] or [(c,) for c in outputs]


def _errors_of_part(
    problem: OutputError, point: Array, runs: Runs, seconds: WindowSeconds, parts: Parts, k: int
) -> Array:  # fmt: skip
    dt, rows = runs.records[0].dt, parts.rows(runs, k)
    shortest = min(b - a for a, b in rows if b > a)
    steps = max(min(round(seconds.length / dt), shortest // _FEWEST_WINDOWS), 2 * _LEAST_START)
    whole, windows = [[(a, b)] if b > a else [] for a, b in rows], [_cut(a, b, steps) for a, b in rows]
    return np.array([
        _rms_logarithms(problem, point, runs, bounds, max(min(round(seconds.beginning / dt), steps // 2), _LEAST_START))
        for bounds in (whole, windows if any(windows) else whole)
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
        counts = np.isfinite(data.measured[:, columns]).sum(axis=0)
        if not np.all(counts):
            logarithms.append(np.nan)
            continue
        motion = float(np.sum(np.nanvar(data.measured[:, columns], axis=0)))
        square = motion if np.any(is_lost) else float(np.sum(np.nansum(error[:, columns] ** 2, axis=0) / counts))
        least = max(float(np.sum(floor[columns] ** 2)), np.finfo(float).tiny)
        logarithms.append(0.5 * np.log(max(min(square, motion), least)))
    return np.array(logarithms)
