"""Tasks on a Dask cluster, which gives them out, moves them off workers that die, and brings their outcomes back.

What all tasks share, files included, travels to each worker once, whenever it joins. Outcomes come to this process,
which keeps them; a lost scheduler costs what was running.
"""

import logging
import shutil
from collections.abc import Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

from seatrial.campaigns.files_elsewhere import CarriedFiles
from seatrial.campaigns.machine import serial_linear_algebra
from seatrial.campaigns.outcome import Outcome, Outcomes, attempted, lost_outcome
from seatrial.campaigns.work import Task, TaskFunction, Work
from seatrial.core.values import InputError, versions
from seatrial.numerics.workers import worker_count

LOCAL = "local"
DaskClient = Any
"""A client of Dask; its own annotations are those of its asynchronous half."""
_CONNECT_S = 10  # s to wait for the scheduler, at first and after it was lost: chosen
_AHEAD = 4
"""Tasks handed over beforehand, for each thread of the cluster: chosen, so that none waits for this process."""
_LEAST_AHEAD = 32  # tasks handed over beforehand where few or no workers have come yet: chosen


@runtime_checkable
class FilesTask(Protocol):
    """A function of tasks that reads files, which can be moved."""

    def carried(self) -> CarriedFiles:
        """Read the files."""
        ...

    def moved(self, root: Path) -> TaskFunction:
        """Return the function for files in another folder."""
        ...


class CampaignPlugin:
    """What a worker holds of a campaign: the function of its tasks, and its files in a folder of the worker's own."""

    functions: dict[str, TaskFunction] = {}  # noqa: RUF012  # of this process, by campaign
    refusals: dict[str, str] = {}  # noqa: RUF012  # why this process takes no task, by campaign

    def __init__(self, work: Work) -> None:
        self.name = f"seatrial-campaign-{work.digest}"
        self._digest, self._function, self._versions = work.digest, work.function, dict(work.versions)
        self._files = work.function.carried() if isinstance(work.function, FilesTask) else None

    def setup(self, worker: Any) -> None:  # noqa: ARG002
        """Begin on a worker; Dask calls this when one joins."""
        if difference := _difference(self._versions, versions()):
            self.refusals[self._digest] = f"a Dask worker has {difference}"
        self._stack = ExitStack()
        self._stack.enter_context(serial_linear_algebra())
        function = self._function
        if self._files is not None and isinstance(function, FilesTask):
            root = self._files.unpack()
            self._stack.callback(shutil.rmtree, root, ignore_errors=True)
            function = function.moved(root)
        self.functions[self._digest] = function

    def teardown(self, worker: Any) -> None:  # noqa: ARG002
        """End on a worker."""
        for table in (self.functions, self.refusals):
            table.pop(self._digest, None)
        self._stack.close()


def attempted_there(digest: str, task: Task) -> Outcome:
    """Do a task on a worker.

    Raises:
        InputError: the worker has other versions of the packages.
    """
    if digest in CampaignPlugin.refusals:
        raise InputError(CampaignPlugin.refusals[digest])
    return attempted(CampaignPlugin.functions[digest], task)


def outcomes_by_dask(work: Work, tasks: Sequence[Task], address: str, workers: int | None) -> Outcomes:
    """Yield the outcomes of tasks done by a Dask cluster, as they come.

    Args:
        address: of a scheduler, or ``local`` for one of this machine.
        workers: of a local one; None: as many as cores.

    Raises:
        InputError: no Dask, no scheduler there, a worker of other versions (by its name), or a scheduler that is lost.
    """
    with _cluster(address, workers) as client:
        _refuse_other_versions(client, dict(work.versions))
        client.register_plugin(_as_worker_plugin(work))
        try:
            yield from _collected(client, work, tasks)
        except CancelledError:
            raise _lost(address) from None


