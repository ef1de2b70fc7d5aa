"""ArduPilot's parameters: the controller against its recurrences, the margins against python-control, the file."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter

import seatrial as st
from seatrial.core.values import Array, InputError
from seatrial.data.folder.model_file import ModelFile
from seatrial.exporting import ExportSource
from seatrial.exporting.ardupilot.choice import (
    LARGEST_MS,
    SampledPlant,
    closed_loop_matrix,
    heading_step,
    is_stable,
    open_loop,
    sampled_heading,
    sampled_margins,
    tune_ardupilot,
)
from seatrial.exporting.ardupilot.controller import (
    ArduPilotGains,
    CascadeGains,
    PidGains,
    SteeredCraft,
    cascade_from_pid,
    filter_share,
    simulate_controlled,
    steered_craft,
    turning_rates,
)
from seatrial.exporting.ardupilot.parameters import unsuitable_boat
from seatrial.physics.loops import Block
from seatrial.physics.models.thruster_layout import CATAMARAN, CommandInput, Thruster

K, T, U = 0.5, 1.2, 2.0  # 1/s, s, m/s, of a boat of some metres
DT = 0.02
GAINS = CascadeGains(1.1, PidGains(0.9, 0.5, 0.05, 0.7, target_filter=3.0, error_filter=4.0, derivative_filter=5.0))


@pytest.fixture(scope="module")
def nomoto_file() -> ModelFile:
    """A boat of first order."""
    return ModelFile(st.models.nomoto().with_values({"K": K, "T": T, "U": U}))


@pytest.fixture(scope="module")
def craft(nomoto_file: ModelFile) -> SteeredCraft:
    """The boat as ArduPilot steers it."""
    return steered_craft(nomoto_file)


@pytest.fixture(scope="module")
def plant(craft: SteeredCraft) -> SampledPlant:
    """Its heading, sampled."""
    return sampled_heading(craft.heading_plant, DT)


def catamaran_file() -> ModelFile:
    """A craft with two thrusters, stable on its course."""
    values = {"k_f": 1.6, "k_b": 1.1, "X_u": -0.1, "X_uu": -0.3, "Y_v": -0.6, "Y_vv": -1.5, "N_r": -1.0, "N_rr": -0.2}
    model = st.models.model_named("thrusters", CATAMARAN.text())
    return ModelFile(model.with_values({**values, "M_v": 1.6, "M_r": 0.15}))


def test_steering_has_the_scale_of_the_rudder(craft: SteeredCraft) -> None:
    # a rudder of 35 degrees, of which 0.8 reach it at cruising speed
    assert craft.heading_plant.num[-1] / craft.heading_plant.den[-2] == pytest.approx(K * math.radians(35.0) * 0.8)
    peak, acceleration = turning_rates(craft, T)
    share = 0.7 * 0.8 * math.radians(35.0)
    assert peak == pytest.approx(K * share, rel=1e-6)
    assert acceleration == pytest.approx(K * share / T, rel=0.01)


def test_the_hold_is_the_textbook_one(plant: SampledPlant) -> None:
    # zero-order hold of k / (T s + 1): k (1 - q) / (z - q), q = exp(-dt / T) (Astrom & Wittenmark 1997, table 2.1)
    k, q = K * math.radians(35.0) * 0.8, math.exp(-DT / T)
    omega = np.array([0.01, 1.0, 100.0])
    _, rate = plant.responses_at(omega)
    assert rate == pytest.approx(k * (1.0 - q) / (np.exp(1j * omega * DT) - q), rel=1e-9)


def test_margins_are_those_of_python_control(plant: SampledPlant) -> None:
    control = pytest.importorskip("control")
    z = control.tf([1.0, 0.0], [1.0], DT)
    k, q = K * math.radians(35.0) * 0.8, math.exp(-DT / T)
    heading = control.sample_system(control.tf([k], [T, 1.0, 0.0]), DT)
    target, error, slope = (a * z / (z - 1.0 + a) for a in (filter_share(f, DT) for f in (3.0, 4.0, 5.0)))
    parts = (z, k * (1.0 - q) / (z - q), heading, target, error, slope, DT * z / (z - 1.0), (z - 1.0) / (DT * z))

    def loop(omega: Array) -> np.ndarray:
        """The product part by part: multiplied out, its polynomials lose all digits near z = 1."""
        late, rate, psi, aim, seen, smooth, summed, differed = (part(np.exp(1j * omega * DT)) for part in parts)
        wanted = 1.1 * aim * psi
        pid = 0.9 + 0.5 * summed + 0.05 * smooth * differed
        return (pid * seen * (wanted + rate) + 0.7 * wanted) / late

    omega = np.geomspace(0.01, 0.999 * math.pi / DT, 4000)
    assert open_loop(plant, GAINS, omega) == pytest.approx(loop(omega), rel=1e-6)
    gain, phase, _, _, crossing, _ = control.stability_margins(control.frd(loop(omega), omega, smooth=True))
    found = sampled_margins(plant, GAINS)
    assert found.gain == pytest.approx(gain, rel=1e-3)
    assert found.phase == pytest.approx(math.radians(phase), rel=1e-3)
    assert found.delay == pytest.approx(math.radians(phase) / crossing, rel=1e-2)
    assert found.Ms == pytest.approx(np.max(1.0 / np.abs(1.0 + loop(omega))), rel=1e-3)


def _independent_run(gains: CascadeGains, step: float, count: int) -> Array:
    """Heading of the boat under AC_PID by scipy's filters, sample by sample: no code of the package."""
    a, pid = [filter_share(f, DT) for f in (3.0, 4.0, 5.0)], gains.rate
    k, q = K * math.radians(35.0) * 0.8, math.exp(-DT / T)
    psi, r, order, states = 0.0, 0.0, 0.0, [np.zeros(1) for _ in range(4)]
    headings = np.empty(count)
    target_last, error_last = 0.0, 0.0
    for i in range(count):
        headings[i] = psi
        wanted = gains.angle_P * (step - psi)
        if i == 0:  # filters begin at the first value
            target_last, error_last, derivative = wanted, wanted - r, 0.0
        else:
            target_last += a[0] * (wanted - target_last)
            before = error_last
            error_last += a[1] * (target_last - r - error_last)
            smoothed, states[2] = lfilter([a[2]], [1.0, a[2] - 1.0], [(error_last - before) / DT], zi=states[2])
            derivative = float(smoothed[0])
        summed, states[3] = lfilter([pid.I * DT], [1.0, -1.0], [error_last], zi=states[3])
        psi, r = psi + k * order * DT + (r - k * order) * T * (1.0 - q), k * order + (r - k * order) * q
        order = pid.P * error_last + float(summed[0]) + pid.D * derivative + pid.FF * target_last
    return headings


