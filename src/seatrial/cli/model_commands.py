"""The commands on models: list, simulate, export."""

import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from seatrial.cli.application import Json, OwnModelPath, Seed, app, own_model, result_document, write_json
from seatrial.cli.finding_output import print_finding
from seatrial.cli.progress import progress_reporter
from seatrial.cli.result_output import errors_text, print_measures, print_tuning, print_verification
from seatrial.cli.screen import print_file, print_heading, print_lines, print_next, print_table, print_verbatim

if TYPE_CHECKING:
    from seatrial.control.task import TuningTask
    from seatrial.core.values import Record
    from seatrial.data.folder.model_file import ModelFile
    from seatrial.data.trial.model_table import FilledValue, ModelGuide
    from seatrial.physics.models import ModelSummary


# The list of models on the screen.


def print_models(summaries: "Sequence[ModelSummary]") -> None:
    """Print name, states, inputs and source of each model; why an installed one cannot be loaded."""
    rows = []
    for model in summaries:
        signature = f"states {', '.join(model.states)}; inputs {', '.join(model.inputs)}"
        rows.append([model.name, model.problem or signature])
        rows += [["", text] for text in (model.source, model.package and f"installed by {model.package}") if text]
    print_table(rows, flush_left=(0, 1))
    print_next("seatrial models NAME says what a model needs, with a trial file to begin with")


def print_model_guide(guide: "ModelGuide") -> None:
    """Print what a model needs, what is filled from where, and the tables of a trial file to begin with."""
    from seatrial.core.text.words import enumeration

    print_lines([f"{guide.name}: {guide.source}"])
    needed = [name for name in guide.inputs if name not in guide.optional_inputs]
    needs = f"{enumeration(needed)}, and " if needed else ""
    print_lines([f"records need {needs}one or more of {', '.join(guide.observables)}"])
    if guide.optional_inputs:
        print_lines([f"where recorded: {enumeration(list(guide.optional_inputs))}"])
    print_lines([f"estimated unless you say otherwise: {', '.join(guide.free)}"])
    by_source: dict[str, list[FilledValue]] = {}
    for value in guide.filled:
        by_source.setdefault(value.source, []).append(value)
    print_lines(["filled, where you do not state it:"])
    for source, values in by_source.items():
        print_lines([f"  {', '.join(_with_deviation(value) for value in values)}: {source}"])
    print_heading("A trial file begins so ('seatrial init LOG... --out trial.toml' writes the records)")
    print_verbatim(["", *guide.trial.splitlines()])


def _with_deviation(value: "FilledValue") -> str:
    return f"{value.name} (prior sd {value.deviation:g})" if value.deviation else value.name


# Commands on a model: tune, simulate, models.

INTERVALS_OF_COEFFICIENTS = (
    "intervals hold what the coefficients may be wrong by, in still water and if the model's terms are the right ones; "
    "a single trial scatters more, by wind and waves"
)


@app.command()
def tune(
    loop: Annotated[Path, typer.Argument(metavar="LOOP.toml", help="Loop file.")],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Where report, gains, loop and tuning.json go.")
    ] = None,
    model_path: Annotated[
        Path | None, typer.Option("--from", metavar="MODEL.toml", help="Ship model in place of plant.model.")
    ] = None,
    method: Annotated[
        str, typer.Option("--method", metavar="METHOD", help="front, or genetic (Yu et al. 2014), compared with it.")
    ] = "front",
    verify: Annotated[
        list[Path] | None,
        typer.Option("--verify", metavar="LOG", help="Log of a trial with the controller: trial file or record."),
    ] = None,
    gains: Annotated[
        Path | None, typer.Option("--gains", metavar="GAINS.toml", help="With --verify: the gains that were on.")
    ] = None,
    model: OwnModelPath = None,
    json: Json = None,
    seed: Seed = 0,
) -> None:
    """Tune fins, an autopilot, a speed or station control: gains with their margins, front, schedule, simulation.

    Example: seatrial tune examples/fin_stabiliser.toml --out results/fins

    On an identified ship: --from results/waterjet/model.toml

    After its trial, predicted against achieved: --verify log.toml --gains results/fins/gains.toml
    """
    from seatrial import api
    from seatrial.core.values import InputError
    from seatrial.core.values.files import writable_folder

    if (gains is None) != (not verify):
        raise InputError("--verify LOG and --gains GAINS.toml go together; give both, or neither to tune")
    if out is not None:
        writable_folder(out)
    if gains is not None and verify:
        _verify(api.load_loop(loop, own_model(model), model_path), gains, verify, out, json)
        return
    with progress_reporter() as report_progress:
        task = api.load_loop(loop, own_model(model), model_path)
        result = api.tune(task, seed=seed, report_progress=report_progress, method=method)
        if out is not None:
            report_progress("report")
            api.save(result, out)
    print_tuning(result)
    write_json(json, lambda: result_document(result))
    if out is not None:
        print_file("gains", out / "gains.toml")
        print_file("report", out / "report.html")


