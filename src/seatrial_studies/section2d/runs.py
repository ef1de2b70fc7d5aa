"""The runs of the folder: record, wave frequency, and the stretch between the ramp and the beach's reflection."""

import os
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from seatrial.core.values import Array, InputError, Record
from seatrial.data.read import read_record
from seatrial.physics.hydro import group_velocity, wavenumber
from seatrial_studies.section2d.harmonics import best_fit_frequency
from seatrial_studies.section2d.tank import DEPTH, LAYOUT, ROUND_TRIP, TO_MODEL

FOLDER = "section2d_waves"
_TRIM_S = 0.5
_STARTED_SHARE, _FULL_SHARE = 0.03, 0.97


@dataclass(frozen=True)
class Timing:
    """Where the steady stretch lies.

    Attributes:
        settling_s: s after the full waves' arrival, for roll's transient to die (its time constant is about 2 s).
        allowed_reflection_s: s of the beach's reflection that may be in: the beginning of a ramp 4 to 6 s long.
    """

    settling_s: float = 1.5
    allowed_reflection_s: float = 2.5


STEADY_TIMING = Timing()


@dataclass(frozen=True, eq=False)
class FlumeRun:
    """One run SPPH_rep: scenario S, period PP, height H."""

    record: Record
    nominal: "NominalWave"

    @property
    def name(self) -> str:
        """Return the name of the run as in the file name."""
        return self.record.name

    @property
    def scenario(self) -> int:
        """Return the scenario: 3 sway-heave-roll, 4 sway-heave, 6 heave-roll."""
        return int(self.name[0])

    @property
    def period_index(self) -> int:
        """Return the index of the wave period."""
        return int(self.name[1:3])

    @property
    def height_index(self) -> int:
        """Return the index of the wave height, 1 or 2."""
        return int(self.name[3])

    @cached_property
    def stroke_times(self) -> tuple[float, float, float]:
        """Return the times [s] at which the paddle starts, reaches its full stroke and leaves it."""
        stroke = np.abs(self.record["x_wm"])
        most, time = float(stroke.max()), self.record.time
        full = np.flatnonzero(stroke > _FULL_SHARE * most)
        return float(time[np.argmax(stroke > _STARTED_SHARE * most)]), float(time[full[0]]), float(time[full[-1]])

    @cached_property
    def omega(self) -> float:
        """Return the angular frequency of the paddle at full stroke [rad/s]."""
        _, full, left = self.stroke_times
        stretch = self.record.between(full + _TRIM_S, left - _TRIM_S)
        return best_fit_frequency(stretch.time, stretch["x_wm"], self.nominal.omega)

    @property
    def period(self) -> float:
        """Return the wave period [s]."""
        return 2.0 * np.pi / self.omega

    @property
    def wavenumber(self) -> float:
        """Return the wave number at the flume's depth [rad/m]."""
        return float(wavenumber(self.omega, DEPTH))

    def steady_window(self, timing: "Timing") -> tuple[float, float]:
        """Return the interval [s] from full waves at the model to the beach's first reflection.

        The front travels with the group velocity; reflections from the beach take 12 m more, as in periods.csv.
        """
        on, full, left = self.stroke_times
        speed = float(group_velocity(self.omega, DEPTH))
        start = full + TO_MODEL / speed + timing.settling_s
        stop = min(on + (TO_MODEL + ROUND_TRIP) / speed + timing.allowed_reflection_s, left + TO_MODEL / speed)
        return start, stop

    def elevations(self, probes: tuple[str, ...]) -> Array:
        """Return the surface elevations at the probes [m], (n, p)."""
        return self.record.matrix(probes)


def data_folder() -> Path:
    """Return the folder of the section's records in SEATRIAL_DATA.

    Raises:
        InputError: SEATRIAL_DATA is not set, or holds no such folder.
    """
    root = os.environ.get("SEATRIAL_DATA")
    folder = Path(root or "") / FOLDER
    if not root or not (folder / "periods.csv").is_file():
        reason = f"'{root}' holds no {FOLDER}/periods.csv" if root else "SEATRIAL_DATA is not set"
        raise InputError(f"the measured records are not part of the package and {reason}; set it to their folder")
    return folder


@dataclass(frozen=True)
class NominalWave:
    """A row of periods.csv: rad/s, and the wave number listed beside it, rad/m."""

    omega: float
    wavenumber: float


def read_periods(path: Path) -> dict[int, NominalWave]:
    """Return the listed wave periods [s] by index.

    Raises:
        InputError: a row is no pair of numbers.
    """
    rows = [line.split(",") for line in path.read_text(encoding="utf-8").splitlines() if line[:1].isdigit()]
    try:
        return {int(row[0]): NominalWave(2.0 * np.pi / float(row[1]), float(row[3])) for row in rows}
    except (ValueError, IndexError, ZeroDivisionError):
        raise InputError(f"{path}: each row must hold index, period in s, frequency and wave number") from None


def read_runs(folder: Path, scenarios: tuple[int, ...] = (3, 4, 6)) -> tuple[FlumeRun, ...]:
    """Return all runs of those scenarios, by name.

    Raises:
        InputError: none is there, or a file cannot be read.
    """
    omegas = read_periods(folder / "periods.csv")
    paths = [p for s in scenarios for p in sorted((folder / f"{s}PPH").glob(f"{s}*.csv.gz"))]
    if not paths:
        raise InputError(f"{folder} holds no runs; it needs folders 3PPH, 4PPH, 6PPH with files like 4021_1.csv.gz")
    made = []
    for path in paths:
        record = read_record(path, LAYOUT)
        index = int(record.name[1:3]) if record.name[1:3].isdigit() else -1
        if index not in omegas:
            raise InputError(f"{path.name}: period {record.name[1:3]} is not in periods.csv; name files SPPH_rep")
        made.append(FlumeRun(record, omegas[index]))
    return tuple(made)
