"""A sample of the fuzzing: every kind of input, in this process; the whole runs as a benchmark."""

from pathlib import Path

import numpy as np
import pytest
from benchmarks.fuzz import CORPUS, finds_of, fuzz, hidden_number, input_of, samples_of, shares
from benchmarks.fuzz_targets import TARGETS

from seatrial.core.values import InputError, Record

# as many inputs of each kind as take a second, by the costs of the targets, between one and so many
_COST_OF_A_SECOND, _MOST = 1000.0, 100
_SLOW = ("identify", "binary", "loop")  # some seconds each: of these one input


@pytest.mark.parametrize("name", TARGETS)
def test_a_damaged_input_is_a_result_or_one_sentence(name: str) -> None:
    samples = samples_of(name)
    count = 1 if name in _SLOW else max(3, min(_MOST, int(_COST_OF_A_SECOND / TARGETS[name].cost)))
    assert [find for index in range(count) for find in finds_of(name, input_of(name, samples, 1, index))] == []


@pytest.mark.parametrize("path", sorted(CORPUS.glob("*/*")), ids=lambda path: path.name[:40])
def test_what_was_found_once_stays_corrected(path: Path) -> None:
    assert finds_of(path.parent.name, path.read_bytes()) == []


def test_the_same_seed_gives_the_same_inputs() -> None:
    samples = samples_of("trial")
    assert input_of("trial", samples, 3, 7) == input_of("trial", samples, 3, 7) != input_of("trial", samples, 4, 7)


def test_each_kind_of_find_is_one(monkeypatch: pytest.MonkeyPatch) -> None:
    def failing(outcome: object) -> list[str]:
        def run(data: bytes, place: Path) -> object:  # noqa: ARG001
            if isinstance(outcome, Exception):
                raise outcome
            return outcome

        monkeypatch.setitem(TARGETS, "gains", type(TARGETS["gains"])(lambda: [b""], run, 1))
        return [kind for kind, _ in finds_of("gains", b"")]

    assert failing(KeyError("a")) == ["traceback"]
    assert failing({"a": [1.0, float("nan")]}) == ["silent number"]
    assert failing(InputError("no; do")) == failing(1.0) == []


def test_a_channel_without_a_number_is_hidden() -> None:
    time = np.arange(3.0)
    assert hidden_number(Record.from_arrays("run", time, {"u": np.full(3, np.nan)})) == "channel u"
    assert hidden_number(Record.from_arrays("run", time, {"u": np.array([1.0, np.nan, 2.0])})) == ""


def test_a_child_process_runs_them_all(tmp_path: Path) -> None:
    tally = fuzz("gains", 3, 1, tmp_path)
    assert (tally.inputs, tally.finds) == (3, {})


def test_cheap_targets_get_more_inputs() -> None:
    counts = shares(10_000, ["manoeuvre", "identify"])
    assert counts["manoeuvre"] > 1000 * counts["identify"] >= 1000 / 10_000
