"""Run every command that a page shows in a block `console`, and write what it printed below it.

`python docs/write_transcripts.py [PAGE.md ...]` rewrites the pages, by default all that have such blocks. With
`--check` nothing is written and each page is named whose commands fail or print other words; numbers are not
compared, since their last digits and all times depend on the machine.

A page is run from top to bottom in an empty folder with the package's `examples` in it. A block with a caption,

    ```{code-block} toml
    :caption: trial.toml

is written to the file of that name, and so the commands below it find what a reader would have saved.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

DOCS = Path(__file__).parent
BLOCK = re.compile(
    r"^```\{code-block\} \w+\n:caption: (?P<file>\S+)\n\n(?P<text>.*?)^```$|^```console\n(?P<console>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)
PROMPT = "$ "
COLUMNS = "112"  # characters of the terminal whose output the pages show: a code block of the site at 1400 pixels
LIMIT = 900  # s for one command; some thirty times what the slowest takes on an idle machine


class CommandFailed(Exception):
    """A command of a page ended with an error."""


def environment() -> dict[str, str]:
    """Return the variables under which commands run: this checkout, this interpreter's scripts, plain output."""
    paths = {
        "PYTHONPATH": str(DOCS.parent / "src"),
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
    }
    plain = {"COLUMNS": COLUMNS, "NO_COLOR": "1", "TERM": "dumb", "OPENBLAS_NUM_THREADS": "1", "LC_ALL": "C.UTF-8"}
    return {**os.environ, **paths, **plain}


def printed(command: str, folder: Path) -> str:
    """Return what a command prints, run in a folder; its progress, on standard error, is left out."""
    done = subprocess.run(
        ["bash", "-c", command], cwd=folder, env=environment(), capture_output=True, text=True, timeout=LIMIT
    )
    if done.returncode:
        raise CommandFailed(f"{command!r} ended with {done.returncode}: {done.stderr.strip()}")
    return "".join(f"{line.rstrip()}\n" for line in done.stdout.splitlines())


def run_page(text: str) -> str:
    """Return a page with the output of its commands written anew."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "examples").symlink_to(DOCS.parent / "examples")

        def executed(block: re.Match[str]) -> str:
            if block["file"]:
                (folder / block["file"]).parent.mkdir(parents=True, exist_ok=True)
                (folder / block["file"]).write_text(block["text"], encoding="utf-8")
                return block[0]
            commands = [line for line in block["console"].splitlines() if line.startswith(PROMPT)]
            parts = [f"{line}\n{printed(line.removeprefix(PROMPT), folder)}" for line in commands]
            return f"```console\n{''.join(parts)}```"

        return BLOCK.sub(executed, text)


def words(text: str) -> list[str]:
    """Return a text without its numbers, and without the rules and spaces whose width depends on them."""
    return re.sub(r"[-+−]?\d[\d.,e+-]*|[-−─━═]{2,}", " ", text).split()


def main(arguments: list[str]) -> int:
    """Run pages; with --check name those that differ and return their number."""
    check, names = "--check" in arguments, [Path(a) for a in arguments if a != "--check"]
    pages = names or [p for p in sorted(DOCS.rglob("*.md")) if "```console\n" in p.read_text(encoding="utf-8")]
    failures = 0
    for page in pages:
        text = page.read_text(encoding="utf-8")
        try:
            new = run_page(text)
        except CommandFailed as problem:
            print(f"{page.name}: {problem}")
            failures += 1
            continue
        if not check:
            page.write_text(new, encoding="utf-8")
        elif words(new) != words(text):
            print(f"{page.name} does not show what its commands print; run python docs/write_transcripts.py {page}")
            failures += 1
    return failures


if __name__ == "__main__":
    if not shutil.which("bash"):
        sys.exit("the commands of the pages need bash")
    sys.exit(min(main(sys.argv[1:]), 1))
