"""Measures against motions whose measures follow from geometry or from finer integration, and their intervals."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from seatrial.core.values import InputError, Record
from seatrial.physics.manoeuvres import ManoeuvreKind, bounded_interval, imo_criteria, measures, recognise_manoeuvre
from seatrial.physics.manoeuvres.imo import first_overshoot_limit, second_overshoot_limit
from seatrial.physics.manoeuvres.measures import commands_of, thrust_measures
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.published import container_ship, kvlcc2
from seatrial.physics.simulate.steer import manoeuvre

LENGTH = 10.0


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("positive", ["starboard", "port"])
def test_circle_in_closed_form(circle: Callable[..., Record], side: int, positive: str) -> None:
    record = circle(side, positive)
    assert recognise_manoeuvre(record) is ManoeuvreKind.TURNING_CIRCLE
    found = measures(record, LENGTH)
    # the rudder jumps within one sample, of which the execute takes the middle: 0.05 m of track
    assert found["advance_L"] == pytest.approx(2.0, abs=0.006)
    assert found["transfer_L"] == pytest.approx(2.0, abs=1e-3)
    assert found["tactical_diameter_L"] == pytest.approx(4.0, abs=1e-3)
    assert found["steady_diameter_L"] == pytest.approx(4.0, rel=1e-3)
    assert found["steady_yaw_rate_deg_s"] == pytest.approx(math.degrees(0.05), rel=1e-3)
    assert found["steady_drift_deg"] == pytest.approx(math.degrees(0.1), rel=1e-6)
    assert found["speed_loss"] == pytest.approx(0.0, abs=1e-9)
    assert found["rudder_deg"] == pytest.approx(35.0)


def fine_nomoto_zigzag(gain: float, lag: float, rudder: float, switching: float, slew: float) -> tuple[float, float]:
    """First and second overshoot [rad] of T r' + r = K delta by steps of 2 ms, independent of the package."""
    h, psi, r, delta, order = 0.002, 0.0, 0.0, 0.0, rudder
    peaks, switched_at, peak = [], None, 0.0
    while len(peaks) < 2:
        if order * psi > 0 and abs(psi) >= switching:
            if switched_at is not None:
                peaks.append(peak - switched_at)
            order, switched_at, peak = -order, abs(psi), 0.0
        delta += min(max(order - delta, -slew * h), slew * h)
        old = r
        r += h * (gain * delta - r) / lag
        psi += 0.5 * h * (old + r)
        if switched_at is not None and psi * order < 0:
            peak = max(peak, abs(psi))
    return peaks[0], peaks[1]


def test_nomoto_zigzag_against_fine_integration() -> None:
    model = nomoto().with_values({"K": 0.08, "T": 12.0})
    slew = math.radians(3.0)
    record = manoeuvre(model, programme("zigzag:20/20"), slew_rate=slew)
    assert recognise_manoeuvre(record) is ManoeuvreKind.ZIGZAG
    found = measures(record, LENGTH)
    first, second = fine_nomoto_zigzag(0.08, 12.0, math.radians(20.0), math.radians(20.0), slew)
    assert found["overshoot_1_deg"] == pytest.approx(math.degrees(first), abs=0.02)
    assert found["overshoot_2_deg"] == pytest.approx(math.degrees(second), abs=0.02)
    counted = measures(record, LENGTH, switching=math.radians(20.0))
    assert counted["overshoot_1_deg"] == pytest.approx(found["overshoot_1_deg"], abs=0.25)
    assert "initial_turning_L" not in found


def test_initial_turning_time_of_a_jumping_rudder() -> None:
    """psi = K delta (t - T (1 - exp(-t/T))), Nomoto's step response."""
    gain, lag, delta = 0.08, 12.0, math.radians(10.0)
    record = manoeuvre(nomoto().with_values({"K": gain, "T": lag}), programme("zigzag:10/10"), slew_rate=1e3, dt=0.02)
    time = measures(record, LENGTH)["initial_turning_time_s"]
    assert gain * delta * (time - lag * (1 - math.exp(-time / lag))) == pytest.approx(math.radians(10.0), rel=5e-3)


