"""Line of sight in time: against SciPy's integrator, the closed form of the offset in a current, and at a corner."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from seatrial.core.values import Array, Parameter, Parameters
from seatrial.physics.loops import Block, Sampling, Term, TransferLoop
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.simulate.closed_loop import ActuatorLimits, ClosedLoop
from seatrial.physics.simulate.craft_control import LineOfSight, PlannedTrack, TrackRun, follow_track

K, T, U, TAU = 0.1, 8.0, 5.0, 0.5
KP, KD = 2.0, 20.0
DELTA, SIGMA = 60.0, 1.0


def heading(dt: float, start: Array, current: float = 0.0) -> ClosedLoop:
    """A Nomoto ship under a proportional and a filtered derivative gain."""
    gains = Parameters(tuple(Parameter(name, 1.0, "1", 0.0, 100.0, free=True) for name in ("KP", "KD")))
    terms = (Term("KP", Block("proportional")), Term("KD", Block("derivative", (1.0, 0.0), (TAU, 1.0))))
    plant = Block("rudder to heading", (K,), (T, 1.0, 0.0))
    signals, sampling = ("psi", "delta", "delta"), Sampling(dt)
    loop = TransferLoop("heading", (), terms, (), (), plant, plant, gains, *signals, sampling=sampling)
    model = nomoto().with_values({"K": K, "T": T, "U": U, "current_east": current})
    return ClosedLoop(model, loop, np.array([KP, KD]), dt, "delta", "", "psi", start)


def follow(guidance: LineOfSight, duration: float, r: float = 0.0, current: float = 0.0) -> TrackRun:
    """From the track, at a yaw rate."""
    dt, names = 0.005, nomoto().states
    start = np.array([{"r": r}.get(name, 0.0) for name in names])
    return follow_track(heading(dt, start, current), guidance, np.zeros(round(duration / dt) + 1))


def test_it_is_the_published_law_around_the_heading_loop() -> None:
    """Borhaug's integral, the Nomoto ship and the filtered derivative as one set of equations, by SciPy."""

    def rates(_: float, x: Array) -> list[float]:
        r, psi, y, q, filtered = x
        total = y + SIGMA * q
        error = -math.atan(total / DELTA) - psi
        delta = KP * error + KD * (error - filtered) / TAU
        return [(K * delta - r) / T, r, U * math.sin(psi), DELTA * y / (total**2 + DELTA**2), (error - filtered) / TAU]

    made = follow(LineOfSight(DELTA, SIGMA), 120.0, 0.3)
    exact = solve_ivp(rates, (0.0, 120.0), [0.3, 0.0, 0.0, 0.0, 0.0], rtol=1e-10, atol=1e-10,
                      t_eval=np.linspace(0.0, 120.0, len(made.error)), max_step=0.05)  # fmt: skip
    size = np.abs(exact.y[2]).max()
    assert size > 5.0
    np.testing.assert_allclose(made.error, exact.y[2], atol=1e-3 * size)


@pytest.mark.parametrize("current", [0.5, -1.0])
def test_a_current_leaves_the_offset_of_its_closed_form_without_an_integral(current: float) -> None:
    """U sin(psi) = -V and tan(psi) = -e / Delta: e = Delta V / sqrt(U^2 - V^2) (Borhaug et al. 2008, section III)."""
    made = follow(LineOfSight(DELTA), 400.0, current=current)
    assert made.error[-1] == pytest.approx(DELTA * current / math.sqrt(U**2 - current**2), rel=1e-4)
    assert abs(follow(LineOfSight(DELTA, SIGMA), 600.0, current=current).error[-1]) < 0.02


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_corner_is_taken_at_its_circle_and_overshot_to_the_outside(side: float) -> None:
    dt, turn = 0.05, side * math.radians(70.0)
    track = PlannedTrack(300.0, turn, 40.0)
    closed = heading(dt, np.zeros(len(nomoto().states)))
    limits = ActuatorLimits(math.radians(35.0), math.radians(5.0))
    made = follow_track(closed, LineOfSight(DELTA, 0.0, math.radians(3.0)), np.zeros(6000), track, limits)
    names = closed.model.states
    assert made.states[made.new_leg, names.index("x0")] == pytest.approx(260.0, abs=U * dt)
    behind = side * made.error[made.new_leg :]
    assert behind[0] == pytest.approx(40.0 * math.sin(abs(turn)), abs=1.0)
    assert behind.min() < -1.0
    assert abs(made.error[-1]) < 0.05
    assert made.states[-1, names.index("psi")] == pytest.approx(turn, abs=1e-3)
    assert np.abs(made.actuator).max() <= limits.limit