def _verify(task: "TuningTask", gains: Path, logs: list[Path], out: Path | None, json: Path | None) -> None:
    """Verify gains by logs, print the result and write it where that is wanted."""
    from seatrial import api

    with progress_reporter() as report_progress:
        report_progress("ship and seas that the legs show")
        result = api.verify(task, gains, logs)
        page = None if out is None else api.save(result, out)
    print_verification(result)
    write_json(json, lambda: result_document(result))
    if page is not None:
        print_file("report", page)


@app.command()
def simulate(
    model_file: Annotated[
        Path, typer.Argument(metavar="MODEL.toml|FMU", help="Model file, as identify writes it, or an exported FMU.")
    ],
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="Simulated record (CSV).")],
    manoeuvre: Annotated[
        str | None,
        typer.Option(
            "--manoeuvre",
            help="zigzag:20/20, turning-circle:35, spiral, pull-out or prbs; by thrust straight:50, spin:50, stop:50 "
            "(per cent), of fixed thrusters zigzag:30/20 (per cent); of a roll model release:15; add :port.",
        ),
    ] = None,
    inputs: Annotated[
        str | None, typer.Option("--inputs", metavar="RECORD", help="Simulate the inputs of a record.")
    ] = None,
    trial: Annotated[
        Path | None, typer.Option("--trial", metavar="TRIAL.toml", help="RECORD is the name of one of its runs.")
    ] = None,
    speed: Annotated[float | None, typer.Option(help="Approach speed, m/s; default: where surge balances.")] = None,
    duration: Annotated[float | None, typer.Option(help="s at most.")] = None,
    constant_inputs: Annotated[
        list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="A constant input in SI units.")
    ] = None,
    rudder_rate: Annotated[
        float | None,
        typer.Option(
            help="deg/s; default: SOLAS's at the ship's scale, or the fastest of the training runs where that is at "
            "least 1.2 times as fast."
        ),
    ] = None,
    session: Annotated[
        str | None,
        typer.Option(help="Fitted session whose offsets the record has, or new; default: the run's, or the only one."),
    ] = None,
    waves: Annotated[
        bool, typer.Option("--waves", help="Add the waves that the sensors of the training runs showed.")
    ] = False,
    model: OwnModelPath = None,
    json: Json = None,
    seed: Seed = 0,
) -> None:
    """Simulate a manoeuvre or the inputs of a record with a model, and print its measures.

    Example: seatrial simulate results/kvlcc2/model.toml --manoeuvre turning-circle:35 --out turn.csv

    Measured inputs: --inputs table.csv, or --trial examples/kvlcc2_hsva.toml --inputs HSVA_CPMC_KVLCC2_Z_35_05

    An exported FMU, as a check: seatrial simulate ship.fmu --inputs turn.csv --out back.csv
    """
    from seatrial import api
    from seatrial.core.results import fitted_session
    from seatrial.core.values import InputError
    from seatrial.core.values.files import writable_folder
    from seatrial.data.read import write_record_csv

    if (manoeuvre is None) == (inputs is None):
        raise InputError("give either --manoeuvre or --inputs")
    writable_folder(out.parent)
    if model_file.suffix == ".fmu":
        if waves:
            raise InputError("an FMU holds no waves; leave out --waves")
        if inputs is None:
            raise InputError("an FMU is run with the inputs of a record: give --inputs, such as a simulated manoeuvre")
        measured, _ = _measured_run(inputs, trial)
        record = api.replay_fmu(model_file, measured)
        write_record_csv(record, out)
        rms = api.rms_differences(measured, record)
        _print_rms(measured.name, rms)
        write_json(json, lambda: {"record": str(out), "rms": rms, "seed": seed})
        print_file("record", out)
        return
    file = api.load_model(model_file, own_model(model))
    measured, rate, intervals = None, None, dict[str, tuple[float, float] | None]()
    constant = dict(_name_and_value(text) for text in constant_inputs or [])
    if inputs is not None:
        measured, own = _measured_run(inputs, trial)
        session = session or (own and fitted_session(file.offsets, own))
        record = api.simulate(file, measured, speed=speed, session=session)
    else:
        given_rate = None if rudder_rate is None else math.radians(rudder_rate)
        steer = api.steering(
            file,
            manoeuvre or "",
            speed=speed,
            inputs=constant,
            duration=duration,
            rudder_rate=given_rate,
            seed=seed,
        )
        record = steer(file.model)
        rate = api.rudder_rate_of(file, given_rate) if "delta" in record else None
        try:
            intervals = api.measure_intervals(file, steer)
        except InputError as error:
            print(f"seatrial: {error}", file=sys.stderr)
    write_record_csv(api.in_waves(file, record, seed) if waves else record, out)
    reference = measured if measured is not None and {"psi", "delta"} <= set(measured.channels) else None
    measures = api.measures(file, record, reference) if manoeuvre or "psi" in record else {}
    leaving = api.extrapolation(file, record)
    print_measures(measures, intervals, leaving, is_manoeuvre=manoeuvre is not None)
    print_lines([INTERVALS_OF_COEFFICIENTS] if any(intervals.values()) else [])
    print_lines(
        ["no measures: the run shows none of a zigzag, turn, spin, stop or decay"] if manoeuvre and not measures else []
    )
    rms = {} if measured is None else api.rms_differences(measured, record)
    if measured is not None and rms:
        print_lines([f"against {measured.name}: rms {errors_text(rms)}"])
    if rate is not None:
        print_lines([rate.text])
    held_rate = api.propeller_rate_text(file, record) if manoeuvre else ""
    print_lines([held_rate] if held_rate else [])
    print_lines(_offset_lines(file, measured, session))
    for text in file.provenance.warnings:
        print_finding("warning", f"of the fit: {text}")
    for finding in api.course_findings(file, manoeuvre or "", constant):
        print_finding("warning", f"[{finding.code}] {finding.text}: a straight run is one that it does not hold")
    write_json(
        json,
        lambda: {
            "record": str(out),
            "rudder_rate": None if rate is None else {"value": rate.value, "origin": rate.origin},
            "measures": measures,
            "intervals": {name: pair and list(pair) for name, pair in intervals.items()},
            "extrapolation_index": None if leaving is None else leaving.index,
            "rms": rms,
            "seed": seed,
        },
    )
    print_file("record", out)