def test_noise_moves_measures_little(rng: np.random.Generator) -> None:
    model = nomoto().with_values({"K": 0.08, "T": 12.0})
    clean = manoeuvre(model, programme("zigzag:20/20"), slew_rate=math.radians(3.0), approach=20.0)
    psi = clean.channel("psi").with_values(clean["psi"] + math.radians(0.2) * rng.standard_normal(len(clean)))
    delta = clean.channel("delta").with_values(clean["delta"] + math.radians(0.3) * rng.standard_normal(len(clean)))
    noisy = clean.with_channel("psi", psi).with_channel("delta", delta)
    assert recognise_manoeuvre(noisy) is ManoeuvreKind.ZIGZAG
    expected, found = measures(clean, LENGTH), measures(noisy, LENGTH)
    assert found["overshoot_1_deg"] == pytest.approx(expected["overshoot_1_deg"], abs=0.5)
    assert found["overshoot_2_deg"] == pytest.approx(expected["overshoot_2_deg"], abs=0.5)


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("zigzag:10/10:port", ManoeuvreKind.ZIGZAG),
        ("consecutive-zigzags:2", ManoeuvreKind.ZIGZAG),
        ("turning-circle:20:port", ManoeuvreKind.TURNING_CIRCLE),
        ("pull-out:15", ManoeuvreKind.PULL_OUT),
        ("spiral:20", ManoeuvreKind.SPIRAL),
        ("prbs:20:7:3", ManoeuvreKind.OTHER),
    ],
)
def test_programmes_are_recognised(text: str, kind: ManoeuvreKind) -> None:
    record = manoeuvre(nomoto(), programme(text), slew_rate=math.radians(4.0))
    assert recognise_manoeuvre(record) is kind


def test_pull_out_of_a_stable_ship_leaves_no_rate() -> None:
    record = manoeuvre(nomoto().with_values({"T": 5.0}), programme("pull-out:15"))
    assert measures(record, LENGTH)["residual_yaw_rate_deg_s"] == pytest.approx(0.0, abs=1e-3)


def test_a_turning_circle_with_a_pull_out_gives_the_measures_of_both() -> None:
    record = manoeuvre(kvlcc2(), programme("pull-out:35"), speed=1.18, inputs={"n": 10.4})
    both = measures(record, 7.0)
    circle = measures(manoeuvre(kvlcc2(), programme("turning-circle:35"), speed=1.18, inputs={"n": 10.4}), 7.0)
    for name in ("advance_L", "transfer_L", "tactical_diameter_L"):
        assert both[name] == pytest.approx(circle[name], rel=1e-3)
    assert "residual_yaw_rate_deg_s" in both and "residual_yaw_rate_deg_s" not in circle


def test_heel_is_counted_out_of_the_turn() -> None:
    ship, inputs = container_ship(), {"n": 100.0 / 60.0}
    for text in ("turning-circle:15", "turning-circle:15:port"):
        turn = manoeuvre(ship, programme(text), dt=0.5, inputs=inputs)
        found, outward = measures(turn, 175.0), math.copysign(1.0, -float(turn["psi"][-1])) * np.degrees(turn["phi"])
        assert found["heel_1_deg"] == pytest.approx(outward.max(), rel=0.01)
        last_half_turn = np.abs(turn["psi"]) > abs(float(turn["psi"][-1])) - math.pi
        assert found["steady_heel_deg"] == pytest.approx(np.mean(outward[last_half_turn]), abs=0.05)
    zigzag = manoeuvre(ship, programme("zigzag:20/20"), dt=0.5, inputs=inputs)
    found = measures(zigzag, 175.0)
    assert found["heel_1_deg"] == pytest.approx(np.degrees(np.abs(zigzag["phi"]).max()), rel=0.02)
    assert {f"heel_{k}_deg" for k in (1, 2, 3)} <= set(found)


def test_rudder_that_never_moves_shows_nothing() -> None:
    time = np.arange(50.0)
    record = Record.from_arrays("straight", time, {"psi": 0.0 * time, "delta": 0.0 * time})
    assert recognise_manoeuvre(record) is ManoeuvreKind.OTHER
    assert measures(record, LENGTH) == {}


