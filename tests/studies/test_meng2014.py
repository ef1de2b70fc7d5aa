"""meng2014 repeated quickly: assumed inputs said, claims with evidence, our fit near its bound."""

import numpy as np
import pytest

from seatrial.core.results import Study, Verdict
from seatrial_studies import meng2014
from seatrial_studies.meng2014.study import twelve_unknowns, undetected_change
from seatrial_studies.swarm_search import simulate_search_data


@pytest.fixture(scope="module")
def study() -> Study:
    return meng2014.study(quick=True, seed=0, report_progress=None)


def test_twelve_unknowns_are_told_by_waves_and_fin_together_only() -> None:
    known = twelve_unknowns(0)
    assert known["beam waves alone"] < 1e-11
    assert known["one fin alone"] < 1e-11
    assert known["waves and fin"] > 1e-6


def test_wrong_coefficients_follow_the_record_within_the_noise() -> None:
    found = undetected_change(simulate_search_data(135, np.random.default_rng(0), has_fin=True))
    assert np.abs(found.relative_change).max() > 0.2
    assert found.heave_rms < 0.02
    assert found.pitch_rms < 0.04


def test_what_is_not_printed_is_said_to_be_assumed(study: Study) -> None:
    unknowable = [c for c in study.claims if c.verdict is Verdict.UNKNOWABLE]
    assert any("lost" in c.evidence for c in unknowable)
    assert any("assumed" in c.evidence.lower() for c in unknowable)
    assert sum("assumed" in t.note for t in study.tables) == 2
    (listed,) = [t for t in study.tables if t.title == "Assumed"]
    assert {"table 1: coefficients and errors", "fitness, eq. (7)"} <= {row[0] for row in listed.rows}
    assert "quick version" in listed.note


def test_the_law_without_an_inertia_weight_does_not_converge(study: Study) -> None:
    (law,) = [c for c in study.claims if "velocity law" in c.claim]
    assert law.verdict is Verdict.REFUTED


def test_our_fit_reaches_its_bound(study: Study) -> None:
    held = {c.name: c.holds for c in study.checks}
    assert held["our errors over the Cramer-Rao bound"]
    assert held["our largest relative error, noise-free"]
    assert held["flattest direction of twelve unknowns, beam waves alone"]
    assert held["flattest direction of twelve unknowns, one fin alone"]
