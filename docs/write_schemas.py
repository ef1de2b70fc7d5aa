"""Write the JSON Schemas of trial files and results, and docs/result-keys.md, from the code.

`python docs/write_schemas.py --check` writes nothing and names each file that differs.
"""

import json
import re
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from seatrial.campaigns.plan import plan_schema
from seatrial.control.loopfile.schema import loop_schema
from seatrial.core.results import Comparison, Design, Fit, Study
from seatrial.core.results.campaign import Benchmark, CampaignSummary
from seatrial.core.results.online import Snapshot
from seatrial.core.results.tuning import Tuning
from seatrial.core.results.verification import Verification
from seatrial.data.folder.document import document_schema
from seatrial.data.trial.schema import trial_schema

DOCS = Path(__file__).parent
RESULTS = {
    "result": Fit,
    "design": Design,
    "tuning": Tuning,
    "verification": Verification,
    "study": Study,
    "comparison": Comparison,
    "online": Snapshot,
    "campaign_summary": CampaignSummary,
    "benchmark": Benchmark,
}
PAGE = DOCS / "result-keys.md"
HEAD = """---
orphan: true
---

<!-- written by write_schemas.py -->

# Keys of the documents

Of every document that a [result folder](result-folder.md) may hold. Values marked "derived" follow from others and
are not read back.

"""
JsonSchema = Mapping[str, Any]


def schema_texts() -> Iterator[tuple[Path, str]]:
    """Yield path and text of every schema."""
    schemas = {"campaign": plan_schema(), "loop": loop_schema(), "trial": trial_schema()}
    schemas |= {name: document_schema(kind) for name, kind in RESULTS.items()}
    for name, schema in schemas.items():
        yield DOCS / f"{name}.schema.json", json.dumps(schema, indent=1, ensure_ascii=False) + "\n"


def page_text() -> str:
    """Return the page: a table for each document and for each table in it."""
    tables: dict[str, str] = {}
    words: dict[str, str] = {}
    for name, kind in RESULTS.items():
        schema = document_schema(kind)
        tables.setdefault(kind.__name__, f"## {name}.json\n\n{_table(schema)}")
        for title, entry in schema.get("$defs", {}).items():
            if entry.get("properties"):
                tables.setdefault(title, f"## {title}\n\n{_table(entry)}")
            else:
                words[title] = kind_of(entry)
    text = re.sub(r"\[(\w+)\]\(#\w+\)", lambda link: words.get(link[1], link[0]), "\n".join(tables.values()))
    return HEAD + text


def _table(schema: JsonSchema) -> str:
    rows = [f"| `{key}` | {kind_of(entry)} | {_remark(entry)} |" for key, entry in schema["properties"].items()]
    return "\n".join(
        [schema.get("description", "").split("\n\n")[0], "", "| key | type | meaning |", "|---|---|---|", *rows, ""]
    )


def _remark(entry: JsonSchema) -> str:
    text = re.sub(r"\s+", " ", entry.get("description", "")).replace("|", "\\|")
    return f"{text} (derived)".lstrip() if entry.get("readOnly") else text


def kind_of(entry: JsonSchema) -> str:
    """Return the type of a value in a word or two, with a link where it has a table of its own."""
    if entry.get("x-stored"):
        return "name in arrays.npz"
    if "$ref" in entry:
        title = entry["$ref"].rpartition("/")[2]
        return f"[{title}](#{title.lower()})"
    if "anyOf" in entry or "oneOf" in entry:
        kinds = (kind_of(part) for part in entry.get("anyOf", entry.get("oneOf")))
        return " or ".join(dict.fromkeys(word for kind in kinds for word in kind.split(" or ")))
    if "enum" in entry:
        return ", ".join(map(str, entry["enum"]))
    if isinstance(entry.get("type"), list):
        return " or ".join(entry["type"])
    if entry.get("type") == "array":
        return f"list of {kind_of(entry['items'])}" if isinstance(entry.get("items"), dict) else "list"
    if entry.get("type") == "object":
        values = entry.get("additionalProperties")
        return f"name → {kind_of(values)}" if isinstance(values, dict) else entry.get("title", "table")
    return entry.get("type", "value")


def main(*, check: bool) -> int:
    """Write every file, or name those that differ; return their number."""
    differing = 0
    for path, text in [*schema_texts(), (PAGE, page_text())]:
        if path.is_file() and path.read_text(encoding="utf-8") == text:
            continue
        differing += 1
        print(f"{path.name} {'is not what the code says' if check else 'written'}")
        if not check:
            path.write_text(text, encoding="utf-8")
    return differing


if __name__ == "__main__":
    count = main(check=sys.argv[1:] == ["--check"])
    sys.exit(1 if count and sys.argv[1:] else 0)
