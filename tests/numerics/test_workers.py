"""The ordered map: order, progress, errors, interruption."""

import math
import threading
import time

import pytest

from seatrial.numerics.workers import limited_workers, map_in_processes, map_in_threads, worker_count


def slow_square(x: float) -> float:
    time.sleep(0.002 * (7 - x % 7))
    return x * x


@pytest.mark.parametrize("workers", [1, 2, 5, None])
def test_results_come_in_the_order_of_the_items(workers: int | None) -> None:
    assert map_in_threads(slow_square, range(20), workers=workers) == [x * x for x in range(20)]


def test_processes_give_the_same() -> None:
    assert map_in_processes(math.factorial, [5, 3, 8], workers=2) == [120, 6, 40320]


def test_no_items_give_no_results() -> None:
    assert map_in_threads(slow_square, []) == []
    assert map_in_processes(slow_square, []) == []


@pytest.mark.parametrize("workers", [1, 3])
def test_progress_counts_every_item_in_the_callers_thread(workers: int) -> None:
    seen: list[tuple[int, int, str]] = []

    def progress(done: int, total: int) -> None:
        seen.append((done, total, threading.current_thread().name))

    map_in_threads(slow_square, range(6), workers=workers, report_progress=progress)
    assert [s[:2] for s in seen] == [(i, 6) for i in range(1, 7)]
    assert {s[2] for s in seen} == {threading.current_thread().name}


@pytest.mark.parametrize("workers", [1, 2])
def test_an_error_is_raised_as_it_is(workers: int) -> None:
    def reciprocal(x: int) -> float:
        return 1 / x

    with pytest.raises(ZeroDivisionError):
        map_in_threads(reciprocal, [1, 2, 0, 4], workers=workers)


@pytest.mark.parametrize("workers", [1, 2])
def test_an_interrupt_returns_promptly_and_keeps_what_was_finished(workers: int) -> None:
    keep: list[tuple[int, float]] = []

    def work(x: float) -> float:
        time.sleep(0.01)
        return 2 * x

    def interrupt(done: int, _total: int) -> None:
        if done == 3:
            raise KeyboardInterrupt

    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        map_in_threads(work, range(1000), workers=workers, report_progress=interrupt, partial_results=keep)
    assert time.monotonic() - began < 2.0
    assert len(keep) >= 3
    assert all(result == 2 * place for place, result in keep)


def test_worker_count_refuses_none_at_all() -> None:
    assert worker_count() >= 1
    with pytest.raises(ValueError, match="at least one"):
        worker_count(0)


def test_a_limit_holds_where_no_number_is_given_and_ends() -> None:
    cores = worker_count()
    with limited_workers(1), limited_workers(2):
        assert worker_count() == 1
        assert worker_count(3) == 3
    assert worker_count() == cores
