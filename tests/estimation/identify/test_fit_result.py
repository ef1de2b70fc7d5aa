"""What is said of coefficients the records do not tell: a warning for some, a refusal where it is all of them."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from seatrial.core.results import Coefficient
from seatrial.core.values import InputError, Prior
from seatrial.estimation.identify.fit_result import (
    bounds_hit,
    coefficients,
    open_signs,
    refuse_unidentified,
    unconverged,
)
from seatrial.estimation.information.covariance import Interval
from seatrial.numerics.optimise import Status
from seatrial.physics.models import model_named
from seatrial.physics.models.waterjet import WATERJET_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models.waterjet import waterjet

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
