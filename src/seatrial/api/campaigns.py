"""Campaigns: many tasks in a store, on one machine or many."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from seatrial.campaigns import Work
    from seatrial.campaigns.run_campaign import CampaignOptions
    from seatrial.core.results.campaign import CampaignStatus, CampaignSummary
    from seatrial.core.values import ProgressReporter


def campaign(
    plan: "str | Path | Work",
    store: str | Path,
    *,
    workers: int | None = None,
    threads: bool = False,
    dask: str = "",
    shard: str = "1/1",
    retry: bool = False,
    report_progress: "ProgressReporter | None" = None,
) -> "CampaignStatus":
    """Do the tasks of a plan that its store does not hold yet, and return how many are done, failed and left.

    Args:
        plan: a plan file (see docs/campaigns.md), or work defined in Python (`seatrial.campaigns.Work`).
        store: folder of the results; made where it does not exist, gone on with where it does.
        workers: processes of this machine; None: as many as cores.
        threads: threads in place of processes.
        dask: address of a Dask scheduler, or ``local`` for one of its own.
        shard: which share of the tasks, such as ``3/16``; needs no coordination between machines.
        retry: whether failed tasks are done again.
        report_progress: called with one line of text about a hundred times.

    Raises:
        InputError: the plan or a file that it names is not valid; the store is of another campaign or version, or
            cannot be written; a scheduler or worker that cannot be used.
    """
    from seatrial.campaigns.run_campaign import run_campaign, work_of_plan

    options = _options(workers, dask, shard, threads=threads, retry=retry)
    if isinstance(plan, str | Path):
        return run_campaign(work_of_plan(Path(plan)), Path(store), options, report_progress, Path(plan))
    return run_campaign(plan, Path(store), options, report_progress)


def campaign_status(store: str | Path) -> "CampaignStatus":
    """Return how many tasks of a store are done, failed and left; also while others work on it.

    Raises:
        InputError: the folder holds no campaign, or a journal cannot be read.
    """
    from seatrial.campaigns import open_store

    return open_store(Path(store)).status()


def retry_campaign(
    store: str | Path,
    *,
    workers: int | None = None,
    threads: bool = False,
    dask: str = "",
    report_progress: "ProgressReporter | None" = None,
) -> "CampaignStatus":
    """Do the failed tasks of a store again, and those that are left; arguments as in `campaign`.

    Raises:
        InputError: as `campaign`; or the plan's file is gone, or the campaign was begun with work from Python.
    """
    from seatrial.campaigns.run_campaign import retry_campaign

    return retry_campaign(Path(store), _options(workers, dask, threads=threads, retry=True), report_progress)


def gather_campaign(
    store: str | Path, table: str | Path | None = None, page: str | Path | None = None
) -> "CampaignSummary":
    """Gather what a store holds into one table and one page, and return the summary.

    Args:
        table: file to write, ``.csv`` or ``.parquet``: a row a coefficient and task, in the order of the plan.
        page: HTML file to write.

    Raises:
        InputError: no campaign, no result yet, another ending, or a file that cannot be written.
    """
    from seatrial.campaigns import open_store
    from seatrial.campaigns.summary import campaign_summary, campaign_table, write_table
    from seatrial.core.values.files import write_atomically
    from seatrial.reporting.pages import report_page

    opened = open_store(Path(store))
    gathered = campaign_table(opened)
    if table is not None:
        write_table(gathered, Path(table))
    summary = campaign_summary(opened, gathered)
    if page is not None:
        write_atomically(Path(page), report_page(summary).encode())
    return summary


def _options(
    workers: int | None, dask: str = "", shard: str = "1/1", *, threads: bool = False, retry: bool = False
) -> "CampaignOptions":
    from seatrial.campaigns.engines import WorkerKind
    from seatrial.campaigns.run_campaign import CampaignOptions, shard_named
    from seatrial.core.values import InputError

    if workers is not None and workers < 1:
        raise InputError(f"{workers} workers can do nothing; give at least 1, or leave it out for all cores")
    kind = WorkerKind.THREADS if threads else WorkerKind.PROCESSES
    return CampaignOptions(workers, kind, dask, shard_named(shard), retry)
