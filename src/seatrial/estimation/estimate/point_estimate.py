"""Output error with the noise re-estimated: the estimator behind `fit`, and the steps by which it integrates."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.text.words import counted
from seatrial.core.values import Array, Finding, InputError, ProgressReporter, Severity
from seatrial.estimation.estimate.settings import WHITE_INFLATION
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.information.whiteness import autocorrelation, variance_inflation
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.population import SessionPopulation
from seatrial.estimation.problem.prediction_error import PredictionError
from seatrial.estimation.problem.static_forces import StaticForces
from seatrial.numerics.optimise import NormalEquations, Optimum, Status, bounded_step, levenberg_marquardt
from seatrial.physics.simulate.batch import MOST_SUBSTEPS, SIMULATION_ERROR, error_over_range, sufficient_substeps

# Runge-Kutta steps in a sample of an output-error problem: none so long that its error shows beside the noise.

_START_ERROR = 0.1
"""Error of the outputs with which a search may begin (rms, share of the noise); chosen."""

_OPTIMUM_ERROR = 0.1
"""What halving the step may move a coefficient at the optimum (share of its standard error); chosen."""


def with_steps_of_start(problem: OutputError, shared: Array, local: Array) -> OutputError:
    """Return the problem with enough steps in a sample for a search that begins at a point."""
    if problem.model.is_affine:
        return problem

    def excess(coarse: Array, fine: Array) -> float:
        error = np.sqrt(np.mean((fine - coarse) ** 2, axis=0)) if len(fine) else np.zeros(1)
        return float(np.max(error / np.maximum(_START_ERROR * problem.noise, 1e-300)))  # above zero, for a division

    simulate = _simulation(problem, shared, local)
    return replace(problem, substeps=sufficient_substeps(simulate, excess, problem.substeps))


def _simulation(problem: OutputError, shared: Array, local: Array) -> Callable[[int], Array]:
    """Return the outputs at a point, (rows, ny), by the number of steps in a sample."""

    def simulate(count: int) -> Array:
        with np.errstate(all="ignore"):
            return replace(problem, substeps=count).simulated_outputs(shared, local)

    return simulate


def sufficient_steps_of_optimum(problem: OutputError, optimum: Optimum, least: int) -> int:
    """Return so many steps in a sample, `least` or more, that halving them leaves a problem's optimum where it is.

    Records of less noise than a simulation errs by, which a simulation wrote, are followed as closely as that.
    """
    shared, count = optimum.solution.point, least
    if problem.model.is_affine or not np.isfinite(optimum.normal.cost):
        return problem.substeps

    def normal(substeps: int) -> NormalEquations:
        with np.errstate(all="ignore"):
            return replace(problem, substeps=substeps).normal(shared, optimum.local)

    if np.all(problem.noise <= SIMULATION_ERROR * np.nanstd(problem.data.measured, axis=0)):
        return sufficient_substeps(_simulation(problem, shared, optimum.local), error_over_range, least)
    before = optimum.normal if count == problem.substeps else normal(count)
    while 2 * count <= MOST_SUBSTEPS:
        after = normal(2 * count)
        is_finite = np.isfinite(before.cost) and np.isfinite(after.cost)
        if is_finite and _is_same_optimum(problem, shared, before, after, len(problem.free)):
            return count
        count, before = 2 * count, after
    return count if np.isfinite(before.cost) else problem.substeps


def sufficient_steps_of_filter(problem: PredictionError, optimum: Optimum) -> int:
    """Return so many steps in a sample, the problem's own or more, that halving them leaves its optimum where it is."""
    shared, count = optimum.solution.point, problem.runs.substeps
    if problem.runs.model.is_affine or not np.isfinite(optimum.normal.cost):
        return count

    def normal(substeps: int) -> NormalEquations:
        with np.errstate(all="ignore"):
            return filter_with_steps(problem, substeps).normal(shared, optimum.local)

    before = normal(count)
    while 2 * count <= MOST_SUBSTEPS:
        after = normal(2 * count)
        if not np.isfinite(after.cost) or _is_same_optimum(problem, shared, before, after, len(problem.runs.free)):
            break
        count, before = 2 * count, after
    return count


def filter_with_steps(problem: PredictionError, substeps: int) -> PredictionError:
    """Return the problem with so many steps in a sample."""
    return replace(problem, runs=replace(problem.runs, substeps=substeps), steps=None)


