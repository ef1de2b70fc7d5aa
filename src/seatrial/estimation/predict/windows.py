"""Windows of runs simulated open loop, all at once: each from a state estimated in its first seconds, then inputs only.

A whole run is one window.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Index, Record, RecordKind
from seatrial.estimation.predict.draws import simulate_points
from seatrial.estimation.problem.output_error import OutputError
from seatrial.physics.simulate.replay import inputs_of

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
