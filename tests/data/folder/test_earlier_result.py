"""An earlier fit as priors: what they claim, whose they are, and records that would count twice."""

from pathlib import Path

import numpy as np
import pytest

import seatrial as st
from seatrial.core.values import frozen
from seatrial.data.folder.earlier_result import independent_deviations, read_earlier_result
from seatrial.data.folder.model_file import ModelFile, write_model
from seatrial.data.folder.model_tables import ModelProvenance, RecordSource
from seatrial.data.read.record_file import file_digest

COVARIANCE = np.array([[1e-4, 4e-3], [4e-3, 0.25]])  # correlation 0.8


@pytest.fixture
def monday(tmp_path: Path) -> Path:
    """A folder with the model file of a fit of K 0.15 and T 8 from a file of which a copy exists."""
    (tmp_path / "used.csv").write_text("t,delta\n0,0\n")
    source = RecordSource("used", "training", file_digest(tmp_path / "used.csv"))
    model = st.models.nomoto().with_values({"K": 0.15, "T": 8.0})
    (tmp_path / "monday").mkdir()
    file = ModelFile(model, frozen(COVARIANCE), ModelProvenance((source,)))
    write_model(file, tmp_path / "monday" / "model.toml")
    return tmp_path / "monday"


def test_independent_priors_claim_nothing_that_the_fit_does_not(monday: Path) -> None:
    result = read_earlier_result(monday)
    assert result.model == "nomoto"
    assert (result.priors["K"].mean, result.priors["T"].mean) == (0.15, 8.0)
    claimed = np.diag([result.priors[n].deviation for n in ("K", "T")]) ** 2
    assert np.linalg.eigvalsh(claimed - COVARIANCE)[0] > -1e-12
    np.testing.assert_allclose(np.diag(claimed), 1.8 * np.diag(COVARIANCE))
    assert "monday" in result.priors["K"].source


def test_uncorrelated_errors_keep_their_size_and_unknown_ones_have_none() -> None:
    np.testing.assert_allclose(independent_deviations(np.diag([4.0, 9.0])), [2.0, 3.0])
    some = independent_deviations(np.array([[4.0, 0.0], [0.0, np.inf]]))
    assert some[0] == 2.0
    assert np.isnan(some[1])


def test_a_fit_without_uncertainty_is_refused(tmp_path: Path) -> None:
    write_model(ModelFile(st.models.nomoto()), tmp_path / "model.toml")
    with pytest.raises(st.InputError, match="states no uncertainty"):
        read_earlier_result(tmp_path)
