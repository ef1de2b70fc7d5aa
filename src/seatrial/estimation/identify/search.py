"""Coefficients by published methods: searches of a population, and regressions on the training runs."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import count

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import (
    Coefficient,
    Fit,
    Method,
    Prediction,
    ReferenceEstimate,
    Search,
    SearchRestart,
    Solution,
    Status,
)
from seatrial.core.results.coefficients import NO_INTERVALS
from seatrial.core.results.fields import MissingParts
from seatrial.core.text.numbers import significant
from seatrial.core.values import (
    Array,
    DivergedError,
    Finding,
    InputError,
    ProgressReporter,
    Record,
    Severity,
    spelling_hint,
)
from seatrial.core.values.versions import versions
from seatrial.data.trial import EstimateMethod, OwnEstimate, Role, SearchFitness, SearchSettings, Trial
from seatrial.data.trial.settings import SupportVectorSettings
from seatrial.estimation.estimate.settings import weak_form_half_width
from seatrial.estimation.identify.fit_result import coefficient_table
from seatrial.estimation.identify.identification import Identification, Situation
from seatrial.estimation.information.covariance import Interval
from seatrial.estimation.predict.open_loop import compare_measures, is_steered, rms_errors
from seatrial.estimation.problem.segments import compared_outputs
from seatrial.estimation.regress import RegressionEstimate, estimator_of_method
from seatrial.estimation.search import (
    Candidates,
    FinishedSearch,
    Fitness,
    JudgedRun,
    LinearCandidates,
    SimulatedCandidates,
    one_sample_fitness,
    run_search,
    whole_record_fitness,
)
from seatrial.numerics.optimise import SEARCH_METHODS, Box, FitnessMemory, Optimiser, SearchBudget, SearchError
from seatrial.physics.simulate import Forcing, LinearBatch, initial_state, inputs_of
from seatrial.physics.simulate.replay import replay

# From a trial's runs to what a search needs: candidates, the box of their coefficients, the budget.


def search_candidates(
    trial: Trial,
    model: Model,
    records: Sequence[Record],
    starts: Sequence[Array],
    weights: Mapping[str, float] | None = None,
) -> Candidates:
    """Return the candidates for the free coefficients of a model, judged by records.

    Args:
        starts: initial state of each record, (states,).
        weights: deviation of each compared channel that counts as 1; None: `channel_weights`.

    Raises:
        InputError: the records cannot be compared with the model.
    """
    outputs = compared_outputs(model, records, trial.estimate.channels)
    measured = [_columns(record, outputs) for record in records]
    weights = weights or channel_weights(trial, outputs, measured)
    sigma = np.array([weights[name] for name in outputs])
    states = [_recorded_states(model, record) for record in records]
    names = model.parameters.free_names
    is_linear = model.is_affine and set(outputs) <= set(model.states)
    used, forcings = _linear_forcings(model, records) if is_linear else ((), _recorded_forcings(model, records))
    judged = tuple(JudgedRun(*run) for run in zip(forcings, starts, measured, states, strict=True))
    if is_linear:
        channels = tuple(model.states.index(name) for name in outputs)
        return LinearCandidates(model, names, used, judged, channels, sigma)
    return SimulatedCandidates(model, names, judged, outputs, sigma)


def simulated_starts(model: Model, runs: Sequence[Prediction]) -> list[Array]:
    """Return the state in which the simulation of each run begins, (states,)."""
    return [np.array([run.simulated[state][0] for state in model.states]) for run in runs]


def recorded_starts(model: Model, records: Sequence[Record]) -> list[Array]:
    """Return the state in which each run begins as its record shows it, (states,).

    Raises:
        InputError: a record shows neither a state nor that of which it is the rate.
    """
    try:
        return [initial_state(model, record, {}) for record in records]
    except InputError as error:
        raise InputError(
            f'{error}; or write own_estimate = "first" under [estimate]: the states at the start of each run are then '
            "those of the package's own estimate"
        ) from None


def channel_weights(trial: Trial, outputs: Sequence[str], measured: Sequence[Array]) -> dict[str, float]:
    """Return the deviation of each channel that counts as 1: its noise where all are stated, else its spread, SI."""
    stated = {name: trial.noise.get(name) for name in outputs}
    if all(stated.values()):
        return {name: float(value) for name, value in stated.items() if value is not None}
    spread = np.nanstd(np.concatenate(measured), axis=0)
    return {name: float(value) or 1.0 for name, value in zip(outputs, spread, strict=True)}


def search_box(model: Model, method: EstimateMethod, settings: SearchSettings) -> Box:
    """Return the range of every free coefficient: of `[estimate.search]`, else of `[model.bounds]`.

    Raises:
        InputError: a coefficient has no range, or a range belongs to no free coefficient.
    """
    names = model.parameters.free_names
    for name in settings.bounds:
        if name not in names:
            raise InputError(
                f"[estimate.search.bounds] names '{name}', no free coefficient{spelling_hint(name, list(names))}"
            )
    ranges = {p.name: settings.bounds.get(p.name, (p.lower, p.upper)) for p in model.parameters.free}
    missing = [name for name, ends in ranges.items() if not np.all(np.isfinite(ends))]
    if missing:
        raise InputError(
            f"method '{method}' searches within bounds, which {', '.join(missing)} "
            f"{'lacks' if len(missing) == 1 else 'lack'}; add [estimate.search.bounds] {missing[0]} = [lower, upper]"
        )
    lower, upper = np.array(list(ranges.values())).T
    return Box(lower, upper)


def search_budget(method: EstimateMethod, settings: SearchSettings, unknowns: int) -> SearchBudget:
    """Return population and iterations as set, else as the method's source has them.

    Raises:
        InputError: the population is too small for the method, or it has no such constant.
    """
    published = SEARCH_METHODS[method]
    population, iterations = settings.population or published.population(unknowns), settings.iterations
    changes = settings.fitness is SearchFitness.SAMPLE
    memory = FitnessMemory.RE_EVALUATE if changes else FitnessMemory.KEEP
    budget = SearchBudget(population, iterations or published.iterations, memory, settings.constants)
    try:
        published.within(budget)
    except SearchError as error:
        text = str(error)
        raise InputError(f"[estimate.search]: {text[0].lower()}{text[1:].rstrip('.')}") from None
    return budget


def check_search_settings(trial: Trial) -> None:
    """Refuse settings with which no search can begin, before anything is estimated.

    Raises:
        InputError: `[estimate.search]` beside a method that is no search, missing bounds, too small a population.
    """
    method, search = trial.estimate.method, trial.estimate.search
    if method.is_search:
        settings = search or SearchSettings()
        search_budget(method, settings, search_box(trial.model, method, settings).size)
    elif search is not None:
        raise InputError(
            f"[estimate.search] is not used by method '{method}'; "
            'remove the table, or write method = "iwho" (or another search) under [estimate]'
        )


def _columns(record: Record, outputs: Sequence[str]) -> Array:
    return np.stack([record[o] if o in record else np.full(len(record), np.nan) for o in outputs], axis=1)


def _recorded_states(model: Model, record: Record) -> Array | None:
    """States as recorded, (samples, states); None where one was not, or has gaps."""
    if not all(state in record for state in model.states):
        return None
    states = _columns(record, model.states)
    return states if np.all(np.isfinite(states)) else None


def _recorded_forcings(model: Model, records: Sequence[Record]) -> list[Forcing]:
    """All inputs of a model at the samples of each record."""
    return [Forcing(inputs_of(model, record), record.dt, is_held=True) for record in records]


def _linear_forcings(model: Model, records: Sequence[Record]) -> tuple[tuple[int, ...], list[Forcing]]:
    """The inputs of a linear model that move in any run, and each run's at the fine step."""
    inputs = [inputs_of(model, record) for record in records]
    used = tuple(j for j in range(len(model.inputs)) if any(np.any(u[:, j] != 0.0) for u in inputs))
    held = tuple(place for place, j in enumerate(used) if model.inputs[j].is_held)
    forcings = []
    for u, record in zip(inputs, records, strict=True):
        fine, substeps = LinearBatch(model, u, np.array([0, len(u)]), record.dt, model.states).fine_inputs(0)
        is_held = len(held) == len(used)
        columns = () if is_held else held
        forcings.append(Forcing(np.ascontiguousarray(fine[:, used]), record.dt, is_held, substeps, columns))
    return used, forcings


