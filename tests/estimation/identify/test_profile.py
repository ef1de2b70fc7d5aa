"""Few memories of a disturbance and few changes of a reference: profiles in place of the information, and a warning."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from standard_craft import NOMOTO

from seatrial.core.results import Profile
from seatrial.core.results.coefficients import FeedbackEvidence
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.fit import estimate_model
from seatrial.estimation.estimate.settings import EstimatorOptions
from seatrial.estimation.identify import nonlinear_intervals
from seatrial.estimation.identify.assembled_fit import widened_ends
from seatrial.estimation.identify.nonlinear_intervals import default_profiles, short_record_findings
from seatrial.estimation.information.covariance import Interval
from seatrial.numerics.optimise import Status
from seatrial.problems.disturbed_craft import Disturbance, independent_nomoto

PROFILE = Profile("K", (0.1, 0.2), (0.0, 4.0), None, 0.19)


def estimation(memory: float, *, steps: int | None = None) -> Any:
    """What is read of an estimation over 600 s."""
    data = SimpleNamespace(inputs=np.zeros((6000, 1)), dt=0.1)
    loop = None if steps is None else FeedbackEvidence("delta", "psi", ("run",), reference_steps=steps)
    return SimpleNamespace(
        estimate=SimpleNamespace(problem=SimpleNamespace(data=data, free=("K", "T"))),
        noise_model=SimpleNamespace(added={"gust_memory_r": memory, "wave_frequency": 900.0}, closed_loop=loop),
        process_noise=None,
        has_process_noise=False,
    )


@pytest.mark.parametrize(("memory", "count"), [(5.0, 0), (15.0, 0), (16.0, 1)])
def test_few_memories_are_warned_of(memory: float, count: int) -> None:
    """A record of 600 s has 40 memories of 15 s."""
    findings = short_record_findings(estimation(memory), ())
    assert [f.code for f in findings] == ["few-memories"] * count
    assert all("--intervals profile" in f.message for f in findings)


def test_few_changes_of_the_reference_are_warned_of() -> None:
    (finding,) = short_record_findings(estimation(5.0, steps=3), (PROFILE,))
    assert finding.code == "few-reference-steps"
    assert "intervals come from a profile likelihood" in finding.message
    assert short_record_findings(estimation(5.0, steps=4), ()) == []


def test_without_a_disturbance_there_is_no_profile() -> None:
    assert default_profiles(estimation(16.0)) == ()


@pytest.mark.parametrize(
    ("share", "count", "status", "profiles"),
    [
        (0.05, 2, Status.CONVERGED, ()),
        (0.2, 2, Status.CONVERGED, (PROFILE,)),
        (0.2, 7, Status.CONVERGED, ()),
        (0.2, 2, Status.EXHAUSTED, ()),
    ],
)
def test_vague_coefficients_have_profiles(
    share: float, count: int, status: Status, profiles: tuple[Profile, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Standard errors of a fifth of the estimates, of a few coefficients, where the search converged."""
    monkeypatch.setattr(nonlinear_intervals, "innovation_profiles", lambda *_: (PROFILE,))
    one = estimation(5.0)
    one.process_noise, one.has_process_noise = object(), True
    one.interval = SimpleNamespace(standard_error=share * np.ones(count))
    one.estimate.common_parameters = -np.ones(count)
    one.estimate.problem.free = tuple("abcdefg"[:count])
    one.estimate.optimum = SimpleNamespace(solution=SimpleNamespace(status=status))
    assert default_profiles(one) == profiles


def test_a_profile_of_prediction_error_has_the_curvature_of_its_information() -> None:
    """A standard error away the loss is one of chi squared's units, with all else fitted again."""
    craft = NOMOTO
    (run,) = independent_nomoto(
        craft, Disturbance(0.5, 5.0), 1, np.random.default_rng(11), is_closed=False, seconds=120.0
    )
    fitted = estimate_model(
        craft.model.with_values(dict(craft.guess)),
        Runs.one_session_each([run], craft.length),
        options=EstimatorOptions(workers=1),
    )
    profiles = default_profiles(fitted)
    assert [p.parameter for p in profiles] == ["K", "T"]
    for p, error in zip(profiles, fitted.interval.standard_error, strict=False):
        values, costs = np.array(p.values), np.array(p.costs)
        centre = values[np.argmin(costs)]
        near = np.isclose(np.abs(values - centre), error, rtol=1e-6)
        assert near.sum() == 2
        assert np.mean(costs[near]) == pytest.approx(1.0, rel=0.15)
        assert p.lower is not None
        assert p.lower < centre
        assert p.upper is None or p.upper > centre


def test_unknowns_on_a_bound_stay_while_another_is_held() -> None:
    """The delay of a stepped input ends on half a sample: no refit may begin beyond it."""
    hessian = np.array([[4.0, 1.0, 1.0], [1.0, 2.0, 0.5], [1.0, 0.5, 2.0]])
    optimum = nonlinear_intervals._Refit(0.0, np.array([0.1, 0.25, 1.0]), np.zeros((0, 0)))
    bounds = np.array([-1.0, -0.25, -9.0]), np.array([1.0, 0.25, 9.0])
    fit = nonlinear_intervals._ProfiledFit(("K",), optimum, *bounds, np.ones(3), hessian, lambda _: None, 1)  # type: ignore[arg-type,return-value]
    assert fit.others_by(0) == pytest.approx([0.0, -0.5])


def test_ends_go_out_with_what_widens_the_standard_errors() -> None:
    """Errors that no profile knows add as squares, on the side that a profile leaves open nothing."""

    def of_error(error: float) -> Any:
        estimate = SimpleNamespace(
            problem=SimpleNamespace(free=("K", "T")), common_parameters=np.array([0.2, 8.0, 0.0])
        )
        interval = Interval(np.diag([error**2, 1.0, 1.0]), np.inf, "")
        return SimpleNamespace(estimate=estimate, interval=interval)

    ends = widened_ends({"K": (0.17, None), "T": (7.0, 9.5)}, of_error(0.01), of_error(math.hypot(0.01, 0.04 / 1.96)))
    assert ends["K"] == (pytest.approx(0.15, abs=1e-4), None) and ends["T"] == (7.0, 9.5)
