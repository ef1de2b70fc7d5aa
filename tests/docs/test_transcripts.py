"""Pages show commands that exist, and the writer of transcripts puts below each what it printed."""

import re
import sys
from pathlib import Path

import pytest
import typer

from seatrial.cli import app

REPOSITORY = Path(__file__).parents[2]
sys.path.insert(0, str(REPOSITORY / "docs"))
import write_transcripts  # noqa: E402  # a script next to the pages

PAGES = sorted(p for p in (REPOSITORY / "docs").rglob("*.md") if "```console\n" in p.read_text(encoding="utf-8"))
COMMAND = re.compile(r"^\$ seatrial (\w+)([^|>\n]*)", re.MULTILINE)


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(REPOSITORY)))
def test_the_commands_of_a_page_and_their_options_exist(page: Path) -> None:
    commands = typer.main.get_command(app).commands  # type: ignore[attr-defined]  # typer's own group
    shown = COMMAND.findall(page.read_text(encoding="utf-8"))
    assert shown
    for name, rest in shown:
        options = {option for parameter in commands[name].params for option in parameter.opts}
        assert set(re.findall(r"--[a-z-]+", rest)) <= options, (name, rest)


def test_output_is_written_below_each_command_and_files_are_there_for_the_next() -> None:
    page = (
        "# A page\n\n```{code-block} toml\n:caption: sub/a.toml\n\nL = 1.0\n```\n\n"
        "```console\n$ cat sub/a.toml\nsomething old\n$ ls examples | grep waterjet.toml\n```\n\nThe end.\n"
    )
    written = write_transcripts.run_page(page)
    assert "$ cat sub/a.toml\nL = 1.0\n$ ls examples | grep waterjet.toml\nwaterjet.toml\n```\n\nThe end." in written
    assert write_transcripts.run_page(written) == written


def test_a_command_that_fails_is_an_error_with_its_own_words() -> None:
    with pytest.raises(write_transcripts.CommandFailed, match=r"ended with 2.*no_such_file"):
        write_transcripts.run_page("```console\n$ ls no_such_file\n```\n")


def test_pages_are_compared_by_words_not_by_digits() -> None:
    assert write_transcripts.words("K  0.125  -1.2e-05 ---- s") == write_transcripts.words("K 0.13 1.3e-5 ------ s")
    assert write_transcripts.words("inside 3 of 4") != write_transcripts.words("outside 3 of 4")
