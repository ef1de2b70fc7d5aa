"""Intervals of predictions: what is foreseen by draws, and what runs left out missed beyond it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Measure, Prediction
from seatrial.core.results.coefficients import STORED_LEVEL, two_sided_quantile
from seatrial.core.values import Array, InputError, Record
from seatrial.data.check.motion import sample_noise
from seatrial.estimation.information.discrepancy import BAND_CHANNELS, Discrepancy, HoldoutError, discrepancy
from seatrial.estimation.predict.draws import PredictionUncertainty, StartStates, draw_runs
from seatrial.estimation.predict.open_loop import (
    OpenLoopRun,
    compare_measures,
    is_steered,
    observables_record,
    open_loop_runs,
    simulate_open_loop,
)
from seatrial.estimation.predict.session_offsets import offsets_without
from seatrial.estimation.predict.windows import Windows
from seatrial.estimation.problem.output_error import OutputError
from seatrial.numerics.workers import map_in_threads
from seatrial.physics.manoeuvres import bounded_interval, measures
from seatrial.physics.manoeuvres.recognition import ManoeuvreKind, ObservedManoeuvre, recognise_manoeuvre
from seatrial.physics.simulate.replay import inputs_of

# How exactly a measure is read from a run: what the noise of its sensors leaves open.

MEASURE_CHANNELS = ("psi", "x0", "y0", "u", "v", "r")
"""Channels that measures are read from."""
READINGS = 60
"""Readings drawn; chosen: their scatter is then known to a tenth."""


def reading_errors(record: Record, length: float, rng: np.random.Generator) -> dict[str, float]:
    """Return the standard deviation of each measure of a run that white noise of its sensors leaves, in its unit.

    The noise of each channel is that of its third differences; the run is read again with as much added, which to first
    order scatters as the reading itself does. What a second run would do differently is not in it.

    Args:
        length: of the ship [m].

    Raises:
        InputError: the record is no manoeuvre.
    """
    reference = ObservedManoeuvre.from_record(record)
    centre = measures(record, length, reference=reference)
    noise = {c: sample_noise(record.channel(c).readings) for c in MEASURE_CHANNELS if c in record}
    values: dict[str, list[float]] = {name: [] for name in centre}
    for _ in range(READINGS):
        again = record
        for channel, size in noise.items():
            read = record[channel] + size * rng.standard_normal(len(record[channel]))
            again = again.with_channel(channel, record.channel(channel).with_values(read))
        for name, value in measures(again, length, reference=reference).items():
            if name in values:
                values[name].append(value - centre[name])
    return {name: float(np.sqrt(np.mean(np.square(v)))) for name, v in values.items() if 2 * len(v) > READINGS}


# Intervals of predictions: what is foreseen by draws, and what runs left out missed beyond it.

# ships drawn for the interval of a prediction, and for that of a run left out, ours
DRAWS, HOLDOUT_DRAWS = 100, 32
_POOLED_DRAWS, _FEWEST_DRAWS = 1600, 8  # of all runs left out together, and of each where they are many; chosen
_ROWS_AT_ONCE = 200_000  # of drawn windows, simulated together; chosen: some 20 MB


@dataclass(frozen=True, eq=False)
class PredictionSpread:
    """How far runs drawn from what is left open scatter about a prediction.

    Attributes:
        channels: of `BAND_CHANNELS` -> standard deviation at every sample, shape (n,), SI.
        measures: measure -> standard deviation in its unit.
    """

    channels: dict[str, Array]
    measures: dict[str, float]


def prediction_spread(
    template: OutputError,
    model: Model,
    record: Record,
    simulation: OpenLoopRun,
    nuisances: Array,
    length: float,
    uncertainty: PredictionUncertainty,
    rng: np.random.Generator,
    count: int,
) -> PredictionSpread:
    """Scatter of `count` drawn runs about the simulated one, as sensors show them in the waves that were estimated.

    Measures include the noise with which they are read. Nothing is foreseen where half of the draws or more diverge:
    what is left of them would look too certain.
    """
    runs = _drawn_about(template, model, record, simulation, nuisances, uncertainty, rng, count)
    waves = uncertainty.waves
    spreads = _measure_spread(model, record, simulation, runs, length, waves, rng) if is_steered(record, model) else {}
    return PredictionSpread(_channel_spread(model, simulation.record, runs, waves), spreads)


def window_spreads(
    template: OutputError,
    model: Model,
    windows: Windows,
    simulated: Sequence[Record],
    starts: StartStates,
    nuisances: Array,
    uncertainty: PredictionUncertainty,
    rng: np.random.Generator,
) -> list[dict[str, Array]]:
    """Return of each window the scatter of heading and position of drawn runs: channel -> (steps + 1,), SI.

    As sensors show them in the waves that were estimated.

    simulated: the windows open loop from `starts`; nuisances: of each run, (runs, k).
    """
    size = max(1, _ROWS_AT_ONCE // (HOLDOUT_DRAWS * (windows.steps + 1)))
    spreads = []
    for chosen in (slice(i, i + size) for i in range(0, len(windows), size)):
        part = windows.selected(chosen)
        drawn = draw_runs(
            template, model, part.dt, part.inputs(model), starts[chosen], nuisances[part.run], uncertainty, rng,
            HOLDOUT_DRAWS,
        )  # fmt: skip
        spreads += [
            _channel_spread(model, s, _finite_draws(y), uncertainty.waves)
            for s, y in zip(simulated[chosen], drawn, strict=True)
        ]
    return spreads


def _drawn_about(
    template: OutputError,
    model: Model,
    record: Record,
    simulation: OpenLoopRun,
    nuisances: Array,
    uncertainty: PredictionUncertainty,
    rng: np.random.Generator,
    count: int,
) -> Array:
    """Runs drawn from what is left open, those that last, (at most `count`, rows, observables)."""
    inputs = inputs_of(model, record)[None]
    runs = draw_runs(template, model, record.dt, inputs, simulation.start, nuisances[None], uncertainty, rng, count)
    return _finite_draws(runs[0])


def _finite_draws(runs: Array) -> Array:
    """Return the draws that do not diverge; none where they are fewer than half."""
    kept = runs[np.all(np.isfinite(runs), axis=(1, 2))]
    return kept if 2 * len(kept) > len(runs) else kept[:0]


def _channel_spread(model: Model, simulated: Record, runs: Array, waves: Mapping[str, float]) -> dict[str, Array]:
    place = {c: model.observables.index(model.observable_of(c)) for c in model.channels}
    return {
        c: np.sqrt(np.mean((runs[:, :, place[c]] - simulated[c]) ** 2, axis=0) + waves.get(c, 0.0) ** 2)
        for c in BAND_CHANNELS
        if c in place and len(runs)
    }


def _measure_spread(
    model: Model, record: Record, simulation: OpenLoopRun, runs: Array, length: float, waves: Mapping[str, float],
    rng: np.random.Generator,
) -> dict[str, float]:  # fmt: skip
    place = {c: model.observables.index(model.observable_of(c)) for c in model.channels}
    noise = {
        c: np.hypot(sample_noise(record.channel(c).readings), waves.get(c, 0.0))
        for c in MEASURE_CHANNELS if c in record and c in place
    }  # fmt: skip
    reference = ObservedManoeuvre.from_record(record)
    centre = measures(simulation.record, length, reference=reference)
    values_by_measure: dict[str, list[float]] = {name: [] for name in centre}
    for y in runs:
        read = y.copy()
        for channel, spread in noise.items():
            read[:, place[channel]] += spread * rng.standard_normal(len(y))
        for name, value in measures(observables_record(model, record, read), length, reference=reference).items():
            if name in values_by_measure:
                values_by_measure[name].append(value - centre[name])
    enough = max(4, len(runs) // 2)
    return {n: float(np.sqrt(np.mean(np.square(d)))) for n, d in values_by_measure.items() if len(d) >= enough}


def holdout_draws(runs: int) -> int:
    """Return the draws for each of so many runs left out: what they miss is pooled, so that many runs need few each."""
    return max(_FEWEST_DRAWS, min(HOLDOUT_DRAWS, _POOLED_DRAWS // max(runs, 1)))


@dataclass(frozen=True, eq=False)
class HoldoutModel:
    """A model fitted without a session's run, and what the run is expected to have by the other sessions."""

    model: Model
    nuisances: Array


