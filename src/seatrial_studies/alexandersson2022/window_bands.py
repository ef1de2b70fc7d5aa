"""Are the bands right? Heading and position in windows of runs left out, against bands that never saw the run."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import stdtrit

from seatrial.core.values import Array, InputError
from seatrial.data.trial import TrialRecord
from seatrial.estimation.estimate import Estimation
from seatrial.estimation.information import HoldoutError, discrepancy, extrapolation_index
from seatrial.estimation.predict import HoldoutProtocol, Windows, band_errors, holdout_model, prediction_uncertainty


@dataclass(frozen=True)
class BandCoverage:
    """Share of the measured samples, over all windows of a run, in the 95 % band of each channel (psi, x0, y0)."""

    run: str
    windows: int
    shares: dict[str, float]


@dataclass(frozen=True, eq=False)
class MissedWindows:
    """How windows were missed, for each training run by the estimate without it, and for each run held out."""

    training: tuple[tuple[HoldoutError, ...], ...]
    held_out: tuple[tuple[HoldoutError, ...], ...]
    degrees_of_freedom: float


def holdout_windows(
    estimation: Estimation,
    train: Sequence[TrialRecord],
    held_out: Sequence[TrialRecord],
    protocol: HoldoutProtocol,
    seed: int = 0,
) -> MissedWindows:
    """Every window of the training runs predicted without its run, and of the runs held out with all.

    Raises:
        InputError: fewer runs than a jackknife needs.
    """
    left_out = estimation.uncertainty.leave_one_out
    if left_out is None:
        raise InputError("bands are judged by runs left out; the trial has too few training runs, add some")
    problem, scatter, rng = estimation.estimate.problem, prediction_uncertainty(estimation), np.random.default_rng(seed)

    def predict_windows_of(
        item: TrialRecord, point: Array, training_runs: Sequence[TrialRecord]
    ) -> tuple[HoldoutError, ...]:
        index = extrapolation_index(item.record, [o.record for o in training_runs])
        by = holdout_model(problem, point, item.session, item.record)
        windows = Windows.cut([item.record], protocol.window_s, protocol.max_windows)
        found = band_errors(problem, by, windows, protocol.initial_s, scatter, rng)
        return tuple(replace(error, index=index) for error in found)

    trained = tuple(
        predict_windows_of(item, left_out[i], [*train[:i], *train[i + 1 :]]) for i, item in enumerate(train)
    )
    return MissedWindows(
        trained,
        tuple(predict_windows_of(item, estimation.estimate.common_parameters, train) for item in held_out),
        scatter.degrees_of_freedom,
    )


def band_coverage(holdout: MissedWindows) -> tuple[tuple[BandCoverage, ...], tuple[BandCoverage, ...]]:
    """How much of the training runs and of the runs held out lies within their bands.

    The discrepancy of a training run is that of the other training runs.
    """
    t, trained = float(stdtrit(holdout.degrees_of_freedom, 0.975)), holdout.training
    everything = [m for mine in trained for m in mine]
    within = tuple(
        _run_coverage(own, [m for other in trained if other is not own for m in other], t) for own in trained
    )
    return within, tuple(_run_coverage(own, everything, t) for own in holdout.held_out)


def _run_coverage(run_errors: Sequence[HoldoutError], other_errors: Sequence[HoldoutError], t: float) -> BandCoverage:
    known = discrepancy(other_errors)
    inside: dict[str, list[float]] = {}
    for miss in run_errors:
        for channel, error in miss.errors.items():
            half = t * known.channel_sd(channel, miss.predicted_sd[channel], miss.dt, miss.index)
            seen = np.isfinite(error)
            if seen.any():
                inside.setdefault(channel, []).append(float(np.mean((np.abs(error) <= half)[seen])))
    shares = {channel: float(np.mean(each)) for channel, each in inside.items()}
    return BandCoverage(run_errors[0].run if run_errors else "", len(run_errors), shares)
