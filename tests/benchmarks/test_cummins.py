"""The time domain with memory against the frequency domain, on kernels whose transforms are known."""

import numpy as np
import pytest
from benchmarks.cummins import RetardationFunctions, retardation_functions, simulate_cummins

from seatrial.core.values import Array, InputError
from seatrial.physics.hydro.capytaine_data import HullData
from seatrial.physics.hydro.tabulated import WaveTable, coefficients_at_speed

DECAY, TURN = 0.5, 1.2
K0 = np.array([[1.8e6, 4.0e6], [4.0e6, 2.1e8]])
A_INF = np.array([[6.0e5, 1.0e6], [1.0e6, 7.3e7]])
MASS, C = np.diag([4.42e5, 9.945e7]), np.array([[3.15e6, 6.83e6], [6.83e6, 6.54e8]])


def _known(dt: float, length: float) -> RetardationFunctions:
    """K = k0 exp(-a t) (cos b t - a / b sin b t), whose integral exp(-a t) sin(b t) / b dies out."""
    t = dt * np.arange(round(length / dt) + 1)
    shape = np.exp(-DECAY * t) * (np.cos(TURN * t) - DECAY / TURN * np.sin(TURN * t))
    return RetardationFunctions(
        dt, shape[:, None, None] * K0, K0[0, 0] * np.exp(-DECAY * t) * np.sin(TURN * t) / TURN, A_INF
    )


def _transform(omega: Array) -> tuple[Array, Array]:
    """Added mass and damping of that kernel, s / ((s + a)^2 + b^2) at s = i omega."""
    s = 1j * omega
    Z = (s / ((s + DECAY) ** 2 + TURN**2))[:, None, None] * K0
    return A_INF + Z.imag / omega[:, None, None], Z.real


def _hull(omega: Array) -> HullData:
    added, damping = _transform(omega)
    nothing = WaveTable("none", omega, np.array([0.0]), np.zeros((omega.size, 1, 2), dtype=np.complex128))
    return HullData(omega, added, damping, None, nothing, nothing, C, np.inf)


def _response_error(dt: float, U: float, omega_e: float) -> float:
    """Worst relative difference of heave and pitch between the end of a run and the frequency domain."""
    amplitude = np.array([1e5 + 2e4j, -3e6 + 1e6j])
    t = dt * np.arange(round(120.0 / dt))
    wave = np.exp(1j * omega_e * t)
    states = simulate_cummins(_known(dt, 25.0), MASS, C, U, np.real(wave[:, None] * amplitude))
    added, damping = coefficients_at_speed(*_transform(np.array([omega_e])), np.array([omega_e]), U)
    plant = C - omega_e**2 * (MASS + added[0]) + 1j * omega_e * damping[0]
    expected = np.linalg.solve(plant, amplitude)
    end = round(40.0 / dt)
    lines = np.column_stack([wave[-end:].real, -wave[-end:].imag])
    (re, im), *_ = np.linalg.lstsq(lines, states[-end:][:, [0, 2]], rcond=None)
    return float(np.max(np.abs((re + 1j * im) / expected - 1)))


@pytest.mark.parametrize("U", [0.0, 8.0])
@pytest.mark.parametrize("omega_e", [0.7, 1.9])
def test_the_steady_state_is_that_of_the_frequency_domain(U: float, omega_e: float) -> None:
    """The difference falls with the square of the step, at rest and with the speed terms of strip theory."""
    coarse, fine = _response_error(0.05, U, omega_e), _response_error(0.025, U, omega_e)
    assert fine < 5e-3
    assert fine < coarse / 3.5


def test_velocities_belong_to_the_positions() -> None:
    dt = 0.02
    t = dt * np.arange(2000)
    forces = np.column_stack([1e5 * np.sin(0.9 * t) ** 3, 2e6 * np.sin(1.3 * t) ** 3])
    states = simulate_cummins(_known(dt, 20.0), MASS, C, 6.0, forces)
    for position, velocity in ((0, 1), (2, 3)):
        slope = np.gradient(states[:, position], dt)[2:-2]
        assert np.max(np.abs(slope - states[2:-2, velocity])) < 1e-3 * np.max(np.abs(slope))


def test_retardation_from_the_damping() -> None:
    memory, known = retardation_functions(_hull(np.linspace(0.1, 6.0, 60)), 0.05, 25.0), _known(0.05, 25.0)
    later = slice(4, None)
    assert np.max(np.abs(memory.K[later] - known.K[later])) < 0.01 * K0.max()
    assert np.max(np.abs(memory.J - known.J)) < 0.01 * np.abs(known.J).max()
    np.testing.assert_allclose(memory.A_inf, A_INF, rtol=0.01)


def test_memory_and_coefficients_are_one_another() -> None:
    """Ogilvie's relations both ways, from the exact kernel."""
    omega = np.linspace(0.3, 3.0, 12)
    added, damping = _known(0.005, 30.0).coefficients(omega)
    exact_added, exact_damping = _transform(omega)
    for ours, exact in ((added, exact_added), (damping, exact_damping)):
        assert np.all(np.abs(ours - exact).max(axis=0) < 1e-4 * np.abs(exact).max(axis=0))


def test_what_cannot_be_computed_is_refused() -> None:
    with pytest.raises(InputError, match="damping of heave is still"):
        retardation_functions(_hull(np.linspace(0.1, 1.4, 20)), 0.05, 20.0)
    with pytest.raises(InputError, match="time step"):
        retardation_functions(_hull(np.linspace(0.1, 6.0, 20)), 0.0, 20.0)
    memory, forces = _known(0.05, 20.0), np.zeros((100, 2))
    with pytest.raises(InputError, match="finite"):
        simulate_cummins(memory, MASS, C, 0.0, np.full((100, 2), np.nan))
    with pytest.raises(InputError, match="speed"):
        simulate_cummins(memory, MASS, C, -1.0, forces)
    with pytest.raises(InputError, match="too long"):
        simulate_cummins(_known(0.5, 20.0), MASS, C, 0.0, forces)
