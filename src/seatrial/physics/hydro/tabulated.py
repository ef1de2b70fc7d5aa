"""Wave forces tabulated by frequency and heading: at rest and at speed by strip theory, and from files."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from seatrial.core.values import Array, InputError, spelling_hint
from seatrial.core.values.files import is_file
from seatrial.physics.hydro.excitation import MAX_SHIP_SPEED, Complex, checked_waves

# Complex functions of wave frequency and heading, tabulated on a grid and read between its points.

_ROUNDING = 1e-9  # of the largest grid value, by which a value may lie outside the table: rounding


@dataclass(frozen=True)
class WaveTable:
    """Values over omega [rad/s] and heading [rad, 0 following, pi head, hull alike to port and starboard].

    Real and imaginary parts are interpolated by monotone cubics (PCHIP) in frequency, then in heading; nothing is
    extrapolated. Phases at midship turn slowly where the hull is not many wave lengths long; a table must be dense
    enough that neighbours differ by less than a quarter turn, which is checked in frequency where the values matter.

    Attributes:
        name: of the file or data, for messages.
        omega: (n,), rising; headings: (h,), rising, within 0 and pi; values: (n, h, m).

    Raises:
        InputError: fewer than two frequencies, an order or shape that does not agree, NaN, or phases that jump.
    """

    name: str
    omega: Array
    headings: Array
    values: Complex

    def __post_init__(self) -> None:
        if self.omega.ndim != 1 or self.omega.size < 2 or not np.all(np.diff(self.omega) > 0) or self.omega[0] <= 0:
            raise InputError(f"{self.name} needs at least two positive, rising wave frequencies")
        within = np.all((self.headings >= 0) & (self.headings <= np.pi + _ROUNDING))
        if self.headings.ndim != 1 or self.headings.size == 0 or not np.all(np.diff(self.headings) > 0) or not within:
            raise InputError(f"{self.name} needs rising headings between 0 (following) and 180 degrees (head)")
        if self.values.ndim != 3 or self.values.shape[:2] != (self.omega.size, self.headings.size):
            raise InputError(f"{self.name} does not have one value for each pair of frequency and heading")
        if not np.all(np.isfinite(self.values)):
            i, j, _ = np.argwhere(~np.isfinite(self.values))[0]
            raise InputError(
                f"{self.name} has no finite value at omega = {self.omega[i]:g} rad/s and heading "
                f"{np.degrees(self.headings[j]):g} degrees; fill or leave out that frequency"
            )
        self._refuse_phase_jumps()

    @property
    def frequency_range(self) -> tuple[float, float]:
        """Its first and last frequency [rad/s]."""
        return float(self.omega[0]), float(self.omega[-1])

    def interpolate(self, omega: Array, U: float, beta: Array | float) -> Complex:
        """Return values (k, m) at the frequencies (k,) and one heading, or one for each.

        Raises:
            InputError: as `checked_waves`, or a frequency or heading outside the table.
        """
        w, heading = checked_waves(omega, U, beta)
        folded = np.abs(np.angle(np.exp(1j * heading)))
        refuse_outside(self.name, "wave frequency", "rad/s", self.omega, w)
        refuse_outside(self.name, "heading", "degrees", np.degrees(self.headings), np.degrees(folded))
        along = interpolated(self.omega, self.values, np.clip(w, self.omega[0], self.omega[-1]))
        out = np.empty((w.size, self.values.shape[2]), dtype=np.complex128)
        for angle in np.unique(folded):
            rows = folded == angle
            inside = np.clip(angle, self.headings[0], self.headings[-1])
            out[rows] = interpolated(self.headings, np.moveaxis(along[rows], 1, 0), np.array([inside]))[0]
        return out

    def _refuse_phase_jumps(self) -> None:
        """Neighbours in frequency that both carry a fifth of the largest value and differ by over a quarter turn."""
        size = np.abs(self.values)
        loud = np.minimum(size[1:], size[:-1]) > 0.2 * size.max(axis=(0, 1))  # a fifth: chosen
        turned = np.real(self.values[1:] * self.values[:-1].conj()) < 0
        if np.any(loud & turned):
            i, j, _ = np.argwhere(loud & turned)[0]
            raise InputError(
                f"{self.name} is too coarse: the phase turns by more than 90 degrees between omega = "
                f"{self.omega[i]:g} and {self.omega[i + 1]:g} rad/s at heading {np.degrees(self.headings[j]):g} "
                "degrees; give more frequencies between, or check the unit of the phase"
            )


def interpolated(x: Array, values: Complex | Array, points: Array) -> Complex:
    """Return PCHIP along the first axis, real and imaginary parts each; a single row holds at its own point only."""
    if x.size == 1:
        return np.repeat(np.asarray(values, dtype=np.complex128), points.size, axis=0)
    from scipy.interpolate import PchipInterpolator

    return PchipInterpolator(x, np.real(values))(points) + 1j * PchipInterpolator(x, np.imag(values))(points)


def refuse_outside(name: str, quantity: str, unit: str, grid: Array, values: Array) -> None:
    """Raise InputError naming the range of a table if `values` leaves it by more than rounding."""
    slack = _ROUNDING * max(1.0, abs(float(grid[-1])))
    outside = values[(values < grid[0] - slack) | (values > grid[-1] + slack)]
    if outside.size:
        raise InputError(
            f"{name} covers {quantity} {grid[0]:g} to {grid[-1]:g} {unit}, so it cannot give {outside[0]:g} {unit}; "
            "it is not extrapolated"
        )


# Speed terms of strip theory: coefficients and excitation at rest to those at forward speed, without a transom.


def coefficients_at_speed(A: Array, B: Array, omega_e: Array, U: float) -> tuple[Array, Array]:
    """Return added mass and damping at the speed U [m/s] from those at rest.

    A35 = A35_0 - U / omega_e^2 B33, A53 = A53_0 + U / omega_e^2 B33, A55 = A55_0 + U^2 / omega_e^2 A33,
    B35 = B35_0 + U A33, B53 = B53_0 - U A33, B55 = B55_0 + U^2 / omega_e^2 B33; A33 and B33 stay.

    Raises:
        InputError: a frequency of encounter is zero, shapes do not agree, a number is not finite, or the speed is out
            of sense.
    """
    more_A, more_B = _speed_terms(A, B, omega_e, U)
    return A + more_A, B + more_B


def excitation_at_speed(
    froude_krylov: Complex, diffraction: Complex, omega: Array, omega_e: Array, U: float
) -> Complex:
    """Return excitation (n, 2) at the speed U from its two parts (n, 2) at rest, at the wave frequencies `omega`.

    The diffraction of a section is proportional to omega omega_e there, so that at rest is taken omega_e / omega
    times, and the moment gains -U / (i omega_e) F3_D = i U / omega F3_D. With `coefficients_at_speed` a hull in
    a long wave then moves with it at any speed. Omega_e / omega times is exact for the part in phase with the water's
    acceleration; a part in phase with its velocity should not be scaled, but cannot be separated in a total.

    Raises:
        InputError: shapes do not agree or a frequency is not positive.
    """
    if np.shape(froude_krylov) != np.shape(diffraction) or np.shape(diffraction) != (*np.shape(omega), 2):
        raise InputError(
            f"Froude-Krylov force {np.shape(froude_krylov)} and diffraction {np.shape(diffraction)} must both have two "
            f"columns for the {np.size(omega)} wave frequencies"
        )
    if not np.all(omega > 0.0):
        raise InputError("wave frequencies must be positive [rad/s]")
    scattered = diffraction * (omega_e / omega)[:, None]
    convected = 1j * U / omega * diffraction[:, 0]
    return froude_krylov + scattered + np.column_stack([np.zeros(omega.size), convected])


def _speed_terms(A: Array, B: Array, omega_e: Array, U: float) -> tuple[Array, Array]:
    """Return what the speed adds to A and B; A33 and B33 are the same before and after."""
    n = np.size(omega_e)
    if np.shape(A) != (n, 2, 2) or np.shape(B) != (n, 2, 2):
        raise InputError(
            f"{n} frequencies of encounter need added mass and damping of the shape ({n}, 2, 2), not {np.shape(A)} and "
            f"{np.shape(B)}"
        )
    if not (np.all(np.isfinite(A)) and np.all(np.isfinite(B)) and np.all(np.isfinite(omega_e))):
        raise InputError("added mass, damping and frequencies of encounter must be finite; leave out NaN and infinity")
    if not (np.isfinite(U) and 0.0 <= U <= MAX_SHIP_SPEED):
        raise InputError(f"the ship speed must lie between 0 and {MAX_SHIP_SPEED:g} m/s, not {U:g}; is it in knots?")
    if np.any(omega_e == 0.0):
        raise InputError(
            "strip theory has no speed terms at a frequency of encounter of zero, where the ship runs with the wave; "
            "leave that wave out"
        )
    a33, b33, none = A[:, 0, 0], B[:, 0, 0], np.zeros(n)
    slow, square = U / omega_e**2, U**2 / omega_e**2
    more_A = np.array([[none, -slow * b33], [slow * b33, square * a33]])
    more_B = np.array([[none, U * a33], [-U * a33, square * b33]])
    return np.moveaxis(more_A, 2, 0), np.moveaxis(more_B, 2, 0)


# Complex transfer functions of the wave force from a file: CSV or NetCDF to an excitation.

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
