"""Ordered maps over threads or processes, independent of their number."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, ThreadPoolExecutor, wait
from contextlib import contextmanager
from typing import TypeVar

from seatrial.numerics.platform import usable_cores

__all__ = ["limited_workers", "map_in_processes", "map_in_threads", "worker_count"]


Item = TypeVar("Item")
Result = TypeVar("Result")
CountReporter = Callable[[int, int], None]

_POLL = 0.1  # s between looks at the keyboard


_LIMITS = list[int]()
"""Largest number of workers that is taken where none is given, of each `limited_workers` that is active."""


@contextmanager
def limited_workers(count: int) -> Iterator[None]:
    """Let at most `count` workers be taken where no number is given, in all threads of this process."""
    _LIMITS.append(count)
    try:
        yield
    finally:
        _LIMITS.remove(count)


def worker_count(workers: int | None = None) -> int:
    """Return `workers` where given, else the number of cores this process may use, or the limit if that is lower.

    Raises:
        ValueError: fewer than one worker.
    """
    if workers is None:
        return min([usable_cores(), *_LIMITS])
    if workers < 1:
        raise ValueError(f"{workers} workers cannot do anything; give at least one, or None for all cores")
    return workers


def map_in_threads(
    function: Callable[[Item], Result],
    items: Sequence[Item],
    *,
    workers: int | None = None,
    report_progress: CountReporter | None = None,
    partial_results: list[tuple[int, Result]] | None = None,
) -> list[Result]:
    """Return `[function(item) for item in items]`, worked out by threads of this process.

    Args:
        workers: number of threads; None takes the cores, 1 works in the caller's own thread.
        report_progress: called in the caller's thread with (done, total) after each finished item.
        partial_results: gets (position, result) of each item as it finishes, so that a map cut short loses nothing.

    Raises:
        KeyboardInterrupt: at once on Ctrl-C; waiting items are dropped, running ones are not waited for.
        Exception: what `function` raised first.
    """
    return _ordered_map(ThreadPoolExecutor, function, items, workers, report_progress, partial_results)


def map_in_processes(
    function: Callable[[Item], Result],
    items: Sequence[Item],
    *,
    workers: int | None = None,
    report_progress: CountReporter | None = None,
    partial_results: list[tuple[int, Result]] | None = None,
) -> list[Result]:
    """Return what `map_in_threads` does, from processes: for Python code that holds the lock.

    Function, items and results must pickle. The processes start afresh (not forked), so that threads of compiled code
    cannot hang them.
    """
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor

    def spawn(count: int) -> Executor:
        return ProcessPoolExecutor(count, mp_context=multiprocessing.get_context("spawn"))

    return _ordered_map(spawn, function, items, workers, report_progress, partial_results)


def _ordered_map(
    make_pool: Callable[[int], Executor], function: Callable[[Item], Result], items: Sequence[Item],
    workers: int | None, report_progress: CountReporter | None, partial_results: list[tuple[int, Result]] | None,
) -> list[Result]:  # fmt: skip
    finished: dict[int, Result] = {}

    def keep(place: int, result: Result) -> None:
        finished[place] = result
        if partial_results is not None:
            partial_results.append((place, result))
        if report_progress:
            report_progress(len(finished), len(items))

    count = min(worker_count(workers), len(items))
    if count <= 1:
        for place, item in enumerate(items):
            keep(place, function(item))
        return list(finished.values())
    pool = make_pool(count)
    places = {pool.submit(function, item): place for place, item in enumerate(items)}
    pending = set(places)
    try:
        while pending:
            done, pending = wait(pending, timeout=_POLL, return_when=FIRST_COMPLETED)
            for future in sorted(done, key=places.__getitem__):
                keep(places[future], future.result())
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        raise
    pool.shutdown()
    return [finished[place] for place in range(len(items))]
