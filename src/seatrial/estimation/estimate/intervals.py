"""Which interval is defensible for this fit, and the interval itself."""

from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.estimation.estimate.estimate import Estimate
from seatrial.estimation.estimate.process_noise import ProcessNoise
from seatrial.estimation.estimate.replicates import Counted, drawn, left_out, stepped
from seatrial.estimation.estimate.settings import WHITE_INFLATION, Intervals
from seatrial.estimation.information.covariance import (
    Interval,
    bootstrap,
    from_information,
    inverse,
    jackknife,
    sandwich,
    with_prior,
)

RUNS_FOR_JACKKNIFE = 4
BOOTSTRAPS = 40
_BLOCKS_FOR_SANDWICH = 10


@dataclass(frozen=True, eq=False)
class Uncertainty:
    """An interval of all shared unknowns, and what it rests on.

    Attributes:
        left_out: estimates with one run left out each, shape (runs, k); None with fewer runs than a jackknife needs.
        agreement: median over coefficients of the one-step jackknife's standard error over that of full refits; None
            unless both were computed.
        information: inverse of the covariance where that is another one than the criterion's, shape (k, k).
    """

    interval: Interval
    left_out: Array | None = None
    agreement: float | None = None
    information: Array | None = None


def intervals(
    made: Estimate,
    inflation: Array,
    kind: Intervals = Intervals.AUTO,
    rng: np.random.Generator | None = None,
    progress: Counted | None = None,
) -> Uncertainty:
    """Information matrix where residuals are white; else one-step jackknife over runs, or a sandwich over segments.

    With few runs and few segments the information matrix is left, of the effective number of samples (the problem's
    `inflation`). A jackknife of full refits or a bootstrap over runs where `kind` asks for it; `rng` draws the runs.

    Raises:
        InputError: fewer runs than the wanted kind needs.
    """
    problem, hessian = made.problem, made.optimum.normal.reduced()[1]
    runs = len(problem.data.runs)
    refuse_few_runs(kind, runs)
    steps = stepped(made) if runs >= RUNS_FOR_JACKKNIFE else None

    def over_runs(interval: Interval) -> Interval:
        known = with_prior(interval, hessian, problem.known_precision(made.shared))
        return _offsets_by_information(known, hessian, len(problem.free))

    if kind is Intervals.JACKKNIFE:
        points = left_out(made, problem.workers, progress)
        full, fast = jackknife(points, ""), jackknife(_demanded(steps), "")
        share = fast.standard_error / np.maximum(full.standard_error, 1e-300)
        agreement = float(np.median(share[: len(problem.free)]))
        meaning = f"jackknife over {runs} runs, each refitted (one step would give {agreement:.2f} of these errors)"
        return Uncertainty(over_runs(replace(full, meaning=meaning)), points, agreement)
    if kind is Intervals.BOOTSTRAP:
        points = drawn(made, BOOTSTRAPS, rng or np.random.default_rng(0), problem.workers, progress)
        return Uncertainty(over_runs(bootstrap(points, runs, f"bootstrap over {runs} runs, {BOOTSTRAPS} draws")), steps)
    if np.max(inflation) <= WHITE_INFLATION:
        return Uncertainty(from_information(hessian), steps)
    if steps is not None:
        return Uncertainty(over_runs(jackknife(steps, f"one-step jackknife over {runs} runs")), steps)
    if problem.data.count >= _BLOCKS_FOR_SANDWICH:
        return Uncertainty(with_prior(sandwich(hessian, _scores(made)), hessian, problem.known_precision(made.shared)))
    meaning = "information matrix, correlated samples counted as their effective number"
    return Uncertainty(replace(from_information(hessian), meaning=meaning))


def of_innovations(noise: ProcessNoise, kind: Intervals) -> Uncertainty:
    """Intervals of a prediction-error estimate: its information matrix; runs left out where innovations are not white.

    Full refits and a bootstrap would cost a search each and are not offered: one step stands for them, and says so.
    """
    runs = len(noise.runs.data.runs)
    steps = noise.left_out if runs >= RUNS_FOR_JACKKNIFE else None
    wanted = kind in (Intervals.JACKKNIFE, Intervals.BOOTSTRAP)
    if steps is not None and (wanted or not noise.gate.is_white):
        made = jackknife(steps, f"one-step jackknife over {runs} runs, prediction error")
        precision = noise.runs.known_precision(noise.shared)
        widened = with_prior(made, noise.information, precision)
        count = len(noise.runs.free)
        return Uncertainty(_offsets_by_information(widened, noise.information, count), steps)
    return Uncertainty(noise.interval, steps)


def refuse_few_runs(kind: Intervals, runs: int) -> None:
    """Raises:
    InputError: a jackknife or bootstrap was asked for and there are too few runs.
    """
    if kind in (Intervals.JACKKNIFE, Intervals.BOOTSTRAP) and runs < RUNS_FOR_JACKKNIFE:
        raise InputError(
            f"intervals by {kind} leave whole runs out and need at least {RUNS_FOR_JACKKNIFE} training runs, the trial "
            f"has {runs}; add runs, or leave the choice of intervals to the program"
        )


def _demanded(steps: Array | None) -> Array:
    assert steps is not None
    return steps


def _scores(made: Estimate) -> Array:
    """Gradient of every segment with its initial state eliminated, shape (segments, k)."""
    problem = made.problem
    blocks = problem.blocks(made.shared, made.optimum.local)
    return np.array(
        [
            problem.assembled(blocks, made.shared, np.array([s]), with_prior=False).reduced()[0]
            for s in range(problem.data.count)
        ]
    )


def _offsets_by_information(interval: Interval, hessian: Array, coefficients: int) -> Interval:
    """Errors of a session's own unknowns from the information matrix: a run left out says nothing about its offset."""
    covariance = interval.covariance.copy()
    covariance[coefficients:, :] = covariance[:, coefficients:] = 0.0
    covariance[coefficients:, coefficients:] = inverse(hessian)[coefficients:, coefficients:]
    return replace(interval, covariance=covariance)
