"""Fits, studies and their pages, made once."""

from pathlib import Path

import pytest
from tests.reporting.complete_fit import complete_fit
from tests.reporting.fabricated import fabricated_fit
from tests.reporting.fabricated_study import fabricated_study

from seatrial.core.results import Fit, Study
from seatrial.reporting import write_report
from seatrial.reporting.study import write_study


@pytest.fixture(scope="session")
def fit() -> Fit:
    """The fabricated fit with everything a page can show."""
    return complete_fit(fabricated_fit())


@pytest.fixture(scope="session")
def page(fit: Fit, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Its report."""
    return write_report(fit, tmp_path_factory.mktemp("report") / "report.html")


@pytest.fixture(scope="session")
def study(fit: Fit) -> Study:
    """A study with everything its page can show."""
    return fabricated_study(fit)


@pytest.fixture(scope="session")
def study_page(study: Study, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Its page."""
    return write_study(study, tmp_path_factory.mktemp("study") / "study.html")
