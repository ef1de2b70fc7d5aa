"""Tasks on this machine, in threads or processes, and on a Dask cluster, of which any part may die."""

import hashlib
import logging
import multiprocessing
import os
import shutil
import signal
import tempfile
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, ThreadPoolExecutor, wait
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from enum import StrEnum
from functools import partial
from itertools import islice
from multiprocessing.connection import Connection
from multiprocessing.connection import wait as wait_for_any
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

from seatrial.campaigns.work import (
    Outcome,
    Outcomes,
    Task,
    TaskFunction,
    Work,
    attempted,
    lost_outcome,
    serial_linear_algebra,
)
from seatrial.core.values import InputError, versions
from seatrial.numerics.workers import worker_count

# Files of a campaign on a machine that does not have them: their contents travel once and lie in a folder there.


@dataclass(frozen=True)
class CarriedFiles:
    """Contents of files by their path from a common folder, with forward slashes."""

    contents: Mapping[str, bytes]

    def unpack(self) -> Path:
        """Write the files to a new temporary folder, which is left to the system, and return it."""
        root = Path(tempfile.mkdtemp(prefix="seatrial-campaign-"))
        for name, content in self.contents.items():
            path = root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        return root

    @property
    def digest(self) -> str:
        """Return the SHA-256 of names and contents."""
        total = hashlib.sha256()
        for name, content in sorted(self.contents.items()):
            total.update(f"{name} {len(content)}\n".encode() + content)
        return total.hexdigest()


def common_folder(files: Sequence[Path]) -> Path:
    """Return the folder below which all files lie."""
    return Path(os.path.commonpath([file.parent for file in files]))


def carried_files(root: Path, files: Sequence[Path]) -> CarriedFiles:
    """Read files below `root`.

    Raises:
        OSError: one cannot be read.
    """
    return CarriedFiles({file.relative_to(root).as_posix(): file.read_bytes() for file in files})


# Tasks on this machine: here, in threads, or in processes of which any may die without more than its task.

MAX_ATTEMPTS = 5
"""How often a task is begun whose process dies: chosen; five deaths in a row are the task's doing, not chance."""
_TASKS_WAITING = 2
"""Tasks handed to the threads beforehand, for each thread: chosen, so that none waits for the caller."""
_EXCEPTION_EXIT_CODE = 1  # of a Python process that ends with an exception
_POLL_S = 0.1  # s between looks at the keyboard


class WorkerKind(StrEnum):
    """Where tasks run: processes suit every task, threads those whose time is spent in compiled code."""

    PROCESSES = "processes"
    THREADS = "threads"


def outcomes_here(function: TaskFunction, tasks: Sequence[Task]) -> Outcomes:
    """Yield the outcomes of tasks done one after the other in the caller's thread."""
    with serial_linear_algebra():
        for task in tasks:
            yield attempted(function, task)


def outcomes_in_threads(function: TaskFunction, tasks: Sequence[Task], workers: int) -> Outcomes:
    """Yield the outcomes of tasks done by threads, as they finish."""
    waiting = iter(tasks)
    pool = ThreadPoolExecutor(workers)
    with serial_linear_algebra():
        try:
            pending = {pool.submit(attempted, function, t) for t in islice(waiting, _TASKS_WAITING * workers)}
            while pending:
                done, pending = wait(pending, timeout=_POLL_S, return_when=FIRST_COMPLETED)
                for future in done:
                    pending |= {pool.submit(attempted, function, t) for t in islice(waiting, 1)}
                    yield future.result()
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


class _Lane:
    """A process that does one task at a time."""

    def __init__(self, function: TaskFunction) -> None:
        context = multiprocessing.get_context("spawn")  # threads of compiled code would not survive a fork
        self.connection, inner = context.Pipe()
        self.process = context.Process(target=_serve, args=(inner, function))
        self.process.start()
        inner.close()
        self.task: Task | None = None

    def assign(self, task: Task) -> None:
        self.task = task
        with suppress(OSError):  # the process has died: seen when its answer is read
            self.connection.send(task)

    def answer(self) -> Outcome | None:
        """The outcome of its task; None where the process has died."""
        try:
            return self.connection.recv()
        except (EOFError, OSError):
            self.process.join()
            return None

    def end(self) -> None:
        self.connection.close()
        self.process.kill()
        self.process.join()


def _serve(connection: Connection, function: TaskFunction) -> None:
    """Do tasks until the other end of the connection is closed, be it because that process has died."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the whole group; the parent decides
    with serial_linear_algebra(), suppress(EOFError, OSError):
        while True:
            connection.send(attempted(function, connection.recv()))


def outcomes_in_processes(function: TaskFunction, tasks: Sequence[Task], workers: int) -> Outcomes:
    """Yield the outcomes of tasks done by processes, as they finish.

    A process that dies (killed, out of memory, a crash of compiled code) is replaced and its task begun again, up to
    `MAX_ATTEMPTS` times; a pool of the standard library would give up all its tasks instead. Function and outcomes
    must pickle.
    """
    waiting, attempts = deque(tasks), dict[bytes, int]()
    lanes = [_Lane(function) for _ in range(min(workers, len(tasks)))]
    try:
        for lane in lanes:
            lane.assign(waiting.popleft())
        while busy := {lane.connection: lane for lane in lanes if lane.task is not None}:
            for connection in wait_for_any(list(busy), timeout=_POLL_S):
                lane = busy[connection]  # type: ignore[index]
                task, outcome = lane.task, lane.answer()
                assert task is not None
                lane.task = None
                if outcome is None:
                    lanes[lanes.index(lane)] = lane = _replaced(lane, function)
                    attempts[task.identity] = attempts.get(task.identity, 0) + 1
                    if attempts[task.identity] < MAX_ATTEMPTS:
                        waiting.appendleft(task)
                    else:
                        outcome = lost_outcome(task, _lost_reason())
                if waiting:
                    lane.assign(waiting.popleft())
                if outcome is not None:
                    yield outcome
    finally:
        for lane in lanes:
            lane.end()


def _replaced(lane: _Lane, function: TaskFunction) -> _Lane:
    """Return a new process in the place of one that has died.

    Raises:
        InputError: it ended with an exception of Python: outside a task, as tasks raise none.
    """
    lane.end()
    if lane.process.exitcode == _EXCEPTION_EXIT_CODE:
        raise InputError(
            "a worker process cannot start; its own message stands above. A script that starts a campaign needs "
            "'if __name__ == \"__main__\":' around the call"
        )
    return _Lane(function)


def _lost_reason() -> str:
    return f"its process ended without a result, {MAX_ATTEMPTS} times in a row (killed, out of memory, or a crash)"


# Tasks on a Dask cluster, which gives them out, moves them off workers that die, and brings their outcomes back.

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
