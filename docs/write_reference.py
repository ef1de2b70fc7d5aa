"""Write docs/command-line.md from the commands, the keys of trial and loop files, and the table of notation.

`python docs/write_reference.py --check` writes nothing and names each page that differs.
"""

import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import typer
from schema_keys import schema_keys

from seatrial.cli import app
from seatrial.control.loopfile import schema as loop_tables
from seatrial.control.loopfile.schema import loop_schema
from seatrial.core.values import NOTATION
from seatrial.data.trial import schema as trial_tables
from seatrial.data.trial.schema import trial_schema

DOCS = Path(__file__).parent
GENERATED = """---
orphan: true
---

<!-- written by write_reference.py -->

"""
NOTATION_START, NOTATION_END = "<!-- written by write_reference.py -->", "<!-- end -->"
NOTATION_HEAD = ("symbol", "meaning", "unit", "frame", "positive")
KEYS = """# {title}

From the schema of the file; [its page]({page}) has examples. An *amount* is a number in the SI unit
shown, or a table with a unit of its own: `{{ value = 22, unit = "deg" }}`. {unit}Where no default is shown nothing is
assumed, or it follows from what else is given.

"""
HEAD = """# Command line

Each command is also a function of the same name in Python ([Names in Python](api.md)). Exit codes: 0 done, 2 bad
input (one sentence on standard error says what, where and what to do) or errors that `check` finds, 70 an error of
the program, 130 interrupted.
Files are written whole or not at all.
"""
COMMAND = re.compile(r"seatrial [a-z].+|--[a-z-]+(?: [^\s,]+)?")
"""An example in a help text: a command to the end of its line, or an option with its value."""


def page() -> str:
    """Return the page: a section for each command."""
    root = typer.main.get_command(app)
    return GENERATED + HEAD + "".join(_sections(root.commands, "seatrial"))  # type: ignore[attr-defined]  # typer's own group


def _sections(commands: dict[str, Any], prefix: str) -> Iterator[str]:
    for name, command in commands.items():
        if command.hidden:
            continue
        yield _section(command, f"{prefix} {name}")
        yield from _sections(getattr(command, "commands", {}), f"{prefix} {name}")


def _section(command: Any, path: str) -> str:
    options = [p for p in command.params if not (p.opts[0].startswith("-") and p.name == "help")]
    places = " ".join(_placed(p) for p in options if not p.opts[0].startswith("-"))
    rest = (
        " SUBCOMMAND" if getattr(command, "commands", {}) else " [OPTIONS]" if len(options) > places.count(" ") else ""
    )
    usage = f"    {path}{rest} {places}".rstrip()
    rows = "".join(f"| `{_name(p)}` | {_meaning(p)} | {_default(p)} |\n" for p in options)
    table = f"\n| option | what | default |\n|---|---|---|\n{rows}" if rows else ""
    return f"\n## {path}\n\n{_prose(command.help or '')}\n\n{usage}\n{table}"


def _prose(text: str) -> str:
    """Return a help text with its examples set as code."""
    return COMMAND.sub(lambda example: f"`{example[0]}`", text.strip())


def _placed(parameter: Any) -> str:
    name = (parameter.metavar or parameter.name.upper()).removesuffix("...")
    several = "..." if parameter.nargs == -1 else ""
    return name + several if parameter.required else f"[{name}{several}]"


def _name(parameter: Any) -> str:
    if not parameter.opts[0].startswith("-"):
        return _placed(parameter).replace("|", "\\|")
    value = "" if getattr(parameter, "is_flag", False) else f" {parameter.metavar or 'VALUE'}"
    return ", ".join(parameter.opts) + value.replace("|", "\\|")


def _meaning(parameter: Any) -> str:
    return re.sub(r"\s+", " ", parameter.help or "").replace("|", "\\|")


def _default(parameter: Any) -> str:
    if parameter.required:
        return "required"
    value = parameter.default
    return "" if value is None or value is False or value in ("", ()) or callable(value) else f"`{value}`"


def _with_notation(text: str) -> str:
    """Return the page of conventions with the notation; of numbered channels the first."""
    shown = [q for q in NOTATION.values() if not re.search(r"_(?:[2-9]|1\d)$", q.symbol)]
    rows = [(f"`{q.symbol}`", q.meaning, q.unit, q.frame, q.positive) for q in shown]
    lines = [f"| {' | '.join(cells)} |\n" for cells in (NOTATION_HEAD, ("---",) * len(NOTATION_HEAD), *rows)]
    before, rest = text.split(NOTATION_START)
    return f"{before}{NOTATION_START}\n\n{''.join(lines)}\n{NOTATION_END}{rest.split(NOTATION_END, 1)[1]}"


def pages() -> Iterator[tuple[Path, str]]:
    """Yield path and text of each page."""
    yield DOCS / "command-line.md", page()
    conventions = DOCS / "conventions.md"
    yield conventions, _with_notation(conventions.read_text(encoding="utf-8"))
    loop_unit = "Where no unit is shown it is that of the output or the actuator. "
    tables = (("trial", trial_schema(), vars(trial_tables), ""), ("loop", loop_schema(), vars(loop_tables), loop_unit))
    for kind, schema, classes, unit in tables:
        head = KEYS.format(title=f"Keys of the {kind} file", page=f"{kind}-file.md", unit=unit)
        yield DOCS / f"{kind}-keys.md", f"{GENERATED}{head}{schema_keys(schema, classes)}"


def main(*, check: bool) -> int:
    """Write the pages, or name those that differ; return 1 where one did."""
    differing = [(p, t) for p, t in pages() if not p.is_file() or p.read_text(encoding="utf-8") != t]
    for path, text in differing:
        if check:
            print(f"{path.name} is not what the code says; run python docs/write_reference.py")
        else:
            path.write_text(text, encoding="utf-8")
    return int(check and bool(differing))


if __name__ == "__main__":
    sys.exit(main(check=sys.argv[1:] == ["--check"]))