def test_the_controller_moves_the_boat_as_its_recurrences_do(craft: SteeredCraft) -> None:
    free = replace(craft, steering_rate=math.inf)
    gains = ArduPilotGains(GAINS, None, rate_max=1e3, turn_acceleration=1e9, speed_acceleration=1.0)
    _, states, _ = simulate_controlled(free, gains, 10.0, heading=0.01)
    psi = states[:, free.model.states.index("psi")]
    assert psi == pytest.approx(_independent_run(GAINS, 0.01, len(psi)), abs=1e-9)


def test_the_matrix_decays_as_the_controller_does(plant: SampledPlant) -> None:
    matrix = closed_loop_matrix(plant, GAINS)
    assert is_stable(plant, GAINS)
    assert not is_stable(plant, CascadeGains(40.0, GAINS.rate))
    # poles of the closed loop are where 1 + L vanishes
    pole = np.linalg.eigvals(matrix)
    slow = pole[np.argmax(np.abs(pole) * (np.abs(pole.imag) > 0.0))]
    omega = np.array([np.log(slow) / 1j / DT])
    assert abs(1.0 + open_loop(plant, GAINS, omega)[0]) < 1e-6


def test_a_limit_stops_the_integral_and_the_turn(craft: SteeredCraft) -> None:
    gains = ArduPilotGains(GAINS, None, rate_max=0.05, turn_acceleration=0.1, speed_acceleration=1.0)
    _, states, inputs = simulate_controlled(craft, gains, 60.0, heading=1.0)
    r = states[:, craft.model.states.index("r")]
    assert 0.045 < r.max() < 0.06
    assert np.abs(np.diff(inputs[:, 0])).max() <= craft.steering_rate * abs(craft.full_steering) * DT * (1.0 + 1e-12)
    assert states[-1, craft.model.states.index("psi")] == pytest.approx(1.0, abs=0.01)


