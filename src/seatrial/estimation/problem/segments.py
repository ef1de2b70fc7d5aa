"""Records cut into segments, the data of a problem as arrays, and the states with which segments begin."""

import math
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from itertools import pairwise
from typing import Generic, TypeVar

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Index, InputError, Record, channel_hint
from seatrial.core.values.arrays import Mask
from seatrial.numerics.resolution import resolution
from seatrial.physics.sensors import Sensors
from seatrial.physics.sensors.measured_outputs import is_late
from seatrial.physics.simulate.batch import RunInputs
from seatrial.physics.simulate.replay import inputs_of
from seatrial.physics.simulate.states import ActuatorHistory

Part = TypeVar("Part")

# The states with which segments begin, as they were measured: where a search starts.

_VELOCITIES, TRACK = ("u", "v"), ("x0", "y0", "psi")
_SHARE = 0.25  # of a segment, through whose beginning a parabola is laid; chosen
_LEAST = 8  # fixes of it at least; chosen
_PLACES = 60  # of a run by which its velocities vary; chosen
_FEWEST = 4  # fixes before the end of a segment, below which those behind it count as well; chosen
_FOR_PARABOLA = 5  # fixes, below which a straight line is laid; chosen: two more than it has coefficients


@dataclass(frozen=True, eq=False)
class Beginnings:
    """What a whole run says of the first rows of its segments.

    Attributes:
        values, value_sd: (segments, ny), outputs straight between readings, and how far readings are from such a line.
        velocity, velocity_sd: (segments, 2), surge and sway by the fixes nearest to them [m/s], and how they vary over
            the run; zero where no track is compared.
        is_thin: (segments,), whether the first quarter of a segment holds too few fixes for its velocity.
    """

    values: Array
    value_sd: Array
    velocity: Array
    velocity_sd: Array
    is_thin: Mask

    def selected(self, indices: Index) -> "Beginnings":
        """Return those of some segments."""
        return Beginnings(*(getattr(self, field.name)[indices] for field in fields(self)))

    @classmethod
    def joined(cls, parts: Sequence["Beginnings"]) -> "Beginnings":
        """Return those of several runs, one after the other."""
        return cls(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(cls)))

    @classmethod
    def of_run(
        cls, measured: Array, outputs: Sequence[str], dt: float, bounds: Sequence[tuple[int, int]]
    ) -> "Beginnings":
        """Return those of a run.

        Args:
            measured: outputs (n, ny), NaN where nothing was measured.
            dt: s.
            bounds: first row of each segment and row behind its last.
        """
        rows = [first for first, _ in bounds]
        values, spread = np.full((len(bounds), len(outputs)), np.nan), np.full(len(outputs), np.nan)
        for column in range(len(outputs)):
            known = np.flatnonzero(np.isfinite(measured[:, column]))
            if known.size:
                values[:, column] = np.interp(rows, known, measured[known, column])
            if known.size > 2:
                spread[column] = np.sqrt(np.mean(np.diff(measured[known, column], 2) ** 2))
        count = len(bounds)
        velocity, deviation, is_thin = np.zeros((count, 2)), np.zeros(2), np.zeros(count, dtype=np.bool_)
        if set(TRACK) <= set(outputs):
            north, east, psi = (measured[:, outputs.index(name)] for name in TRACK)
            is_thin = np.array([not _has_fixes(north[a:b], east[a:b]) for a, b in bounds], dtype=np.bool_)
            if is_thin.any():
                thin = [bound for bound, is_one in zip(bounds, is_thin, strict=True) if is_one]
                velocity[is_thin] = nearest_velocity(north, east, psi, dt, thin)
                places = np.linspace(0, len(north) - 1, _PLACES).astype(int).tolist()
                everywhere = nearest_velocity(north, east, psi, dt, [(k, len(north)) for k in places])
                deviation = np.std(everywhere, axis=0)
        return cls(values, np.tile(spread, (count, 1)), velocity, np.tile(deviation, (count, 1)), is_thin)


def _has_fixes(north: Array, east: Array) -> bool:
    """Whether the beginning of a track holds enough fixes for a velocity."""
    count = max(_LEAST, math.ceil(_SHARE * len(north)))
    return int(np.count_nonzero(np.isfinite(north[:count]) & np.isfinite(east[:count]))) >= _LEAST


def measured_initial_states(data: "Segments", starts: Sequence[str]) -> Array:
    """Return the states `starts` of each segment, (segments, len(starts)), SI: as first measured, zero if unmeasured.

    What was not read in the first row lies straight between the readings of the whole run. Velocities that nobody
    measured are those of the track, so that a craft under way does not begin at rest: of the segment's own beginning,
    or where that holds few fixes, of the fixes of the run that are nearest.
    """
    local = np.zeros((data.count, len(starts)))
    for m, state in enumerate(starts):
        channel = _channel_of(state)
        if channel in data.outputs:
            local[:, m] = np.nan_to_num(_first_values(data, data.outputs.index(channel)))
    hidden = [name for name in _VELOCITIES if name in starts and name not in data.outputs]
    if not hidden or not set(TRACK) <= set(data.outputs):
        return local
    north, east, psi = (data.measured[:, data.outputs.index(name)] for name in TRACK)
    for s, (a, b) in enumerate(pairwise(data.offsets)):
        if data.beginnings is not None and data.beginnings.is_thin[s]:
            surge, sway = data.beginnings.velocity[s]
        else:
            surge, sway = start_velocity(north[a:b], east[a:b], psi[a:b], data.dt)
        local[s, [starts.index(name) for name in hidden]] = [surge if name == "u" else sway for name in hidden]
    return local


