"""A sample of the matrix of planted faults: one simulated record, every other kind; the whole runs as a benchmark."""

import pytest
from benchmarks.fault_kinds import KINDS, UNDETECTABLE, FaultKind
from benchmarks.planted_faults import alarms, outcome, simulated, thruster_outcomes


@pytest.mark.long(every=2)
@pytest.mark.parametrize("kind", KINDS[1::2], ids=lambda kind: kind.name)
def test_a_planted_fault_is_found_by_its_cause(kind: FaultKind) -> None:
    assert outcome(kind, "tanker", 5, simulated("tanker", 5)).is_found


@pytest.mark.parametrize("craft", ["tanker", "waterjet"])
def test_unspoilt_records_and_their_symmetries_raise_no_alarm(craft: str) -> None:
    record = simulated(craft, 5)
    assert alarms(record) == frozenset()
    for symmetry in UNDETECTABLE.values():
        assert alarms(symmetry(record)) == frozenset()


def test_sides_of_thrusters_are_found() -> None:
    assert all(one.is_found for one in thruster_outcomes([5]))
