"""Output error of one whole record of an affine model whose states are measured: `OutputError` without its overhead.

Nothing but coefficients and initial states is estimated, residuals are white and count squared. Cost, gradient and
Hessian are those of `OutputError`; an evaluation is some tens of microseconds where a record has some hundred samples.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Index, InputError
from seatrial.estimation.problem.segments import Segments
from seatrial.numerics.kernels.kernel import TangentPointer
from seatrial.numerics.kernels.linear_fit import residuals_and_jacobian
from seatrial.numerics.optimise import NormalEquations
from seatrial.physics.simulate.linear import LinearBatch


@dataclass(frozen=True, eq=False)
class LinearOutputError:
    """Shared unknowns: the free parameters. Local: the initial states named in `starts`, shape (1, len(starts)).

    Attributes:
        data: one segment, its outputs all states of the model.
        noise: standard deviation of each output, shape (ny,), SI.
        initial_state: shape (nx,), where it is known; the entries of `starts` are not used.

    Raises:
        InputError: on construction, where the problem is not of this kind.
    """

    model: Model
    data: Segments
    noise: Array
    initial_state: Array
    starts: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        why = self._reason_unsuitable()
        if why:
            raise InputError(f"{why}; use the output error over segments")

    def _reason_unsuitable(self) -> str:
        states, parameters = self.model.states, self.model.parameters
        if not self.model.is_affine:
            return f"model '{self.model.name}' is not linear in its states"
        if self.data.count != 1:
            return f"there are {self.data.count} segments, not one whole record"
        other = [o for o in self.data.outputs if o not in states]
        if other:
            return f"channel '{other[0]}' is no state of model '{self.model.name}'"
        with_prior = [n for n in parameters.free_names if parameters[n].prior is not None]
        if with_prior:
            return f"parameter '{with_prior[0]}' has a prior"
        if np.shape(self.initial_state) != (len(states),) or not np.all(np.isfinite(self.initial_state)):
            return f"the initial state must be {len(states)} finite values, got {self.initial_state}"
        if np.shape(self.noise) != (len(self.data.outputs),) or not np.all(self.noise > 0.0):
            return f"noise must be positive, one value for each of {', '.join(self.data.outputs)}"
        return ""

    @property
    def lower(self) -> Array:
        """Lower bounds of the free parameters."""
        return self._bounds[0]

    @property
    def upper(self) -> Array:
        """Upper bounds of the free parameters."""
        return self._bounds[1]

    def start(self) -> Array:
        """Return values of the free parameters in the model."""
        return self._values[self._free_indices]

    def given_initial_states(self) -> Array:
        """Return initial states as given, where the search for them begins; (1, len(starts))."""
        return self.initial_state[None, self._start_indices]

    def cost(self, shared: Array, local: Array) -> float:
        """Return half the sum of squares; infinite if the run diverges. Slopes come along and are kept for `normal`."""
        made = self.normal(shared, local)
        self._last_evaluation[:] = [(shared.tobytes(), local.tobytes(), made)]
        return made.cost

    def normal(self, shared: Array, local: Array) -> NormalEquations:
        """Return the Gauss-Newton model at a point; its cost infinite if the run diverges."""
        for at, start, made in self._last_evaluation:
            if at == shared.tobytes() and start == local.tobytes():
                return made
        return self._linearised(shared, local)

    def _linearised(self, shared: Array, local: Array) -> NormalEquations:
        n, m = len(self._free_indices), len(self.starts)
        used, straight = self._active_columns
        made = residuals_and_jacobian(
            self._rates, len(self.model.inputs), self._free_indices, used, straight, self._parameter_values(shared),
            self._step, self._input_rows, self._substeps, self._initial_state(local), self._start_columns, n + m,
            *self._comparison,
        )  # fmt: skip
        if made is None:
            return NormalEquations(
                np.inf,
                np.full(n, np.nan),
                np.full((n, n), np.nan),
                np.full((1, m), np.nan),
                np.full((1, m, m), np.nan),
                np.full((1, n, m), np.nan),
            )
        residual, jacobian = made
        gradient, hessian = residual @ jacobian, jacobian.T @ jacobian
        cost = 0.5 * float(residual @ residual)
        return NormalEquations(
            cost, gradient[:n], hessian[:n, :n], gradient[None, n:], hessian[None, n:, n:], hessian[None, :n, n:]
        )

    def _parameter_values(self, shared: Array) -> Array:
        values = self._values.copy()
        values[self._free_indices] = shared
        return values

    def _initial_state(self, local: Array) -> Array:
        if not self.starts:
            return self.initial_state
        begin = self.initial_state.copy()
        begin[self._start_indices] = local[0]
        return begin

    @cached_property
    def _last_evaluation(self) -> list[tuple[bytes, bytes, NormalEquations]]:
        """The point whose cost was computed last: a search that takes the step needs its slopes next."""
        return []

    @cached_property
    def _rates(self) -> TangentPointer:
        return TangentPointer(self.model.compiled.rates_tangent)

    @cached_property
    def _values(self) -> Array:
        return np.array(self.model.parameters.values)

    @cached_property
    def _free_indices(self) -> Index:
        parameters = self.model.parameters
        return np.array([parameters.index(n) for n in parameters.free_names], dtype=np.int64)

    @cached_property
    def _bounds(self) -> tuple[Array, Array]:
        free = self.model.parameters.free
        return np.array([p.lower for p in free]), np.array([p.upper for p in free])

    @cached_property
    def _start_indices(self) -> Index:
        return np.array([self.model.states.index(s) for s in self.starts], dtype=np.int64)

    @cached_property
    def _start_columns(self) -> Index:
        """Jacobian column of each initial state, or -1."""
        columns = np.full(len(self.initial_state), -1, dtype=np.int64)
        columns[self._start_indices] = len(self._free_indices) + np.arange(len(self.starts))
        return columns

    @cached_property
    def _comparison(self) -> tuple[Index, Array, Array]:
        select = np.array([self.model.states.index(o) for o in self.data.outputs], dtype=np.int64)
        return select, np.ascontiguousarray(self.data.measured), 1.0 / np.asarray(self.noise, dtype=np.float64)

    @cached_property
    def _fine_inputs(self) -> tuple[Array, int]:
        d = self.data
        return LinearBatch(self.model, d.inputs, d.offsets, d.dt, d.outputs).fine_inputs(0)

    @cached_property
    def _substeps(self) -> int:
        return self._fine_inputs[1]

    @cached_property
    def _step(self) -> float:
        return self.data.dt / self._substeps

    @cached_property
    def _active_columns(self) -> tuple[Index, Index]:
        """Columns of [inputs | 1] that are not zero throughout, and those places among them that run straight."""
        used = np.flatnonzero(np.any(self._fine_inputs[0] != 0.0, axis=0)).astype(np.int64)
        held = [i.is_held for i in self.model.inputs] + [True]
        return used, np.array([k for k, j in enumerate(used) if not held[j]], dtype=np.int64)

    @cached_property
    def _input_rows(self) -> Array:
        used, straight = self._active_columns
        fine = self._fine_inputs[0]
        return np.ascontiguousarray(np.hstack([fine[:-1, used], fine[1:, used[straight]]]))
