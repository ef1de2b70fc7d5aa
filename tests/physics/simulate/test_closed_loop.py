"""A loop in time: the linear answer where nothing bites, and what limits, stall and trims do."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import lsim

from seatrial.core.equations import Model
from seatrial.core.values import Array, DivergedError, InputError, Parameter, Parameters, Record
from seatrial.numerics.kernels.feedback import effective_angle
from seatrial.physics.loops import Block, Sampling, Term, TransferLoop
from seatrial.physics.loops.loop_states import plant_model, state_space
from seatrial.physics.loops.structures import Preamplifier, fin_loop
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.published import container_ship
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate.closed_loop import (
    UNLIMITED,
    ActuatorLimits,
    ClosedLoop,
    fastest_motion,
    hold_equivalent,
)

WASHOUT, PRINTED = fin_loop(Preamplifier.WASHOUT), fin_loop(Preamplifier.PRINTED)
FINS = {"actuator": "alpha_f", "disturbance_input": "alpha_w", "output": "phi"}
RUDDER = {"actuator": "delta", "disturbance_input": "", "output": "psi"}


def gains(*names: str) -> Parameters:
    return Parameters(tuple(Parameter(name, 1.0, "1", 0.0, 100.0, free=True) for name in names))


def test_steps_follow_the_fastest_pole_of_the_plant() -> None:
    assert fastest_motion(follower(Block("lag", (1.0,), (2.0, 1.0)))) == pytest.approx(0.5)


def follower(plant: Block, servo: tuple[Block, ...] = ()) -> TransferLoop:
    """Proportional and integral gains, for steps of the reference."""
    terms = (Term("P", Block("proportional")), Term("I", Block("integral", (1.0,), (1.0, 0.0))))
    return TransferLoop("follower", (), terms, (), servo, plant, plant, gains("P", "I"), "phi", "alpha_f", "alpha_w")


def test_a_sampled_loop_without_limits_is_its_difference_equations() -> None:
    """No sum that rounds beside the order holds the integral: x' = (a - x) / 2, order held, Tustin's rule."""
    loop, T, push = follower(Block("lag", (1.0,), (2.0, 1.0))), 0.1, 0.3 * swell(0.1 * np.arange(400))
    made = closed_loop(plant_model(loop), loop, np.array([0.7, 0.9]), 0.0 * push, T, reference=push, **FINS)
    keeps, x, integral, before = math.exp(-0.5 * T), 0.0, 0.0, 0.0
    for k, wanted in enumerate(push):
        assert made["phi"][k] == pytest.approx(x, abs=1e-15)
        error = wanted - x
        integral, before = integral + 0.5 * T * (error + before), error
        x = keeps * x + (1.0 - keeps) * (0.7 * error + 0.9 * integral)


def autopilot(plant: Block) -> TransferLoop:
    """Proportional and filtered derivative gains."""
    terms = (Term("P", Block("proportional")), Term("D", Block("derivative", (1.0, 0.0), (0.5, 1.0))))
    return TransferLoop("autopilot", (), terms, (), (), plant, plant, gains("P", "D"), "psi", "delta", "w")


def closed_loop(
    model: Model, loop: TransferLoop, values: Array, disturbance: Array, dt: float, *,
    limits: ActuatorLimits = UNLIMITED, reference: Array | None = None, **where: Any,
) -> Record:  # fmt: skip
    sampled = replace(loop, sampling=Sampling(dt))
    return ClosedLoop(model, sampled, values, dt, **where).record("closed", disturbance, limits, reference)


def swell(time: Array) -> Array:
    """rad, from rest."""
    return 0.05 * (np.sin(0.7 * time) - 0.5 * np.sin(1.3 * time) + 0.3 * np.sin(1.9 * time))


def rolled(loop: TransferLoop, dt: float, duration: float = 120.0, size: float = 1.0, **limits: float) -> Record:
    disturbance = size * swell(np.arange(0.0, duration, dt))
    return closed_loop(
        plant_model(loop), loop, loop.gain_values, disturbance, dt, limits=ActuatorLimits(**limits), **FINS
    )  # fmt: skip


def exact(loop: TransferLoop, time: Array, finer: int) -> tuple[Array, Array]:
    """Output and actuator by exact steps `finer` times shorter."""
    fine = np.linspace(time[0], time[-1], (len(time) - 1) * finer + 1)
    made = state_space(loop)
    rows = np.stack([made.c, made.actuator_row(loop.gain_values)])
    system = (made.closed_loop_matrix(loop.gain_values), made.b[:, None], rows, np.zeros((2, 1)))
    _, seen, _ = lsim(system, swell(fine), fine)
    return seen[::finer, 0], seen[::finer, 1]


def off(loop: TransferLoop, dt: float) -> tuple[float, float]:
    """RMS errors of roll and fin over their own size."""
    record = rolled(loop, dt)
    roll, fin = exact(loop, record.time, round(dt / 0.005))
    return (
        float(np.std(record["phi"] - roll) / np.std(roll)),
        float(np.std(record["alpha_f"] - fin) / np.std(fin)),
    )


@pytest.mark.parametrize("loop", [WASHOUT, PRINTED])
def test_without_limits_it_comes_to_the_linear_loop_as_samples_get_shorter(loop: TransferLoop) -> None:
    """The gyro's poles, -40 +- 49 j, are far beyond what Runge-Kutta steps of .1 s bear."""
    coarse, fine = off(loop, 0.02), off(loop, 0.01)
    assert max(fine) < 0.05
    assert all(1.8 < a / b < 2.2 for a, b in zip(coarse, fine, strict=True))


