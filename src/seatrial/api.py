"""The commands as functions of values: check, identify, follow, design, tune, simulate, report, demo, reproduce.

import seatrial.api as sea

trial = sea.load_trial("examples/waterjet.toml")
fit = sea.identify(trial)
sea.report(fit, "report.html")
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from importlib.metadata import entry_points
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from seatrial.control.task import TuningTask
    from seatrial.core.equations import Model
    from seatrial.core.results import Design, Extrapolation, Fit, Study
    from seatrial.core.results.online import SampleCounts, Snapshot
    from seatrial.core.results.tuning import Tuning
    from seatrial.core.values import Finding, Record
    from seatrial.data.folder.model_file import ModelFile
    from seatrial.data.trial import Trial
    from seatrial.onboard.follow import FollowResult
    from seatrial.onboard.sample import SampleSource

ProgressCallback = Callable[[str], None]


def load_trial(path: str | Path, own_model: "Model | None" = None) -> "Trial":
    """The trial a TOML file describes; record files are found, not yet read.

    Raises:
        InputError: one sentence naming file, key and what to do.
    """
    from seatrial.data.trial import load_trial

    return load_trial(path, own_model)


def check(trial: "Trial") -> "tuple[Finding, ...]":
    """Read the trial's records and say what is odd about them.

    Raises:
        InputError: a record cannot be read at all.
    """
    from seatrial.data.trial import load_records

    return load_records(trial)[1]


def identify(
    trial: "Trial",
    seed: int = 0,
    report_progress: ProgressCallback | None = None,
    *,
    intervals: str = "auto",
    choose: bool = False,
    compare: bool = False,
) -> "Fit":
    """Estimate the trial's model from its training runs and predict its validation runs, with intervals.

    Args:
        intervals: ``auto``, ``jackknife`` (every run left out, refitted, and the spread of tied models), ``bootstrap``
            or ``profile``.
        choose: compare the family of models and take the one that predicts runs left out best.
        compare: put other estimators (regressions) on the same records beside the fit.

    Raises:
        InputError: the records do not pass the checks, show no excitation, or cannot tell the parameters apart.
    """
    from seatrial.physics.models.precompile import Precompilation

    compiling = Precompilation(trial.model.name)
    from seatrial.core.values import InputError, spelling_hint
    from seatrial.estimation.identify import IntervalMethod, identify

    if intervals not in (kinds := [kind.value for kind in IntervalMethod]):
        raise InputError(f"unknown kind of intervals '{intervals}'{spelling_hint(intervals, kinds)}")
    compiling.wait()
    kind = IntervalMethod(intervals)
    return identify(trial, seed=seed, report_progress=report_progress, intervals=kind, choose=choose, compare=compare)


def follow(
    trial: "Trial",
    *,
    source: "SampleSource | None" = None,
    once: bool = False,
    journal: str | Path | None = None,
    show: "Callable[[Snapshot, SampleCounts], None] | None" = None,
    stop: Callable[[], bool] | None = None,
    seed: int = 0,
    report_progress: ProgressCallback | None = None,
) -> "FollowResult":
    """Estimate while the record is still being made, from the samples that [follow] of the trial names.

    Args:
        source: takes the place of the one that the trial file names.
        once: end at the end of the input; the outcome then holds the fit `identify` makes of what was accepted.
        journal: file in which admitted samples are kept; one that is there already is read first and continued.
        show: called with what is known and what happened to the samples, twice a second at most.
        stop: asked several times a second; ends the work when it says so.
        seed: of the fit of `once`.

    Raises:
        InputError: the trial has no [follow], it lacks channels, its source cannot be opened, or the journal is of
            another trial.
    """
    from seatrial.physics.models.precompile import Precompilation

    compiling = Precompilation(trial.model.name)
    from seatrial.onboard.follow import follow

    compiling.wait()
    place = None if journal is None else Path(journal)
    return follow(
        trial, source=source, once=once, journal=place, show=show, stop=stop, seed=seed, report_progress=report_progress
    )


def save_outcome(outcome: "FollowResult", folder: str | Path) -> Path:
    """Write what following came to: a result folder with its report after `once`, else ``online.json``; its path.

    Raises:
        InputError: the folder cannot be written.
    """
    from seatrial.core.values.files import write_files_atomically
    from seatrial.data.folder.fit_json import strict_json
    from seatrial.data.folder.online_json import online_json

    if outcome.fit is not None:
        return save_fit(outcome.fit, folder)
    text = strict_json(online_json(outcome.snapshot, outcome.counts))
    return write_files_atomically(Path(folder), {"online.json": text.encode()}) / "online.json"


def save_fit(fit: "Fit", folder: str | Path) -> Path:
    """Write the result folder (see docs/result-folder.md) with its report; returns the report's path.

    Raises:
        InputError: the folder cannot be written.
    """
    from seatrial.data.folder.result_folder import save_fit

    return report(fit, save_fit(fit, folder) / "report.html")


def load_fit(folder: str | Path, own_model: "Model | None" = None) -> "Fit":
    """The fit of a result folder.

    Raises:
        InputError: it is none, or its files do not belong together.
    """
    from seatrial.data.folder.result_folder import load_fit

    return load_fit(folder, own_model)


def report(fit: "Fit", path: str | Path) -> Path:
    """Render the fit as one self-contained HTML file; nothing is computed.

    Raises:
        InputError: the file cannot be written.
    """
    from seatrial.reporting import write_report

    write_report(fit, Path(path))
    return Path(path)


def load_model(path: str | Path, own_model: "Model | None" = None) -> "ModelFile":
    """A model file: the model, its covariance, and the approach condition of the trials it comes from.

    Raises:
        InputError: no model file, or its equations have changed since.
    """
    from seatrial.data.folder.model_file import read_model_file

    return read_model_file(path, own_model)


def design(
    trial: "Trial",
    seed: int = 0,
    report_progress: ProgressCallback | None = None,
    prior_model: "ModelFile | None" = None,
) -> "Design":
    """The manoeuvre that tells the trial's coefficients best within its limits, beside the standard ones.

    Args:
        seed: of the search, of the ships drawn from the prior, and of the noise that confirms the design.
        prior: a model file of `identify`; its values and their covariance take the place of the trial's.

    Raises:
        InputError: the trial has no [design], its sensors or inputs do not fit the model, the model file holds another
            model, or nothing keeps within the limits.
    """
    from seatrial.physics.models.precompile import Precompilation

    compiling = Precompilation(trial.model.name)
    from seatrial.estimation.design.design import design
    from seatrial.estimation.design.from_trial import design_task

    task = design_task(trial, prior_model)
    compiling.wait()
    return design(task, seed=seed, report_progress=report_progress or (lambda _: None))


def save_design(design: "Design", folder: str | Path) -> Path:
    """Write report, orders, plan, model and ``design.json`` of a design to `folder`; returns the report's path.

    Raises:
        InputError: the folder cannot be written.
    """
    from seatrial.core.values.files import write_files_atomically
    from seatrial.data.folder.design_json import design_json
    from seatrial.data.folder.fit_json import strict_json
    from seatrial.data.folder.model_file import ModelFile, model_text
    from seatrial.data.folder.orders import orders_csv
    from seatrial.data.read.record_csv import record_csv
    from seatrial.reporting.design import html

    texts = {
        "orders.csv": orders_csv(design),
        "plan.csv": record_csv(design.plan),
        "design.json": strict_json(design_json(design)),
        "model.toml": model_text(ModelFile(design.model)),
        "report.html": html(design),
    }
    return write_files_atomically(Path(folder), {name: text.encode() for name, text in texts.items()}) / "report.html"


def load_loop(path: str | Path, own_model: "Model | None" = None, model_file: str | Path | None = None) -> "TuningTask":
    """The tuning that a loop file asks for (see docs/loop-file.md).

    Args:
        own_model: equations of a model file that are not built in.
        model_file: takes the place of the one that the loop file names.

    Raises:
        InputError: one sentence naming file, key and what to do.
    """
    from seatrial.control.loopfile.load import tuning_task

    return tuning_task(Path(path), own_model, None if model_file is None else Path(model_file))


def tune(task: "TuningTask | str | Path", seed: int = 0, report_progress: ProgressCallback | None = None) -> "Tuning":
    """Gains of a feedback loop: the front, the choice and its reasons, what nonlinear simulation says of it.

    Args:
        task: as `load_loop` gives it, or the path of a loop file.
        seed: of the search, of the seas simulated, and of the ships drawn from the fit.

    Raises:
        InputError: as `load_loop`; no gains keep the limits (which limit, by how much).
    """
    from seatrial.control.task import TuningTask
    from seatrial.control.tune import tune

    asked = task if isinstance(task, TuningTask) else load_loop(task)
    return tune(asked, seed=seed, report_progress=report_progress or (lambda _: None))


def save_tuning(tuning: "Tuning", folder: str | Path) -> Path:
    """Write report, gains, loop, schedule and ``tuning.json`` of a tuning to `folder`; returns the report's path.

    Raises:
        InputError: the folder cannot be written.
    """
    from seatrial.core.values.files import write_files_atomically
    from seatrial.data.folder.fit_json import strict_json
    from seatrial.data.folder.tuning_files import gains_toml, loop_mat, schedule_csv
    from seatrial.data.folder.tuning_json import tuning_json
    from seatrial.reporting.tuning import html

    contents = {
        "gains.toml": gains_toml(tuning).encode(),
        "loop.mat": loop_mat(tuning),
        "tuning.json": strict_json(tuning_json(tuning)).encode(),
        "report.html": html(tuning).encode(),
    }
    if tuning.schedule:
        contents["schedule.csv"] = schedule_csv(tuning).encode()
    return write_files_atomically(Path(folder), contents) / "report.html"


Steering = Callable[["Model"], "Record"]


def steering(
    model: "ModelFile",
    manoeuvre: str,
    *,
    speed: float | None = None,
    inputs: Mapping[str, float] | None = None,
    duration: float | None = None,
    rudder_rate: float | None = None,
    seed: int = 0,
) -> Steering:
    """What steers a manoeuvre such as ``zigzag:20/20`` with any model of these equations, under the file's conditions.

    Args:
        speed: approach speed, m/s; without it the speed at which surge balances.
        inputs: constant inputs besides the rudder, SI; the trials' own if not given.
        duration: s at most.
        rudder_rate: rad/s; SOLAS's at the ship's scale if not given.
        seed: of a random binary sequence.

    Raises:
        InputError: unknown manoeuvre, or a rudder that cannot move.
    """
    from seatrial.core.values import InputError
    from seatrial.physics.manoeuvres.programme import programme
    from seatrial.physics.simulate.steer import SOLAS_SLEW_RATE
    from seatrial.physics.simulate.steer import manoeuvre as steered

    if rudder_rate is not None and not 0.0 < rudder_rate < math.inf:
        raise InputError(
            f"the rudder rate {math.degrees(rudder_rate):g} deg/s is not positive; leave it out for SOLAS's"
        )
    scale = model.ship.scale if model.ship else 1.0
    held = {name: value for name, value in model.approach.items() if name in model.model.input_names}
    known = model.approach.get("u") if "u" not in model.model.states else None
    orders = programme(_with_seed(manoeuvre, seed))

    def steer(ship: "Model") -> "Record":
        return steered(
            ship,
            orders,
            duration=duration,
            speed=known if speed is None else speed,
            inputs={**held, **(inputs or {})},
            slew_rate=rudder_rate or SOLAS_SLEW_RATE * math.sqrt(scale),
        )

    return steer


def simulate(
    model: "ModelFile",
    manoeuvre: str,
    *,
    speed: float | None = None,
    inputs: Mapping[str, float] | None = None,
    duration: float | None = None,
    rudder_rate: float | None = None,
    seed: int = 0,
) -> "Record":
    """A manoeuvre steered by the model, as a record; arguments as in `steering`.

    Raises:
        InputError: as `steering`; an input or the speed is known to nobody, or the simulation diverges.
    """
    steer = steering(
        model, manoeuvre, speed=speed, inputs=inputs, duration=duration, rudder_rate=rudder_rate, seed=seed
    )
    return steer(model.model)


def measure_intervals(model: "ModelFile", steer: Steering) -> dict[str, tuple[float, float]]:
    """95 % interval of each measure of the manoeuvre; empty where the model file says nothing of its own uncertainty.

    Raises:
        InputError: most of the ships that the fit allows cannot be steered through the manoeuvre.
    """
    from seatrial.estimation.predict.measure_intervals import measure_intervals

    if model.interval_basis is None or model.ship is None:
        return {}
    return measure_intervals(model.model, model.interval_basis, steer, model.ship.length)


def extrapolation(model: "ModelFile", record: "Record") -> "Extrapolation | None":
    """How far a simulated run leaves what the training runs cover; None where the model file does not say it."""
    from seatrial.estimation.information.extrapolation import extrapolation

    return None if model.interval_basis is None else extrapolation(record, model.interval_basis.training_envelope)


def _with_seed(manoeuvre: str, seed: int) -> str:
    """The programme's text; a random binary sequence that names no seed of its own gets this one."""
    kind, *fields = manoeuvre.strip().split(":")
    if kind != "prbs" or len(fields) > 2:
        return manoeuvre
    return ":".join(["prbs", *fields, *["20", ""][len(fields) :], str(seed)])


