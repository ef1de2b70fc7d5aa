"""`st.benchmark`."""

from pathlib import Path

import pytest

import seatrial as st


def test_the_own_estimator_succeeds_and_the_page_is_written(tmp_path: Path) -> None:
    result = st.benchmark("qi2025-135-whole", tmp_path, against=("output-error",), runs=2, workers=1)
    (problem,) = result.problems
    assert problem.methods[0].success_share == 1.0 and problem.tests == ()
    assert (tmp_path / "benchmark.html").exists() and "output-error" in str(result.summary())


def test_as_published_is_another_campaign(tmp_path: Path) -> None:
    st.benchmark("qi2025-135-whole", tmp_path, against=("output-error",), runs=1, workers=1)
    with pytest.raises(st.InputError, match="differs in: placement"):
        st.benchmark("qi2025-135-whole", tmp_path, against=("output-error",), runs=1, workers=1, as_published=True)


def test_no_runs_are_refused(tmp_path: Path) -> None:
    with pytest.raises(st.InputError, match="0 runs show nothing"):
        st.benchmark("qi2025-135-whole", tmp_path, runs=0)