def holdout_model(
    template: OutputError, point: Array, session: str, record: Record, *, is_session_known: bool = False
) -> HoldoutModel:
    """Return the model at the shared unknowns `point`, which were estimated without this record of the session.

    is_session_known: whether the session's other runs say what the run has of its own, else other sessions do.
    """
    model = template.model_at(point)
    if is_session_known:
        return HoldoutModel(model, point[template.offset_columns(template.data.sessions.index(session))])
    return HoldoutModel(model, offsets_without(template, point, session, record))


def holdout_error(
    template: OutputError,
    holdout: HoldoutModel,
    record: Record,
    seconds: float,
    length: float,
    uncertainty: PredictionUncertainty,
    rng: np.random.Generator,
    draws: int = HOLDOUT_DRAWS,
) -> HoldoutError | None:
    """Return how a run is missed by a model that was fitted without it; None where the simulation diverges."""
    try:
        run = simulate_open_loop(template, holdout.model, record, holdout.nuisances, seconds)
    except InputError:
        return None
    spread = prediction_spread(template, holdout.model, record, run, holdout.nuisances, length, uncertainty, rng, draws)
    if not spread.channels:
        return None
    pairs = compare_measures(record, run.record, length) if is_steered(record, holdout.model) else {}
    of_measures = {
        n: (m.simulated - m.measured, spread.measures[n])
        for n, m in pairs.items()
        if n in spread.measures and m.measured is not None and m.simulated is not None
    }
    return replace(_channel_errors(record, run, spread.channels), measures=of_measures)