# A published method: its values for the coefficients, compared with the package's own estimate.


@dataclass(frozen=True, eq=False)
class PublishedEstimate:
    """What a published method gives.

    Attributes:
        solution: its point holds the free coefficients in the model's order.
        method: its name, what it minimises, where it starts, its settings.
        search: what it did, where it is a search.
        own_record_rms: of the package's own values beside it, as of a restart of the search.
    """

    solution: Solution
    method: Method
    findings: tuple[Finding, ...] = ()
    search: Search | None = None
    own_record_rms: float | None = None

    def named_findings(self, further: Sequence[Finding] = ()) -> tuple[Finding, ...]:
        """Return its findings and further ones, each with the name of the method."""
        return _named_findings(f"method {self.method.name}", (*self.findings, *further))


def _named_findings(estimate: str, findings: Sequence[Finding]) -> tuple[Finding, ...]:
    """Findings that say of which estimate they are."""
    return tuple(replace(one, message=f"{estimate}: {one.message}") for one in findings)


def own_estimate_progress(report_progress: ProgressReporter | None) -> ProgressReporter | None:
    """Return what reports the package's own estimate next to a published method: each line is marked as such."""
    return None if report_progress is None else lambda text: report_progress(f"own estimate: {text}")


def published_alone(task: Identification, estimate: PublishedEstimate) -> Fit:
    """Return the fit of a published method without an estimate of the package's own.

    Every run is simulated from the state that its record shows at its start, without offsets.

    Raises:
        InputError: a record does not show the state at its start.
    """
    trial, records = task.trial, [r.record for r in task.records]
    names, point = trial.model.parameters.free_names, estimate.solution.point
    values = dict(zip(names, map(float, point), strict=True))
    model = trial.model.with_values(values)
    recorded_starts(model, records)  # refused before it is simulated
    roles = ["training" if r.role is Role.TRAIN else "validation" for r in task.records]
    runs = [Prediction(r.name, role, r, r, {}, {}, 0.0) for r, role in zip(records, roles, strict=True)]
    predictions, findings = _predictions(runs, model, trial.ship.particulars.get("L", 0.0))
    unknown = Interval(np.zeros((len(names), len(names))), np.inf, NO_INTERVALS)
    table = coefficient_table(model.parameters, names, point, unknown, trial.truth)
    return Fit(
        question=trial.question
        or f"Which {model.name} model does method {estimate.method.name} find in these records?",
        ship=trial.ship,
        model=model,
        coefficients=tuple(_without_interval(c, values) for c in table),
        covariance=np.empty((0, 0)),
        solution=estimate.solution,
        method=estimate.method,
        offsets=(),
        channel_noise=(),
        residuals=(),
        predictions=predictions,
        findings=(*task.findings, *estimate.named_findings((*_outside_bounds(model), *findings))),
        records=tuple(records),
        seed=task.options.seed,
        elapsed_s=time.perf_counter() - task.began,
        versions=versions(),
        search=estimate.search,
    )


