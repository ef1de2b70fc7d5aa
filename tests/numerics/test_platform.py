"""What differs between operating systems lies in one file, and works where a system lacks something."""

import ast
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from seatrial.numerics import platform

SOURCES = Path(__file__).parents[2] / "src"
FOREIGN_MODULES = {"fcntl", "msvcrt", "termios", "tty", "pwd", "grp", "resource", "winreg"}
FOREIGN_OS_NAMES = {"rename", "replace", "sched_getaffinity", "fsync", "fork", "name", "kill", "getuid", "geteuid"}
# methods of paths: with one positional argument they are no method of a string or a table
RENAMING_METHODS = {"rename", "replace"}


def _platform_uses(tree: ast.AST) -> list[str]:
    """Places where a module asks for what only some systems have."""
    uses = []
    for node in ast.walk(tree):
        match node:
            case ast.Import(names=names):
                uses += [n.name for n in names if n.name in FOREIGN_MODULES]
            case ast.ImportFrom(module=module) if module in FOREIGN_MODULES:
                uses.append(str(module))
            case ast.Attribute(value=ast.Name(id="os"), attr=attr) if attr in FOREIGN_OS_NAMES:
                uses.append(f"os.{attr}")
            case ast.Attribute(value=ast.Name(id="sys"), attr="platform"):
                uses.append("sys.platform")
            case ast.Call(func=ast.Attribute(attr=attr), args=[_], keywords=[]) if attr in RENAMING_METHODS:
                uses.append(f".{attr}(path)")
    return uses


def test_nothing_else_asks_which_system_it_runs_on() -> None:
    files = [file for file in SOURCES.rglob("*.py") if file != Path(platform.__file__)]
    uses = {str(file): found for file in files if (found := _platform_uses(ast.parse(file.read_text("utf-8"))))}
    assert not uses
    assert len(_platform_uses(ast.parse(Path(platform.__file__).read_text("utf-8")))) > 5


def test_a_command_in_the_background_says_what_it_writes_and_a_file_can_be_made_to_run(tmp_path: Path) -> None:
    process = platform.start_in_background(
        [sys.executable, "-c", "import sys; print('found'); print('done', file=sys.stderr)"], os.environ, 5
    )
    assert process.stderr is not None and process.stderr.read().strip() == "done" and process.wait() == 0
    assert process.stdout is not None and process.stdout.read().strip() == "found"
    process.stdout.close()
    process.stderr.close()
    script = tmp_path / f"open{platform.click_suffix()}"
    script.write_text("", encoding="utf-8")
    platform.make_executable(script)
    assert os.access(script, os.X_OK) and script.suffix in (".bat", ".command", ".desktop")


def test_all_cores_are_used_where_there_are_no_affinities(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(os, "sched_getaffinity", raising=False)
    monkeypatch.setattr(os, "cpu_count", lambda: 7)
    assert platform.usable_cores() == 7
    monkeypatch.setattr(os, "cpu_count", lambda: None)
    assert platform.usable_cores() == 1


def test_only_the_cores_of_the_process_count(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 3, 5}, raising=False)
    assert platform.usable_cores() == 3


def test_one_file_is_locked_once(tmp_path: Path) -> None:
    pytest.importorskip("fcntl", reason="locks of this kind are Unix's")
    path = tmp_path / "journal"
    with path.open("x+b", buffering=0) as first, path.open("r+b", buffering=0) as second:
        assert platform.lock_exclusively(first)
        assert not platform.lock_exclusively(second)
    with path.open("r+b", buffering=0) as third:
        assert platform.lock_exclusively(third)


def test_without_locks_a_file_counts_as_locked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("fcntl", "msvcrt"):
        monkeypatch.setitem(sys.modules, module, None)
    with (tmp_path / "journal").open("x+b", buffering=0) as file:
        assert platform.lock_exclusively(file)


class _WindowsLocks:
    """As msvcrt: one byte at the position of the file, once."""

    LK_NBLCK = 2

    def __init__(self) -> None:
        self.locked: list[tuple[int, int]] = []

    def locking(self, descriptor: int, mode: int, count: int) -> None:
        assert (mode, count) == (self.LK_NBLCK, 1)
        place = os.fstat(descriptor).st_ino, os.lseek(descriptor, 0, os.SEEK_CUR)
        if place in self.locked:
            raise OSError(13, "Permission denied")
        self.locked.append(place)


def test_windows_locks_one_byte_and_leaves_the_position(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "fcntl", None)
    monkeypatch.setitem(sys.modules, "msvcrt", _WindowsLocks())
    path = tmp_path / "journal"
    path.write_bytes(b"header")
    with path.open("r+b", buffering=0) as first, path.open("r+b", buffering=0) as second:
        first.seek(3)
        assert platform.lock_exclusively(first)
        assert first.tell() == 3
        assert not platform.lock_exclusively(second)


def test_a_file_replaces_another(tmp_path: Path) -> None:
    source, target = tmp_path / "new", tmp_path / "old"
    source.write_text("new")
    target.write_text("old")
    platform.replace_file(source, target)
    assert target.read_text() == "new"
    assert not source.exists()


