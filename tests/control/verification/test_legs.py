"""Legs by whether the actuator moves; logs that hold none."""

import math
from dataclasses import replace

import numpy as np
import pytest

from seatrial.control.verification.stabiliser import legs_on_and_off, natural_period
from seatrial.core.values import Array, Channel, InputError, Record, RecordKind, frozen
from seatrial.physics.loops import Block
from seatrial.physics.loops.structures import fin_loop

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