def published_fit(reference: Fit, estimate: PublishedEstimate, cpu_s: float, of_records: Sequence[Finding] = ()) -> Fit:
    """Return the fit of a published method; the package's own stands in it as its reference.

    Every run is simulated from the initial state that the package's own fit has for it, without offsets. Findings say
    of which of the two estimates they are.

    Args:
        reference: the package's own fit of the same records.
        cpu_s: processor time of the package's own estimate [s].
        of_records: findings that hold whatever is estimated.
    """
    names = reference.model.parameters.free_names
    values = dict(zip(names, map(float, estimate.solution.point), strict=True))
    model = reference.model.with_values(values)
    length = reference.ship.particulars.get("L", 0.0)
    predictions, findings = _predictions(reference.predictions, model, length)
    own = [one for one in reference.findings if one not in of_records]
    return replace(
        reference,
        model=model,
        coefficients=tuple(_without_interval(c, values) for c in reference.coefficients),
        covariance=np.empty((0, 0)),
        solution=estimate.solution,
        method=estimate.method,
        offsets=(),
        channel_noise=(),
        residuals=(),
        predictions=predictions,
        findings=(
            *of_records, *_named_findings("own estimate", own),
            *estimate.named_findings((*_outside_bounds(model), *findings)),
        ),
        identifiability=None,
        noise_model=None,
        candidate_models=(),
        interval_basis=None,
        k_step_errors=(),
        frequency_responses=(),
        seakeeping=None,
        roll=None,
        search=estimate.search,
        reference=_reference(reference, cpu_s, estimate.own_record_rms),
    )  # fmt: skip


