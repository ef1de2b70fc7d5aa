"""Windows of runs simulated open loop, all at once: each from a state estimated in its first seconds, then inputs only.

A whole run is one window.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Index, Record, RecordKind
from seatrial.estimation.information.autocorrelation import autocorrelation, variance_inflation
from seatrial.estimation.predict.draws import StartStates, simulate_points
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import compared_outputs, segments_between
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.physics.simulate.channels import inputs_of

MIN_STEPS = 4
"""Steps of the shortest window, and of the shortest beginning that an initial state is estimated from; chosen."""
_EVALUATIONS = 40  # of the search for initial states; chosen: a few are enough
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
        steps = max(round(seconds / records[0].dt), MIN_STEPS)
        counts = [(len(record) - 1) // steps for record in records]
        counts = counts if each is None else [min(n, each) for n in counts]
        first = np.concatenate([steps * np.arange(n) for n in counts])
        return cls(records, np.repeat(np.arange(len(records)), counts), first, steps)

    def __len__(self) -> int:
        return len(self.run)

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
    local, kinds = problem.measured_initial_states(), nuisances.shape[1]
    place = [model.states.index(s) for s in problem.starts]
    by_offsets = np.zeros((len(local), len(model.states), kinds))
    covariance = np.zeros((len(local), len(model.states), len(model.states)))
    if seconds > 0.0:
        y = problem.simulated_outputs(nuisances.ravel(), local)
        lasting = np.flatnonzero([np.isfinite(y[a:b]).all() for a, b in pairwise(data.offsets)])
        if len(lasting):
            part = replace(problem, data=data.selected(lasting)) if len(lasting) < len(local) else problem
            local[lasting] = levenberg_marquardt(
                part, nuisances.ravel(), local[lasting], evaluations=_EVALUATIONS
            ).local
            by_offsets[np.ix_(lasting, place)], covariance[np.ix_(lasting, place, place)] = _what_they_may_be(
                part, local[lasting]
            )
    return StartStates(problem.unpack(nuisances.ravel(), local)[0], by_offsets, covariance)


def _what_they_may_be(problem: OutputError, local: Array) -> tuple[Array, Array]:
    """Derivatives of estimated initial states by offsets, (segments, m, k), and their covariance, (segments, m, m).

    At the optimum the gradient by the initial state stays zero: dx/do = -H_xx^-1 H_xo. The residuals of all segments
    give the noise of each channel and its colour: the covariance is H_xx^-1 J'WRWJ H_xx^-1 (Huber 1967).
    """
    assert problem.pinned is not None
    residuals = problem.simulated_outputs(problem.pinned, local) - problem.data.measured
    measured = np.isfinite(residuals)
    freedom = 1.0 - local.size / max(int(measured.sum()), local.size + 1)
    variance = np.mean(np.where(measured, residuals, 0.0) ** 2, axis=0) / np.mean(measured, axis=0) / freedom
    pieces = [residuals[a:b] for a, b in pairwise(problem.data.offsets)]
    lags = max(len(piece) for piece in pieces) - 1
    variance *= [variance_inflation(autocorrelation([p[:, c] for p in pieces], lags)) for c in range(len(variance))]
    noise = np.sqrt(np.maximum(variance, np.finfo(float).tiny))
    blocks = problem.segment_normals(problem.pinned, local)
    scatter = replace(problem, noise=problem.noise**2 / noise).segment_normals(problem.pinned, local)
    n = blocks.shared
    bread = np.linalg.pinv(blocks.hessians[:, n:, n:], hermitian=True)
    return -bread @ blocks.hessians[:, n:, :n], bread @ scatter.hessians[:, n:, n:] @ bread


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
