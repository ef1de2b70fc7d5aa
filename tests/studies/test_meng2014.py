"""meng2014 repeated quickly: assumed inputs said, claims with evidence, our fit near its bound."""

import re

import numpy as np
import pytest

from seatrial.core.results import CheckStatus, Figure, Study, Verdict
from seatrial.numerics.optimise import CloudSettings
from seatrial.physics.models import HEAVE_PITCH_STIFFNESSES
from seatrial_studies import meng2014
from seatrial_studies.heave_pitch_search import is_smaller, simulate_search_data
from seatrial_studies.meng2014.reproduction import (
    BEAM_WAVES,
    ONE_FIN,
    WAVES_AND_FIN,
    inertia_weight,
    twelve_unknown_problem,
    twelve_unknowns,
    undetected_change,
)
from seatrial_studies.study_file import read_study
from seatrial_studies.study_page import judged


@pytest.fixture(scope="module", params=[pytest.param("quick", marks=pytest.mark.long)])
def study() -> Study:
    return meng2014.study(quick=True, seed=0, report_progress=None)


def test_twelve_unknowns_are_identified_by_waves_and_fin_together_only() -> None:
    unknowns = twelve_unknowns(0)
    assert unknowns.curvatures[BEAM_WAVES] < 1e-11
    assert unknowns.curvatures[ONE_FIN] < 1e-11
    assert unknowns.curvatures[WAVES_AND_FIN] > 1e-6
    assert max(unknowns.errors.values()) < 1e-9


def test_the_problem_of_twelve_has_the_truth_for_its_start() -> None:
    problem = twelve_unknown_problem(simulate_search_data(135, np.random.default_rng(0), has_fin=True))
    assert set(HEAVE_PITCH_STIFFNESSES) < set(problem.model.parameters.free_names)
    assert problem.cost(problem.start(), problem.given_initial_states()) < 1e-12


def test_the_weight_of_the_printed_cloud_hardly_moves() -> None:
    """By hand: exp(-(0.15 - 4.1)^2 / 50) = 0.7319, exp(-(0.93 - 4.1)^2 / 50) = 0.8179."""
    ends = inertia_weight(np.array([0.15, 0.93]), np.full(2, 5.0), CloudSettings())
    assert ends == pytest.approx([0.9 - 0.5 * 0.7319, 0.9 - 0.5 * 0.8179], abs=1e-4)
    assert inertia_weight(np.array([4.1]), np.array([5.0]), CloudSettings()) == pytest.approx([0.4])


def test_speed_is_judged_by_a_sign_test() -> None:
    one, other = np.full((1, 5), 10.0), np.array([[20.0, 20.0, 20.0, 20.0, np.inf]])
    assert is_smaller(one, other) and not is_smaller(other, one)
    assert not is_smaller(one[:, :4], other[:, :4])  # four of four may be chance: 1/16
    assert not is_smaller(one, one)


def test_more_iterations_are_judged_with_the_noise_and_without() -> None:
    declared = read_study("meng2014")
    (claim,) = [c for c in declared.claims if c.claim.startswith("More iterations")]
    verdicts = [judged(claim.rule, {**declared.limits, "noisy_ratio": ratio}).verdict for ratio in (0.9, 0.99)]
    assert verdicts == [Verdict.CONFIRMED, Verdict.UNKNOWABLE]  # what may be is not refuted


def test_wrong_coefficients_follow_the_record_within_the_noise() -> None:
    found = undetected_change(simulate_search_data(135, np.random.default_rng(0), has_fin=True))
    assert np.abs(found.relative_change).max() > 0.2
    assert found.heave_rms < 0.02
    assert found.pitch_rms < 0.04


