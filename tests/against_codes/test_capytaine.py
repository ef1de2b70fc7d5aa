"""A Wigley hull through the panel code: long waves, the radiated energy, symmetry at rest, antisymmetry at speed."""

import numpy as np
import pytest
from benchmarks.hull_panels import capytaine_dataset, solve_hull, wigley

from seatrial.core.values import Array, InputError
from seatrial.physics.hydro.capytaine_data import HullData, HullExcitation, hull_data, read_capytaine
from seatrial.physics.hydro.excitation import G

cpt = pytest.importorskip("capytaine", reason="the panel code Capytaine is not installed (extra hydro)")

L, B, T, RHO = 60.0, 7.14, 2.27, 1025.0
HULL = wigley(L, B, T, along=24, down=4)
OMEGA = np.array([0.2, 0.3, 0.4, 0.55, 0.7, 0.85, 1.0, 1.1, 1.2])
HEADINGS = np.linspace(0.0, np.pi, 13)
MASS = np.diag([RHO * 4 / 9 * L * B * T, RHO * 4 / 9 * L * B * T * (0.25 * L) ** 2])


@pytest.fixture(scope="module")
def dataset() -> object:
    return capytaine_dataset(HULL, OMEGA, HEADINGS, rho=RHO)


@pytest.fixture(scope="module")
def hull(dataset: object) -> HullData:
    return hull_data(dataset)  # type: ignore[arg-type]


def _motions(hull: HullData, omega: float, U: float, beta: float) -> tuple[complex, complex]:
    """Heave per elevation and pitch per slope."""
    w, k = np.array([omega]), omega**2 / G
    omega_e = w - k * U * np.cos(beta)
    added, damping = hull.coefficients(omega_e, U)
    force = np.array(HullExcitation(hull).forces(w, U, beta))[:, 0]
    plant = hull.stiffness - omega_e[0] ** 2 * (MASS + added[0]) + 1j * omega_e[0] * damping[0]
    z, theta = np.linalg.solve(plant, force)
    return z, theta / (1j * k * np.cos(beta))


def test_stiffness_and_volume(hull: HullData) -> None:
    """C_wp = 2/3; the second moment of the parabolic water line is L^3 B / 30."""
    np.testing.assert_allclose(hull.stiffness[0, 0], RHO * G * 2 / 3 * L * B, rtol=0.01)
    np.testing.assert_allclose(hull.stiffness[1, 1], RHO * G * L**3 * B / 30, rtol=0.03)


@pytest.mark.parametrize("beta", [0.0, 0.8, 2.2, np.pi])
def test_a_long_wave_carries_the_hull(hull: HullData, beta: float) -> None:
    """The wave of 0.2 rad/s is 26 ship lengths long; heave and pitch follow it in size, sign and phase."""
    z, pitch = _motions(hull, 0.2, 0.0, beta)
    assert abs(z - 1) < 0.01
    assert abs(pitch - 1) < 0.02


def _energy_gap(along: int) -> Array:
    """Relative difference of the damping and k omega / (4 pi rho g^2) int |F|^2 d beta (Newman 1962), (n, 2)."""
    omega = np.array([0.3, 0.7, 1.0])
    hull = solve_hull(wigley(L, B, T, along=along, down=along // 6), omega, HEADINGS, rho=RHO)
    force = hull.froude_krylov.values + hull.diffraction.values
    energy = 2 * np.trapezoid(np.abs(force) ** 2, HEADINGS, axis=1)
    radiated = (omega**3 / G / (4 * np.pi * RHO * G**2))[:, None] * energy
    return np.abs(radiated / np.diagonal(hull.damping, axis1=1, axis2=2) - 1)


def test_excitation_and_damping_share_the_radiated_energy() -> None:
    """Two problems that know nothing of one another; they agree the better the finer the panels."""
    coarse, fine = _energy_gap(24), _energy_gap(36)
    assert np.all(coarse < 0.05)
    assert np.all(fine < 0.75 * coarse)


def test_symmetric_at_rest_antisymmetric_at_speed(hull: HullData) -> None:
    U, omega_e = 6.0, np.array([0.5, 0.8, 1.1])
    scale = np.sqrt(hull.added_mass[:, 0, 0] * hull.added_mass[:, 1, 1])
    assert np.all(np.abs(hull.added_mass[:, 0, 1] - hull.added_mass[:, 1, 0]) < 1e-3 * scale)
    at_rest, moving = hull.coefficients(omega_e, 0.0), hull.coefficients(omega_e, U)
    for still, fast in zip(at_rest, moving, strict=True):
        np.testing.assert_allclose((fast - still)[:, 0, 1], -(fast - still)[:, 1, 0], rtol=1e-9)
    np.testing.assert_allclose((moving[1] - at_rest[1])[:, 0, 1], U * moving[0][:, 0, 0], rtol=1e-9)


def test_the_file_it_writes_is_read_back(dataset: object, hull: HullData, tmp_path: object) -> None:
    pytest.importorskip("h5netcdf", reason="h5netcdf is not installed (extra hydro)")
    path = tmp_path / "wigley.nc"  # type: ignore[operator]
    cpt.export_dataset(path, dataset)
    again = read_capytaine(path)
    np.testing.assert_allclose(again.diffraction.values, hull.diffraction.values, rtol=1e-12)
    np.testing.assert_allclose(again.added_mass, hull.added_mass, rtol=1e-12)
    assert again.added_mass_infinite is not None and hull.added_mass_infinite is not None


def test_shallow_water_gives_the_same_twice() -> None:
    coarse, omega, headings = wigley(L, B, T, along=10, down=2), np.array([0.4, 0.5]), np.array([np.pi])
    one, two = (solve_hull(coarse, omega, headings, depth=12.0) for _ in range(2))
    np.testing.assert_array_equal(one.added_mass, two.added_mass)
    np.testing.assert_array_equal(one.diffraction.values, two.diffraction.values)
    assert one.depth == 12.0
    deep = solve_hull(coarse, omega, headings)
    assert np.all(np.abs(one.added_mass[:, 0, 0] / deep.added_mass[:, 0, 0] - 1) > 0.02)


def test_panels_too_coarse_are_refused() -> None:
    with pytest.raises(InputError, match="too coarse for 3 rad/s"):
        capytaine_dataset(wigley(L, B, T, along=10, down=2), np.array([1.0, 3.0]), np.array([0.0]))
