"""Methods against benchmark problems as a campaign: a task is one method on one draw of one problem."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from seatrial.campaigns.work import COEFFICIENT, Row, Work
from seatrial.core.values import InputError
from seatrial.problems import (
    Answer,
    BenchmarkProblem,
    EnteredMethod,
    KnownTruth,
    MethodError,
    Placement,
    ProblemDraw,
    attempt,
    method_named,
    problem_named,
    repeats_itself,
    suits,
)

KIND, ANSWER, TARGET = "benchmark", "answer", "target"
PROBLEM, VERSION, METHOD, DIGEST, SEED = "problem", "version", "method", "method_digest", "seed"
NOT_DETERMINISTIC = "it is not deterministic"
"""How the failure of a method begins whose first run does not repeat itself; none of its runs counts."""
TARGETS = (300.0, 100.0, 30.0, 10.0, 3.0, 1.0)
"""Errors, in the limit of a success, to which evaluations are counted; chosen, two a decade down to the limit."""
_DIGITS = 16  # of a digest in the keys: chosen, no two of a million alike
_HALF_WIDTH_95 = 1.959964
"""Half width of a 95 % interval of the normal distribution, in standard deviations (Abramowitz & Stegun 1964)."""


@dataclass(frozen=True)
class BenchmarkTask:
    """Runs one method on one draw.

    Attributes:
        first_seed: its runs are made twice, to see whether a method repeats itself.
    """

    placement: Placement
    first_seed: int

    def __call__(self, keys: Mapping[str, Any]) -> Sequence[Row]:
        """Return the rows of one answer.

        Raises:
            InputError: another version of the problem or of the method's file, or what the method may not do.
        """
        problem, method, seed = problem_named(keys[PROBLEM]), method_named(keys[METHOD]), int(keys[SEED])
        if problem.version != keys[VERSION] or method.digest[:_DIGITS] != keys[DIGEST]:
            raise InputError(
                f"'{keys[PROBLEM]}' or '{keys[METHOD]}' has changed since the campaign began; run it again"
            )
        draw = _draw(problem.name, seed, self.placement)
        answer = attempt(method, problem, seed, self.placement, draw)
        if seed == self.first_seed and not repeats_itself(method, problem, seed, self.placement, answer):
            raise MethodError(f"{NOT_DETERMINISTIC}: two runs of one seed differ; draw from the generator it is given")
        return [*_answer(answer, draw), *_coefficients(answer, draw)]


def benchmark_work(
    problems: Sequence[BenchmarkProblem], methods: Sequence[EnteredMethod], seeds: range, placement: Placement
) -> Work:
    """Return the work of a benchmark: every method that suits a problem on the same draws.

    More problems, methods and seeds go on with the same store.
    """
    keys = list(_keys(problems, methods, seeds, placement))
    description = {"kind": KIND, "placement": placement.value, "first_seed": seeds.start}
    question = f"How good are {len(methods)} methods on {len(problems)} problems?"
    return Work(description, keys, BenchmarkTask(placement, seeds.start), question=question)


def _keys(
    problems: Sequence[BenchmarkProblem], methods: Sequence[EnteredMethod], seeds: range, placement: Placement
) -> Iterator[dict[str, Any]]:
    """Keys, all methods on a draw one after the other, so that a process makes it once."""
    for problem in problems:
        draw = _draw(problem.name, seeds.start, placement)
        suitable = [m for m in methods if not m.is_built_in or suits(m, problem, draw)]
        for seed in seeds:
            for m in suitable:
                yield {PROBLEM: problem.name, VERSION: problem.version, METHOD: m.name, DIGEST: m.digest[:_DIGITS],
                       SEED: seed}  # fmt: skip


@lru_cache(maxsize=2)  # draws: that of the last task, and of the one before
def _draw(problem: str, seed: int, placement: Placement) -> ProblemDraw:
    """The draw of a seed, kept for the methods that follow."""
    return problem_named(problem).draw(seed, placement)


def _answer(answer: Answer, draw: ProblemDraw) -> Iterator[Row]:
    """One row of the answer, then one for each target that the search has met."""
    stick = draw.yardstick
    error = stick.error(answer.values)
    is_outside = bool(np.any((answer.values < draw.box.lower) | (answer.values > draw.box.upper)))
    row: Row = {
        "row": ANSWER, "error": error, "is_success": error <= stick.success_limit, "evaluations": answer.evaluations,
        "is_budget_spent": answer.is_budget_spent, "is_outside": is_outside,
    }  # fmt: skip
    yield row
    reached = [(count, stick.error(point)) for count, point in answer.trace]
    for target in TARGETS:
        counts = [count for count, one in reached if one <= target * stick.success_limit]
        if counts:
            yield {"row": TARGET, "name": f"{target:g}", "evaluations": counts[0]}
        elif error <= target * stick.success_limit:
            yield {"row": TARGET, "name": f"{target:g}", "evaluations": answer.evaluations}


def _coefficients(answer: Answer, draw: ProblemDraw) -> Iterator[Row]:
    """One row for each unknown, as campaigns of fits have them; none where nobody knows the truth."""
    stick = draw.yardstick
    if not isinstance(stick, KnownTruth):
        return
    deviations = None if answer.covariance is None else np.sqrt(np.diag(answer.covariance))
    for k, (name, unit) in enumerate(zip(draw.unknowns, draw.units, strict=True)):
        value, deviation = float(answer.values[k]), None if deviations is None else float(deviations[k])
        half = None if deviation is None else _HALF_WIDTH_95 * deviation
        yield {
            "row": COEFFICIENT, "name": name, "unit": unit, "estimate": value, "standard_error": deviation,
            "lower": None if half is None else value - half, "upper": None if half is None else value + half,
            "truth": float(stick.truth[k]), "bound": None if stick.bound is None else float(stick.bound[k]),
        }  # fmt: skip
