"""Output error with the noise re-estimated: the estimator behind `fit`."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from seatrial.core.text.words import counted
from seatrial.core.values import Array, InputError, ProgressReporter
from seatrial.estimation.estimate.integration_steps import sufficient_steps_of_optimum
from seatrial.estimation.estimate.settings import WHITE_INFLATION
from seatrial.estimation.information.autocorrelation import autocorrelation, variance_inflation
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.population import SessionPopulation
from seatrial.numerics.optimise import Optimum, Status, levenberg_marquardt

# promised decrease of the cost at which a search ends, ours
_NEGLIGIBLE = 1e-8
# promised decrease that suffices where the evaluations run out: the point then lies within 0.014 standard errors
# (root of twice the promise) of the model's minimum, ours
_SUFFICIENT = 1e-4
# rounds of noise estimates at most; each brings the noise some 40 % nearer where residuals are coloured, ours
_ROUNDS = 25
# of a search before noise levels are estimated anew, ours
_FEW_EVALUATIONS = 12
COLOUR_ROUNDS = 2
"""Rounds in which effective numbers of samples follow the residuals, before they are held; chosen: the first has the
residuals of the start, the second those of a model that nearly fits (benchmarks/estimation_folds.py)."""
# of a channel, over its largest value
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class PointEstimate:
    """An optimum of an output-error problem; `is_settled`: its noise levels agree with its residuals."""

    problem: OutputError
    optimum: Optimum
    is_settled: bool = True

    @property
    def common_parameters(self) -> Array:
        """Shared unknowns at the optimum."""
        return self.optimum.solution.point

    @property
    def session_offsets(self) -> Array:
        """What each session has of its own, (sessions, k)."""
        problem = self.problem
        own = self.common_parameters[len(problem.free) :]
        return own.reshape(len(problem.data.sessions), problem.unknowns_per_session)

    @cached_property
    def population(self) -> SessionPopulation:
        """How the sessions' offsets are distributed, by the estimate's own normal equations."""
        problem, count = self.problem, len(self.problem.free)
        assumed = problem.population or problem.declared_population
        if not problem.unknowns_per_session:
            return assumed
        hessian = self.optimum.normal.without_local()[1]
        by_free = np.linalg.lstsq(hessian[:count, :count], hessian[:count, count:], rcond=None)[0]
        precision = hessian[count:, count:] - hessian[count:, :count] @ by_free
        is_stated = [True] * len(problem.session_parameters) + [n.is_stated for n in problem.nuisances]
        if not all(is_stated):  # nothing is declared of their size, so it is the estimated one
            squares = self.session_offsets.ravel() ** 2 + np.diag(inverse(precision))
            sizes = np.sqrt(squares.reshape(-1, len(is_stated)).mean(axis=0))
            declared = [
                prior if stated else replace(prior, standard_deviation=float(size))
                for prior, stated, size in zip(assumed.declared, is_stated, sizes, strict=True)
            ]
            assumed = replace(assumed, declared=tuple(declared))
        return assumed.fitted(self.session_offsets, precision, problem.session_covariates)

    def residuals(self) -> Array:
        """Simulated minus measured, SI, shape (rows, ny); NaN where nothing was measured."""
        return self.problem.simulated_outputs(self.common_parameters, self.optimum.local) - self.problem.data.measured


def residual_spread(problem: OutputError, residuals: Array) -> Array:
    """Noise of each channel from its residuals, with the unknowns' degrees of freedom, shape (ny,).

    With a robust loss the spread is that of the bulk (median absolute deviation), otherwise the rms. It never falls
    below `rounding_level`.
    """
    freedom = degrees_of_freedom_share(problem)
    if np.isfinite(problem.huber):
        # normal standard deviation over median absolute deviation
        spread = 1.4826 * np.nanmedian(np.abs(residuals), axis=0)
    else:
        spread = np.sqrt(np.nanmean(residuals**2, axis=0))
    return np.maximum(spread / np.sqrt(freedom), rounding_level(problem))


def degrees_of_freedom_share(problem: OutputError) -> float:
    """Return the share of the measured samples that the unknowns leave free."""
    samples = int(np.isfinite(problem.data.measured).sum())
    unknowns = problem.size + problem.data.count * len(problem.starts)
    return max(1.0 - unknowns / max(samples, 1), 0.1)  # a tenth at least; chosen


def rounding_level(problem: OutputError) -> Array:
    """Noise below which a channel counts as free of noise, 1e-9 of its largest value, shape (ny,), SI."""
    # a channel that is zero throughout, SI; chosen
    return _ROUNDING * np.maximum(np.nanmax(np.abs(problem.data.measured), axis=0), 1e-6)


def fit_output_error(
    problem: OutputError,
    common_parameters: Array,
    initial_states: Array,
    known_noise: Mapping[str, float],
    *,
    rounds: int = _ROUNDS,
    colour_rounds: int = COLOUR_ROUNDS,
    evaluations: int = 60,  # of the residuals, at most; chosen
    report_progress: ProgressReporter | None = None,
) -> PointEstimate:
    """Alternate short searches with estimates of the noise and the sessions' population until both settle.

    Then search to the end. The evaluations of all of them are counted.

    Coloured channels count as their effective number of samples throughout (`OutputError.inflation`). These follow the
    residuals in the first `colour_rounds` rounds and are held after them, 0: as the problem has them. All further
    rounds then decrease one objective, the likelihood with the noise concentrated out (`ConcentratedLikelihood`):
    followed throughout, a worse fit is more correlated, counts less against the priors, and fits worse still.
    """
    stated_noise = np.array([known_noise.get(o, np.nan) for o in problem.data.outputs])
    problem = replace(problem, noise=np.where(np.isfinite(stated_noise), stated_noise, problem.noise))
    estimate = _search(problem, common_parameters, initial_states, min(_FEW_EVALUATIONS, evaluations), report_progress)
    spent, settled = estimate.optimum.solution.evaluations, False
    if estimate.optimum.solution.status is Status.FAILED:
        return estimate
    substeps = problem.substeps  # at a start far off more than near the optimum
    if substeps > 1:
        substeps = sufficient_steps_of_optimum(problem, estimate.optimum, 1)
    for k in range(rounds):
        noise = np.where(
            np.isfinite(stated_noise), stated_noise, residual_spread(estimate.problem, estimate.residuals())
        )
        again = replace(
            problem,
            noise=noise,
            population=estimate.population if problem.unknowns_per_session else None,
            inflation=(
                effective_inflation(residual_correlation(estimate.problem, estimate.residuals())[1])
                if k < colour_rounds
                else estimate.problem.inflation
            ),
            substeps=substeps,
        )
        settled = _is_settled(estimate.problem, again)
        if settled or k == rounds - 1:
            substeps = sufficient_steps_of_optimum(estimate.problem, estimate.optimum, substeps)
            again = replace(again, substeps=substeps)
            settled = settled and substeps == estimate.problem.substeps
        estimate = _search(
            again,
            estimate.common_parameters,
            estimate.optimum.local,
            evaluations if settled or k == rounds - 1 else _FEW_EVALUATIONS,
            report_progress,
        )
        spent += estimate.optimum.solution.evaluations
        if settled:
            break
    solution = replace(estimate.optimum.solution, evaluations=spent)
    return replace(estimate, optimum=replace(estimate.optimum, solution=solution), is_settled=settled)


def effective_inflation(inflation: Array) -> Array | None:
    """Return the inflation of the channels that are not white, (ny,); None where all are."""
    coloured = inflation > WHITE_INFLATION
    return np.where(coloured, inflation, 1.0) if np.any(coloured) else None


def _is_settled(before: OutputError, after: OutputError) -> bool:
    """Noise within 2 %, effective numbers of samples and deviations between sessions within 10 %."""
    ratio = np.log(after.noise / before.noise)
    ones = np.ones(len(before.noise))
    colours = [ones if p.inflation is None else p.inflation for p in (before, after)]
    deviations = [(p.population or p.declared_population).deviation for p in (before, after)]
    slow = np.concatenate([np.log(colours[1] / colours[0]), np.log(deviations[1] / deviations[0])])
    # noise settled to 2 %, its colour and what differs between sessions to 10 %; chosen
    return bool(np.max(np.abs(ratio)) < 0.02 and np.max(np.abs(slow)) < 0.1)


def refuse_unstarted(estimate: PointEstimate) -> None:
    """Accept an estimate whose search could begin.

    Raises:
        InputError: the model diverges on the records with the values from which it was to begin; which run, and when.
    """
    if estimate.optimum.solution.status is not Status.FAILED:
        return
    problem = estimate.problem
    data, y = problem.data, problem.simulated_outputs(estimate.common_parameters, estimate.optimum.local)
    row = int(np.argmax(~np.isfinite(y).all(axis=1)))
    segment = int(np.searchsorted(data.offsets, row, side="right")) - 1
    seconds = data.dt * (row - int(data.offsets[segment]))
    raise InputError(
        f"the search cannot begin: with the start values, model '{problem.model.name}' diverges in run "
        f"'{data.runs[data.run[segment]]}', {seconds:.3g} s after the start of a segment of it; give start values "
        "nearer the craft's under [model.start], priors or other fixed values, or leave that run out"
    )


def _search(
    problem: OutputError,
    common_parameters: Array,
    initial_states: Array,
    evaluations: int,
    report_progress: ProgressReporter | None,
) -> PointEstimate:
    def report(count: int, cost: float) -> None:
        if report_progress:
            segments = counted(problem.data.count, "segment")
            report_progress(f"output error, {segments}: evaluation {count}, cost {cost:.6g}")

    optimum = levenberg_marquardt(
        problem,
        common_parameters,
        initial_states,
        negligible=_NEGLIGIBLE,
        sufficient=_SUFFICIENT,
        evaluations=evaluations,
        report_progress=report,
    )
    return PointEstimate(problem, optimum)


def split_segments(problem: OutputError, column: Array) -> list[Array]:
    """A column of rows split into its segments."""
    return [column[a:b] for a, b in pairwise(problem.data.offsets)]


def residual_correlation(problem: OutputError, residuals: Array) -> tuple[list[Array], Array]:
    """Autocorrelation of each channel's residuals within segments, and its variance inflation, shape (ny,).

    Residuals of the size of rounding count as white (inflation 1): their colour says nothing about the ship.
    """
    longest = int(np.max(np.diff(problem.data.offsets)))
    lags = min(longest // 2, 400)  # longest correlation considered [samples]; chosen
    rho = [autocorrelation(split_segments(problem, residuals[:, i]), lags) for i in range(residuals.shape[1])]
    silent = problem.noise <= rounding_level(problem)
    return rho, np.where(silent, 1.0, [variance_inflation(r) for r in rho])
