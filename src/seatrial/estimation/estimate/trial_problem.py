"""What `identify` minimises first, as a plain least-squares problem that any optimiser takes."""

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from seatrial.core.values import Array
from seatrial.data.trial import Trial, checked_records
from seatrial.estimation.estimate.assemble import output_error_problem, training_runs
from seatrial.estimation.estimate.fit import refuse_without_excitation, segment_seconds, with_segment_seconds
from seatrial.estimation.estimate.settings import resolved_time
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.static_forces import StaticForces


@dataclass(frozen=True, eq=False)
class Bounds:
    """Lower and upper bounds of the unknowns, both (n,), infinite where there are none."""

    lower: Array
    upper: Array


@dataclass(frozen=True, eq=False)
class TrialProblem:
    """Output error over the segments of all training runs.

    Unknowns, in SI units: free coefficients, what each session has of its own, then the initial states of each
    segment. Half the sum of squared residuals is the fitness.

    Attributes:
        output_error: the same problem with shared and local unknowns apart.
        start: the model's own values, prior means, and initial states as measured, (n,).
    """

    output_error: OutputError
    start: Array

    @property
    def names(self) -> tuple[str, ...]:
        """Name of each unknown."""
        problem = self.output_error
        kinds = [name for name, _ in problem.session_parameters] + [n.correction.name for n in problem.nuisances]
        return (
            *problem.free,
            *(f"{kind} of {session}" for session in problem.data.sessions for kind in kinds),
            *(f"{state} of segment {s + 1}" for s in range(problem.data.count) for state in problem.starts),
        )

    @cached_property
    def bounds(self) -> Bounds:
        """Bounds of the unknowns; only coefficients have finite ones."""
        free = np.full(len(self.start) - self.output_error.size, np.inf)
        return Bounds(np.concatenate([self.output_error.lower, -free]), np.concatenate([self.output_error.upper, free]))

    def residuals(self, point: Array) -> Array:
        """Return weighted residuals (m,): simulated minus measured over noise, force points, then priors.

        What was not measured counts as zero; a simulation that diverges gives infinite residuals.
        """
        shared, local = self._parts(point)
        problem = self.output_error
        simulated = problem.simulated_outputs(shared, local)
        difference = np.where(np.isfinite(simulated), simulated, np.inf) - problem.data.measured
        scaled = np.where(np.isfinite(problem.data.measured), difference / problem.noise, 0.0)
        forces = [term.scaled_rows(self._values(shared), ())[0].ravel() for term in self._forces]
        mean, weight = problem.priors
        first, known = problem.initial_prior
        begun = np.sqrt(known) * (local - first)
        return np.concatenate([scaled.ravel(), *forces, np.sqrt(weight) * (shared - mean), begun.ravel()])

    def jacobian(self, point: Array) -> Array:
        """Return the derivatives of the residuals by the unknowns, (m, n)."""
        shared, local = self._parts(point)
        problem, data = self.output_error, self.output_error.data
        slopes = problem.slopes(shared, local) / problem.noise[:, None]
        slopes = np.where(np.isfinite(data.measured)[:, :, None], slopes, 0.0)
        ny, starts = len(data.outputs), len(problem.starts)
        rows = np.zeros((len(slopes), ny, len(point)))
        for s, (first, last) in enumerate(pairwise(data.offsets)):
            local_columns = problem.size + s * starts + np.arange(starts)
            columns = np.concatenate([problem.columns_of(int(data.session[s])), local_columns])
            rows[first:last, :, columns] = slopes[first:last]
        forces = [self._force_rows(term, shared, len(point)) for term in self._forces]
        weights = np.concatenate([problem.priors[1], problem.initial_prior[1].ravel()])
        return np.concatenate([rows.reshape(-1, len(point)), *forces, np.diag(np.sqrt(weights))])

    def fitness(self, points: Array) -> Array:
        """Return half the sum of squared residuals at each row of points (k, n), (k,); infinite after a divergence."""
        return np.array([self.output_error.cost(*self._parts(point)) for point in np.atleast_2d(points)])

    def _parts(self, point: Array) -> tuple[Array, Array]:
        size, count = self.output_error.size, self.output_error.data.count
        return point[:size], point[size:].reshape(count, -1)

    @property
    def _forces(self) -> list[StaticForces]:
        return [term for term in self.output_error.extra_terms if isinstance(term, StaticForces)]

    @cached_property
    def _free_positions(self) -> list[int]:
        parameters = self.output_error.model.parameters
        return [parameters.index(name) for name in self.output_error.free]

    def _values(self, shared: Array) -> Array:
        """All model parameters."""
        values = self.output_error.model.parameters.values
        values[self._free_positions] = shared[: len(self._free_positions)]
        return values

    def _force_rows(self, term: StaticForces, shared: Array, width: int) -> Array:
        by_coefficients = term.scaled_rows(self._values(shared), self._free_positions)[1]
        return np.pad(by_coefficients, ((0, 0), (0, width - by_coefficients.shape[1])))


def trial_problem(trial: Trial) -> TrialProblem:
    """Return the problem of a trial's training runs, in segments by the decision table, noise as stated.

    A channel without stated noise counts with a tenth of its spread.

    Raises:
        InputError: the records do not pass the checks, show no excitation, or cannot be compared with the model.
    """
    runs, model = training_runs(trial, checked_records(trial).records), trial.model
    refuse_without_excitation(model, runs.records)
    settings = with_segment_seconds(trial.estimate, model, runs)
    unit = resolved_time(model, runs.records, runs.length, settings.segment_s)
    problem = output_error_problem(model, runs, segment_seconds(model, settings, unit), settings)
    noise = [runs.noise.get(output, level) for output, level in zip(problem.data.outputs, problem.noise, strict=True)]
    problem = replace(problem, noise=np.array(noise))
    return TrialProblem(problem, np.concatenate([problem.start(), problem.measured_initial_states().ravel()]))