def test_a_target_that_is_open_for_a_moment_is_tried_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source, target, attempts, replace = tmp_path / "new", tmp_path / "old", [0], Path.replace

    def open_elsewhere(one: Path, other: Path) -> None:
        attempts[0] += 1
        if attempts[0] < 4:
            raise PermissionError(13, "in use")
        replace(one, other)

    source.write_text("new")
    monkeypatch.setattr(platform, "_RETRIES_REPLACING", True)
    monkeypatch.setattr(Path, "replace", open_elsewhere)
    monkeypatch.setattr(platform, "_REPLACE_PAUSE_S", 0.0)
    platform.replace_file(source, target)
    assert target.read_text() == "new"
    assert attempts == [4]


def test_a_target_that_stays_open_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def open_elsewhere(*_: Path) -> None:
        raise PermissionError(13, "in use")

    monkeypatch.setattr(Path, "replace", open_elsewhere)
    monkeypatch.setattr(platform, "_REPLACE_PAUSE_S", 0.0)
    for retries in (True, False):
        monkeypatch.setattr(platform, "_RETRIES_REPLACING", retries)
        with pytest.raises(PermissionError):
            platform.replace_file(tmp_path / "new", tmp_path / "old")


def test_what_was_written_reaches_the_disk(tmp_path: Path) -> None:
    with (tmp_path / "file").open("xb") as file:
        file.write(b"content")
        file.flush()
        platform.flush_to_disk(file.fileno())
    reading, writing = os.pipe()
    with pytest.raises(OSError):  # a pipe is on no disk
        platform.flush_to_disk(writing)
    os.close(reading)
    os.close(writing)


def test_interrupt_and_a_polite_kill_stop_a_process() -> None:
    assert {signal.SIGINT, signal.SIGTERM} <= set(platform.stop_signals())


def test_input_is_waited_for_no_longer_than_said() -> None:
    reading, writing = os.pipe()
    assert not platform.has_input(reading, 0.0)
    os.write(writing, b"line")
    assert platform.has_input(reading, 0.0)
    os.close(writing)
    os.close(reading)


def test_input_that_cannot_be_waited_for_counts_as_there(monkeypatch: pytest.MonkeyPatch) -> None:
    def no_pipes(*_: object) -> None:
        raise OSError(10038, "not a socket")

    monkeypatch.setattr(platform.select, "select", no_pipes)
    assert platform.has_input(0, 5.0)


@pytest.mark.parametrize(("system", "is_safe"), [("posix", True), ("nt", False)])
def test_windows_would_share_a_port(monkeypatch: pytest.MonkeyPatch, system: str, is_safe: bool) -> None:
    monkeypatch.setattr(platform, "_SYSTEM", system)
    assert platform.reuses_addresses_safely() is is_safe


def test_two_folders_exchange_their_names_in_one_step(tmp_path: Path) -> None:
    for name in ("one", "other"):
        (tmp_path / name).mkdir()
        (tmp_path / name / name).touch()
        platform.flush_folder_to_disk(tmp_path / name)
    if platform.exchange_folders(tmp_path / "one", tmp_path / "other"):
        assert (tmp_path / "one" / "other").exists() and (tmp_path / "other" / "one").exists()
    assert not platform.exchange_folders(tmp_path / "one", tmp_path / "absent")


def test_a_locked_folder_is_not_locked_again(tmp_path: Path) -> None:
    with platform.held_lock(tmp_path) as first, platform.held_lock(tmp_path) as second:
        assert not (first and second)
    with platform.held_lock(tmp_path) as again:
        assert again == first
    with platform.held_lock(tmp_path / "absent") as absent:
        assert not absent


def test_a_process_with_little_memory_cannot_take_more() -> None:
    program = (
        f"from {platform.limit_resources.__module__} import limit_resources; limit_resources(2**28, 60); bytes(2**29)"
    )
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (ended.returncode == 1 and "MemoryError" in ended.stderr) or os.name == "nt"


def test_no_more_is_written_of_a_file_than_it_has(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_bytes(b"x" * 100)
    assert platform.written_size(path.stat()) == 100
    with path.open("r+b") as file:
        file.truncate(2**30)
    assert 0 < platform.written_size(path.stat()) <= 2**30


def test_the_names_of_this_system_suit_a_library_of_it() -> None:
    assert (platform.system_name(), platform.library_suffix()) in {
        ("linux", ".so"), ("darwin", ".dylib"), ("win", ".dll"),
    }  # fmt: skip


def test_a_device_is_written_and_a_pipe_without_a_reader_refused(tmp_path: Path) -> None:
    platform.write_to_device(Path(os.devnull), b"content")
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe")
        with pytest.raises(OSError, match="No such device"):
            platform.write_to_device(tmp_path / "pipe", b"content")


def test_a_pipe_is_opened_without_waiting(tmp_path: Path) -> None:
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe")
        descriptor = platform.open_without_waiting(str(tmp_path / "pipe"), os.O_RDONLY)
        assert os.read(descriptor, 1) == b"" and os.get_blocking(descriptor)
        os.close(descriptor)
