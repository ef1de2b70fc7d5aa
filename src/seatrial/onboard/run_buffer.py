"""Samples as raw records, as a file of the same lines would have given them."""

from array import array
from dataclasses import replace

import numpy as np

from seatrial.core.results.online import Sample
from seatrial.core.values import Record
from seatrial.data.read import Layout
from seatrial.data.read.assemble import record_from_values
from seatrial.data.trial import Role, Trial
from seatrial.data.trial.runs import require_stream
from seatrial.data.trial.trial import TrialRun

# a record needs a time step
_MIN_SAMPLES = 2


class RunBuffer:
    """Keeps every sample accepted, run by run, at eight bytes a number."""

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self._runs: list[tuple[str, array[float]]] = []

    def start_run(self, name: str) -> None:
        """Begin a run."""
        self._runs.append((name, array("d")))

    def add(self, sample: Sample) -> None:
        """Append a sample to the run begun last."""
        rows = self._runs[-1][1]
        rows.append(sample.time)
        rows.frombytes(sample.values.tobytes())

    def records(self) -> tuple[Record, ...]:
        """Return the runs of two samples and more as records, in order."""
        width = 1 + len(self._layout.columns)
        tables = [(name, np.frombuffer(rows, dtype=np.float64).reshape(-1, width)) for name, rows in self._runs]
        return tuple(
            record_from_values(name, self._layout, table[:, 0], table[:, 1:])
            for name, table in tables
            if len(table) >= _MIN_SAMPLES
        )


def with_training_records(trial: Trial, records: tuple[Record, ...]) -> Trial:
    """Return the trial with these records as training runs, behind its own and before all other runs."""
    waves = require_stream(trial).waves
    came = tuple(TrialRun(record, waves=waves) for record in records)
    others = tuple(run for run in trial.runs if run.role is not Role.TRAIN)
    return replace(trial, runs=(*trial.runs_with_role(Role.TRAIN), *came, *others))