def _without_interval(c: Coefficient, values: dict[str, float]) -> Coefficient:
    if c.fixed:
        return c
    return replace(c, estimate=values[c.name], standard_error=None, lower=None, upper=None, prior_mean=None,
                   prior_standard_deviation=None)  # fmt: skip


def _outside_bounds(model: Model) -> list[Finding]:
    """A warning for every coefficient that a method which knows no bounds puts beyond them."""
    return [
        Finding(
            Severity.WARNING, "outside-bounds", f"coefficient {p.name} lies outside its bounds",
            f"{p.value:g}, bounds {p.lower:g} to {p.upper:g}",
        )
        for p in model.parameters.free
        if not p.lower <= p.value <= p.upper
    ]  # fmt: skip


def _predictions(
    runs: Sequence[Prediction], model: Model, length: float
) -> tuple[tuple[Prediction, ...], list[Finding]]:
    """All runs simulated with the method's values from their starts, and a warning for each that diverges."""
    predictions, findings = [], []
    for p in runs:
        try:
            simulated = replay(model, p.simulated)
        except DivergedError as error:
            text = f"run '{p.record}' cannot be simulated with its coefficients"
            findings.append(Finding(Severity.WARNING, "diverged", text, str(error), "do not use them"))
            continue
        measures = compare_measures(p.measured, simulated, length) if is_steered(p.measured, model) else {}
        predictions.append(
            Prediction(p.record, p.role, p.measured, simulated, rms_errors(p.measured, simulated), measures,
                       p.initial_seconds, p.extrapolation)
        )  # fmt: skip
    return tuple(predictions), findings


def _reference(fit: Fit, cpu_s: float, record_rms: float | None) -> ReferenceEstimate:
    errors = {p.record: p.rms for p in fit.predictions}
    return ReferenceEstimate(fit.coefficients, fit.method, fit.solution.evaluations, cpu_s, errors, record_rms)


def refuse_options(method: EstimateMethod, *, choose: bool, compare: bool) -> None:
    """Refuse what belongs to the package's own estimate where a published method is named.

    Raises:
        InputError: models are to be chosen from, or other estimators compared.
    """
    if method.is_published and (choose or compare):
        option = "--choose" if choose else "--compare"
        raise InputError(
            f"{option} goes with the package's own estimate, and method '{method}' is compared with that one anyway; "
            f"leave out {option}, or the method"
        )


# The fit of the published method that a trial names, beside the package's own.


