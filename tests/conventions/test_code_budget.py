"""The code stays within its budgets, and the counter of lines, classes and constants counts what it says."""

import tomllib

import benchmarks.measure_code as counter
import pytest
from tests.conventions.source_tree import REPOSITORY

SAMPLE = '''"""A docstring of the file."""

# a comment
LENGTH = 5.5  # m
SPAN = 2.0 * LENGTH
NAME = "no number"
lower = 7.0
TABLE = {"a": 1.0, "b": -2.0, "c": "text"}
CODES = types.Array(types.uint8, 2, "C")


class Ship:
    """A class."""

    length: float
    """A field."""

    def text(self):
        return """first

        # not a comment, but like one
        last"""
'''


def test_what_counts_as_a_line_a_class_and_a_constant() -> None:
    assert counter.count_file(SAMPLE) == {"lines": 11, "files": 1, "classes": 1, "constants": 4}


def test_no_figure_rises_above_its_budget() -> None:
    figures = counter.totals(counter.measure(REPOSITORY))
    assert counter.over_budget(figures, tomllib.loads(counter.BUDGET.read_text(encoding="utf-8"))) == []


def test_a_figure_above_its_budget_needs_a_reason() -> None:
    row = {"figure": "lines", "by": 5, "reason": "a reader of one more format"}
    document = {"budget": dict.fromkeys(counter.FIGURES, 10)}
    figures = dict.fromkeys(counter.FIGURES, 10) | {"lines": 15}
    (sentence,) = counter.over_budget(figures, document)
    assert sentence.startswith(
        "lines: 15 is 5 above the budget of 10; lower another part of it, or say why in one line"
    )
    assert counter.over_budget(figures, document | {"raised": [row]}) == []
    assert len(counter.over_budget(figures, document | {"raised": [row | {"reason": " "}]})) == 1


def test_recording_lowers_budgets_only(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "budget.toml"
    rows = '[[raised]]\nfigure = "lines"\nby = 5\nreason = "r"\n[[raised]]\nfigure = "files"\nby = 2\nreason = "s"\n'
    path.write_text("# kept\n[budget]\nlines = 10\nfiles = 10\n" + rows)
    monkeypatch.setattr(counter, "BUDGET", path)
    counter.record({"lines": 12, "files": 8})
    document = tomllib.loads(path.read_text())
    assert document["budget"] == {"lines": 10, "files": 8}
    assert [row["figure"] for row in document["raised"]] == ["lines"]
    assert path.read_text().startswith("# kept")
