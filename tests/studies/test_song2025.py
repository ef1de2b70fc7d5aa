"""The study of Song et al. 2025 as a whole: what it prints holds together, and its checks can fail."""

import json
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from seatrial.core.results import Bars, Matrix, Study, Verdict
from seatrial.data.folder.document import document, strict_json
from seatrial.physics.models import waterjet, with_candidate_terms
from seatrial_studies.song2025 import study
from seatrial_studies.song2025.facts import FACTS
from seatrial_studies.song2025.published import DROPPED_COEFFICIENTS
from seatrial_studies.song2025.reproduction import EstimatorResult
from seatrial_studies.study_file import read_study
from seatrial_studies.study_page import StudyPage


@pytest.fixture(scope="module", params=[pytest.param("quick", marks=pytest.mark.long)])
def quick() -> Study:
    """The quick form, seed 3."""
    return study(quick=True, seed=3, report_progress=None)


def test_checks_hold_in_another_series_of_noise(quick: Study) -> None:
    """Not only in the default seed's; those on one noise series have room for one."""
    assert [c.name for c in quick.checks if not c.holds] == []
    assert len(quick.checks) == 7


def test_every_statement_is_judged(quick: Study) -> None:
    """Nine statements; what holds without noise holds in its own setting, of robustness the print says too little."""
    assert len(quick.claims) == 9
    claims = {c.claim.split(" (")[0]: c for c in quick.claims}
    assert claims["the model is robust"].verdict is Verdict.UNKNOWABLE
    assert "0.02 m/s in u and v and 0.1°/s in r" in claims["the model is robust"].evidence
    own = {claim.split(" ")[0] for claim, c in claims.items() if c.verdict is Verdict.HOLDS_IN_OWN_SETTING}
    assert own == {"SVR", "the", "predicted"}
    (accurate,) = [c for claim, c in claims.items() if claim.startswith("SVR identifies")]
    assert "in the median and 79.9 % at worst" in accurate.evidence and "nearest to the print" in accurate.evidence
    assert len(quick.answer) == 3 and "The paper tests no noise" in quick.answer[2]
    assert claims["thorough cleaning removes bad data and raises the accuracy"].verdict is Verdict.CONFIRMED


def test_every_table_and_figure_of_the_paper_has_its_place(quick: Study) -> None:
    """Tables 2 to 4; figures 2, 4 to 10."""
    titles = " ".join([t.title for t in quick.tables] + [f.title for f in quick.figures])
    (printed,) = [t for t in quick.tables if t.title.startswith("Table 2")]
    assert printed.rows[5][1:4] == ("-1.00740", "-0.0860", "0.6083")  # as printed, digits and all
    for wanted in ("Table 2", "Table 3", "Table 4", "Figure 2", "Figures 4, 5", "Figure 6", "Figures 7, 8", "9, 10"):
        assert wanted in titles
    assert sum(isinstance(f, Matrix) for f in quick.figures) == 3
    assert sum(isinstance(f, Bars) for f in quick.figures) == 5
    every = [t.title for t in quick.tables] + [f.title for f in quick.figures]
    assert read_study("song2025").missing_counterparts(every) == ()
    assert every.index("What wrong coefficients cost a controller") == len(quick.tables) - 1


def test_it_can_be_written_as_json(quick: Study) -> None:
    """Numbers only where there are numbers."""
    table = json.loads(strict_json(document(quick)))
    assert {"name", "tables", "claims", "checks"} <= set(table)
    assert table["name"] == "song2025"


def test_the_two_further_candidates_act_as_eq_2_has_them() -> None:
    """N_vrr v r^2 L^2 / U and N_vvr v^2 r L / U, times q L over the yaw inertia; zero they change nothing."""
    craft = with_candidate_terms(waterjet())
    assert craft.parameters.free_names[-2:] == DROPPED_COEFFICIENTS
    state, inputs = np.array([0.8, 0.1, 0.02, 0.0, 0.0, 0.0]), np.array([0.1, 1.866])
    rates = {}
    for name in (None, *DROPPED_COEFFICIENTS):
        model = craft if name is None else craft.with_values({name: 1.0})
        rates[name] = np.empty(6)
        model.compiled.rates(0.0, state, inputs, model.parameters.values, rates[name])
    p = {n: craft.parameters[n].value for n in ("rho", "L", "d", "I_z", "J_z")}
    q = 0.5 * p["rho"] * p["L"] * p["d"]
    unit = q * p["L"] / (p["I_z"] + p["J_z"]) / np.hypot(0.8, 0.1)
    r_L = 0.02 * p["L"]
    assert rates["N_vrr"][2] - rates[None][2] == pytest.approx(unit * 0.1 * r_L**2, rel=1e-5)
    assert rates["N_vvr"][2] - rates[None][2] == pytest.approx(unit * 0.01 * r_L, rel=1e-5)


def evidence(error: float, ratio: float = 1.0, gain: float = 8.0, confirms: bool = True) -> Any:
    """What the checks look at: every estimator's errors are `error`, the published pipeline's 10."""

    def row(name: str, size: float) -> EstimatorResult:
        return EstimatorResult(name, np.zeros(11), np.full(11, size), {})

    made = SimpleNamespace(
        noise_free_results=(row("central differences, least squares", error),),
        published=(None, None, None, row("published", 10.0)),
        output_error_noise_free=row("exact", error),
        output_error_noisy=row("ours", error),
        errors_over_bound={"weak form": gain},
        output_error_ratio=ratio,
    )
    return SimpleNamespace(
        reproduction=made, audit=SimpleNamespace(sign_checks=(SimpleNamespace(confirms_misprints=confirms),))
    )


def checks(numbers: Any) -> list[bool]:
    return [check.holds for check in StudyPage(read_study("song2025"), FACTS, numbers).checks()]


def test_checks_hold_for_good_numbers_and_fail_for_bad_ones() -> None:
    """Each by its own number."""
    assert all(checks(evidence(1e-9)))
    assert checks(evidence(0.5)) == [False, False, True, False, True, False, True]
    assert checks(evidence(1e-9, 2.0, 3.0, False)) == [True, True, False, True, False, True, False]
