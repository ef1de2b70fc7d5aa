"""Replayed inputs: the same numbers back, signs turned by metadata, and a sentence where something is missing."""

import math

import numpy as np
import pytest

from seatrial.core.values import Channel, InputError, Record, RecordKind, frozen
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate import forces, inputs_of, replay
from seatrial.physics.simulate.replay import series_record
from seatrial.physics.simulate.steer import manoeuvre

JET = {"v_j": 1.866}
K, T, DELTA = 0.1, 10.0, 0.2


def step_record(rate: float = 10.0) -> Record:
    time = np.arange(int(60 * rate) + 1) / rate
    return Record.from_arrays("step", time, {"delta": np.full(len(time), DELTA)})


def test_series_become_channels_of_the_notation_or_like_another_one() -> None:
    series = {"psi": np.arange(4.0), "demand": np.ones(4), "x_1": np.zeros(4)}
    record = series_record("course", 0.5, series, "a loop", {"demand": "psi"})
    assert record.kind is RecordKind.SIMULATED and record.time.tolist() == [0.0, 0.5, 1.0, 1.5]
    assert [record.channel(name).unit for name in series] == ["rad", "rad", "1"]
    assert record.provenance.source == "a loop"


@pytest.fixture(scope="module")
def zigzag() -> Record:
    return manoeuvre(waterjet(), programme("zigzag:20/20"), inputs=JET, slew_rate=math.radians(4.0))


def test_step_response_of_nomoto_in_closed_form() -> None:
    """r = K delta (1 - exp(-t/T)), psi = K delta (t - T (1 - exp(-t/T)))."""
    model = nomoto().with_values({"K": K, "T": T})
    made = replay(model, step_record(), {"r": 0.0})
    decay = 1.0 - np.exp(-made.time / T)
    assert made["r"] == pytest.approx(K * DELTA * decay, abs=1e-9)
    assert made["psi"] == pytest.approx(K * DELTA * (made.time - T * decay), abs=1e-8)
    assert made.kind is RecordKind.SIMULATED


def test_substeps_are_of_fourth_order() -> None:
    model = nomoto().with_values({"K": K, "T": T})
    exact = K * DELTA * (1.0 - math.exp(-6.0))
    coarse, fine = (abs(replay(model, step_record(0.2), {"r": 0.0}, substeps=n)["r"][-1] - exact) for n in (1, 2))
    assert 14.0 < coarse / fine < 22.0


@pytest.mark.parametrize("text", ["zigzag:10/10", "zigzag:20/20:port", "turning-circle:20", "pull-out", "prbs:10:7"])
def test_a_manoeuvre_replayed_repeats_to_the_last_bit(text: str) -> None:
    made = manoeuvre(waterjet(), programme(text), inputs=JET, slew_rate=math.radians(4.0))
    again = replay(waterjet(), made)
    assert set(again.channels) == set(made.channels)
    assert all(np.array_equal(again[s], made[s]) for s in made.channels)


def test_the_sign_of_the_rudder_is_metadata(zigzag: Record) -> None:
    assert zigzag.channel("delta").positive == "starboard"
    turned = zigzag.with_channel("delta", Channel(frozen(-zigzag["delta"]), "rad", "body", "port"))
    assert np.array_equal(inputs_of(waterjet(), zigzag), inputs_of(waterjet(), turned))
    assert np.array_equal(inputs_of(waterjet(), zigzag)[:, 0], -zigzag["delta"])
    assert np.array_equal(replay(waterjet(), turned)["psi"], zigzag["psi"])


def test_a_direction_that_is_no_opposite_is_refused(zigzag: Record) -> None:
    odd = zigzag.with_channel("delta", Channel(zigzag["delta"], "rad", "body", "up"))
    with pytest.raises(InputError, match="'delta' is positive to 'up', model 'waterjet' has it positive to 'port'"):
        inputs_of(waterjet(), odd)


def test_a_state_recorded_to_port_starts_turned(zigzag: Record) -> None:
    late = zigzag.rows(slice(100, None))
    turned = late.with_channel("r", Channel(frozen(-late["r"]), "rad/s", "body", "port"))
    assert np.array_equal(replay(waterjet(), turned)["r"], replay(waterjet(), late)["r"])


def test_initial_values_given_measured_or_zero(zigzag: Record) -> None:
    late = zigzag.rows(slice(200, None))
    assert replay(waterjet(), late)["psi"][0] == late["psi"][0]
    assert replay(waterjet(), late, {"psi": 1.0})["psi"][0] == 1.0
    assert replay(waterjet(), late.without("psi", "x0", "y0"))["psi"][0] == 0.0
    with pytest.raises(InputError, match="no channel 'u', a state of model 'waterjet': give its initial value"):
        replay(waterjet(), late.without("u"))
    with pytest.raises(InputError, match="'w' is no state"):
        replay(waterjet(), late, {"w": 1.0})


def test_earth_fixed_velocities_are_refused_as_initial_state(zigzag: Record) -> None:
    earth = zigzag.with_channel("u", Channel(zigzag["u"], "m/s", "earth", "north"))
    with pytest.raises(InputError, match="'u' is earth-fixed"):
        replay(waterjet(), earth)


def test_missing_inputs_are_named(zigzag: Record) -> None:
    with pytest.raises(InputError, match="no channel 'v_j', an input of model 'waterjet'"):
        replay(waterjet(), zigzag.without("v_j"))
    values = np.array(zigzag["delta"])
    values[7] = math.nan
    gap = zigzag.with_channel("delta", zigzag.channel("delta").with_values(values))
    with pytest.raises(InputError, match=r"'delta' has no value at sample 7 \(t = 0.7 s\)"):
        replay(waterjet(), gap)


def test_divergence_says_when_and_which_channel(zigzag: Record) -> None:
    wild = waterjet().with_values({"N_r": 5.0})
    with pytest.raises(InputError, match=r"model 'waterjet' diverges: '[urv]' left its bounds at t = \d"):
        replay(wild, zigzag)
    with pytest.raises(InputError, match="manoeuvre 'zigzag:20/20' with model 'waterjet' diverges"):
        manoeuvre(wild, programme("zigzag:20/20"), inputs=JET)


def test_one_sample_and_uneven_time_are_refused(zigzag: Record) -> None:
    with pytest.raises(InputError, match="one sample"):
        replay(waterjet(), zigzag.rows(slice(0, 1)))


def test_forces_along_a_simulated_record_balance(zigzag: Record) -> None:
    """Surge on the straight start: hull and thrust cancel, Song et al. 2025, eq. (1)."""
    parts = forces(waterjet(), zigzag)
    assert parts["X_H"][0] + parts["X_P"][0] == pytest.approx(0.0, abs=1e-6)
    assert parts["X_P"].shape == (len(zigzag),)
    with pytest.raises(InputError, match="simulate it first"):
        forces(waterjet(), zigzag.without("u"))