@settings(max_examples=15)
@given(omega=st.floats(0.2, 2.5), loop=st.sampled_from([WASHOUT, PRINTED]))
def test_a_steady_wave_gives_the_frequency_response(omega: float, loop: TransferLoop) -> None:
    dt, periods = 0.05, 12
    time = np.arange(0.0, 400.0 + periods * 2.0 * math.pi / omega, dt)
    record = closed_loop(plant_model(loop), loop, loop.gain_values, 0.01 * np.sin(omega * time), dt, **FINS)
    late = time > 400.0
    table = np.stack([np.sin(omega * time), np.cos(omega * time), np.ones(len(time))], axis=1)[late]
    a, b, _ = np.linalg.lstsq(table, record["phi"][late] / 0.01, rcond=None)[0]
    at, loop = np.array([omega]), replace(loop, sampling=Sampling(dt))
    wanted = complex((loop.disturbance.frequency_response(at) / (1.0 + loop.open_loop(at)))[0])
    # second order in the step, and as sensitive as the loop itself
    sensitivity = 1.0 / abs(1.0 + complex(loop.open_loop(at)[0]))
    assert abs(complex(a, b) - wanted) < (omega * dt) ** 2 * max(sensitivity, 1.0) * abs(wanted) + 1e-4 * abs(wanted)


def test_limits_that_never_bite_change_nothing() -> None:
    free, wide = rolled(WASHOUT, 0.05), rolled(WASHOUT, 0.05, limit=10.0, rate=100.0, stall=9.0)
    assert np.array_equal(free["phi"], wide["phi"])


@settings(max_examples=20)
@given(size=st.floats(0.1, 5.0), limit=st.floats(0.05, 0.5), rate=st.floats(0.05, 0.6))
def test_angle_and_rate_stay_within_their_limits(size: float, limit: float, rate: float) -> None:
    fin = rolled(WASHOUT, 0.1, 60.0, size, limit=limit, rate=rate)["alpha_f"]
    assert np.abs(fin).max() <= limit
    assert np.abs(np.diff(fin)).max() <= rate * 0.1 * (1.0 + 1e-9)


def test_beyond_stall_the_effect_falls() -> None:
    """As steeply as it rose where nothing else is said, evenly on either side, and never turns round."""
    angles = np.radians([-40.0, -22.0, -18.0, 0.0, 10.0, 18.0, 20.0, 22.0, 40.0])
    effective = [math.degrees(effective_angle(a, math.radians(18.0), 1.0)) for a in angles]
    assert effective == pytest.approx([0.0, -14.0, -18.0, 0.0, 10.0, 18.0, 16.0, 14.0, 0.0], abs=1e-9)
    assert effective_angle(0.5, 0.3, 0.0) == 0.3


