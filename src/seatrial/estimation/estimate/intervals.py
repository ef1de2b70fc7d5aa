"""Which interval is defensible for this fit, and the interval itself."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.values import Array, InputError
from seatrial.estimation.estimate.disturbance_choice import DisturbanceChoice
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.estimate.process_noise import ProcessNoise
from seatrial.estimation.estimate.process_noise_interval import ReportCount, bootstrap_fits, full_jackknife, run_scores
from seatrial.estimation.estimate.settings import WHITE_INFLATION, IntervalMethod
from seatrial.estimation.information.covariance import (
    Interval,
    bootstrap,
    from_information,
    inverse,
    jackknife,
    sandwich,
    with_prior,
)
from seatrial.estimation.problem.output_error import OutputError

# fewest runs for a jackknife, ours
RUNS_FOR_JACKKNIFE = 4
# fits of a bootstrap of standard errors, ours
BOOTSTRAP_FITS = 40
# fewest segments for a sandwich covariance, ours
_BLOCKS_FOR_SANDWICH = 10


@dataclass(frozen=True, eq=False)
class Uncertainty:
    """An interval of all shared unknowns, and what it rests on.

    Attributes:
        leave_one_out: estimates with one run left out each, shape (runs, k); None with too few
            runs for a jackknife.
        one_step_ratio: median over coefficients of the one-step jackknife's standard error over that of full refits;
            None unless both were computed.
        information: inverse of the covariance where that is another one than the criterion's, shape (k, k).
    """

    interval: Interval
    leave_one_out: Array | None = None
    one_step_ratio: float | None = None
    information: Array | None = None


def estimate_uncertainty(
    estimate: PointEstimate,
    inflation: Array,
    kind: IntervalMethod = IntervalMethod.AUTO,
    rng: np.random.Generator | None = None,
    report_progress: ReportCount | None = None,
) -> Uncertainty:
    """Information matrix where residuals are white; else one-step jackknife over runs, or a sandwich over segments.

    With few runs and few segments the information matrix is left, of the effective number of samples (the problem's
    `inflation`). A jackknife of full refits or a bootstrap over runs where `kind` asks for it; `rng` draws the runs.

    Raises:
        InputError: fewer runs than the wanted kind needs.
    """
    problem, hessian = estimate.problem, estimate.optimum.normal.without_local()[1]
    runs = len(problem.data.runs)
    refuse_few_runs(kind, runs)
    scores = run_scores(estimate) if runs >= RUNS_FOR_JACKKNIFE else None
    steps = None if scores is None else estimate.common_parameters + scores.left_out_steps

    def over_runs(interval: Interval) -> Interval:
        known = with_prior(interval, hessian, problem.prior_score_variance(estimate.common_parameters))
        return _offsets_by_information(known, hessian, len(problem.free))

    if kind is IntervalMethod.JACKKNIFE:
        points = full_jackknife(estimate, problem.workers, report_progress)
        full, fast = jackknife(points, ""), jackknife(_required(steps), "")
        share = fast.standard_error / np.maximum(full.standard_error, 1e-300)  # above zero, for a division
        agreement = float(np.median(share[: len(problem.free)]))
        meaning = f"jackknife over {runs} runs, each refitted (one step would give {agreement:.2f} of these errors)"
        return Uncertainty(over_runs(replace(full, meaning=meaning)), points, agreement)
    if kind is IntervalMethod.BOOTSTRAP:
        points = bootstrap_fits(
            estimate, BOOTSTRAP_FITS, rng or np.random.default_rng(0), problem.workers, report_progress
        )
        return Uncertainty(
            over_runs(bootstrap(points, runs, f"bootstrap over {runs} runs, {BOOTSTRAP_FITS} draws")), steps
        )
    if np.max(inflation) <= WHITE_INFLATION:
        return Uncertainty(
            _with_refuted_priors(from_information(hessian), hessian, problem, estimate.common_parameters), steps
        )
    if scores is not None:
        return Uncertainty(over_runs(scores.interval(f"one-step jackknife over {runs} runs")), steps)
    if problem.data.count >= _BLOCKS_FOR_SANDWICH:
        return Uncertainty(
            with_prior(
                sandwich(hessian, _segment_gradients(estimate)),
                hessian,
                problem.prior_score_variance(estimate.common_parameters),
            )
        )
    meaning = "information matrix, correlated samples counted as their effective number"
    interval = replace(from_information(hessian), meaning=meaning)
    return Uncertainty(_with_refuted_priors(interval, hessian, problem, estimate.common_parameters))


def innovations_uncertainty(noise: ProcessNoise, disturbances: DisturbanceChoice, kind: IntervalMethod) -> Uncertainty:
    """Intervals of a prediction-error estimate: its information matrix; runs left out where innovations are not white.

    With too few runs for that, the spread between the disturbance models is added. Full refits and a bootstrap would
    cost a search each and are not offered: one step stands for them, and says so.
    """
    runs = len(noise.output_error.data.runs)
    steps = noise.leave_one_out if runs >= RUNS_FOR_JACKKNIFE else None
    wanted = kind in (IntervalMethod.JACKKNIFE, IntervalMethod.BOOTSTRAP)
    if steps is not None and (wanted or not noise.test.is_white):
        made = noise.interval_over_runs(f"one-step jackknife over {runs} runs, prediction error")
        score = noise.output_error.prior_score_variance(noise.common_parameters)
        widened = with_prior(made, noise.information, score)
        count = len(noise.output_error.free)
        return Uncertainty(_offsets_by_information(widened, noise.information, count), steps)
    interval = _with_refuted_priors(noise.interval, noise.information, noise.output_error, noise.common_parameters)
    return Uncertainty(
        interval
        if noise.test.is_white
        else with_spread(interval, disturbances, noise.output_error.free, noise.common_parameters),
        steps,
    )


def _with_refuted_priors(interval: Interval, hessian: Array, problem: OutputError, point: Array) -> Interval:
    """The interval of an information matrix, which takes priors for right, with what those the records refute add."""
    excess = problem.prior_score_variance(point) - problem.prior_precision(point)
    if not np.any(excess):
        return interval
    bread = inverse(hessian)
    meaning = f"{interval.meaning}, priors that the records contradict counted as wrong by as much"
    return replace(interval, covariance=interval.covariance + bread @ excess @ bread, meaning=meaning)


def with_spread(
    interval: Interval, disturbances: DisturbanceChoice, free: Sequence[str], common_parameters: Array
) -> Interval:
    """The interval with the scatter of the disturbance models about the estimate added to that of its coefficients."""
    k = len(free)
    covariance = interval.covariance.copy()
    covariance[:k, :k] += disturbances.spread(common_parameters[:k])
    return replace(
        interval, covariance=covariance, meaning=f"{interval.meaning}, with the spread of disturbance models"
    )


def refuse_few_runs(kind: IntervalMethod, runs: int) -> None:
    """Raises:
    InputError: a jackknife or bootstrap is required and there are too few runs.
    """
    if kind in (IntervalMethod.JACKKNIFE, IntervalMethod.BOOTSTRAP) and runs < RUNS_FOR_JACKKNIFE:
        raise InputError(
            f"intervals by {kind} leave whole runs out and need at least {RUNS_FOR_JACKKNIFE} training runs, the trial "
            f"has {runs}; add runs, or leave the choice of intervals to the program"
        )


def _required(steps: Array | None) -> Array:
    assert steps is not None
    return steps


def _segment_gradients(estimate: PointEstimate) -> Array:
    """Gradient of every segment with its initial state eliminated, shape (segments, k)."""
    problem = estimate.problem
    blocks = problem.segment_normals(estimate.common_parameters, estimate.optimum.local)
    return np.array(
        [
            problem.assemble(blocks, estimate.common_parameters, np.array([s]), with_prior=False).without_local()[0]
            for s in range(problem.data.count)
        ]
    )


def _offsets_by_information(interval: Interval, hessian: Array, coefficients: int) -> Interval:
    """Errors of a session's own unknowns from the information matrix: a run left out says nothing about its offset."""
    covariance = interval.covariance.copy()
    covariance[coefficients:, :] = covariance[:, coefficients:] = 0.0
    covariance[coefficients:, coefficients:] = inverse(hessian)[coefficients:, coefficients:]
    return replace(interval, covariance=covariance)
