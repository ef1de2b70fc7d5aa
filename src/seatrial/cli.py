"""The command line: parse, call, print, exit code. Everything heavy is imported inside the commands."""

import math
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from seatrial.equations import Model
    from seatrial.results import Fit
    from seatrial.values import Finding

app = typer.Typer(
    name="seatrial",
    help="Sea-trial records into ship motion models you can defend.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)

Json = Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Write the result as JSON.")]
Seed = Annotated[int, typer.Option("--seed", help="Of everything drawn at random; the same seed gives the same bits.")]
TrialPath = Annotated[Path, typer.Argument(metavar="TRIAL.toml", help="Trial file.")]
OwnModel = Annotated[Path | None, typer.Option("--model", metavar="FILE.py", help="A model of your own (is executed).")]

INTERRUPTED = 130
OF_A_KIND = 2
SEVERITY_MARK = {"error": "ERROR  ", "warning": "warning", "info": "note   "}


def _version(wanted: bool) -> None:
    if wanted:
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
    everything: Annotated[bool, typer.Option("--all", help="Every finding, not the first few of each kind.")] = False,
    model: OwnModel = None,
    json: Json = None,
    seed: Seed = 0,  # noqa: ARG001
) -> None:
    """Say what is odd about the records: frames, signs, units, gaps, jumps, lags.

    Example: seatrial check examples/esso_osaka.toml
    """
    from seatrial import verbs
    from seatrial.trial.fit_json import findings_json

    findings = verbs.check(verbs.load_trial(trial, _own(model)))
    _print_findings(findings, len(findings) if everything else OF_A_KIND)
    _write_json(json, lambda: findings_json(findings))


@app.command()
def identify(
    trial: TrialPath,
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Result folder: model, result, report.")],
    model: OwnModel = None,
    json: Json = None,
    seed: Seed = 0,
) -> None:
    """Estimate the ship's model from the training runs and predict the validation runs.

    Example: seatrial identify examples/kvlcc2_hsva.toml --out results/kvlcc2
    """
    from seatrial import verbs
    from seatrial.values.files import writable_folder

    writable_folder(out)
    with _progress() as progress:
        fit = verbs.identify(verbs.load_trial(trial, _own(model)), seed=seed, progress=progress)
        progress("report")
        page = verbs.save(fit, out)
    _print_fit(fit)
    _write_json(json, lambda: _fit_json(fit))
    print(f"report: {page}")


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
    inputs: Annotated[Path | None, typer.Option("--inputs", metavar="RECORD", help="Replay a record's inputs.")] = None,
    speed: Annotated[float | None, typer.Option(help="Approach speed, m/s; default: where surge balances.")] = None,
    duration: Annotated[float | None, typer.Option(help="s at most.")] = None,
    constant: Annotated[
        list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="A constant input in SI units.")
    ] = None,
    rudder_rate: Annotated[float | None, typer.Option(help="deg/s; default: SOLAS's at the ship's scale.")] = None,
    model: OwnModel = None,
    json: Json = None,
    seed: Seed = 0,
) -> None:
    """Steer a manoeuvre with a model, or replay measured inputs, and print its measures.

    Example: seatrial simulate results/kvlcc2/model.toml --manoeuvre turning-circle:35 --out turn.csv
    """
    from seatrial import verbs
    from seatrial.read import read_table, write_record
    from seatrial.values import InputError
    from seatrial.values.files import writable_folder

    if (manoeuvre is None) == (inputs is None):
        raise InputError("give either --manoeuvre or --inputs")
    file = verbs.load_model(model_file, _own(model))
    writable_folder(out.parent)
    if inputs is not None:
        record = verbs.replay(file, read_table(inputs))
    else:
        held = dict(_pair(text) for text in constant or [])
        record = verbs.simulate(
            file,
            manoeuvre or "",
            speed=speed,
            inputs=held,
            duration=duration,
            rudder_rate=None if rudder_rate is None else math.radians(rudder_rate),
            seed=seed,
        )
    write_record(record, out)
    measures = verbs.measures(file, record)
    for name, value in measures.items():
        print(f"  {name:28s} {value:10.4g}")
    _write_json(json, lambda: {"record": str(out), "measures": measures, "seed": seed})
    print(f"record: {out}")


