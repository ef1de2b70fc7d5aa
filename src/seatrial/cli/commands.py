"""The commands: parse, call the function of the same name, print. Everything heavy is imported inside them."""

import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from seatrial.cli.follow_output import (
    journal_path,
    live_display,
    print_outcome,
    stop_on_signal,
    stream_heading,
)
from seatrial.cli.output import (
    print_design,
    print_findings,
    print_fit,
    print_measures,
    print_study,
    progress_reporter,
    write_json,
)
from seatrial.cli.tuning_output import print_tuning

if TYPE_CHECKING:
    from seatrial.core.equations import Model

app = typer.Typer(
    name="seatrial",
    help="Sea-trial records into ship motion models you can defend.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)


def _writable_json_path(path: Path | None) -> Path | None:
    """The place of the JSON file, tested before the work rather than after it."""
    if path is not None:
        from seatrial.core.values import InputError
        from seatrial.core.values.files import writable_folder

        if path.is_dir():
            raise InputError(f"--json {path} is a folder; name a file")
        writable_folder(path.parent)
    return path


Json = Annotated[
    Path | None, typer.Option("--json", metavar="FILE", callback=_writable_json_path, help="Write the result as JSON.")
]
Seed = Annotated[
    int, typer.Option("--seed", min=0, help="Of everything drawn at random; the same seed gives the same bits.")
]
TrialPath = Annotated[Path, typer.Argument(metavar="TRIAL.toml", help="Trial file.")]
OwnModelPath = Annotated[
    Path | None, typer.Option("--model", metavar="FILE.py", help="A model of your own (is executed).")
]

FINDINGS_PER_CODE = 2


def _version(requested: bool) -> None:
    if requested:
        from seatrial import __version__

        print(f"seatrial {__version__}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[bool, typer.Option("--version", callback=_version, is_eager=True, help="Show it.")] = False,
) -> None:
    pass


@app.command()
def check(
    trial: TrialPath,
    show_all: Annotated[bool, typer.Option("--all", help="Every finding, not the first few of each kind.")] = False,
    model: OwnModelPath = None,
    json: Json = None,
    seed: Seed = 0,  # noqa: ARG001
) -> None:
    """Say what is odd about the records: frames, signs, units, gaps, jumps, lags.

    Example: seatrial check examples/esso_osaka.toml
    """
    from seatrial import api
    from seatrial.data.folder.document import findings_document

    findings = api.check(api.load_trial(trial, _own_model(model)))
    print_findings(findings, len(findings) if show_all else FINDINGS_PER_CODE)
    write_json(json, lambda: findings_document(findings))


@app.command()
def identify(
    trial: TrialPath,
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Result folder: model, result, report.")],
    intervals: Annotated[
        str, typer.Option("--intervals", metavar="KIND", help="auto, jackknife, bootstrap or profile.")
    ] = "auto",
    choose: Annotated[bool, typer.Option("--choose", help="Take the family's best model on runs left out.")] = False,
    compare: Annotated[
        bool, typer.Option("--compare", help="Other estimators on the same records, beside it.")
    ] = False,
    model: OwnModelPath = None,
    json: Json = None,
    seed: Seed = 0,
) -> None:
    """Estimate the ship's model from the training runs and predict the validation runs, with intervals.

    Example: seatrial identify examples/kvlcc2_hsva.toml --out results/kvlcc2

    Every run left out and refitted, and the spread of tied models: --intervals jackknife
    """
    from seatrial import api
    from seatrial.core.values.files import writable_folder

    writable_folder(out)
    with progress_reporter() as tell:
        fit = api.identify(
            api.load_trial(trial, _own_model(model)),
            seed=seed,
            report_progress=tell,
            intervals=intervals,
            choose=choose,
            compare=compare,
        )
        tell("report")
        page = api.save(fit, out)
    print_fit(fit)
    write_json(json, lambda: _document(fit))
    print(f"report: {page}")


@app.command()
def follow(
    trial: TrialPath,
    once: Annotated[bool, typer.Option("--once", help="End at the end of the input, with what identify says.")] = False,
    out: Annotated[Path | None, typer.Option("--out", metavar="DIR", help="Where journal and result go.")] = None,
    page: Annotated[
        int | None, typer.Option("--page", metavar="PORT", help="Port of the page on this machine; 0: any.")
    ] = None,
    journal: Annotated[
        Path | None, typer.Option("--journal", metavar="FILE", help="Samples are kept there, and read back first.")
    ] = None,
    source: Annotated[
        str | None, typer.Option("--source", metavar="KIND", help="file, stdin, udp, or nmea- before them.")
    ] = None,
    model: OwnModelPath = None,
    json: Json = None,
    seed: Seed = 0,
) -> None:
    """Identify while the record is still being made: a growing file, standard input, NMEA 0183 or UDP.

    Example: seatrial follow examples/heave_pitch_follow.toml --once --json fit.json

    On board, with a page of moving plots and a journal: --page 8000 --out results/today
    """
    from seatrial import api
    from seatrial.core.values.files import writable_folder
    from seatrial.data.trial.follow_table import require_stream, with_source

    if out is not None:
        writable_folder(out)
    asked = api.load_trial(trial, _own_model(model))
    asked = asked if source is None else with_source(asked, source)
    port = page if page is not None else require_stream(asked).page_port or None
    with stop_on_signal() as stop, live_display(stream_heading(asked), port) as show, progress_reporter() as tell:
        outcome = api.follow(
            asked,
            once=once,
            journal=journal_path(journal, asked, out, once=once),
            show=show,
            stop=stop,
            seed=seed,
            report_progress=tell,
        )
    print_outcome(outcome)
    if outcome.fit is not None:
        print_fit(outcome.fit)
    write_json(json, lambda: _document(outcome.result))
    if out is not None:
        print(f"result: {api.save(outcome, out)}")


@app.command()
def design(
    trial: TrialPath,
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Where report, orders, plan and design.json go.")],
    model_path: Annotated[
        Path | None, typer.Option("--from", metavar="MODEL.toml", help="Design for what identify found before.")
    ] = None,
    model: OwnModelPath = None,
    json: Json = None,
    seed: Seed = 0,
) -> None:
    """Find the manoeuvre that tells the coefficients best within the limits of the trial file's table 'design'.

    Example: seatrial design examples/waterjet_design.toml --out results/plan

    After a first trial: --from results/waterjet/model.toml designs for the coefficients it gave.
    """
    from seatrial import api
    from seatrial.core.values.files import writable_folder

    writable_folder(out)
    own = _own_model(model)
    asked = api.load_trial(trial, own)
    known = None if model_path is None else api.load_model(model_path, own)
    with progress_reporter() as tell:
        found = api.design(asked, seed=seed, report_progress=tell, prior_model=known)
        tell("report")
        page = api.save(found, out)
    print_design(found)
    write_json(json, lambda: _document(found))
    print(f"orders: {out / 'orders.csv'}")
    print(f"report: {page}")


@app.command()
def tune(
    loop: Annotated[Path, typer.Argument(metavar="LOOP.toml", help="Loop file.")],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Where report, gains, loop and tuning.json go.")
    ] = None,
    model_path: Annotated[
        Path | None, typer.Option("--from", metavar="MODEL.toml", help="The ship: takes the place of plant.model.")
    ] = None,
    model: OwnModelPath = None,
    json: Json = None,
    seed: Seed = 0,
) -> None:
    """Tune a fin stabiliser, an autopilot or a speed control: gains with their margins, front, schedule, simulation.

    Example: seatrial tune examples/fin_stabiliser.toml --out results/fins

    On a ship just identified: --from results/waterjet/model.toml
    """
    from seatrial import api
    from seatrial.core.values.files import writable_folder

    if out is not None:
        writable_folder(out)
    with progress_reporter() as tell:
        found = api.tune(api.load_loop(loop, _own_model(model), model_path), seed=seed, report_progress=tell)
        if out is not None:
            tell("report")
            api.save(found, out)
    print_tuning(found)
    write_json(json, lambda: _document(found))
    if out is not None:
        print(f"gains: {out / 'gains.toml'}")
        print(f"report: {out / 'report.html'}")


