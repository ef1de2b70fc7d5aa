"""What passes is in order and counted to the last sample; a broken clock begins a run, a wrong stamp does not."""

import math
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.core.results.online import Sample, SampleCounts
from seatrial.onboard.stream_session import RunStart, SampleOrder, StreamEvent, combined_counts

TIMES = st.lists(
    st.one_of(
        st.integers(0, 60).map(lambda k: k / 2),
        st.floats(allow_nan=True, allow_infinity=True),
        st.integers(1000, 1060).map(float),
    ),
    max_size=60,
)


def at(time: float, *values: float) -> Sample:
    return Sample(time, np.array(values or (1.0,)))


def passed(gate: SampleOrder, times: list[float]) -> list[StreamEvent]:
    events = [event for time in times for event in gate.admit(at(time))]
    gate.drop_suspect()
    return events


def runs(events: list[StreamEvent]) -> list[list[float]]:
    found: list[list[float]] = []
    for event in events:
        if isinstance(event, RunStart):
            found.append([])
        else:
            found[-1].append(event.time)
    return found


@given(TIMES, st.sampled_from([None, 0.5]))
def test_order_and_sum(times: list[float], dt: float | None) -> None:
    gate = SampleOrder(dt, 10.0)
    found = runs(passed(gate, times))
    counts = gate.counts
    for run in found:
        steps = np.diff(run)
        assert run and np.all(steps > 0) and np.all(steps <= 10.0)
    assert counts.accepted == sum(map(len, found))
    assert counts.accepted + counts.late + counts.repeated + counts.garbled == len(times)
    assert counts.jumps == max(len(found) - 1, 0)


@given(st.lists(st.integers(0, 200), unique=True, max_size=80))
def test_what_comes_in_order_passes_in_order(ticks: list[int]) -> None:
    times = [0.1 * k for k in sorted(ticks)]
    gate = SampleOrder(0.1, 100.0)
    assert [t for run in runs(passed(gate, times)) for t in run] == times
    expected = 0 if not ticks else max(ticks) - min(ticks) + 1 - len(ticks)
    assert gate.counts.missing == expected
    assert gate.counts == SampleCounts(accepted=len(times), missing=expected)


def test_late_and_repeated_samples_are_dropped() -> None:
    gate = SampleOrder(1.0, 10.0)
    assert runs(passed(gate, [0, 1, 2, 2, 1.5, 3, 2.0000001, 3.0000001, 4])) == [[0, 1, 2, 3, 4]]
    assert (gate.counts.late, gate.counts.repeated) == (2, 2)


@pytest.mark.parametrize("start", [500.0, -500.0, 13.5, -4.0])
def test_a_clock_that_jumps_begins_a_run_and_loses_nothing(start: float) -> None:
    gate = SampleOrder(0.5, 10.0)
    new = [start + 0.5 * k for k in range(4)]
    assert runs(passed(gate, [0.0, 1.0, 2.0, 3.0, *new])) == [[0.0, 1.0, 2.0, 3.0], new]
    assert gate.counts.jumps == 1 and gate.counts.late == 0


@pytest.mark.parametrize(("wrong", "kind"), [(1e9, "garbled"), (-1e9, "late"), (math.nan, "garbled")])
def test_one_wrong_stamp_begins_no_run(wrong: float, kind: str) -> None:
    gate = SampleOrder(1.0, 10.0)
    assert runs(passed(gate, [0, 1, 2, wrong, 3, 4])) == [[0, 1, 2, 3, 4]]
    assert gate.counts.jumps == 0 and getattr(gate.counts, kind) == 1 and gate.counts.last_problem


def test_a_wrong_first_stamp_costs_one_sample() -> None:
    gate = SampleOrder(1.0, 10.0)
    assert runs(passed(gate, [1e9, 0, 1, 2])) == [[1e9], [0, 1, 2]]


def test_the_step_is_the_median_of_the_first_twenty() -> None:
    gate = SampleOrder(None, 10.0)
    times = [k / 4 for k in range(30) if k not in (3, 4, 26)]
    passed(gate, times)
    assert gate.dt == 0.25 and gate.counts.missing == 3


def test_what_is_not_finite_is_counted_and_becomes_nan() -> None:
    gate = SampleOrder(1.0, 10.0)
    gate.admit(at(0.0, 1.0, math.nan))
    (found,) = gate.admit(at(1.0, math.inf, 2.0))
    assert isinstance(found, Sample)
    np.testing.assert_array_equal(found.values, [math.nan, 2.0])
    assert (gate.counts.accepted, gate.counts.not_finite) == (2, 2)


def test_the_first_event_says_that_a_run_begins() -> None:
    begun, first = SampleOrder(1.0, 10.0).admit(at(7.0))
    assert isinstance(begun, RunStart) and begun.time == 7.0
    assert isinstance(first, Sample) and first.time == 7.0


def test_memory_does_not_grow() -> None:
    gate = SampleOrder(None, 10.0)
    rng = np.random.default_rng(1)
    sizes = []
    for time in np.cumsum(rng.choice([0.1, 0.1, 0.1, 0.0, -1.0, 50.0, math.nan], 20000, p=[0.3] * 3 + [0.025] * 4)):
        gate.admit(at(float(time)))
        sizes.append(sum(sys.getsizeof(part) for part in vars(gate).values()))
    assert max(sizes[1000:]) <= max(sizes[:1000])


@given(st.lists(st.integers(0, 9), min_size=20, max_size=20))
def test_counts_are_added(numbers: list[int]) -> None:
    one, other = SampleCounts(*numbers[:10], last_problem="a"), SampleCounts(*numbers[10:])
    both = combined_counts(one, other)
    names = [name for name in vars(one) if name != "last_problem"]
    assert [getattr(both, n) for n in names] == [getattr(one, n) + getattr(other, n) for n in names]
    assert both.last_problem == "a" and combined_counts(other, other).last_problem == ""
