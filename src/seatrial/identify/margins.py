"""Intervals of predictions: what is foreseen by draws, and what runs left out missed beyond it."""

from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from seatrial.check.signal import sample_noise
from seatrial.equations import Model
from seatrial.identify.draws import Scatter, drawn
from seatrial.identify.predict import OpenLoop, as_record, compared, is_steered, offsets_of, open_loop
from seatrial.information.discrepancy import Discrepancy, Miss
from seatrial.manoeuvres import measures
from seatrial.problem.output_error import OutputError
from seatrial.results import Measure, Prediction
from seatrial.values import Array, InputError, Record

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
    """Scatter of `count` drawn runs about the simulated one; measures include the noise with which they are read."""
    runs = drawn(template, model, record, made.start, own, scatter, rng, count)
    runs = runs[np.all(np.isfinite(runs), axis=(1, 2))]
    place = {o: i for i, o in enumerate(model.observables)}
    channels = {c: np.sqrt(np.mean((runs[:, :, place[c]] - made.record[c]) ** 2, axis=0))
                for c in _TRACK if c in place and len(runs)}  # fmt: skip
    if not is_steered(record, model):
        return Foreseen(channels, {})
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
    spreads = {n: float(np.sqrt(np.mean(np.square(d)))) for n, d in found.items() if len(d) >= max(4, len(runs) // 2)}
    return Foreseen(channels, spreads)


def missed(
    template: OutputError,
    point: Array,
    piece: Record,
    session: str,
    seconds: float,
    length: float,
    scatter: Scatter,
    rng: np.random.Generator,
) -> Miss | None:
    """How a run, or a piece of one, is missed by a model that was fitted without it; None where that diverges.

    point: shared unknowns without the run. Its own offsets count as unknown: it gets the mean of the other sessions.
    """
    model = template.model.with_values(dict(zip(template.free, point, strict=False)))
    others = [s != session for s in template.data.sessions]
    own = offsets_of(template, point)[others if any(others) else slice(None)].mean(axis=0)
    try:
        made = open_loop(template, model, piece, own, seconds)
    except InputError:
        return None
    found = foreseen(template, model, piece, made, own, length, scatter, rng, DRAWS_LEFT_OUT)
    errors = {c: made.record[c] - piece[c] for c in found.channels if c in piece}
    pairs = compared(piece, made.record, length) if is_steered(piece, model) else {}
    return Miss(
        piece.name,
        piece.dt,
        errors,
        {c: found.channels[c] for c in errors},
        {
            n: (m.simulated - m.measured, found.measures[n])
            for n, m in pairs.items()
            if n in found.measures and m.measured is not None and m.simulated is not None
        },
    )


def with_intervals(made: Prediction, found: Foreseen, beyond: Discrepancy, degrees_of_freedom: float) -> Prediction:
    """The prediction with 95 % intervals of its measures and bands of heading and position.

    beyond: model discrepancy; the spread over tied models is the prediction's own.
    """
    t = float(stats.t.ppf(0.975, degrees_of_freedom))

    def bounded(name: str, m: Measure) -> Measure:
        if m.simulated is None or name not in found.measures:
            return m
        half = t * float(np.hypot(beyond.of_measure(name, found.measures[name]), made.spread.get(name, 0.0)))
        return replace(m, lower=m.simulated - half, upper=m.simulated + half)

    bands = {c: t * beyond.of_channel(c, s, made.measured.dt) for c, s in found.channels.items()}
    return replace(made, measures={n: bounded(n, m) for n, m in made.measures.items()}, half_width=bands)
