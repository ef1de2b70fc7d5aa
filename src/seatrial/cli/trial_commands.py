"""Commands on a trial: check, identify, follow, design."""

from pathlib import Path
from typing import Annotated

import typer

from seatrial.cli.application import Json, OwnModelPath, Seed, TrialPath, app, own_model, result_document, write_json
from seatrial.cli.finding_output import exit_if_errors, print_findings, write_correction
from seatrial.cli.next_steps import after_check, after_design, after_fit
from seatrial.cli.progress import progress_reporter
from seatrial.cli.result_output import print_design, print_fit
from seatrial.cli.screen import print_file, print_next

Method = Annotated[
    str | None,
    typer.Option(
        "--method",
        metavar="METHOD",
        help="auto, output-error, ..., or a published one: iwho, icpso, pso, svr, ...",
    ),
]
FINDINGS_PER_CODE = 2  # findings of one kind that `check` prints without --all; ours, one screen for a bad file


@app.command()
def check(
    trial: Annotated[Path, typer.Argument(metavar="TRIAL.toml|LOG", help="Trial file, or a log or a folder of logs.")],
    show_all: Annotated[
        bool, typer.Option("--all", help="Show every finding (column), not the first few of each kind.")
    ] = False,
    fix: Annotated[
        bool, typer.Option("--fix", help="Write TRIAL.fixed.toml with the edits that remove errors.")
    ] = False,
    model: OwnModelPath = None,
    json: Json = None,
    seed: Seed = 0,  # noqa: ARG001
) -> None:
    """Check the records: frames, signs, units, gaps, jumps, lags. Of a bare log: list what is in it.

    Neither a model nor particulars are needed.

    Example: seatrial check examples/esso_osaka.toml

    What it is certain of, corrected in a copy of the trial file: --fix
    """
    from seatrial import api
    from seatrial.core.values import InputError
    from seatrial.data.folder.document import findings_document

    if trial.suffix.lower() != ".toml":
        from seatrial.cli.log_commands import print_surveys

        if fix:
            raise InputError("--fix corrects a trial file; draft one from the log with 'seatrial init'")
        print_surveys(trial, api.survey_logs(trial), show_all=show_all)
        return
    findings = api.check(trial if model is None else api.load_trial(trial, own_model(model)))
    if fix:
        write_correction(api.correct_trial(trial), trial, findings, FINDINGS_PER_CODE)
        return
    print_findings(findings, len(findings) if show_all else FINDINGS_PER_CODE)
    print_next(after_check(findings, trial))
    write_json(json, lambda: findings_document(findings))
    exit_if_errors(findings)


@app.command()
def identify(
    trial: TrialPath,
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Result folder: model, result, report.")],
    intervals: Annotated[
        str, typer.Option("--intervals", metavar="KIND", help="auto, jackknife, bootstrap, profile or sampling.")
    ] = "auto",
    choose: Annotated[bool, typer.Option("--choose", help="Take the model that predicts left-out runs best.")] = False,
    compare: Annotated[
        bool, typer.Option("--compare", help="Compare with other estimators on the same records.")
    ] = False,
    windows: Annotated[
        str, typer.Option("--windows", metavar="LENGTHS", help="Score held-out runs in windows of: 10s,5L.")
    ] = "",
    horizons: Annotated[
        str, typer.Option("--horizons", metavar="STEPS", help="Score predictions so far ahead: 1,10,5s.")
    ] = "",
    method: Method = None,
    model: OwnModelPath = None,
    json: Json = None,
    seed: Seed = 0,
) -> None:
    """Estimate the ship's model from the training runs and predict the validation runs, with intervals.

    Example: seatrial identify examples/kvlcc2_hsva.toml --out results/kvlcc2

    Every run left out and refitted, and the spread of tied models: --intervals jackknife

    A published method compared with the package's own estimate: --method iwho, --method svr
    """
    from seatrial import api
    from seatrial.core.values.files import writable_folder

    writable_folder(out)
    with progress_reporter() as report_progress:
        fit = api.identify(
            api.load_trial(trial, own_model(model)),
            seed=seed,
            report_progress=report_progress,
            intervals=intervals,
            choose=choose,
            compare=compare,
            method=method,
            windows=windows,
            horizons=horizons,
        )
        report_progress("report")
        page = api.save(fit, out)
    print_fit(fit)
    write_json(json, lambda: result_document(fit))
    print_file("report", page)
    print_next(after_fit(fit, out, trial))


