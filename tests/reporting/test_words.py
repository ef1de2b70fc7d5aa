"""Sentences and citations: what a reader learns of correlations, priors, truth and publications."""

from dataclasses import replace

import numpy as np

from seatrial.core.results import Fit
from seatrial.numerics.optimise import Status
from seatrial.reporting import summary
from seatrial.reporting.citations import Citations
from seatrial.reporting.correlations import correlation_text


def test_publications_are_numbered_once_and_the_longest_wording_is_listed() -> None:
    citations = Citations()
    first = citations.mark("Yasukawa & Yoshimura 2015, J Mar Sci Technol 20, 37-52, hull force polynomial")
    again = citations.mark("as Zhou et al. 1983, through Yasukawa & Yoshimura 2015; <b>")
    assert ">[1]</a>, hull force polynomial" in first
    assert ">[2]</a>, through <a" in again and "[1]" in again and "<b>" not in again
    assert [str(e) for e in citations.entries()] == [
        "Yasukawa &amp; Yoshimura 2015, J Mar Sci Technol 20, 37–52",
        "Zhou et al. 1983",
    ]


def test_a_doi_becomes_a_link() -> None:
    citations = Citations()
    citations.mark("Song et al. 2025, doi 10.19693/j.issn.1673-3185.03832, table 1")
    assert 'href="https://doi.org/10.19693/j.issn.1673-3185.03832"' in citations.entries()[0]


def test_strong_correlations_are_named() -> None:
    covariance = np.array([[1.0, -0.95, 0.0], [-0.95, 1.0, 0.0], [0.0, 0.0, 4.0]])
    assert correlation_text(("a", "b", "c"), covariance).startswith(
        "1 pair at 0.9 or above in size; the strongest: b and a (−0.95)"
    )
    weak = np.array([[1.0, 0.4], [0.4, 1.0]])
    assert correlation_text(("a", "b"), weak) == "The strongest is 0.40, between b and a."
    assert correlation_text(("a", "b"), np.eye(2)) == "None is correlated with another."
    assert correlation_text(("a",), np.eye(1)) == ""


def test_the_coefficients_count_known_values_and_name_disagreeing_priors(fit: Fit) -> None:
    known = [c for c in fit.coefficients if not c.fixed and c.truth is not None]
    assert f"of {len(known)} 95 % intervals contain" in " ".join(summary.coefficient_sentences(fit))
    with_prior = next(c for c in fit.coefficients if c.prior_mean is not None)
    far = replace(with_prior, prior_mean=with_prior.estimate + 9.0 * (with_prior.prior_standard_deviation or 1.0))
    changed = replace(fit, coefficients=tuple(far if c is with_prior else c for c in fit.coefficients))
    sentences = summary.coefficient_sentences(changed)
    assert f"({far.name})" in next(s for s in sentences if "prior standard deviations" in s)


def test_residuals_and_search_are_stated_where_they_stand(fit: Fit) -> None:
    coloured = [n.channel for n in fit.channel_noise if not n.is_white]
    assert coloured and all(name in summary.residual_sentence(fit) for name in coloured)
    assert summary.convergence_sentence(fit) == ""
    stopped = replace(fit, solution=replace(fit.solution, status=Status.EXHAUSTED))
    assert summary.convergence_sentence(stopped).startswith("The search did not converge")
