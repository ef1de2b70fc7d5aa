"""Write the codes of findings into docs/bad-fit.md, from the table of the package.

`python docs/write_codes.py --check` writes nothing and fails where the page differs.
"""

import sys
from itertools import groupby
from pathlib import Path

from seatrial.core.values.finding import FindingKind, finding_kinds

PAGE = Path(__file__).parent / "bad-fit.md"
_HEADING = "## Codes\n"
_INTRODUCTION = "Causes stand before what they cause: of several warnings begin with the first.\n"


def page() -> str:
    """Return the page with the codes as the package holds them."""
    text, heading, _ = PAGE.read_text(encoding="utf-8").partition(_HEADING)
    areas = groupby(finding_kinds().items(), key=lambda item: item[1].area)
    tables = [f"### {area}\n\n{_table(list(kinds))}" for area, kinds in areas]
    return "\n".join((text + heading, _INTRODUCTION, *tables))


def _table(kinds: list[tuple[str, FindingKind]]) -> str:
    rows = (f"| `{code}` | {kind.says} | {kind.consequence} | {kind.advice or 'nothing'} |" for code, kind in kinds)
    return "\n".join(("| code | it says | what follows | what to do |", "|---|---|---|---|", *rows, ""))


if __name__ == "__main__":
    if "--check" in sys.argv[1:]:
        sys.exit(page() != PAGE.read_text(encoding="utf-8"))
    PAGE.write_text(page(), encoding="utf-8")
