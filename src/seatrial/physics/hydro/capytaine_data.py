"""A dataset of the panel code Capytaine at zero speed to hull data and wave excitation in our convention.

Capytaine (its manual, "Conventions"): time factor exp(-i omega t), incident potential -i g / omega exp(k z)
exp(i k (x cos beta + y sin beta)), so that the crest is at the origin at t = 0 and the wave travels towards beta: 0 is
following. Its axes are x forward (as meshed), z up, pitch the rotation about y to port, bow down. Forces therefore
become ours by complex conjugation alone; added mass, damping and stiffness stay.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from seatrial.core.values import Array, InputError, spelling_hint
from seatrial.core.values.files import is_file
from seatrial.physics.hydro.excitation import Complex, checked_waves, wavenumber
from seatrial.physics.hydro.tabulated import (
    WaveTable,
    coefficients_at_speed,
    excitation_at_speed,
    interpolated,
    refuse_outside,
)

if TYPE_CHECKING:
    import xarray as xr

DOFS = ["Heave", "Pitch"]
_REQUIRED_VARIABLES = (
    "added_mass", "radiation_damping", "diffraction_force", "Froude_Krylov_force", "hydrostatic_stiffness",
)  # fmt: skip
_MIDSHIP_TOLERANCE, _HEADING_TOLERANCE = 1e-6, 1e-9  # m and rad by which a dataset may be off: rounding


@dataclass(frozen=True)
class HullData:
    """Heave and pitch of a hull at rest over frequency; the reference point is midship, pitch bow down.

    Attributes:
        omega: rad/s (n,), rising.
        added_mass, damping: (n, 2, 2), heave first; rows are forces, columns motions.
        added_mass_infinite: added mass at infinite frequency (2, 2), if it was computed.
        froude_krylov, diffraction: WaveTable, values (n, h, 2) per metre of wave amplitude.
        stiffness: (2, 2).
        depth: of the water, m; infinite for deep.
    """

    omega: Array
    added_mass: Array
    damping: Array
    added_mass_infinite: Array | None
    froude_krylov: WaveTable
    diffraction: WaveTable
    stiffness: Array
    depth: float

    def coefficients(self, omega_e: Array, U: float) -> tuple[Array, Array]:
        """Added mass and damping (k, 2, 2) at the frequencies of encounter (k,), with the speed terms of strip theory.

        Raises:
            InputError: |omega_e| outside the data (not extrapolated), or as `strip_theory.coefficients_at_speed`.
        """
        felt = np.abs(omega_e)
        refuse_outside("the hull data", "frequency of encounter", "rad/s", self.omega, felt)
        inside = np.clip(felt, self.omega[0], self.omega[-1])
        A, B = (np.real(interpolated(self.omega, table, inside)) for table in (self.added_mass, self.damping))
        return coefficients_at_speed(A, B, omega_e, U)


@dataclass(frozen=True)
class HullExcitation:
    """`Excitation` of a hull from its data at rest, with the speed terms of strip theory."""

    data: HullData

    @property
    def frequency_range(self) -> tuple[float, float]:
        """The ends of the data [rad/s]."""
        return self.data.froude_krylov.frequency_range

    def forces(self, omega: Array, U: float, beta: Array | float) -> tuple[Complex, Complex]:
        """Return `Excitation.forces`: Froude-Krylov force and diffraction at the frequency of the wave.

        Raises:
            InputError: frequency or heading outside the data, or as `checked_waves`.
        """
        w, heading = checked_waves(omega, U, beta)
        omega_e = w - wavenumber(w, self.data.depth) * U * np.cos(heading)
        incident, scattered = (
            table.interpolate(w, U, heading) for table in (self.data.froude_krylov, self.data.diffraction)
        )
        total = excitation_at_speed(incident, scattered, w, omega_e, U)
        return total[:, 0], total[:, 1]


def read_capytaine(path: str | Path) -> HullData:
    """Return hull data from a NetCDF file that Capytaine wrote.

    Raises:
        InputError: no such file, not NetCDF, xarray not installed, or as `hull_data`.
    """
    file = Path(path)
    if not is_file(file):
        raise InputError(f"there is no file {file} with hydrodynamic data")
    try:
        import xarray as xr
    except ImportError:
        advice = "install them with: pip install 'seatrial[hydro]'"
        raise InputError(f"{file.name} needs xarray and h5netcdf; {advice}") from None
    try:
        dataset = xr.load_dataset(file)
    except (OSError, ValueError) as error:
        raise InputError(f"{file.name} is not a readable NetCDF file ({str(error).splitlines()[0]})") from None
    return hull_data(dataset, name=file.name)


def hull_data(dataset: xr.Dataset, name: str = "the dataset") -> HullData:
    """Hull data from a Capytaine dataset in memory; headings beyond 0 to 180 degrees are mirrored ones and left out.

    Raises:
        InputError: a variable, a degree of freedom or heading is missing, the dataset was computed with forward speed
            or about a point that is not midship, or holds NaN.
    """
    for key in _REQUIRED_VARIABLES:
        if key not in dataset:
            raise InputError(f"{name} has no variable '{key}'{spelling_hint(key, [str(v) for v in dataset.data_vars])}")
    _refuse_other_conventions(dataset, name)
    dataset = _heave_and_pitch(dataset, name).sortby("omega")
    finite = np.isfinite(dataset["omega"].values)
    part = dataset.isel(omega=finite)
    omega = np.asarray(part["omega"].values, dtype=np.float64)
    pair = ("omega", "influenced_dof", "radiating_dof")
    A, B = (_real_values(part[key].transpose(*pair), f"{name}: {key}") for key in ("added_mass", "radiation_damping"))
    limit = _real_values(dataset["added_mass"].isel(omega=~finite).transpose(*pair), f"{name}: added_mass")
    tables = [_wave_table(part, key, name) for key in ("Froude_Krylov_force", "diffraction_force")]
    C = _real_values(dataset["hydrostatic_stiffness"].transpose(*pair[1:]), f"{name}: hydrostatic_stiffness")
    depth = float(dataset["water_depth"]) if "water_depth" in dataset.coords else np.inf
    return HullData(omega, A, B, limit[-1] if limit.size else None, tables[0], tables[1], C, depth)


def _refuse_other_conventions(dataset: xr.Dataset, name: str) -> None:
    """Refuse data computed with forward speed or about another reference point."""
    if "forward_speed" in dataset.coords and np.any(dataset["forward_speed"].values != 0.0):
        raise InputError(
            f"{name} was computed with forward speed, which breaks the antisymmetry of A35, A53; compute it at rest, "
            "the speed terms are added here"
        )
    if "rotation_center" in dataset and np.abs(np.ravel(dataset["rotation_center"].values)[0]) > _MIDSHIP_TOLERANCE:
        raise InputError(f"{name} turns about a point that is not midship; give the rotation centre x = 0")


def _heave_and_pitch(dataset: xr.Dataset, name: str) -> xr.Dataset:
    """Return heave and pitch, one water depth, one period axis."""
    for dimension in ("influenced_dof", "radiating_dof"):
        labels = [str(v) for v in np.atleast_1d(dataset[dimension].values)] if dimension in dataset.coords else []
        for dof in DOFS:
            if dof not in labels:
                raise InputError(f"{name} has no degree of freedom '{dof}' among {labels}")
    if "omega" not in dataset.dims:
        raise InputError(f"{name} has no dimension 'omega'")
    chosen = dataset.sel(influenced_dof=DOFS, radiating_dof=DOFS)
    if "water_depth" in chosen.dims:
        if chosen.sizes["water_depth"] != 1:
            raise InputError(f"{name} holds several water depths; choose one")
        chosen = chosen.squeeze("water_depth")
    return chosen


def _wave_table(dataset: xr.Dataset, key: str, name: str) -> WaveTable:
    """Return a wave force, conjugated from exp(-i omega t) to exp(+i omega t)."""
    force = dataset[key]
    if "complex" in force.dims:
        force = force.sel(complex="re") + 1j * force.sel(complex="im")
    if "wave_direction" not in force.dims:
        force = force.expand_dims("wave_direction")
    force = force.sortby("wave_direction").transpose("omega", "wave_direction", "influenced_dof")
    headings = np.asarray(force["wave_direction"].values, dtype=np.float64)
    kept = (headings > -_HEADING_TOLERANCE) & (headings < np.pi + _HEADING_TOLERANCE)
    return WaveTable(
        f"{name}: {key}",
        np.asarray(dataset["omega"].values, dtype=np.float64),
        np.clip(headings[kept], 0.0, np.pi),
        np.conj(np.asarray(force.values, dtype=np.complex128)[:, kept]),
    )


def _real_values(array: xr.DataArray, name: str) -> Array:
    values = np.asarray(array.values, dtype=np.float64)
    if not np.all(np.isfinite(values)):
        raise InputError(f"{name} holds NaN; leave out the frequencies that were not solved")
    return values