def test_missing_channel_and_bad_length_are_refused(circle: Callable[..., Record]) -> None:
    with pytest.raises(InputError, match="has no channel 'delta'"):
        measures(circle().without("delta"), LENGTH)
    with pytest.raises(InputError, match="length 0 m is not positive"):
        measures(circle(), 0.0)


def test_overshoot_limits_of_the_resolution() -> None:
    assert [first_overshoot_limit(t) for t in (5.0, 10.0, 20.0, 30.0, 50.0)] == [10.0, 10.0, 15.0, 20.0, 20.0]
    assert [second_overshoot_limit(t) for t in (5.0, 10.0, 20.0, 30.0, 50.0)] == [25.0, 25.0, 32.5, 40.0, 40.0]


def test_criteria_of_a_turning_circle_say_where_they_apply(circle: Callable[..., Record]) -> None:
    small = imo_criteria(circle(), LENGTH)
    assert {c.name: c.limit for c in small} == {"advance_L": 4.5, "tactical_diameter_L": 5.0}
    assert all(c.is_fulfilled and not c.applies for c in small)
    assert "100 m and more" in small[0].note
    model = imo_criteria(circle(), LENGTH, scale=20.0)
    assert all(c.applies and "model scale 1:20" in c.note for c in model)


def test_a_circle_with_its_pull_out_meets_the_criteria_of_a_circle() -> None:
    record = manoeuvre(kvlcc2(), programme("pull-out:35"), speed=1.18, inputs={"n": 10.4})
    assert {c.name for c in imo_criteria(record, LENGTH)} == {"advance_L", "tactical_diameter_L"}


@pytest.mark.parametrize("speed", [0.0, 3.0])
def test_a_model_without_surge_has_no_distances_and_no_standard_to_meet(speed: float) -> None:
    model = nomoto().with_values({"K": 0.1, "T": 5.0, "U": speed})
    record = manoeuvre(model, programme("turning-circle:35"), dt=0.2, speed=1.0, duration=400.0)
    found = measures(record, LENGTH)
    assert {"time_90_s", "steady_yaw_rate_deg_s", "rudder_deg"} == set(found)
    assert imo_criteria(record, LENGTH) == ()


def test_a_position_that_never_moves_is_no_track_and_zero_has_no_sign(circle: Callable[..., Record]) -> None:
    record = circle(1, "starboard")
    still = record.with_channel("v", record.channel("v").with_values(np.zeros(len(record))))
    for symbol in ("x0", "y0"):
        still = still.with_channel(symbol, still.channel(symbol).with_values(np.zeros(len(record))))
    found = measures(still, LENGTH)
    assert not {"advance_L", "transfer_L", "tactical_diameter_L"} & set(found)
    assert math.copysign(1.0, found["steady_drift_deg"]) == 1.0


def test_a_rudder_that_never_rests_holds_no_angle() -> None:
    """A controller that answers steps of heading with kicks of one sample."""
    time = 0.1 * np.arange(400)
    delta = np.where(np.arange(400) % 50 == 25, 0.2, 0.0)
    psi = 0.1 * np.cos(0.7 * time)
    record = Record.from_arrays("auto", time, {"delta": delta, "psi": psi, "r": np.gradient(psi, time)})
    assert recognise_manoeuvre(record) in ManoeuvreKind


@pytest.mark.parametrize(
    ("name", "value", "half", "lowest", "highest"),
    [
        ("tactical_diameter_L", 3.0, 4.0, 0.0, math.inf),
        ("overshoot_1_deg", 1.3, 2.0, 0.0, math.inf),
        ("time_90_s", 40.0, 50.0, 0.0, math.inf),
        ("speed_loss", 0.6, 0.6, -math.inf, 1.0),
        ("steady_drift_deg", 20.0, 100.0, -90.0, 90.0),
    ],
)
def test_wide_intervals_stay_among_possible_values(
    name: str, value: float, half: float, lowest: float, highest: float
) -> None:
    bounds = bounded_interval(name, value, half)
    assert bounds is not None
    assert lowest < bounds[0] < value < bounds[1] < highest