@app.command()
def follow(
    trial: TrialPath,
    once: Annotated[bool, typer.Option("--once", help="End with the input, with the fit of identify.")] = False,
    out: Annotated[Path | None, typer.Option("--out", metavar="DIR", help="Where journal and result go.")] = None,
    page: Annotated[
        int | None,
        typer.Option("--page", metavar="PORT", help="Show it in the workspace at this port of this machine; 0: any."),
    ] = None,
    journal: Annotated[
        Path | None,
        typer.Option("--journal", metavar="FILE", help="Keep samples there; an existing one is read first."),
    ] = None,
    source: Annotated[
        str | None,
        typer.Option(
            "--source",
            metavar="KIND",
            help="file, stdin, udp, nmea-file, nmea2000-udp, mavlink-udp, ...",
        ),
    ] = None,
    reports: Annotated[
        bool, typer.Option("--reports", hidden=True, help="Print reports for a workspace, a line of JSON each.")
    ] = False,
    method: Method = None,
    model: OwnModelPath = None,
    json: Json = None,
    seed: Seed = 0,
) -> None:
    """Identify while the record is still being made: a growing file, standard input, NMEA 0183 or UDP.

    Example: seatrial follow examples/heave_pitch_follow.toml --once --json fit.json

    A published search, sample by sample, compared with the package's own follower: --method iwho --once

    On board, in the workspace in the browser and with a journal: --page 8000 --out results/today
    """
    from seatrial import api
    from seatrial.cli.follow_output import journal_path, live_display, print_outcome, reports_as_lines, stop_on_signal
    from seatrial.core.values.files import writable_folder
    from seatrial.data.trial.runs import require_stream, with_source

    if out is not None:
        writable_folder(out)
    stream = api.load_trial(trial, own_model(model))
    stream = stream if source is None else with_source(stream, source)
    port = page if page is not None else require_stream(stream).page or None
    with (
        stop_on_signal() as stop,
        reports_as_lines(stream) if reports else live_display(stream, port) as show,
        progress_reporter(has_live_table=True) as report_progress,
    ):
        outcome = api.follow(
            stream,
            once=once,
            journal=journal_path(journal, stream, out, once=once),
            show=show,
            stop=stop,
            seed=seed,
            report_progress=report_progress,
            method=method,
            proposal_file=None if out is None else out / "proposal.toml",
        )
    print_outcome(outcome)
    if outcome.fit is not None:
        print_fit(outcome.fit)
    write_json(json, lambda: result_document(outcome.result))
    if out is not None:
        print_file("result", api.save(outcome, out))


@app.command()
def design(
    trial: TrialPath,
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Where report, orders, plan and design.json go.")],
    model_path: Annotated[
        Path | None, typer.Option("--from", metavar="MODEL.toml", help="Design for the model of an earlier fit.")
    ] = None,
    model: OwnModelPath = None,
    json: Json = None,
    seed: Seed = 0,
) -> None:
    """Design the manoeuvre that identifies the coefficients best within the limits of the table 'design'.

    Example: seatrial design examples/waterjet_design.toml --out results/plan

    After a first trial: --from results/waterjet/model.toml designs for its coefficients.
    """
    from seatrial import api
    from seatrial.core.values.files import writable_folder

    writable_folder(out)
    equations = own_model(model)
    request = api.load_trial(trial, equations)
    prior = None if model_path is None else api.load_model(model_path, equations)
    with progress_reporter() as report_progress:
        result = api.design(request, seed=seed, report_progress=report_progress, prior_model=prior)
        report_progress("report")
        page = api.save(result, out)
    print_design(result)
    write_json(json, lambda: result_document(result))
    print_file("orders", out / "orders.csv")
    print_file("report", page)
    print_next(after_design(result))