def _channel_errors(record: Record, simulation: OpenLoopRun, channels: dict[str, Array]) -> HoldoutError:
    errors = {c: simulation.record[c] - record.measured(c) for c in channels if c in record}
    return HoldoutError(record.name, record.dt, errors, {c: channels[c] for c in errors})


def with_intervals(
    prediction: Prediction, spread: PredictionSpread, discrepancy: Discrepancy, degrees_of_freedom: float
) -> Prediction:
    """Return the prediction with 95 % intervals of its measures and bands of heading and position.

    beyond: model discrepancy; the spread over tied models is the prediction's own.
    """
    t = two_sided_quantile(STORED_LEVEL, degrees_of_freedom)
    index = prediction.extrapolation.index if prediction.extrapolation else 1.0

    def bounded(name: str, m: Measure) -> Measure:
        if m.simulated is None or name not in spread.measures:
            return m
        half = t * float(
            np.hypot(discrepancy.measure_sd(name, spread.measures[name], index), prediction.tied_spread.get(name, 0.0))
        )
        bounds = bounded_interval(name, m.simulated, half)
        return replace(m, is_determined=False) if bounds is None else replace(m, lower=bounds[0], upper=bounds[1])

    bands = {c: t * discrepancy.channel_sd(c, s, prediction.measured.dt, index) for c, s in spread.channels.items()}
    return replace(prediction, measures={n: bounded(n, m) for n, m in prediction.measures.items()}, half_width=bands)


# Training runs, each left out of the estimate in turn: what bands of predictions are calibrated by.

_WINDOWS = 20  # of each run left out, evenly spread; chosen: neighbours err alike


@dataclass(frozen=True, eq=False)
class HoldoutRun:
    """A training run, and what is known of it without it.

    Attributes:
        holdout: model and offsets by the other runs; uncertainty: what they leave open.
        index: extrapolation index of the run against the others.
    """

    record: Record
    holdout: HoldoutModel
    uncertainty: PredictionUncertainty
    index: float


@dataclass(frozen=True, eq=False)
class RunErrors:
    """How the windows of a run of some kind of manoeuvre are missed."""

    kind: str
    errors: tuple[HoldoutError, ...]