def test_stall_costs_more_than_limits() -> None:
    sizes = [
        np.std(rolled(WASHOUT, 0.05, 300.0, 2.0, **what)["phi"])
        for what in ({}, {"limit": 0.384, "rate": 0.436}, {"limit": 0.384, "rate": 0.436, "stall": 0.314})
    ]
    assert sizes[0] < sizes[1] < sizes[2]


def test_a_slow_term_does_not_wind_up() -> None:
    """P and I cancel the plant's pole, L = 1 / (2 s): no overshoot, unless the integral grows while the limit bites."""
    loop = follower(Block("plant", (1.0,), (10.0, 1.0)))
    record = closed_loop(plant_model(loop), loop, np.array([5.0, 0.5]), np.zeros(1201), 0.05,
                         reference=np.ones(1201), limits=ActuatorLimits(limit=1.1), **FINS)  # fmt: skip
    assert record["alpha_f"].max() == 1.1
    assert record["phi"].max() < 1.01
    assert record["phi"][-1] == pytest.approx(1.0, abs=2e-3)
    assert winding_up(1.1, 0.05, 1201).max() > 1.05


def winding_up(limit: float, dt: float, count: int) -> Array:
    """The same loop by Euler's steps, its integral going on."""
    y, integral, made = 0.0, 0.0, []
    for _ in range(count):
        made.append(y)
        order = 5.0 * (1.0 - y) + 0.5 * integral
        integral += dt * (1.0 - y)
        y += dt * (min(max(order, -limit), limit) - y) / 10.0
    return np.array(made)


def test_a_course_is_kept_and_changed() -> None:
    ship = nomoto()
    K, T = ship.parameters["K"].value, ship.parameters["T"].value
    loop = autopilot(Block("yaw", (K,), (T, 1.0, 0.0)))
    reference = np.full(4001, math.radians(20.0))
    record = closed_loop(ship, loop, np.array([1.0, 5.0]), np.zeros(4001), 0.1, reference=reference,
                         limits=ActuatorLimits(math.radians(35.0), math.radians(2.3)), **RUDDER)  # fmt: skip
    assert record["psi"][-1] == pytest.approx(math.radians(20.0), rel=1e-3)
    assert record["reference"][0] == math.radians(20.0)
    assert record.channel("reference").unit == "rad"


def test_signs_are_the_notations_whatever_the_models() -> None:
    """The waterjet's nozzle is positive to port; trims are kept."""
    ship = waterjet()
    states, inputs = np.zeros(len(ship.states)), np.zeros(len(ship.inputs))
    states[ship.states.index("u")], inputs[ship.input_names.index("v_j")] = 0.8, 1.866
    loop = autopilot(Block("yaw", (0.0045,), (1.0, 0.28, 0.0)))
    record = closed_loop(ship, loop, np.array([1.0, 30.0]), np.zeros(8001), 0.05, reference=np.full(8001, 0.2),
                         start=states, inputs=inputs, limits=ActuatorLimits(0.5), **RUDDER)  # fmt: skip
    assert record["delta"][1:20].min() > 0.1
    assert record["psi"][-1] == pytest.approx(0.2, abs=0.005)
    assert record["psi"].max() < 0.25
    assert record["u"][-1] == pytest.approx(0.8, abs=0.02)


def test_a_ship_with_outputs_is_recorded_with_them() -> None:
    ship = container_ship()
    states, inputs = np.zeros(len(ship.states)), np.zeros(len(ship.inputs))
    states[ship.states.index("u")], inputs[ship.input_names.index("n")] = 7.33, 70.0 / 60.0
    loop = autopilot(Block("yaw", (0.0043,), (1.0, 0.02, 0.0)))
    record = closed_loop(ship, loop, np.array([1.0, 30.0]), np.zeros(401), 0.5, reference=np.full(401, 0.05),
                         start=states, inputs=inputs, limits=ActuatorLimits(0.3), **RUDDER)  # fmt: skip
    assert record["thrust"][-1] > 1e5
    assert record["psi"][-1] == pytest.approx(0.05, abs=0.01)


