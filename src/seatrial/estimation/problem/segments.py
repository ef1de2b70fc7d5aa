"""Records cut into segments: the data of an output-error problem as arrays."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Index, InputError, Record, channel_hint
from seatrial.estimation.problem.initial_states import Beginnings
from seatrial.numerics.resolution import resolution
from seatrial.physics.sensors import Sensors
from seatrial.physics.simulate.batch import RunInputs
from seatrial.physics.simulate.replay import inputs_of
from seatrial.physics.simulate.states import ActuatorHistory


@dataclass(frozen=True, eq=False)
class Segments:
    """Segments laid end to end.

    Attributes:
        inputs: (rows, nu) in the model's signs; measured: (rows, ny), NaN where nothing was measured.
        offsets: (segments + 1,); run, session: (segments,), indices into `runs` and `sessions`.
        outputs: observables that are compared, in order; dt: s.
        history: commands of the whole runs, where the model has states that follow them; None: it has none.
        beginnings: what the whole runs say of the first rows; None: nothing.
        run_inputs: inputs of the whole runs, from which delayed ones are taken; None: the segments' own alone.
    """

    inputs: Array
    measured: Array
    offsets: Index
    run: Index
    session: Index
    runs: tuple[str, ...]
    sessions: tuple[str, ...]
    outputs: tuple[str, ...]
    dt: float
    history: ActuatorHistory | None = None
    beginnings: Beginnings | None = None
    run_inputs: RunInputs | None = None

    @cached_property
    def rounding_noise(self) -> Array:
        """Standard deviation of the rounding of each output's values, (ny,), SI: of a uniform error of one step."""
        columns = (column[np.isfinite(column)] for column in self.measured.T)
        return np.array([resolution(column) for column in columns]) / np.sqrt(12.0)  # Widrow & Kollar 2008

    @property
    def count(self) -> int:
        """Number of segments."""
        return len(self.run)

    def run_segments(self, run: int) -> Index:
        """Return the segments of a run."""
        return np.flatnonzero(self.run == run)

    def selected(self, indices: Index) -> "Segments":
        """Only the chosen segments, in that order, repeated where one is chosen twice; runs and sessions stay."""
        rows = [np.arange(int(self.offsets[s]), int(self.offsets[s + 1])) for s in indices]
        kept = np.concatenate(rows)
        return replace(
            self,
            inputs=np.ascontiguousarray(self.inputs[kept]),
            measured=self.measured[kept],
            offsets=np.concatenate([[0], np.cumsum([len(r) for r in rows])]).astype(np.int64),
            run=self.run[indices],
            session=self.session[indices],
            history=None if self.history is None else self.history.selected(indices),
            beginnings=None if self.beginnings is None else self.beginnings.selected(indices),
            run_inputs=None if self.run_inputs is None else self.run_inputs.selected(indices),
        )


def _still_channels(model: Model) -> tuple[str, ...]:
    """Positions that a model of steering alone leaves where they are: its speed U is fixed at 0."""
    names = model.parameters.names
    if "u" in model.states or "U" not in names:
        return ()
    speed = model.parameters["U"]
    return () if speed.free or speed.value else ("x0", "y0")


def compared_outputs(model: Model, records: Sequence[Record], requested: Sequence[str] = ()) -> tuple[str, ...]:
    """Return observables of the model that at least one record holds; only the wanted ones where some are named.

    Raises:
        InputError: there is none, or a wanted one is no observable of the model or in no record.
    """
    still = _still_channels(model)
    found = tuple(o for o in model.channels if o not in still and any(o in r for r in records))
    for name in requested:
        if name in still:
            raise InputError(
                f"channel '{name}' cannot be compared: model '{model.name}' has no position while its speed U is 0; "
                "give U under [model.fixed], or free it"
            )
        if name not in found:
            raise InputError(f"channel '{name}' cannot be compared{channel_hint(name, list(found))}")
    if not found:
        raise InputError(f"no record holds any output of model '{model.name}': {', '.join(model.observables)}")
    return tuple(o for o in found if not requested or o in requested)


