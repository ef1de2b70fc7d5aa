"""Intervals of predictions: what is foreseen by draws, and what runs left out missed beyond it."""

from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from seatrial.core.equations import Model
from seatrial.core.results import Measure, Prediction
from seatrial.core.values import Array, InputError, Record
from seatrial.data.check.signal import sample_noise
from seatrial.estimation.information.discrepancy import Discrepancy, Miss
from seatrial.estimation.predict.draws import Scatter, drawn
from seatrial.estimation.predict.open_loop import OpenLoop, as_record, compared, is_steered, offsets_of, open_loop
from seatrial.estimation.problem.output_error import OutputError
from seatrial.physics.manoeuvres import measures

_TRACK = ("psi", "x0", "y0")
_OF_MEASURES = ("psi", "x0", "y0", "u", "v", "r")
DRAWS, DRAWS_LEFT_OUT = 100, 32


@dataclass(frozen=True, eq=False)
class Foreseen:
    """How far runs drawn from what is left open scatter about a prediction.

    Attributes:
        channels: psi, x0, y0 -> standard deviation at every sample, shape (n,), SI.
        measures: measure -> standard deviation in its unit.
    """

    channels: dict[str, Array]
    measures: dict[str, float]


def foreseen(
    template: OutputError,
    model: Model,
    record: Record,
    made: OpenLoop,
    own: Array,
    length: float,
    scatter: Scatter,
    rng: np.random.Generator,
    count: int,
) -> Foreseen:
    """Scatter of `count` drawn runs about the simulated one; measures include the noise with which they are read.

    Nothing is foreseen where half of the draws or more diverge: what is left of them would look too certain.
    """
    runs = _finite(drawn(template, model, record, made.start, own, scatter, rng, count))
    spreads = _of_measures(model, record, made, runs, length, rng) if is_steered(record, model) else {}
    return Foreseen(_of_track(model, made, runs), spreads)


def _finite(runs: Array) -> Array:
    """The draws that do not diverge; none where they are fewer than half."""
    kept = runs[np.all(np.isfinite(runs), axis=(1, 2))]
    return kept if 2 * len(kept) > len(runs) else kept[:0]


def _of_track(model: Model, made: OpenLoop, runs: Array) -> dict[str, Array]:
    place = {o: i for i, o in enumerate(model.observables)}
    return {
        c: np.sqrt(np.mean((runs[:, :, place[c]] - made.record[c]) ** 2, axis=0))
        for c in _TRACK
        if c in place and len(runs)
    }


def _of_measures(
    model: Model, record: Record, made: OpenLoop, runs: Array, length: float, rng: np.random.Generator
) -> dict[str, float]:
    place = {o: i for i, o in enumerate(model.observables)}
    noise = {c: sample_noise(record[c]) for c in _OF_MEASURES if c in record and c in place}
    centre = measures(made.record, length, like=record)
    found: dict[str, list[float]] = {name: [] for name in centre}
    for y in runs:
        read = y.copy()
        for channel, spread in noise.items():
            read[:, place[channel]] += spread * rng.standard_normal(len(y))
        for name, value in measures(as_record(model, record, read), length, like=record).items():
            if name in found:
                found[name].append(value - centre[name])
    enough = max(4, len(runs) // 2)
    return {n: float(np.sqrt(np.mean(np.square(d)))) for n, d in found.items() if len(d) >= enough}


@dataclass(frozen=True, eq=False)
class Without:
    """A model fitted without a session, and what a run of that session is given: the mean of the other sessions."""

    model: Model
    own: Array


def without(template: OutputError, point: Array, session: str) -> Without:
    """The model at the shared unknowns `point`, which were estimated without the session's run."""
    others = [s != session for s in template.data.sessions]
    own = offsets_of(template, point)[others if any(others) else slice(None)].mean(axis=0)
    return Without(template.model.with_values(dict(zip(template.free, point, strict=False))), own)


def missed(
    template: OutputError,
    by: Without,
    record: Record,
    seconds: float,
    length: float,
    scatter: Scatter,
    rng: np.random.Generator,
) -> Miss | None:
    """How a run is missed by a model that was fitted without it; None where the simulation diverges."""
    try:
        made = open_loop(template, by.model, record, by.own, seconds)
    except InputError:
        return None
    found = foreseen(template, by.model, record, made, by.own, length, scatter, rng, DRAWS_LEFT_OUT)
    if not found.channels:
        return None
    pairs = compared(record, made.record, length) if is_steered(record, by.model) else {}
    of_measures = {
        n: (m.simulated - m.measured, found.measures[n])
        for n, m in pairs.items()
        if n in found.measures and m.measured is not None and m.simulated is not None
    }
    return replace(_miss(record, made, found.channels), measures=of_measures)


def missed_track(
    template: OutputError, by: Without, piece: Record, seconds: float, scatter: Scatter, rng: np.random.Generator
) -> Miss | None:
    """`missed` for a piece of a run, heading and track only."""
    try:
        made = open_loop(template, by.model, piece, by.own, seconds)
    except InputError:
        return None
    runs = _finite(drawn(template, by.model, piece, made.start, by.own, scatter, rng, DRAWS_LEFT_OUT))
    return _miss(piece, made, _of_track(by.model, made, runs)) if len(runs) else None


def _miss(record: Record, made: OpenLoop, channels: dict[str, Array]) -> Miss:
    errors = {c: made.record[c] - record[c] for c in channels if c in record}
    return Miss(record.name, record.dt, errors, {c: channels[c] for c in errors})


def with_intervals(made: Prediction, found: Foreseen, beyond: Discrepancy, degrees_of_freedom: float) -> Prediction:
    """The prediction with 95 % intervals of its measures and bands of heading and position.

    beyond: model discrepancy; the spread over tied models is the prediction's own.
    """
    t = float(stats.t.ppf(0.975, degrees_of_freedom))
    index = made.extrapolation.index if made.extrapolation else 1.0

    def bounded(name: str, m: Measure) -> Measure:
        if m.simulated is None or name not in found.measures:
            return m
        half = t * float(np.hypot(beyond.of_measure(name, found.measures[name], index), made.spread.get(name, 0.0)))
        return replace(m, lower=m.simulated - half, upper=m.simulated + half)

    bands = {c: t * beyond.of_channel(c, s, made.measured.dt, index) for c, s in found.channels.items()}
    return replace(made, measures={n: bounded(n, m) for n, m in made.measures.items()}, half_width=bands)
