"""All runs of a trial predicted: training runs to see the fit, the others to see what it is worth, with intervals."""

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Extrapolation, IntervalBasis, Prediction
from seatrial.core.values import Array, Finding, InputError, ProgressReporter, Record
from seatrial.data.trial import Role, TrialRecord
from seatrial.data.trial.settings import WindowLength
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.information.discrepancy import Discrepancy, HoldoutError, discrepancy
from seatrial.estimation.information.extrapolation import (
    extrapolation,
    extrapolation_index,
    motion_envelope,
    with_recorded_speed,
)
from seatrial.estimation.predict.draws import PredictionUncertainty
from seatrial.estimation.predict.open_loop import (
    compare_measures,
    divergence_finding,
    not_predicted_finding,
    predict_run,
    rms_errors,
    simulate_open_loop,
    simulate_while_bounded,
)
from seatrial.estimation.predict.prediction_intervals import (
    DRAWS,
    HoldoutRun,
    HoldoutRuns,
    holdout_draws,
    holdout_error,
    holdout_model,
    manoeuvre_kind,
    prediction_spread,
    with_intervals,
)
from seatrial.estimation.predict.session_offsets import (
    SessionOffsets,
    new_session_offsets,
    session_offsets,
    updated_by_start,
)
from seatrial.estimation.predict.window_scores import WindowPredictor, window_baselines, window_scores
from seatrial.estimation.problem.output_error import OutputError
from seatrial.numerics.workers import map_in_threads
from seatrial.physics.simulate.filtering import FilterPoint, KalmanFilter
from seatrial.physics.simulate.replay import inputs_of

_MOTION = frozenset({"u", "v", "r"})
"""Channels that show how a craft with thrusters moved; where they are not recorded, the fit's own runs show it."""


@dataclass(frozen=True, eq=False)
class IntervalCalibration:
    """What intervals of predictions are made of: what is foreseen, and what runs left out missed beyond it.

    Attributes:
        discrepancy: of whole runs; left_out: runs by which that of windows is found, by their length.
    """

    uncertainty: PredictionUncertainty
    discrepancy: Discrepancy
    left_out: HoldoutRuns


def prediction_uncertainty(estimation: Estimation) -> PredictionUncertainty:
    """Covariance of the coefficients, and of what a new session has of its own.

    Process noise counts where it makes one-step residuals white: under prediction error, and where the intervals of
    whole runs come from it. Elsewhere model error is in its intensities.
    """
    problem, count = estimation.estimate.problem, len(estimation.estimate.problem.free)
    intensity = estimation.noise_model.process if estimation.process_noise is not None else {}
    return PredictionUncertainty(
        estimation.interval.covariance[:count, :count],
        estimation.estimate.population.new_session_covariance,
        np.array([intensity.get(s, 0.0) for s in problem.model.states]),
        estimation.interval.degrees_of_freedom,
        _wave_motion(estimation),
    )


def _wave_motion(estimation: Estimation) -> dict[str, float]:
    """Return what waves add to each channel, SI: all peaks together."""
    waves = estimation.noise_model.waves
    channels = {c for peak in waves for c in peak.rms}
    return {c: float(np.linalg.norm([peak.rms.get(c, 0.0) for peak in waves])) for c in sorted(channels)}


