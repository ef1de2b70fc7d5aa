"""The command that runs methods against benchmark problems."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from seatrial.cli.application import Json, app, result_document, write_json
from seatrial.cli.finding_output import print_findings
from seatrial.cli.progress import progress_reporter
from seatrial.cli.screen import print_file, print_lines, print_table
from seatrial.cli.section_output import print_text_table

RUNS = 30
"""Runs of a method where none are stated: COCO has 15 (Hansen et al. 2016); twice that suits paired tests."""

if TYPE_CHECKING:
    from seatrial.core.results.campaign import Benchmark


@app.command("benchmark")
def benchmark(
    problems: Annotated[
        list[str] | None, typer.Argument(metavar="PROBLEM...", help="Names, families or patterns; see --list.")
    ] = None,
    method: Annotated[
        list[str] | None,
        typer.Option("--method", metavar="FILE.py|module:Class|NAME", help="Yours; the file is executed. Repeatable."),
    ] = None,
    against: Annotated[
        list[str] | None, typer.Option("--against", metavar="NAME", help="Built-in; default: all. Repeatable.")
    ] = None,
    runs: Annotated[int, typer.Option("--runs", min=1, help="Of each method on each problem.")] = RUNS,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder of runs and page; gone on with.")
    ] = None,
    as_published: Annotated[bool, typer.Option("--as-published", help="Truth where the paper has it.")] = False,
    workers: Annotated[int | None, typer.Option("--workers", help="Processes; default: all cores.")] = None,
    seed: Annotated[int, typer.Option("--seed", min=0, help="First seed; run k has seed + k.")] = 0,
    list_: Annotated[bool, typer.Option("--list", help="List problems and built-in methods.")] = False,
    json: Json = None,
) -> None:
    """Run methods against problems whose answer is known, and compare them.

    Example: seatrial benchmark qi2025-135-whole --method my_search.py --runs 30 --out results/my_search
    """
    from seatrial import api
    from seatrial.core.values import InputError

    if list_:
        _print_list()
        return
    if not problems or out is None:
        raise InputError("name at least one problem, and a folder with --out; 'seatrial benchmark --list' names them")
    with progress_reporter() as report_progress:
        result = api.benchmark(
            problems, out, methods=method or (), against=against, runs=runs, seed=seed, as_published=as_published,
            workers=workers, report_progress=report_progress,
        )  # fmt: skip
    _print_benchmark(result)
    write_json(json, lambda: result_document(result))
    print_file("report", out / "benchmark.html")


def _print_list() -> None:
    from seatrial.problems import absent_families, built_in_methods, list_problems

    rows = [(p.name, str(p.budget), p.title) for p in list_problems()]
    print_table([("problem", "budget", ""), *rows], flush_left=(0, 2))
    print_lines([f"{name} is not here: {reason}" for name, reason in absent_families().items()])
    print_table([("method", ""), *((m.name, m.source) for m in built_in_methods().values())], flush_left=(0, 1))


def _print_benchmark(result: "Benchmark") -> None:
    from seatrial.reporting.benchmark import method_table, outcome

    for score in result.problems:
        print_lines([f"{score.name}: an error of 1 is {score.error_unit}"])
        print_text_table(method_table(score))
    print_lines(outcome(result))
    print_lines([f"to cite: {result.citation}"])
    if result.findings:
        print_findings(result.findings, 1)
