"""A campaign done: tasks that the store does not hold yet, by an engine, each outcome kept as it comes."""

from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from seatrial.campaigns.engines import WorkerKind, outcomes_here, outcomes_in_processes, outcomes_in_threads
from seatrial.campaigns.plan import MonteCarloPlan, read_plan
from seatrial.campaigns.store import open_store, store_for
from seatrial.campaigns.work import Outcome, Outcomes, Task, Work
from seatrial.core.results.campaign import CampaignStatus
from seatrial.core.text.numbers import duration
from seatrial.core.values import InputError, ProgressReporter

FLUSH_S = 2.0
"""Seconds between two flushes of the journal to the disk: chosen; what a power failure can cost, and on a network file
system the least time that does not slow short tasks down."""
_REPORTS = 100  # progress reports of a campaign at most: chosen, one a per cent


@dataclass(frozen=True)
class Shard:
    """A share of the tasks: number `index` of `count`, counted from 1; every count-th task."""

    index: int
    count: int

    def share(self, tasks: Sequence[Task]) -> Sequence[Task]:
        """Return the tasks of this shard."""
        return tasks[self.index - 1 :: self.count]


def shard_named(text: str) -> Shard:
    """Return the shard of a text such as ``3/16``.

    Raises:
        InputError: it is no such text, or counts from 0.
    """
    first, _, second = text.partition("/")
    if not (first.strip().isdigit() and second.strip().isdigit()):
        raise InputError(f"--shard '{text}' is not of the form 3/16")
    index, count = int(first), int(second)
    if not 1 <= index <= count:
        raise InputError(f"--shard {text}: shards count from 1 to {count}; a SLURM array is --array=1-{count}")
    return Shard(index, count)


WHOLE = Shard(1, 1)


@dataclass(frozen=True)
class CampaignOptions:
    """How a campaign is worked through; nothing of it changes a result.

    Attributes:
        workers: processes or threads of this machine; None: as many as cores.
        kind: which of the two.
        dask: address of a scheduler, ``local`` for one of its own, empty for none.
        shard: which share of the tasks.
        retry: whether failed tasks are done again.
    """

    workers: int | None = None
    kind: WorkerKind = WorkerKind.PROCESSES
    dask: str = ""
    shard: Shard = WHOLE
    retry: bool = False


def work_of_plan(path: Path) -> Work:
    """Return the work that a plan describes.

    Raises:
        InputError: the plan, or a file that it names, is not valid.
    """
    plan = read_plan(path)
    try:
        if isinstance(plan, MonteCarloPlan):
            from seatrial.campaigns.montecarlo_work import montecarlo_work

            return montecarlo_work(plan, path.resolve().parent)
        from seatrial.campaigns.trial_work import trial_work

        return trial_work(plan, path.resolve().parent)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def run_campaign(
    work: Work,
    folder: Path,
    options: CampaignOptions,
    report_progress: ProgressReporter | None = None,
    plan: Path | None = None,
) -> CampaignStatus:
    """Do those tasks of a campaign that its store does not hold yet, and return how far it is then.

    Ctrl-C, a kill or a full disk leave a store that the same call goes on with.

    Args:
        folder: the store; made where it does not exist.
        plan: the file that describes the work, for `retry` later.

    Raises:
        InputError: the store is of another campaign or other versions, or cannot be written; a Dask scheduler or a
            worker that cannot be used.
    """
    tasks = work.tasks()
    store = store_for(work, tasks, folder, plan)
    stored = store.outcomes()
    mine = options.shard.share(tasks)
    remaining = [task for task in mine if not stored.is_finished(task, retry=options.retry)]
    if remaining:
        progress = _Progress(report_progress, len(mine), len(mine) - len(remaining))
        journal = store.new_journal(FLUSH_S)
        try:
            with closing(_outcomes(work, remaining, options)) as outcomes:
                for outcome in outcomes:
                    journal.append(outcome)
                    progress.count(outcome)
        finally:
            journal.close()
    return store.status()


def retry_campaign(
    folder: Path, options: CampaignOptions, report_progress: ProgressReporter | None = None
) -> CampaignStatus:
    """Do the failed and the remaining tasks of a store again, by the plan that it was begun with.

    Raises:
        InputError: as `run_campaign`; or the plan's file is gone, or the campaign was begun from Python.
    """
    plan = open_store(folder).table["plan"]
    if plan is None:
        raise InputError(f"the campaign in '{folder}' was begun from Python; run that again with retry")
    return run_campaign(work_of_plan(Path(plan)), folder, options, report_progress, Path(plan))


def _outcomes(work: Work, tasks: Sequence[Task], options: CampaignOptions) -> Outcomes:
    from seatrial.numerics.workers import worker_count

    if options.dask:
        from seatrial.campaigns.engines import outcomes_by_dask

        return outcomes_by_dask(work, tasks, options.dask, options.workers)
    count = worker_count(options.workers)
    if count == 1:
        return outcomes_here(work.function, tasks)
    engine = outcomes_in_threads if options.kind is WorkerKind.THREADS else outcomes_in_processes
    return engine(work.function, tasks, count)


class _Progress:
    """Reports how many tasks are done and failed, and how long the others will take at the pace so far."""

    def __init__(self, report: ProgressReporter | None, total: int, finished: int) -> None:
        from time import monotonic

        self._report, self._total, self._finished, self._first = report, total, finished, finished
        self._failed, self._clock, self._began = 0, monotonic, monotonic()
        self._step = max(1, total // _REPORTS)

    def count(self, outcome: Outcome) -> None:
        self._finished += 1
        self._failed += outcome.is_failure
        if self._report is None or (self._finished % self._step and self._finished != self._total):
            return
        pace = (self._clock() - self._began) / (self._finished - self._first)
        remaining = self._total - self._finished
        failed = f", {self._failed} failed" if self._failed else ""
        rest = f", about {duration(pace * remaining)} left" if remaining else ""
        self._report(f"campaign: {self._finished} of {self._total} tasks done{failed}{rest}")
