"""Documented schemas and tables are those of the code, and every document fits its schema."""

import json
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from tests.onboard.fabricated import heave_pitch
from tests.reporting.complete_fit import complete_fit
from tests.reporting.fabricated import fabricated_fit
from tests.reporting.fabricated_comparison import fabricated_comparison
from tests.reporting.fabricated_design import fabricated_design
from tests.reporting.fabricated_tuning import fabricated_autopilot, fabricated_bare, fabricated_fin

from seatrial.core.results.online import NO_SAMPLE
from seatrial.data.folder.document import document, document_schema, strict_json
from seatrial.data.folder.result_folder import folder_files

RESULTS: dict[str, Callable[[], object]] = {
    "fit": fabricated_fit,
    "complete fit": lambda: complete_fit(fabricated_fit()),
    "design": fabricated_design,
    "fin": fabricated_fin,
    "autopilot": fabricated_autopilot,
    "bare tuning": fabricated_bare,
    "comparison": fabricated_comparison,
    "snapshot": lambda: list(heave_pitch(30.0))[-1],
    "no sample": lambda: NO_SAMPLE,
}


@pytest.mark.parametrize("name", RESULTS)
def test_what_is_printed_and_what_is_stored_fit_the_schema(name: str) -> None:
    result = RESULTS[name]()
    schema = document_schema(type(result))
    stored = next(content for file, content in folder_files(result).items() if file.endswith(".json"))
    for table in (json.loads(strict_json(document(result))), json.loads(stored)):
        jsonschema.validate(table, schema)


def test_every_number_and_text_that_needs_one_has_a_unit_or_meaning() -> None:
    """A field without a description is one whose name says all: no numbers among them but intervals and counts."""
    plain = {"lower", "upper", "estimate", "standard_error", "seed", "elapsed_s", "value", "mean", "seeds", "cost"}
    plain |= {"samples", "runs", "statistic", "degrees_of_freedom", "Ms", "saturation", "period_lower", "period_upper"}
    plain |= {"damping_lower", "damping_upper"}
    for make in RESULTS.values():
        schema = document_schema(type(make()))
        for table in (schema, *schema.get("$defs", {}).values()):
            for name, entry in table.get("properties", {}).items():
                kinds = np.atleast_1d(entry.get("type", "object"))
                assert "number" not in kinds or "description" in entry or name in plain, (table.get("title"), name)


def test_the_documentation_is_written_from_the_code(repository: Path) -> None:
    done = subprocess.run(
        [sys.executable, repository / "docs" / "write_schemas.py", "--check"], capture_output=True, text=True
    )
    assert done.returncode == 0, f"{done.stdout}{done.stderr}: run python docs/write_schemas.py"


def test_infinite_and_unknown_are_null_in_both() -> None:
    fin = fabricated_fin()
    loose = replace(fin, chosen=replace(fin.chosen, gain_margin=np.inf, reduction=np.nan))
    stored = json.loads(folder_files(loose)["tuning.json"])
    for table in (document(loose), stored):
        assert table["chosen"]["gain_margin"] is None and table["chosen"]["reduction"] is None
    assert stored["non_finite"]["/chosen/gain_margin"] == "inf"
    assert stored["non_finite"]["/chosen/reduction"] == "nan"