def _measured_run(name: str, trial: Path | None) -> "tuple[Record, str | None]":
    """Return a record that is named on the command line, and the session of a trial's run."""
    from seatrial import api
    from seatrial.data.read import read_record_csv

    if trial is None:
        return read_record_csv(Path(name)), None
    loaded = api.load_trial(trial)
    return api.prepared_run(loaded, name), next(run.session for run in loaded.runs if run.name == name)


def _offset_lines(file: "ModelFile", measured: "Record | None", session: str | None) -> list[str]:
    """Say whether offsets of the fit's sessions were corrected in a record's inputs, or that orders have none."""
    from seatrial.api.simulation import is_measured_motion
    from seatrial.core.results import offsets_text

    if not file.offsets:
        return []
    if measured is not None and is_measured_motion(file, measured):
        return [f"with what the fit found of its session: {offsets_text(file.offsets, session)}"]
    of_inputs = [offset for offset in file.offsets if offset.is_of_input]
    if not of_inputs:
        return []
    text = offsets_text(of_inputs, session)
    is_alone = len(file.offsets[0].by_session) == 1
    rest = "; how those of other sessions differ was not recorded, and is in no interval" if is_alone else ""
    return [f"inputs are true values; in logs the fit found {text}{rest}"]


@app.command()
def models(
    name: Annotated[
        str, typer.Argument(metavar="[NAME]", help="A model: what it needs, and tables to begin with.")
    ] = "",
    json: Json = None,
    seed: Seed = 0,  # noqa: ARG001
) -> None:
    """List the built-in and the installed models; of one, say what it needs and print a starting trial file.

    Example: seatrial models mmg
    """
    from dataclasses import asdict

    from seatrial import api

    if name:
        guide = api.model_guide(name)
        print_model_guide(guide)
        write_json(json, lambda: asdict(guide))
        return
    summaries = api.list_models()
    print_models(summaries)
    write_json(json, lambda: {"models": [asdict(summary) for summary in summaries]})


