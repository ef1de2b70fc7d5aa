"""What a fit warns of where a controller was on, from the sentences of the loop and from a whole identification."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from standard_craft import NOMOTO

import seatrial as st
from seatrial.core.results.coefficients import FeedbackEvidence
from seatrial.data.trial import ControllerGains, EstimateMethod, Feedback
from seatrial.estimation.identify.warnings import closed_loop_findings
from seatrial.problems.disturbed_craft import GAIN, RATE_GAIN, SAMPLE_S, Disturbance, course_at, independent_nomoto

LOOP = FeedbackEvidence(
    "delta", "psi", ("run",), is_declared=True, reference="psi_ref", reference_steps=9, reference_p=0.4,
    controller_correlation=0.98, controller_delay=1.0,
)  # fmt: skip


def codes(loop: FeedbackEvidence | None) -> list[str]:
    estimation: Any = SimpleNamespace(noise_model=SimpleNamespace(closed_loop=loop), has_process_noise=True)
    return [finding.code for finding in closed_loop_findings(estimation)]


def test_what_agrees_is_no_finding() -> None:
    assert codes(None) == codes(LOOP) == []


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"reference_p": 1e-3}, "reference-residual"),
        ({"controller_correlation": -0.9}, "controller-mismatch"),
    ],
)
def test_what_contradicts_is_one_warning(change: dict[str, Any], code: str) -> None:
    assert codes(replace(LOOP, **change)) == [code]


@pytest.fixture(scope="module")
def trial() -> st.Trial:
    """Two minutes under a controller in gusts, reference and controller declared."""
    craft = NOMOTO
    (run,) = independent_nomoto(
        craft, Disturbance(0.3, 5.0), 1, np.random.default_rng(5), is_closed=True, seconds=120.0
    )
    reference = np.array([course_at(t + 1e-9, craft) for t in run.time])
    channels = {c: run[c] for c in ("delta", "psi", "r", "u")}
    record = st.Record.from_arrays("auto", run.time, {**channels, "psi_ref": reference})
    gains = ControllerGains(gain=GAIN, rate_gain=RATE_GAIN, sample_s=SAMPLE_S)
    declared = Feedback(input="delta", output="psi", reference="psi_ref", controller=gains)
    model = st.models.nomoto().with_values(dict(craft.guess))
    return st.Trial(st.Ship("craft", {"L": 50.0}), (st.Run(record),), model, feedback=declared)


def test_a_declared_loop_is_used_and_its_short_record_warned_of(trial: st.Trial) -> None:
    fit = st.identify(trial)
    noise = fit.noise_model
    assert noise is not None
    assert noise.method == "prediction error"
    loop = noise.closed_loop
    assert loop is not None
    assert loop.is_declared
    assert loop.reference_steps == 2
    assert loop.reference_p is not None
    assert loop.reference_p > 0.01
    assert loop.controller_correlation == pytest.approx(1.0, abs=0.05)
    assert [c.name for c in loop.without_disturbance] == ["K", "T"]
    codes = [finding.code for finding in fit.findings]
    assert fit.intervals.startswith("profile likelihood")
    assert "few-reference-steps" in codes
    assert "controller-mismatch" not in codes


def test_output_error_that_the_trial_requires_is_warned_of(trial: st.Trial) -> None:
    settings = replace(trial.estimate, method=EstimateMethod.OUTPUT_ERROR)
    fit = st.identify(replace(trial, estimate=settings))
    (finding,) = [f for f in fit.findings if f.code == "closed-loop"]
    assert "answered count as the craft's own response" in finding.message
