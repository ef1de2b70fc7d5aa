"""The page of a benchmark."""

from dataclasses import replace

import pytest
from tests.reporting.section_text import cells, text_of

from seatrial.core.results.campaign import (
    Benchmark,
    BenchmarkMethod,
    CampaignStatus,
    CheckedClaim,
    MethodScore,
    PairedTest,
    ProblemScore,
    TargetCurve,
)
from seatrial.reporting.benchmark import html, method_table, outcome, problem_section, target_chart, waterfall_chart


@pytest.fixture
def result() -> Benchmark:
    """Two methods on one problem, one of them entered and without an answer in one run."""
    good = MethodScore("de", True, 3, 0, "", (0.5, 0.9, 2.5), 1.5, 2, 100.0, 150.0, TargetCurve((10, 20, 40), 18), 0, 0,
                       None, 0, 3, 2.0)  # fmt: skip
    own = MethodScore("a<b>.py", False, 2, 1, "it raises <x>", (1.0, float("inf")), float("inf"), 1, 50.0, 300.0,
                      TargetCurve((5, 6), 18), 4, 3, (0.2, 0.99), 1, 0, None)  # fmt: skip
    test = PairedTest("a<b>.py", "de", 0, 3, 0.25, 0.25)
    problem = ProblemScore("toy-2", 1, "a title", "a paper", "white", ("a", "b"), 400, "the bound", 2.0, (good, own),
                           (test,), (CheckedClaim("a is better than b", test),))  # fmt: skip
    methods = (BenchmarkMethod("de", "Storn", "", True), BenchmarkMethod("a<b>.py", "a<b>.py", 64 * "0", False))
    status = CampaignStatus(6, 5, 1, 1.0)
    return Benchmark("truth shifted", (0, 2), (300.0, 1.0), status, methods, (problem,), "cite <me>", (), ("cpu",),
                     {"seatrial": "1"})  # fmt: skip


def test_the_page_shows_everything_and_escapes_what_users_wrote(result: Benchmark) -> None:
    page = html(result)
    for text in (
        "toy-2, version 1",
        "a paper",
        "the bound",
        "cite &lt;me&gt;",
        "it raises &lt;x&gt;",
        "Holm",
        "a is better than b",
        "not shown",
    ):
        assert text in page
    assert "<x>" not in page and "a<b>" not in page


def test_the_summary_says_what_an_entered_method_does(result: Benchmark) -> None:
    assert outcome(result)[1] == (
        "a<b>.py succeeds in 1 of 3 runs; in 1 comparison with built-in methods it is better in 0, worse in 0, and no "
        "difference shows in 1. Without an answer 1: it raises <x>. Answers outside the box: 1."
    )
    built_in = replace(result, methods=result.methods[:1])
    assert outcome(built_in)[1] == "Smallest median error: toy-2: de."


def test_the_table_has_a_row_for_each_method(result: Benchmark) -> None:
    first, second = cells(method_table(result.problems[0]))
    assert first[:5] == ("de", "0.900", "1.50", "67", "100")
    assert second[1] == "∞" and "1 outside the box" in second[-1] and "1 answers cannot be evaluated" in second[-1]


def test_charts_have_a_curve_for_each_method_and_none_without_answers(result: Benchmark) -> None:
    problem = result.problems[0]
    for chart in (target_chart(problem), waterfall_chart(problem)):
        assert chart is not None and {"de", "a<b>.py"} <= {entry.words for entry in chart.legend}
    empty = replace(problem, methods=(replace(problem.methods[0], errors=(), targets=TargetCurve((), 18)),))
    assert target_chart(empty) is None and waterfall_chart(empty) is None
    assert "a<b>.py de 0 3" in text_of(problem_section(empty, (1.0,)))
