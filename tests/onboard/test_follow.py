"""The loop: what comes in is used once, in order, whatever comes between; a break loses nothing that was written."""

import os
import signal
import socket
import subprocess
import sys
import threading
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.fits import example_fit
from tests.onboard.streams import (
    EXAMPLES,
    LINES,
    ListSource,
    RecordingEstimator,
    accepted_count,
    fit_json_without_time,
    sample_range,
    stream_trial,
)

from seatrial.core.results.online import Sample, SampleCounts, Snapshot
from seatrial.core.values import InputError
from seatrial.data.trial import Role, RunFiles, Trial, load_trial
from seatrial.data.trial.runs import require_stream
from seatrial.data.trial.trial import Run
from seatrial.estimation.identify import identify
from seatrial.onboard.columns import ColumnReader
from seatrial.onboard.follow import follow
from seatrial.onboard.lines import TailLines, UdpLines
from seatrial.onboard.proposer import check_required_channels
from seatrial.onboard.sources import LineSampleSource

FOLLOWER = """
import sys
from pathlib import Path
from tests.onboard.streams import RecordingEstimator, stream_trial
from seatrial.onboard.follow import follow
follow(stream_trial(Path(sys.argv[1])), journal=Path(sys.argv[2]), estimator=RecordingEstimator())
"""


@pytest.fixture
def in_a_hurry(monkeypatch: pytest.MonkeyPatch) -> None:
    """Waits and looks twenty times as often."""
    monkeypatch.setattr("seatrial.onboard.follow._DISPLAY_INTERVAL_S", 0.02)
    monkeypatch.setattr("seatrial.onboard.follow._POLL_WAIT_S", 0.01)


def identified(trial: Trial, file: Path) -> dict:
    """What identify says where the file stands under [[records]] in place of [follow]."""
    stream = require_stream(trial)
    run = Run(RunFiles.of_file(file, stream.layout), waves=stream.waves)
    others = tuple(r for r in trial.runs if r.role is not Role.TRAIN)
    return fit_json_without_time(
        identify(replace(trial, stream=None, runs=(*trial.runs_with_role(Role.TRAIN), run, *others)))
    )


def test_followed_to_its_end_the_fit_is_that_of_identify_bit_for_bit() -> None:
    trial = load_trial(EXAMPLES / "heave_pitch_follow.toml")
    outcome = follow(trial, once=True)
    file = require_stream(trial).file
    assert file is not None
    assert fit_json_without_time(outcome.fit) == identified(trial, file)
    assert accepted_count(outcome) == len(LINES) - 1
    fit, snapshot = outcome.fit, outcome.snapshot
    assert fit is not None and snapshot is not None
    free = [c for c in fit.coefficients if not c.fixed]
    away = [(v - c.estimate) / c.standard_error for v, c in zip(snapshot.value, free, strict=True)]  # type: ignore[operator]
    assert np.max(np.abs(away)) < 0.5


def test_a_garbled_file_gives_what_the_clean_one_gives(tmp_path: Path) -> None:
    garbled, mended = tmp_path / "voyage_1.csv", tmp_path / "clean" / "voyage_1.csv"
    noise = [b"\x00\xff\xfe\n", b"nonsense\n", b"\n", b",,,,\n", b"1,2,3,4,5,6,7\n", b"x" * 9000 + b"\n"]
    lines = [line.encode() for line in LINES]
    places = range(1450, 10, -97)
    for i, place in enumerate(places):
        lines[place:place] = [noise[i % len(noise)], lines[place - 3]]
    garbled.write_bytes(b"".join(lines))
    mended.parent.mkdir()
    mended.write_text("".join(LINES), encoding="utf-8")
    outcome = follow(stream_trial(garbled), once=True)
    assert fit_json_without_time(outcome.fit) == identified(stream_trial(garbled), mended)
    counts = outcome.counts
    assert counts.accepted == len(LINES) - 1
    assert counts.garbled + counts.dropped == len(places) - sum(i % len(noise) == 2 for i in range(len(places)))
    assert counts.late == len(places)
    assert (counts.jumps, counts.missing) == (0, 0)


@pytest.mark.usefixtures("in_a_hurry")
def test_a_file_truncated_while_it_is_read_is_read_on_from_its_start(tmp_path: Path) -> None:
    file, notes = tmp_path / "log.csv", RecordingEstimator()
    file.write_text("".join(LINES[:301]))
    steps = iter(range(100))

    def stop() -> bool:
        step = next(steps)
        if step == 5:
            file.write_text(LINES[0] + "".join(LINES[301:331]))
        if step == 10:
            with file.open("a") as log:
                log.write("".join(LINES[331:401]))
        return len(notes.values) >= 400 or step > 90

    outcome = follow(stream_trial(file), estimator=notes, stop=stop)
    assert notes.runs == [pytest.approx([0.1 * i for i in range(400)])]
    assert outcome.counts.truncated == 1
    assert outcome.fit is None