def test_a_pid_becomes_the_cascade_with_the_same_loop(craft: SteeredCraft) -> None:
    pid = {"KP": 2.0, "KI": 0.2, "KD": 1.5}
    cascade = cascade_from_pid(pid, 0.5, 0.0)
    fine = sampled_heading(craft.heading_plant, 1e-5)
    omega = np.geomspace(0.05, 20.0, 20)
    s = 1j * omega
    wanted = craft.heading_plant.frequency_response(omega) * (pid["KP"] + pid["KI"] / s + pid["KD"] * s)
    assert open_loop(fine, cascade, omega) == pytest.approx(wanted, rel=1e-3)
    assert cascade.rate.FF == 0.5
    assert cascade_from_pid({"KP": 2.0, "KD": 1.5}, 0.5, 0.0).rate.I == 0.0
    with pytest.raises(InputError, match="tune with less KI"):
        cascade_from_pid({"KP": 1.0, "KI": 5.0, "KD": 1.0}, 0.5, 0.0)


def test_chosen_gains_keep_their_limits(craft: SteeredCraft) -> None:
    tuning = tune_ardupilot(craft)
    assert tuning.heading_margins.Ms <= LARGEST_MS
    assert tuning.heading_step.overshoot <= 0.1
    assert tuning.heading_step.settling < 10.0 * T
    again = heading_step(craft, tuning.gains, 1.0 / T)
    assert again.weighted_error == pytest.approx(tuning.heading_step.weighted_error)


def test_the_file_of_a_boat_with_a_rudder(nomoto_file: ModelFile, tmp_path: Path) -> None:
    result = st.export(nomoto_file, "ardupilot", tmp_path / "boat.param")
    lines = (tmp_path / "boat.param").read_text().splitlines()
    values = dict(line.split(",") for line in lines if not line.startswith("#"))
    assert all(len(name) <= 16 for name in values)  # AP_MAX_NAME_SIZE of AP_Param.h
    assert float(values["MOT_SPD_SCA_BASE"]) == pytest.approx(0.8 * U)
    assert values["SCHED_LOOP_RATE"] == "50" and "ATC_SPEED_P" not in values
    assert result.notes[0].startswith("Heading at 2 m/s: Ms ") and f"# {result.notes[0]}" in lines
    assert any("full GroundSteering is 35 deg" in line for line in lines)


def test_the_file_of_a_craft_with_thrusters(tmp_path: Path) -> None:
    file = catamaran_file()
    assert unsuitable_boat(ExportSource(file, "model.toml", "2026-01-01")) == ""
    result = st.export(file, "ardupilot", tmp_path / "cat.param")
    text = (tmp_path / "cat.param").read_text()
    assert "CRUISE_THROTTLE,50\n" in text and "MOT_STR_THR_MIX,0.5\n" in text and "MOT_SPD_SCA_BASE" not in text
    assert any(note.startswith("Speed step of -") for note in result.notes)


def test_gains_of_a_tuned_autopilot_are_taken_over(nomoto_file: ModelFile, tmp_path: Path) -> None:
    st.export(nomoto_file, "ardupilot", tmp_path / "boat.param", {"KP": 2.0, "KD": 1.5})
    text = (tmp_path / "boat.param").read_text()
    share = math.radians(35.0) * 0.8  # of rudder for full steering
    assert f"ATC_STR_RAT_P,{1.5 / share:.6g}\n" in text and "Gains: those given, KP 2, KD 1.5" in text
    with pytest.raises(InputError, match="holds a model and no controller; leave the gains out"):
        st.export(nomoto_file, "c99", tmp_path / "boat", {"KP": 2.0})


@pytest.mark.parametrize(
    ("model", "sentence"),
    [
        (st.models.roll(), "it has no state 'psi'"),
        (st.models.heave_pitch(), "it has no state 'psi'"),
        (
            st.models.model_named(
                "thrusters",
                replace(
                    CATAMARAN,
                    thrusters=(*CATAMARAN.thrusters, Thruster("bow", 0.5, 0.0, CommandInput("command_3"), 1.57)),
                ).text(),
            ),
            "thruster 'bow' is neither a throttle to port nor one to starboard",
        ),
    ],
)
def test_a_model_without_a_place_is_refused(model: st.Model, sentence: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=sentence):
        st.export(model, "ardupilot", tmp_path / "boat.param")
    assert list(tmp_path.iterdir()) == []


def test_a_boat_of_unknown_speed_is_refused(tmp_path: Path) -> None:
    model = st.models.nomoto().with_values({"K": K, "T": T})
    with pytest.raises(InputError, match="does not state the speed of its trials"):
        st.export(model, "ardupilot", tmp_path / "boat.param")


def test_a_plant_no_gains_can_keep_is_refused(craft: SteeredCraft) -> None:
    with pytest.raises(InputError, match=r"gains do not keep model 'nomoto' stable"):
        tune_ardupilot(craft, {"KP": 500.0, "KD": 400.0})
    assert isinstance(craft.heading_plant, Block)
