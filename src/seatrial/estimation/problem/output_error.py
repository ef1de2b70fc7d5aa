"""Output error over segments: simulate each from its own free initial state and compare with what was measured."""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Index, Prior
from seatrial.estimation.problem.population import SessionPopulation
from seatrial.estimation.problem.segments import (
    Segments,
    initial_state_weights,
    measured_initial_states,
)
from seatrial.numerics.optimise import NormalEquations
from seatrial.numerics.workers import map_in_threads
from seatrial.physics.simulate.batch import InputCorrection, SegmentBatch, batch_class
from seatrial.physics.simulate.states import ActuatorHistory

# Output error over segments: simulate each from its own free initial state and compare with what was measured.

_MOST_KEPT = 2**23  # slopes that are kept for the next evaluation at their point, 64 MB; chosen
_ROWS_PER_RANGE = 4000  # samples that one thread takes at a time; chosen

_BY_CHANCE = 3.84  # squared standard deviations between a right prior and its record in 19 of 20 cases


@dataclass(frozen=True, eq=False)
class Contribution:
    """Cost, gradient (k,) and Gauss-Newton Hessian (k, k) of one addend by k model parameters."""

    cost: float
    gradient: Array
    hessian: Array


class DataTerm(Protocol):
    """What the output-error problem asks of other data."""

    def cost(self, values: Array) -> float:
        """Return half the sum of squares at these values of all model parameters."""
        ...

    def normal(self, values: Array, free: Sequence[int]) -> Contribution:
        """Return the Gauss-Newton model by the parameters at the positions `free`."""
        ...


@dataclass(frozen=True)
class Nuisance:
    """An input correction estimated once a session, with what is assumed of it before any record.

    Attributes:
        prior: about its mean over sessions; its standard deviation is also the first guess of how sessions differ.
        is_stated: whether the trial declares it; the prior of another one is only there to be exceeded.
        is_spread_fixed: whether sessions differ as the prior says, whatever the records show: what is known of timing.
        covariate: the input on whose rms over a session the correction may depend linearly; empty: none.
    """

    correction: InputCorrection
    prior: Prior
    unit: str
    is_stated: bool = True
    covariate: str = ""
    is_spread_fixed: bool = False