def test_a_flood_is_dropped_and_counted_and_the_loop_goes_on() -> None:
    trial = stream_trial()
    layout = replace(require_stream(trial).layout, header_lines=0)
    columns = tuple(replace(c, source=i + 2) for i, c in enumerate(layout.columns))
    layout = replace(layout, time=replace(layout.time, source=1), columns=columns)
    source, notes = LineSampleSource(UdpLines(0, rate=10.0), ColumnReader(layout)), RecordingEstimator()
    port = source._lines.port  # type: ignore[attr-defined]
    over = threading.Event()

    def flood() -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for i in range(100_000):
                sender.sendto(f"{0.1 * i:.1f},1,2,3,4\n".encode(), ("127.0.0.1", port))
                sender.sendto(os.urandom(40), ("127.0.0.1", port))
                if over.wait(0.001):
                    return

    thread = threading.Thread(target=flood)
    began = time.monotonic()
    thread.start()
    outcome = follow(trial, source=source, estimator=notes, stop=lambda: time.monotonic() - began > 1.2)
    over.set()
    thread.join()
    source.close()
    assert outcome.counts.dropped > 500
    assert 10 < len(notes.values) <= 5 * 10 * 3
    assert time.monotonic() - began < 3.0


def test_kill_9_and_a_restart_are_as_one_voyage(tmp_path: Path) -> None:
    file, journal = tmp_path / "voyage_1.csv", tmp_path / "a.journal"
    file.write_text("".join(LINES[:901]))
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    child = subprocess.Popen([sys.executable, "-c", FOLLOWER, str(file), str(journal)], env=environment)
    patience = time.monotonic() + 30.0
    while time.monotonic() < patience and not (journal.exists() and journal.stat().st_size > 900 * 40):
        time.sleep(0.02)
    os.kill(child.pid, signal.SIGKILL)
    child.wait()
    assert journal.stat().st_size > 900 * 40
    with journal.open("ab") as torn:
        torn.write(b"S half an entry")
    file.write_text("".join(LINES))
    notes, uninterrupted = RecordingEstimator(), RecordingEstimator()
    outcome = follow(stream_trial(file), once=True, journal=journal, estimator=notes)
    whole = follow(stream_trial(file), once=True, estimator=uninterrupted)
    assert fit_json_without_time(outcome.fit) == fit_json_without_time(whole.fit)
    assert notes.runs == uninterrupted.runs
    assert np.array_equal(notes.values, uninterrupted.values, equal_nan=True)
    assert outcome.counts == whole.counts
    assert outcome.messages == ("the last 15 bytes of 'a.journal' were incomplete after a break and were cut off",)
    again = RecordingEstimator()
    follow(stream_trial(file), once=True, journal=journal, estimator=again)
    assert again.runs == uninterrupted.runs


def test_the_own_estimate_after_a_restart_is_the_uninterrupted_one_bit_for_bit(tmp_path: Path) -> None:
    file, journal = tmp_path / "log.csv", tmp_path / "a.journal"
    file.write_text("".join(LINES[:701]))
    source = LineSampleSource(TailLines(file, once=True), ColumnReader(require_stream(stream_trial()).layout))
    follow(stream_trial(file), source=source, journal=journal)
    source.close()
    file.write_text("".join(LINES))
    ends: list[Snapshot] = []
    for place in (journal, None):
        outcome = follow(stream_trial(file), once=True, journal=place)
        assert outcome.snapshot is not None
        ends.append(outcome.snapshot)
    assert np.array_equal(ends[0].value, ends[1].value)
    assert np.array_equal(ends[0].standard_error, ends[1].standard_error)
    assert (ends[0].samples, ends[0].runs) == (ends[1].samples, ends[1].runs) == (len(LINES) - 1, 1)


@pytest.mark.usefixtures("in_a_hurry")
@pytest.mark.parametrize("cut", [0, 30, 47, 900])
def test_whatever_of_the_journal_is_left_the_file_gives_the_rest(tmp_path: Path, cut: int) -> None:
    file, journal = tmp_path / "log.csv", tmp_path / "a.journal"
    jumped = [line.replace(line.split(",")[0], f"{1000 + 0.1 * i:.1f}", 1) for i, line in enumerate(LINES[101:201])]
    file.write_text("".join([*LINES[:101], *jumped[:3]]))
    first = RecordingEstimator()
    follow(stream_trial(file), journal=journal, estimator=first, stop=lambda: len(first.values) >= 103)
    assert [len(run) for run in first.runs] == [100, 3]
    data = journal.read_bytes()
    journal.write_bytes(data[: len(data) - cut])
    file.write_text("".join([*LINES[:101], *jumped]))
    notes, whole = RecordingEstimator(), RecordingEstimator()
    resumed = follow(stream_trial(file), journal=journal, estimator=notes, stop=lambda: len(notes.values) >= 200)
    unbroken = follow(stream_trial(file), estimator=whole, stop=lambda: len(whole.values) >= 200)
    assert notes.runs == whole.runs
    assert resumed.counts == unbroken.counts


