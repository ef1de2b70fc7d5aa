"""States that follow the inputs alone (thrusters behind their lags): known from the commands of a run."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import NOTATION, Array, Index
from seatrial.physics.simulate.batch import InputCorrection, SegmentBatch
from seatrial.physics.simulate.steps import is_within_range, sufficient_substeps

_SETTLING_STEP_S = 0.05  # of a simulation until actuators have settled; chosen: the least lag there is
_SETTLING_S = 60.0
"""Time for which the first command of a run counts as given before it [s]: many times any lag; chosen."""


def actuator_states(model: Model) -> tuple[str, ...]:
    """Return the states without a measured channel whose rates hold inputs, parameters and states of this kind only."""
    nx, nu = len(model.states), len(model.inputs)
    unmeasured = {i for i, s in enumerate(model.states) if s not in NOTATION}
    if not unmeasured:
        return ()
    pattern = model.compiled.rates_pattern
    by_state = [{int(k) for i, k in pattern if i == row} for row in range(nx)]
    kept = {i for i in unmeasured if any(nx <= k < nx + nu for k in by_state[i])}
    while True:
        closed = {i for i in kept if all(k in kept for k in by_state[i] if k < nx)}
        if closed == kept:
            return tuple(s for i, s in enumerate(model.states) if i in kept)
        kept = closed


def settled_actuators(model: Model, inputs: Array) -> Array:
    """Return the state (nx,) in which what follows the inputs alone has settled at constant `inputs` (nu,), else 0."""
    from seatrial.physics.simulate.replay import trajectory

    state = np.zeros(len(model.states))
    names = actuator_states(model)
    if names:
        steps = round(_SETTLING_S / _SETTLING_STEP_S)
        states, _ = trajectory(model, np.tile(inputs, (steps + 1, 1)), _SETTLING_STEP_S, state)
        places = [model.states.index(name) for name in names]
        state[places] = states[-1, places]
    return state


@dataclass(frozen=True, eq=False)
class ActuatorHistory:
    """The commands of whole runs, from which actuator states follow at the start of each segment.

    Attributes:
        inputs: of all runs, end to end, (rows, nu), each run's first sample repeated before it until things settle.
        offsets: (runs + 1,), where each run's rows begin.
        run, row: of each segment, its run and the row of its first sample, both (segments,).
        session: of each run, (runs,).
        substeps: Runge-Kutta steps in a sample.
    """

    model: Model
    inputs: Array
    offsets: Index
    dt: float
    run: Index
    row: Index
    session: Index
    substeps: int = 1

    @classmethod
    def from_runs(
        cls, model: Model, inputs: Sequence[Array], dt: float, run: Index, first: Index, session: Index
    ) -> "ActuatorHistory | None":
        """Return the history of runs with inputs (rows, nu) each; None where the model has no actuator state.

        first: of each segment, the sample of its run with which it begins; session: of each segment.
        """
        names = actuator_states(model)
        if not names:
            return None
        lead = max(1, round(_SETTLING_S / dt))
        rows = [np.concatenate([np.repeat(u[:1], lead, axis=0), u]) for u in inputs]
        offsets = np.concatenate([[0], np.cumsum([len(r) for r in rows])]).astype(np.int64)
        segments = [np.flatnonzero(run == k) for k in range(len(inputs))]
        of_run = np.array([session[s[0]] if len(s) else 0 for s in segments], dtype=np.int64)
        row = offsets[run] + lead + first
        return cls(_actuators_only(model, names), np.concatenate(rows), offsets, dt, run, row, of_run)

    def selected(self, indices: Index) -> "ActuatorHistory":
        """Return the history for the chosen segments only."""
        return replace(self, run=self.run[indices], row=self.row[indices])

    @cached_property
    def states(self) -> tuple[str, ...]:
        """The actuator states."""
        return self.model.states

    def starts(self, parameters: Array, corrections: Array, kinds: tuple[InputCorrection, ...]) -> Array:
        """Return the states at the start of each segment, (segments, states).

        parameters: of each session, all of the model's, (sessions, np); corrections: of each session, (sessions, n).
        """
        batch = self._batch((), kinds)
        values = np.ascontiguousarray(parameters[self.session])
        rows, _ = batch.simulate(0, batch.segment_count, self._rest, values, corrections[self.session])
        return rows[self.row]

    def slopes(
        self, names: tuple[str, ...], parameters: Array, corrections: Array, kinds: tuple[InputCorrection, ...]
    ) -> Array:
        """Return the derivatives of `starts` by the named parameters, then by corrections, (segments, states, n)."""
        batch = self._batch(names, kinds)
        values = np.ascontiguousarray(parameters[self.session])
        _, slopes, _ = batch.differentiate(0, batch.segment_count, self._rest, values, corrections[self.session])
        return slopes[self.row]

    @property
    def _rest(self) -> Array:
        return np.zeros((len(self.offsets) - 1, len(self.model.states)))

    def _batch(self, names: tuple[str, ...], kinds: tuple[InputCorrection, ...]) -> SegmentBatch:
        return SegmentBatch(
            self.model, self.inputs, self.offsets, self.dt, self.model.states, names, kinds, (), self.substeps
        )


def actuator_motion(model: Model, inputs: Array, dt: float) -> dict[str, Array]:
    """Return the actuator states along inputs (n, nu), (n,) each, at the model's values; what is NaN diverged."""
    run = np.zeros(1, dtype=np.int64)
    history = ActuatorHistory.from_runs(model, (inputs,), dt, run, run, run)
    if history is None:
        return {}
    every = replace(history, run=np.zeros(len(inputs), dtype=np.int64), row=history.row[0] + np.arange(len(inputs)))

    def motion(substeps: int) -> Array:
        return replace(every, substeps=substeps).starts(model.parameters.values[None], np.zeros((1, 0)), ())

    columns = motion(sufficient_substeps(motion, is_within_range))
    return dict(zip(every.states, columns.T, strict=True))


def _actuators_only(model: Model, names: tuple[str, ...]) -> Model:
    """The equations of these states alone, with all parameters."""
    equations = model.equations
    rates = tuple(rate for rate in equations.rates if rate.name in names)
    return replace(model, equations=replace(equations, name=f"{equations.name}, actuators", rates=rates, outputs=()))
