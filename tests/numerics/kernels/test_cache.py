"""Entries come back as they were written, or not at all; folders that are not the user's own are not used."""

import logging
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from seatrial.numerics.kernels import cache
from seatrial.numerics.kernels.cache import (
    cache_folder,
    discard_entry,
    entry_path,
    read_entry,
    source_digest,
    write_entry,
)

CONTENT = b"first\n\x00 second"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("SEATRIAL_CACHE", str(tmp_path))
    cache._folders.cache_clear()
    monkeypatch.setattr(cache, "_folders", cache._folders.__wrapped__)
    return tmp_path


@pytest.mark.parametrize("content", [CONTENT, b"", b"\n" * 1000])
def test_an_entry_comes_back_as_it_was_written(folder: Path, content: bytes) -> None:
    write_entry("one.bin", content)
    assert read_entry("one.bin") == content
    assert entry_path("one.bin").is_relative_to(folder)
    assert [p.name for p in cache_folder().iterdir()] == ["one.bin"], "a temporary file was left behind"


@pytest.mark.usefixtures("folder")
def test_an_absent_entry_is_none_without_a_word(caplog: pytest.LogCaptureFixture) -> None:
    assert read_entry("absent.bin") is None
    assert not caplog.records


@pytest.mark.usefixtures("folder")
def test_a_discarded_entry_is_gone_and_the_reason_logged(caplog: pytest.LogCaptureFixture) -> None:
    write_entry("one.bin", CONTENT)
    discard_entry("one.bin", "made by another compiler")
    assert read_entry("one.bin") is None
    assert "made by another compiler" in caplog.text


@pytest.mark.skipif(os.name != "posix", reason="Windows has no such modes")
@pytest.mark.parametrize(
    ("obstacle", "reason"),
    [
        (lambda place: place.write_text("in the way"), "File exists"),
        (lambda place: (place.mkdir(), place.chmod(0o777)), "other users may write it"),
        (lambda place: place.symlink_to(place.parent / "nowhere"), "File exists"),
    ],
)
def test_an_unusable_folder_is_named_once_and_replaced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture,
    obstacle: Callable[[Path], object], reason: str,
) -> None:  # fmt: skip
    monkeypatch.setenv("SEATRIAL_CACHE", str(tmp_path))
    obstacle(tmp_path / "entries-1")
    cache._folders.cache_clear()
    try:
        write_entry("one.bin", CONTENT)
        assert read_entry("one.bin") == CONTENT
        assert not entry_path("one.bin").is_relative_to(tmp_path)
        (record,) = caplog.records
        assert reason in record.getMessage() and "SEATRIAL_CACHE" in record.getMessage()
    finally:
        cache._folders.cache_clear()


@pytest.mark.usefixtures("folder")
def test_what_cannot_be_kept_is_logged_and_goes_on(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING):
        write_entry("no such folder/one.bin", CONTENT)
    assert "is not kept" in caplog.text


def test_the_digest_of_a_folder_is_that_of_all_its_texts(tmp_path: Path) -> None:
    folders = []
    for i, text in enumerate(("a = 1", "a = 1", "a = 2")):
        (tmp_path / str(i)).mkdir()
        (tmp_path / str(i) / "module.py").write_text(text)
        folders.append(source_digest(tmp_path / str(i)))
    assert folders[0] == folders[1] != folders[2]