def calibrate_intervals(
    estimation: Estimation,
    train: Sequence[TrialRecord],
    moved: Sequence[Record],
    seconds: float,
    length: float,
    seed: int,
    *,
    offsets_from_start: bool = False,
    is_session_known: bool = False,
) -> IntervalCalibration:
    """Return what intervals of a fit's predictions rest on: every training run is predicted by the estimate without it.

    moved: how the training runs moved, by which they extrapolate from one another; seconds: of a run's beginning, for
    its initial state; is_session_known: whether the predictions are of runs of sessions that were fitted, as far as
    the training runs' are without them.
    """
    uncertainty = prediction_uncertainty(estimation)
    problem = replace(estimation.estimate.problem, workers=1)
    runs = left_out_runs(
        estimation, train, moved, seconds, offsets_from_start=offsets_from_start, is_session_known=is_session_known
    )
    streams = np.random.SeedSequence(seed).spawn(len(runs))

    def one(i: int) -> HoldoutError | None:
        run, rng = runs[i], np.random.default_rng(streams[i])
        error = holdout_error(
            problem, run.holdout, run.record, seconds, length, run.uncertainty, rng, holdout_draws(len(runs))
        )
        return None if error is None else replace(error, index=run.index)

    workers = estimation.estimate.problem.workers
    errors = [e for e in map_in_threads(one, range(len(runs)), workers=workers) if e is not None]
    whole = discrepancy(errors)
    return IntervalCalibration(uncertainty, whole, HoldoutRuns(problem, runs, seconds, whole, seed, workers))


def left_out_runs(
    estimation: Estimation,
    train: Sequence[TrialRecord],
    moved: Sequence[Record],
    seconds: float,
    *,
    offsets_from_start: bool = False,
    is_session_known: bool = False,
) -> tuple[HoldoutRun, ...]:
    """Return each training run with what is known of it by the others; none where none can be left out."""
    uncertainty, points = prediction_uncertainty(estimation), estimation.uncertainty.leave_one_out
    problem, sessions = replace(estimation.estimate.problem, workers=1), [item.session for item in train]
    runs = []
    for i, (item, point) in enumerate(zip(train, () if points is None else points, strict=points is not None)):
        record, is_known = item.record, is_session_known and sessions.count(item.session) > 1
        holdout = holdout_model(problem, point, item.session, record, is_session_known=is_known)
        if is_known:
            own = session_offsets(estimation, item.session, record).covariance
        elif offsets_from_start:
            expected = SessionOffsets(holdout.nuisances, uncertainty.offsets)
            updated = updated_by_start(problem, holdout.model, expected, record, seconds)
            holdout, own = replace(holdout, nuisances=updated.expected), updated.covariance
        else:
            own = uncertainty.offsets
        index = extrapolation_index(moved[i], [*moved[:i], *moved[i + 1 :]], problem.model.equations.layout)
        runs.append(HoldoutRun(record, holdout, replace(uncertainty, offsets=own), index))
    return tuple(runs)


@dataclass(frozen=True, eq=False)
class RunPredictions:
    """All runs predicted, what intervals of further predictions are made of, and which runs diverge or cannot be."""

    predictions: tuple[Prediction, ...]
    interval_basis: IntervalBasis
    findings: tuple[Finding, ...] = ()


