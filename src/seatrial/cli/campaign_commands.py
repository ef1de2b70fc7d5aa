"""The commands of campaigns and of benchmarks."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from seatrial.cli.application import Application, Json, app, result_document, write_json
from seatrial.cli.finding_output import print_findings
from seatrial.cli.next_steps import after_campaign
from seatrial.cli.progress import progress_reporter
from seatrial.cli.screen import print_file, print_lines, print_next, print_sections, print_table, print_text_table

if TYPE_CHECKING:
    from seatrial.core.results.campaign import Benchmark, CampaignStatus, CampaignSummary


# Commands on campaigns: run a plan, status, gather, retry.


class PlanOrAction(TyperGroup):
    """`campaign PLAN.toml` is short for `campaign run PLAN.toml`."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Put `run` before arguments that name no action."""
        if args and args[0] not in (*self.commands, "--help"):
            args = ["run", *args]
        return super().parse_args(ctx, args)


campaigns = Application(
    cls=PlanOrAction,
    no_args_is_help=True,
    help="Many identifications in a store that survives kills: Monte Carlo, grids, runs left out, fleets.\n\n"
    "Example: seatrial campaign examples/coverage.toml --out results/coverage --workers 8\n\n"
    "Then: status STORE, gather STORE --to table.parquet, retry STORE. All take --json; a plan states its --seed.",
)
app.add_typer(campaigns, name="campaign")

StorePath = Annotated[Path, typer.Argument(metavar="STORE", help="Folder of a campaign.")]
Workers = Annotated[int | None, typer.Option("--workers", help="Processes of this machine; default: all cores.")]
Threads = Annotated[bool, typer.Option("--threads", help="Threads in place of processes.")]
Dask = Annotated[str, typer.Option("--dask", metavar="ADDRESS", help="Dask scheduler, tcp://host:8786, or 'local'.")]


@campaigns.command("run")
def run(
    plan: Annotated[Path, typer.Argument(metavar="PLAN.toml", help="Plan of a campaign, see docs/campaigns.md.")],
    out: Annotated[Path, typer.Option("--out", metavar="STORE", help="Store; an existing one is gone on with.")],
    workers: Workers = None,
    threads: Threads = False,
    dask: Dask = "",
    shard: Annotated[str, typer.Option("--shard", metavar="I/N", help="Only every N-th task, from the I-th.")] = "1/1",
    json: Json = None,
) -> None:
    """Do the tasks of a plan that the store does not hold yet.

    Example: seatrial campaign examples/coverage.toml --out results/coverage --workers 8

    On a cluster: --dask tcp://host:8786, or a job array with --shard $SLURM_ARRAY_TASK_ID/16
    """
    from seatrial import api

    with _resumable(out), progress_reporter() as report_progress:
        status = api.campaign(
            plan, out, workers=workers, threads=threads, dask=dask, shard=shard, report_progress=report_progress
        )
    _print_status(status)
    print_next(after_campaign(status, out))
    write_json(json, lambda: result_document(status))


@campaigns.command("status")
def status(store: StorePath, json: Json = None) -> None:
    """Print how many tasks are done, failed and left.

    Example: seatrial campaign status results/coverage
    """
    from seatrial import api

    counts = api.campaign_status(store)
    _print_status(counts)
    print_next(after_campaign(counts, store))
    write_json(json, lambda: result_document(counts))


@campaigns.command("gather")
def gather(
    store: StorePath,
    to: Annotated[Path, typer.Option("--to", metavar="FILE", help="Table, .csv or .parquet; the page: .html.")],
    json: Json = None,
) -> None:
    """Gather the results into one table, a row a coefficient and task, and a page.

    Example: seatrial campaign gather results/coverage --to coverage.parquet
    """
    from seatrial import api

    page = to.with_suffix(".html")
    summary = api.gather_campaign(store, to, page)
    _print_summary(summary)
    write_json(json, lambda: result_document(summary))
    print_file("table", to)
    print_file("report", page)


@campaigns.command("retry")
def retry(
    store: StorePath, workers: Workers = None, threads: Threads = False, dask: Dask = "", json: Json = None
) -> None:
    """Do failed tasks again, and those that are left.

    Example: seatrial campaign retry results/coverage
    """
    from seatrial import api

    with _resumable(store), progress_reporter() as report_progress:
        status = api.retry_campaign(store, workers=workers, threads=threads, dask=dask, report_progress=report_progress)
    _print_status(status)
    print_next(after_campaign(status, store))
    write_json(json, lambda: result_document(status))


class _resumable:
    """Says after Ctrl-C how to go on."""

    def __init__(self, store: Path) -> None:
        self._store = store

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: type[BaseException] | None, error: object, trace: object) -> None:
        if kind is KeyboardInterrupt:
            print(f"what is finished is kept in {self._store}; the same command goes on with it", file=sys.stderr)


def _print_status(status: "CampaignStatus") -> None:
    from seatrial.reporting.campaign import status_sentence

    print_lines([status_sentence(status)])
    if status.damaged_places:
        print_lines([f"journals are damaged in {status.damaged_places} places; the tasks there are done again"])


def _print_summary(summary: "CampaignSummary") -> None:
    from seatrial.reporting.campaign import coefficient_section, outcome

    print_lines(outcome(summary))
    print_sections([coefficient_section(summary.coefficients)])
    print_lines(f"{failure.count} failed: {failure.example}" for failure in summary.failures)
    if summary.findings:
        print_findings(summary.findings, 1)


# The command that runs methods against benchmark problems.

RUNS = 30
"""Runs of a method where none are stated: COCO has 15 (Hansen et al. 2016); twice that suits paired tests."""


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
