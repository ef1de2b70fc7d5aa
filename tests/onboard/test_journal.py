"""The journal: everything that was written comes back, a torn end is noticed, what is not its own is refused."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from seatrial.core.results.online import Sample
from seatrial.core.values import InputError
from seatrial.data.read import ColumnSpec, Layout
from seatrial.onboard.journal import Journal, JournalEntry, RunEntry, journal_identity
from seatrial.physics.models import model_named

WRITER = """
import sys, time
from pathlib import Path
import numpy as np
from seatrial.onboard.journal import RunEntry, Journal
from seatrial.core.results.online import Sample
journal = Journal(Path(sys.argv[1]), "a", 3)
list(journal.entries())
journal.append(RunEntry("start"))
for i in range(10**9):
    journal.append(Sample(float(i), np.full(3, 0.5 * i)))
    journal.write_pending()
    if i % 50 == 0:
        print(i, time.monotonic(), flush=True)
        time.sleep(0.001)
"""


def written(path: Path, count: int) -> list[JournalEntry]:
    journal = Journal(path, "a", 2)
    before = list(journal.entries())
    journal.append(RunEntry("the clock jumped, å"))
    for i in range(count):
        journal.append(Sample(0.1 * i, np.array([i, np.nan])))
    journal.close()
    return before


def read(path: Path) -> tuple[list[JournalEntry], int]:
    journal = Journal(path, "a", 2)
    entries = list(journal.entries())
    journal.close()
    return entries, journal.torn_bytes


def contents(entries: list[JournalEntry]) -> list[object]:
    return [(e.time, [repr(v) for v in e.values.tolist()]) if isinstance(e, Sample) else e for e in entries]


def test_what_was_written_comes_back_bit_for_bit_and_is_continued(tmp_path: Path) -> None:
    path = tmp_path / "deep" / "a.journal"
    assert written(path, 5) == []
    first = written(path, 3)
    entries, torn = read(path)
    assert torn == 0
    assert contents(entries[:6]) == contents(first)
    assert contents(entries[6:]) == contents(first[:4])
    assert entries[0] == RunEntry("the clock jumped, å")
    last = entries[-1]
    assert isinstance(last, Sample)
    assert (last.time, last.values[0]) == (0.1 * 2, 2.0)
    assert np.isnan(last.values[1])


@settings(max_examples=20)
@given(cut=st.integers(min_value=1, max_value=400))
def test_wherever_a_break_cuts_whole_entries_stay_and_writing_goes_on(
    tmp_path_factory: pytest.TempPathFactory, cut: int
) -> None:
    path = tmp_path_factory.mktemp("cut") / "a.journal"
    written(path, 12)
    whole, _ = read(path)
    data = path.read_bytes()
    kept = max(len(data) - cut, 0)
    path.write_bytes(data[:kept])
    entries, torn = read(path)
    assert contents(entries) == contents(whole[: len(entries)])
    assert len(entries) >= len(whole) - 1 - cut / 21
    assert torn < 40
    assert contents(written(path, 1)) == contents(entries)
    assert len(read(path)[0]) == len(entries) + 2


@settings(max_examples=20)
@given(place=st.integers(min_value=1, max_value=58), letter=st.integers(min_value=0, max_value=255))
def test_a_last_entry_that_was_garbled_is_cut_off(
    tmp_path_factory: pytest.TempPathFactory, place: int, letter: int
) -> None:
    path = tmp_path_factory.mktemp("garbled") / "a.journal"
    written(path, 12)
    whole, _ = read(path)
    data = bytearray(path.read_bytes())
    same = data[-place] == letter
    data[-place] = letter
    path.write_bytes(bytes(data))
    journal = Journal(path, "a", 2)
    entries = list(journal.entries())
    journal.close()
    assert (
        contents(entries) == contents(whole)
        if same
        else contents(entries) in (contents(whole[:-1]), contents([*whole[:-2], whole[-1]]))
    )
    assert same or journal.torn_bytes > 0 or journal.damaged_places == 1


@settings(max_examples=20)
@given(place=st.integers(min_value=60, max_value=400), damage=st.binary(min_size=1, max_size=40))
def test_damage_in_the_middle_costs_the_entries_it_touches(
    tmp_path_factory: pytest.TempPathFactory, place: int, damage: bytes
) -> None:
    path = tmp_path_factory.mktemp("damaged") / "a.journal"
    written(path, 40)
    whole, _ = read(path)
    data = bytearray(path.read_bytes())
    data[place : place + len(damage)] = damage
    path.write_bytes(bytes(data))
    entries, torn = read(path)
    assert torn == 0 and len(entries) >= len(whole) - 3
    assert set(map(str, contents(entries))) <= set(map(str, contents(whole)))
    assert contents(written(path, 1)) == contents(entries)


def test_a_long_end_without_a_whole_entry_is_no_break(tmp_path: Path) -> None:
    path = tmp_path / "a.journal"
    written(path, 20)
    data = path.read_bytes() + bytes(300_000)
    path.write_bytes(data)
    with pytest.raises(InputError, match="is damaged at byte"):
        read(path)
    assert path.read_bytes() == data


def test_what_is_not_its_own_is_refused_and_left_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "a.journal"
    written(path, 2)
    before = path.read_bytes()
    with pytest.raises(InputError, match="another model or other columns"):
        Journal(path, "b", 2)
    with pytest.raises(InputError, match="another model or other columns"):
        Journal(path, "a", 3)
    other = tmp_path / "log.csv"
    other.write_text("time,u\n0,1\n" * 100)
    with pytest.raises(InputError, match="is not a journal"):
        Journal(other, "a", 2)
    with pytest.raises(InputError, match="is a folder, pipe or device"):
        Journal(tmp_path, "a", 2)
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(InputError, match="is a folder, pipe or device"):
        Journal(tmp_path / "pipe", "a", 2)
    assert path.read_bytes() == before
    assert other.read_text() == "time,u\n0,1\n" * 100


def test_two_writers_are_one_too_many(tmp_path: Path) -> None:
    pytest.importorskip("fcntl", reason="locks of this kind are Unix's")
    journal = Journal(tmp_path / "a.journal", "a", 2)
    with pytest.raises(InputError, match="another process"):
        Journal(tmp_path / "a.journal", "a", 2)
    journal.close()


def test_the_identity_is_that_of_equations_and_columns() -> None:
    column = ColumnSpec("r", "r", "deg/s")
    layout = Layout("text", ColumnSpec("time", "t", "s"), (column,))
    turned = Layout("text", ColumnSpec("time", "t", "s"), (ColumnSpec("r", "r", "deg/s", positive="port"),))
    nomoto = model_named("nomoto")
    known = {journal_identity(m, x) for m in (nomoto, model_named("roll")) for x in (layout, turned)}
    assert len(known) == 4
    assert journal_identity(nomoto, layout) == journal_identity(model_named("nomoto"), layout)


def test_a_full_disk_ends_the_journal_and_not_the_voyage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    journal = Journal(tmp_path / "a.journal", "a", 2)
    monkeypatch.setattr(os, "fsync", full)
    journal.flush()
    journal.append(Sample(0.0, np.zeros(2)))
    journal.close()
    assert "no longer written (No space left on device)" in journal.write_error


def test_kill_9_loses_at_most_the_unflushed_second(tmp_path: Path) -> None:
    path = tmp_path / "a.journal"
    child = subprocess.Popen([sys.executable, "-c", WRITER, str(path)], stdout=subprocess.PIPE, text=True)
    assert child.stdout is not None
    told_at = []
    for line in child.stdout:
        number, at = line.split()
        told_at.append((int(number), float(at)))
        if told_at[-1][1] - told_at[0][1] > 1.3:
            break
    os.kill(child.pid, signal.SIGKILL)
    killed = time.monotonic()
    child.stdout.close()
    child.wait()
    journal = Journal(path, "a", 3)
    entries = [e for e in journal.entries() if isinstance(e, Sample)]
    journal.close()
    assert [e.time for e in entries] == list(range(len(entries)))
    old = max(number for number, at in told_at if at < killed - 1.0)
    assert len(entries) > old
    assert np.array_equal(entries[-1].values, np.full(3, 0.5 * (len(entries) - 1)))
