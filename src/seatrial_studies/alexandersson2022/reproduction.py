"""The numbers of the repetition: fit, turns, the headers' labels put to the test, noise from sample to sample."""

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Fit
from seatrial.core.values import Finding, ProgressReporter, Record, Severity
from seatrial.data.check import examine, sample_noise
from seatrial.data.read import ColumnSpec, Layout
from seatrial.data.trial import Role, Trial, TrialRecord, approach_condition, load_records
from seatrial.estimation.estimate import IntervalMethod, training_runs
from seatrial.estimation.identify import estimate_model, identify
from seatrial.physics.manoeuvres import measures, programme
from seatrial.physics.simulate import SOLAS_SLEW_RATE, manoeuvre
from seatrial_studies.alexandersson2022.leave_one_out import LeftOutRun, leave_one_out
from seatrial_studies.alexandersson2022.prediction_coverage import PredictionCoverage, assess_coverage
from seatrial_studies.alexandersson2022.published import SIDES, Turn


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
            for finding in examine(replace(run.file, layout=layout_as_labelled(run.file.layout)).read())
            if finding.severity is Severity.ERROR
        )
        for run in trial.runs
        if run.file is not None
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
