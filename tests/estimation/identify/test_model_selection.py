"""Models compared on runs left out: ties, the choice, what a family may not be."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import InputError, Prior, Record, Severity
from seatrial.data.trial import EstimateMethod, EstimateSettings, ModelFamily
from seatrial.estimation.estimate import Estimation, EstimatorOptions, Runs, estimate_model
from seatrial.estimation.estimate.intervals import fits_without, one_step_jackknife
from seatrial.estimation.identify.model_selection import (
    FittedVariant,
    ModelVariant,
    _better_candidate_warning,
    _choice_findings,
    apply_variant,
    fit_variants,
    rank_candidates,
    select_model,
    selected_estimation,
    tied_models,
    variants,
    with_model_spread,
)
from seatrial.estimation.identify.score_test import groups_of, holdout_scores
from seatrial.physics.models.abkowitz import abkowitz
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.published import kvlcc2
from seatrial.physics.models.thrusters import thrusters
from seatrial.physics.simulate import replay

RUNS = 6
SETTINGS, OPTIONS = EstimateSettings(segment_s=20.0), EstimatorOptions(workers=1)
LENGTH = 8.0


@pytest.fixture(scope="module")
def model() -> Model:
    """First order with priors, its current fixed at zero."""
    free = nomoto().with_values({"K": 0.15, "T": 8.0, "U": 2.0})
    return free.with_parameters(free.parameters.with_priors({"K": Prior(0.14, 0.05), "T": Prior(8.5, 3.0)}))


@pytest.fixture(scope="module")
def records(model: Model) -> list[Record]:
    made = []
    for i in range(RUNS):
        rng, time = np.random.default_rng(i), 0.5 * np.arange(161)
        delta = 0.3 * np.sign(np.sin(0.12 * time + i))
        truth = replay(model, Record.from_arrays(f"run {i}", time, {"delta": delta}), {"r": 0.0})
        channels = {s: truth[s] + 2e-3 * rng.standard_normal(161) for s in ("r", "psi")}
        channels |= {s: truth[s] + 0.05 * rng.standard_normal(161) for s in ("x0", "y0")}
        made.append(Record.from_arrays(f"run {i}", time, {"delta": delta, "u": np.full(161, 2.0), **channels}))
    return made


@pytest.fixture(scope="module")
def found(model: Model, records: list[Record]) -> Estimation:
    return estimate_model(model, Runs.one_session_each(records, LENGTH), SETTINGS, OPTIONS)


def fitted(found: Estimation, name: str, heading: list[float] | None) -> FittedVariant:
    """A member with these heading errors and positions alike."""
    scores = np.empty((0, 2)) if heading is None else np.stack([heading, heading], axis=1)
    made = None if heading is None else found.estimate
    return FittedVariant(ModelVariant(name), found.model, made, scores, "" if heading else "it diverges")


def test_runs_whose_segments_differ_in_length_are_compared(model: Model, records: list[Record]) -> None:
    """Segments of 20 s cut five runs of 70 s into 17.5 s each and leave one of 27.5 s whole; 17.5 s would halve it."""
    runs = Runs.one_session_each([*(r.rows(slice(0, 141)) for r in records[:5]), records[5].rows(slice(0, 56))], LENGTH)
    settings = replace(SETTINGS, method=EstimateMethod.MULTIPLE_SHOOTING)
    estimation = estimate_model(model, runs, settings, OPTIONS)
    family = ModelFamily({"with current": ("current_north",)})
    members = fit_variants(estimation, model, runs, 20.0, settings, OPTIONS, family)
    assert [m.estimate is not None for m in members[:2]] == [True, True]


def test_members_are_tied_where_runs_cannot_tell_them_apart(found: Estimation) -> None:
    rows = rank_candidates(
        [
            fitted(found, "own", [1.0, 2.0, 3.0, 4.0]),
            fitted(found, "alike", [1.1, 1.8, 3.2, 3.8]),
            fitted(found, "worse in every run", [1.5, 2.5, 3.5, 4.5]),
            fitted(found, "failed", None),
        ],
        choose=False,
    )
    assert [r.is_tied for r in rows] == [True, True, False, False]
    assert [r.is_chosen for r in rows] == [True, False, False, False]
    assert rows[0].heading_deg == pytest.approx(2.5)
    assert rows[3].heading_deg is None and rows[3].note == "it diverges"


def test_the_best_is_chosen_where_it_is_asked_for(found: Estimation) -> None:
    members = [fitted(found, "own", [2.0, 3.0, 4.0]), fitted(found, "better", [1.0, 2.0, 3.0])]
    rows = rank_candidates(members, choose=True)
    assert [r.is_chosen for r in rows] == [False, True]
    assert tied_models(members, rows) == ()


def test_the_simplest_within_one_standard_error_is_chosen(found: Estimation, model: Model) -> None:
    """The richer member is a little better on average, by less than its scatter explains."""
    rich = apply_variant(model, ModelVariant("rich", ("current_north",)))
    better = replace(fitted(found, "rich", [0.5, 3.1, 1.9, 3.6]), model=rich)
    own = fitted(found, "own", [1.0, 2.9, 2.2, 3.4])
    assert [r.is_chosen for r in rank_candidates([own, better], choose=True)] == [True, False]
    surely = replace(fitted(found, "rich", [0.5, 2.4, 1.7, 2.9]), model=rich)
    assert [r.is_chosen for r in rank_candidates([own, surely], choose=True)] == [False, True]


def test_what_no_craft_has_is_not_chosen(found: Estimation) -> None:
    odd = replace(fitted(found, "odd", [0.1, 0.2, 0.3]), objections=("m_x -3 is negative",))
    rows = rank_candidates([fitted(found, "own", [2.0, 3.0, 4.0]), odd], choose=True)
    assert [r.is_chosen for r in rows] == [True, False]
    assert rows[1].note == "m_x -3 is negative"


def test_the_trials_own_model_stays_where_none_is_a_crafts(found: Estimation) -> None:
    why = ("m_x -3 is negative",)
    members = [
        replace(fitted(found, "own", [2.0, 3.0, 4.0]), objections=why),
        replace(fitted(found, "better", [1.0, 2.0, 3.0]), objections=why),
    ]
    rows = rank_candidates(members, choose=True)
    assert [r.is_chosen for r in rows] == [True, False]
    assert [f.severity for f in _choice_findings(members, rows) if f.code == "unphysical-values"] == [Severity.WARNING]


def test_structures_that_gain_are_joined_and_the_gain_is_reported(
    found: Estimation, model: Model, records: list[Record]
) -> None:
    """Nothing but noise is left to explain, so that the search ends after the first pair."""
    declared = ModelFamily({"north": ("current_north",), "east": ("current_east",)})
    runs = Runs.one_session_each(records, LENGTH)
    selected = select_model(found, model, runs, 20.0, SETTINGS, OPTIONS, declared, choose=True)
    names = [row.name for row in selected.candidates]
    assert names[:3] == ["as in the trial", "north", "east"] and len(names) <= 4
    assert selected.candidates[0].gain_percent is None and selected.candidates[0].is_chosen
    assert all(row.gain_percent is not None and abs(row.gain_percent) < 20.0 for row in selected.candidates[1:])
    assert [f.code for f in selected.findings] == ["several-looks"]
    assert f"{len(names)} models were compared" in selected.findings[0].text


def test_runs_are_left_out_by_session_and_by_kind(found: Estimation, records: list[Record]) -> None:
    """Two runs of a session are predicted by the estimate without both; the steering decides of which kind a run is."""
    assert groups_of(["a", "b", "a"]) == [[0, 2], [1]]
    by_pairs = one_step_jackknife(found.estimate, [[0, 1], [2], [3], [4], [5]])
    by_runs = one_step_jackknife(found.estimate)
    np.testing.assert_allclose(by_pairs[1:, :2], by_runs[2:, :2])
    refit = fits_without(found.estimate, [[0, 1]])
    np.testing.assert_allclose(by_pairs[0, :2], refit[0, :2], rtol=0.02)
    scores = holdout_scores(found.estimate, found.model, records, 20.0)
    assert scores.shape == (RUNS, 2)


def test_structures_free_parameters_and_factors_widen_priors(model: Model) -> None:
    wide = apply_variant(model, ModelVariant("wide", prior_factor=3.0)).parameters
    assert wide["K"].prior == Prior(0.14, pytest.approx(0.15))  # type: ignore[arg-type]
    more = apply_variant(model, ModelVariant("more", ("current_north",))).parameters
    assert more["current_north"].free and more["current_north"].prior is not None
    assert more["K"].prior == model.parameters["K"].prior


def test_the_family_of_the_package_knows_its_models(model: Model) -> None:
    names = [v.name for v in variants(abkowitz(), None, is_segmented=True)]
    assert names[0] == "as in the trial" and "cubic rudder" in names
    assert not any(n.startswith("priors") for n in names), "this model has no priors"
    assert [v.name for v in variants(model, None, is_segmented=False)] == [
        "as in the trial",
        "gain that falls with the yaw rate",
        "priors x 0.5",
        "priors x 3",
    ]


def test_built_in_structures_are_those_that_a_model_has() -> None:
    craft = thrusters()
    named = {v.name: v for v in variants(craft, None, is_segmented=False)}
    assert {"side force of thrust", "moment of speed", "sway and yaw coupled"} <= set(named)
    freed = apply_variant(craft, named["moment of speed"]).parameters
    assert freed["N_u"].free and freed["N_uu"].free and freed["N_u"].prior is not None
    assert "even terms" in [v.name for v in variants(kvlcc2(), None, is_segmented=True)]
    without = craft.with_parameters(craft.parameters.freed("Y_T"))
    assert "side force of thrust" not in [v.name for v in variants(without, None, is_segmented=False)]


def test_a_declared_family_is_fitted_and_scored(found: Estimation, model: Model, records: list[Record]) -> None:
    declared = ModelFamily({"stream": ("current_north", "current_east")})
    runs, options = Runs.one_session_each(records, LENGTH), [replace(OPTIONS, workers=w) for w in (1, 2)]
    made = [fit_variants(found, model, runs, 20.0, SETTINGS, one, declared) for one in options]
    rows = rank_candidates(made[0], choose=False)
    assert [r.name for r in rows] == ["as in the trial", "stream"]
    assert [r.free_count for r in rows] == [2, 4]
    assert rows == rank_candidates(made[1], choose=False)
    assert all(r.heading_deg is not None and r.heading_deg < 2.0 for r in rows)


def test_a_family_of_one_is_refused(found: Estimation, model: Model, records: list[Record]) -> None:
    with pytest.raises(InputError, match=r"model 'nomoto' has no family to choose from; declare \[family\]"):
        fit_variants(found, model, Runs.one_session_each(records, LENGTH), 20.0, SETTINGS, OPTIONS, ModelFamily())


def test_a_family_whose_members_all_fail_is_refused(found: Estimation, model: Model, records: list[Record]) -> None:
    """Windows longer than any run: nobody can be judged."""
    declared, runs = ModelFamily({"north": ("current_north",)}), Runs.one_session_each(records, LENGTH)
    with pytest.raises(InputError, match=r"no member of the family can be fitted; the first fails because no run"):
        fit_variants(found, model, runs, 500.0, SETTINGS, OPTIONS, declared)


def test_the_scatter_of_tied_models_is_added(found: Estimation) -> None:
    i, optimum = found.estimate.problem.free.index("K"), found.estimate.optimum
    point = optimum.solution.point + 0.02 * np.eye(len(optimum.solution.point))[i]
    away = replace(found.estimate, optimum=replace(optimum, solution=replace(optimum.solution, point=point)))
    widened = with_model_spread(found, [away])
    added = widened.interval.covariance[i, i] - found.interval.covariance[i, i]
    assert added == pytest.approx(0.02**2)
    assert widened.interval.meaning.endswith("with the spread of 1 tied model")
    assert with_model_spread(found, []) is found


def test_the_trials_own_model_stays_where_it_cannot_be_judged(found: Estimation, records: list[Record]) -> None:
    members = [fitted(found, "own", None), fitted(found, "other", [1.0, 2.0, 3.0])]
    rows = rank_candidates(members, choose=False)
    assert [(r.is_chosen, r.is_tied, r.note) for r in rows] == [(True, False, "it diverges"), (False, True, "")]
    runs = Runs.one_session_each(records, LENGTH)
    assert selected_estimation(found, members, rows, runs, SETTINGS, OPTIONS) is found
    assert tied_models(members, rows) == (found.estimate,)


def test_a_structure_may_be_called_like_another_member(found: Estimation) -> None:
    members = [fitted(found, "as in the trial", [2.0, 3.0, 4.0]), fitted(found, "as in the trial", [1.0, 2.0, 3.0])]
    for choose in (False, True):
        rows = rank_candidates(members, choose=choose)
        assert [r.is_chosen for r in rows] == [not choose, choose]
        assert [r.is_tied for r in rows] == [False, True]


@pytest.mark.parametrize("seconds", [20.0, None])
def test_a_chosen_segment_length_is_that_which_was_compared(
    model: Model, records: list[Record], seconds: float | None
) -> None:
    """Also where the trial leaves the length to the house."""
    runs = Runs.one_session_each(records, LENGTH)
    settings = EstimateSettings(segment_s=seconds, method=EstimateMethod.MULTIPLE_SHOOTING)
    own = estimate_model(model, runs, settings, OPTIONS)
    members = fit_variants(own, model, runs, 20.0, settings, OPTIONS)
    rows = [replace(row, is_chosen=row.name == "segments x 0.7") for row in rank_candidates(members, choose=False)]
    used = selected_estimation(own, members, rows, runs, settings, OPTIONS)
    (half,) = [m.estimate for m in members if m.variant.name == "segments x 0.7"]
    assert half is not None
    assert used.estimate.problem.data.count == half.problem.data.count > own.estimate.problem.data.count


def with_gap(record: Record, rows: slice) -> Record:
    """Heading not measured in these rows."""
    channel = record.channel("psi")
    values = channel.values.copy()
    values[rows] = np.nan
    return record.with_channel("psi", channel.with_values(values))


def test_windows_without_heading_judge_nobody(model: Model, records: list[Record]) -> None:
    """A gap over a whole window of 20 s leaves the run's other windows; a run without any is named."""
    gappy = [with_gap(records[0], slice(50, 100)), *records[1:]]
    found = estimate_model(model, Runs.one_session_each(gappy, LENGTH), SETTINGS, OPTIONS)
    scores = holdout_scores(found.estimate, model, gappy, 20.0)
    assert np.all(np.isfinite(scores))
    assert np.all(scores < 2.0)
    with pytest.raises(InputError, match="'run 0' has no window in which both position and heading"):
        holdout_scores(found.estimate, model, [with_gap(records[0], slice(None)), *records[1:]], 20.0)


def test_a_model_that_is_worse_than_another_is_said(found: Estimation) -> None:
    rows = rank_candidates(
        [fitted(found, "own", [2.0, 3.1, 4.0]), fitted(found, "better", [1.0, 2.0, 3.0])], choose=False
    )
    (said,) = _better_candidate_warning(rows)
    assert said.code == "better-model" and "'better'" in said.message and "2 deg against 3.03 deg" in said.evidence
    assert (
        _better_candidate_warning(
            rank_candidates([fitted(found, "own", [1.0, 2.0]), fitted(found, "other", [1.1, 1.9])], choose=False)
        )
        == ()
    )
