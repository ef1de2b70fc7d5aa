"""Files and folders: written whole or not at all, tried before the work without leaving a trace."""

from pathlib import Path

import pytest

from seatrial.core.values import InputError
from seatrial.core.values.files import writable_folder, write_atomically, write_files_atomically


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
