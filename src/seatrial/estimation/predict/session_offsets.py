"""What a run that was not fitted has of its own: its session's estimate, or what the population of sessions expects."""

from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Prior, Record
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.predict.start_states import EVALUATIONS
from seatrial.estimation.predict.windows import Windows
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.population import SessionPopulation
from seatrial.estimation.problem.segments import segments_between
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.physics.simulate.replay import inputs_of


@dataclass(frozen=True, eq=False)
class SessionOffsets:
    """Offsets with which a run is simulated, (k,), SI, and the covariance of what they may be instead, (k, k)."""

    expected: Array
    covariance: Array


def new_session_offsets(estimate: PointEstimate, record: Record) -> SessionOffsets:
    """Return what a session that no training run belongs to is expected to have: the population's mean and variance.

    Raises:
        InputError: the record lacks an input.
    """
    covariates = estimate.problem.covariates_of(inputs_of(estimate.problem.model, record))
    population = estimate.population
    return SessionOffsets(population.means(covariates), population.new_session_covariance)


def session_offsets(estimation: Estimation, session: str, record: Record) -> SessionOffsets:
    """Return what a run of this session has: the session's own estimate where it was fitted, else as of a new session.

    Raises:
        InputError: the record lacks an input.
    """
    estimate = estimation.estimate
    problem = estimate.problem
    if session not in problem.data.sessions:
        return new_session_offsets(estimate, record)
    index = problem.data.sessions.index(session)
    own = problem.offset_columns(index)
    return SessionOffsets(estimate.session_offsets[index], estimation.interval.covariance[np.ix_(own, own)])


def updated_by_start(
    template: OutputError, model: Model, offsets: SessionOffsets, record: Record, seconds: float
) -> SessionOffsets:
    """Return offsets that the first seconds of a run make likely, with those expected before it as the prior.

    Initial state and offsets are estimated together, the model held, its outputs weighted as in the fit: by the
    residuals it left there and their effective number of samples. On board this much of a run is known when it begins.

    Raises:
        InputError: the record lacks an input.
    """
    held = model.with_parameters(model.parameters.fixed(*model.parameters.names))
    bounds = Windows.of_record(record).beginnings(seconds).bounds
    deviations = np.sqrt(np.diag(offsets.covariance))
    declared = [Prior(float(m), float(d), "population") for m, d in zip(offsets.expected, deviations, strict=True)]
    problem = replace(
        template,
        model=held,
        data=segments_between(held, [record], template.data.outputs, bounds),
        population=SessionPopulation.as_declared(declared, np.zeros((1, len(declared)))),
        extra_terms=(),
        prior_terms=(),
    )
    optimum = levenberg_marquardt(problem, offsets.expected, problem.measured_initial_states(), evaluations=EVALUATIONS)
    return SessionOffsets(optimum.solution.point, inverse(optimum.normal.without_local()[1]))


def offsets_without(template: OutputError, point: Array, session: str, record: Record) -> Array:
    """Return what a run of `session` is expected to have by the other sessions at the shared unknowns `point`, (k,).

    Where there is no other session, the expectation is that of the population.

    Raises:
        InputError: the record lacks an input.
    """
    population = template.population or template.declared_population
    new = template.covariates_of(inputs_of(template.model, record))
    rest = [s != session for s in template.data.sessions]
    if not any(rest):
        return population.means(new)
    offsets = point[len(template.free) :].reshape(len(rest), template.unknowns_per_session)
    return population.of_new_session(offsets[rest], template.session_covariates[rest], new)