def prepared_run(trial: "Trial | str | Path", name: str) -> "Record":
    """One run of a trial as `identify` would use it: canonical, trimmed, resampled.

    Raises:
        InputError: the trial has no run of that name (the nearest is named), or it cannot be read.
    """
    from seatrial.core.values import InputError, spelling_hint
    from seatrial.data.trial import Trial, load_trial
    from seatrial.data.trial.records import load_run

    known = trial if isinstance(trial, Trial) else load_trial(trial)
    runs = {run.name: run for run in known.runs}
    if name not in runs:
        raise InputError(f"the trial has no run '{name}'{spelling_hint(name, list(runs))}")
    record = load_run(runs[name], known.reference_point)[0]
    return record if known.estimate.rate is None else record.resampled(known.estimate.rate)


def replay(model: "ModelFile", record: "Record", speed: float | None = None) -> "Record":
    """The model driven by the inputs of a record, from the record's first sample; a planned one from a straight run.

    Args:
        speed: approach speed of a planned record, m/s; without it the speed at which surge balances.

    Raises:
        InputError: an input channel is missing, or the simulation diverges.
    """
    from seatrial.core.values import RecordKind
    from seatrial.physics.simulate import replay
    from seatrial.physics.simulate.approach import straight_run

    start = straight_run(model.model, record, speed) if record.kind is RecordKind.PLANNED else None
    return replay(model.model, record, start)


