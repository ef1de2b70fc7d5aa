"""Cross-validation over whole runs: windows of held-out runs simulated open loop, errors pooled by kind of manoeuvre.

Whole runs are held out, never pieces of them: neighbouring samples share wind and noise, and random splits leak
(Stone 1974, J. R. Stat. Soc. B 36, 111-147, for runs instead of observations).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, ProgressReporter, Record
from seatrial.data.trial import EstimateSettings
from seatrial.estimation.estimate import Estimation, EstimatorOptions, Runs, estimate_model, with_segment_seconds
from seatrial.estimation.predict import HoldoutProtocol, WindowError, session_offsets, window_errors
from seatrial.estimation.problem import OutputError, compared_outputs, cut_segments
from seatrial.numerics.workers import map_in_threads


@dataclass(frozen=True)
class PooledError:
    """Windows of one label together.

    Attributes:
        position_m, heading_deg: mean of the windows' rms errors.
        rms_position_m, rms_heading_deg: root mean square over all samples, in which the worst windows weigh most.
    """

    label: str
    windows: int
    position_m: float
    heading_deg: float
    rms_position_m: float
    rms_heading_deg: float


@dataclass(frozen=True)
class CrossValidation:
    """Errors of all held-out windows, and the seconds each fold's fit took."""

    windows: tuple[WindowError, ...]
    elapsed_s: tuple[float, ...] = ()

    @property
    def labels(self) -> tuple[str, ...]:
        """Labels in the order in which they occur."""
        return tuple(dict.fromkeys(w.label for w in self.windows))

    def pooled(self, label: str, fold: int | None = None) -> PooledError:
        """Return all windows of a label, or those of one fold.

        Raises:
            InputError: there is none.
        """
        mine = [w for w in self.windows if w.label == label and fold in (None, w.fold)]
        if not mine:
            raise InputError(f"no window of '{label}'{'' if fold is None else f' in fold {fold}'}; use fewer folds")
        errors = np.array([(w.position_m, w.heading_deg) for w in mine])
        mean, rms = np.mean(errors, axis=0), np.sqrt(np.mean(errors**2, axis=0))
        return PooledError(label, len(mine), float(mean[0]), float(mean[1]), float(rms[0]), float(rms[1]))

    def fold_spread(self, label: str) -> tuple[float, float]:
        """Return the standard deviation over folds of the pooled position [m] and heading error [deg]."""
        of_label = sorted({w.fold for w in self.windows if w.label == label})
        each = [self.pooled(label, fold) for fold in of_label]
        spread = np.std([(p.position_m, p.heading_deg) for p in each], axis=0, ddof=1 if len(each) > 1 else 0)
        return float(spread[0]), float(spread[1])


def assign_folds(labels: Sequence[str], folds: int) -> list[int]:
    """Fold of each run: the runs of every label are dealt out in turn, so that each fold has its share of all.

    Raises:
        InputError: fewer than two folds, or more folds than runs of some label.
    """
    dealt: dict[str, int] = {}
    made = []
    for label in labels:
        made.append(dealt.get(label, 0) % folds if folds > 1 else 0)
        dealt[label] = dealt.get(label, 0) + 1
    if folds < 2:
        raise InputError(f"{folds} folds hold nothing out; give at least 2")
    rare = min(dealt, key=dealt.__getitem__)
    if dealt[rare] < folds:
        raise InputError(f"'{rare}' has {dealt[rare]} runs, fewer than {folds} folds; give fewer folds")
    return made


@dataclass(frozen=True, eq=False)
class Fold:
    """A fit and the indices of the runs held out from it."""

    held_out: tuple[int, ...]
    estimation: Estimation


def fit_folds(
    model: Model,
    runs: Runs,
    labels: Sequence[str],
    settings: EstimateSettings | None = None,
    options: EstimatorOptions | None = None,
    *,
    folds: int = 4,
    workers: int = 1,
    report_progress: ProgressReporter | None = None,
) -> tuple[Fold, ...]:
    """Fit the training runs of each fold.

    Args:
        labels: kind of manoeuvre of each run.
        workers: folds fitted at a time.

    Raises:
        InputError: folds that cannot be filled, or what `identified` raises.
    """
    dealt = assign_folds(labels, folds)
    held_out = [tuple(i for i, f in enumerate(dealt) if f == fold) for fold in range(folds)]
    return fit_held_out(model, runs, held_out, settings, options, workers=workers, report_progress=report_progress)


