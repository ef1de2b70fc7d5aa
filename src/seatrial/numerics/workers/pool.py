"""One ordered map: over threads, for kernels that release the interpreter lock, or over processes.

Results come in the order of the items whatever the number of workers, so the same seed gives the same bits.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, ThreadPoolExecutor, wait
from typing import TypeVar

from seatrial.numerics.platform import usable_cores

Item = TypeVar("Item")
Result = TypeVar("Result")
CountReporter = Callable[[int, int], None]

_POLL = 0.1  # s between looks at the keyboard


def worker_count(workers: int | None = None) -> int:
    """`workers` where given, else the cores this process may use.

    Raises:
        ValueError: fewer than one worker.
    """
    if workers is None:
        return usable_cores()
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
    """`[function(item) for item in items]` over threads of this process.

    Args:
        workers: number of threads; None takes the cores, 1 works in the caller's own thread.
        progress: called in the caller's thread with (done, total) after each finished item.
        keep: gets (position, result) of each item as it finishes, so that a map cut short loses nothing.

    Raises:
        KeyboardInterrupt: at once on Ctrl-C; waiting items are dropped, running ones are not waited for.
        Exception: what `function` raised first.
    """
    count = min(worker_count(workers), len(items))
    kept = [] if partial_results is None else partial_results
    if count <= 1:
        return _map_sequentially(function, items, report_progress, kept)
    return _gather(ThreadPoolExecutor(count), function, items, report_progress, kept)


def map_in_processes(
    function: Callable[[Item], Result],
    items: Sequence[Item],
    *,
    workers: int | None = None,
    report_progress: CountReporter | None = None,
    partial_results: list[tuple[int, Result]] | None = None,
) -> list[Result]:
    """`mapped` over processes, for Python code that holds the lock; function, items and results must pickle.

    The processes start afresh (not forked), so that threads of compiled code cannot hang them.
    """
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor

    count = min(worker_count(workers), len(items))
    kept = [] if partial_results is None else partial_results
    if count <= 1:
        return _map_sequentially(function, items, report_progress, kept)
    pool = ProcessPoolExecutor(count, mp_context=multiprocessing.get_context("spawn"))
    return _gather(pool, function, items, report_progress, kept)


def _map_sequentially(
    function: Callable[[Item], Result],
    items: Sequence[Item],
    report_progress: CountReporter | None,
    partial_results: list[tuple[int, Result]],
) -> list[Result]:
    results = []
    for place, item in enumerate(items):
        results.append(function(item))
        partial_results.append((place, results[-1]))
        if report_progress:
            report_progress(place + 1, len(items))
    return results


def _gather(
    pool: Executor,
    function: Callable[[Item], Result],
    items: Sequence[Item],
    report_progress: CountReporter | None,
    partial_results: list[tuple[int, Result]],
) -> list[Result]:
    places = {pool.submit(function, item): place for place, item in enumerate(items)}
    finished: dict[int, Result] = {}
    pending = set(places)
    try:
        while pending:
            done, pending = wait(pending, timeout=_POLL, return_when=FIRST_COMPLETED)
            for future in sorted(done, key=places.__getitem__):
                place = places[future]
                finished[place] = future.result()
                partial_results.append((place, finished[place]))
                if report_progress:
                    report_progress(len(finished), len(items))
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        raise
    pool.shutdown()
    return [finished[place] for place in range(len(items))]
