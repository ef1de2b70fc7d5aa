"""Simulated logs of a stabiliser verified: the truth inside, a wrong model named, logs and gains that do not fit."""

import math
from dataclasses import replace

import numpy as np
import pytest
from benchmarks.verification import EXAMPLE, SimulatedLog, simulated_log, verified

import seatrial as st
from seatrial.control.loopfile.load import tuning_task
from seatrial.control.task import SlowDisturbance, TuningTask
from seatrial.control.verification.stabiliser import AS_THEY_ARE, BY_MODEL, BY_WAVES
from seatrial.core.results.verification import Verification
from seatrial.core.values import Channel, InputError, frozen
from seatrial.physics.loops.structures import PUBLISHED_GAINS

LEG_S = 600.0  # s: half of the benchmark's


@pytest.fixture(scope="module")
def task() -> TuningTask:
    return tuning_task(EXAMPLE)


@pytest.fixture(scope="module")
def log(task: TuningTask) -> SimulatedLog:
    return simulated_log(task, np.zeros(3), 3, LEG_S)


@pytest.fixture(scope="module")
def verification(task: TuningTask, log: SimulatedLog) -> Verification:
    return verified(task, log)


def test_a_ship_as_modelled_is_inside(verification: Verification, log: SimulatedLog) -> None:
    reduction = verification.quantities[0]
    assert verification.outside == ()
    assert verification.moved == ()
    assert reduction.lower < log.reduction < reduction.upper
    assert reduction.upper - reduction.lower < 0.15
    assert [leg.is_controlled for leg in verification.legs] == [False, True, False, True]
    assert [r.method for r in verification.reductions] == [BY_MODEL, AS_THEY_ARE]
    assert verification.legs[1].gain_ratio == pytest.approx(1.0, abs=0.05)
    assert all(leg.height_lower < 1.8 * 1.25 and leg.height_upper > 1.8 / 1.25 for leg in verification.legs)


def test_fins_that_do_less_are_named(task: TuningTask) -> None:
    log = simulated_log(task, np.array([math.log(0.5), 0.0, 0.0]), 4, LEG_S)
    result = verified(task, log)
    assert result.moved[0] == "effectiveness of the fins, K_alpha"
    assert "reduction" in result.outside
    correction = result.corrections[0]
    assert correction.lower < 0.8 * 0.256
    assert "model-moved" in {f.code for f in result.findings}
    assert result.reductions[0].lower < log.reduction < result.reductions[0].upper


def test_recorded_waves_give_the_reduction_by_their_spectra(task: TuningTask, log: SimulatedLog) -> None:
    """Waves twice as high on the legs with control: the ratio of spectra allows for them."""
    phi = [record["phi"] for record in log.records]
    records = [
        record.with_channel("zeta", Channel.from_notation("zeta", frozen(10.0 * height * phi[2 * (k // 2)])))
        for k, (record, height) in enumerate(zip(log.records, (1.0, 2.0, 1.0, 2.0), strict=True))
    ]
    estimates = {r.method: r.value for r in st.verify(task, PUBLISHED_GAINS, records).reductions}
    assert estimates[BY_WAVES] == pytest.approx(1.0 - (1.0 - estimates[AS_THEY_ARE]) / 2.0, abs=0.02)


def test_legs_with_control_alone_say_what_they_rest_on(task: TuningTask, log: SimulatedLog) -> None:
    result = st.verify(task, PUBLISHED_GAINS, [log.records[1]])
    assert [f.code for f in result.findings] == ["no-leg-off"]
    assert len(result.reductions) == 1


@pytest.mark.parametrize(
    ("gains", "words"),
    [
        ({"KP": 1.0, "KI": 1.0}, "needs a value for gain KD"),
        ({**PUBLISHED_GAINS, "KX": 1.0}, "has no gain 'KX'"),
        ({"KP": -11.0, "KI": 0.0, "KD": -32.0}, "unstable"),
        ({"KP": 0.0, "KI": 40.0, "KD": 0.0}, "does not follow these gains"),
    ],
)
def test_other_gains_are_refused(task: TuningTask, log: SimulatedLog, gains: dict[str, float], words: str) -> None:
    with pytest.raises(InputError, match=words):
        st.verify(task, gains, log.records)


def test_fins_of_the_other_sign_are_named(task: TuningTask, log: SimulatedLog) -> None:
    reversed_fins = [
        record.with_channel("alpha_f", record.channel("alpha_f").with_values(-record["alpha_f"]))
        for record in log.records
    ]
    with pytest.raises(InputError, match="moves against these gains"):
        st.verify(task, PUBLISHED_GAINS, reversed_fins)


def test_half_of_the_gains_is_a_finding(task: TuningTask, log: SimulatedLog) -> None:
    halved = {name: 2.0 * value for name, value in PUBLISHED_GAINS.items()}
    assert "gains-differ" in [f.code for f in st.verify(task, halved, log.records).findings]


def test_waves_that_reach_the_output_otherwise_are_refused(task: TuningTask, log: SimulatedLog) -> None:
    pitching = replace(task, disturbances=(replace(task.disturbances[0], path=task.loop.disturbance),))
    with pytest.raises(InputError, match="not verified in waves"):
        st.verify(pitching, PUBLISHED_GAINS, log.records)


def test_a_loop_without_a_sea_is_refused(task: TuningTask, log: SimulatedLog) -> None:
    slow = replace(task, disturbances=(SlowDisturbance(0.01, 0.1, 9.0),), schedule_grid=None)
    with pytest.raises(InputError, match="names no sea"):
        st.verify(slow, PUBLISHED_GAINS, log.records)
