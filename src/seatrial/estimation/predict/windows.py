"""Windows of runs simulated open loop, all at once, each from a state estimated in its first seconds."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Index, InputError, Record, RecordKind
from seatrial.estimation.information.whiteness import autocorrelation, variance_inflation
from seatrial.estimation.predict.draws import StartStates, simulate_points
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import compared_outputs, segments_between
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.physics.simulate.replay import inputs_of

# Windows of runs simulated open loop, all at once: each from a state estimated in its first seconds, then inputs only.

MIN_STEPS = 4
"""Steps of the shortest window, and of the shortest beginning that an initial state is estimated from; chosen."""
INITIAL_SHARE = 0.2
"""Share of a window from which its initial state is estimated at most; chosen."""
_ROUNDING = 1e-9  # share of a step by which a length counts as a whole number of them; chosen


@dataclass(frozen=True, eq=False)
class Windows:
    """Stretches of one length of some runs.

    Attributes:
        records: whole runs, all of one time step.
        run: of each window the index of its run, (windows,); first: its first row there, (windows,).
        steps: number of steps of every window.
    """

    records: Sequence[Record]
    run: Index
    first: Index
    steps: int

    @classmethod
    def of_record(cls, record: Record) -> "Windows":
        """Return a run as one window."""
        return cls([record], np.zeros(1, dtype=np.int64), np.zeros(1, dtype=np.int64), len(record) - 1)

    @classmethod
    def cut(cls, records: Sequence[Record], seconds: float, each: int | None = None) -> "Windows":
        """Return windows that follow one another from each run's first sample; the remainder is dropped.

        each: the first so many of a run; None: all. A run shorter than a window has none.
        """
        steps = cls.steps_of(seconds, records[0].dt)
        counts = [(len(record) - 1) // steps for record in records]
        counts = counts if each is None else [min(n, each) for n in counts]
        first = np.concatenate([steps * np.arange(n) for n in counts])
        return cls(records, np.repeat(np.arange(len(records)), counts), first, steps)

    @staticmethod
    def steps_of(seconds: float, dt: float) -> int:
        """Return the number of steps of windows of this length."""
        return max(round(seconds / dt), MIN_STEPS)

    def __len__(self) -> int:
        return len(self.run)

    def initial_seconds(self, most: float) -> float:
        """Return the seconds of a window's beginning from which its initial state is estimated."""
        return min(most, INITIAL_SHARE * self.steps * self.dt)

    def evenly_spread(self, count: int) -> "Windows":
        """Return at most so many of them, evenly spread."""
        if len(self) <= count:
            return self
        return self.selected(np.unique(np.linspace(0, len(self) - 1, count).round().astype(np.int64)))

    def selected(self, indices: Index | slice) -> "Windows":
        """Return the chosen windows."""
        return replace(self, run=self.run[indices], first=self.first[indices])

    def beginnings(self, seconds: float) -> "Windows":
        """Return their first seconds, `MIN_STEPS` steps at least."""
        steps = max(int(seconds / self.dt * (1.0 + _ROUNDING)), MIN_STEPS)
        return replace(self, steps=min(steps, self.steps))

    @property
    def dt(self) -> float:
        """Time step [s]."""
        return self.records[0].dt

    @property
    def bounds(self) -> list[list[tuple[int, int]]]:
        """Of each run, first row and row behind the last of its windows."""
        rows = [self.first[self.run == i].tolist() for i in range(len(self.records))]
        return [[(a, a + self.steps + 1) for a in of_run] for of_run in rows]

    @cached_property
    def pieces(self) -> list[Record]:
        """The windows as records."""
        pairs = zip(self.run.tolist(), self.first.tolist(), strict=True)
        return [self.records[i].rows(slice(a, a + self.steps + 1)) for i, a in pairs]

    def inputs(self, model: Model) -> Array:
        """Return the inputs in the model's signs, (windows, steps + 1, nu).

        Raises:
            InputError: as `inputs_of`.
        """
        return np.stack([inputs_of(model, piece) for piece in self.pieces])


