"""What is left when a command fails: one sentence, an exit code, and a file where the program is at fault."""

import errno
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from seatrial import InputError, api
from seatrial.cli import INPUT_EXIT_CODE, INTERNAL_EXIT_CODE, INTERRUPT_EXIT_CODE
from seatrial.cli.errors import is_of_input
from seatrial.core.values import Finding, Severity
from seatrial.data.trial.load import Correction


@pytest.fixture
def failing_with(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Callable[[BaseException], None]:
    """Let `check` raise an exception; error files go below a folder of the test."""
    monkeypatch.setattr("platformdirs.user_log_path", lambda _: tmp_path / "log")

    def prepare(error: BaseException) -> None:
        def check(*_: object) -> None:
            raise error

        monkeypatch.setattr(api, "check", check)

    return prepare


def test_an_error_of_the_program_is_a_sentence_and_a_file_to_send(
    failing_with: Callable[..., None],
    run_command: Callable[..., int],
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
) -> None:
    failing_with(IndexError("index 5 is out of bounds"))
    assert run_command("check", "any.toml") == INTERNAL_EXIT_CODE == 70
    said = capsys.readouterr().err
    (file,) = (tmp_path / "log").iterdir()
    assert said.count("\n") == 1 and said.strip().endswith(str(file)) and "IndexError" in said
    text = file.read_text()
    assert "index 5 is out of bounds" in text and "any.toml" in text and "numpy " in text


def test_the_file_goes_to_the_temporary_folder_where_there_is_no_other(
    failing_with: Callable[..., None],
    run_command: Callable[..., int],
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    (tmp_path / "log").touch()
    monkeypatch.setattr("tempfile.gettempdir", lambda: str(tmp_path))
    failing_with(MemoryError())
    assert run_command("check", "any.toml") == INTERNAL_EXIT_CODE
    (file,) = tmp_path.glob("seatrial-error-*.txt")
    assert capsys.readouterr().err.strip().endswith(f"memory of this computer does not suffice; nothing was written by "
                                                    f"halves. Please send the file {file}")  # fmt: skip


def test_bad_input_and_interruption_keep_their_exit_codes(
    failing_with: Callable[..., None],
    run_command: Callable[..., int],
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
) -> None:
    failing_with(InputError("rudder missing;\n  name it"))
    assert run_command("check", "any.toml") == INPUT_EXIT_CODE == 2
    assert capsys.readouterr().err == "seatrial: rudder missing; name it\n"
    failing_with(KeyboardInterrupt())
    assert run_command("check", "any.toml") == INTERRUPT_EXIT_CODE == 130
    assert "interrupted" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_behind_the_output_is_no_error_of_the_program(
    failing_with: Callable[[BaseException], None], run_command: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    full = OSError(errno.ENOSPC, "No space left on device")
    failing_with(full)
    assert is_of_input(full) and not is_of_input(FileNotFoundError(errno.ENOENT, "No such file", "name"))
    assert run_command("check", "any.toml") == INPUT_EXIT_CODE
    assert "cannot be written (No space left on device); make room" in capsys.readouterr().err


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
@pytest.mark.parametrize(("target", "codes"), [("> /dev/full", {INPUT_EXIT_CODE}), (">&-", {0}), ("| true", {0, 1})])
def test_output_that_cannot_go_anywhere_is_no_traceback(target: str, codes: set[int]) -> None:
    program = f"{sys.executable} -c 'from seatrial.cli import main; main()' --version {target}; exit ${{PIPESTATUS[0]}}"
    done = subprocess.run(["bash", "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode in codes
    assert done.stderr.count("\n") == int(done.returncode == INPUT_EXIT_CODE)


def test_the_module_is_the_command() -> None:
    done = subprocess.run([sys.executable, "-m", "seatrial", "--version"], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and done.stdout.startswith("seatrial ")


def test_errors_that_check_finds_are_its_exit_code(
    run_command: Callable[..., int],
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    """Those across blocks too, which `--fix` does not judge by itself."""
    file = tmp_path / "t.toml"
    file.touch()
    error = Finding(Severity.ERROR, "copied-run", "runs a and b are the same", "", "leave one out")
    monkeypatch.setattr(api, "check", lambda *_: (error,))
    monkeypatch.setattr(api, "correct_trial", lambda _: Correction("", (), ()))
    assert run_command("check", str(file)) == INPUT_EXIT_CODE
    assert run_command("check", str(file), "--fix") == INPUT_EXIT_CODE
    assert "no error has an edit that removes it" in capsys.readouterr().out
    monkeypatch.setattr(api, "check", lambda *_: ())
    assert run_command("check", str(file)) == 0
    assert run_command("check", str(file), "--fix") == 0
