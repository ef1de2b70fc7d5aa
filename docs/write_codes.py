"""Write docs/findings.md, the codes of findings, from the table of the package.

`python docs/write_codes.py --check` writes nothing and fails where the page differs.
"""

import sys
from itertools import groupby
from pathlib import Path

from seatrial.core.values.finding import FindingKind, finding_kinds

PAGE = Path(__file__).parent / "findings.md"
HEAD = """---
orphan: true
---

<!-- written by write_codes.py -->

# Codes of findings

[A bad fit](bad-fit.md) begins with what you see; this page has the codes that terminal and report show in brackets.
Causes stand before what they cause: of several warnings begin with the first.
"""


def page() -> str:
    """Return the page with the codes as the package holds them."""
    areas = groupby(finding_kinds().items(), key=lambda item: item[1].area)
    return "\n".join((HEAD, *(f"## {area}\n\n{_table(list(kinds))}" for area, kinds in areas)))


def _table(kinds: list[tuple[str, FindingKind]]) -> str:
    rows = (f"| `{code}` | {kind.says} | {kind.consequence} | {kind.advice or 'nothing'} |" for code, kind in kinds)
    return "\n".join(("| code | it says | what follows | what to do |", "|---|---|---|---|", *rows, ""))


if __name__ == "__main__":
    if "--check" in sys.argv[1:]:
        sys.exit(not PAGE.is_file() or page() != PAGE.read_text(encoding="utf-8"))
    PAGE.write_text(page(), encoding="utf-8")