def simulate_windows(template: OutputError, model: Model, windows: Windows, nuisances: Array, states: Array) -> Array:
    """Return all observables of the model along each window, (windows, steps + 1, observables); NaN after a divergence.

    nuisances: of each run, (runs, k); states: initial states, (windows, nx).
    """
    point = np.array([model.parameters[name].value for name in template.free])
    points = np.tile(point, (len(windows), 1))
    return simulate_points(template, model, windows.dt, windows.inputs(model), states, points, nuisances[windows.run])


def like_window(window: Record, values: Mapping[str, Array]) -> Record:
    """Return a simulated record of the window's channels with these values."""
    channels = {c: window.channel(c).with_values(v) for c, v in values.items() if c in window}
    return replace(window, channels=channels, kind=RecordKind.SIMULATED)


# The state at the start of a window or run, estimated from its first seconds, and what it may be instead.

EVALUATIONS = 40
"""Of the search for what a run's first seconds show; chosen: a few are enough."""
_NEGLIGIBLE = 1e-4  # promised decrease at which it ends with a Newton step: 0.014 standard errors of a state; chosen
_LEAST_FREEDOM = 0.5  # share of effective samples that initial states leave free, at least; chosen


def start_states(
    template: OutputError, model: Model, windows: Windows, nuisances: Array, seconds: float
) -> StartStates:
    """Return the state at the start of each window, the model held.

    By output error from the first `seconds`; as measured where they are 0, and in windows that the model leaves from
    there within them. What follows the commands alone (thrusters) follows those of the whole run.

    Args:
        template: the problem whose outputs, noise and nuisances are used.
        nuisances: of each run, (runs, k).

    Raises:
        InputError: an input is missing, or time steps differ.
    """
    held = model.with_parameters(model.parameters.fixed(*model.parameters.names))
    outputs = template.data.outputs if seconds > 0.0 else compared_outputs(model, windows.records)
    beginnings = windows.beginnings(seconds)
    sessions = [str(i) for i in range(len(windows.records))]
    data = segments_between(held, windows.records, outputs, beginnings.bounds, sessions)
    problem = replace(template, model=held, data=data, pinned=nuisances.ravel(), inflation=None)
    local = problem.measured_initial_states()
    place = np.array([model.states.index(s) for s in problem.starts], dtype=np.int64)
    lasting = _lasting(problem, local) if seconds > 0.0 else np.zeros(0, dtype=np.int64)
    if not len(lasting):
        return StartStates.given(problem.unpack(nuisances.ravel(), local)[0], nuisances.shape[1])
    part = replace(problem, data=data.selected(lasting)) if len(lasting) < len(local) else problem
    estimated = levenberg_marquardt(
        part, nuisances.ravel(), local[lasting], negligible=_NEGLIGIBLE, evaluations=EVALUATIONS
    ).local
    local[lasting] = estimated
    values = problem.unpack(nuisances.ravel(), local)[0]

    def alternatives() -> tuple[Array, Array]:
        by_offsets, covariance = (
            np.zeros((*values.shape, nuisances.shape[1])),
            np.zeros((*values.shape, values.shape[1])),
        )
        by_offsets[np.ix_(lasting, place)], covariance[np.ix_(lasting, place, place)] = _alternatives(part, estimated)
        return by_offsets, covariance

    return StartStates(values, alternatives)


def _lasting(problem: OutputError, local: Array) -> Index:
    """Return the segments in which the model, begun there, does not diverge."""
    assert problem.pinned is not None
    y = problem.simulated_outputs(problem.pinned, local)
    return np.flatnonzero([np.isfinite(y[a:b]).all() for a, b in pairwise(problem.data.offsets)])


