"""`seatrial open` says where the workspace is, ends with its terminal, and names what it lacks in one line."""

import contextlib
import http.client
import re
import signal
import subprocess
import sys
import threading
import time
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.workspace.logs import at_address, write_trial

from seatrial.core.values import InputError
from seatrial.workspace import serve_workspace


def test_it_serves_until_it_is_interrupted_and_leaves_no_command_behind(tmp_path: Path) -> None:
    write_trial(tmp_path)
    before = (tmp_path / "trial.toml").read_bytes()
    command = [sys.executable, "-m", "seatrial", "open", str(tmp_path), "--no-browser"]
    # a suite in the background of a shell ignores interrupts, which a command that it starts would, too
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    signal.signal(signal.SIGINT, handler)
    assert process.stdout is not None and process.stderr is not None
    address = re.search(r"http://127\.0\.0\.1:\d+/\?token=\S{20,}", process.stdout.readline())
    assert address is not None
    process.send_signal(signal.SIGINT)
    began = time.monotonic()
    assert process.wait(20.0) == 130
    assert time.monotonic() - began < 10.0 and "interrupted" in process.stderr.read()
    assert (tmp_path / "trial.toml").read_bytes() == before


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="a system without SIGKILL")
def test_a_killed_workspace_leaves_the_trial_file_as_of_the_last_edit(tmp_path: Path) -> None:
    trial = write_trial(tmp_path)
    command = [sys.executable, "-m", "seatrial", "open", str(tmp_path), "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        assert process.stdout is not None
        address = re.search(r"http://\S+", process.stdout.readline())
        assert address is not None
        page, answered = at_address(address[0]), 0
        version = page.ask("state")[1]["version"]
        killer = threading.Timer(1.5, process.kill)  # in the middle of an edit, or between two
        killer.start()
        with contextlib.suppress(OSError, http.client.HTTPException):
            while True:
                edit = {"kind": "set", "place": ["ship", "L"], "value": 20.0 + answered + 1, "version": version}
                status, answer = page.ask("edit", edit)
                assert status == 200
                version, answered = answer["version"], answered + 1
        assert process.wait(20.0) == -signal.SIGKILL
    length = tomllib.loads(trial.read_text(encoding="utf-8"))["ship"]["L"]
    assert answered > 1 and length in (
        20.0 + answered,
        20.0 + answered + 1,
    )  # one may be unanswered
    assert [path.name for path in tmp_path.glob("*.toml")] == ["trial.toml"]


def test_what_is_not_there_is_refused(run_command: Callable[..., int], capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command("open", "no such folder", "--no-browser") == 2
    assert "there is no" in capsys.readouterr().err
    with pytest.raises(InputError, match="there is no"):
        serve_workspace(Path("no such folder"))
    assert run_command("open", ".", "--no-browser", "--port", "70000") == 2
    assert "port 70000 cannot be opened" in capsys.readouterr().err


def test_without_its_packages_it_names_the_line_to_install(
    run_command: Callable[..., int], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in [name for name in sys.modules if name.startswith(("seatrial.workspace", "starlette", "uvicorn"))]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "uvicorn", None)
    assert run_command("open", ".", "--no-browser") == 2
    assert "pip install 'seatrial[app]'" in capsys.readouterr().err