@app.command()
def report(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Result folder.")],
    model: OwnModel = None,
    json: Json = None,
    seed: Seed = 0,  # noqa: ARG001
) -> None:
    """Render the report of a result folder again, without computing.

    Example: seatrial report results/kvlcc2
    """
    from seatrial import verbs

    fit = verbs.load_fit(folder, _own(model))
    page = verbs.report(fit, folder / "report.html")
    _write_json(json, lambda: _fit_json(fit))
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
    from seatrial import verbs
    from seatrial.values.files import writable_folder

    writable_folder(out)
    with _progress() as progress:
        fit = verbs.demo(out, seed=seed, progress=progress)
    _print_fit(fit)
    _write_json(json, lambda: _fit_json(fit))
    print(f"report: {out / 'report.html'}")


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
    from seatrial import verbs
    from seatrial.values.files import writable_folder

    if out is not None:
        writable_folder(out)
    with _progress() as progress:
        made = verbs.reproduce(study, quick=quick, seed=seed, progress=progress)
        page = None if out is None else verbs.save_study(made, out)
    for claim in made.claims:
        print(f"  {claim.verdict:10s} {claim.claim}: {claim.evidence}")
    for one in made.checks:
        limit = one.limit if isinstance(one.limit, str) else f"{one.limit:.4g}"
        print(f"  {'holds' if one.holds else 'FAILS':10s} {one.name}: {one.value:.4g} (limit {limit})")
    _write_json(json, made.as_table)
    if page is not None:
        print(f"report: {page}")


def _own(path: Path | None) -> "Model | None":
    if path is None:
        return None
    from seatrial.models import model_from_file

    return model_from_file(path)


def _pair(text: str) -> tuple[str, float]:
    from seatrial.values import InputError

    name, equals, value = text.partition("=")
    try:
        if not equals:
            raise ValueError
        return name.strip(), float(value)
    except ValueError:
        raise InputError(f"--set {text}: write NAME=VALUE with a number in SI units, e.g. --set n=10.2") from None


def _fit_json(fit: "Fit") -> dict[str, Any]:
    from seatrial.trial.fit_json import fit_json

    return fit_json(fit)


def _write_json(path: Path | None, table: Callable[[], Mapping[str, Any]]) -> None:
    if path is not None:
        from seatrial.trial.fit_json import strict_json
        from seatrial.values.files import write_whole

        write_whole(path, strict_json(table()).encode())


def _print_findings(findings: "tuple[Finding, ...]", of_a_kind: int) -> None:
    """Findings by kind, errors first; of each kind the first few."""
    order = list(SEVERITY_MARK)
    kinds = {
        (f.severity.value, f.code): [g for g in findings if g.code == f.code and g.severity is f.severity]
        for f in findings
    }
    for (severity, code), alike in sorted(kinds.items(), key=lambda item: order.index(item[0][0])):
        for finding in alike[:of_a_kind]:
            print(f"{SEVERITY_MARK[severity]} [{code}] {finding.text}")
        if len(alike) > of_a_kind:
            print(f"        ... and {len(alike) - of_a_kind} more of this kind; --all shows them")
        if alike[0].advice:
            print(f"        advice: {alike[0].advice}")
    errors = sum(finding.severity.value == "error" for finding in findings)
    print(f"{len(findings)} finding{'s' * (len(findings) != 1)}, {errors} of them error{'s' * (errors != 1)}")


def _print_fit(fit: "Fit") -> None:
    with_truth = any(c.truth is not None for c in fit.coefficients)
    print(f"{'coefficient':14s} {'estimate':>12s} {'std. error':>11s}" + (f" {'truth':>12s}" if with_truth else ""))
    for c in fit.coefficients:
        if not c.fixed:
            error = "" if c.standard_error is None else f"{c.standard_error:11.2g}"
            truth = f" {c.truth:12.5g}" if c.truth is not None else ""
            print(f"{c.name:14s} {c.estimate:12.5g} {error:>11s}{truth} {c.unit if c.unit != '1' else ''}".rstrip())
    for p in fit.validation():
        errors = ", ".join(f"{name} {value:.3g}" for name, value in p.rms.items())
        print(f"validation {p.record}: rms {errors}")
    print(f"{fit.method.criterion}; {fit.elapsed_s:.1f} s")


@contextmanager
def _progress() -> Iterator[Callable[[str], None]]:
    """A spinner on a terminal, plain lines otherwise; both on standard error."""
    if not sys.stderr.isatty():
        yield lambda text: print(text, file=sys.stderr, flush=True)
        return
    from rich.console import Console

    with Console(stderr=True).status("starting") as status:
        yield status.update


def main() -> None:
    """Run the command line; bad input is one line on standard error and exit code 2."""
    try:
        app()
    except ValueError as error:
        from seatrial.values import InputError

        if not isinstance(error, InputError):
            raise
        print(f"seatrial: {' '.join(str(error).split())}", file=sys.stderr)
        sys.exit(2)
    except SystemExit as ending:
        if ending.code == INTERRUPTED:
            print("seatrial: interrupted; files are written whole or not at all", file=sys.stderr)
        raise
    except KeyboardInterrupt:
        print("seatrial: interrupted; files are written whole or not at all", file=sys.stderr)
        sys.exit(INTERRUPTED)
