"""Commands on results and without records: report, compare, reproduce, demo."""

from pathlib import Path
from typing import Annotated

import typer

from seatrial.cli.application import Json, OwnModelPath, Seed, app, own_model, result_document, write_json
from seatrial.cli.finding_output import print_warnings
from seatrial.cli.next_steps import after_fit
from seatrial.cli.progress import progress_reporter
from seatrial.cli.result_output import print_fit, print_poster, print_study, print_summary
from seatrial.cli.screen import print_file, print_next, print_sections


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

    result = api.load(folder, own_model(model))
    page = api.report(result, folder / "report.html")
    write_json(json, lambda: result_document(result))
    print_file("report", page)


@app.command()
def compare(
    first: Annotated[Path, typer.Argument(metavar="FIRST", help="Result folder of identify.")],
    second: Annotated[Path, typer.Argument(metavar="SECOND", help="The one that it is compared with.")],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Where report and comparison.json go.")
    ] = None,
    manoeuvre: Annotated[
        list[str] | None,
        typer.Option("--manoeuvre", help="Compare this one, as zigzag:20/20; default: turns and zigzags of IMO."),
    ] = None,
    speed: Annotated[
        float | None, typer.Option(help="Approach speed of both, m/s; default: that of each one's trials.")
    ] = None,
    model: OwnModelPath = None,
    json: Json = None,
    seed: Seed = 0,  # noqa: ARG001
) -> None:
    """Compare two fits, of two days, loadings, facilities or methods: coefficients, manoeuvres, what else changed.

    Example: seatrial compare results/laden results/ballast --out results/loading
    """
    from seatrial import api
    from seatrial.api.comparison import MANOEUVRES
    from seatrial.core.values.files import writable_folder
    from seatrial.reporting.comparison import first_screen, sections

    if out is not None:
        writable_folder(out)
    equations = own_model(model)
    with progress_reporter() as report_progress:
        result = api.compare(
            api.load_fit(first, equations),
            api.load_fit(second, equations),
            names=(str(first), str(second)),
            manoeuvres=tuple(manoeuvre or MANOEUVRES),
            speed=speed,
            report_progress=report_progress,
        )
        page = None if out is None else api.save(result, out)
    screen = first_screen(result)
    print_summary(f"{result.first.name} (first) and {result.second.name} (second)", screen.verdict, screen.facts)
    print_sections(sections(result))
    print_warnings(result.findings)
    write_json(json, lambda: result_document(result))
    if page is not None:
        print_file("report", page)


@app.command()
def poster(
    folder: Annotated[Path, typer.Argument(metavar="RESULT", help="Result folder of identify.")],
    out: Annotated[Path, typer.Option("--out", metavar="FILE.html", help="Page that prints on a sheet of A4.")],
    rudder: Annotated[float, typer.Option(help="Rudder angle of the turning circles, deg.")] = 35.0,  # most ships'
    speed: Annotated[float | None, typer.Option(help="Approach speed, m/s; default: that of the trials.")] = None,
    model: OwnModelPath = None,
    json: Json = None,
    seed: Seed = 0,  # noqa: ARG001
) -> None:
    """Write the wheelhouse poster and pilot card of a fit (IMO A.601(15)): each number with interval and basis.

    Example: seatrial poster results/kvlcc2 --out poster.html
    """
    from seatrial import api

    fit = api.load_fit(folder, own_model(model))
    with progress_reporter() as report_progress:
        result = api.poster(fit, rudder_deg=rudder, speed=speed, report_progress=report_progress)
        page = api.write_poster(result, out)
    print_poster(result)
    write_json(json, lambda: result_document(result))
    print_file("poster", page)


@app.command()
def reproduce(
    study: Annotated[str, typer.Argument(metavar="STUDY", help="E.g. alexandersson2022.")],
    quick: Annotated[bool, typer.Option("--quick", help="Fewer cases: 4 to 40 s of computing, by study.")] = False,
    out: Annotated[Path | None, typer.Option("--out", metavar="DIR", help="Where report and study.json go.")] = None,
    json: Json = None,
    seed: Seed = 0,
) -> None:
    """Repeat a published study and check its claims.

    Example: seatrial reproduce alexandersson2022 --quick --out results/alexandersson2022
    """
    from seatrial import api
    from seatrial.core.values.files import writable_folder

    if out is not None:
        writable_folder(out)
    with progress_reporter() as report_progress:
        result = api.reproduce(study, quick=quick, seed=seed, report_progress=report_progress)
        page = None if out is None else api.save(result, out)
    print_study(result)
    write_json(json, lambda: result_document(result))
    if page is not None:
        print_file("report", page)


@app.command()
def demo(
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Where trials, result and report go.")],
    json: Json = None,
    seed: Seed = 0,
) -> None:
    """Identify a craft with known coefficients from simulated trials.

    Example: seatrial demo --out demo
    """
    from seatrial import api
    from seatrial.core.values.files import writable_folder

    writable_folder(out)
    with progress_reporter() as report_progress:
        fit = api.demo(out, seed=seed, report_progress=report_progress)
    print_fit(fit)
    write_json(json, lambda: result_document(fit))
    print_file("report", out / "report.html")
    print_next(after_fit(fit, out))
