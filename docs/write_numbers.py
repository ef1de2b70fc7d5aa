"""Write docs/numbers.md and the table of the README from docs/numbers.json, which `benchmarks/run.py --record` keeps.

`python docs/write_numbers.py --check` writes nothing and names each file that differs.
"""

import json
import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from seatrial.core.text.numbers import significant

DOCS = Path(__file__).parent
README = DOCS.parent / "README.md"
BENCHMARKS = DOCS.parent / "benchmarks"
TABLE = re.compile(r"(?<=<!-- numbers: docs/write_numbers.py -->\n).*?(?=<!-- end of numbers -->)", re.DOTALL)
DIGITS = 3
"""Significant digits of a printed number."""

Recorded = Mapping[str, Any]


@dataclass(frozen=True)
class Headline:
    """A row of the README: `text` with a {} for each quantity of a benchmark."""

    benchmark: str
    what: str
    text: str
    quantities: tuple[str, ...]


HEADLINES = (
    Headline(
        "kvlcc2_zigzags",
        "Tanker KVLCC2: a 35/5 zigzag that was not used, 210 s",
        "{}° heading and {} m position rms; the published code at best {}° and {} m",
        (
            "Z_35_05 left out, 210 s open loop: heading",
            "Z_35_05 left out, 210 s open loop: position",
            "the published code on the same run, best setting: heading",
            "the published code on the same run, best setting: position",
        ),
    ),
    Headline(
        "montecarlo",
        "Simulated truth, noisy trials, no guess",
        "95 % intervals hold it in {} of the cases",
        ("coverage of 95 % intervals, pooled",),
    ),
    Headline(
        "waterjet_regressions",
        "Waterjet craft by the best regression instead of output error",
        "{} times as far off in the median",
        ("best of each coefficient / output error, median: regressions",),
    ),
    Headline(
        "simulation",
        "Simulation, one core",
        "{} million Runge-Kutta steps a second",
        ("waterjet, 3 dynamic states: Runge-Kutta steps",),
    ),
    Headline(
        "against_shipmmg",
        "Against shipmmg on its own equations, a 20/20 zigzag",
        "{} times as fast",
        ("20/20 zigzag: ratio with steps of 0.1 s",),
    ),
)


def texts(recorded: Recorded) -> Iterator[tuple[Path, str]]:
    """Yield path and text of the page and of the README."""
    yield DOCS / "numbers.md", page(recorded)
    readme = README.read_text(encoding="utf-8")
    table, count = TABLE.subn(lambda _: headline_table(recorded), readme)
    if count != 1:
        raise SystemExit("README.md needs the two marks of the table of numbers, once each")
    yield README, table


def headline_table(recorded: Recorded) -> str:
    """Return the rows of the README, of the benchmarks that are recorded."""
    rows = []
    for h in (h for h in HEADLINES if h.benchmark in recorded):
        values = {line["quantity"]: line["value"] for line in recorded[h.benchmark]["lines"]}
        text = h.text.format(*(significant(values[q], DIGITS) for q in h.quantities))
        rows.append(f"| {h.what} | {text} | `python benchmarks/run.py {h.benchmark}` |\n")
    return "".join(["| what | number | command |\n|---|---|---|\n", *rows])


def page(recorded: Recorded) -> str:
    """Return the page: a table for each benchmark."""
    head = (
        "---\norphan: true\n---\n\n<!-- written by write_numbers.py -->\n\n# Numbers\n\n"
        "Each table is what its command printed on the machine and at the commit named below it; "
        "`make bench` prints all of\nthem. Times depend on the machine, ratios hardly do.\n"
    )
    return head + "".join(_section(name, entry) for name, entry in recorded.items())


def _section(name: str, entry: Mapping[str, Any]) -> str:
    lines = [
        f"| {x['quantity'].strip()} | {significant(x['value'], DIGITS)} {x['unit']} | {x['target']} | {_verdict(x)} |\n"
        for x in entry["lines"]
    ]
    return (
        f"\n## {name.replace('_', ' ').capitalize()}\n\n{_purpose(name)}\n\n"
        f"    python benchmarks/run.py {name}\n\n| quantity | value | target | |\n|---|---|---|---|\n{''.join(lines)}\n"
        f"{entry['machine']}; {entry['date']}, commit {entry['commit']}.\n"
    )


def _purpose(name: str) -> str:
    """First sentence of the benchmark's file."""
    return (BENCHMARKS / f"{name}.py").read_text(encoding="utf-8").split('"""')[1].split("\n\n")[0].strip()


def _verdict(line: Mapping[str, Any]) -> str:
    return "" if line["holds"] is None else "holds" if line["holds"] else "**missed**"


def main(arguments: list[str]) -> int:
    """Write what differs; with --check name it and return 1."""
    recorded = json.loads((DOCS / "numbers.json").read_text(encoding="utf-8"))
    stale = [(p, t) for p, t in texts(recorded) if not p.exists() or p.read_text(encoding="utf-8") != t]
    for path, text in stale:
        if "--check" in arguments:
            print(f"{path.name} is not what docs/numbers.json says; run python docs/write_numbers.py")
        else:
            path.write_text(text, encoding="utf-8")
    return int("--check" in arguments and bool(stale))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
