"""Published methods on a user's records: beside the package's own estimate, refused where they cannot serve."""

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.fits import example_fit

from seatrial.core.results import Fit
from seatrial.core.results.comparison import coefficient_comparison, cost_comparison
from seatrial.core.values import InputError
from seatrial.data.folder.document import document
from seatrial.data.folder.result_folder import load_fit, save_result
from seatrial.data.trial import (
    SEARCHES,
    EstimateMethod,
    EstimateSettings,
    OwnEstimate,
    SearchFitness,
    SearchSettings,
    Trial,
    load_trial,
)
from seatrial.estimation.identify import baselines, identify
from seatrial.estimation.identify import search as search_problem
from seatrial.estimation.identify import search as search_strategy
from seatrial.estimation.identify.identification import Situation
from seatrial.estimation.identify.search import search_findings
from seatrial.estimation.regress import estimator_named
from seatrial.reporting.page import html

FEW = SearchSettings(population=12, iterations=6, restarts=2)


def example(repository: Path, name: str, method: EstimateMethod, search: SearchSettings | None = FEW) -> Trial:
    trial = load_trial(repository / "examples" / f"{name}.toml")
    return replace(trial, estimate=EstimateSettings(method=method, search=search))


@pytest.fixture(scope="module")
def own() -> Fit:
    return example_fit("heave_pitch")


@pytest.fixture
def kept_own(own: Fit, monkeypatch: pytest.MonkeyPatch) -> None:
    """The package's own estimate of the example in waves is not made anew."""
    strategies = {**identify.__globals__["STRATEGIES"], Situation.RECORDED_WAVES: lambda _: own}
    monkeypatch.setitem(identify.__globals__, "STRATEGIES", strategies)


@pytest.fixture(scope="module")
def horses(repository: Path) -> Fit:
    return identify(example(repository, "heave_pitch", EstimateMethod.IWHO), seed=3)


def test_the_packages_own_estimate_stands_in_the_fit_unchanged(own: Fit, horses: Fit) -> None:
    reference = horses.reference
    assert reference is not None
    assert reference.coefficients == own.coefficients
    assert reference.method == own.method
    assert reference.evaluations == own.solution.evaluations
    assert reference.rms == {p.record: p.rms for p in own.predictions}
    assert reference.cpu_s > 0.0


def test_the_methods_coefficients_have_no_intervals_and_lie_in_their_ranges(horses: Fit) -> None:
    search = horses.search
    assert search is not None
    for c in horses.coefficients:
        assert c.standard_error is c.lower is c.upper is None
        if not c.fixed:
            lower, upper = search.bounds[c.name]
            assert lower <= c.estimate <= upper
    assert horses.covariance.size == 0
    assert horses.identifiability is None
    assert horses.method.name == "iwho"


def test_what_only_the_own_estimate_has_does_not_stand_for_the_method(own: Fit, horses: Fit) -> None:
    assert own.k_step_errors or own.frequency_responses
    assert not horses.k_step_errors and not horses.frequency_responses


def test_evaluations_history_and_scatter_are_those_of_the_restarts(horses: Fit) -> None:
    search = horses.search
    assert search is not None
    # 9 foals and 3 leaders in each of 6 iterations
    assert [one.evaluations for one in search.restarts] == [72, 72]
    assert search.evaluations == horses.solution.evaluations == 144
    best = min(range(2), key=lambda k: search.restarts[k].history[-1])
    assert search.used == best
    assert search.history == search.restarts[best].history
    assert list(search.history) == sorted(search.history, reverse=True)
    assert search.history[-1] == pytest.approx(search.restarts[best].record_rms, rel=1e-12)
    first, second = (np.array(list(one.values.values())) for one in search.restarts)
    np.testing.assert_allclose(list(search.scatter.values()), np.abs(first - second) / np.sqrt(2.0), rtol=1e-12)


