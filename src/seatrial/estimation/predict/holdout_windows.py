"""Windows of held-out runs simulated open loop: position and heading errors from an initial state estimated in each."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Record
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.predict.open_loop import mean_nuisances
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.numerics.optimise import levenberg_marquardt

_TRACK = ("x0", "y0", "psi")


@dataclass(frozen=True)
class HoldoutProtocol:
    """How held-out runs are judged.

    Attributes:
        window_s: length of the windows; they follow one another from the first sample, the remainder is dropped.
        initial_s: the initial state of a window is estimated from its first seconds; 0 takes the first sample as it is.
        first: number of windows of each run that count; None: all.
    """

    window_s: float = 50.0
    initial_s: float = 5.0
    max_windows: int | None = None


@dataclass(frozen=True)
class WindowError:
    """Root-mean-square error of one window: position in m, heading in degrees; `start` in s."""

    run: str
    label: str
    fold: int
    start: float
    position_m: float
    heading_deg: float


def split_windows(record: Record, protocol: HoldoutProtocol) -> list[Record]:
    """Return the record's windows, one after another; empty where it is shorter than one."""
    steps = round(protocol.window_s / record.dt)
    count = (len(record) - 1) // steps
    return [record.rows(slice(i * steps, (i + 1) * steps + 1)) for i in range(count)][: protocol.max_windows]


@dataclass(frozen=True, eq=False)
class _WindowSet:
    """Stretches of records with the record each comes from; `owns` holds the nuisances of each record."""

    records: list[Record]
    record_indices: list[int]
    nuisances: Sequence[Array]

    @classmethod
    def from_records(
        cls, records: Sequence[Record], nuisances: Sequence[Array], protocol: HoldoutProtocol
    ) -> "_WindowSet":
        cut_up = [split_windows(record, protocol) for record in records]
        whose = [i for i, found in enumerate(cut_up) for _ in found]
        if not whose:
            raise InputError(f"no run is as long as a window of {protocol.window_s:g} s; give shorter windows")
        return cls([piece for found in cut_up for piece in found], whose, nuisances)

    def first_seconds(self, seconds: float) -> "_WindowSet":
        """Return their first seconds, five samples at least."""
        short = [p.between(p.time[0], p.time[0] + max(seconds, 4 * p.dt)) for p in self.records]
        return replace(self, records=short)

    def problem(self, template: OutputError, model: Model, outputs: tuple[str, ...]) -> tuple[OutputError, Array]:
        """Return one segment a piece with everything but initial states pinned, and the pinned unknowns."""
        fixed = model.with_parameters(model.parameters.fixed(*model.parameters.names))
        data = cut_segments(fixed, self.records, outputs, None, [str(i) for i in self.record_indices])
        pinned = np.concatenate([self.nuisances[int(i)] for i in data.sessions])
        place = {o: i for i, o in enumerate(template.data.outputs)}
        noise = np.array([template.noise[place[o]] if o in place else 1.0 for o in outputs])
        return replace(template, model=fixed, data=data, noise=noise, inflation=None, pinned=pinned), pinned


def _initial_states(template: OutputError, model: Model, pieces: _WindowSet, seconds: float) -> dict[str, Array]:
    """Initial states by name, each (pieces,): estimated from the first seconds, as measured where `seconds` is 0."""
    if seconds <= 0:
        count = len(pieces.records)
        return {
            s: np.array([p[s][0] for p in pieces.records]) if s in pieces.records[0] else np.zeros(count)
            for s in model.states
        }
    problem, pinned = pieces.first_seconds(seconds).problem(template, model, template.data.outputs)
    found = levenberg_marquardt(problem, pinned, problem.measured_initial_states(), evaluations=40)
    return dict(zip(problem.starts, found.local.T, strict=True))


def window_errors(
    template: OutputError,
    model: Model,
    records: Sequence[Record],
    nuisances: Sequence[Array],
    labels: Sequence[str],
    protocol: HoldoutProtocol,
    fold: int = 0,
) -> list[WindowError]:
    """Errors of all windows of `records`, simulated open loop with the nuisances `owns`, shape (kinds,) a record.

    A window in which position or heading is never measured has no error and is left out.
    template: the problem whose outputs, noise and nuisances are used to estimate initial states.

    Raises:
        InputError: a record lacks position or heading, no record holds a window, or a simulation diverges.
    """
    _require_track(records)
    pieces = _WindowSet.from_records(records, nuisances, protocol)
    start = _initial_states(template, model, pieces, protocol.initial_s)
    problem, pinned = pieces.problem(template, model, _TRACK)
    simulated = problem.simulated_outputs(pinned, np.stack([start[s] for s in problem.starts], axis=1))
    errors = []
    for piece, index, (a, b) in zip(pieces.records, pieces.record_indices, pairwise(problem.data.offsets), strict=True):
        if not np.all(np.isfinite(simulated[a:b])):
            raise InputError(
                f"the simulation of run '{piece.name}' from {piece.time[0]:g} s diverges; check the bounds"
            )
        error = simulated[a:b] - problem.data.measured[a:b]
        if not np.all(np.any(np.isfinite(error), axis=0)):
            continue
        position = float(np.sqrt(np.nanmean(error[:, 0] ** 2 + error[:, 1] ** 2)))
        heading = float(np.degrees(np.sqrt(np.nanmean(error[:, 2] ** 2))))
        errors.append(WindowError(piece.name, labels[index], fold, float(piece.time[0]), position, heading))
    return errors


def _require_track(records: Sequence[Record]) -> None:
    for record in records:
        for channel in _TRACK:
            if channel not in record:
                raise InputError(
                    f"record '{record.name}' has no '{channel}'; windows are judged by position and heading"
                )


def session_nuisances(estimation: Estimation, session: str) -> Array:
    """Nuisances of a session: its own estimate where it was in training, else the training mean; shape (kinds,)."""
    problem, shared = estimation.estimate.problem, estimation.estimate.common_parameters
    if session not in problem.data.sessions:
        return mean_nuisances(problem, shared)
    return shared[problem.columns_of(problem.data.sessions.index(session))[len(problem.free) :]]
