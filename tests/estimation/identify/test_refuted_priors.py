"""Priors that an estimate left are a warning that says by how far and what to do."""

from types import SimpleNamespace

import pytest

from seatrial.core.values import Prior
from seatrial.estimation.identify.warnings import refuted_prior_findings
from seatrial.physics.models.nomoto import nomoto


def estimation_at(distance: float) -> SimpleNamespace:
    """K so many standard deviations above its prior, T at its prior."""
    priors = {"K": Prior(0.2, 0.01), "T": Prior(10.0, 1.0)}
    model = nomoto().with_values({"K": 0.2 + 0.01 * distance, "T": 10.0})
    return SimpleNamespace(model=model.with_parameters(model.parameters.with_priors(priors)))


def test_the_farthest_are_named_with_their_distance() -> None:
    (finding,) = refuted_prior_findings(estimation_at(13.6))  # type: ignore[arg-type]
    assert finding.code == "prior-refuted"
    assert "the records contradict the priors of 1 coefficient" in finding.text
    assert "K by 14" in finding.evidence
    assert "T" not in finding.evidence
    assert "[model.priors]" in finding.advice


@pytest.mark.parametrize("distance", [0.0, 2.9, -2.9])
def test_what_chance_may_do_is_none(distance: float) -> None:
    assert refuted_prior_findings(estimation_at(distance)) == ()  # type: ignore[arg-type]
