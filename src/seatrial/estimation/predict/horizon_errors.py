"""How far predictions over a few seconds miss: windows of a run, each from a state estimated in its first second."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Index, Record
from seatrial.estimation.predict.holdout_windows import HoldoutProtocol, split_windows
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.physics.simulate.actuators import ActuatorHistory
from seatrial.physics.simulate.channels import inputs_of

INITIAL_S = 1.0
"""Length of a window's beginning from which its state is estimated [s]; chosen."""
_CHANNELS = ("u", "v", "r", "psi", "x0", "y0")
_EVALUATIONS = 40  # of the search for initial states, as elsewhere in predictions


@dataclass(frozen=True, eq=False)
class WindowPredictions:
    """Windows of runs and their predictions.

    Attributes:
        run: index of the run that each window is from, (windows,); offsets: first row of each window and the end.
        errors: channel -> prediction minus measurement at every sample, (rows,); NaN where nothing was measured.
        measured: channel -> values, (rows,), SI.
    """

    run: Index
    offsets: Index
    errors: dict[str, Array]
    measured: dict[str, Array]

    def rms(self, run: int | None = None) -> dict[str, float]:
        """Return rms errors of a run, of all without one: u, v [m/s], r [rad/s], psi [deg], position [m].

        A window that diverges makes them infinite.
        """
        chosen = np.ones(len(self.run), bool) if run is None else self.run == run
        rows = np.repeat(chosen, np.diff(self.offsets))
        errors = {c: e[rows] for c, e in self.errors.items()}
        scores = {c: _rms(errors[c]) for c in ("u", "v", "r") if c in errors}
        if "psi" in errors:
            scores["psi_deg"] = float(np.degrees(_rms(errors["psi"])))
        if {"x0", "y0"} <= set(errors):
            scores["position_m"] = float(np.hypot(_rms(errors["x0"]), _rms(errors["y0"])))
        return scores


def _rms(values: Array) -> float:
    return float(np.sqrt(np.nanmean(values**2)))


def predict_windows(
    template: OutputError,
    model: Model,
    records: Sequence[Record],
    nuisances: Sequence[Array],
    window_s: float,
    initial_s: float = INITIAL_S,
) -> WindowPredictions:
    """Predict all windows of records open loop, one after another from the first sample, the remainder dropped.

    What follows the commands alone (thrusters) is worked out from those of the whole record; runs shorter than a window
    have none.

    template: the problem whose outputs, noise and nuisances are used; nuisances: of each record, (kinds,) each.
    """
    protocol = HoldoutProtocol(window_s, initial_s)
    windows = [split_windows(record, protocol) for record in records]
    run = np.array([i for i, pieces in enumerate(windows) for _ in pieces])
    pieces = [piece for found in windows for piece in found]
    fixed = model.with_parameters(model.parameters.fixed(*model.parameters.names))
    beginnings = [p.between(p.time[0], p.time[0] + max(initial_s, 4 * p.dt)) for p in pieces]
    whole = _Origin(
        records, run, np.concatenate([np.arange(len(found)) for found in windows]) * round(window_s / pieces[0].dt)
    )
    problem, pinned = _pinned(template, fixed, beginnings, whole, nuisances)
    local = levenberg_marquardt(problem, pinned, problem.measured_initial_states(), evaluations=_EVALUATIONS).local
    problem, pinned = _pinned(template, fixed, pieces, whole, nuisances)
    simulated, data = problem.simulated_outputs(pinned, local), problem.data
    simulated = np.where(np.isfinite(simulated), simulated, np.inf)
    columns = {c: data.outputs.index(c) for c in _CHANNELS if c in data.outputs}
    return WindowPredictions(
        run,
        data.offsets,
        {c: simulated[:, k] - data.measured[:, k] for c, k in columns.items()},
        {c: data.measured[:, k] for c, k in columns.items()},
    )


@dataclass(frozen=True, eq=False)
class _Origin:
    """Where windows are from: records, and of each window the index of its record and its first row there."""

    records: Sequence[Record]
    run: Index
    row: Index


def _pinned(
    template: OutputError, model: Model, pieces: Sequence[Record], origin: _Origin, nuisances: Sequence[Array]
) -> tuple[OutputError, Array]:
    """One segment a window with everything but initial states held, and the unknowns held."""
    data = cut_segments(model, pieces, template.data.outputs, None, [str(i) for i in origin.run])
    kept, run = np.unique(origin.run, return_inverse=True)
    inputs = [inputs_of(model, origin.records[i]) for i in kept]
    history = ActuatorHistory.from_runs(model, inputs, data.dt, run, origin.row, data.session)
    pinned = np.concatenate([nuisances[int(i)] for i in data.sessions])
    data = replace(data, history=history)
    return replace(template, model=model, data=data, inflation=None, pinned=pinned), pinned