@dataclass(frozen=True, eq=False)
class OutputError:
    """Shared unknowns: free model parameters, then each nuisance for each session. Local: initial states.

    Attributes:
        noise: standard deviation of each compared output, shape (ny,), SI.
        inflation: variance inflation of each channel's residuals; coloured samples count for that many times fewer, so
            that priors keep their weight against them (effective sample size; Sokal 1997). None: white.
        huber: residuals beyond this many standard deviations count linearly (Huber 1964); infinite: squares only.
        session_parameters: model parameters estimated once a session (a current), with their priors.
        population: how nuisances and session parameters are distributed over sessions; None: as declared.
        pinned: shared unknowns held at these values, for predictions: only initial states move.
        substeps: Runge-Kutta steps in a sample (`integration_steps`).
        extra_terms: data besides the records that say something about the model parameters (static force points).
        prior_terms: what is known of several model parameters together, besides the priors of each.
    """

    model: Model
    data: Segments
    noise: Array
    nuisances: tuple[Nuisance, ...] = ()
    session_parameters: tuple[tuple[str, Prior], ...] = ()
    inflation: Array | None = None
    huber: float = np.inf
    substeps: int = 1
    workers: int | None = None
    pinned: Array | None = None
    extra_terms: tuple[DataTerm, ...] = ()
    population: SessionPopulation | None = None
    prior_terms: tuple[DataTerm, ...] = ()

    @cached_property
    def free(self) -> tuple[str, ...]:
        """Names of the free model parameters that all runs share."""
        own = {name for name, _ in self.session_parameters}
        return tuple(n for n in self.model.parameters.free_names if n not in own)

    @property
    def observables(self) -> tuple[str, ...]:
        """What the model says of each compared channel."""
        return tuple(self.model.observable_of(channel) for channel in self.data.outputs)

    @cached_property
    def _batch(self) -> SegmentBatch:
        batch = batch_class(self.model)(
            self.model, self.data.inputs, self.data.offsets, self.data.dt, self.observables,
            (*self.free, *(name for name, _ in self.session_parameters)),
            tuple(n.correction for n in self.nuisances), (), self.substeps, self.data.run_inputs,
        )  # fmt: skip
        return replace(batch, initial_states=(*self._starts_of(batch), *self._actuators))

    def substeps_at(self, dt: float) -> int:
        """Return the number of steps in a sample of `dt` [s] that are no longer than the problem's own."""
        # rounding of a quotient of time steps; chosen
        return max(1, int(np.ceil(self.substeps * dt / self.data.dt - 1e-6)))

    @cached_property
    def _history(self) -> ActuatorHistory | None:
        return None if self.data.history is None else replace(self.data.history, substeps=self.substeps)

    @property
    def _actuators(self) -> tuple[str, ...]:
        return () if self._history is None else self._history.states

    def _starts_of(self, batch: SegmentBatch) -> tuple[str, ...]:
        return tuple(s for s in batch.influential_states() if s not in self._actuators)

    @cached_property
    def starts(self) -> tuple[str, ...]:
        """States whose initial value is estimated in every segment; those that follow the inputs alone are known."""
        return self._starts_of(self._batch)

    @property
    def unknowns_per_session(self) -> int:
        """Number of unknowns a session has of its own."""
        return len(self.session_parameters) + len(self.nuisances)

    @property
    def size(self) -> int:
        """Number of shared unknowns."""
        return len(self.free) + self.unknowns_per_session * len(self.data.sessions)

    def _bounds(self, free_bounds: list[float], other_bound: float) -> Array:
        if self.pinned is not None:
            return self.pinned
        return np.concatenate([free_bounds, np.full(self.size - len(self.free), other_bound)])

    @property
    def lower(self) -> Array:
        """Lower bounds of the shared unknowns."""
        return self._bounds([self.model.parameters[n].lower for n in self.free], -np.inf)

    @property
    def upper(self) -> Array:
        """Upper bounds of the shared unknowns."""
        return self._bounds([self.model.parameters[n].upper for n in self.free], np.inf)

    @cached_property
    def priors(self) -> tuple[Array, Array]:
        """Mean and weight (1/variance, 0 without prior) of each shared unknown."""
        mean, weight, count = np.zeros(self.size), np.zeros(self.size), len(self.free)
        for i, prior in enumerate(self.model.parameters[n].prior for n in self.free):
            if prior is not None and np.isfinite(prior.standard_deviation):
                mean[i], weight[i] = prior.mean, prior.standard_deviation**-2
        population = self.population or self.declared_population
        mean[count:] = population.means(self.session_covariates).ravel()
        weight[count:] = np.tile(population.deviation**-2.0, len(self.data.sessions))
        return mean, weight

    @property
    def session_unknowns(self) -> tuple[str, ...]:
        """Names of what each session has of its own, in order."""
        return (*(name for name, _ in self.session_parameters), *(n.correction.name for n in self.nuisances))

    @property
    def declared_population(self) -> SessionPopulation:
        """What is assumed of sessions before any record."""
        declared = [p for _, p in self.session_parameters] + [n.prior for n in self.nuisances]
        population = SessionPopulation.as_declared(declared, self.session_covariates, len(self.session_parameters))
        return population.with_fixed_spread([False] * len(self.session_parameters) + [
            n.is_spread_fixed for n in self.nuisances
        ])  # fmt: skip

    @cached_property
    def session_covariates(self) -> Array:
        """Covariates of each session, (sessions, k)."""
        if not any(n.covariate for n in self.nuisances):
            return np.zeros((len(self.data.sessions), self.unknowns_per_session))
        of_row = np.repeat(self.data.session, np.diff(self.data.offsets))
        inputs = [self.data.inputs[of_row == session] for session in range(len(self.data.sessions))]
        return np.array([self.covariates_of(one) for one in inputs]).reshape(len(inputs), self.unknowns_per_session)

    def covariates_of(self, inputs: Array) -> Array:
        """Return the rms of the input on which each kind of offset may depend, (k,), 0: none; inputs: (rows, nu)."""
        channels = ["" for _ in self.session_parameters] + [n.covariate for n in self.nuisances]
        rms = np.sqrt(np.mean(inputs**2, axis=0)) if len(inputs) else np.zeros(inputs.shape[1])
        return np.array([rms[self.model.input_names.index(c)] if c else 0.0 for c in channels])

    def start(self) -> Array:
        """Return model values and prior means: the shared unknowns where nothing is known yet."""
        point = self.priors[0].copy()
        point[: len(self.free)] = [self.model.parameters[n].value for n in self.free]
        return point

    def model_at(self, shared: Array) -> Model:
        """Return the model with the free parameters of a point."""
        return self.model.with_values(dict(zip(self.free, shared.tolist(), strict=False)))

    def columns_of(self, session: int) -> np.ndarray:
        """Return positions among the shared unknowns of a session's sensitivity columns."""
        return np.concatenate([np.arange(len(self.free)), self.offset_columns(session)])

    def offset_columns(self, session: int) -> np.ndarray:
        """Return positions among the shared unknowns of what a session has of its own."""
        return len(self.free) + session * self.unknowns_per_session + np.arange(self.unknowns_per_session)

    def measured_initial_states(self) -> Array:
        """Return the initial states of each segment as measured, (segments, len(starts)), SI."""
        return measured_initial_states(self.data, self.starts)

    @cached_property
    def initial_prior(self) -> tuple[Array, Array]:
        """Mean and weight (1/variance, 0 without a prior) of the initial states, both (segments, len(starts))."""
        return self.measured_initial_states(), initial_state_weights(self.data, self.starts)

    def unpack(self, shared: Array, local: Array) -> tuple[Array, Array, Array]:
        """Return full initial states, model parameters and corrections of each segment."""
        count, parameters = self.data.count, self.model.parameters
        values = np.tile(parameters.values, (count, 1))
        values[:, self._free_indices] = shared[: len(self.free)]
        own = shared[len(self.free) :].reshape(len(self.data.sessions), self.unknowns_per_session)[self.data.session]
        split = len(self.session_parameters)
        values[:, [parameters.index(n) for n, _ in self.session_parameters]] = own[:, :split]
        start = np.zeros((count, len(self.model.states)))
        start[:, [self.model.states.index(s) for s in self.starts]] = local
        corrections = np.ascontiguousarray(own[:, split:])
        if self._history is not None:
            first = self._first_segments
            known = self._history.starts(values[first], corrections[first], self._batch.corrections)
            start[:, [self.model.states.index(s) for s in self._actuators]] = known
        return start, values, corrections

    @cached_property
    def _first_segments(self) -> Index:
        """The first segment of each session; the first of all for sessions that have none."""
        return np.array(
            [int(np.argmax(self.data.session == s)) for s in range(len(self.data.sessions))], dtype=np.int64
        )

    def _actuator_slopes(self, values: Array, corrections: Array) -> Array | None:
        """Derivatives of the known initial states by a session's columns, (segments, actuators, n)."""
        if self._history is None:
            return None
        first, batch = self._first_segments, self._batch
        return self._history.slopes(batch.parameters, values[first], corrections[first], batch.corrections)

    def _differentiate(
        self, bounds: tuple[int, int], start: Array, values: Array, corrections: Array, by_actuator: Array | None
    ) -> tuple[Array, Array]:
        """Outputs of some segments and their derivatives by a session's columns, then by unknown initial states.

        Noise and priors move neither: at one point of the same data they are worked out once.
        """
        if self.data.measured.size * (self.size + len(self.starts)) > _MOST_KEPT:
            return self._differentiated(bounds, start, values, corrections, by_actuator)

        def differentiated() -> tuple[Array, Array]:
            outputs, slopes = self._differentiated(bounds, start, values, corrections, by_actuator)
            outputs.setflags(write=False)
            slopes.setflags(write=False)
            return outputs, slopes

        return self.data.last_slopes.part(self._point(start, values, corrections), bounds, differentiated)

    def _point(self, start: Array, values: Array, corrections: Array) -> tuple[Hashable, ...]:
        """What decides outputs and slopes of the same data."""
        return (self._simulated_by, *(a.tobytes() for a in (start, values, corrections)))

    @cached_property
    def _simulated_by(self) -> tuple[Hashable, ...]:
        """What decides the slopes besides the data and the point."""
        equations = self.model.equations
        return (
            equations.digest, equations.layout, equations.sensors, self.model.held, self.observables, self.free,
            self.session_parameters, tuple(n.correction for n in self.nuisances), self.substeps, self.starts,
        )  # fmt: skip

    def _differentiated(
        self, bounds: tuple[int, int], start: Array, values: Array, corrections: Array, by_actuator: Array | None
    ) -> tuple[Array, Array]:
        y, s, _ = self._batch.differentiate(*bounds, start, values, corrections)
        if by_actuator is None:
            return y, s
        n, width = len(self.free) + self.unknowns_per_session, s.shape[2] - len(self._actuators)
        base = self.data.offsets[bounds[0]]
        for k in range(*bounds):
            rows = slice(self.data.offsets[k] - base, self.data.offsets[k + 1] - base)
            s[rows, :, :n] += s[rows, :, width:] @ by_actuator[k]
        return y, s[:, :, :width]

    def _work_ranges(self) -> list[tuple[int, int]]:
        """Return ranges of segments of some thousand rows each: the units of work."""
        edges, first = [], 0
        for s in range(1, self.data.count + 1):
            if s == self.data.count or self.data.offsets[s] - self.data.offsets[first] >= _ROWS_PER_RANGE:
                edges.append((first, s))
                first = s
        return edges

    @property
    def _threads(self) -> int | None:
        """The threads of one evaluation: that of the caller where two would not both have their fill."""
        return self.workers if len(self.data.measured) >= 2 * _ROWS_PER_RANGE else 1

    def _scaled_residuals(self, simulated: Array, rows: slice) -> Array:
        residual = (simulated - self.data.measured[rows]) / self.noise
        return np.where(np.isfinite(self.data.measured[rows]), residual, 0.0)

    @cached_property
    def _effective_share(self) -> Array:
        """Effective over actual number of samples, by channel."""
        return np.ones(len(self.noise)) if self.inflation is None else 1.0 / self.inflation

    def _loss(self, scaled: Array) -> tuple[Array, Array]:
        """Return half the robust square of each residual, of effective samples, and its weight (Huber 1964)."""
        size = np.abs(scaled)
        if np.isinf(self.huber) or not np.any(size > self.huber):
            return 0.5 * self._effective_share * scaled**2, np.broadcast_to(self._effective_share, scaled.shape)
        inside = size <= self.huber
        loss = np.where(inside, 0.5 * scaled**2, self.huber * (size - 0.5 * self.huber))
        weight = np.where(inside, 1.0, self.huber / np.maximum(size, 1e-300))  # above zero, for a division
        return self._effective_share * loss, self._effective_share * weight

    def _prior_cost(self, shared: Array) -> float:
        mean, weight = self.priors
        return 0.5 * float(np.sum(weight * (shared - mean) ** 2))

    def _parameter_values(self, shared: Array) -> Array:
        """Return all model parameters as the runs share them."""
        values = self.model.parameters.values
        values[self._free_indices] = shared[: len(self.free)]
        return values

    @cached_property
    def _free_indices(self) -> list[int]:
        return [self.model.parameters.index(n) for n in self.free]

    @property
    def _active_terms(self) -> tuple[DataTerm, ...]:
        """The other data; none where only initial states move, which they say nothing about."""
        return () if self.pinned is not None else (*self.extra_terms, *self.prior_terms)

    def prior_precision(self, shared: Array) -> Array:
        """Return the information (size, size) of priors and other data, which stay when runs are left out."""
        precision, k = np.diag(self.priors[1]), len(self.free)
        for other in self._active_terms:
            precision[:k, :k] += other.normal(self._parameter_values(shared), self._free_indices).hessian
        return precision

    def prior_score_variance(self, shared: Array) -> Array:
        """Return the variance (size, size) of the gradient that priors and other data add to the cost.

        It is their information, as far as they are right. A coefficient's prior whose mean the records put further away
        than chance does (d standard deviations, d^2 > 3.84) is wrong by that much: its gradient counts with its own
        square, as those of the runs do in a sandwich (White 1982, Econometrica 50, 1-25). That is its whole error where
        the records weigh as much as the prior or more.
        """
        (mean, weight), k = self.priors, len(self.free)
        squared_distance = weight[:k] * (shared[:k] - mean[:k]) ** 2
        variance = self.prior_precision(shared)
        is_wrong = squared_distance > _BY_CHANCE
        variance[range(k), range(k)] += weight[:k] * np.where(is_wrong, squared_distance - 1.0, 0.0)
        return variance

    def _extra_cost(self, shared: Array) -> float:
        values = self._parameter_values(shared)
        return sum(other.cost(values) for other in self._active_terms)

    def simulated_outputs(self, shared: Array, local: Array) -> Array:
        """Return simulated outputs of all segments, shape (rows, ny); NaN after a divergence."""
        start, values, corrections = self.unpack(shared, local)
        point, last = self._point(start, values, corrections), self.data.last_outputs

        def piece(bounds: tuple[int, int]) -> Array:
            return last.part(point, bounds, lambda: self._batch.simulate(*bounds, start, values, corrections)[0])

        return np.concatenate(map_in_threads(piece, self._work_ranges(), workers=self._threads))

    def cost(self, shared: Array, local: Array) -> float:
        """Return half the (robust) sum of squares and the prior's; infinite if any segment diverges."""
        mean, weight = self.initial_prior
        known = 0.5 * float(np.sum(weight * (local - mean) ** 2))
        return self.cost_of_outputs(self.simulated_outputs(shared, local), shared) + known

    def cost_of_outputs(self, simulated: Array, shared: Array) -> float:
        """Return the cost of simulated outputs, (rows, ny), and of the shared unknowns behind them."""
        if not np.all(np.isfinite(simulated)):
            return np.inf
        loss = float(np.sum(self._loss(self._scaled_residuals(simulated, slice(None)))[0]))
        return loss + self.prior_cost(shared)

    def prior_cost(self, shared: Array) -> float:
        """Return what priors and other data add to the cost."""
        return self._prior_cost(shared) + self._extra_cost(shared)

    def weighted_residuals(self, simulated: Array) -> Array:
        """Return the derivative of the cost by the simulated outputs, (rows, ny); 0 where nothing was measured."""
        scaled = self._scaled_residuals(simulated, slice(None))
        return self._loss(scaled)[1] * scaled / self.noise

    def segment_normals(self, shared: Array, local: Array) -> "SegmentNormals":
        """Return Gauss-Newton blocks of every segment, prior of shared unknowns left out."""
        start, values, corrections = self.unpack(shared, local)
        n, m = len(self.free) + self.unknowns_per_session, len(self.starts)
        by_actuator = self._actuator_slopes(values, corrections)

        def piece(bounds: tuple[int, int]) -> tuple[Array, Array, Array]:
            y, s = self._differentiate(bounds, start, values, corrections, by_actuator)
            base = self.data.offsets[bounds[0]]
            scaled = self._scaled_residuals(y, slice(base, base + len(y)))
            losses, weight = self._loss(scaled)
            root = np.sqrt(weight) * np.isfinite(self.data.measured[base : base + len(y)])
            scale, residuals = (root / self.noise)[:, :, None], root * scaled
            costs, gradients, hessians = [], [], []
            for k in range(*bounds):
                rows = slice(self.data.offsets[k] - base, self.data.offsets[k + 1] - base)
                jacobian = (s[rows] * scale[rows]).reshape(-1, n + m)  # of one segment: it stays in the cache
                costs.append(np.sum(losses[rows]))
                gradients.append(jacobian.T @ residuals[rows].ravel())
                hessians.append(jacobian.T @ jacobian)
            return np.array(costs), np.array(gradients), np.array(hessians)

        parts = map_in_threads(piece, self._work_ranges(), workers=self._threads)
        costs, gradients, hessians = (np.concatenate([p[i] for p in parts]) for i in range(3))
        mean, weight = self.initial_prior
        costs += 0.5 * np.sum(weight * (local - mean) ** 2, axis=1)
        gradients[:, n:] += weight * (local - mean)
        hessians[:, range(n, n + m), range(n, n + m)] += weight
        return SegmentNormals(costs, gradients, hessians, n)

    def slopes(self, shared: Array, local: Array) -> Array:
        """Derivatives of the outputs by a session's columns (`columns_of`), then by initial states, (rows, ny, n)."""
        start, values, corrections = self.unpack(shared, local)
        by_actuator = self._actuator_slopes(values, corrections)
        parts = map_in_threads(
            lambda p: self._differentiate(p, start, values, corrections, by_actuator)[1],
            self._work_ranges(),
            workers=self._threads,
        )
        return np.concatenate(parts)

    def sensitivities(self, shared: Array, local: Array) -> Array:
        """Rms slope of each output, in units of its noise, by each free parameter, (ny, free); initial states held."""
        start, values, corrections = self.unpack(shared, local)
        known = np.isfinite(self.data.measured)
        by_actuator = self._actuator_slopes(values, corrections)

        def piece(bounds: tuple[int, int]) -> Array:
            _, s = self._differentiate(bounds, start, values, corrections, by_actuator)
            rows = slice(self.data.offsets[bounds[0]], self.data.offsets[bounds[1]])
            return np.einsum("tyf,ty->yf", s[:, :, : len(self.free)] ** 2, known[rows].astype(float))

        total = np.sum(map_in_threads(piece, self._work_ranges(), workers=self._threads), axis=0)
        return np.sqrt(total / np.maximum(known.sum(axis=0), 1)[:, None]) / self.noise[:, None]

    def normal(self, shared: Array, local: Array) -> NormalEquations:
        """Return the Gauss-Newton model at a point."""
        return self.assemble(self.segment_normals(shared, local), shared, np.arange(self.data.count), with_prior=True)

    def assemble(
        self, blocks: "SegmentNormals", shared: Array, segments: Index, *, with_prior: bool
    ) -> NormalEquations:
        """Return the normal equations of some segments (all for the fit, those of one run for the jackknife).

        with_prior: whether what is known besides the records is in them: priors and other data.
        """
        n, gradient, hessian = blocks.shared, np.zeros(self.size), np.zeros((self.size, self.size))
        cross = np.zeros((len(segments), self.size, blocks.gradients.shape[1] - n))
        for session in np.unique(self.data.session[segments]):
            inside = np.flatnonzero(self.data.session[segments] == session)
            columns = self.columns_of(int(session))
            picked = segments[inside]
            gradient[columns] += blocks.gradients[picked, :n].sum(axis=0)
            hessian[np.ix_(columns, columns)] += blocks.hessians[picked, :n, :n].sum(axis=0)
            cross[np.ix_(inside, columns)] = blocks.hessians[picked, :n, n:]
        cost = float(blocks.costs[segments].sum())
        if with_prior:
            mean, weight = self.priors
            cost += self._prior_cost(shared)
            gradient += weight * (shared - mean)
            hessian += np.diag(weight)
            k = len(self.free)
            for other in self._active_terms:
                more = other.normal(self._parameter_values(shared), self._free_indices)
                cost += more.cost
                gradient[:k] += more.gradient
                hessian[:k, :k] += more.hessian
        return NormalEquations(
            cost, gradient, hessian, blocks.gradients[segments, n:], blocks.hessians[segments, n:, n:], cross
        )


