"""One method against one draw of one problem: its answer, checked; what it may not do is one sentence."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.problems.method import EnteredMethod, MethodError
from seatrial.problems.problem import (
    BenchmarkProblem,
    BudgetSpent,
    Estimate,
    EvaluationMeter,
    Placement,
    PosedProblem,
    ProblemDraw,
    posed,
)

_METHOD_STREAM = 21
"""First number of the seed of every method's generator: chosen, different from that of draws."""


@dataclass(frozen=True, eq=False)
class Answer:
    """What a method answered.

    Attributes:
        values: (d,); covariance: (d, d), None where it states none.
        evaluations: spent; is_budget_spent: whether the budget ended it.
        trace: evaluations and the best point then (d,), a row for each improvement.
    """

    values: Array
    covariance: Array | None
    evaluations: int
    is_budget_spent: bool
    trace: Sequence[tuple[int, Array]]

    def bits(self) -> bytes:
        """Return what two runs of one seed must have in common."""
        covariance = b"" if self.covariance is None else self.covariance.tobytes()
        return self.values.tobytes() + covariance + str(self.evaluations).encode()


def attempt(
    method: EnteredMethod, problem: BenchmarkProblem, seed: int, placement: Placement = Placement.SHIFTED,
    draw: ProblemDraw | None = None,
) -> Answer:  # fmt: skip
    """Return the answer of a method to the draw of a seed.

    Args:
        draw: that of the seed, where it is at hand.

    Raises:
        MethodError: the method raises, leaves the box, returns what is no answer, or changes what it was given.
    """
    draw = draw or problem.draw(seed, placement)
    meter = EvaluationMeter(problem.budget)
    given = posed(problem, draw, meter)
    before = _contents(given)
    estimate = _estimate(method, given, np.random.default_rng([_METHOD_STREAM, seed]))
    if _contents(given) != before:
        raise MethodError("it changes what it was given; work on a copy")
    return Answer(estimate.values, estimate.covariance, meter.count, meter.is_spent, tuple(meter.trace))


def suits(method: EnteredMethod, problem: BenchmarkProblem, draw: ProblemDraw) -> bool:
    """Return whether a method can be entered against a problem."""
    return method.suits(posed(problem, draw, EvaluationMeter(problem.budget)))


def repeats_itself(
    method: EnteredMethod, problem: BenchmarkProblem, seed: int, placement: Placement, first: Answer
) -> bool:  # fmt: skip
    """Return whether a second run of the same seed gives the same bits."""
    return attempt(method, problem, seed, placement).bits() == first.bits()


def _estimate(method: EnteredMethod, given: PosedProblem, rng: np.random.Generator) -> Estimate:
    """Run a method and check what it returns."""
    try:
        with np.errstate(all="ignore"):  # overflows of a search are its own matter: its answer is checked
            return _checked(method.estimate(given, rng), given)
    except BudgetSpent:
        if not given.best_points:
            raise MethodError("its budget is spent before its first finite fitness; start inside the box") from None
        return Estimate(given.best_points[-1][1])
    except MethodError:
        raise
    except Exception as error:
        text = " ".join(str(error).split())
        if isinstance(error, ValueError) and "read-only" in text:
            raise MethodError("it changes what it was given (an array is read-only); work on a copy") from error
        kind = "" if isinstance(error, InputError) else f"{type(error).__name__}: "
        raise MethodError(f"it raises {kind}{text}") from error


def _checked(result: object, given: PosedProblem) -> Estimate:
    """Return the answer of a method in one form.

    Raises:
        MethodError: values or covariance of another shape or not finite, or variances that are not positive.
    """
    size = given.box.size
    if isinstance(result, Estimate):
        values, covariance = result.values, result.covariance
    elif isinstance(result, tuple) and len(result) == 2:
        values, covariance = result
    else:
        values, covariance = result, None
    array = _numbers(values, "values")
    if array.shape != (size,):
        raise MethodError(f"it answers values of shape {array.shape}, not ({size},)")
    if covariance is None:
        return Estimate(array)
    matrix = _numbers(covariance, "a covariance")
    if matrix.shape != (size, size):
        raise MethodError(f"it answers a covariance of shape {matrix.shape}, not ({size}, {size})")
    if not np.all(np.diag(matrix) > 0.0):
        raise MethodError("it answers a covariance whose variances are not positive; answer None where it has none")
    return Estimate(array, matrix)


def _numbers(value: object, noun: str) -> Array:
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise MethodError(f"it answers {noun} that are no numbers: {str(value)[:60]}") from None  # 60 letters: chosen
    if not np.all(np.isfinite(array)):
        raise MethodError(f"it answers {noun} that are not finite")
    return array


def _contents(given: PosedProblem) -> bytes:
    """Return the bytes of all arrays that a method is given, records included."""
    arrays = [given.box.lower, given.box.upper, given.start]
    if given.trial is not None:
        records = [run.raw_record() for run in given.trial.runs]
        arrays += [record[symbol] for record in records for symbol in record.channels]
    return b"".join(array.tobytes() for array in arrays)
