"""The repetition: what is published, the fit, the turns, runs left out, what the intervals are worth."""

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import stdtrit

from seatrial.core.equations import Model
from seatrial.core.results import CandidateModel, Fit, Prediction
from seatrial.core.values import Array, Finding, InputError, ProgressReporter, Record, Severity
from seatrial.data.check import examine, sample_noise
from seatrial.data.read import ColumnSpec, Layout
from seatrial.data.trial import Role, RunFiles, Trial, TrialRecord, approach_condition, load_records
from seatrial.estimation.estimate import (
    INITIAL_STATE_SHIP_LENGTHS,
    Estimation,
    EstimatorOptions,
    IntervalMethod,
    ship_length_seconds,
    training_runs,
)
from seatrial.estimation.identify import estimate_model, identify
from seatrial.estimation.information import HoldoutError, discrepancy, extrapolation_index
from seatrial.estimation.predict import (
    HoldoutProtocol,
    Windows,
    band_errors,
    holdout_model,
    measure_intervals,
    predict_run,
    prediction_uncertainty,
    session_offsets,
    simulate_open_loop,
)
from seatrial.physics.manoeuvres import measures, programme
from seatrial.physics.simulate import SOLAS_SLEW_RATE, manoeuvre
from seatrial_studies.cross_validation import cross_validate, fit_folds
from seatrial_studies.study_file import Declared, read_study

# What is published: the paper's numbers, what its code gives when run again, and the measured turning circles.

SIDES = ("port", "starboard")


@dataclass(frozen=True)
class Turn:
    """Advance and tactical diameter of a 35 deg turn in ship lengths; an empty `side` means it is not stated."""

    side: str
    advance: float
    diameter: float
    source: str


class PrintedTurn(Declared):
    """Advance and tactical diameter as they are printed, m, for a ship of this length, m."""

    side: str
    advance: float
    diameter: float
    length: float
    source: str

    @property
    def turn(self) -> Turn:
        """Return the turn in ship lengths."""
        return Turn(self.side, self.advance / self.length, self.diameter / self.length, self.source)


def _printed_turns(name: str) -> tuple[Turn, ...]:
    printed = read_study("alexandersson2022").published[name]
    return tuple(PrintedTurn.model_validate(turn).turn for turn in printed)


MEASURED_TURNS = {turn.side: turn for turn in _printed_turns("measured")}
PREDICTED_TURNS = {turn.side: turn for turn in _printed_turns("predicted")}
OTHER_TURNS = _printed_turns("other")


def percent_deviation(value: float, reference: float) -> float:
    """Return the deviation of `value` from `reference` in per cent."""
    return 100.0 * (value / reference - 1.0)


def published_range(measure: str) -> tuple[float, float]:
    """Smallest and largest measured value over sides and sources, widened by the paper's largest own error.

    measure: ``advance`` or ``diameter``.
    """
    values = [float(getattr(turn, measure)) for turn in (*MEASURED_TURNS.values(), *OTHER_TURNS)]
    worst = max(
        abs(percent_deviation(float(getattr(PREDICTED_TURNS[s], measure)), float(getattr(MEASURED_TURNS[s], measure))))
        for s in SIDES
    )
    return min(values) * (1.0 - worst / 100.0), max(values) * (1.0 + worst / 100.0)


# Are the bands right? Heading and position in windows of runs left out, against bands that never saw the run.


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


# Leave one run out: the others train, the one left out is predicted whole and in windows, the turns once more.

# s, length of the windows that are predicted; our choice
WINDOW_S = 30.0


@dataclass(frozen=True, eq=False)
class LeftOutRun:
    """One training run left out.

    Attributes:
        prediction: the run open loop from beginning to end, offsets from the runs that trained.
        window_count: number of windows of 30 s in it.
        window_heading_deg, window_position_m: mean of the windows' rms errors.
        turns: side -> the 35 deg turn of the model without this run.
    """

    run: str
    prediction: Prediction
    window_count: int
    window_heading_deg: float
    window_position_m: float
    turns: Mapping[str, Turn]


def leave_one_out(
    trial: Trial,
    train: Sequence[TrialRecord],
    simulate_turns: Callable[[Model], Mapping[str, Turn]],
    report_progress: ProgressReporter | None = None,
) -> tuple[LeftOutRun, ...]:
    """Every training run left out in turn, on one core; settings are the trial's, nothing is chosen.

    Raises:
        InputError: fewer than two training runs, or what the estimate and the predictions raise.
    """
    runs, labels = training_runs(trial, train), ["zigzag"] * len(train)
    records, sessions, length = runs.records, runs.sessions, runs.length
    folds = fit_folds(
        trial.model, runs, labels, trial.estimate, EstimatorOptions(workers=1), folds=len(train),
        report_progress=report_progress,
    )  # fmt: skip
    scored = cross_validate(folds, runs, labels, HoldoutProtocol(window_s=WINDOW_S))
    seconds = trial.estimate.initial_s or INITIAL_STATE_SHIP_LENGTHS * ship_length_seconds(records, length)
    made = []
    for fold in folds:
        (held,) = fold.held_out
        own = session_offsets(fold.estimation, sessions[held], records[held]).expected
        problem = fold.estimation.estimate.problem
        run = simulate_open_loop(problem, fold.estimation.model, records[held], own, seconds)
        whole = predict_run(fold.estimation.model, records[held], "validation", run, seconds, length)
        windows = [w for w in scored.windows if w.run == records[held].name]
        made.append(
            LeftOutRun(
                run=records[held].name,
                prediction=whole,
                window_count=len(windows),
                window_heading_deg=float(np.mean([w.heading_deg for w in windows])),
                window_position_m=float(np.mean([w.position_m for w in windows])),
                turns=simulate_turns(fold.estimation.model),
            )
        )
    return tuple(made)


