"""Write docs/measured.md from docs/measured.toml: tables that commands printed which take too long for `make bench`.

`python docs/write_measured.py --check` writes nothing and fails where the page differs.
"""

import sys
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

DOCS = Path(__file__).parent
PAGE = DOCS / "measured.md"
HEAD = """---
orphan: true
---

<!-- written by write_measured.py -->

# Longer runs

Tables of commands that take longer than `make bench`, on a machine with two cores (AMD EPYC). The shorter ones, with
machine, date and commit, are on the page of [numbers](numbers.md). Under a table stands the day on which its command
was run at this version; those without a day are of version 0.1 and were not run again.
"""


def page() -> str:
    """Return the page: a section for each table."""
    tables = tomllib.loads((DOCS / "measured.toml").read_text(encoding="utf-8"))["table"]
    return HEAD + "".join(map(_section, tables))


def _section(table: Mapping[str, Any]) -> str:
    commands = "".join(f"    {command}\n" for command in table["commands"])
    note = f"\n{table['note'].strip()}\n" if "note" in table else ""
    rows = f"\n{_rows(table)}" if "rows" in table else ""
    day = f"\nRun on {table['run']}.\n" if "run" in table else ""
    return f"\n## {table['title']}\n\n{commands}{note}{rows}{day}"


def _rows(table: Mapping[str, Any]) -> str:
    header = table["header"]
    lines = [header, ["---"] * len(header), *table["rows"]]
    return "".join(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |\n" for line in lines)


if __name__ == "__main__":
    if "--check" in sys.argv[1:]:
        sys.exit(not PAGE.is_file() or page() != PAGE.read_text(encoding="utf-8"))
    PAGE.write_text(page(), encoding="utf-8")
