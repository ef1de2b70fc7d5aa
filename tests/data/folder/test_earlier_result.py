"""An earlier fit as priors: what they claim, whose they are, and records that would count twice."""

from pathlib import Path

import numpy as np
import pytest

import seatrial as st
from seatrial.core.results import IntervalBasis
from seatrial.core.values import Prior, frozen
from seatrial.data.folder.model_file import (
    ModelFile,
    ModelProvenance,
    RecordSource,
    joint_prior,
    read_earlier_result,
    write_model,
)
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


def test_the_earlier_fit_keeps_its_correlations_and_claims_no_more(monday: Path) -> None:
    result = read_earlier_result(monday)
    assert result.model == "nomoto"
    assert (result.priors["K"].mean, result.priors["T"].mean) == (0.15, 8.0)
    assert "monday" in result.priors["K"].source
    claimed = result.joint_prior.covariance
    assert np.linalg.eigvalsh(claimed - COVARIANCE)[0] > 0.0
    np.testing.assert_allclose(claimed, COVARIANCE + 0.01 * np.diag(np.diag(COVARIANCE)))
    np.testing.assert_allclose([result.priors[n].deviation ** 2 for n in ("K", "T")], np.diag(claimed))


def test_few_runs_are_trusted_less_and_what_is_not_determined_is_no_prior() -> None:
    model = st.models.nomoto()
    few = IntervalBasis(COVARIANCE, degrees_of_freedom=4.0)
    file = ModelFile(model, frozen(COVARIANCE), interval_basis=few)
    np.testing.assert_allclose(np.diag(joint_prior(file).covariance), 1.25 * np.diag(COVARIANCE))
    half = ModelFile(model, frozen(np.array([[1e-4, 0.0], [0.0, np.inf]])))
    assert joint_prior(half).names == ("K",)


def test_priors_of_the_trial_file_take_the_place_of_the_earlier_ones(monday: Path) -> None:
    result = read_earlier_result(monday)
    own = {n: Prior(p.mean, p.deviation, p.source) for n, p in result.priors.items()}
    parameters = st.models.nomoto().parameters.with_priors(own)
    assert result.joint_prior_of(parameters).names == ("K", "T")
    assert result.joint_prior_of(parameters.with_priors({"T": Prior(8.0, 1.0, "trial file")})).names == ("K",)
    assert result.joint_prior_of(parameters.fixed("K")).names == ("T",)


def test_a_fit_without_uncertainty_is_refused(tmp_path: Path) -> None:
    write_model(ModelFile(st.models.nomoto()), tmp_path / "model.toml")
    with pytest.raises(st.InputError, match="states no uncertainty"):
        read_earlier_result(tmp_path)
