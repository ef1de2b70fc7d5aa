"""What is said of coefficients the records do not tell, of offsets over sessions, and of two fits compared."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.reporting.fabricated import fabricated_fit

from seatrial.core.results import Coefficient, Fit, OffsetPopulation
from seatrial.core.values import InputError, Prior, Ship
from seatrial.data.trial import EstimateSettings
from seatrial.estimation.estimate import EstimatorOptions, Runs, estimate_model
from seatrial.estimation.identify.fit_result import (
    bounds_hit,
    changes,
    coefficient_differences,
    coefficients,
    compared_fit,
    findings,
    offset_populations,
    open_signs,
    refuse_unidentified,
    unconverged,
)
from seatrial.estimation.information.covariance import Interval
from seatrial.numerics.optimise import Status
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models import model_named
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.waterjet import WATERJET_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate.steer import manoeuvre

VALUES = waterjet().parameters


def found(share: dict[str, float], held: str = "") -> Any:
    """An estimate whose relative standard errors are `share`, .1 elsewhere; `held` has a prior."""
    items = [SimpleNamespace(prior=Prior(0.0, 1.0) if p.name == held else None, name=p.name) for p in VALUES]
    parameters = {item.name: item for item in items}
    shared = np.array([VALUES[n].value for n in COEFFICIENTS])
    errors = np.abs(shared) * np.array([share.get(n, 0.1) for n in COEFFICIENTS])
    problem = SimpleNamespace(
        free=COEFFICIENTS,
        model=SimpleNamespace(parameters=parameters, states=("u",), input_names=()),
        data=SimpleNamespace(outputs=("u", "r")),
        noise=np.array([1.0, 0.09]),
    )
    return SimpleNamespace(
        estimate=SimpleNamespace(problem=problem, common_parameters=shared),
        interval=SimpleNamespace(standard_error=errors),
    )


def table(ends: dict[str, tuple[float, float]], held: str = "") -> list[Coefficient]:
    """Coefficients 1 with intervals from 0.9 to 1.1, or these ends; `held` has a prior."""
    return [
        Coefficient(n, "1", 1.0, 0.05, *ends.get(n, (0.9, 1.1)), False, prior_mean=0.0 if n == held else None)
        for n in COEFFICIENTS
    ]


def test_intervals_that_exclude_zero_are_no_finding() -> None:
    assert open_signs(waterjet(), table({})) == []


def test_coefficients_whose_sign_is_open_are_named() -> None:
    """Not the one a prior holds."""
    ends = dict.fromkeys(("X_rr", "Y_vr", "X_vv"), (-0.5, 2.5))
    (finding,) = open_signs(waterjet(), table(ends, held="X_vv"))
    assert finding.code == "sign-open"
    assert finding.text == "the 95 % intervals of X_rr and Y_vr contain 0"
    (one,) = open_signs(waterjet(), table({"X_rr": (-0.1, 3.0)}))
    assert one.text == "the 95 % interval of X_rr contains 0"


def test_nothing_stated_is_refused_with_names_and_noise() -> None:
    """All eleven."""
    with pytest.raises(InputError, match=r"determine none of the free coefficients X_uu, .*N_rr: .*u 1, r 0\.09"):
        refuse_unidentified(found(dict.fromkeys(COEFFICIENTS, 5.0)))


@pytest.mark.parametrize(
    ("status", "is_settled", "codes"),
    [
        (Status.CONVERGED, True, []),
        (Status.EXHAUSTED, True, ["not-converged"]),
        (Status.CONVERGED, False, ["noise-not-settled"]),
    ],
)
def test_a_search_at_its_limit_and_noise_that_changes_are_warned_of(
    status: Status, is_settled: bool, codes: list[str]
) -> None:
    optimum = SimpleNamespace(solution=SimpleNamespace(status=status))
    estimation: Any = SimpleNamespace(estimate=SimpleNamespace(optimum=optimum, is_settled=is_settled))
    assert [f.code for f in unconverged(estimation)] == codes


@pytest.mark.parametrize(("bound", "says"), [(-1e9, "widen the bound under"), (0.0, "the bound is the model's own")])
def test_a_bound_of_the_model_is_not_to_be_widened(bound: float, says: str) -> None:
    """The first is a bound of the trial, the second one that the model has by itself."""
    model = model_named("thrusters")
    (name, *_) = (p.name for p in model.parameters.free if p.lower == 0.0)
    problem = SimpleNamespace(model=model, free=(name,), lower=np.array([bound]), upper=np.array([np.inf]))
    normal = SimpleNamespace(without_local=lambda: (np.array([3.0]), np.array([[1.0]])))
    estimate = SimpleNamespace(
        problem=problem, common_parameters=np.array([bound]), optimum=SimpleNamespace(normal=normal)
    )
    (finding,) = bounds_hit(SimpleNamespace(estimate=estimate))  # type: ignore[arg-type]
    assert says in finding.advice
    assert f"{name} is not determined by these records: it ends on its lower bound" in finding.text


def test_what_ends_on_a_bound_has_no_interval_but_that_of_a_profile() -> None:
    model = model_named("nomoto")
    problem = SimpleNamespace(model=model, free=("K", "T"), lower=np.array([-1.0, 5.0]), upper=np.array([1.0, 50.0]))
    estimation: Any = SimpleNamespace(
        estimate=SimpleNamespace(problem=problem, common_parameters=np.array([0.1, 5.0])),
        interval=Interval(np.diag([1e-4, 0.25]), np.inf, "test"),
    )
    known, stopped = (c for c in coefficients(estimation, {}) if not c.fixed)
    assert (known.standard_error, known.lower is None) == (pytest.approx(0.01), False)
    assert (stopped.estimate, stopped.standard_error, stopped.lower, stopped.upper) == (5.0, None, None, None)
    profiled = coefficients(estimation, {}, {"T": (None, 6.0)})
    assert next(c for c in profiled if c.name == "T").upper == 6.0


def other_day(fit: Fit) -> Fit:
    """The fit with a coefficient moved by five standard errors, another draught, and records of its own."""
    moved = tuple(
        replace(c, estimate=c.estimate + 5.0 * c.standard_error, lower=c.lower + 5.0 * c.standard_error,
                upper=c.upper + 5.0 * c.standard_error)
        if c.name == "N_r" and c.standard_error and c.lower is not None and c.upper is not None else c
        for c in fit.coefficients
    )  # fmt: skip
    ship = Ship(fit.ship.name, dict(fit.ship.particulars) | {"d": 0.6}, fit.ship.source)
    records = tuple(r.rows(slice(5, None)).renamed(f"{r.name}_b") for r in fit.records)
    method = replace(fit.method, criterion="prediction error")
    return replace(fit, coefficients=moved, ship=ship, records=records, method=method, predictions=())


def test_the_coefficient_that_moved_is_significant() -> None:
    first = fabricated_fit()
    rows, test = coefficient_differences(first, other_day(first))
    assert [r.name for r in rows if r.is_significant] == ["N_r"]
    assert len(rows) == sum(not c.fixed for c in first.coefficients)
    assert test is not None
    assert test.p < 0.05
    same, test = coefficient_differences(first, first)
    assert all(r.difference == 0.0 for r in same)
    assert test is not None
    assert (test.statistic, test.p) == (0.0, 1.0)


def test_what_else_changed_is_named() -> None:
    first = fabricated_fit()
    texts = changes(first, other_day(first))
    assert "criterion: output error over whole runs → prediction error" in texts
    assert "particulars: d 0.71 → 0.6" in texts
    assert any(
        text.startswith("training runs: zigzag_10_10, zigzag_20_20, zigzag_30_30 → zigzag_10_10_b") for text in texts
    )
    assert changes(first, first) == ()
    assert compared_fit(first, "a").records == ("zigzag_10_10", "zigzag_20_20", "zigzag_30_30")


def test_shared_records_are_a_warning() -> None:
    first = fabricated_fit()
    assert [f.code for f in findings(first, first)] == ["shared-records"]
    assert findings(first, other_day(first)) == ()


HELM = np.array([8.0, 12.0, 16.0, 20.0, 24.0])
ZEROS = np.radians([1.4, 1.15, 1.0, 0.75, 0.6])
"""Zeros of the rudder that fall with the helm, 0.2 deg for a standard deviation of it."""


def populations(covariates: dict[str, str]) -> tuple[OffsetPopulation, ...]:
    """Of zigzags whose recorded rudder angle lacks the zero of their session."""
    truth = nomoto().with_values({"K": 0.15, "T": 8.0, "U": 1.0})
    records = []
    for i, (helm, zero) in enumerate(zip(HELM, ZEROS, strict=True)):
        run = manoeuvre(truth, programme(f"zigzag:{helm:g}/10"), dt=0.5, speed=1.0, duration=90.0).renamed(f"run_{i}")
        records.append(run.with_channel("delta", run.channel("delta").with_values(run["delta"] - zero)))
    offsets, timing = {"delta": np.radians(2.0)}, {"delta": 0.0}
    settings = EstimateSettings(method="output-error", offsets=offsets, covariates=covariates, delays=timing)
    runs = Runs.one_session_each(records, 7.0)
    return offset_populations(estimate_model(truth, runs, settings, EstimatorOptions(workers=1)))


def test_mean_and_deviation_stand_in_the_fit() -> None:
    (zero,) = populations({})
    assert (zero.name, zero.unit, zero.covariate, zero.slope) == ("delta zero", "rad", "", None)
    assert zero.mean == pytest.approx(ZEROS.mean(), rel=0.02)
    assert zero.deviation == pytest.approx(np.std(ZEROS, ddof=1), rel=0.5)


def test_a_slope_stands_with_its_error_and_what_it_is_worth() -> None:
    (zero,) = populations({"delta": "delta"})
    assert zero.covariate == "delta"
    assert zero.slope is not None
    assert zero.slope_standard_error is not None
    assert np.degrees(zero.slope) == pytest.approx(-0.28, abs=0.05)  # of all five, by a line through them
    assert abs(zero.slope) > 3.0 * zero.slope_standard_error
