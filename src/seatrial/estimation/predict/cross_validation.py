"""Cross-validation over whole runs: windows of held-out runs simulated open loop, errors pooled by kind of manoeuvre.

Whole runs are held out, never pieces of them: neighbouring samples share wind and noise, and random splits leak
(Stone 1974, J. R. Stat. Soc. B 36, 111-147, for runs instead of observations).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, ProgressReporter, Record
from seatrial.data.trial import EstimateSettings
from seatrial.estimation.estimate.fit import Estimation, estimate_model, with_segment_seconds
from seatrial.estimation.estimate.runs import Runs
from seatrial.estimation.estimate.settings import EstimatorOptions
from seatrial.estimation.predict.open_loop import mean_nuisances
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import compared_outputs, cut_segments
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.numerics.workers import map_in_threads

_TRACK = ("x0", "y0", "psi")


@dataclass(frozen=True)
class HoldoutProtocol:
    """How held-out runs are judged.

    Attributes:
        window_s: length of the windows; they follow one another from the first sample, the remainder is dropped.
        initial_s: the initial state of a window is estimated from its first seconds; 0 takes the first sample as it is.
        first: number of windows of each run that count; None: all.
    """

    window_s: float = 50.0
    initial_s: float = 5.0
    max_windows: int | None = None


@dataclass(frozen=True)
class WindowError:
    """Root-mean-square error of one window: position in m, heading in degrees; `start` in s."""

    run: str
    label: str
    fold: int
    start: float
    position_m: float
    heading_deg: float


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
        """All windows of a label, or those of one fold.

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
        """Standard deviation over folds of the pooled position [m] and heading error [deg]."""
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


def split_windows(record: Record, protocol: HoldoutProtocol) -> list[Record]:
    """The record's windows, one after another; empty where it is shorter than one."""
    steps = round(protocol.window_s / record.dt)
    count = (len(record) - 1) // steps
    return [record.rows(slice(i * steps, (i + 1) * steps + 1)) for i in range(count)][: protocol.max_windows]


@dataclass(frozen=True, eq=False)
class _WindowSet:
    """Stretches of records with the record each comes from; `owns` holds the nuisances of each record."""

    records: list[Record]
    record_indices: list[int]
    nuisances: Sequence[Array]

    @classmethod
    def from_records(
        cls, records: Sequence[Record], nuisances: Sequence[Array], protocol: HoldoutProtocol
    ) -> "_WindowSet":
        cut_up = [split_windows(record, protocol) for record in records]
        whose = [i for i, found in enumerate(cut_up) for _ in found]
        if not whose:
            raise InputError(f"no run is as long as a window of {protocol.window_s:g} s; give shorter windows")
        return cls([piece for found in cut_up for piece in found], whose, nuisances)

    def first_seconds(self, seconds: float) -> "_WindowSet":
        """Their first seconds, five samples at least."""
        short = [p.between(p.time[0], p.time[0] + max(seconds, 4 * p.dt)) for p in self.records]
        return replace(self, records=short)

    def problem(self, template: OutputError, model: Model, outputs: tuple[str, ...]) -> tuple[OutputError, Array]:
        """One segment a piece with everything but initial states pinned, and the pinned unknowns."""
        fixed = model.with_parameters(model.parameters.fixed(*model.parameters.names))
        data = cut_segments(fixed, self.records, outputs, None, [str(i) for i in self.record_indices])
        pinned = np.concatenate([self.nuisances[int(i)] for i in data.sessions])
        place = {o: i for i, o in enumerate(template.data.outputs)}
        noise = np.array([template.noise[place[o]] if o in place else 1.0 for o in outputs])
        return replace(template, model=fixed, data=data, noise=noise, inflation=None, pinned=pinned), pinned


def _initial_states(template: OutputError, model: Model, pieces: _WindowSet, seconds: float) -> dict[str, Array]:
    """Initial states by name, each (pieces,): estimated from the first seconds, as measured where `seconds` is 0."""
    if seconds <= 0:
        count = len(pieces.records)
        return {
            s: np.array([p[s][0] for p in pieces.records]) if s in pieces.records[0] else np.zeros(count)
            for s in model.states
        }
    problem, pinned = pieces.first_seconds(seconds).problem(template, model, template.data.outputs)
    found = levenberg_marquardt(problem, pinned, problem.measured_initial_states(), evaluations=40)
    return dict(zip(problem.starts, found.local.T, strict=True))


