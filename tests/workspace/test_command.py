"""`seatrial open` says where the workspace is, ends with its terminal, and names what it lacks in one line."""

import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.workspace.logs import write_trial


def test_it_serves_until_it_is_interrupted_and_leaves_no_command_behind(tmp_path: Path) -> None:
    write_trial(tmp_path)
    before = (tmp_path / "trial.toml").read_bytes()
    command = [sys.executable, "-m", "seatrial", "open", str(tmp_path), "--no-browser"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout is not None and process.stderr is not None
    address = re.search(r"http://127\.0\.0\.1:\d+/\?token=\S{20,}", process.stdout.readline())
    assert address is not None
    process.send_signal(signal.SIGINT)
    began = time.monotonic()
    assert process.wait(20.0) == 130
    assert time.monotonic() - began < 10.0 and "interrupted" in process.stderr.read()
    assert (tmp_path / "trial.toml").read_bytes() == before


def test_what_is_not_there_is_refused(run_command: Callable[..., int], capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command("open", "no such folder", "--no-browser") == 2
    assert "there is no" in capsys.readouterr().err
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
