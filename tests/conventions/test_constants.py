"""Numeric constants say what they are: unit, meaning and origin stand at their line, however lines are broken."""

from pathlib import Path

from benchmarks.measure_code import write_formatted
from tests.conventions.list_constants import bare_constants
from tests.conventions.source_tree import REPOSITORY, parsed, source_files


def test_every_constant_says_what_it_is_wherever_the_formatter_breaks_a_line(tmp_path: Path) -> None:
    write_formatted(REPOSITORY, tmp_path)
    assert [f"{c.place}: {c.line}" for c in bare_constants(source_files("seatrial", tmp_path / "src"))] == []


def test_a_comment_explains_the_numbers_of_its_line_and_statement(tmp_path: Path) -> None:
    path = tmp_path / "sample.py"
    path.write_text(SAMPLE, encoding="utf-8")
    assert [c.line for c in bare_constants([parsed(path, tmp_path)])] == [
        "BARE = 7.5",
        "NEVER = 9.5  # fmt: skip",
        "8.5,",
    ]


SAMPLE = """
LENGTH = 5.5  # m, chosen
# m, chosen
WIDTH = 5.6
DEPTH = max(
    5.7,
)  # m, chosen
BARE = 7.5
SIZES = max(
    # m, chosen
    6.5,
    8.5,
    6.7,  # m, chosen
)
NEVER = 9.5  # fmt: skip
"""