def _measured(model: Model, record: Record, outputs: tuple[str, ...]) -> Array:
    """Return the outputs of a record, (rows, ny): NaN where it holds none, or only runs on from a reading.

    Repeated positions count as such as well where the trial says that they stay between fixes.
    """
    measured = np.stack([record.measured(o) if o in record else np.full(len(record), np.nan) for o in outputs], axis=1)
    if not model.equations.sensors or not Sensors.from_text(model.equations.sensors).position_hold:
        return measured
    columns = [i for i, output in enumerate(outputs) if output in ("x0", "y0")]
    is_held = np.all(np.diff(measured[:, columns], axis=0, prepend=np.nan) == 0.0, axis=1)
    measured[np.ix_(is_held, columns)] = np.nan
    return measured


def _segment_bounds(rows: int, length: int) -> list[tuple[int, int]]:
    """Return overlapping-by-one pieces of about `length` steps, as even as possible."""
    steps = rows - 1
    pieces = max(1, round(steps / length))
    edges = np.linspace(0, steps, pieces + 1).round().astype(int)
    return [(int(a), int(b) + 1) for a, b in pairwise(edges)]


def cut_segments(
    model: Model,
    records: Sequence[Record],
    outputs: tuple[str, ...],
    segment_seconds: float | None,
    sessions: Sequence[str] | None = None,
) -> Segments:
    """Cut records (all of one time step) into pieces of about `segment_seconds`; None keeps whole runs.

    Neighbouring pieces share one sample. Each record belongs to the session of the same index (default: its own).

    Raises:
        InputError: time steps differ, or a record has fewer than three samples.
    """
    lengths = [
        len(r) - 1 if segment_seconds is None else max(2, round(segment_seconds / records[0].dt)) for r in records
    ]
    bounds = [_segment_bounds(len(record), length) for record, length in zip(records, lengths, strict=True)]
    return segments_between(model, records, outputs, bounds, sessions)


def segments_between(
    model: Model,
    records: Sequence[Record],
    outputs: tuple[str, ...],
    bounds: Sequence[Sequence[tuple[int, int]]],
    sessions: Sequence[str] | None = None,
) -> Segments:
    """Cut records (all of one time step) at the given rows: of each record, first row and row behind the last.

    Rows in no segment still count as commands given before it. Sessions as in `cut_segments`.

    Raises:
        InputError: as `cut_segments`.
    """
    dt = records[0].dt
    of_runs, inputs, measured, firsts, lengths, runs, beginnings = [], [], [], [], [], [], []
    for index, (record, of_record) in enumerate(zip(records, bounds, strict=True)):
        if abs(record.dt - dt) > 1e-3 * dt:  # share by which time steps may differ; chosen
            raise InputError(
                f"record '{record.name}' has a time step of {record.dt:g} s, the first one {dt:g} s; give one: "
                f"rate = {1.0 / dt:.4g} under [[records]]"
            )
        if len(record) < 3:
            raise InputError(f"record '{record.name}' has {len(record)} samples; at least three are needed")
        u = inputs_of(model, record)
        y = _measured(model, record, outputs)
        of_runs.append(u)
        beginnings.append(Beginnings.of_run(y, outputs, dt, of_record))
        for first, last in of_record:
            inputs.append(u[first:last])
            firsts.append(first)
            measured.append(y[first:last])
            lengths.append(last - first)
            runs.append(index)
    names = tuple(r.name for r in records)
    of_run = tuple(sessions) if sessions is not None else names
    distinct = tuple(dict.fromkeys(of_run))
    run = np.array(runs, dtype=np.int64)
    session = np.array([distinct.index(of_run[i]) for i in runs], dtype=np.int64)
    return Segments(
        np.concatenate(inputs),
        np.concatenate(measured),
        np.concatenate([[0], np.cumsum(lengths)]).astype(np.int64),
        run,
        session,
        names,
        distinct,
        outputs,
        dt,
        ActuatorHistory.from_runs(model, of_runs, dt, run, np.array(firsts, dtype=np.int64), session),
        Beginnings.joined(beginnings),
        _run_inputs(of_runs, run, np.array(firsts, dtype=np.int64)),
    )


def _run_inputs(inputs: Sequence[Array], run: Index, first: Index) -> RunInputs:
    """Return the inputs of whole runs, (rows, nu) each; run, first: of each segment, and its first row in that run."""
    edges = np.concatenate([[0], np.cumsum([len(u) for u in inputs])]).astype(np.int64)
    place = np.column_stack([edges[run] + first, edges[run], edges[run + 1]])
    return RunInputs(np.concatenate(inputs), np.ascontiguousarray(place, dtype=np.int64))