def _is_same_optimum(
    problem: OutputError | PredictionError, shared: Array, before: NormalEquations, after: NormalEquations, count: int
) -> bool:  # fmt: skip
    """Whether a Gauss-Newton step for the change of the gradient moves none of `count` coefficients by too much."""
    gradient, hessian = after.without_local()
    reduced = replace(after, gradient=gradient - before.without_local()[0], hessian=hessian)
    step = bounded_step(reduced, problem.lower - shared, problem.upper - shared)[:count]
    error = np.sqrt(np.maximum(np.diagonal(inverse(hessian)), 0.0))[: len(step)]
    return bool(np.all(np.abs(step) <= _OPTIMUM_ERROR * error))


def integration_text(problem: OutputError) -> str:
    """Return how many steps a sample takes and what they cost; empty of one."""
    count = problem.substeps
    if count == 1:
        return ""
    return (
        f"the craft moves within a sample of {problem.data.dt:.3g} s: {count} Runge-Kutta steps in each, which take up "
        f"to {count} times as long as one"
    )


# Output error with the noise re-estimated: the estimator behind `fit`.

# promised decrease of the cost at which a search ends, ours
_NEGLIGIBLE = 1e-8
NEAR_ENOUGH = 0.02
"""Decrease that a search may leave which gets no further: its point lies within 0.2 standard errors (root of twice
that) of the minimum; chosen."""
NEGLIGIBLE_IN_ROUND = 2e-4
"""Promised decrease at which a short search, or a round before the last, ends with a Newton step: 0.02 standard errors;
chosen. From farther off that step goes far along a direction that the records hardly determine."""
# rounds of noise estimates at most; each brings the noise some 40 % nearer where residuals are coloured, ours
_ROUNDS = 25
# of a search before noise levels are estimated anew, ours
_FEW_EVALUATIONS = 12
COLOUR_ROUNDS = 2
"""Rounds in which effective numbers of samples follow the residuals, before they are held; chosen: the first has the
residuals of the start, the second those of a model that nearly fits (benchmarks/estimation_folds.py)."""
_WHITENED = 0.5
"""Share of its held inflation to which that of a channel falls where the second round did not nearly fit; chosen."""
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
    def model(self) -> Model:
        """The model at the optimum."""
        return self.problem.model_at(self.common_parameters)

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
    return max(1.0 - (problem.size + problem.data.count * len(problem.starts)) / max(samples, 1), 0.1)  # least; chosen


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
    evaluations: int = 60,  # of the residuals in one search, at most; chosen
    further_searches: int = _ROUNDS,
    report_progress: ProgressReporter | None = None,
) -> PointEstimate:
    """Alternate short searches with estimates of the noise and the sessions' population until both settle.

    Then search to the end. The evaluations of all of them are counted.

    Coloured channels count as their effective number of samples throughout (`OutputError.inflation`). These follow the
    residuals in the first `colour_rounds` rounds and are held after them, 0: as the problem has them. All further
    rounds then decrease one objective, the likelihood with the noise concentrated out (`ConcentratedLikelihood`):
    followed throughout, a worse fit is more correlated, counts less against the priors, and fits worse still. Where a
    search that began far off fits later than that, the inflation falls with its residuals, and never rises again.

    Args:
        further_searches: begun anew where the evaluations of the last one ran out, at most.
    """
    stated_noise = np.array([known_noise.get(o, np.nan) for o in problem.data.outputs])
    problem = replace(problem, noise=np.where(np.isfinite(stated_noise), stated_noise, problem.noise))
    few = min(_FEW_EVALUATIONS, evaluations)
    estimate = _search(problem, common_parameters, initial_states, few, report_progress, NEGLIGIBLE_IN_ROUND)
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
        inflation = estimate.problem.inflation
        if colour_rounds:
            current = effective_inflation(residual_correlation(estimate.problem, estimate.residuals())[1])
            inflation = current if k < colour_rounds else fallen_inflation(inflation, current)
        again = replace(
            problem,
            noise=noise,
            population=estimate.population if problem.unknowns_per_session else None,
            inflation=inflation,
            substeps=substeps,
        )
        settled = _is_settled(estimate.problem, again)
        if settled or k == rounds - 1:
            substeps = sufficient_steps_of_optimum(estimate.problem, estimate.optimum, substeps)
            again = replace(again, substeps=substeps)
            settled = settled and substeps == estimate.problem.substeps
        is_last = settled or k == rounds - 1
        estimate = _search(
            again,
            estimate.common_parameters,
            estimate.optimum.local,
            evaluations if is_last else _FEW_EVALUATIONS,
            report_progress,
            _NEGLIGIBLE if is_last else NEGLIGIBLE_IN_ROUND,
        )
        spent += estimate.optimum.solution.evaluations
        if settled:
            break
    estimate, more = _searched_on(estimate, further_searches, evaluations, report_progress)
    solution = replace(estimate.optimum.solution, evaluations=spent + more)
    return replace(estimate, optimum=replace(estimate.optimum, solution=solution), is_settled=settled)


