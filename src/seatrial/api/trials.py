"""From a trial to a fit: load, check, identify, follow, design."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from seatrial.core.equations import Model
    from seatrial.core.results import Design, Fit
    from seatrial.core.results.online import SampleCounts, Snapshot
    from seatrial.core.values import Finding, ProgressReporter, Record
    from seatrial.data.draft import DraftTrial, LogSurvey, SurveyedLogs
    from seatrial.data.folder.model_file import ModelFile
    from seatrial.data.trial import Trial
    from seatrial.data.trial.load import Correction
    from seatrial.data.trial.priors import EarlierResult
    from seatrial.data.trial.records import RunLoader
    from seatrial.onboard.follow import FollowResult
    from seatrial.onboard.sources import SampleSource


def load_trial(path: str | Path, own_model: "Model | None" = None) -> "Trial":
    """Load the trial that a TOML file describes; record files are located, not yet read.

    Args:
        path: the trial file.
        own_model: takes the place of the built-in model that the file names.

    Raises:
        InputError: one sentence naming file, key and what to do.
    """
    from seatrial.data.trial import load_trial

    def read_result(folder: Path) -> "EarlierResult":
        from seatrial.data.folder.model_file import read_earlier_result

        return read_earlier_result(folder, own_model)

    return load_trial(path, own_model, read_result)


def check(trial: "Trial | str | Path", load: "RunLoader | None" = None) -> "tuple[Finding, ...]":
    """Check the trial's records and return the findings: frames, signs, units, gaps, jumps, lags.

    Args:
        trial: a trial, or a trial file; of a file neither ship nor model is needed, and a finding `model` says what
            is not ready to be estimated.
        load: reads and checks a run; one that keeps runs makes a second check of a changed file as quick as its change.

    Raises:
        InputError: a record cannot be read at all.
    """
    from seatrial.core.values import Finding, InputError, Severity
    from seatrial.data.trial import Trial, load_runs, load_trial
    from seatrial.data.trial.records import load_run
    from seatrial.data.trial.trial import Role

    if isinstance(trial, Trial):
        return _checked(trial, load)
    try:
        return _checked(load_trial(trial), load)
    except InputError as error:
        runs = load_runs(trial)
        if not runs:
            raise
        used = (run for run in runs if run.role is not Role.LEAVE_OUT)
        findings = [finding for run in used for finding in load_run(run, 0.0, load).findings]
        what, advice = "'seatrial identify' cannot start yet", str(error)
        return (*findings, Finding(Severity.INFO, "model", what, "", advice))


def _checked(trial: "Trial", load: "RunLoader | None" = None) -> "tuple[Finding, ...]":
    """The findings of the records, and one where they lack an input of the model, or a state that nothing implies."""
    from seatrial.core.values import Finding, InputError, Severity
    from seatrial.data.trial import Role, load_records
    from seatrial.physics.simulate.replay import require_inputs

    records, findings = load_records(trial, load)
    try:
        for record in records:
            require_inputs(trial.model, record.record)
        _require_motion(trial.model, [r.record for r in records if r.role is Role.TRAIN])
    except InputError as error:
        what = "'seatrial identify' cannot start yet"
        return (*findings, Finding(Severity.INFO, "model", what, "", str(error)))
    return findings


def _require_motion(model: "Model", records: "Sequence[Record]") -> None:
    """Refuse records of a steered craft from which its states cannot begin.

    Raises:
        InputError: a state is neither measured nor implied by another channel.
    """
    from seatrial.physics.simulate.states import hidden_states, measured_states

    if model.has_rudder and not hidden_states(model, records):
        for record in records:
            measured_states(model, record)


def correct_trial(trial: "str | Path") -> "Correction":
    """Correct a trial file by what `check` is certain of: units, signs, frames, exchanged columns, reference points.

    A change is kept only where fewer errors are left with it; edits of warnings are not made. No file is written.

    Returns:
        The text of the corrected file, what was changed, what was not and why, and the findings that are left.

    Raises:
        InputError: the file or its records cannot be read.
    """
    from seatrial.data.trial.load import corrected_trial

    return corrected_trial(trial)


def draft_trial(
    *logs: "str | Path",
    folder: "str | Path" = ".",
    length: float = 0.0,
    beam: float = 0.0,
    draught: float = 0.0,
    mass: float = 0.0,
    gear: float = 0.0,
    rho: float = 0.0,
    scale: float = 0.0,
    propeller: float = 0.0,
    rudder: float = 0.0,
    gm: float = 0.0,
    antenna: float | None = None,
    name: str = "",
    columns: "Sequence[str]" = (),
) -> "DraftTrial":
    """Draft a trial file from logs: channels, units, frames and signs by name and behaviour, each with its evidence.

    Args:
        logs: files of any format, or folders; files of one kind are runs, of several kinds sources of one run.
        folder: where the trial file will lie; the paths in it count from there.
        length: of the craft between perpendiculars [m]; 0: it is not stated, and the file asks for it.
        beam: breadth at the waterline [m]; 0: a rule by the length stands in for it, as for the next two.
        draught: m. mass: kg.
        gear: turns of the engine over those of the propeller; 0: the rate of an engine is no input.
        rho: density of the water [kg/m^3]; 0: that of sea water.
        scale: 40 for a model 1:40; 0: not stated.
        propeller: diameter [m]. rudder: area [m^2]; 0: a rule stands in for them.
        gm: metacentric height [m], of roll decays; 0: not stated.
        antenna: place of the GNSS antenna, m forward of midship, negative abaft; None: not stated.
        name: of the craft, as it stands in the report; empty: not stated.
        columns: what columns are whose names say nothing: ``Klokke=time``, ``Kurs (gyro)=psi``.

    Returns:
        The text of the file; what is unsure stands in it as a commented line with both readings.

    Raises:
        InputError: no logs, or one that cannot be read; a size below zero, or sizes that no hull has; a
            stated column that no log has.
    """
    from seatrial.data.draft import StatedSize, draft_trial, stated_columns

    size = StatedSize(length, beam, draught, mass, gear, rho, scale, propeller, rudder, gm, antenna, name)
    return draft_trial(*logs, folder=folder, size=size, stated=stated_columns(columns))


def survey_logs(path: "str | Path") -> "SurveyedLogs":
    """Read one log, or those of a folder, and list what is in each; files of the folder that are no logs are named.

    Raises:
        InputError: the file cannot be read, or the folder holds no log.
    """
    from seatrial.data.draft import survey_logs

    return survey_logs([Path(path)])


def survey_log(path: "str | Path") -> "LogSurvey":
    """Read one log of any format and list its topics and columns with rates, ranges and the share missing.

    Raises:
        InputError: the file cannot be read.
    """
    from seatrial.data.draft import survey_log

    return survey_log(Path(path))


def identify(
    trial: "Trial | str | Path",
    seed: int = 0,
    report_progress: "ProgressReporter | None" = None,
    *,
    intervals: str = "auto",
    choose: bool = False,
    compare: bool = False,
    method: str | None = None,
    windows: str = "",
    horizons: str = "",
) -> "Fit":
    """Estimate the trial's model from its training runs and predict its validation runs, with intervals.

    Args:
        seed: of everything drawn at random; the same seed gives the same bits.
        report_progress: called with one line of text at each step.
        intervals: ``auto``, ``jackknife`` (every run left out and refitted, and the spread of tied models),
            ``bootstrap``, ``profile`` or ``sampling`` (draws from the posterior, with emcee).
        choose: compare the family of models and take the one that predicts left-out runs best.
        compare: compare the fit with other estimators (regressions) on the same records.
        method: takes the place of the trial's ``[estimate] method``: ``auto``, ``output-error``, ...; or a published
            one such as ``iwho`` or ``svr``, which is compared with the package's own estimate.
        windows: lengths of windows in which validation runs are predicted as well, in seconds or ship lengths:
            ``10s,5L``; empty: those of the trial, else chosen by the length of each run.
        horizons: how far ahead the fit's Kalman filter predicts from every moment, in samples or seconds:
            ``1,10,5s``; empty: chosen by the length of the runs.

    Raises:
        InputError: the records do not pass the checks, show no excitation, or cannot distinguish the parameters; an
            unknown method, or one that cannot serve this model.
    """
    from seatrial.core.values import InputError, spelling_hint
    from seatrial.physics.models.registry import precompile

    trial = _loaded(trial)
    with precompile(trial.model.name):
        from seatrial.estimation.identify import IntervalMethod, identify

    if intervals not in (kinds := [kind.value for kind in IntervalMethod]):
        raise InputError(f"unknown kind of intervals '{intervals}'{spelling_hint(intervals, kinds)}")
    return identify(
        trial if method is None else replace(trial, estimate=trial.estimate.with_method(method)),
        seed=seed,
        report_progress=report_progress,
        intervals=IntervalMethod(intervals),
        choose=choose,
        compare=compare,
        windows=windows,
        horizons=horizons,
    )


def follow(
    trial: "Trial | str | Path",
    *,
    source: "SampleSource | None" = None,
    once: bool = False,
    journal: str | Path | None = None,
    show: "Callable[[Snapshot, SampleCounts], None] | None" = None,
    stop: Callable[[], bool] | None = None,
    seed: int = 0,
    report_progress: "ProgressReporter | None" = None,
    method: str | None = None,
    proposal_file: str | Path | None = None,
) -> "FollowResult":
    """Estimate while the record is being made, from the samples that the trial's table ``[follow]`` names.

    Args:
        source: takes the place of the source that the trial file names.
        once: end with the input; the result then holds the fit that `identify` makes of the accepted samples.
        journal: file in which admitted samples are kept; an existing one is read first and continued.
        show: called with the present estimate and the sample counts, twice a second at most.
        stop: called several times a second; following ends when it returns True.
        seed: of the fit of `once`, and of a search.
        report_progress: called with one line of text at each step.
        method: takes the place of the trial's ``[estimate] method``; a search such as ``iwho`` judges by one sample
            after the other and is compared with the package's own follower.
        proposal_file: where gains are proposed in, as TOML, for a trial with a table ``[proposal]``; each proposal
            takes the place of the one before.

    Raises:
        InputError: the trial has no ``[follow]``, lacks channels, its source cannot be opened, or the journal belongs
            to another trial.
    """
    from seatrial.physics.models.registry import precompile

    trial = _loaded(trial)
    with precompile(trial.model.name):
        from seatrial.onboard.follow import follow
    followed = trial if method is None else replace(trial, estimate=trial.estimate.with_method(method))
    return follow(
        followed, source=source, once=once, journal=None if journal is None else Path(journal), show=show, stop=stop,
        seed=seed, report_progress=report_progress,
        proposal_file=None if proposal_file is None else Path(proposal_file),
    )  # fmt: skip


def design(
    trial: "Trial | str | Path",
    seed: int = 0,
    report_progress: "ProgressReporter | None" = None,
    prior_model: "ModelFile | None" = None,
) -> "Design":
    """Design the manoeuvre that identifies the trial's coefficients best within its limits.

    Args:
        seed: of the search, of the ships drawn from the prior, and of the noise that confirms the design.
        report_progress: called with one line of text at each step.
        prior_model: a model file of `identify`; its values and their covariance take the place of the trial's.

    Raises:
        InputError: the trial has no ``[design]``, its sensors or inputs do not fit the model, the model file holds
            another model, or no manoeuvre stays within the limits.
    """
    from seatrial.physics.models.registry import precompile

    trial = _loaded(trial)
    with precompile(trial.model.name):
        from seatrial.estimation.design.design import design
        from seatrial.estimation.design.task import design_task

        task = design_task(trial, prior_model)
    return design(task, seed=seed, report_progress=report_progress or (lambda _: None))


def _loaded(trial: "Trial | str | Path") -> "Trial":
    """Return a trial, read where its file is named."""
    from seatrial.data.trial import Trial, load_trial

    return trial if isinstance(trial, Trial) else load_trial(trial)


def prepared_run(trial: "Trial | str | Path", name: str) -> "Record":
    """Return one run of a trial as `identify` uses it: canonical, trimmed, resampled.

    Raises:
        InputError: the trial has no run of that name (the nearest is named), or it cannot be read.
    """
    from seatrial.core.values import InputError, spelling_hint
    from seatrial.data.trial.records import load_run

    trial = _loaded(trial)
    runs = {run.name: run for run in trial.runs}
    if name not in runs:
        raise InputError(f"the trial has no run '{name}'{spelling_hint(name, list(runs))}")
    record = load_run(runs[name], trial.reference_point).record
    return record if trial.estimate.rate is None else record.resampled(trial.estimate.rate)