def _collected(client: DaskClient, work: Work, tasks: Sequence[Task]) -> Outcomes:
    """Yield the outcomes, batch by batch, with as many tasks handed over as keep the workers busy."""
    from distributed import as_completed

    waiting, running = iter(tasks), dict[str, Task]()

    def submitted(count: int) -> list[Any]:
        new = {f"seatrial-{task.identity.hex()}": task for task in islice(waiting, count)}
        running.update(new)
        function = partial(attempted_there, work.digest)
        return client.map(function, list(new.values()), key=list(new), pure=False) if new else []

    threads = sum(client.nthreads().values())
    first = submitted(max(_AHEAD * threads, _LEAST_AHEAD))
    pending = as_completed(first, with_results=True, raise_errors=False, loop=client.loop)
    for batch in pending.batches():
        outcomes = [_outcome(running.pop(future.key), future.status, result) for future, result in batch]
        pending.update(submitted(len(outcomes)))
        yield from outcomes


def _outcome(task: Task, status: str, result: Any) -> Outcome:
    """Return what a finished future says of its task.

    Raises:
        CancelledError: the scheduler was lost.
        InputError: the worker cannot do tasks.
    """
    from distributed import KilledWorker

    if isinstance(result, Outcome):
        return result
    error = result[1] if isinstance(result, tuple) else result
    if status != "error" or isinstance(error, CancelledError):
        raise CancelledError
    if isinstance(error, KilledWorker):
        return lost_outcome(task, f"its workers ended without a result ({error.allowed_failures + 1} of them)")
    if isinstance(error, InputError):
        raise error
    raise InputError(
        f"a Dask worker cannot do a task ({type(error).__name__}: {error}); install the same seatrial there as here"
    )


@contextmanager
def _cluster(address: str, workers: int | None) -> Iterator[DaskClient]:
    """Connect to a scheduler, or start one with its workers."""
    try:
        from dask import config
        from distributed import Client
        from distributed.deploy.local import LocalCluster
    except ImportError:
        raise InputError("--dask needs Dask; run: pip install 'seatrial[cluster]'") from None
    logging.getLogger("distributed").setLevel(logging.CRITICAL)  # its tracebacks of a lost scheduler are no news
    with ExitStack() as stack:
        target: Any = address
        if address == LOCAL:
            # readers of binary logs work in a process of their own, which a daemon may not have
            stack.enter_context(config.set({"distributed.worker.daemon": False}))
            start: Any = LocalCluster
            cluster = start(n_workers=worker_count(workers), threads_per_worker=1, dashboard_address=None,
                            silence_logs=logging.CRITICAL)  # fmt: skip
            target = stack.enter_context(cluster)
        try:
            client = Client(target, timeout=_CONNECT_S, set_as_default=False)
        except (OSError, TimeoutError, ValueError) as error:
            raise InputError(f"no Dask scheduler answers at '{address}' ({error}); start one, or check it") from None
        stack.callback(client.close, timeout=_CONNECT_S)
        yield client


def _as_worker_plugin(work: Work) -> Any:
    """The plugin as one that Dask knows; made here, as Dask may be absent."""
    from distributed import WorkerPlugin

    return type(CampaignPlugin.__name__, (CampaignPlugin, WorkerPlugin), {})(work)


def _refuse_other_versions(client: DaskClient, expected: dict[str, str]) -> None:
    """Raises:
    InputError: a worker has another version of a package, or no seatrial.
    """
    for worker, answer in client.run(versions, on_error="return").items():
        if isinstance(answer, Exception):
            raise InputError(f"Dask worker '{worker}' cannot import seatrial ({answer}); install it there")
        if difference := _difference(expected, answer):
            raise InputError(f"Dask worker '{worker}' has {difference}")


def _difference(expected: dict[str, str], present: dict[str, str]) -> str:
    """Return what is different between versions here and on a worker; empty where nothing is."""
    for name, version in expected.items():
        if present.get(name) != version:
            return f"{name} {present.get(name)}, the campaign was begun with {version}; install that on all machines"
    return ""


def _lost(address: str) -> InputError:
    return InputError(
        f"the Dask scheduler '{address}' was lost; what was finished is kept: start it again and run the same command"
    )