# What the intervals are worth: the turns' beside MARIN's circles, the bands of 30 s windows beside the records.

_MEASURES = {"advance_L": ("advance", "advance"), "tactical_diameter_L": ("tactical diameter", "diameter")}


@dataclass(frozen=True)
class TurnInterval:
    """A measure of a simulated turn with its interval, and MARIN's value, in ship lengths."""

    side: str
    measure: str
    lower: float
    upper: float
    measured: float

    @property
    def half_width(self) -> float:
        """Return the half width in per cent of the interval's middle."""
        return 100.0 * (self.upper - self.lower) / (self.upper + self.lower)

    @property
    def relative_deviation(self) -> float:
        """Return the distance of MARIN's value from the middle over the half width; 1 at the interval's end."""
        return abs(2.0 * self.measured - self.lower - self.upper) / (self.upper - self.lower)

    @property
    def contains_measured(self) -> bool:
        """Return whether the measured value lies inside."""
        return self.lower <= self.measured <= self.upper


@dataclass(frozen=True)
class PredictionCoverage:
    """Intervals of the turns, and shares of samples inside their bands: runs left out, and held out.

    with_tied: intervals of the turns by full refits and the spread of tied models; family: those models; both empty in
    the quick version.
    """

    turn_intervals: tuple[TurnInterval, ...]
    left_out_coverage: tuple[BandCoverage, ...]
    held_out_coverage: tuple[BandCoverage, ...]
    tied_turn_intervals: tuple[TurnInterval, ...] = ()
    family: tuple[CandidateModel, ...] = ()

    @property
    def heading_share(self) -> float:
        """Return the mean share of headings over the runs left out."""
        return float(np.mean([c.shares["psi"] for c in self.left_out_coverage]))


def assess_coverage(
    fit: Fit,
    tied_fit: Fit | None,
    estimation: Estimation,
    train: Sequence[TrialRecord],
    validation: Sequence[TrialRecord],
    approach: Mapping[str, float],
    seed: int,
) -> PredictionCoverage:
    """Steer the turns with ships beside the fit, and beside the one with the spread of tied models; predict windows.

    Raises:
        InputError: the turns diverge, or there are too few runs to leave any out.
    """
    within, beyond = band_coverage(
        holdout_windows(estimation, train, validation, HoldoutProtocol(window_s=WINDOW_S), seed)
    )
    turns, with_tied = (
        tuple(m for side in SIDES for m in simulated_turn_intervals(one, side, approach)) if one else ()
        for one in (fit, tied_fit)
    )
    return PredictionCoverage(turns, within, beyond, with_tied, tied_fit.candidate_models if tied_fit else ())


def simulated_turn_intervals(fit: Fit, side: str, approach: Mapping[str, float]) -> list[TurnInterval]:
    """Return the advance and tactical diameter of the 35 deg turn to one side.

    Raises:
        InputError: the fit has no margin, or most ships beside it cannot be steered through the turn.
    """
    if fit.interval_basis is None:
        raise InputError("this fit says nothing of its predictions' uncertainty; identify again")
    held = {name: value for name, value in approach.items() if name in fit.model.input_names}
    slew = SOLAS_SLEW_RATE * math.sqrt(fit.ship.scale)
    orders = programme(f"turning-circle:35:{side}")
    intervals = measure_intervals(
        fit.model,
        fit.interval_basis,
        lambda ship: manoeuvre(ship, orders, inputs=held, slew_rate=slew),
        fit.ship.length,
    )
    return [
        TurnInterval(side, name, *interval, float(getattr(MEASURED_TURNS[side], field)))
        for key, (name, field) in _MEASURES.items()
        if (interval := intervals.get(key)) is not None  # None: not determined
    ]


# The numbers of the repetition: fit, turns, the headers' labels put to the test, noise from sample to sample.


