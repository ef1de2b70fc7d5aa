"""Sentences and citations: what a reader learns of correlations, priors, truth and publications."""

from dataclasses import replace

import numpy as np
import pytest
from tests.reporting.section_text import cells

from seatrial.core.results import Coefficient, Fit, OffsetPopulation
from seatrial.numerics.optimise import Status
from seatrial.reporting import model_chapter as summary
from seatrial.reporting.coefficients_chapter import correlation_text, strong_partners
from seatrial.reporting.model_chapter import Citations
from seatrial.reporting.records_chapter import offset_section


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
    covariance = np.array([[1.0, -0.96, 0.0], [-0.96, 1.0, 0.0], [0.0, 0.0, 4.0]])
    assert correlation_text(("a", "b", "c"), covariance).startswith(
        "1 pair at 0.95 or above in size; the strongest: b and a (−0.96)"
    )
    weak = np.array([[1.0, 0.4], [0.4, 1.0]])
    assert correlation_text(("a", "b"), weak) == "The strongest is 0.40, between b and a."
    assert correlation_text(("a", "b"), np.eye(2)) == "None is correlated with another."
    assert correlation_text(("a",), np.eye(1)) == ""


def test_partners_are_those_of_the_sentence() -> None:
    covariance = np.array([[1.0, -0.97, 0.0], [-0.97, 1.0, 0.0], [0.0, 0.0, 4.0]])
    partners = strong_partners(("a", "b", "c"), covariance)
    assert {name: (p.name, p.correlation) for name, p in partners.items()} == {"a": ("b", -0.97), "b": ("a", -0.97)}
    weaker = np.where(covariance == -0.97, -0.96, covariance)
    assert strong_partners(("a", "b", "c"), weaker, 3.0) == strong_partners(("a",), np.eye(1)) == {}


def test_a_correlation_that_four_runs_give_by_chance_is_not_called_strong(rng: np.random.Generator) -> None:
    """The limit is that below which 95 of 100 sets of four unrelated estimates of three coefficients stay."""
    strong = np.array([[1.0, 0.96, 0.0], [0.96, 1.0, 0.0], [0.0, 0.0, 1.0]])
    assert correlation_text(("a", "b", "c"), strong, 3.0) == (
        "The strongest is 0.96, between b and a; with 4 runs or segments left out that may be chance."
    )
    assert correlation_text(("a", "b", "c"), strong, 40.0).startswith("1 pair at 0.95 or above in size")
    draws = [np.corrcoef(rng.standard_normal((3, 4))) for _ in range(4000)]
    beyond = [np.abs(np.tril(r, k=-1)).max() > 0.98333 for r in draws]  # r of t_2(1 - 0.05/6) = 7.649 by tables
    assert np.mean(beyond) == pytest.approx(0.05, abs=0.012)
    assert correlation_text(("a", "b", "c"), np.where(strong == 0.96, 0.984, strong), 3.0).startswith("1 pair at 0.98")


def test_residuals_and_search_are_stated_where_they_stand(fit: Fit) -> None:
    coloured = [n.channel for n in fit.channel_noise if not n.is_white]
    assert coloured and all(name in summary.residual_sentence(fit) for name in coloured)
    assert summary.convergence_sentence(fit) == ""
    stopped = replace(fit, solution=replace(fit.solution, status=Status.EXHAUSTED))
    assert summary.convergence_sentence(stopped).startswith("The search did not converge")


def test_the_spread_of_offsets_over_one_session_is_called_assumed(fit: Fit) -> None:
    population = OffsetPopulation("delta zero", "rad", 0.0, 0.01, 0.02, "v_j", 0.02, 0.004)
    several = offset_section(replace(fit, offset_populations=(population,)))
    (row,) = cells(several.table)
    assert row == ("delta zero", "0", "0.57", "1.1", "deg", "v_j: 1.1 ± 0.23 a standard deviation")
    assert not several.sentences
    one = replace(fit, offset_populations=(replace(population, slope=0.004),), offsets=fit.offsets[:1])
    assert offset_section(one).sentences[0].startswith("One session was recorded: ")
    assert cells(offset_section(one).table)[0][-1].endswith(", by chance")


def test_a_rudder_zero_is_said_to_look_like_an_asymmetric_hull(fit: Fit) -> None:
    asymmetry = replace(fit.coefficients[0], name="Y_0", estimate=0.0, fixed=True)

    def note(*more: Coefficient) -> str:
        return summary.steering_zero_note(replace(fit, coefficients=(*fit.coefficients, *more)))

    assert "asymmetric hull, which this model does not have, would look the same" in note()
    assert "asymmetric hull, held at zero here (Y_0), would look the same" in note(asymmetry)
    assert note(replace(asymmetry, fixed=False)) == ""
    currents = replace(fit, offsets=tuple(replace(o, name="current_north") for o in fit.offsets))
    assert summary.steering_zero_note(currents) == ""