def identify_by_published_method(
    task: Identification,
    situation: Situation,
    strategy: Callable[[Identification], Fit],
    report_progress: ProgressReporter | None,
) -> Fit:
    """Return the fit of the published method that the trial names, compared with the package's own, by its strategy.

    Raises:
        InputError: the runs cannot be simulated from recorded inputs, or what the method raises.
    """
    trial, method = task.trial, task.trial.estimate.method
    if situation in (Situation.WAVE_SPECTRUM, Situation.UNKNOWN_WAVES):
        raise InputError(
            f"method '{method}' needs what moves the ship in every sample, and here the waves were not recorded; "
            'record them, or write method = "auto"'
        )
    order = trial.estimate.own_estimate
    if order is OwnEstimate.FIRST:
        reference, cpu_s = _own_estimate(task, strategy)
        estimate = _published_estimate(task, reference, report_progress)
        fit = published_fit(reference, _beside(task, estimate, reference), cpu_s, task.findings)
        return replace(fit, elapsed_s=time.perf_counter() - task.began)
    estimate = _published_estimate(task, None, report_progress)
    if order is OwnEstimate.NONE:
        return published_alone(task, estimate)
    if report_progress:
        found = zip(trial.model.parameters.free_names, estimate.solution.point, strict=True)
        report_progress(f"{method}: {', '.join(f'{name} {value:.4g}' for name, value in found)}")
    parts = MissingParts()
    own = parts.computed("the package's own estimate", lambda: _own_estimate(task, strategy), None)
    if own is None:
        alone = published_alone(task, estimate)
        return replace(alone, findings=(*alone.findings, *parts.findings))
    reference, cpu_s = own
    fit = published_fit(reference, _beside(task, estimate, reference), cpu_s, task.findings)
    return replace(fit, elapsed_s=time.perf_counter() - task.began)


def _own_estimate(task: Identification, strategy: Callable[[Identification], Fit]) -> tuple[Fit, float]:
    """The package's own fit, and the processor time of its estimate [s]."""
    began = time.process_time()
    _ = task.estimation
    cpu_s = time.process_time() - began
    return strategy(task), cpu_s


def _starts(task: Identification, reference: Fit | None) -> tuple[list[Record], list[Array]]:
    """The training runs, and the state in which each begins: of the package's own fit, else of its record."""
    if reference is not None:
        runs = training_predictions(reference)
        return [run.measured for run in runs], simulated_starts(reference.model, runs)
    records = [r.record for r in task.train]
    return records, recorded_starts(task.trial.model, records)


def _published_estimate(
    task: Identification, reference: Fit | None, report_progress: ProgressReporter | None
) -> PublishedEstimate:
    """What the method that the trial names gives."""
    trial, method = task.trial, task.trial.estimate.method
    if method.is_search:
        return estimate_by_search(trial, *_starts(task, reference), task.options.seed, report_progress)
    window = weak_form_half_width(task.trial.model, task.runs.records, task.resolved_time)
    return estimate_by_regression(trial.model, task.runs.records, method, window, trial.compare.svr)


def _beside(task: Identification, estimate: PublishedEstimate, reference: Fit) -> PublishedEstimate:
    """With the weighted rms of the package's own values, as a search judges it."""
    if estimate.search is None:
        return estimate
    return replace(estimate, own_record_rms=record_rms(task.trial, reference.model, *_starts(task, reference)))


# Coefficients by a published search of a population, restarted, on the whole record or sample by sample.

# lines of progress that one search writes
_PROGRESS_LINES = 10


def estimate_by_search(
    trial: Trial,
    records: Sequence[Record],
    starts: Sequence[Array],
    seed: int,
    report_progress: ProgressReporter | None = None,
) -> PublishedEstimate:
    """Return what the search that the trial names finds for the free coefficients of its model.

    Interrupted (Ctrl-C), it returns the restarts that are finished; the interrupt is passed on where there is none.

    Args:
        records, starts: of the training runs, and the state in which each begins, (states,).
        seed: of everything drawn at random, with the number of the restart.

    Raises:
        InputError: bounds are missing, the population is too small, or the runs cannot be compared with the model.
    """
    method, settings = trial.estimate.method, trial.estimate.search or SearchSettings()
    model = trial.model
    box = search_box(model, method, settings)
    budget = search_budget(method, settings, box.size)
    candidates = search_candidates(trial, model, records, starts)
    finished = _restarts(method, settings, box, budget, candidates, seed, report_progress)
    result = _search_result(trial, settings, box, budget, candidates, finished)
    used = finished[result.used].solution
    return PublishedEstimate(
        Solution(used.point, used.value, used.status, result.evaluations, used.history, seed),
        search_method_text(method, settings, result),
        search_findings(result, used.point, settings.restarts),
        result,
    )