def rms_differences(measured: "Record", simulated: "Record") -> dict[str, float]:
    """Root-mean-square differences of two runs on one time base: keys as in `Prediction.rms`."""
    from seatrial.estimation.predict.open_loop import rms_errors

    return rms_errors(measured, simulated)


def measures(model: "ModelFile", record: "Record", measured: "Record | None" = None) -> dict[str, float]:
    """Overshoots, advance, transfer, tactical diameter and the like, as far as the record shows them.

    like: the measured run whose inputs `record` replays; the manoeuvre is then made out on it.

    Raises:
        InputError: the ship's length is not known, or the record has no heading or rudder.
    """
    from seatrial.core.values import InputError
    from seatrial.physics.manoeuvres.measures import measures

    if model.ship is None:
        raise InputError("the model file has no [ship] with the length L, which measures need; add it")
    return measures(record, model.ship.length, reference=measured)


def demo(folder: str | Path, seed: int = 0, report_progress: ProgressCallback | None = None) -> "Fit":
    """The main job on simulated trials of a craft with known coefficients; trials, result and report go to `folder`.

    Raises:
        InputError: the folder cannot be written.
    """
    from seatrial.core.values.files import writable_folder
    from seatrial.data.example_series.files import write_demo

    tell = report_progress or (lambda _: None)
    place = writable_folder(Path(folder))
    tell("simulating the trials")
    fit = identify(load_trial(write_demo(place / "trials", seed)), seed=seed, report_progress=report_progress)
    tell("writing result and report")
    save_fit(fit, place)
    return fit