def _print_rms(name: str, rms: dict[str, float]) -> None:
    if rms:
        print_lines([f"against {name}: rms {', '.join(f'{channel} {value:.3g}' for channel, value in rms.items())}"])


def _name_and_value(text: str) -> tuple[str, float]:
    from seatrial.core.values import InputError

    name, equals, value = text.partition("=")
    try:
        if not equals:
            raise ValueError
        return name.strip(), float(value)
    except ValueError:
        raise InputError(f"--set {text}: write NAME=VALUE with a number in SI units, e.g. --set n=10.2") from None


# The command export: a model as files of another tool.


@app.command()
def export(
    model_file: Annotated[
        Path, typer.Argument(metavar="MODEL.toml", help="Model file, as identify writes it, or its folder.")
    ],
    to: Annotated[
        str | None,
        typer.Option("--to", metavar="TARGET", help="c99, fmu, casadi, matlab, vrx, gazebo or ardupilot; see --list."),
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", metavar="PATH", help="New file or folder.")] = None,
    gains: Annotated[
        Path | None, typer.Option("--gains", metavar="GAINS.toml", help="gains.toml of tune, for ardupilot.")
    ] = None,
    show_list: Annotated[bool, typer.Option("--list", help="Show which targets suit the model, and why not.")] = False,
    model: OwnModelPath = None,
    json: Json = None,
    seed: Seed = 0,  # noqa: ARG001
) -> None:
    """Export a model to another tool, with units, signs, identified range and provenance in every file.

    Example: seatrial export results/kvlcc2/model.toml --to c99 --out kvlcc2

    What suits a model: seatrial export results/kvlcc2/model.toml --list
    """
    from seatrial import api
    from seatrial.core.values import InputError
    from seatrial.data.folder.gains_file import controller_gains
    from seatrial.exporting import TARGETS

    file = model_file if model is None else api.load_model(model_file, own_model(model))
    if show_list:
        reasons = api.export_targets(file)
        print_lines(
            f"{name:10s} {(reason and f'no: {reason}') or TARGETS[name].meaning}" for name, reason in reasons.items()
        )
        write_json(json, lambda: {"targets": reasons})
        return
    if to is None or out is None:
        raise InputError("give --to TARGET and --out PATH, or --list to see what suits the model")
    result = api.export(file, to, out, None if gains is None else controller_gains(gains))
    print_lines(result.notes)
    write_json(json, lambda: {"target": to, "path": str(out), "files": list(result.files), "notes": list(result.notes)})
    print_file("exported", out)