def predict_runs(
    estimation: Estimation,
    records: Sequence[TrialRecord],
    seconds: float,
    length: float,
    seed: int = 0,
    report_progress: ProgressReporter | None = None,
    tied: Sequence[PointEstimate] = (),
    windows: Sequence[WindowLength] = (),
    *,
    offsets_from_start: bool = False,
) -> RunPredictions:
    """Return every run open loop, with its session's offsets where the session was fitted, else as of a new session.

    offsets_from_start: whether the first `seconds` of a run of a new session move what is expected of its offsets.

    Runs that were not fitted get intervals, for which `tied` models are asked as well; all are compared with the ground
    the training runs cover. seconds: of a run's beginning, from which its initial state is taken.

    A run that diverges is scored as long as it lasts; a validation run that cannot be simulated is left out. Both are
    findings.

    Raises:
        InputError: a training run cannot be simulated.
    """
    report = report_progress or (lambda _: None)
    problem = estimation.estimate.problem
    items, runs, offsets, findings = [], [], [], []
    for number, item in enumerate(records, 1):
        report(f"prediction: {number} of {len(records)}, {item.record.name}")
        try:
            own = session_offsets(estimation, item.session, item.record)
            if offsets_from_start and item.session not in problem.data.sessions:
                own = updated_by_start(problem, estimation.model, own, item.record, seconds)
            run = simulate_while_bounded(problem, estimation.model, item.record, own.expected, seconds)
        except InputError as error:
            if item.role is Role.TRAIN:
                raise
            findings.append(not_predicted_finding(item.record, error))
            continue
        items.append(item)
        runs.append(run)
        offsets.append(own)
    train = [item for item in items if item.role is Role.TRAIN]
    moved_as = [  # a runaway simulation says nothing of what the run reached
        item.record if run.divergence is not None else with_recorded_speed(run.record, item.record)
        for run, item in zip(runs, items, strict=True)
    ]
    fitted = [record for record, item in zip(moved_as, items, strict=True) if item.role is Role.TRAIN]
    layout = estimation.model.equations.layout
    moved = [
        i.record if layout and set(i.record.channels) >= _MOTION else r for i, r in zip(train, fitted, strict=True)
    ]
    covered = motion_envelope(moved, layout)
    report("intervals of predictions: runs left out")
    by_session = {
        is_known: calibrate_intervals(
            estimation, train, moved, seconds, length, seed, offsets_from_start=offsets_from_start,
            is_session_known=is_known,
        )
        for is_known in {False} | {_is_session_known(problem, i) for i in items if i.role is not Role.TRAIN}
    }  # fmt: skip
    streams = np.random.SeedSequence((seed, 1)).spawn(len(items))
    held_out = [item for item in items if item.role is not Role.TRAIN]
    kinds = {manoeuvre_kind(item.record) for item in train}
    baselines = window_baselines(problem, estimation.model, [i.record for i in train], seconds) if held_out else {}
    predictions = []
    for item, run, reached, own, stream in zip(items, runs, moved_as, offsets, streams, strict=True):
        role = "training" if item.role is Role.TRAIN else "validation"
        one = predict_run(estimation.model, item.record, role, run, seconds, length)
        by_name = dict(zip(problem.session_unknowns, map(float, own.expected), strict=True))
        one = replace(one, offsets=by_name, session=item.session)
        one = replace(one, extrapolation=_extrapolation(extrapolation(reached, covered, layout), item, kinds))
        if run.divergence is not None:
            findings.append(divergence_finding(estimation.model, one, run.divergence))
        calibration = by_session[item.role is not Role.TRAIN and _is_session_known(problem, item)]
        uncertainty = replace(calibration.uncertainty, offsets=own.covariance)
        if run.divergence is None:
            floor = process_noise_floor(
                problem, estimation.model, item.record, run.start.values[0], own.expected,
                estimation.noise_model.process,
            )  # fmt: skip
            one = replace(one, noise_floor=floor)
        if run.divergence is None and item.role is not Role.TRAIN:
            rng = np.random.default_rng(stream)
            spread = prediction_spread(
                problem, estimation.model, item.record, run, own.expected, length, uncertainty, rng, DRAWS
            )
            one = replace(one, tied_spread=tied_model_spread(tied, one, seconds, length))
            one = with_intervals(one, spread, calibration.discrepancy, uncertainty.degrees_of_freedom)
        if item.role is not Role.TRAIN:
            index = one.extrapolation.index if one.extrapolation else 1.0
            rng = np.random.default_rng(stream.spawn(1)[0])
            predictor = WindowPredictor(
                problem,
                estimation.model,
                own.expected,
                uncertainty,
                partial(calibration.left_out.discrepancy, kind=manoeuvre_kind(item.record)),
                baselines,
                length,
                seconds,
            )
            one = replace(one, windows=window_scores(predictor, item.record, windows, index, rng))
        predictions.append(one)
    basis = _interval_basis(estimation, by_session[False], covered, tied)
    return RunPredictions(tuple(predictions), basis, tuple(findings))


def _extrapolation(reached: Extrapolation | None, item: TrialRecord, kinds: Set[str]) -> Extrapolation | None:
    """How far a run leaves the training runs, which show these kinds of manoeuvre, with its own where it is another."""
    kind = manoeuvre_kind(item.record)
    return replace(reached, untrained_kind=kind) if reached is not None and kind and kind not in kinds else reached