@dataclass(frozen=True, eq=False)
class BenchmarkReproduction:
    """Everything the study's tables, claims and checks rest on.

    Attributes:
        fit: of the trial file as it is, the validation run predicted.
        warm_fit_s: s for the estimate alone, all code compiled.
        turns: side -> simulated 35 deg turn; tracks: the same as records.
        label_findings: run -> errors that the checks find when the columns are declared as the headers name them.
        noise_levels: channel -> noise from sample to sample, SI, median over runs.
        left_out_runs: one entry a training run; empty in the quick version.
        coverage: how often the intervals of predictions hold the measured values.
    """

    fit: Fit
    warm_fit_s: float
    turns: Mapping[str, Turn]
    tracks: Mapping[str, Record]
    label_findings: Mapping[str, tuple[Finding, ...]]
    noise_levels: Mapping[str, float]
    left_out_runs: tuple[LeftOutRun, ...]
    coverage: PredictionCoverage


def reproduce_benchmark(
    trial: Trial, *, quick: bool, seed: int, report_progress: ProgressReporter | None
) -> BenchmarkReproduction:
    """Identify, simulate the turns, and (unless quick) leave out each training run in turn.

    Raises:
        InputError: what `identify` raises.
    """
    report = report_progress or (lambda _: None)
    fit = identify(trial, seed, report_progress)
    raw = load_records(trial)[0]
    rate = trial.estimate.rate
    used = [replace(r, record=r.record.resampled(rate) if rate else r.record) for r in raw]
    train, held = ([r for r in used if r.role is role] for role in (Role.TRAIN, Role.VALIDATE))
    records = [r.record for r in train]
    approach = approach_condition(records, trial.model)
    report("the fit once more, warm")
    began = time.perf_counter()
    found = estimate_model(trial.model, training_runs(trial, train), trial.estimate)
    warm = time.perf_counter() - began
    wide = None if quick else identify(trial, seed, report_progress, intervals=IntervalMethod.JACKKNIFE)
    report("the headers' labels")
    labels = label_errors(trial)
    tracks = {side: turn_record(fit.model, side, approach, trial.ship.scale) for side in SIDES}
    return BenchmarkReproduction(
        fit=fit,
        warm_fit_s=warm,
        turns={side: turn_measures(track, side, trial.ship.length) for side, track in tracks.items()},
        tracks=tracks,
        label_findings=labels,
        noise_levels=median_noise([r.record for r in raw], [n.channel for n in fit.channel_noise]),
        left_out_runs=() if quick else _leave_one_out(trial, train, approach, report_progress),
        coverage=assess_coverage(fit, wide, found, train, held, approach, seed),
    )


def _leave_one_out(
    trial: Trial, train: Sequence[TrialRecord], approach: Mapping[str, float], report_progress: ProgressReporter | None
) -> tuple[LeftOutRun, ...]:
    def simulate_turns(model: Model) -> dict[str, Turn]:
        records = {side: turn_record(model, side, approach, trial.ship.scale) for side in SIDES}
        return {side: turn_measures(record, side, trial.ship.length) for side, record in records.items()}

    return leave_one_out(trial, train, simulate_turns, report_progress)


def turn_record(model: Model, side: str, approach: Mapping[str, float], scale: float) -> Record:
    """Return the 35 deg turn as ``seatrial simulate MODEL --manoeuvre turning-circle:35:SIDE`` steers it."""
    held = {name: value for name, value in approach.items() if name in model.input_names}
    text = f"turning-circle:35:{side}"
    return manoeuvre(model, programme(text), inputs=held, slew_rate=SOLAS_SLEW_RATE * math.sqrt(scale))


def turn_measures(record: Record, side: str, length: float) -> Turn:
    """Return the advance and tactical diameter of a simulated turn; NaN where it does not come round."""
    found = measures(record, length)
    return Turn(side, found.get("advance_L", math.nan), found.get("tactical_diameter_L", math.nan), "simulated here")


def label_errors(trial: Trial) -> dict[str, tuple[Finding, ...]]:
    """Return errors the checks find in each run when its columns are declared as the files' headers name them."""
    return {
        run.name: tuple(
            finding
            for file in run.files
            for finding in examine(RunFiles.of_file(file.path, layout_as_labelled(file.layout)).read())
            if finding.severity is Severity.ERROR
        )
        for run in trial.runs
    }


def layout_as_labelled(layout: Layout) -> Layout:
    """The headers' reading: columns 5 to 8 are u, v, p, r of the ship, a positive rudder steers to starboard."""
    changed = {
        "u": lambda c: replace(c, frame="body", positive=""),
        "v": lambda c: replace(c, frame="body", positive=""),
        "r": lambda c: replace(c, symbol="p"),
        "delta": lambda c: replace(c, positive="starboard"),
    }
    columns = [changed[c.symbol](c) if c.symbol in changed else c for c in layout.columns]
    return replace(layout, columns=(*columns, ColumnSpec("r", 8, "deg/s")))


def median_noise(records: Sequence[Record], channels: Sequence[str]) -> dict[str, float]:
    """Return noise of each channel from sample to sample, SI: median over the records as they were sampled."""
    made = {}
    for channel in channels:
        found = [sample_noise(r[channel]) for r in records if channel in r]
        if found:
            made[channel] = float(np.median(found))
    return made