def test_a_disturbance_may_act_where_the_actuator_does() -> None:
    ship = nomoto()
    K, T = ship.parameters["K"].value, ship.parameters["T"].value
    loop = autopilot(Block("yaw", (K,), (T, 1.0, 0.0)))
    where = {**RUDDER, "disturbance_input": "delta"}
    record = closed_loop(ship, loop, np.array([2.0, 5.0]), np.full(6001, 0.1), 0.1, **where)
    assert record["psi"][-1] == pytest.approx(0.05, rel=1e-3)
    assert record["delta"][-1] == pytest.approx(-0.1, rel=1e-3)


@pytest.mark.parametrize("omega", [0.5, 1.5])
def test_values_held_act_as_the_smooth_series(omega: float) -> None:
    """Behind two integrations, where their mean would leave an error of second order."""

    def error(dt: float) -> float:
        time = np.arange(0.0, 40.0, dt)
        u = hold_equivalent(np.sin(omega * time))
        speed = np.concatenate([[0.0], np.cumsum(u * dt)])[:-1]
        y = np.concatenate([[0.0], np.cumsum(speed * dt + 0.5 * u * dt**2)])[:-1]
        exactly = time / omega - np.sin(omega * time) / omega**2
        off = (y - exactly)[2:]
        line = np.polyval(np.polyfit(time[2:], off, 1), time[2:])
        return float(np.abs(off - line).max() * omega**2)

    assert error(0.2) < 0.1 * (0.2 * omega) ** 3
    assert error(0.2) / error(0.1) > 6.0


def test_a_loop_that_runs_away_is_said_to() -> None:
    loop = fin_loop(Preamplifier.PRINTED)
    with pytest.raises(DivergedError, match=r"diverges.*left its bounds|runs away"):
        closed_loop(plant_model(loop), loop, -3.0 * loop.gain_values, np.full(40_001, 0.01), 0.1, **FINS)


def test_what_does_not_fit_is_named() -> None:
    model, w = plant_model(WASHOUT), np.zeros(10)
    with pytest.raises(InputError, match="needs 'theta' as state"):
        closed_loop(model, WASHOUT, WASHOUT.gain_values, w, 0.1, **{**FINS, "output": "theta"})
    with pytest.raises(InputError, match="needs 'delta' as input"):
        closed_loop(model, WASHOUT, WASHOUT.gain_values, w, 0.1, **{**FINS, "actuator": "delta"})
    with pytest.raises(InputError, match="3 finite gains: KP, KI, KD"):
        closed_loop(model, WASHOUT, np.ones(2), w, 0.1, **FINS)
    with pytest.raises(InputError, match="without gaps"):
        closed_loop(model, WASHOUT, WASHOUT.gain_values, np.full(10, np.nan), 0.1, **FINS)
    with pytest.raises(InputError, match="same number of samples"):
        closed_loop(model, WASHOUT, WASHOUT.gain_values, w, 0.1, reference=np.zeros(9), **FINS)
    with pytest.raises(InputError, match=r"step of a loop .* must be positive"):
        ClosedLoop(model, replace(WASHOUT, sampling=Sampling(0.1)), WASHOUT.gain_values, 0.0, **FINS)
    with pytest.raises(InputError, match="takes no samples; give it sampling"):
        ClosedLoop(model, WASHOUT, WASHOUT.gain_values, 0.1, **FINS)
    with pytest.raises(InputError, match="2 finite values for 'start'"):
        ClosedLoop(model, WASHOUT, WASHOUT.gain_values, 0.1, "alpha_f", "alpha_w", "phi", start=np.zeros(3))
    with pytest.raises(InputError, match="actuator's rate must be positive"):
        ActuatorLimits(rate=0.0)
