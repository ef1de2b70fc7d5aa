"""Datasets of the panel code mapped to our convention, made by hand here: conjugation, order, and what is refused."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from seatrial.core.values import InputError
from seatrial.physics.hydro.capytaine_data import HullExcitation, hull_data, read_capytaine
from seatrial.physics.hydro.excitation import G

xr = pytest.importorskip("xarray", reason="xarray is not installed (extra hydro)")

OMEGA = np.linspace(0.3, 1.5, 13)
HEADINGS = np.array([0.0, 0.5 * np.pi, np.pi, 1.5 * np.pi])
X = 10.0


def capytaine_dataset(frequencies: np.ndarray = OMEGA) -> "xr.Dataset":
    """A float of unit stiffness at x = 10 m that feels the elevation there: exp(i k x cos beta), no diffraction."""
    k = frequencies**2 / G
    elevation = np.exp(1j * k[:, None] * X * np.cos(HEADINGS))
    dofs = ["Pitch", "Surge", "Heave"]
    force = np.stack([-X * elevation, 0 * elevation, elevation], axis=-1)
    A = np.zeros((frequencies.size, 3, 3))
    A[:, 2, 2], A[:, 2, 0], A[:, 0, 2], A[:, 0, 0] = frequencies, 100.0, 200.0, 50.0
    pair, waves = ("omega", "influenced_dof", "radiating_dof"), ("omega", "wave_direction", "influenced_dof")
    C = np.array([[X**2, 0, -X], [0, 0, 0], [-X, 0, 1]])
    return xr.Dataset(
        {
            "added_mass": (pair, A),
            "radiation_damping": (pair, 0.1 * A),
            "Froude_Krylov_force": (waves, force),
            "diffraction_force": (waves, 0 * force),
            "hydrostatic_stiffness": (pair[1:], C),
        },
        coords={
            "omega": frequencies,
            "wave_direction": HEADINGS,
            "influenced_dof": dofs,
            "radiating_dof": dofs,
            "forward_speed": 0.0,
            "water_depth": np.inf,
        },
    )


def test_a_crest_reaches_the_forward_point_early_in_head_waves() -> None:
    """The crest passes x = 10 m a phase k x before midship in head waves, and after it in following ones."""
    excitation = HullExcitation(hull_data(capytaine_dataset()))
    k = OMEGA**2 / G
    head, head_moment = excitation.forces(OMEGA, 0.0, np.pi)
    following, _ = excitation.forces(OMEGA, 0.0, 0.0)
    np.testing.assert_allclose(head, np.exp(1j * k * X), rtol=1e-12)
    np.testing.assert_allclose(following, np.exp(-1j * k * X), rtol=1e-12)
    np.testing.assert_allclose(head_moment, -X * head, rtol=1e-12)
    assert excitation.frequency_range == (0.3, 1.5)


def test_rows_are_forces_and_heave_comes_first() -> None:
    data = hull_data(capytaine_dataset())
    np.testing.assert_allclose(data.added_mass[:, 0, 0], OMEGA)
    assert data.added_mass[0, 0, 1] == 100.0 and data.added_mass[0, 1, 0] == 200.0
    np.testing.assert_allclose(data.stiffness, [[1.0, -X], [-X, X**2]])
    assert data.added_mass_infinite is None and data.depth == np.inf


def test_the_order_of_dimensions_and_rows_is_no_matter() -> None:
    one, other = (
        hull_data(capytaine_dataset()),
        hull_data(capytaine_dataset().transpose().isel(omega=slice(None, None, -1))),
    )
    np.testing.assert_array_equal(one.added_mass, other.added_mass)
    np.testing.assert_array_equal(one.froude_krylov.values, other.froude_krylov.values)


def test_infinite_frequency_is_set_apart() -> None:
    ends = capytaine_dataset().isel(omega=[-1]).assign_coords(omega=[np.inf])
    waves = ["Froude_Krylov_force", "diffraction_force"]
    ends[waves] = ends[waves] * np.nan
    data = hull_data(xr.concat([capytaine_dataset(), ends], dim="omega", data_vars="minimal"))
    assert data.added_mass_infinite is not None and data.added_mass_infinite[0, 0] == OMEGA[-1]
    np.testing.assert_array_equal(data.omega, OMEGA)


def test_coefficients_at_speed_come_from_the_frequency_of_encounter() -> None:
    data = hull_data(capytaine_dataset())
    A, B = data.coefficients(np.array([-0.9]), 4.0)
    np.testing.assert_allclose(A[0, 0, 0], 0.9, rtol=1e-6)
    np.testing.assert_allclose(B[0, 0, 1] - B[0, 1, 0], 0.1 * (100 - 200) + 2 * 4.0 * 0.9, rtol=1e-6)
    with pytest.raises(InputError, match=r"frequency of encounter 0\.3 to 1\.5"):
        data.coefficients(np.array([2.0]), 0.0)


def test_a_file_with_parts_apart(tmp_path: Path) -> None:
    """As Capytaine writes it: a dimension 'complex' of re and im."""
    pytest.importorskip("h5netcdf", reason="h5netcdf is not installed (extra hydro)")
    dataset = capytaine_dataset()
    for key in ("Froude_Krylov_force", "diffraction_force"):
        dataset[key] = xr.concat([dataset[key].real, dataset[key].imag], dim="complex").assign_coords(
            complex=["re", "im"]
        )
    dataset.to_netcdf(tmp_path / "hull.nc", engine="h5netcdf")
    again, one = read_capytaine(tmp_path / "hull.nc"), hull_data(capytaine_dataset())
    np.testing.assert_array_equal(again.froude_krylov.values, one.froude_krylov.values)
    np.testing.assert_array_equal(again.damping, one.damping)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda d: d.drop_vars("diffraction_force"), "no variable 'diffraction_force'"),
        (lambda d: d.isel(radiating_dof=[0, 1]), "no degree of freedom 'Heave'"),
        (lambda d: d.assign_coords(forward_speed=5.0), "compute it at rest"),
        (lambda d: d.assign(rotation_center=("space", [3.0, 0.0, 0.0])), "midship"),
        (lambda d: d.assign(added_mass=d.added_mass.where(d.omega > 0.5)), "added_mass holds NaN"),
        (lambda d: d.assign(diffraction_force=d.diffraction_force * np.nan), "no finite value"),
        (lambda d: d.isel(wave_direction=[3]), "headings"),
    ],
)
def test_datasets_out_of_sense(change: Callable, words: str) -> None:
    with pytest.raises(InputError, match=words):
        hull_data(change(capytaine_dataset()))


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no file"):
        read_capytaine(tmp_path / "none.nc")
    (tmp_path / "bad.nc").write_text("not netcdf", encoding="utf-8")
    with pytest.raises(InputError, match="not a readable NetCDF"):
        read_capytaine(tmp_path / "bad.nc")