@pytest.mark.parametrize("name", ["advance_L", "overshoot_2_deg", "speed_loss", "steady_drift_deg", "transfer_L"])
def test_narrow_intervals_are_symmetric(name: str) -> None:
    bounds = bounded_interval(name, 0.7, 1e-4)
    assert bounds == pytest.approx((0.6999, 0.7001), abs=1e-7)


def test_the_interval_of_a_positive_measure_is_that_of_its_logarithm() -> None:
    assert bounded_interval("advance_L", 2.0, 1.0) == pytest.approx((2.0 / math.exp(0.5), 2.0 * math.exp(0.5)))


@pytest.mark.parametrize(
    ("name", "value", "half"),
    [("steady_drift_deg", 20.0, 169.0), ("tactical_diameter_L", 3.0, 9.0), ("overshoot_1_deg", -0.5, 0.1),
     ("speed_loss", 0.9, 0.4), ("steady_drift_deg", 95.0, 1.0), ("advance_L", 3.0, math.nan)],
)  # fmt: skip
def test_what_would_say_nothing_is_not_determined(name: str, value: float, half: float) -> None:
    assert bounded_interval(name, value, half) is None


def test_a_measure_without_limits_keeps_its_symmetric_interval() -> None:
    assert bounded_interval("residual_yaw_rate_deg_s", 0.1, 0.5) == (-0.4, 0.6)


TIME = 0.1 * np.arange(400)


def record(**channels: np.ndarray) -> Record:
    still = {"command_1": np.full(400, 0.5), "command_2": np.full(400, 0.5), "u": np.zeros(400), "psi": np.zeros(400)}
    return Record.from_arrays("run", TIME, still | channels)


def test_commands_are_the_numbered_channels() -> None:
    assert commands_of(record(delta=np.zeros(400))) == ("command_1", "command_2")


def test_a_spin_has_its_rate_and_the_time_of_a_turn() -> None:
    found = thrust_measures(record(psi=np.angle(np.exp(0.5j * TIME))))
    assert found == pytest.approx(
        {"steady_yaw_rate_deg_s": np.degrees(0.5), "time_360_s": 4.0 * np.pi, "time_constant_s": 0.0}  # at once
    )


def test_a_straight_run_has_speed_and_time_constant() -> None:
    found = thrust_measures(record(u=2.0 * (1.0 - np.exp(-TIME / 3.0))))
    assert found == pytest.approx({"steady_speed": 2.0, "time_constant_s": 3.0}, rel=1e-3)


def test_a_stop_is_read_from_the_change_of_commands_to_rest() -> None:
    u = np.where(TIME < 10.0, 2.0, 2.0 - 0.25 * (TIME - 10.0))
    found = thrust_measures(record(u=u, command_1=np.where(TIME <= 10.0, 0.5, -0.5)))
    assert found == pytest.approx({"approach_speed": 2.0, "stopping_time_s": 8.0, "stopping_distance_m": 8.0})


def test_a_zigzag_has_overshoots_behind_its_executes() -> None:
    psi = 0.5 * np.sin(0.5 * TIME)
    executes = (np.pi / 6.0 + np.pi * np.arange(6)) / 0.5  # at 15 deg on the way to 0.5 rad and back
    command = 0.5 + 0.3 * (-1.0) ** np.searchsorted(executes, TIME)
    found = thrust_measures(record(psi=psi, u=np.full(400, 1.5), command_1=command))
    step = np.degrees(0.25 * np.cos(np.pi / 6.0) * 0.1)  # of the heading in a sample, within which an execute is known
    assert found["overshoot_1_deg"] == pytest.approx(np.degrees(0.5 - 0.25), abs=step)
    assert found["period_s"] == pytest.approx(4.0 * np.pi, rel=0.01)


def test_commands_that_step_at_will_are_no_manoeuvre() -> None:
    steps = np.repeat([0.1, 0.7, -0.3, 0.4, 0.2], 80)
    assert thrust_measures(record(psi=0.5 * np.sin(0.5 * TIME), command_1=steps)) == {}


def test_what_is_missing_is_named() -> None:
    with pytest.raises(InputError, match="has no 'psi'"):
        thrust_measures(record().without("psi"))
