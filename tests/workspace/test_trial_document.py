"""Edits of the trial file keep its comments, can be undone, and are refused where the file has changed meanwhile."""

import os
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import pytest

from seatrial.core.values import InputError
from seatrial.workspace.trial_document import (
    EditConflictError,
    TrialDocument,
    parsed_document,
    require_readable,
    version_of,
    with_value,
)

TEXT = """# a comment at the top
[ship]
name = "craft"
L = 20    # m, as stated
m = 1.2e4    # ESTIMATED: kg, of a usual hull

[model]
name = "nomoto"    # the simplest with a rudder
free = ["K", "T"]

[[records]]
files = ["a.csv"]    # two logs
time = { column = "t" }
channels.psi = { column = "heading", unit = "deg" }    # by its name
channels.delta = { column = "rudder", unit = "deg" }    # by its name; positive to starboard by the turn
# a comment at the end
"""
SIDE = ("records", 0, "channels", "delta", "positive")


@pytest.fixture
def document(tmp_path: Path) -> TrialDocument:
    path = tmp_path / "trial.toml"
    path.write_text(TEXT, encoding="utf-8")
    return TrialDocument(path)


def changed_lines(before: str, after: str) -> list[str]:
    return [line for line in after.splitlines() if line not in before.splitlines()]


def test_a_value_is_set_and_every_comment_stays() -> None:
    after = with_value(TEXT, SIDE, "port")
    assert changed_lines(TEXT, after) == [
        'channels.delta = { column = "rudder", unit = "deg", positive = "port" }    '
        "# by hand; by its name; positive to starboard by the turn"
    ]
    assert tomllib.loads(after)["records"][0]["channels"]["delta"]["positive"] == "port"
    assert "positive = " not in with_value(after, SIDE, None)


def test_an_estimate_that_is_replaced_is_one_no_longer() -> None:
    after = with_value(TEXT, ("ship", "m"), 11000.0)
    assert changed_lines(TEXT, after) == ["m = 11000.0    # by hand; in place of: kg, of a usual hull"]


@pytest.mark.parametrize("place", [("records", 3, "channels", "r", "unit"), ("ship", "L", "unit")])
def test_a_place_that_is_none_is_refused(place: tuple[str | int, ...]) -> None:
    with pytest.raises(InputError, match="no place"):
        with_value(TEXT, place, "deg")


def test_no_toml_is_refused() -> None:
    with pytest.raises(InputError, match="no valid TOML"):
        parsed_document("[ship")
    with pytest.raises(InputError, match="would be no valid TOML"):
        require_readable(TEXT, "[ship", Path("trial.toml"))


def test_an_edit_is_written_and_undone(document: TrialDocument) -> None:
    change = document.apply(lambda text: with_value(text, SIDE, "port"), document.version, "the rudder's side")
    assert [line[0] for line in change.diff if line[0] in "+-"] == ["-", "+"]
    assert document.path.read_text() == change.after != TEXT
    assert document.undo(document.version).after == document.path.read_text() == TEXT
    with pytest.raises(InputError, match="nothing to undo"):
        document.undo(document.version)


def test_an_edit_of_a_text_that_has_changed_is_refused_and_nothing_is_lost(document: TrialDocument) -> None:
    seen = document.version
    document.apply(lambda text: with_value(text, ("ship", "L"), 21.0), seen, "first window")
    with pytest.raises(EditConflictError) as refusal:
        document.apply(lambda text: with_value(text, SIDE, "port"), seen, "second window")
    assert refusal.value.version == document.version
    since = document.changes_since(seen)
    assert since is not None and any("L = 21" in line for line in since.diff)
    document.apply(lambda text: with_value(text, SIDE, "port"), document.version, "second window")
    tables = tomllib.loads(document.path.read_text())
    assert tables["ship"]["L"] == 21.0 and tables["records"][0]["channels"]["delta"]["positive"] == "port"


def test_a_change_by_another_program_joins_the_history(document: TrialDocument) -> None:
    document.path.write_text(TEXT.replace("L = 20", "L = 25"), encoding="utf-8")
    assert document.version == version_of(document.path.read_text())
    assert [change.summary for change in document.history] == ["changed by another program"]
    assert document.undo(document.version).after == TEXT


def test_a_text_that_is_no_trial_file_is_refused_and_the_file_stays(document: TrialDocument) -> None:
    with pytest.raises(InputError, match="unknown key"):
        document.apply(lambda text: with_value(text, ("estimate", "rat"), 3.0), document.version, "a slip")
    assert document.path.read_text() == TEXT and document.history == ()


WRITER = """
import itertools, sys
from pathlib import Path
from seatrial.workspace.trial_document import TrialDocument, with_value
document = TrialDocument(Path(sys.argv[1]))
for k in itertools.count(1):
    document.apply(lambda text: with_value(text, ("ship", "L"), float(k)), document.version, "longer")
    print(k, flush=True)
"""


@pytest.mark.skipif(os.name != "posix", reason="kill -9")
def test_kill_leaves_the_file_as_of_the_last_edit(document: TrialDocument) -> None:
    process = subprocess.Popen([sys.executable, "-c", WRITER, document.path], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    process.stdout.readline()
    time.sleep(0.2)
    process.send_signal(signal.SIGKILL)
    last = int(process.stdout.read().split()[-1])
    length = tomllib.loads(document.path.read_text())["ship"]["L"]
    assert length in (last, last + 1)
    assert changed_lines(TEXT, document.path.read_text()) == [f"L = {length}    # m, as stated"]
