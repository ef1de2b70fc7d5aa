"""Files and folders: written whole or not at all, tried before the work without leaving a trace."""

import errno
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from seatrial.core.values import InputError, files
from seatrial.core.values.files import (
    is_device_or_pipe,
    is_file,
    is_folder,
    is_present,
    plain_name,
    remove_file,
    writable_folder,
    write_atomically,
    write_files_atomically,
)


def test_the_test_of_writing_leaves_nothing_behind(tmp_path: Path) -> None:
    assert writable_folder(tmp_path / "a" / "b") == tmp_path / "a" / "b"
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_exists_stays(tmp_path: Path) -> None:
    (tmp_path / "kept").mkdir()
    writable_folder(tmp_path / "kept")
    assert [place.name for place in tmp_path.iterdir()] == ["kept"]


def test_a_file_in_the_folders_place_is_said(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match=r"cannot be written .File exists.; choose another place"):
        writable_folder(tmp_path / "file")


def test_a_folder_in_the_files_place_is_said_and_no_draft_stays(tmp_path: Path) -> None:
    (tmp_path / "taken").mkdir()
    with pytest.raises(InputError, match="taken' cannot be written"):
        write_atomically(tmp_path / "taken", b"content")
    assert [place.name for place in tmp_path.iterdir()] == ["taken"]


def test_files_that_belong_together_are_written_together(tmp_path: Path) -> None:
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "kept").touch()
    with pytest.raises(InputError, match="cannot be written"):
        write_files_atomically(tmp_path / "b" / "kept" / "inside", {"one": b"1"})
    assert write_files_atomically(tmp_path / "b", {"one": b"1", "two": b"2"}) == tmp_path / "b"
    assert sorted(place.name for place in (tmp_path / "b").iterdir()) == ["kept", "one", "two"]


def test_the_users_umask_and_symbolic_links_are_respected(tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "elsewhere")
    (tmp_path / "name.json").symlink_to(tmp_path / "target.json")
    before = os.umask(0o027)
    try:
        write_atomically(tmp_path / "name.json", b"content")
        write_files_atomically(tmp_path / "link", {"one": b"1"})
        write_files_atomically(tmp_path / "new", {"one": b"1"})
    finally:
        os.umask(before)
    assert (tmp_path / "name.json").is_symlink() and (tmp_path / "link").is_symlink()
    modes = [(tmp_path / place).stat().st_mode & 0o777 for place in ("target.json", "elsewhere/one", "new")]
    assert modes == [0o640, 0o640, 0o750]


def test_folders_of_the_user_in_a_result_folder_stay(tmp_path: Path) -> None:
    write_files_atomically(tmp_path / "fit", {"one": b"1", "two": b"2"})
    (tmp_path / "fit" / "notes").mkdir()
    (tmp_path / "fit" / "notes" / "today.txt").write_text("windy")
    (tmp_path / "fit" / "notes" / "link").symlink_to("nowhere")
    write_files_atomically(tmp_path / "fit", {"one": b"3", "two": b"4"})
    assert (tmp_path / "fit" / "notes" / "today.txt").read_text() == "windy"
    assert (tmp_path / "fit" / "notes" / "link").is_symlink()
    assert (tmp_path / "fit" / "one").read_bytes() == b"3"
    assert [place.name for place in tmp_path.iterdir()] == ["fit"]


@pytest.mark.parametrize("is_working_folder", [False, True])
def test_files_that_are_removed_go_with_the_change(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, is_working_folder: bool
) -> None:
    write_files_atomically(tmp_path / "fit", {"one": b"1", "old": b"2"})
    (tmp_path / "fit" / "mine").write_text("kept")
    monkeypatch.chdir(tmp_path / "fit" if is_working_folder else tmp_path)
    write_files_atomically(tmp_path / "fit", {"one": b"3"}, {"one", "old", "never there"})
    assert {file.name: file.read_text() for file in (tmp_path / "fit").iterdir()} == {"one": "3", "mine": "kept"}


def test_a_folder_with_very_many_files_keeps_its_identity(tmp_path: Path) -> None:
    folder = tmp_path / "home"
    folder.mkdir()
    for number in range(1001):
        (folder / str(number)).touch()
    identity = folder.stat().st_ino
    write_files_atomically(folder, {"one": b"1"})
    assert folder.stat().st_ino == identity
    assert (folder / "one").read_bytes() == b"1"


