"""Legs of a log and simulated logs of a stabiliser verified: the truth inside, what does not fit refused."""

import math
from dataclasses import replace

import numpy as np
import pytest
from benchmarks.verification import EXAMPLE, SimulatedLog, simulated_log, verified

import seatrial as st
from seatrial.control.loopfile.load import tuning_task
from seatrial.control.task import Seaway, SlowDisturbance, TuningTask
from seatrial.control.verification.stabiliser import AS_THEY_ARE, BY_MODEL, BY_WAVES, legs_on_and_off, natural_period
from seatrial.core.results.verification import Verification
from seatrial.core.values import Array, Channel, InputError, Record, RecordKind, frozen
from seatrial.physics.loops import Block, HullFactor
from seatrial.physics.loops.structures import PUBLISHED_GAINS, fin_loop

DT, LOOP = 0.5, fin_loop()
PERIOD = natural_period(LOOP)


def _record(**channels: Array) -> Record:
    time = frozen(DT * np.arange(len(next(iter(channels.values())))))
    values = {name: Channel.from_notation(name, frozen(v)) for name, v in channels.items()}
    return Record("log", time, values, RecordKind.MEASURED)


def _swing(seconds: float, amplitude: float = 0.1) -> Array:
    return amplitude * np.sin(2.0 * math.pi / PERIOD * DT * np.arange(round(seconds / DT)))


def test_natural_period_is_that_of_the_least_damped_swing() -> None:
    assert natural_period(LOOP) == pytest.approx(2.0 * math.pi * math.sqrt(1.43242))


def test_a_log_is_cut_where_control_is_switched() -> None:
    fins = np.concatenate([_swing(600), np.zeros(round(500 / DT)), _swing(700)])
    legs = legs_on_and_off([_record(phi=_swing(1800), alpha_f=fins, u=np.full(len(fins), 9.0))], LOOP, 1.0)
    assert [leg.is_controlled for leg in legs] == [True, False, True]
    for leg, start, stop in zip(legs, (0.0, 600.0, 1100.0), (600.0, 1100.0, 1800.0), strict=True):
        assert start <= leg.start <= start + 4.0 * PERIOD
        assert stop - 4.0 * PERIOD <= leg.stop <= stop + DT
        assert pytest.approx(9.0) == leg.U


def test_gaps_end_a_leg() -> None:
    phi = _swing(1800)
    phi[round(900 / DT)] = np.nan
    legs = legs_on_and_off([_record(phi=phi, alpha_f=_swing(1800))], LOOP, 9.0)
    assert [leg.is_controlled for leg in legs] == [True, True]
    assert all(np.all(np.isfinite(leg.values)) for leg in legs)


def test_the_waves_are_kept_where_all_records_hold_them() -> None:
    waves = {"zeta": _swing(600, 1.0)}
    with_waves = _record(phi=_swing(600), alpha_f=_swing(600), **waves)
    assert legs_on_and_off([with_waves], LOOP, 9.0)[0].values.shape[1] == 3
    assert legs_on_and_off([with_waves, with_waves.without("zeta")], LOOP, 9.0)[0].values.shape[1] == 2


@pytest.mark.parametrize(
    ("record", "words"),
    [
        (_record(phi=_swing(900), alpha_f=0.0 * _swing(900)), "never moves"),
        (_record(phi=_swing(200), alpha_f=_swing(200)), "longest leg with the controller on takes 199 s; 271 s"),
        (_record(phi=_swing(900)), "no channel 'alpha_f'"),
    ],
)
def test_logs_without_legs_are_refused(record: Record, words: str) -> None:
    with pytest.raises(InputError, match=words):
        legs_on_and_off([record], LOOP, 9.0)


def test_a_plant_that_does_not_swing_is_refused() -> None:
    lag = Block("lag", (1.0,), (5.0, 1.0))
    with pytest.raises(InputError, match="does not swing"):
        natural_period(replace(LOOP, plant=lag))


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


def test_waves_that_act_otherwise_than_assumed_are_named_and_leave_the_fins_alone(task: TuningTask) -> None:
    """A hull five times as wide: short waves hardly roll it, which K_alpha took for its own before."""
    sea = next(met for met in task.disturbances if isinstance(met, Seaway))
    other = replace(task, disturbances=(replace(sea, effect=HullFactor(100.0, 50.0, 10.0)),))
    result = verified(task, simulated_log(other, np.zeros(3), 5))
    fins = result.corrections[0]
    assert fins.lower < fins.model < fins.upper
    assert any(f.message.startswith("waves move 'phi' otherwise") for f in result.findings)


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
