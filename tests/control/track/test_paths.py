"""Paths to the track against the equations of motion solved as a matrix at each frequency."""

from pathlib import Path

import numpy as np
import pytest
from tests.control.track.track_cases import track_task_of

from seatrial.control.ship import linearise
from seatrial.control.track.paths import CURRENT, EAST, HeadingLoop, Reach
from seatrial.control.track.tune_track import DISTURBANCE, heading_loop_of, linear_ship
from seatrial.core.values import Array

OMEGA = np.geomspace(1e-3, 10.0, 60)


@pytest.fixture
def heading(tmp_path: Path) -> HeadingLoop:
    task = track_task_of(tmp_path)
    return heading_loop_of(task, task.loop)


def answer(heading: HeadingLoop, disturbed: Array, order: float) -> tuple[Array, Array]:
    """Return y0 and psi (n,) by (j omega - A) x = b delta + e w + b K psi_d, delta = K (psi_d - psi)."""
    ship, names = heading.ship, heading.ship.model.states
    linear = linearise(ship)
    column = ship.model.input_names.index(ship.actuator)
    b = linear.B[:, column] * (-1.0 if ship.model.inputs[column].is_reversed else 1.0)
    east, north = names.index(EAST), names.index("psi")
    K = heading.loop.gain_values @ heading.loop.continuous.controller_terms(OMEGA)
    found = []
    for omega, gain in zip(OMEGA, K, strict=True):
        A = linear.A.astype(complex).copy()
        A[:, north] -= b * gain
        found.append(np.linalg.solve(1j * omega * np.eye(len(b)) - A, disturbed + b * gain * order))
    x = np.array(found)
    return x[:, east], x[:, north]


def unit(heading: HeadingLoop, state: str) -> Array:
    return np.array([1.0 if name == state else 0.0 for name in heading.ship.model.states])


def test_the_order_reaches_the_track_through_heading_and_sway(heading: HeadingLoop) -> None:
    y, _ = answer(heading, 0.0 * unit(heading, EAST), 1.0)
    np.testing.assert_allclose(heading.order_to_track().frequency_response(OMEGA), y, rtol=1e-8)


@pytest.mark.parametrize("kind", ["current", "waves", "rudder"])
def test_a_disturbance_reaches_the_track_with_the_heading_kept(heading: HeadingLoop, kind: str) -> None:
    reach: Reach = {"current": CURRENT, "waves": heading.waves, "rudder": heading.rudder}[kind]
    ship = heading.ship
    column = ship.model.input_names.index(ship.actuator)
    b = linearise(ship).B[:, column] * (-1.0 if ship.model.inputs[column].is_reversed else 1.0)
    disturbed = {"current": unit(heading, EAST), "waves": unit(heading, "r"), "rudder": b}[kind]
    y, psi = answer(heading, disturbed, 0.0)
    np.testing.assert_allclose(heading.disturbance_to_track(reach).frequency_response(OMEGA), y, rtol=1e-6)
    K = heading.loop.gain_values @ heading.loop.continuous.controller_terms(OMEGA)
    made = heading.rudder_response(reach, np.zeros(len(OMEGA), dtype=complex), OMEGA)
    np.testing.assert_allclose(made, -K * psi, rtol=1e-6, atol=1e-12)


def test_the_linear_ship_has_the_matrices_of_the_trim(heading: HeadingLoop) -> None:
    ship = heading.ship
    model = linear_ship(ship, EAST)
    assert model.input_names == (ship.actuator, DISTURBANCE)
    values = dict(zip(model.parameters.names, model.parameters.values.tolist(), strict=True))
    kept = [ship.model.states.index(name) for name in model.states]
    A = np.array([[values[f"A_{i}_{j}"] for j in range(len(kept))] for i in range(len(kept))])
    np.testing.assert_array_equal(A, linearise(ship).A[np.ix_(kept, kept)])
    assert values[f"B_{model.states.index(EAST)}_1"] == 1.0
