"""Terms that Lasso selects: those that act in truth, judged by what was left out, of any model."""

from pathlib import Path

import numpy as np
import pytest
from tests.estimation.regress.linear import zigzags

from seatrial.core.results import Fit
from seatrial.core.values import InputError
from seatrial.data.example_series import true_model, with_sensor_noise
from seatrial.data.trial import Role, checked_records, load_trial
from seatrial.estimation.identify import identify
from seatrial.estimation.identify.baselines import with_term_selection
from seatrial.estimation.regress.estimators import RegressionSystem
from seatrial.estimation.regress.operators import RegressionMotion, Weak, feature_interactions
from seatrial.estimation.regress.term_selection import select_terms, selected_terms
from seatrial.physics.models import model_named
from seatrial.physics.models.candidate_structures import candidate_terms
from seatrial.physics.simulate import replay
from seatrial.reporting.baselines import term_section


def planted(seed: int, runs: int = 6) -> list[RegressionSystem]:
    """Eight terms of very different size of which three act, with noise."""
    generator = np.random.default_rng(seed)
    sizes, truth = np.logspace(-4, 3, 8), np.array([0.0, 3.0, 0.0, 0.0, -1.0, 0.0, 0.5, 0.0])
    names = tuple("abcdefgh")
    matrices = [generator.standard_normal((120, 8)) * sizes for _ in range(runs)]
    return [
        RegressionSystem(("u",), names, m, m @ (truth / sizes) + 0.5 * generator.standard_normal(120)) for m in matrices
    ]


@pytest.mark.parametrize("seed", range(6))
def test_the_terms_that_act_are_kept_and_no_others(seed: int) -> None:
    found = selected_terms(planted(seed))
    assert set(found.kept) == {"b", "e", "g"}
    assert found.order[:3] == ("b", "e", "g")
    assert found.values["b"] == pytest.approx(3.0 / 1e-3, rel=0.1)
    assert found.errors[found.best] == min(found.errors) and found.chosen >= found.best
    assert found.counts[found.chosen] == 3 and found.counts[-1] == 0


def test_where_nothing_acts_nothing_is_kept() -> None:
    generator = np.random.default_rng(1)
    noise = [RegressionSystem(("u",), ("a", "b"), generator.standard_normal((80, 2)), generator.standard_normal(80))
             for _ in range(5)]  # fmt: skip
    assert selected_terms(noise).kept == ()


@pytest.mark.parametrize("absent", ["Y_vv", "N_v"])
def test_a_term_that_a_craft_lacks_is_dropped(absent: str) -> None:
    craft = true_model().with_values({absent: 0.0})
    records = [with_sensor_noise(replay(craft, zigzags()), np.random.default_rng(k), k) for k in range(3)]
    selection = select_terms(craft, records, Weak(4.0))
    assert selection.left_out == "3 runs" and selection.held == ()
    assert [one.equations for one in selection.equations] == ["u", "v", "r"]
    candidates = {name for one in selection.equations for name in one.candidates}
    assert {"N_vrr", "N_vvr", absent} <= candidates and absent not in selection.kept
    assert {"X_uu", "N_r"} <= set(selection.kept)


def test_coefficients_that_multiply_others_are_held(repository: Path) -> None:
    trial = load_trial(repository / "examples" / "heave_pitch.toml")
    records = [r.record for r in checked_records(trial).records if r.role is Role.TRAIN]
    selection = select_terms(trial.model, records, Weak(4.0))
    assert set(selection.held) == {"a33", "a35", "a53", "a55"}
    assert {name for one in selection.equations for name in one.candidates} == {"b33", "b35", "b53", "b55"}


def test_interactions_are_those_of_the_equations() -> None:
    model = model_named("nomoto").with_values({"K": 0.1, "T": 20.0, "alpha": 0.0})
    model = model.with_parameters(model.parameters.freed("K", "T", "alpha"))
    motion = RegressionMotion(np.arange(40.0), np.random.default_rng(0).normal(size=(40, 2)),
                              np.random.default_rng(1).normal(size=(40, len(model.inputs))))  # fmt: skip
    meets = feature_interactions(model, motion)
    names = model.parameters.free_names
    place = {n: names.index(n) for n in ("K", "T", "alpha")}
    assert meets[place["T"], place["K"]] and meets[place["K"], place["T"]] and meets[place["T"], place["T"]]
    assert not meets[place["K"], place["alpha"]] and not meets[place["K"], place["K"]]


def test_a_model_declares_its_candidates() -> None:
    assert {"Y_ddd", "N_ddd", "X_vr"} <= set(candidate_terms(model_named("abkowitz")))
    assert "m_x" not in candidate_terms(model_named("waterjet"))


def test_the_chapter_says_in_which_terms_fit_and_lasso_differ(repository: Path) -> None:
    trial = load_trial(repository / "examples" / "kvlcc2_rolldecay.toml")
    fit = identify(trial, compare=True)
    assert fit.term_selection is not None
    chapter = term_section(fit)
    text = " ".join(chapter.sentences)
    assert f"Lasso keeps {len(fit.term_selection.kept)}" in text
    assert "10 blocks of the only run" in text
    assert chapter.table and len(chapter.table.rows) == 1
    assert "<svg" in chapter.parts[0].pictures[0].draw()


def test_where_no_state_is_shown_the_reason_stands_in_its_place(fabricated: Fit) -> None:
    short = fabricated.records[0].between(0.0, 0.5)
    without = with_term_selection(fabricated, [short], 50.0)
    assert without.term_selection is None
    assert any(f.message.startswith("no terms to select: ") for f in without.findings)
    with pytest.raises(InputError):
        select_terms(fabricated.model, [short], Weak(50.0))


@pytest.fixture
def fabricated() -> Fit:
    from tests.reporting.fabricated import fabricated_fit

    return fabricated_fit()