class Reproduction(Protocol):
    """What an entry point of the group `seatrial.studies` names: repeats a study, `quick` with fewer cases."""

    def __call__(self, *, quick: bool, seed: int, report_progress: ProgressCallback | None) -> "Study": ...


def reproduce(
    study: str, *, quick: bool = False, seed: int = 0, report_progress: ProgressCallback | None = None
) -> "Study":
    """A published study, its claims checked.

    Raises:
        InputError: unknown study (the nearest is named).
    """
    from seatrial.core.values import InputError, spelling_hint

    studies = {point.name: point for point in entry_points(group="seatrial.studies")}
    if study not in studies:
        raise InputError(f"unknown study '{study}'{spelling_hint(study, sorted(studies))}")
    reproduction: Reproduction = studies[study].load()
    return replace(reproduction(quick=quick, seed=seed, report_progress=report_progress), quick=quick)


def save_study(study: "Study", folder: str | Path) -> Path:
    """Write ``study.json`` and ``report.html`` of a study to `folder`; returns the report's path.

    Raises:
        InputError: the folder cannot be written.
    """
    from seatrial.core.values.files import writable_folder, write_atomically
    from seatrial.data.folder.fit_json import strict_json
    from seatrial.reporting.study import write_study

    place = writable_folder(Path(folder))
    write_atomically(place / "study.json", strict_json(study.as_table()).encode())
    return write_study(study, place / "report.html")