def test_document_and_folder_keep_method_search_and_reference(horses: Fit, tmp_path: Path) -> None:
    table = document(horses)
    assert table["method"]["name"] == "iwho"
    assert len(table["search"]["history"]) == 6
    assert {"evaluations", "history", "cpu_s"} <= set(table["search"])
    assert table["reference"]["coefficients"][0]["standard_error"] > 0.0
    json.dumps(table, allow_nan=False)
    again = load_fit(save_result(horses, tmp_path / "result"))
    assert (again.search, again.reference, again.method) == (horses.search, horses.reference, horses.method)


def test_one_table_shows_both_estimates_with_effort_and_errors(horses: Fit) -> None:
    assert horses.reference is not None
    coefficients = coefficient_comparison(horses, horses.reference)
    assert coefficients.header[:5] == ("coefficient", "iwho", "scatter", "seatrial", "std. error")
    assert len(coefficients.rows) == 8
    cost = cost_comparison(horses, horses.reference)
    assert [row[:2] for row in cost.rows] == [("iwho", "144"), ("seatrial", str(horses.reference.evaluations))]
    assert {len(row) for row in cost.rows} == {len(cost.header)}


@pytest.mark.usefixtures("kept_own")
@pytest.mark.parametrize("method", [m for m in SEARCHES if m is not EstimateMethod.IWHO])
def test_every_search_runs_on_the_shipped_example(repository: Path, method: EstimateMethod) -> None:
    fit = identify(example(repository, "heave_pitch", method, replace(FEW, restarts=1)))
    assert fit.search is not None
    assert fit.search.scatter == {}
    assert np.isfinite(fit.search.history).all()


def test_a_search_of_a_nonlinear_model_minimises_the_rms_over_the_record(repository: Path) -> None:
    settings = SearchSettings(population=6, iterations=2, restarts=1)
    fit = identify(example(repository, "waterjet", EstimateMethod.PSO, settings))
    assert fit.search is not None
    training = [p for p in fit.predictions if p.role == "training"]
    residuals = np.concatenate([
        (p.simulated[name] - p.measured[name]) / deviation
        for p in training for name, deviation in fit.search.weights.items()
    ])  # fmt: skip
    assert fit.search.history[-1] == pytest.approx(np.sqrt(np.nanmean(residuals**2)), rel=1e-9)


def test_a_regression_gives_the_values_of_its_estimator_and_names_those_beyond_bounds(repository: Path) -> None:
    fit = identify(example(repository, "waterjet", EstimateMethod.OLS, None))
    beyond = {p.name for p in fit.model.parameters.free if not p.lower <= p.value <= p.upper}
    assert beyond == {f.message.split()[3] for f in fit.findings if f.code == "outside-bounds"}
    training = [p.measured for p in fit.predictions if p.role == "training"]
    named = estimator_named("central differences, least squares", 1.0).estimate(fit.model, training)
    np.testing.assert_allclose(list(fit.params.values()), named.values, rtol=1e-9)
    assert fit.search is None
    assert fit.method.intervals.startswith("none")
    assert fit.method.name == "ols"


@pytest.mark.usefixtures("kept_own")
def test_sample_by_sample_each_iteration_has_a_sample_of_its_own(repository: Path) -> None:
    settings = replace(FEW, fitness=SearchFitness.SAMPLE)
    fit = identify(example(repository, "heave_pitch", EstimateMethod.IWHO, settings))
    search = fit.search
    assert search is not None
    # remembered leaders are judged again from the second iteration on: 12 + 5 (12 + 3)
    assert [one.evaluations for one in search.restarts] == [87, 87]
    assert search.used == 0
    assert {len(values) for values in search.trace.values()} == {6}


