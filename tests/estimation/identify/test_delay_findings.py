"""Delays that are longer than a sample interval."""

import re
from dataclasses import replace

import numpy as np
from tests.estimation.identify.conftest import NOISE, TRUTH, square, steered

from seatrial.core.values import Record
from seatrial.data.trial import EstimateMethod, EstimateSettings
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.fit import Estimation, estimate_model
from seatrial.estimation.identify.fit_result import bounds_hit
from seatrial.estimation.identify.instruments import delay_findings, lagged_values
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


def test_an_order_recorded_for_the_angle_is_a_lag_of_the_machinery(rng: np.random.Generator) -> None:
    """The rudder follows its order by a lag of 2.5 s, in steps of a twentieth of a sample; the record has the order."""
    lag, fine, order = 2.5, 20, np.repeat(rng.choice([-0.2, -0.1, 0.1, 0.2], 30), 40)
    r, psi, delta = 0.0, 0.0, order[0]
    heading = np.empty(len(order))
    h = 0.5 / fine
    for k, ordered in enumerate(np.repeat(order, fine)):
        if k % fine == 0:
            heading[k // fine] = psi
        delta += h / lag * (ordered - delta)
        psi, r = psi + h * r, r + h / TRUTH["T"] * (TRUTH["K"] * delta - r)
    shown = heading + np.radians(0.1) * rng.standard_normal(len(order))
    (finding,) = delay_findings(
        fitted(Record.from_arrays("run", 0.5 * np.arange(len(order)), {"delta": order, "psi": shown}))
    )
    said = re.search(r"a lag of ([\d.]+) s .* K ([\d.]+) and T ([\d.]+)", finding.evidence or "")
    assert said is not None
    np.testing.assert_allclose([float(x) for x in said.groups()], [lag, TRUTH["K"], TRUTH["T"]], rtol=0.15)


def test_a_lag_is_exact_between_straight_values(rng: np.random.Generator) -> None:
    coarse = np.cumsum(rng.standard_normal(50))
    line = np.interp(np.arange(0.0, 49.0, 1e-3), np.arange(50.0), coarse)
    follower = np.empty(len(line))
    follower[0] = line[0]
    for k in range(len(line) - 1):
        follower[k + 1] = follower[k] + 1e-3 / 2.0 * (0.5 * (line[k] + line[k + 1]) - follower[k])
    np.testing.assert_allclose(lagged_values(coarse, 2.0, is_held=False)[:49], follower[::1000], atol=2e-3)
    after = coarse[1] + (coarse[0] - coarse[1]) * np.exp(-0.5)
    np.testing.assert_allclose(lagged_values(coarse, 2.0, is_held=True)[:3], [coarse[0], coarse[0], after])


def test_a_delay_within_a_sample_is_none(rng: np.random.Generator) -> None:
    assert not delay_findings(estimated(rng, 0))


def test_what_sessions_have_of_their_own_has_no_bound_to_hit(rng: np.random.Generator) -> None:
    estimation = estimated(rng, 0)
    solution = estimation.estimate.optimum.solution
    pinned = replace(estimation.estimate.problem, pinned=solution.point)
    moved = replace(estimation, estimate=replace(estimation.estimate, problem=pinned))
    assert len(bounds_hit(moved)) == len(pinned.free)