def fit_sessions(
    model: Model,
    runs: Runs,
    settings: EstimateSettings | None = None,
    options: EstimatorOptions | None = None,
    *,
    workers: int = 1,
    report_progress: ProgressReporter | None = None,
) -> tuple[Fold, ...]:
    """Fit all sessions but one, each session held out in turn.

    Raises:
        InputError: there is but one session, or what `estimate_model` raises.
    """
    names = list(dict.fromkeys(runs.sessions))
    if len(names) < 2:
        raise InputError("all runs are of one session, so none can be held out; give [[records]] another 'session'")
    held_out = [tuple(i for i, s in enumerate(runs.sessions) if s == name) for name in names]
    return fit_held_out(model, runs, held_out, settings, options, workers=workers, report_progress=report_progress)


def fit_held_out(
    model: Model,
    runs: Runs,
    held_out: Sequence[tuple[int, ...]],
    settings: EstimateSettings | None = None,
    options: EstimatorOptions | None = None,
    *,
    workers: int = 1,
    report_progress: ProgressReporter | None = None,
) -> tuple[Fold, ...]:
    """Fit all runs but those at the positions of each entry of `held_out`.

    Raises:
        InputError: what `estimate_model` raises.
    """
    settings = with_segment_seconds(settings or EstimateSettings(), model, runs)

    def one(fold: int) -> Fold:
        train = [i for i in range(len(runs)) if i not in held_out[fold]]
        if report_progress:
            report_progress(
                f"fold {fold + 1} of {len(held_out)}: {len(train)} runs train, {len(held_out[fold])} are held out"
            )
        return Fold(tuple(held_out[fold]), estimate_model(model, runs.selected(train), settings, options))

    return tuple(map_in_threads(one, range(len(held_out)), workers=workers))


OffsetRule = Callable[[Estimation, str, Record], Array]
"""A fit, a session and its record -> what the run is given of its own, (k,)."""


def population_offsets(estimation: Estimation, session: str, record: Record) -> Array:
    """Return the session's estimate where it was fitted, else what the population of sessions expects, (k,)."""
    return session_offsets(estimation, session, record).expected


def cross_validate(
    folds: Sequence[Fold],
    runs: Runs,
    labels: Sequence[str],
    protocol: HoldoutProtocol | None = None,
    offsets: OffsetRule = population_offsets,
) -> CrossValidation:
    """Predict windows of each fold's held-out runs with its fit; runs and labels as in `fit_folds`.

    Nothing is taken from a held-out run but the first seconds of each window, for its initial state, and what `offsets`
    makes of its inputs.

    Raises:
        InputError: as `window_errors`.
    """
    protocol, made = protocol or HoldoutProtocol(), []
    for number, fold in enumerate(folds):
        held, kinds = [runs.records[i] for i in fold.held_out], [labels[i] for i in fold.held_out]
        owns = [offsets(fold.estimation, runs.sessions[i], runs.records[i]) for i in fold.held_out]
        made += window_errors(
            fold.estimation.estimate.problem, fold.estimation.model, held, owns, kinds, protocol, number
        )
    return CrossValidation(tuple(made), tuple(fold.estimation.elapsed_s for fold in folds))


def cross_validate_unfitted(
    model: Model,
    runs: Runs,
    labels: Sequence[str],
    protocol: HoldoutProtocol | None = None,
    channels: tuple[str, ...] = (),
) -> CrossValidation:
    """The same windows by a model as it is, without nuisances: what published coefficients predict. One fold.

    channels: observables that are compared; empty: all that the runs measure. The noise of the runs, or else the
    spread of a channel, weighs initial states.

    Raises:
        InputError: as `window_errors`.
    """
    data = cut_segments(model, runs.records, compared_outputs(model, runs.records, channels), None)
    spread = np.maximum(np.nanstd(data.measured, axis=0), 1e-9)
    noise = np.array([runs.noise.get(o, size) for o, size in zip(data.outputs, spread, strict=True)])
    template = OutputError(model, data, noise)
    owns = [np.empty(0)] * len(runs)
    return CrossValidation(
        tuple(window_errors(template, model, runs.records, owns, labels, protocol or HoldoutProtocol()))
    )


def jackknife_error(values: Sequence[float]) -> float:
    """Return the standard error from values with one run left out each (Tukey 1958, Ann. Math. Stat. 29, 614)."""
    given = np.asarray(values, dtype=float)
    count = len(given)
    return math.sqrt((count - 1) / count * float(np.sum((given - given.mean()) ** 2)))
