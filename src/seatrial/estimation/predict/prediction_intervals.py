"""Intervals of predictions: what is foreseen by draws, and what runs left out missed beyond it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Measure, Prediction
from seatrial.core.results.coefficients import STORED_LEVEL, two_sided_quantile
from seatrial.core.values import Array, InputError, Record
from seatrial.data.check.motion import sample_noise
from seatrial.estimation.information.discrepancy import BAND_CHANNELS, Discrepancy, HoldoutError
from seatrial.estimation.predict.draws import PredictionUncertainty, StartStates, draw_runs
from seatrial.estimation.predict.open_loop import (
    OpenLoopRun,
    compare_measures,
    is_steered,
    observables_record,
    simulate_open_loop,
)
from seatrial.estimation.predict.reading_error import MEASURE_CHANNELS
from seatrial.estimation.predict.session_offsets import offsets_without
from seatrial.estimation.predict.windows import Windows
from seatrial.estimation.problem.output_error import OutputError
from seatrial.physics.manoeuvres import bounded_interval, measures
from seatrial.physics.manoeuvres.recognition import ObservedManoeuvre
from seatrial.physics.simulate.replay import inputs_of

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
    model = template.model.with_values(dict(zip(template.free, point, strict=False)))
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