def test_what_is_not_printed_is_said_to_be_assumed(study: Study) -> None:
    unknowable = [c for c in study.claims if c.verdict is Verdict.UNKNOWABLE]
    assert any("lost" in c.evidence for c in unknowable)
    assert any("assumed" in c.evidence.lower() for c in unknowable)
    tables = {t.title: t for t in study.tables}
    assert {"table 1: coefficients and errors", "fitness, eq. (7)"} <= {row[0] for row in tables["Assumed"].rows}
    assert "quick version" in tables["Assumed"].note
    assert any("CPSO" in str(row[0]) and row[2] == "left out" for row in tables["Deviations from the print"].rows)


def test_the_page_answers_its_question(study: Study) -> None:
    text = " ".join(study.answer)
    for words in ("improved cloud particle swarm (ICPSO)", "particle swarm optimisation (PSO)", "(CPSO)", "lost"):
        assert words in text
    assert not re.search(r"\de[+-]\d", text)
    assert any("both end in the same minimum, which the noise decides" in c.evidence for c in study.claims)


def test_every_figure_of_the_paper_has_its_counterpart(study: Study) -> None:
    titles = [t.title for t in study.tables] + [f.title for f in study.figures]
    assert read_study("meng2014").missing_counterparts(titles) == ()
    assert [figure for figure, *_ in read_study("meng2014").paper_figures] == ["Figure 1", "Figure 2", "Figure 3"]
    (convergence,) = [f for f in study.figures if isinstance(f, Figure) and f.title == "Convergence"]
    assert [c.name for c in convergence.curves][:2] == ["ICPSO", "PSO"]
    assert all(np.all(np.isfinite(c.y)) for c in convergence.curves)


def test_claims_are_judged_in_the_papers_own_setting_too(study: Study) -> None:
    claims = {c.claim.rpartition(" (")[0]: c for c in study.claims}
    twelve = "Of the twelve unknown parameters eight need identification; the four stiffnesses follow from theory"
    assert claims[twelve].verdict is Verdict.HOLDS_IN_OWN_SETTING
    speed = claims["The cloud makes the swarm converge faster"]
    assert speed.verdict is Verdict.UNKNOWABLE and "ICPSO without its mutations" in speed.evidence
    assert claims["More iterations may reduce the error further"].verdict is Verdict.UNKNOWABLE
    (weight,) = [c for c in study.claims if "inertia weight adaptively" in c.claim]
    assert weight.verdict is Verdict.UNKNOWABLE and "0.534 to 0.491" in weight.evidence
    assert "lost in our copy" in weight.evidence


def test_what_wrong_coefficients_cost_ends_the_page(study: Study) -> None:
    costs = study.tables[-1]
    assert costs.title == "What wrong coefficients cost a controller" and len(costs.rows) == 30
    assert all(float(row[-1] or 0.0) > -1e-6 for row in costs.rows)


def test_no_check_in_force_rests_on_time(study: Study) -> None:
    assert [c.status for c in study.checks if "time" in c.name] == [CheckStatus.WITHDRAWN]


def test_what_our_copy_lacks_refutes_nothing(study: Study) -> None:
    (law,) = [c for c in study.claims if "eqs. (4) and (5)" in c.claim]
    assert law.verdict is Verdict.UNKNOWABLE and "base method" in law.evidence
    assert Verdict.REFUTED not in {c.verdict for c in study.claims}
    assert not any("not printed" in text for text in (*study.answer, *(c.evidence for c in study.claims)))


def test_our_fit_reaches_its_bound(study: Study) -> None:
    held = {c.name: c.holds for c in study.checks}
    assert held["our errors over the Cramer-Rao bound"]
    assert held["our largest relative error, noise-free"]
    assert held["flattest direction of twelve unknowns, beam waves alone"]
    assert held["flattest direction of twelve unknowns, one fin alone"]


def test_accuracy_and_mutation_are_judged(study: Study) -> None:
    claims = {c.claim.rpartition(" (")[0]: c for c in study.claims}
    assert "plain PSO" in claims["The cloud improves the accuracy of convergence"].evidence
    mutation = claims["Mutation by the cloud keeps the swarm diverse, out of local minima"]
    assert mutation.verdict is Verdict.UNKNOWABLE and "without" in mutation.evidence
