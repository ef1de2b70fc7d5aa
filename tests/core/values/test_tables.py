"""Tables of TOML and JSON: what is too large, too deep or beyond all numbers is a sentence."""

import os
from pathlib import Path

import pytest

from seatrial.core.values import InputError
from seatrial.core.values.files import parse_json, parse_toml, read_bounded, read_table_text, refuse_absurd_numbers


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("a = " + "[" * 5000 + "]" * 5000, "nested too deep"),
        ("[" + ".".join("a" * 5000) + "]", "nested too deep"),
        (f"a = [{10**400}]", "beyond 64 bits"),
        ("a =", "Invalid value"),
    ],
)
def test_toml_that_no_program_writes_is_refused(text: str, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        parse_toml(text)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("[" * 50_000, "nested too deep"),
        (f"[{10**400}]", "beyond 64 bits"),
        ("[1e400]", "1e400, which is no finite number"),
        ("[NaN]", "NaN, which is no finite number"),
        ("{", "line 1"),
        (r'["\ud83d"]', "half of a character"),
    ],
)
def test_json_that_no_program_writes_is_refused(text: str, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        parse_json(text)


def test_what_is_well_formed_is_read() -> None:
    assert parse_toml("a = [1, 2.5, inf]\n[b]\nc = true") == {"a": [1, 2.5, float("inf")], "b": {"c": True}}
    assert parse_json('{"a": [1, 2.5, null]}') == {"a": [1, 2.5, None]}
    assert parse_json(r'["\ud83d\udea2"]') == ["\N{SHIP}"]


def test_a_file_beyond_the_limit_is_refused_before_it_is_read(tmp_path: Path) -> None:
    path = tmp_path / "large.toml"
    with path.open("wb") as file:
        file.truncate(5 * 2**30)  # a hole: no disk, and no memory where it is not read
    with pytest.raises(ValueError, match="larger than 256 MiB"):
        read_table_text(path)


def test_what_is_no_text_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "bytes"
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(ValueError, match="not UTF-8 text"):
        read_table_text(path)


def test_a_pipe_is_read_as_well() -> None:
    reader, writer = os.pipe()
    os.write(writer, b"a = 1")
    os.close(writer)
    assert read_bounded(Path(f"/dev/fd/{reader}")) == b"a = 1"
    os.close(reader)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes")
def test_a_pipe_without_a_writer_is_empty(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    assert read_bounded(tmp_path / "pipe") == b""


def test_the_mark_that_editors_put_first_is_left_out(tmp_path: Path) -> None:
    path = tmp_path / "trial.toml"
    path.write_bytes("a = 1".encode("utf-8-sig"))
    assert read_table_text(path) == "a = 1"


@pytest.mark.parametrize("number", [1e308, -1e31, 1e-320])
def test_a_number_of_no_possible_size_is_refused_with_its_key(number: float) -> None:
    with pytest.raises(InputError, match=r"file: ship\.L\[2\] = .* is no size that a quantity of a ship can have"):
        refuse_absurd_numbers({"ship": {"L": [0, number, 3.0, float("inf")]}}, "file")


def test_zero_infinity_and_common_numbers_pass() -> None:
    refuse_absurd_numbers({"a": [0.0, float("inf"), float("nan"), -1e10, 1e-12, True]}, "file")
