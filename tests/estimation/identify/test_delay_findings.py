"""Delays that are longer than a sample interval."""

from dataclasses import replace

import numpy as np
from tests.estimation.identify.conftest import NOISE, TRUTH, square, steered

from seatrial.core.values import Record
from seatrial.data.trial import EstimateMethod, EstimateSettings
from seatrial.estimation.estimate.fit import Estimation, estimate_model
from seatrial.estimation.estimate.runs import Runs
from seatrial.estimation.identify.delay_findings import delay_findings
from seatrial.estimation.identify.fit_result import bounds_hit
from seatrial.physics.models.nomoto import nomoto


def estimated(rng: np.random.Generator, late: int) -> Estimation:
    """A slewing rudder that acts `late` samples of 0.5 s behind its record."""
    run = steered(nomoto().with_values(TRUTH), square(500), rng, NOISE)
    early = np.concatenate([run["delta"][late:], np.repeat(run["delta"][-1:], late)])
    record = run.with_channel("delta", run.channel("delta").with_values(early))
    return fitted(record)


def fitted(record: Record) -> Estimation:
    settings = EstimateSettings(method=EstimateMethod.OUTPUT_ERROR)
    return estimate_model(nomoto(), Runs.one_session_each((record,), 8.0), settings)


def test_a_delay_of_three_samples_is_named_with_its_session(rng: np.random.Generator) -> None:
    (finding,) = delay_findings(estimated(rng, 3))
    assert finding.code == "input-delay" and "after its record" in finding.message
    assert "1.5 s in plan" in (finding.evidence or "") or "1.4 s in plan" in (finding.evidence or "")


def test_a_delay_within_a_sample_is_none(rng: np.random.Generator) -> None:
    assert not delay_findings(estimated(rng, 0))


def test_what_sessions_have_of_their_own_has_no_bound_to_hit(rng: np.random.Generator) -> None:
    estimation = estimated(rng, 0)
    solution = estimation.estimate.optimum.solution
    pinned = replace(estimation.estimate.problem, pinned=solution.point)
    moved = replace(estimation, estimate=replace(estimation.estimate, problem=pinned))
    assert len(bounds_hit(moved)) == len(pinned.free)
