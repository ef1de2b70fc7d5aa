"""qi2025 repeated quickly: the print audited, claims with evidence, checks that can fail."""

import numpy as np
import pytest

from seatrial.models.qi2025 import HEADINGS
from seatrial.results import Study, Verdict
from seatrial.studies import STUDIES
from seatrial.studies.qi2025.audit import audit
from seatrial.studies.qi2025.published import Algorithm, misprinted, recomputed_error
from seatrial.studies.swarm_search import centred, off_centre, one_sample, sailed, searched


@pytest.fixture(scope="module")
def study() -> Study:
    return STUDIES["qi2025"](quick=True, seed=0, progress=None)


def test_six_printed_errors_do_not_follow_from_their_values() -> None:
    assert [(h, str(a), name) for h, a, name, _, _ in misprinted()] == [
        (90, "PSO", "a35"), (90, "WHO", "a55"), (135, "PSO", "a33"),
        (135, "WHO", "b35"), (180, "WHO", "a35"), (180, "IWHO", "a35"),
    ]  # fmt: skip


def test_the_mean_printed_errors_of_the_improved_herd_recompute() -> None:
    means = [float(np.mean(np.abs(recomputed_error(h, Algorithm.IWHO)))) for h in HEADINGS]
    assert means == pytest.approx([0.20, 0.16, 0.19], abs=0.006)


def test_the_speed_behind_the_tables_is_eighteen_knots_if_b53_is_negative() -> None:
    audited = audit([sailed(45, np.random.default_rng(0))], 0)
    for right, wrong in audited.speeds.values():
        assert right == pytest.approx(9.26, abs=0.01)
        assert 5.0 < wrong < 5.8
    assert audited.saturated == (11, 16)
    assert audited.heights == pytest.approx((3.42, 2.27), abs=0.005)
    assert audited.step_rank == 2
    assert audited.beyond[:2] == (14, 24)
    assert all(0.05 < change < 0.5 for pair in audited.sign_effect.values() for change in pair)


def test_boxes_off_centre_hold_the_truth_off_their_centre() -> None:
    truth = np.array([1.0, -2.0, 3.0])
    for seed in range(20):
        box = off_centre(truth, 0.5, np.random.default_rng(seed))
        assert np.all((box.lower < truth) & (truth < box.upper))
        np.testing.assert_allclose(box.upper - box.lower, np.abs(truth))
    assert np.allclose(0.5 * (centred(truth, 0.1).lower + centred(truth, 0.1).upper), truth)


def test_a_search_is_the_same_from_its_seed() -> None:
    from seatrial.optimise import HerdSettings, WildHorse

    seas = [sailed(135, np.random.default_rng(1))]
    boxes = [centred(seas[0].truth, 0.1)]

    def once() -> np.ndarray:
        return searched(seas, boxes, lambda b, g: WildHorse(b, g, HerdSettings(iterations=20)), one_sample, 3).points

    assert np.array_equal(once(), once())


def test_the_papers_contrast_appears_only_in_its_own_setting(study: Study) -> None:
    verdicts = {c.claim: c.verdict for c in study.claims}
    assert verdicts["IWHO is far more accurate than WHO"] is Verdict.REFUTED
    assert all(len(c.evidence) > 20 for c in study.claims)
    assert len(study.claims) >= 12


def test_checks_hold_but_those_of_time(study: Study) -> None:
    failing = [c.name for c in study.checks if not c.holds]
    assert [name for name in failing if "time" not in name] == []


def test_every_table_and_figure_of_the_paper_is_there(study: Study) -> None:
    titles = [t.title for t in study.tables] + [f.title for f in study.figures]
    for heading in HEADINGS:
        assert f"Coefficients at {heading}°" in titles
    assert "Time of a run" in titles
    assert sum(title.startswith("Figure") for title in titles) == 10
    assert all(np.all(np.isfinite(c.y)) for f in study.figures for c in f.curves)