def test_a_failure_leaves_the_old_files_and_no_empty_folders(tmp_path: Path) -> None:
    write_files_atomically(tmp_path / "fit", {"one": b"1"})
    name_no_system_takes = "two" * 100
    with pytest.raises(InputError, match="cannot be written"):
        write_files_atomically(tmp_path / "fit", {"one": b"3", name_no_system_takes: b"4"})
    with pytest.raises(InputError, match="cannot be written"):
        write_files_atomically(tmp_path / "a" / "b", {name_no_system_takes: b"4"})
    assert (tmp_path / "fit" / "one").read_bytes() == b"1"
    assert [place.name for place in tmp_path.iterdir()] == ["fit"]


def test_a_mount_point_is_written_from_within(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "volume"
    write_files_atomically(folder, {"one": b"1", "old": b"2"})
    (folder / ".volume.writing-killed").mkdir()

    def of_another_device(source: Path, target: Path) -> None:
        if source.is_relative_to(folder) != target.is_relative_to(folder):
            raise OSError(errno.EXDEV, os.strerror(errno.EXDEV))
        source.replace(target)

    monkeypatch.setattr(files, "replace_file", of_another_device)
    monkeypatch.setattr(files, "exchange_folders", lambda _draft, _target: False)
    write_files_atomically(folder, {"one": b"3"}, {"old"})
    assert {file.name: file.read_text() for file in folder.iterdir()} == {"one": "3"}
    assert [place.name for place in tmp_path.iterdir()] == ["volume"]


def test_letters_of_a_name_that_cannot_be_shown_are_replaced() -> None:
    assert plain_name("дрейф \x1b[1m\n\udcff.csv") == "дрейф _[1m__.csv"


def test_a_file_is_removed_or_a_sentence_says_why_not(tmp_path: Path) -> None:
    (tmp_path / "page").touch()
    for _ in range(2):
        remove_file(tmp_path / "page")
        assert list(tmp_path.iterdir()) == []
    with pytest.raises(InputError, match="cannot be written"):
        remove_file(tmp_path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes")
def test_devices_and_pipes_are_written_and_stay(tmp_path: Path) -> None:
    write_atomically(Path(os.devnull), b"content")
    assert Path(os.devnull).is_char_device() and is_device_or_pipe(Path(os.devnull))
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(InputError, match="cannot be written"):
        write_atomically(tmp_path / "pipe", b"nobody reads this")
    reader = os.open(tmp_path / "pipe", os.O_RDONLY | os.O_NONBLOCK)
    write_atomically(tmp_path / "pipe", b"content")
    assert os.read(reader, 100) == b"content"
    os.close(reader)
    assert (tmp_path / "pipe").is_fifo()


WRITER = """
import itertools, sys
from pathlib import Path
from seatrial.core.values.files import write_files_atomically
for k in itertools.count():
    write_files_atomically(Path(sys.argv[1]), {name: b"%d" % k for name in ("a", "b", "c", "d")})
    print(k, flush=True)
"""


def test_a_killed_process_leaves_the_old_files_or_the_new_ones(tmp_path: Path) -> None:
    folder = tmp_path / "fit"
    for kill in range(5):
        with subprocess.Popen([sys.executable, "-c", WRITER, str(folder)], stdout=subprocess.PIPE) as process:
            assert process.stdout is not None
            process.stdout.readline()
            time.sleep(0.013 * kill)  # s, anywhere in one of the writings
            process.kill()
        assert len({(folder / name).read_bytes() for name in ("a", "b", "c", "d")}) == 1
        assert sorted(place.name for place in folder.iterdir()) == ["a", "b", "c", "d"]
    write_files_atomically(folder, {"a": b"", "b": b""})
    assert [place.name for place in tmp_path.iterdir()] == ["fit"]


@pytest.mark.parametrize("name", ["x" * 300, "a\0b"])
def test_what_cannot_be_a_name_is_nothing(tmp_path: Path, name: str) -> None:
    assert not (is_file(tmp_path / name) or is_folder(tmp_path / name) or is_present(tmp_path / name))
    assert is_folder(tmp_path)
    with pytest.raises(InputError, match="cannot be written"):
        write_atomically(tmp_path / name, b"")
    with pytest.raises(InputError, match="cannot be written"):
        writable_folder(tmp_path / name)
    with pytest.raises(InputError, match="cannot be written"):
        write_files_atomically(tmp_path / name, {"one": b"1"})