def _is_session_known(problem: OutputError, item: TrialRecord) -> bool:
    """Whether runs of its session were fitted."""
    return item.session in problem.data.sessions


def _interval_basis(
    estimation: Estimation, calibration: IntervalCalibration, covered: dict[str, float], tied: Sequence[PointEstimate]
) -> IntervalBasis:
    problem, scatter = estimation.estimate.problem, calibration.uncertainty
    base = estimation.model.parameters
    changed = [{p.name: p.value for p in t.model.parameters if p.value != base[p.name].value} for t in tied]
    between = dict(zip(problem.session_unknowns, np.sqrt(np.diag(scatter.offsets)).tolist(), strict=True))
    return IntervalBasis(
        scatter.coefficients,
        scatter.degrees_of_freedom,
        calibration.discrepancy.factor,
        calibration.discrepancy.sd_by_kind,
        between if len(problem.data.sessions) > 1 else {},
        {s: float(q) for s, q in zip(estimation.model.states, scatter.process, strict=True) if q > 0},
        covered,
        tuple(changed),
    )


def tied_model_spread(
    tied: Sequence[PointEstimate], prediction: Prediction, seconds: float, length: float
) -> dict[str, float]:
    """Root-mean-square distance of tied models from a prediction: by measure, and of heading and position over the run.

    A model that diverges on this run says nothing about it.
    """
    away: dict[str, list[float]] = {}
    for one in tied:
        try:
            own = new_session_offsets(one, prediction.measured).expected
            run = simulate_open_loop(one.problem, one.model, prediction.measured, own, seconds).record
        except InputError:
            continue
        compared = compare_measures(prediction.measured, run, length) if prediction.measures else {}
        for name, m in compared.items():
            simulated = prediction.measures[name].simulated if name in prediction.measures else None
            if m.simulated is not None and simulated is not None:
                away.setdefault(name, []).append(m.simulated - simulated)
        for name, value in rms_errors(prediction.simulated, run).items():
            away.setdefault(name, []).append(value)
    return {name: float(np.sqrt(np.mean(np.square(values)))) for name, values in away.items()}


def process_noise_floor(
    template: OutputError,
    model: Model,
    record: Record,
    start: Array,
    nuisances: Array,
    intensities: Mapping[str, float],
) -> dict[str, float]:
    """Return the rms error over time of an open-loop prediction that process noise alone causes, to first order.

    Args:
        template: the problem whose nuisances `own` (k,) are; model: at the estimate.
        record: the run that is predicted, for its inputs; start: its initial state, (nx,).
        intensity: of states, SI over the root of a second.

    Returns:
        psi_deg in degrees, position_m in m, u, v in m/s, r in rad/s, as far as the model has them; empty where nothing
        is driven.
    """
    if not any(intensities.values()):
        return {}
    split, parameters = len(template.session_parameters), model.parameters
    values = parameters.values
    values[[parameters.index(n) for n, _ in template.session_parameters]] = nuisances[:split]
    inputs = inputs_of(model, record)
    run = KalmanFilter(
        model, inputs, np.array([0, len(inputs)]), record.dt, template.data.outputs,
        corrections=tuple(n.correction for n in template.nuisances), substeps=template.substeps_at(record.dt),
        driven=tuple(intensities),
    )  # fmt: skip
    at = FilterPoint(start[None], np.zeros((1, len(start))), values[None], nuisances[None, split:],
               np.array(list(intensities.values())), np.ones(len(template.data.outputs)))  # fmt: skip
    mean = dict(zip(model.states, run.variances(0, at).mean(axis=0), strict=True))
    floor = {}
    if "psi" in mean:
        floor["psi_deg"] = float(np.degrees(np.sqrt(mean["psi"])))
    if {"x0", "y0"} <= set(mean) and mean["x0"] + mean["y0"] > 0.0:  # no position is modelled at speed 0
        floor["position_m"] = float(np.sqrt(mean["x0"] + mean["y0"]))
    return floor | {s: float(np.sqrt(mean[s])) for s in ("u", "v", "r") if s in mean}
