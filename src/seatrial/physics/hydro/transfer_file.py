"""Complex transfer functions of the wave force from a file: CSV or NetCDF to an excitation."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from seatrial.core.values import Array, InputError, spelling_hint
from seatrial.core.values.files import is_file
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.hydro.tabulated import WaveTable

CARTESIAN_COLUMNS = ("F3_real", "F3_imag", "M5_real", "M5_imag")
POLAR_COLUMNS = ("F3_amplitude", "F3_phase_deg", "M5_amplitude", "M5_phase_deg")
_SPEED_TOLERANCE = 1e-6  # m/s by which the speeds of a file may differ: rounding


_LARGEST_FORCE = 1e30  # N or N m per metre; ours: beyond every ship's, and its square is still a number


@dataclass(frozen=True)
class TabulatedExcitation:
    """Excitation read between the points of a table.

    Attributes:
        table: values (n, h, 2), F3 [N/m] and M5 [N m/m] in the convention of `Excitation`.
        speed: m/s at which the table was made; None for one that is taken to hold at any speed.
    """

    table: WaveTable
    speed: float | None = None

    @property
    def frequency_range(self) -> tuple[float, float]:
        """The ends of the table [rad/s]."""
        return self.table.frequency_range

    def forces(self, omega: Array, U: float, beta: Array | float) -> tuple[Complex, Complex]:
        """Return the forces of `Excitation.forces`.

        Raises:
            InputError: frequency, heading or speed not in the table; nothing is extrapolated.
        """
        if self.speed is not None and abs(U - self.speed) > _SPEED_TOLERANCE * max(1.0, self.speed):
            raise InputError(f"{self.table.name} holds at {self.speed:g} m/s, so it cannot give forces at {U:g} m/s")
        values = self.table.interpolate(omega, U, beta)
        return values[:, 0], values[:, 1]


def read_transfer(
    path: str | Path, *, heading_deg: float | None = None, speed: float | None = None
) -> TabulatedExcitation:
    """Read a table of transfer functions; a name ending in `.nc` is NetCDF, any other is CSV with a header.

    Columns: `omega` [rad/s, of the wave], `heading_deg` (0 following, 180 head; may be missing if given here), and
    either F3_real, F3_imag, M5_real, M5_imag or F3_amplitude, F3_phase_deg, M5_amplitude, M5_phase_deg, in N and N m
    per metre of wave amplitude. Time factor exp(+i omega_e t), crest at midship at t = 0, F3 up, M5 bow down, so a
    positive phase leads the crest. Lines from `#` on are comment. NetCDF: variables of these names over the dimensions
    omega and, where there are several, heading_deg.

    Args:
        path: the file.
        heading_deg: heading of a file without the column, degrees.
        speed: m/s at which the file was made, if it holds at one speed.

    Raises:
        InputError: no such file, a column is missing or not a number (with row and column), a pair of frequency and
            heading twice or not at all, and as `WaveTable`.
    """
    file = Path(path)
    if not is_file(file):
        raise InputError(f"there is no file {file} with transfer functions")
    columns = _netcdf_columns(file) if file.suffix == ".nc" else _csv_columns(file)
    names = _value_names(file.name, columns)
    if "heading_deg" not in columns:
        if heading_deg is None:
            raise InputError(f"{file.name} has no column 'heading_deg'; add it, or say at which heading the file holds")
        columns["heading_deg"] = np.full(columns["omega"].size, heading_deg)
    for name in ("omega", "heading_deg", *names):
        _refuse_gaps(file.name, name, columns[name])
    values = _complex_values(names, [columns[name] for name in names])
    return TabulatedExcitation(_to_table(file.name, columns["omega"], columns["heading_deg"], values), speed)


def _complex_values(names: tuple[str, ...], columns: list[Array]) -> Complex:
    """Return F3 and M5 (rows, 2) from the four columns."""
    first, two, three, four = columns
    polar = first * np.exp(1j * np.radians(two)), three * np.exp(1j * np.radians(four))
    parts = (first + 1j * two, three + 1j * four) if names == CARTESIAN_COLUMNS else polar
    return np.asarray(np.column_stack(parts), dtype=np.complex128)


def _csv_columns(file: Path) -> dict[str, Array]:
    import pandas as pd

    try:
        frame = pd.read_csv(file, comment="#", skipinitialspace=True, dtype=str, keep_default_na=False)
    except (ValueError, OSError) as error:
        raise InputError(f"{file.name} is not a readable CSV table ({str(error).splitlines()[0]})") from None
    numbers = {name: pd.to_numeric(frame[name], errors="coerce") for name in frame.columns}
    return {str(name).strip(): column.to_numpy(dtype=np.float64) for name, column in numbers.items()}


def _netcdf_columns(file: Path) -> dict[str, Array]:
    try:
        import xarray as xr
    except ImportError:
        advice = "install them with: pip install 'seatrial[formats]'"
        raise InputError(f"{file.name} is a NetCDF file, which needs xarray and h5netcdf; {advice}") from None
    try:
        frame = xr.load_dataset(file).to_dataframe().reset_index()
    except (OSError, ValueError) as error:
        raise InputError(f"{file.name} is not a readable NetCDF file ({str(error).splitlines()[0]})") from None
    numbers = frame.select_dtypes("number")
    return {str(name): numbers[name].to_numpy(dtype=np.float64) for name in numbers.columns}


def _value_names(name: str, columns: dict[str, Array]) -> tuple[str, ...]:
    """Return which of the two sets of columns the file has."""
    wanted = POLAR_COLUMNS if any(key in columns for key in POLAR_COLUMNS) else CARTESIAN_COLUMNS
    for key in ("omega", *wanted):
        if key not in columns:
            raise InputError(f"{name} has no column '{key}'{spelling_hint(key, list(columns))}")
    if columns["omega"].size == 0:
        raise InputError(f"{name} has a header but no rows")
    return wanted


def _refuse_gaps(name: str, key: str, column: Array) -> None:
    gaps = np.flatnonzero(~(np.abs(column) < _LARGEST_FORCE))
    if gaps.size:
        row = int(gaps[0])
        raise InputError(f"{name} has no number in column '{key}', row {row + 1} below the header")


def _to_table(name: str, omega: Array, heading_deg: Array, values: Complex) -> WaveTable:
    """Return rows in any order to the grid (n, h, 2)."""
    frequencies, i = np.unique(omega, return_inverse=True)
    angles, j = np.unique(heading_deg, return_inverse=True)
    rows = np.zeros((frequencies.size, angles.size), dtype=np.int64)
    np.add.at(rows, (i, j), 1)
    if np.any(rows != 1):
        a, b = np.argwhere(rows != 1)[0]
        raise InputError(
            f"{name} has {'no row' if rows[a, b] == 0 else f'{rows[a, b]} rows'} for omega = {frequencies[a]:g} rad/s "
            f"at heading {angles[b]:g} degrees; give each pair of frequency and heading once"
        )
    grid = np.empty((frequencies.size, angles.size, 2), dtype=np.complex128)
    grid[i, j] = values
    return WaveTable(name, frequencies, np.radians(angles), grid)