def _alternatives(problem: OutputError, local: Array) -> tuple[Array, Array]:
    """Derivatives of estimated initial states by offsets, (segments, m, k), and their covariance, (segments, m, m).

    At the optimum the gradient by the initial state stays zero: dx/do = -H_xx^-1 H_xo. The residuals of all segments
    give the noise of each channel and its colour: the covariance is H_xx^-1 J'WRWJ H_xx^-1 (Huber 1967).
    """
    assert problem.pinned is not None
    residuals = problem.simulated_outputs(problem.pinned, local) - problem.data.measured
    pieces = [residuals[a:b] for a, b in pairwise(problem.data.offsets)]
    lags = max(len(piece) for piece in pieces) - 1
    colour = np.array([
        variance_inflation(autocorrelation([piece[:, c] for piece in pieces], lags)) for c in range(residuals.shape[1])
    ])  # fmt: skip
    effective = np.maximum(np.isfinite(residuals).sum(axis=0), 1) / colour
    freedom = np.maximum(1.0 - local.size / len(colour) / effective, _LEAST_FREEDOM)
    variance = np.sum(np.nan_to_num(residuals) ** 2, axis=0) / (effective * freedom)
    noise = np.sqrt(np.maximum(variance, np.finfo(float).tiny))
    blocks = problem.segment_normals(problem.pinned, local)
    scatter = replace(problem, noise=problem.noise**2 / noise).segment_normals(problem.pinned, local)
    n = blocks.shared
    bread = np.linalg.pinv(blocks.hessians[:, n:, n:], hermitian=True)
    return -bread @ blocks.hessians[:, n:, :n], bread @ scatter.hessians[:, n:, n:] @ bread


# Windows of held-out runs simulated open loop: position and heading errors from an initial state estimated in each.

_TRACK = ("x0", "y0", "psi")


@dataclass(frozen=True)
class HoldoutProtocol:
    """How held-out runs are judged.

    Attributes:
        window_s: length of the windows; they follow one another from the first sample, the remainder is dropped.
        initial_s: the initial state of a window is estimated from its first seconds; 0 takes the first sample as it is.
        max_windows: number of windows of each run that count, from the first on; None: all.
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
    return Windows.cut([record], protocol.window_s, protocol.max_windows).pieces


def window_errors(
    template: OutputError,
    model: Model,
    records: Sequence[Record],
    nuisances: Sequence[Array],
    labels: Sequence[str],
    protocol: HoldoutProtocol,
    fold: int = 0,
) -> list[WindowError]:
    """Return errors of all windows of `records`, simulated open loop with `nuisances`, shape (kinds,) a record.

    A window in which position or heading is never measured has no error and is left out.
    template: the problem whose outputs, noise and nuisances are used to estimate initial states.

    Raises:
        InputError: a record lacks position or heading, no record holds a window, or a simulation diverges.
    """
    _require_track(records)
    windows, of_runs = Windows.cut(records, protocol.window_s, protocol.max_windows), np.stack(nuisances)
    if not len(windows):
        raise InputError(f"no run is as long as a window of {protocol.window_s:g} s; give shorter windows")
    states = start_states(template, model, windows, of_runs, protocol.initial_s).values
    place = [model.observables.index(model.observable_of(channel)) for channel in _TRACK]
    simulated = simulate_windows(template, model, windows, of_runs, states)[:, :, place]
    errors = []
    for piece, index, track in zip(windows.pieces, windows.run, simulated, strict=True):
        if not np.all(np.isfinite(track)):
            raise InputError(
                f"the simulation of run '{piece.name}' from {piece.time[0]:g} s diverges; check the bounds"
            )
        error = track - np.stack([piece.measured(channel) for channel in _TRACK], axis=1)
        if not np.all(np.any(np.isfinite(error), axis=0)):
            continue
        position = float(np.sqrt(np.nanmean(error[:, 0] ** 2) + np.nanmean(error[:, 1] ** 2)))
        heading = float(np.degrees(np.sqrt(np.nanmean(error[:, 2] ** 2))))
        errors.append(WindowError(piece.name, labels[int(index)], fold, float(piece.time[0]), position, heading))
    return errors


def _require_track(records: Sequence[Record]) -> None:
    for record in records:
        for channel in _TRACK:
            if channel not in record:
                raise InputError(
                    f"record '{record.name}' has no '{channel}'; windows are judged by position and heading"
                )