@pytest.mark.usefixtures("in_a_hurry")
def test_another_file_under_the_same_name_begins_a_run_and_so_does_a_break_of_a_stream(tmp_path: Path) -> None:
    file, journal = tmp_path / "log.csv", tmp_path / "a.journal"
    file.write_text("".join(LINES[:51]))
    first = RecordingEstimator()
    follow(stream_trial(file), journal=journal, estimator=first, stop=lambda: len(first.values) >= 50)
    file.write_text(LINES[0] + "".join(LINES[101:151]))
    second = RecordingEstimator()
    follow(stream_trial(file), journal=journal, estimator=second, stop=lambda: len(second.values) >= 100)
    assert [len(run) for run in second.runs] == [50, 50]
    third = RecordingEstimator()
    follow(stream_trial(file), source=ListSource(sample_range(151, 161)), journal=journal, estimator=third)
    assert [len(run) for run in third.runs] == [50, 50, 10]
    fourth = RecordingEstimator()
    follow(stream_trial(file), source=ListSource([]), journal=journal, estimator=fourth)
    assert fourth.runs == third.runs


def test_the_end_may_be_asked_for_while_the_journal_is_taken_in(tmp_path: Path) -> None:
    journal = tmp_path / "a.journal"
    follow(stream_trial(), source=ListSource(sample_range(0, 500)), journal=journal, estimator=RecordingEstimator())
    before = journal.read_bytes()
    ended = follow(
        stream_trial(),
        source=ListSource(sample_range(500, 510)),
        journal=journal,
        estimator=RecordingEstimator(),
        stop=lambda: True,
    )
    assert accepted_count(ended) < 500
    assert journal.read_bytes() == before


def test_a_socket_is_read_on_while_a_search_takes_its_time(tmp_path: Path) -> None:
    class Slow(RecordingEstimator):
        def update(self, sample: Sample) -> Snapshot:
            time.sleep(0.11)
            assert journal.stat().st_size > 45 * min(5 * (len(self.values) + 1), 20)
            return super().update(sample)

    journal, notes = tmp_path / "a.journal", Slow()
    polls = [sample_range(5 * i, 5 * i + 5) for i in range(4)]
    follow(stream_trial(), source=ListSource(*polls), journal=journal, estimator=notes)
    assert len(notes.values) == 20


def test_what_comes_while_a_journal_is_read_back_is_noted_before_it_is_processed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("seatrial.onboard.follow._PROCESSING_S", 0.0)
    journal = tmp_path / "a.journal"
    follow(stream_trial(), source=ListSource(sample_range(0, 20)), journal=journal, estimator=RecordingEstimator())
    before = journal.stat().st_size

    class Killed(RecordingEstimator):
        def update(self, sample: Sample) -> Snapshot:
            if len(self.values) == 10:
                raise KeyboardInterrupt  # in the middle of the old journal
            return super().update(sample)

    follow(stream_trial(), source=ListSource(sample_range(30, 35)), journal=journal, estimator=Killed())
    assert journal.stat().st_size > before + 5 * 45  # bytes of an entry, at least
    again = RecordingEstimator()
    follow(stream_trial(), source=ListSource(), journal=journal, estimator=again)
    assert len(again.values) == 25


