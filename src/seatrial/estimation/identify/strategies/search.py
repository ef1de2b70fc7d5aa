"""Coefficients by a published search of a population, restarted, on the whole record or sample by sample."""

from collections.abc import Callable, Sequence
from itertools import count

import numpy as np

from seatrial.core.results import Fit, Method, Prediction, Search, SearchRestart, Solution
from seatrial.core.values import Array, Finding, InputError, ProgressReporter, Severity
from seatrial.data.trial import EstimateMethod, SearchFitness, SearchSettings, Trial
from seatrial.estimation.identify.search_problem import (
    search_box,
    search_budget,
    search_candidates,
    simulated_starts,
)
from seatrial.estimation.identify.strategies.published import NO_INTERVALS, PublishedEstimate
from seatrial.estimation.search import (
    Candidates,
    FinishedSearch,
    Fitness,
    SearchBudget,
    one_sample_fitness,
    run_search,
    search_method,
    whole_record_fitness,
)
from seatrial.numerics.optimise import Box, Optimiser, SearchError

# lines of progress that one search writes
_PROGRESS_LINES = 10


def estimate_by_search(
    trial: Trial, reference: Fit, seed: int, report_progress: ProgressReporter | None = None
) -> PublishedEstimate:
    """Return what the search that the trial names finds for the free coefficients of its model.

    Interrupted (Ctrl-C), it returns the restarts that are finished; the interrupt is passed on where there is none.

    Args:
        reference: the package's own fit, which gives the initial states of the runs.
        seed: of everything drawn at random, with the number of the restart.

    Raises:
        InputError: bounds are missing, the population is too small, or the runs cannot be compared with the model.
    """
    method, settings = trial.estimate.method, trial.estimate.search or SearchSettings()
    model, runs = trial.model, training_predictions(reference)
    box = search_box(model, method, settings)
    budget = search_budget(method, settings, box.size)
    candidates = search_candidates(trial, model, [run.measured for run in runs], simulated_starts(model, runs))
    finished = _restarts(method, settings, box, budget, candidates, seed, report_progress)
    result = _search_result(trial, settings, box, budget, candidates, finished)
    used = finished[result.used].solution
    own = np.array([[reference.model.parameters[name].value for name in model.parameters.free_names]])
    return PublishedEstimate(
        Solution(used.point, used.value, used.status, result.evaluations, used.history, seed),
        search_method_text(method, settings, result),
        search_findings(result, used.point, settings.restarts),
        result,
        float(candidates.record_rms(own)[0]),
    )


def training_predictions(fit: Fit) -> tuple[Prediction, ...]:
    """Return the training runs of a fit, measured and simulated."""
    return tuple(p for p in fit.predictions if p.role == "training")


def _restarts(
    method: EstimateMethod,
    settings: SearchSettings,
    box: Box,
    budget: SearchBudget,
    candidates: Candidates,
    seed: int,
    report_progress: ProgressReporter | None,
) -> list[FinishedSearch]:
    """As many searches as required, or those finished when the user interrupts."""
    create = search_method(method).within(budget)
    finished: list[FinishedSearch] = []

    def fitness_of(optimiser: Optimiser) -> Fitness:
        if settings.fitness is SearchFitness.SAMPLE:
            return one_sample_fitness(candidates, optimiser)
        return whole_record_fitness(candidates)

    try:
        for restart in range(settings.restarts):
            title = f"{method}, search {restart + 1} of {settings.restarts}"
            progress = _search_progress(title, budget.iterations, report_progress)
            finished.append(run_search(box, create, fitness_of, seed, restart, progress))
    except KeyboardInterrupt:
        if not finished:
            raise
    except SearchError as error:
        raise InputError(f"method '{method}': {error}") from None
    return finished


def _search_progress(
    title: str, iterations: int, report_progress: ProgressReporter | None
) -> Callable[[int, float], None] | None:
    """What a search calls after each iteration: a line at the first one, then at each tenth of all."""
    if report_progress is None:
        return None
    iteration, stride = count(1), max(1, iterations // _PROGRESS_LINES)

    def report(_: int, best: float) -> None:
        number = next(iteration)
        if number == 1 or number % stride == 0:
            report_progress(f"{title}: iteration {number} of {iterations}, best {best:.4g}")

    return report


def _search_result(
    trial: Trial,
    settings: SearchSettings,
    box: Box,
    budget: SearchBudget,
    candidates: Candidates,
    finished: Sequence[FinishedSearch],
) -> Search:
    """All restarts; used is the best on the whole record, or the first where each iteration saw another sample."""
    names = trial.model.parameters.free_names
    points = np.array([one.solution.point for one in finished])
    rms = candidates.record_rms(points)
    by_samples = settings.fitness is SearchFitness.SAMPLE
    used = 0 if by_samples else int(np.argmin([one.solution.value for one in finished]))
    restarts = [
        SearchRestart(_named(names, one.solution.point), float(level), one.solution.evaluations, one.cpu_s,
                      one.solution.history)
        for one, level in zip(finished, rms, strict=True)
    ]  # fmt: skip
    scatter = _named(names, np.std(points, axis=0, ddof=1)) if len(points) > 1 else {}
    return Search(
        fitness=settings.fitness.value,
        population=budget.population,
        iterations=budget.iterations,
        bounds={n: (float(a), float(b)) for n, a, b in zip(names, box.lower, box.upper, strict=True)},
        weights=dict(zip(candidates.output_names, map(float, candidates.sigma), strict=True)),
        evaluations=sum(one.solution.evaluations for one in finished),
        cpu_s=sum(one.cpu_s for one in finished),
        history=finished[used].solution.history,
        used=used,
        restarts=tuple(restarts),
        scatter=scatter,
        is_interrupted=len(finished) < settings.restarts,
        trace={n: tuple(map(float, column)) for n, column in zip(names, finished[used].trace.T, strict=True)},
    )


def _named(names: Sequence[str], values: Array) -> dict[str, float]:
    return dict(zip(names, map(float, values), strict=True))


def search_method_text(method: EstimateMethod, settings: SearchSettings, search: Search) -> Method:
    published = search_method(method)
    judged = "one sample an iteration" if settings.fitness is SearchFitness.SAMPLE else "rms over the whole record"
    return Method(
        f"{published.title} ({published.source}), {judged}",
        "points drawn uniformly within the bounds",
        NO_INTERVALS,
        ("the method is named by the trial",),
        {"population": search.population, "iterations": search.iterations, "restarts": len(search.restarts)},
        method.value,
    )


def search_findings(search: Search, point: Array, required: int) -> tuple[Finding, ...]:
    """A warning for each coefficient that ends on an end of its range, and one for a search that was interrupted."""
    findings = [
        Finding(Severity.WARNING, "bound-hit", f"coefficient {name} ends on an end of its range", f"{value:g}",
                "widen its range under [estimate.search.bounds]")
        for (name, ends), value in zip(search.bounds.items(), point, strict=True)
        if float(value) in ends
    ]  # fmt: skip
    if search.is_interrupted:
        text = f"the search was interrupted after {len(search.restarts)} of {required} restarts"
        findings.append(Finding(Severity.WARNING, "interrupted", text, "", "run it again to have them all"))
    return tuple(findings)
