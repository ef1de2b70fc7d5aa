"""From a trial's runs to what a search needs: candidates, the box of their coefficients, the budget."""

from collections.abc import Mapping, Sequence

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Prediction
from seatrial.core.values import Array, InputError, Record, spelling_hint
from seatrial.data.trial import EstimateMethod, SearchFitness, SearchSettings, Trial
from seatrial.estimation.problem.segments import compared_outputs
from seatrial.estimation.search import (
    Candidates,
    JudgedRun,
    LinearCandidates,
    SearchBudget,
    SimulatedCandidates,
    search_method,
)
from seatrial.numerics.optimise import Box, FitnessMemory, SearchError
from seatrial.physics.simulate import Forcing, LinearBatch, inputs_of


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
        InputError: the population is too small for the method.
    """
    published = search_method(method)
    population, iterations = settings.population or published.population(unknowns), settings.iterations
    changes = settings.fitness is SearchFitness.SAMPLE
    memory = FitnessMemory.RE_EVALUATE if changes else FitnessMemory.KEEP
    budget = SearchBudget(population, iterations or published.iterations, memory)
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
