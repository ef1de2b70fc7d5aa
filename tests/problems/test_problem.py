"""Problems by name, family and pattern, and errors in the unit that a problem states."""

from pathlib import Path

import numpy as np
import pytest
from tests.installed_package import install

from seatrial.core.values import InputError
from seatrial.problems import KnownOptimum, KnownTruth, absent_families, list_problems, problem_named, problems_matching

CODE = """
from seatrial.problems import BenchmarkProblem

def problems():
    return tuple(BenchmarkProblem(f"toy-{k}", 1, "", "", "", 10, None) for k in (2, 3))
"""


@pytest.fixture(autouse=True)
def toys(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A family of two problems."""
    install(monkeypatch, tmp_path, "seatrial.problems", "toy", CODE, "problems")


def test_problems_are_found_by_name_family_and_pattern() -> None:
    assert problem_named("toy-3").label == "toy-3@1"
    assert {"toy-2", "toy-3"} <= {p.name for p in list_problems()}
    assert [p.name for p in problems_matching(("toy",))] == ["toy-2", "toy-3"]
    assert [p.name for p in problems_matching(("toy-3", "toy-*"))] == ["toy-3", "toy-2"]


def test_what_there_is_not_is_refused_with_the_nearest() -> None:
    with pytest.raises(InputError, match="no problem 'toy-4'; did you mean 'toy-"):
        problem_named("toy-4")
    with pytest.raises(InputError, match=r"no problem matches 'x\*'"):
        problems_matching(("x*",))


def test_a_family_whose_records_are_absent_is_left_out_and_says_why(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    code = """
from seatrial.core.values import InputError

def problems():
    raise InputError("the records of 'dry' are not here; fetch them")
"""
    install(monkeypatch, tmp_path, "seatrial.problems", "dry", code, "problems")
    assert "toy-2" in {p.name for p in list_problems()}
    assert absent_families()["dry"] == "the records of 'dry' are not here; fetch them"
    for name in ("dry-2", "dry"):
        with pytest.raises(InputError, match="fetch them"):
            problems_matching((name,))


def test_errors_over_the_bound() -> None:
    stick = KnownTruth(np.array([1.0, -2.0]), np.array([0.1, 0.2]))
    assert stick.error(np.array([1.1, -2.4])) == pytest.approx(np.sqrt((1.0 + 4.0) / 2.0))
    assert stick.success_limit == 2.0


def test_errors_without_noise_are_in_per_cent() -> None:
    assert KnownTruth(np.array([1.0, -2.0])).error(np.array([1.02, -2.04])) == pytest.approx(2.0)


def test_errors_of_gains_are_excess_of_the_objective() -> None:
    stick = KnownOptimum(lambda points: 2.0 + np.sum(points**2, axis=1), 2.0)
    assert stick.error(np.array([0.0, 0.1])) == pytest.approx(0.5)
    assert KnownOptimum(lambda points: np.full(len(points), np.inf), 2.0).error(np.zeros(2)) == np.inf