def test_what_comes_while_a_journal_is_taken_in_is_not_lost(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("seatrial.onboard.follow._PROCESSING_S", 0.0)
    journal, notes = tmp_path / "a.journal", RecordingEstimator()
    follow(stream_trial(), source=ListSource(sample_range(0, 20)), journal=journal, estimator=RecordingEstimator())
    follow(
        stream_trial(),
        source=ListSource(sample_range(30, 35), sample_range(35, 40), sample_range(40, 45)),
        journal=journal,
        estimator=notes,
    )
    assert [len(run) for run in notes.runs] == [20, 15]


def test_a_journal_of_another_trial_is_refused_before_anything_starts(tmp_path: Path) -> None:
    journal = tmp_path / "a.journal"
    follow(stream_trial(), source=ListSource(sample_range(0, 5)), journal=journal, estimator=RecordingEstimator())
    trial = stream_trial()
    layout = require_stream(trial).layout
    turned = replace(layout, columns=(*layout.columns[:-1], replace(layout.columns[-1], positive="bow down")))
    other, notes = replace(trial, stream=replace(require_stream(trial), layout=turned)), RecordingEstimator()
    with pytest.raises(InputError, match="another model or other columns"):
        follow(other, source=ListSource(sample_range(0, 5)), journal=journal, estimator=notes)
    assert notes.runs == []


def test_ctrl_c_ends_it_with_what_is_known(tmp_path: Path) -> None:
    journal, source = tmp_path / "a.journal", ListSource(sample_range(0, 5), None, sample_range(5, 10))
    outcome = follow(stream_trial(), source=source, once=True, journal=journal, estimator=RecordingEstimator())
    assert outcome.fit is None
    assert outcome.snapshot is not None
    assert outcome.snapshot.samples == 5
    assert not source.is_closed
    notes = RecordingEstimator()
    follow(stream_trial(), source=ListSource([]), journal=journal, estimator=notes)
    assert [len(run) for run in notes.runs] == [5]


def test_what_the_estimator_refuses_is_said_and_the_next_sample_is_taken() -> None:
    class Choosy(RecordingEstimator):
        def update(self, sample: Sample) -> Snapshot:
            if sample.values[0] == 3:
                raise InputError("the motion leaves all bounds")
            return super().update(sample)

    notes = Choosy()
    outcome = follow(stream_trial(), source=ListSource(sample_range(0, 3), sample_range(3, 8)), estimator=notes)
    assert len(notes.values) == 7
    assert outcome.messages == ("the motion leaves all bounds",)
    assert outcome.counts.last_problem == "t = 0.3 s: the motion leaves all bounds"


def test_a_look_is_given_twice_a_second_at_most_and_at_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [0.0]

    def clock() -> float:
        now[0] += 0.001
        return now[0]

    monkeypatch.setattr("seatrial.onboard.follow.monotonic", clock)
    seen: list[tuple[float, int]] = []

    def show(snapshot: Snapshot, counts: SampleCounts) -> None:
        assert counts.accepted >= snapshot.samples
        seen.append((now[0], snapshot.samples))

    source = ListSource(*[sample_range(100 * i, 100 * i + 100) for i in range(30)])
    follow(stream_trial(), source=source, estimator=RecordingEstimator(), show=show)
    moments = [at for at, _ in seen[:-1]]
    assert len(seen) > 4
    assert np.min(np.diff(moments)) >= 0.5
    assert seen[-1][1] == 3000


def test_training_runs_come_first_and_runs_held_out_last() -> None:
    trial = load_trial(EXAMPLES / "heave_pitch.toml")
    stream = require_stream(load_trial(EXAMPLES / "heave_pitch_follow.toml"))
    runs = tuple(run for run in trial.runs if run.name != "voyage_1")
    both = follow(replace(trial, runs=runs, stream=stream), once=True, estimator=RecordingEstimator())
    assert both.fit is not None
    assert [record.name for record in both.fit.records] == ["voyage_2", "voyage_1", "voyage_held_out"]
    alone = example_fit("heave_pitch")
    pairs = zip(both.fit.coefficients, alone.coefficients, strict=True)
    assert all(a.estimate == pytest.approx(b.estimate, rel=1e-6) for a, b in pairs)


@pytest.mark.parametrize(
    ("example", "without", "says"),
    [
        ("waterjet_follow", ("v_j", "u", "x0"), r"needs: v_j, u; add them to \[follow.channels\]"),
        ("waterjet_follow", ("v_j", "delta", "psi", "r"), "needs: delta, v_j, r, psi"),
        ("heave_pitch_follow", ("zeta", "z"), r"needs: zeta \(or F3 and M5\), z"),
    ],
)
def test_channels_that_are_lacking_are_named_before_anything_starts(
    example: str, without: tuple[str, ...], says: str
) -> None:
    trial = load_trial(EXAMPLES / f"{example}.toml")
    layout = require_stream(trial).layout
    kept = replace(layout, columns=tuple(c for c in layout.columns if c.symbol not in without))
    notes = RecordingEstimator()
    with pytest.raises(InputError, match=says):
        follow(
            replace(trial, stream=replace(require_stream(trial), layout=kept)), source=ListSource([]), estimator=notes
        )
    assert notes.runs == []


@pytest.mark.parametrize("example", ["heave_pitch_follow", "waterjet_follow"])
def test_the_examples_lack_nothing(example: str) -> None:
    check_required_channels(load_trial(EXAMPLES / f"{example}.toml"))


def test_a_file_that_is_a_run_of_the_records_already_is_not_used_twice() -> None:
    trial = load_trial(EXAMPLES / "heave_pitch.toml")
    stream = require_stream(load_trial(EXAMPLES / "heave_pitch_follow.toml"))
    with pytest.raises(InputError, match=r"voyage_1\.csv is named under"):
        follow(replace(trial, stream=stream), source=ListSource([]), estimator=RecordingEstimator())
