"""Journals: outcomes come back, a cut costs the last one, what is no journal is refused."""

from pathlib import Path

import pytest

from seatrial.campaigns.store import OutcomeJournal, body_of, read_journal
from seatrial.campaigns.work import Outcome
from seatrial.core.values import InputError

OUTCOMES = [Outcome(bytes([k]) * 32, k == 2, 0.5 * k, b'{"n":%d}' % k) for k in range(5)]


def journal(folder: Path) -> Path:
    one = OutcomeJournal(folder, 0.0)
    for outcome in OUTCOMES:
        one.append(outcome)
    one.close()
    return one.path


def test_outcomes_come_back(tmp_path: Path) -> None:
    entries, damaged_places = read_journal(journal(tmp_path))
    assert damaged_places == 0
    assert [Outcome(e.identity, e.is_failure, e.seconds, body_of(e)) for e in entries] == OUTCOMES


@pytest.mark.parametrize("cut", [1, 40, 60, 250])
def test_a_journal_cut_in_the_middle_gives_what_was_before(tmp_path: Path, cut: int) -> None:
    path = journal(tmp_path)
    path.write_bytes(path.read_bytes()[:-cut])
    entries, _ = read_journal(path)
    assert [body_of(e) for e in entries] == [o.body for o in OUTCOMES[: len(entries)]]
    assert len(entries) >= 4 - cut // 40


def test_damage_in_the_middle_costs_one_outcome_and_is_counted(tmp_path: Path) -> None:
    path = journal(tmp_path)
    content = bytearray(path.read_bytes())
    content[120] ^= 1
    path.write_bytes(content)
    entries, damaged_places = read_journal(path)
    assert damaged_places == 1
    assert len(entries) == 4


def test_an_empty_journal_leaves_no_file(tmp_path: Path) -> None:
    one = OutcomeJournal(tmp_path, 0.0)
    assert read_journal(one.path) == ((), 0)
    one.close()
    assert not one.path.exists()


def test_what_is_no_journal_is_refused(tmp_path: Path) -> None:
    path = journal(tmp_path)
    path.write_bytes(path.read_bytes().replace(b"journal 1", b"journal 2"))
    with pytest.raises(InputError, match="newer version"):
        read_journal(path)
    path.write_bytes(b"something else that is long enough")
    with pytest.raises(InputError, match="no journal of a campaign"):
        read_journal(path)


def test_a_place_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        OutcomeJournal(tmp_path / "file", 0.0)
