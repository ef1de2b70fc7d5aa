"""Tasks on this machine: here, in threads, or in processes of which any may die without more than its task."""

import multiprocessing
import signal
from collections import deque
from collections.abc import Sequence
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from contextlib import suppress
from enum import StrEnum
from itertools import islice
from multiprocessing.connection import Connection
from multiprocessing.connection import wait as wait_for_any

from seatrial.campaigns.machine import serial_linear_algebra
from seatrial.campaigns.outcome import Outcome, Outcomes, attempted, lost_outcome
from seatrial.campaigns.work import Task, TaskFunction
from seatrial.core.values import InputError

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