@pytest.mark.usefixtures("kept_own")
def test_finished_restarts_are_kept_when_the_user_interrupts(repository: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run, calls = search_strategy.run_search, []

    def interrupted(*args: object) -> object:
        calls.append(1)
        if len(calls) == 2:
            raise KeyboardInterrupt
        return run(*args)  # type: ignore[arg-type]

    monkeypatch.setattr(search_strategy, "run_search", interrupted)
    fit = identify(example(repository, "heave_pitch", EstimateMethod.DE))
    assert fit.search is not None
    assert fit.search.is_interrupted
    assert len(fit.search.restarts) == 1
    assert "interrupted" in [f.code for f in fit.findings]
    monkeypatch.setattr(search_strategy, "run_search", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
    with pytest.raises(KeyboardInterrupt):
        identify(example(repository, "heave_pitch", EstimateMethod.DE))


@pytest.mark.usefixtures("kept_own")
def test_progress_names_search_and_iteration(repository: Path) -> None:
    lines: list[str] = []
    identify(
        example(repository, "heave_pitch", EstimateMethod.PSO, replace(FEW, restarts=1)), report_progress=lines.append
    )
    assert any(re.match(r"pso, search 1 of 1: iteration 6 of 6, best ", line) for line in lines)
    assert all(line.startswith(("own estimate: ", "pso, search 1 of 1: ")) for line in lines)


def free_bounds(trial: Trial, **bounds: tuple[float, float]) -> Trial:
    search = replace(FEW, bounds=bounds)
    model = trial.model.with_parameters(trial.model.parameters.bounded("b33", -np.inf, np.inf))
    return replace(trial, model=model, estimate=replace(trial.estimate, search=search))


@pytest.mark.usefixtures("kept_own")
@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda t: replace(t, estimate=EstimateSettings(method="svr", search=FEW)),
         "[estimate.search] is not used by method 'svr'; remove the table, or write method = \"iwho\""),
        (lambda t: replace(t, estimate=EstimateSettings(search=FEW)),
         "[estimate.search] is not used by method 'auto'"),
        (free_bounds,
         "method 'iwho' searches within bounds, which b33 lacks; add [estimate.search.bounds] b33 = [lower, upper]"),
        (lambda t: free_bounds(t, b_33=(0.0, 1.0)), "[estimate.search.bounds] names 'b_33', no free coefficient; did"),
        (lambda t: replace(t, estimate=EstimateSettings(method="iwho", search=SearchSettings(population=3))),
         "[estimate.search]: the wild horse optimiser needs 3 groups or more"),
        (lambda t: replace(t, estimate=EstimateSettings(method="cma-es", search=SearchSettings(population=3))),
         "[estimate.search]: the evolution strategy needs at least 4 points a generation, not 3"),
        (lambda t: replace(t, estimate=EstimateSettings(method="svr")), "method 'svr': "),
    ],
)  # fmt: skip
def test_what_a_method_cannot_do_is_one_sentence(
    repository: Path, change: Callable[[Trial], Trial], sentence: str
) -> None:
    trial = change(example(repository, "heave_pitch", EstimateMethod.IWHO))
    with pytest.raises(InputError) as raised:
        identify(trial)
    assert str(raised.value).startswith(sentence)
    assert "\n" not in str(raised.value)


def test_options_of_the_own_estimate_are_refused(repository: Path) -> None:
    with pytest.raises(InputError, match="--compare goes with the package's own estimate, and method 'iwho'"):
        identify(example(repository, "heave_pitch", EstimateMethod.IWHO), compare=True)