@dataclass(frozen=True, eq=False)
class HoldoutRuns:
    """Runs left out that calibrate windows of any length, each length once.

    Attributes:
        template: the problem whose outputs, noise and nuisances are used; seed: of what is drawn.
        seconds: of a window's beginning, for its initial state, at most.
        whole_runs: their discrepancy, for windows that fewer runs hold than a discrepancy needs.
        of_length: what is known so far, by number of steps.
    """

    template: OutputError
    runs: tuple[HoldoutRun, ...]
    seconds: float
    whole_runs: Discrepancy
    seed: int
    workers: int | None = None
    of_length: dict[int, list[RunErrors]] = field(default_factory=dict)

    def discrepancy(self, seconds: float, kind: str = "") -> Discrepancy:
        """Return what windows of this length [s] of runs left out miss beyond what is foreseen and sensors add.

        kind: of manoeuvre (`manoeuvre_kind`), by whose runs alone it is found where there are enough of them.
        """
        if not self.runs:
            return self.whole_runs
        runs = self.errors_of_length(seconds)
        pooled = discrepancy([error for run in runs for error in run.errors], self.whole_runs)
        return discrepancy([error for run in runs if kind and run.kind == kind for error in run.errors], pooled)

    def errors_of_length(self, seconds: float) -> list[RunErrors]:
        """Return how windows of this length [s] of each run are missed."""
        steps = Windows.steps_of(seconds, self.runs[0].record.dt)
        if steps not in self.of_length:
            self.of_length[steps] = map_in_threads(
                lambda i: RunErrors(manoeuvre_kind(self.runs[i].record), tuple(self._errors(i, seconds))),
                range(len(self.runs)), workers=self.workers,
            )  # fmt: skip
        return self.of_length[steps]

    def _errors(self, number: int, seconds: float) -> Iterator[HoldoutError]:
        run = self.runs[number]
        windows = Windows.cut([run.record], seconds).evenly_spread(_WINDOWS)
        rng = np.random.default_rng((self.seed, number, windows.steps))
        initial = windows.initial_seconds(self.seconds)
        found = band_errors(self.template, run.holdout, windows, initial, run.uncertainty, rng)
        yield from (replace(error, index=run.index) for error in found)


def manoeuvre_kind(record: Record) -> str:
    """Return the kind of manoeuvre that a run shows; empty where it is none of those with a name, or has no rudder."""
    if not {"psi", "delta"} <= set(record.channels):
        return ""
    try:
        kind = recognise_manoeuvre(record)
    except InputError:  # nothing but gaps
        return ""
    return "" if kind is ManoeuvreKind.OTHER else kind.value


def band_errors(
    template: OutputError, holdout: HoldoutModel, windows: Windows, seconds: float, uncertainty: PredictionUncertainty,
    rng: np.random.Generator,
) -> Iterator[HoldoutError]:  # fmt: skip
    """Yield how each window of a run is missed by a model fitted without it, those left out that diverge.

    The sensors' noise counts as foreseen: a measured sample lies about the true one by as much.

    seconds: of a window's beginning, for its initial state.
    """
    if not len(windows):
        return
    own = holdout.nuisances[None]
    runs = open_loop_runs(template, holdout.model, windows, own, seconds)
    simulated, starts = [run.record for run in runs], StartStates.joined([run.start for run in runs])
    spreads = window_spreads(template, holdout.model, windows, simulated, starts, own, uncertainty, rng)
    for piece, run, spread in zip(windows.pieces, runs, spreads, strict=True):
        sds = with_sensor_noise(piece, spread)
        if run.divergence is None and sds:
            yield HoldoutError(piece.name, piece.dt, {c: run.record[c] - piece.measured(c) for c in sds}, sds)


def with_sensor_noise(measured: Record, spread: dict[str, Array]) -> dict[str, Array]:
    """Return standard deviations of what is measured, of the channels that are, from those of what is simulated."""
    return {c: np.hypot(sd, sample_noise(measured.channel(c).readings)) for c, sd in spread.items() if c in measured}
