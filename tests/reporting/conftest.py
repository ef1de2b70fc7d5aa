"""Fits, studies and their pages, made once."""

from pathlib import Path

import pytest
from tests.reporting.complete_fit import complete_fit
from tests.reporting.fabricated import fabricated_fit
from tests.reporting.fabricated_study import fabricated_study

from seatrial.core.results import Fit, Study
from seatrial.reporting.pages import report_page


@pytest.fixture(scope="session")
def fit() -> Fit:
    """The fabricated fit with everything a page can show."""
    return complete_fit(fabricated_fit())


@pytest.fixture(scope="session")
def page(fit: Fit, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Its report."""
    path = tmp_path_factory.mktemp("report") / "report.html"
    path.write_text(report_page(fit), encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def study(fit: Fit) -> Study:
    """A study with everything its page can show."""
    return fabricated_study(fit)


@pytest.fixture(scope="session")
def study_page(study: Study, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Its page."""
    path = tmp_path_factory.mktemp("study") / "study.html"
    path.write_text(report_page(study), encoding="utf-8")
    return path