def record_rms(trial: Trial, model: Model, records: Sequence[Record], starts: Sequence[Array]) -> float:
    """Return the weighted rms that a model leaves over the whole record, as a search judges it."""
    values = np.array([[model.parameters[name].value for name in trial.model.parameters.free_names]])
    return float(search_candidates(trial, trial.model, records, starts).record_rms(values)[0])


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
    create = SEARCH_METHODS[method].within(budget)
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
    published = SEARCH_METHODS[method]
    judged = "one sample an iteration" if settings.fitness is SearchFitness.SAMPLE else "rms over the whole record"
    budget = SearchBudget(search.population, search.iterations, constants=settings.constants)
    return Method(
        f"{published.title} ({published.source}), {judged}",
        "points drawn uniformly within the bounds",
        NO_INTERVALS,
        ("the method is named by the trial",),
        {
            "population": search.population, "iterations": search.iterations, "restarts": len(search.restarts),
            **published.constant_values(budget),
        },
        method.value,
    )  # fmt: skip


def search_findings(search: Search, point: Array, required: int) -> tuple[Finding, ...]:
    """A warning for each coefficient that ends on an end of its range, and one for a search that was interrupted.

    Where each iteration saw one sample, a wider range helps nothing: one sample does not determine the coefficients.
    """
    advice = {
        SearchFitness.RECORD.value: "widen its range under [estimate.search.bounds]",
        SearchFitness.SAMPLE.value: 'judge by the whole record: write fitness = "record" under [estimate.search]',
    }[search.fitness]
    findings = [
        Finding(Severity.WARNING, "bound-hit", f"coefficient {name} ends on an end of its range", f"{value:g}", advice)
        for (name, ends), value in zip(search.bounds.items(), point, strict=True)
        if float(value) in ends
    ]
    if search.is_interrupted:
        text = f"the search was interrupted after {len(search.restarts)} of {required} restarts"
        findings.append(Finding(Severity.WARNING, "interrupted", text))
    return tuple(findings)


# Coefficients by a published regression on the training runs.


def estimate_by_regression(
    model: Model,
    records: Sequence[Record],
    method: EstimateMethod,
    window_s: float,
    svr: SupportVectorSettings | None = None,
) -> PublishedEstimate:
    """Return what a regression finds for the free coefficients of a model, from the records as they are.

    Args:
        window_s: half width of windows, where the method has any [s].
        svr: settings of the support vectors and of the published pipeline.

    Raises:
        InputError: the model is not linear in its coefficients, or the records do not show every state of it.
    """
    estimator = estimator_of_method(method, window_s, svr)
    began = time.process_time()
    try:
        regression = estimator.estimate(model, records)
    except InputError as error:
        raise InputError(f"method '{method}': {error}") from None
    except np.linalg.LinAlgError:
        raise InputError(f"method '{method}': its equations are singular in these records; add other runs") from None
    seconds = time.process_time() - began
    if not np.all(np.isfinite(regression.values)):
        raise InputError(f"method '{method}': its coefficients are no finite numbers; take another method")
    text = Method(
        estimator.name, "none: linear equations", NO_INTERVALS, ("the method is named by the trial",),
        {"processor time, s": round(seconds, 3)}, method.value,
    )  # fmt: skip
    solution = Solution(regression.values, np.nan, Status.CONVERGED, 1)
    return PublishedEstimate(solution, text, (*regression.findings, *_bias_findings(regression)))


def _bias_findings(regression: RegressionEstimate) -> list[Finding]:
    """What each equation was given besides the model's terms."""
    return [
        Finding(Severity.INFO, "constant", f"the {equation} equation was given a constant besides the model's terms",
                significant(bias, 3))
        for equation, bias in regression.bias.items()
        if bias
    ]  # fmt: skip