@pytest.mark.usefixtures("kept_own")
def test_a_comparison_in_waves_lists_the_searches_behind_the_own_fit(
    repository: Path, own: Fit, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(baselines, "SEARCHES", (EstimateMethod.DE,))
    trial = example(repository, "heave_pitch", EstimateMethod.AUTO)
    compared = baselines.with_search_baselines(own, trial, 3)
    fit_row, found = compared.baselines
    assert fit_row.is_fit
    assert found.name == "differential evolution (de)"
    assert set(found.training.rms) == {"z", "theta_deg"}
    alone = identify(example(repository, "heave_pitch", EstimateMethod.DE, replace(FEW, restarts=1)), seed=3)
    assert found.values == alone.params
    no_box = baselines.with_search_baselines(own, free_bounds(trial), 3)
    assert "b33 lacks" in no_box.baselines[1].note


def test_channels_count_by_their_noise_where_all_are_stated(repository: Path) -> None:
    trial = example(repository, "heave_pitch", EstimateMethod.IWHO)
    measured = [np.array([[1.0, 10.0], [-1.0, -10.0]])]
    spread = search_problem.channel_weights(trial, ("z", "theta"), measured)
    assert spread == {"z": 1.0, "theta": 10.0}
    noisy = replace(trial, noise={"z": 0.01, "theta": 0.002})
    assert search_problem.channel_weights(noisy, ("z", "theta"), measured) == {"z": 0.01, "theta": 0.002}
    half = replace(trial, noise={"z": 0.01})
    assert search_problem.channel_weights(half, ("z", "theta"), measured) == spread


def test_without_the_own_estimate_a_method_stands_alone(repository: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def none_is_made(_: object) -> Fit:
        raise AssertionError("the package's own estimate was made")

    monkeypatch.setitem(identify.__globals__, "STRATEGIES", dict.fromkeys(Situation, none_is_made))
    trial = example(repository, "heave_pitch", EstimateMethod.IWHO)
    alone = identify(replace(trial, estimate=replace(trial.estimate, own_estimate=OwnEstimate.NONE)), seed=3)
    assert alone.reference is None and alone.search is not None
    assert alone.params == dict(zip(trial.model.parameters.free_names, alone.solution.point.tolist(), strict=True))
    assert {p.role for p in alone.predictions} == {"training", "validation"}
    training = [p for p in alone.predictions if p.role == "training"]
    weights = alone.search.weights
    squares = [((p.simulated[n] - p.measured[n]) / weights[n]) ** 2 for p in training for n in weights]
    assert np.sqrt(np.nanmean(np.concatenate(squares))) == pytest.approx(alone.search.history[-1], rel=1e-6)
    assert "The package’s own estimate was not made" in html(alone)


@pytest.mark.usefixtures("kept_own")
def test_a_method_may_run_before_the_own_estimate_and_its_findings_say_whose_they_are(
    repository: Path, own: Fit
) -> None:
    trial, lines = example(repository, "heave_pitch", EstimateMethod.IWHO), list[str]()
    first_method = replace(trial, estimate=replace(trial.estimate, own_estimate=OwnEstimate.AFTER))
    fit = identify(first_method, seed=3, report_progress=lines.append)
    alone = identify(replace(trial, estimate=replace(trial.estimate, own_estimate=OwnEstimate.NONE)), seed=3)
    assert fit.params == alone.params
    assert fit.reference is not None and fit.reference.coefficients == own.coefficients
    assert any(line.startswith("iwho: a33 ") for line in lines)
    owners = {f.message.split(":")[0] for f in fit.findings if f.code in {one.code for one in own.findings}}
    assert owners <= {"own estimate", "method iwho"} | {f.message.split(":")[0] for f in own.findings}
    assert {f.message.split(":")[0] for f in fit.findings if f.code == "bound-hit"} <= {"method iwho"}


def test_a_method_takes_the_constants_that_its_source_names(repository: Path) -> None:
    trial = example(
        repository, "heave_pitch", EstimateMethod.IWHO, replace(FEW, constants={"P_S": 0.4, "omega_max": 0.7})
    )
    alone = identify(replace(trial, estimate=replace(trial.estimate, own_estimate=OwnEstimate.NONE)))
    assert alone.method.settings | {"P_S": 0.4, "P_C": 0.13, "omega_min": 0.1, "omega_max": 0.7, "scatter": 0.05} == (
        alone.method.settings
    )
    with pytest.raises(
        InputError, match=r"\[estimate.search\]: the improved wild horse optimiser has no constant 'A'; "
    ):
        identify(example(repository, "heave_pitch", EstimateMethod.IWHO, replace(FEW, constants={"A": 0.4})))


def test_one_sample_an_iteration_advises_no_wider_bounds(horses: Fit) -> None:
    assert horses.search is not None
    bounds = {name: (value, value + 1.0) for name, value in horses.params.items()}
    on_ends, point = replace(horses.search, bounds=bounds), horses.solution.point
    assert {f.advice for f in search_findings(on_ends, point, 2)} == {"widen its range under [estimate.search.bounds]"}
    for finding in search_findings(replace(on_ends, fitness="sample"), point, 2):
        assert "widen" not in finding.advice and 'fitness = "record"' in finding.advice