@dataclass(frozen=True, eq=False)
class SegmentNormals:
    """Cost (s,), gradient (s, k) and Hessian (s, k, k) of each segment; the first `shared` columns are shared ones."""

    costs: Array
    gradients: Array
    hessians: Array
    shared: int


# Initial states put where they suit the shared unknowns best, at the price of one simulation.


@dataclass(frozen=True, eq=False)
class EliminatedStates:
    """The cost of an output-error problem by its shared unknowns alone, near an optimum.

    Initial states follow the shared unknowns along the optimum's normal equations; what a step of Gauss and Newton by
    the slopes there would still gain is taken off (variable projection; Golub & Pereyra 1973, SIAM J. Numer. Anal. 10,
    413).

    Attributes:
        shared, local, normal: the optimum and its normal equations.
        slopes: derivatives of the outputs by the initial states there, (rows, ny, m).
    """

    problem: OutputError
    shared: Array
    local: Array
    normal: NormalEquations
    slopes: Array

    @classmethod
    def about(cls, problem: OutputError, shared: Array, local: Array, normal: NormalEquations) -> "EliminatedStates":
        """Return the cost about an optimum, whose slopes are computed."""
        slopes = problem.slopes(shared, local)
        return cls(problem, shared, local, normal, slopes[:, :, slopes.shape[2] - local.shape[1] :])

    def states(self, shared: Array) -> Array:
        """Return the initial states that go with the shared unknowns, to first order, (segments, m)."""
        forces = np.einsum("snm,n->sm", self.normal.cross, shared - self.shared)
        return self.local - self.normal.solve_local(forces[:, :, None])[:, :, 0]

    def cost(self, shared: Array) -> float:
        """Return half the squares of residuals and priors at the best initial states; infinite where a run diverges."""
        simulated = self.problem.simulated_outputs(shared, self.states(shared))
        if not np.all(np.isfinite(simulated)):
            return np.inf
        pull = self.problem.weighted_residuals(simulated)
        gradient = np.add.reduceat(np.einsum("ty,tym->tm", pull, self.slopes), self.problem.data.offsets[:-1], axis=0)
        gain = self.normal.solve_local(gradient[:, :, None])[:, :, 0]
        return self.problem.cost_of_outputs(simulated, shared) - 0.5 * float(np.sum(gain * gradient))