def _searched_on(
    estimate: PointEstimate, searches: int, evaluations: int, report_progress: ProgressReporter | None
) -> tuple[PointEstimate, int]:
    """Search on where the evaluations ran out until another search gains next to nothing; return its evaluations, too.

    Kinks of a model (a command near zero, |u| r) promise decreases that are none and stop the damped steps; a search
    that begins anew with small damping passes them. One that takes no step at all says nothing.
    """
    spent, gained = 0, np.inf
    for _ in range(searches):
        before = estimate.optimum
        if before.solution.status is not Status.EXHAUSTED or gained <= 0.0:
            break
        estimate = _search(estimate.problem, before.solution.point, before.local, evaluations, report_progress)
        solution = estimate.optimum.solution
        gained, spent = before.solution.value - solution.value, spent + solution.evaluations
        if 0.0 < gained <= NEAR_ENOUGH:
            solution = replace(solution, status=Status.CONVERGED)
            estimate = replace(estimate, optimum=replace(estimate.optimum, solution=solution))
    return estimate, spent


def effective_inflation(inflation: Array) -> Array | None:
    """Return the inflation of the channels that are not white, (ny,); None where all are."""
    coloured = inflation > WHITE_INFLATION
    return np.where(coloured, inflation, 1.0) if np.any(coloured) else None


def fallen_inflation(held: Array | None, current: Array | None) -> Array | None:
    """Return the held inflation, (ny,), with the current one of channels that have become much whiter."""
    if held is None:
        return None
    present = np.ones(len(held)) if current is None else current
    fallen = np.where(present <= _WHITENED * held, present, held)
    return fallen if np.any(fallen > 1.0) else None


def _is_settled(before: OutputError, after: OutputError) -> bool:
    """Noise within 2 %, effective numbers of samples and deviations between sessions within 10 %."""
    ratio = np.log(after.noise / before.noise)
    colours = [np.ones(len(p.noise)) if p.inflation is None else p.inflation for p in (before, after)]
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
        f"the search cannot begin: with the start values, model '{problem.model.name}' diverges within {seconds:.3g} s "
        f"in run '{data.runs[data.run[segment]]}'; give start values nearer the craft's under [model.start], priors or "
        "other fixed values, or leave that run out"
    )


def _search(
    problem: OutputError,
    common_parameters: Array,
    initial_states: Array,
    evaluations: int,
    report_progress: ProgressReporter | None,
    negligible: float = _NEGLIGIBLE,
) -> PointEstimate:
    def report(count: int, cost: float) -> None:
        if report_progress:
            segments = counted(problem.data.count, "segment")
            report_progress(f"output error, {segments}: evaluation {count}, cost {cost:.6g}")

    optimum = levenberg_marquardt(
        problem,
        common_parameters,
        initial_states,
        negligible=negligible,
        sufficient=NEAR_ENOUGH,
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


# Whether static force points and records describe the same ship.

# rms residual in standard deviations beyond which points disagree, ours
_MAX_RMS = 2.0


def force_consistency(estimate: PointEstimate) -> tuple[Finding, ...]:
    """For each table of points the rms of its residuals at the estimate, in the stated standard deviations.

    About 1 where the points, their stated noise and the records go together; above 2 a warning `force-misfit`.
    """
    problem = estimate.problem
    values = problem.model.parameters.values
    values[[problem.model.parameters.index(n) for n in problem.free]] = estimate.common_parameters[: len(problem.free)]
    findings = []
    for table in problem.extra_terms:
        if isinstance(table, StaticForces):
            rms = {f: float(np.sqrt(np.nanmean(gap**2))) for f, gap in table.residuals(values).items()}
            findings.append(_force_finding(table, rms))
    return tuple(findings)


def _force_finding(table: StaticForces, rms: dict[str, float]) -> Finding:
    points = table.points
    evidence = "rms residual in standard deviations: " + ", ".join(f"{f} {value:.2g}" for f, value in rms.items())
    if max(rms.values()) <= _MAX_RMS:
        what = f"{points.count} forces of '{points.name}' are fitted with the records"
        return Finding(Severity.INFO, "force-points", what, evidence)
    what = f"the forces of '{points.name}' disagree with the model or the records by more than their stated noise"
    advice = "check their signs, origin, scale and what they include; state a larger sd, or free more coefficients"
    return Finding(Severity.WARNING, "force-misfit", what, evidence, advice)