def initial_state_weights(data: "Segments", starts: Sequence[str]) -> Array:
    """Return one over the variance of each initial state about what was measured, (segments, len(starts)); 0: unknown.

    Only of segments whose beginning holds too few fixes: there what the whole run shows stands in for them.
    """
    weights = np.zeros((data.count, len(starts)))
    known = data.beginnings
    if known is None or not known.is_thin.any():
        return weights
    for m, state in enumerate(starts):
        channel = _channel_of(state)
        if channel in data.outputs:
            is_unread = np.isnan(data.measured[data.offsets[:-1], data.outputs.index(channel)])
            spread = np.where(is_unread, known.value_sd[:, data.outputs.index(channel)], np.nan)
        elif state in _VELOCITIES:
            spread = known.velocity_sd[:, _VELOCITIES.index(state)]
        else:
            continue
        is_known = known.is_thin & np.isfinite(spread) & (spread > 0.0)
        weights[is_known, m] = spread[is_known] ** -2.0
    return weights


def _channel_of(state: str) -> str:
    return state.split("_")[0] if is_late(state) else state


def _first_values(data: "Segments", column: int) -> Array:
    """What was measured in the first row of each segment, else between the readings about it, (segments,)."""
    values = data.measured[:, column]
    first = np.array(values[data.offsets[:-1]])
    for s in np.flatnonzero(np.isnan(first)):
        first[s] = np.nan if data.beginnings is None else data.beginnings.values[s, column]
        if np.isnan(first[s]):
            good = values[data.offsets[s] : data.offsets[s + 1]]
            first[s] = next(iter(good[np.isfinite(good)]), np.nan)
    return first


def nearest_velocity(north: Array, east: Array, psi: Array, dt: float, bounds: Sequence[tuple[int, int]]) -> Array:
    """Return surge and sway [m/s] where each segment begins by the fixes of the run nearest to it, (segments, 2).

    Those behind the end of a segment count where there are few before it; zero without two fixes.

    Args:
        north, east: positions [m], (n,), NaN where nothing was measured; psi: heading [rad], (n,).
        dt: s.
        bounds: first row of each segment and row behind its last.
    """
    known = np.flatnonzero(np.isfinite(north) & np.isfinite(east))
    headings = np.flatnonzero(np.isfinite(psi))
    result = np.zeros((len(bounds), 2))
    if len(known) < 2 or not len(headings):
        return result
    heading = np.interp([first for first, _ in bounds], headings, psi[headings])
    for s, (first, last) in enumerate(bounds):
        inside = known[known < last]
        usable = inside if len(inside) >= _FEWEST else known
        near = np.sort(usable[np.argsort(np.abs(usable - first), kind="stable")[:_LEAST]])
        track = np.stack([north[near], east[near]], axis=1)
        degree = 2 if len(near) >= _FOR_PARABOLA else 1
        slope = np.polynomial.polynomial.polyfit(dt * (near - first), track, degree)[1]
        result[s] = _in_body_axes(slope, float(heading[s]))
    return result


def _in_body_axes(slope: Array, heading: float) -> tuple[float, float]:
    c, s = math.cos(heading), math.sin(heading)
    # Fossen 2021, eq. (2.41): velocities in the body's axes are R(psi)^T times those over ground
    return float(c * slope[0] + s * slope[1]), float(c * slope[1] - s * slope[0])


def start_velocity(north: Array, east: Array, psi: Array, dt: float) -> tuple[float, float]:
    """Return surge and sway at the first sample [m/s] by parabolas through the beginning of a track; zero without one.

    Args:
        north, east: positions [m], (n,), NaN where nothing was measured.
        psi: heading [rad], (n,).
        dt: s.
    """
    count = max(_LEAST, math.ceil(_SHARE * len(north)))
    track = np.stack([north[:count], east[:count]], axis=1)
    is_measured = np.isfinite(track).all(axis=1)
    heading = psi[np.isfinite(psi)]
    if np.count_nonzero(is_measured) < _LEAST or not len(heading):
        return 0.0, 0.0
    slope = np.polynomial.polynomial.polyfit(dt * np.flatnonzero(is_measured), track[is_measured], 2)[1]
    return _in_body_axes(slope, float(heading[0]))


# Records cut into segments: the data of an output-error problem as arrays.


class LastPoint(Generic[Part]):
    """What was worked out at the last point, by ranges of segments, first to last."""

    def __init__(self) -> None:
        self._latest: tuple[tuple[Hashable, ...], dict[tuple[int, int], Part]] = ((), {})

    def part(self, point: tuple[Hashable, ...], bounds: tuple[int, int], make: Callable[[], Part]) -> Part:
        """Return a range's part at a point, made where it is not known; point: whatever decides it."""
        latest = self._latest  # as this thread finds it: another may be at another point
        if latest[0] != point:
            latest = self._latest = point, {}
        parts = latest[1]
        if bounds not in parts:
            parts[bounds] = make()
        return parts[bounds]


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
    def last_outputs(self) -> LastPoint[Array]:
        """The outputs where they were last simulated."""
        return LastPoint()

    @cached_property
    def last_slopes(self) -> LastPoint[tuple[Array, Array]]:
        """The outputs and their derivatives where they were last differentiated."""
        return LastPoint()

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
    if model.has_speed or "U" not in names:
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
