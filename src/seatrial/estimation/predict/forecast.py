"""All runs of a trial predicted: training runs to see the fit, the others to see what it is worth, with intervals."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Margin, Prediction
from seatrial.core.values import Array, InputError, Progress, Record
from seatrial.data.trial import Role, TrialRecord
from seatrial.estimation.estimate.estimate import Estimate
from seatrial.estimation.estimate.fit import Identified
from seatrial.estimation.information.discrepancy import NONE, Discrepancy, Miss, discrepancy
from seatrial.estimation.information.extrapolation import extrapolation, index_of, reach
from seatrial.estimation.predict.cross_validation import own_nuisances
from seatrial.estimation.predict.draws import Scatter
from seatrial.estimation.predict.floor import floor
from seatrial.estimation.predict.margins import DRAWS, foreseen, missed, with_intervals, without
from seatrial.estimation.predict.open_loop import compared, offsets_of, open_loop, prediction, rms, session_means
from seatrial.numerics.workers import mapped


@dataclass(frozen=True, eq=False)
class Tied:
    """A model that the runs cannot tell from the best one: its estimate, and the model there."""

    made: Estimate
    model: Model


@dataclass(frozen=True, eq=False)
class Calibration:
    """What intervals of predictions are made of: what is foreseen, and what runs left out missed beyond it."""

    scatter: Scatter
    beyond: Discrepancy


def scatter_of(found: Identified) -> Scatter:
    """Covariance of the coefficients, and of offsets between sessions (their priors' where there is one session).

    Process noise counts where the coefficients come from prediction error: elsewhere model error is in its intensities.
    """
    problem = found.made.problem
    count, kinds = len(problem.free), problem.kinds
    offsets = np.atleast_2d(offsets_of(problem, found.made.shared))
    if len(offsets) > 1:
        between = np.atleast_2d(np.cov(offsets, rowvar=False))
    else:
        between = np.diag(1.0 / problem.priors[1][count:])
    intensity = found.disturbance.process if found.has_process_noise else {}
    return Scatter(
        found.interval.covariance[:count, :count],
        between if kinds else np.zeros((0, 0)),
        np.array([intensity.get(s, 0.0) for s in problem.model.states]),
        found.interval.degrees_of_freedom,
    )


def calibrated(
    found: Identified,
    train: Sequence[TrialRecord],
    simulated: Sequence[Record],
    seconds: float,
    length: float,
    seed: int,
) -> Calibration:
    """What intervals of a fit's predictions rest on: every training run is predicted by the estimate without it.

    simulated: the training runs as the fit has them; seconds: of a run's beginning, for its initial state.
    """
    scatter, left_out = scatter_of(found), found.uncertainty.left_out
    if left_out is None:
        return Calibration(scatter, NONE)
    problem = replace(found.made.problem, workers=1)
    streams = np.random.SeedSequence(seed).spawn(len(train))

    def one(i: int) -> Miss | None:
        by = without(problem, left_out[i], train[i].session)
        miss = missed(problem, by, train[i].record, seconds, length, scatter, np.random.default_rng(streams[i]))
        others = [*simulated[:i], *simulated[i + 1 :]]
        return None if miss is None else replace(miss, index=index_of(simulated[i], others))

    misses = mapped(one, range(len(train)), workers=found.made.problem.workers)
    return Calibration(scatter, discrepancy([m for m in misses if m is not None]))


@dataclass(frozen=True, eq=False)
class Forecast:
    """All runs predicted, and what intervals of further predictions are made of."""

    predictions: tuple[Prediction, ...]
    margin: Margin


def forecast(
    found: Identified,
    records: Sequence[TrialRecord],
    seconds: float,
    length: float,
    seed: int = 0,
    progress: Progress | None = None,
    tied: Sequence[Tied] = (),
) -> Forecast:
    """Every run open loop: training runs with their own session's offsets, the others with the training mean.

    Runs that were not fitted get intervals, for which `tied` models are asked as well; all are compared with the ground
    the training runs cover. seconds: of a run's beginning, from which its initial state is taken.

    Raises:
        InputError: a simulation diverges.
    """
    tell = progress or (lambda _: None)
    problem, mean = found.made.problem, session_means(found.made.problem, found.made.shared)
    runs = []
    for item in records:
        tell(f"predicting {item.record.name}")
        own = own_nuisances(found, item.session) if item.role is Role.TRAIN else mean
        runs.append(open_loop(problem, found.model, item.record, own, seconds))
    train = [item for item in records if item.role is Role.TRAIN]
    fitted = [run.record for run, item in zip(runs, records, strict=True) if item.role is Role.TRAIN]
    covered = reach(fitted)
    tell("runs left out, predicted")
    known = calibrated(found, train, fitted, seconds, length, seed)
    streams = np.random.SeedSequence((seed, 1)).spawn(len(records))
    made = []
    for item, run, stream in zip(records, runs, streams, strict=True):
        role = "training" if item.role is Role.TRAIN else "validation"
        one = prediction(found.model, item.record, role, run, seconds, length)
        one = replace(one, extrapolation=extrapolation(run.record, covered))
        if item.role is not Role.TRAIN:
            rng = np.random.default_rng(stream)
            seen = foreseen(problem, found.model, item.record, run, mean, length, known.scatter, rng, DRAWS)
            alone = _floor(found, item.record, run.start, mean)
            one = replace(one, spread=spread_of(tied, one, seconds, length), floor=alone)
            one = with_intervals(one, seen, known.beyond, known.scatter.degrees_of_freedom)
        made.append(one)
    return Forecast(tuple(made), _margin(found, known, covered, tied))


def _floor(found: Identified, record: Record, start: Array, own: Array) -> dict[str, float]:
    """What process noise alone would leave of the errors, as far as its intensities are known."""
    if not any(found.disturbance.process.values()):
        return {}
    return floor(found.made.problem, found.model, record, start, own, found.disturbance.process)


def _margin(found: Identified, known: Calibration, covered: dict[str, float], tied: Sequence[Tied]) -> Margin:
    problem, scatter = found.made.problem, known.scatter
    names = [name for name, _ in problem.session_parameters] + [n.correction.name for n in problem.nuisances]
    base = found.model.parameters
    changed = [{p.name: p.value for p in t.model.parameters if p.value != base[p.name].value} for t in tied]
    return Margin(
        scatter.coefficients,
        scatter.degrees_of_freedom,
        known.beyond.factor,
        known.beyond.kinds,
        dict(zip(names, np.sqrt(np.diag(scatter.offsets)).tolist(), strict=True)),
        {s: float(q) for s, q in zip(found.model.states, scatter.process, strict=True) if q > 0},
        covered,
        tuple(changed),
    )


def spread_of(tied: Sequence[Tied], made: Prediction, seconds: float, length: float) -> dict[str, float]:
    """Root-mean-square distance of tied models from a prediction: by measure, and of heading and position over the run.

    A model that diverges on this run says nothing about it.
    """
    away: dict[str, list[float]] = {}
    for one in tied:
        problem = one.made.problem
        own = session_means(problem, one.made.shared)
        try:
            run = open_loop(problem, one.model, made.measured, own, seconds).record
        except InputError:
            continue
        told = compared(made.measured, run, length) if made.measures else {}
        for name, m in told.items():
            simulated = made.measures[name].simulated if name in made.measures else None
            if m.simulated is not None and simulated is not None:
                away.setdefault(name, []).append(m.simulated - simulated)
        for name, value in rms(made.simulated, run).items():
            away.setdefault(name, []).append(value)
    return {name: float(np.sqrt(np.mean(np.square(values)))) for name, values in away.items()}