def window_errors(
    template: OutputError,
    model: Model,
    records: Sequence[Record],
    nuisances: Sequence[Array],
    labels: Sequence[str],
    protocol: HoldoutProtocol,
    fold: int = 0,
) -> list[WindowError]:
    """Errors of all windows of `records`, simulated open loop with the nuisances `owns`, shape (kinds,) a record.

    A window in which position or heading is never measured has no error and is left out.
    template: the problem whose outputs, noise and nuisances are used to estimate initial states.

    Raises:
        InputError: a record lacks position or heading, no record holds a window, or a simulation diverges.
    """
    _require_track(records)
    pieces = _WindowSet.from_records(records, nuisances, protocol)
    start = _initial_states(template, model, pieces, protocol.initial_s)
    problem, pinned = pieces.problem(template, model, _TRACK)
    simulated = problem.simulated_outputs(pinned, np.stack([start[s] for s in problem.starts], axis=1))
    made = []
    for piece, index, (a, b) in zip(pieces.records, pieces.record_indices, pairwise(problem.data.offsets), strict=True):
        if not np.all(np.isfinite(simulated[a:b])):
            raise InputError(
                f"the simulation of run '{piece.name}' from {piece.time[0]:g} s diverges; check the bounds"
            )
        error = simulated[a:b] - problem.data.measured[a:b]
        if not np.all(np.any(np.isfinite(error), axis=0)):
            continue
        position = float(np.sqrt(np.nanmean(error[:, 0] ** 2 + error[:, 1] ** 2)))
        heading = float(np.degrees(np.sqrt(np.nanmean(error[:, 2] ** 2))))
        made.append(WindowError(piece.name, labels[index], fold, float(piece.time[0]), position, heading))
    return made


def _require_track(records: Sequence[Record]) -> None:
    for record in records:
        for channel in _TRACK:
            if channel not in record:
                raise InputError(
                    f"record '{record.name}' has no '{channel}'; windows are judged by position and heading"
                )


def session_nuisances(estimation: Estimation, session: str) -> Array:
    """Nuisances of a session: its own estimate where it was in training, else the training mean; shape (kinds,)."""
    problem, shared = estimation.estimate.problem, estimation.estimate.common_parameters
    if session not in problem.data.sessions:
        return mean_nuisances(problem, shared)
    return shared[problem.columns_of(problem.data.sessions.index(session))[len(problem.free) :]]


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
    settings = with_segment_seconds(settings or EstimateSettings(), model, runs)
    dealt = assign_folds(labels, folds)

    def one(fold: int) -> Fold:
        train = [i for i, f in enumerate(dealt) if f != fold]
        if report_progress:
            report_progress(
                f"fold {fold + 1} of {folds}: {len(train)} runs train, {len(dealt) - len(train)} are held out"
            )
        found = estimate_model(model, runs.selected(train), settings, options)
        return Fold(tuple(i for i, f in enumerate(dealt) if f == fold), found)

    return tuple(map_in_threads(one, range(folds), workers=workers))


def cross_validate(
    folds: Sequence[Fold],
    runs: Runs,
    labels: Sequence[str],
    protocol: HoldoutProtocol | None = None,
) -> CrossValidation:
    """Predict windows of each fold's held-out runs with its fit; runs and labels as in `fit_folds`.

    Nothing is taken from a held-out run but the first seconds of each window, for its initial state. Nuisances come
    from training runs of the same session where there are any, else they are the training mean.

    Raises:
        InputError: as `window_errors`.
    """
    protocol, made = protocol or HoldoutProtocol(), []
    for number, fold in enumerate(folds):
        owns = [session_nuisances(fold.estimation, runs.sessions[i]) for i in fold.held_out]
        held, kinds = [runs.records[i] for i in fold.held_out], [labels[i] for i in fold.held_out]
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