@app.command()
def simulate(
    model_file: Annotated[Path, typer.Argument(metavar="MODEL.toml", help="Model file, as identify writes it.")],
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="Simulated record (CSV).")],
    manoeuvre: Annotated[
        str | None,
        typer.Option(
            "--manoeuvre", help="zigzag:20/20, zigzag:20/10, turning-circle:35, spiral, pull-out or prbs; add :port."
        ),
    ] = None,
    inputs: Annotated[str | None, typer.Option("--inputs", metavar="RECORD", help="Replay a record's inputs.")] = None,
    trial: Annotated[
        Path | None, typer.Option("--trial", metavar="TRIAL.toml", help="RECORD is the name of one of its runs.")
    ] = None,
    speed: Annotated[float | None, typer.Option(help="Approach speed, m/s; default: where surge balances.")] = None,
    duration: Annotated[float | None, typer.Option(help="s at most.")] = None,
    constant_inputs: Annotated[
        list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="A constant input in SI units.")
    ] = None,
    rudder_rate: Annotated[float | None, typer.Option(help="deg/s; default: SOLAS's at the ship's scale.")] = None,
    model: OwnModelPath = None,
    json: Json = None,
    seed: Seed = 0,
) -> None:
    """Steer a manoeuvre with a model, or replay measured inputs, and print its measures.

    Example: seatrial simulate results/kvlcc2/model.toml --manoeuvre turning-circle:35 --out turn.csv

    Measured inputs: --inputs table.csv, or --trial examples/kvlcc2_hsva.toml --inputs HSVA_CPMC_KVLCC2_Z_35_05
    """
    from seatrial import api
    from seatrial.core.values import InputError
    from seatrial.core.values.files import writable_folder
    from seatrial.data.read import read_record_csv, write_record_csv

    if (manoeuvre is None) == (inputs is None):
        raise InputError("give either --manoeuvre or --inputs")
    file = api.load_model(model_file, _own_model(model))
    writable_folder(out.parent)
    measured, intervals = None, {}
    if inputs is not None:
        measured = read_record_csv(Path(inputs)) if trial is None else api.prepared_run(trial, inputs)
        record = api.replay(file, measured, speed)
    else:
        held = dict(_name_and_value(text) for text in constant_inputs or [])
        steer = api.steering(
            file,
            manoeuvre or "",
            speed=speed,
            inputs=held,
            duration=duration,
            rudder_rate=None if rudder_rate is None else math.radians(rudder_rate),
            seed=seed,
        )
        record = steer(file.model)
        try:
            intervals = api.measure_intervals(file, steer)
        except InputError as error:
            print(f"seatrial: {error}", file=sys.stderr)
    write_record_csv(record, out)
    like = measured if measured is not None and "psi" in measured else None
    measures = api.measures(file, record, like) if "psi" in record else {}
    reach = api.extrapolation(file, record)
    print_measures(measures, intervals, reach)
    rms = {} if measured is None else api.rms_differences(measured, record)
    if measured is not None and rms:
        print(f"against {measured.name}: rms {', '.join(f'{name} {value:.3g}' for name, value in rms.items())}")
    write_json(
        json,
        lambda: {
            "record": str(out),
            "measures": measures,
            "intervals": {name: list(pair) for name, pair in intervals.items()},
            "extrapolation_index": None if reach is None else reach.index,
            "rms": rms,
            "seed": seed,
        },
    )
    print(f"record: {out}")


