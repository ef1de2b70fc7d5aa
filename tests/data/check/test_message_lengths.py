"""No sentence of a check is longer than 400 letters: every kind of fault, planted in a simulated record."""

import pytest
from benchmarks.fault_kinds import KINDS, FaultKind
from benchmarks.planted_faults import simulated

from seatrial.core.values import InputError, Record
from seatrial.data.check import examine

LONGEST = 400  # letters of a line that is read as one sentence: required


def sentences(record: Record) -> list[str]:
    """What is printed of the findings, a line each; or why the record is refused."""
    try:
        findings = examine(record)
    except InputError as error:
        return [str(error)]
    return [text for one in findings for text in (one.text, one.consequence, one.advice)]


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_what_a_check_says_of_a_fault_is_short(kind: FaultKind, rng) -> None:
    record = simulated("tanker", 3).rows(slice(0, 1500)).renamed("20240513_zigzag_20_20_starboard_second L 7.0")
    texts = sentences(kind.spoil(record, rng))
    assert max(map(len, texts)) <= LONGEST, max(texts, key=len)