@app.command()
def report(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Result folder.")],
    model: OwnModelPath = None,
    json: Json = None,
    seed: Seed = 0,  # noqa: ARG001
) -> None:
    """Render the report of a result folder again, without computing.

    Example: seatrial report results/kvlcc2
    """
    from seatrial import api

    result = api.load(folder, _own_model(model))
    page = api.report(result, folder / "report.html")
    write_json(json, lambda: _document(result))
    print(f"report: {page}")


@app.command()
def demo(
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Where trials, result and report go.")],
    json: Json = None,
    seed: Seed = 0,
) -> None:
    """The main job on simulated trials of a ship whose coefficients are known.

    Example: seatrial demo --out demo
    """
    from seatrial import api
    from seatrial.core.values.files import writable_folder

    writable_folder(out)
    with progress_reporter() as tell:
        fit = api.demo(out, seed=seed, report_progress=tell)
    print_fit(fit)
    write_json(json, lambda: _document(fit))
    print(f"report: {out / 'report.html'}")


@app.command()
def models(
    json: Json = None,
    seed: Seed = 0,  # noqa: ARG001
) -> None:
    """List the built-in and the installed models: name, states, inputs, source.

    Example: seatrial models
    """
    from dataclasses import asdict

    from seatrial import api
    from seatrial.cli.model_table import print_models

    summaries = api.list_models()
    print_models(summaries)
    write_json(json, lambda: {"models": [asdict(summary) for summary in summaries]})


@app.command()
def reproduce(
    study: Annotated[str, typer.Argument(metavar="STUDY", help="E.g. alexandersson2022.")],
    quick: Annotated[bool, typer.Option("--quick", help="Fewer cases, under half a minute.")] = False,
    out: Annotated[Path | None, typer.Option("--out", metavar="DIR", help="Where report and study.json go.")] = None,
    json: Json = None,
    seed: Seed = 0,
) -> None:
    """Repeat a published study: its claims beside our numbers.

    Example: seatrial reproduce alexandersson2022 --quick --out results/alexandersson2022
    """
    from seatrial import api
    from seatrial.core.values.files import writable_folder

    if out is not None:
        writable_folder(out)
    with progress_reporter() as tell:
        made = api.reproduce(study, quick=quick, seed=seed, report_progress=tell)
        page = None if out is None else api.save(made, out)
    print_study(made)
    write_json(json, lambda: _document(made))
    if page is not None:
        print(f"report: {page}")


def _own_model(path: Path | None) -> "Model | None":
    if path is None:
        return None
    from seatrial.physics.models import model_from_file

    return model_from_file(path)


def _name_and_value(text: str) -> tuple[str, float]:
    from seatrial.core.values import InputError

    name, equals, value = text.partition("=")
    try:
        if not equals:
            raise ValueError
        return name.strip(), float(value)
    except ValueError:
        raise InputError(f"--set {text}: write NAME=VALUE with a number in SI units, e.g. --set n=10.2") from None


def _document(result: object) -> dict[str, Any]:
    from seatrial.data.folder.document import document

    return document(result)
