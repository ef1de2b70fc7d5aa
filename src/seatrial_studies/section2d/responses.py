"""The tank and its runs: harmonics, waves apart by direction, and the response per wave amplitude."""

import math
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from seatrial.core.values import Array, InputError, Record
from seatrial.data.check import with_standard_signs
from seatrial.data.read import ColumnSpec, Layout, read_record
from seatrial.physics.hydro import LewisForm, group_velocity, wavenumber
from seatrial_studies.study_file import study_setting

# What is documented of the flume, the section and its holding; how the files are laid out.


def _documented(*names: str) -> Iterator[float]:
    return (study_setting("section2d", name, float).value for name in names)


RHO, G = 1000.0, 9.81
BEAM, DRAUGHT, LENGTH, MASS, KG, GM = _documented("beam", "draught", "length", "mass", "KG", "GM")
DEPTH, WIDTH, TO_MODEL, ROUND_TRIP = _documented("depth", "width", "to_model", "round_trip")
ROLL_RADIUS = study_setting("section2d", "roll_radius", float).value * BEAM
AREA_COEFFICIENT = MASS / (RHO * BEAM * DRAUGHT * LENGTH)
FORM = LewisForm.from_dimensions(BEAM, DRAUGHT, AREA_COEFFICIENT)

HEAVE_STIFFNESS = RHO * G * BEAM * LENGTH
ROLL_STIFFNESS = MASS * G * GM
ROLL_INERTIA = MASS * ROLL_RADIUS**2
ROLL_AXIS = DRAUGHT - KG

# documented truth
HEAVE_PERIOD, ROLL_PERIOD, RIG_DAMPING = _documented("heave_period", "roll_period", "rig_damping")
SWAY_STIFFNESS = tuple(study_setting("section2d", "sway_stiffness", list).value)
HEIGHTS = dict(enumerate(study_setting("section2d", "heights", list).value, start=1))

# not documented: a search over all spacings leaves this one arrangement of the probes (the mirrored one apart)
PROBES = ("zeta_1", "zeta_2", "zeta_3", "zeta_4")
PROBE_PLACES = (1.95, 2.20, 2.50)
FIRST_PROBE_TO_MODEL = 4.06

CAMERA = ("y0", "z", "phi")
LAYOUT = Layout(
    "text",
    ColumnSpec("time", "Time [s]", "s"),
    (
        ColumnSpec("x_wm", "WM_Position", "m"),
        *(ColumnSpec(f"zeta_{k}", f"WP_{k} [m]", "m") for k in (1, 2, 3, 4, 6)),
        ColumnSpec("y0", "Sway [m]", "m"),
        ColumnSpec("z", "Heave [m]", "m", positive="up"),
        ColumnSpec("phi", "Roll [rad]", "rad"),
        ColumnSpec("S_1", "Tension_SB [N]", "N"),
        ColumnSpec("S_2", "Tension_PS [N]", "N"),
        ColumnSpec("F_y", "Force_Sway [N]", "N"),
        ColumnSpec("z_ddot_1", "ACC_Heave_SB [m/s2]", "m/s^2", positive="up"),
        ColumnSpec("z_ddot_2", "ACC_HEAVE_PS [m/s2]", "m/s^2", positive="up"),
        ColumnSpec("v_dot", "ACC_SWAY [m/s2]", "m/s^2"),
    ),
)


def natural_period(inertia: float, stiffness: float) -> float:
    """Return the natural period [s]."""
    return 2.0 * math.pi * math.sqrt(inertia / stiffness)


# Complex amplitudes at the wave frequency and its harmonics: least squares over whole periods, with covariance.

Complex = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class Harmonics:
    """x(t) = sum over h of Re(amplitudes[h] exp(i orders[h] omega t)) + mean and trend + noise.

    Attributes:
        orders: (h,) multiples of the frequency.
        amplitudes: (h,) complex, phase at t = 0 of the record's own clock.
        covariance: (2h, 2h) of (real parts, imaginary parts), white noise of the residual's size.
        noise: standard deviation of the residual.
    """

    orders: tuple[int, ...]
    amplitudes: Complex
    covariance: Array
    noise: float

    @property
    def first(self) -> complex:
        """Return the amplitude at the wave frequency."""
        return complex(self.amplitudes[self.orders.index(1)])

    @property
    def relative_error(self) -> float:
        """Standard error of the first amplitude (root of half the sum of both variances) over its modulus."""
        k, h = self.orders.index(1), len(self.orders)
        variance = 0.5 * (self.covariance[k, k] + self.covariance[h + k, h + k])
        return float(np.sqrt(variance) / abs(self.first)) if self.first else float("inf")


def harmonics(time: Array, values: Array, omega: float, orders: Sequence[int] = (1, 2, 3)) -> Harmonics:
    """Least squares on cosines, sines, mean and trend; with white noise the Cramer-Rao bound 2 sigma^2 / n is met.

    Args:
        time, values: shape (n,), one steady stretch.
        omega: rad/s, of order 1.

    Raises:
        InputError: order 1 missing, less than one period, a harmonic above the Nyquist frequency, or NaN values.
    """
    made = tuple(orders)
    if 1 not in made:
        raise InputError("harmonics need order 1, the wave frequency itself")
    if not np.all(np.isfinite(values)):
        raise InputError("a channel holds NaN where harmonics are wanted; repair or leave out the record")
    count, highest = len(time), max(made)
    if count < 2 * len(made) + 3 or omega * (time[-1] - time[0]) < 0.95 * 2.0 * np.pi:
        raise InputError(f"{count} samples are less than one wave period of {2.0 * np.pi / omega:.3f} s; take more")
    dt = float(time[-1] - time[0]) / (count - 1)
    if highest * omega * dt > np.pi:
        raise InputError(f"harmonic {highest} of {omega:.3f} rad/s lies above the Nyquist frequency; leave it out")
    phase = np.outer(time, omega * np.asarray(made, dtype=np.float64))
    centred = (time - time.mean()) / max(np.ptp(time), dt)
    features = np.column_stack([np.cos(phase), -np.sin(phase), np.ones(count), centred])
    solved = np.linalg.lstsq(features, values, rcond=None)[0]
    residual = values - features @ solved
    variance = float(residual @ residual) / (count - features.shape[1])
    size = len(made)
    covariance = variance * np.linalg.inv(features.T @ features)[: 2 * size, : 2 * size]
    return Harmonics(made, solved[:size] + 1j * solved[size : 2 * size], covariance, float(np.sqrt(variance)))


def whole_periods(time: Array, start: float, stop: float, omega: float) -> slice:
    """Samples from `start` on that make up the most whole periods before `stop`.

    Raises:
        InputError: not one period lies between.
    """
    period = 2.0 * np.pi / omega
    first = int(np.searchsorted(time, start))
    count = int((min(stop, float(time[-1])) - start) / period)
    if count < 1:
        raise InputError(f"no whole wave period of {period:.3f} s lies between {start:.1f} and {stop:.1f} s")
    return slice(first, int(np.searchsorted(time, start + count * period)))


def best_fit_frequency(time: Array, values: Array, omega: float, relative_range: float = 0.02) -> float:
    """Return the frequency [rad/s] at which one harmonic fits best, within a share of `omega` to either side.

    Raises:
        InputError: as `harmonics`.
    """
    from scipy.optimize import minimize_scalar

    found = minimize_scalar(
        lambda w: harmonics(time, values, float(w), (1,)).noise,
        bounds=(omega * (1.0 - relative_range), omega * (1.0 + relative_range)),
        method="bounded",
        options={"xatol": 1e-6},
    )
    return float(found.x)


# The wave that goes on and the one that comes back, from probes along a flume (Mansard & Funke 1980, ICCE).

FREQUENCY_BAND = (0.6, 1.4)
CALIBRATION_BAND = (0.8, 1.2)
RIDGE, TAPER_S = 0.02, 3.0


@dataclass(frozen=True, eq=False)
class Probes:
    """Where wave probes stand and what they must be multiplied by.

    Attributes:
        positions: (p,) m down the flume from the first one.
        gains: (p,) relative to the first one.
        depth: m.
        misfit: share of the calibration records' amplitude that two waves do not explain.
    """

    positions: Array
    gains: Array
    depth: float
    misfit: float = float("nan")


@dataclass(frozen=True, eq=False)
class SeparatedWaves:
    """Elevations at one place: `incident` and `reflected`, shape (n,), m."""

    incident: Array
    reflected: Array


def separate_waves(elevations: Array, dt: float, omega: float, probes: Probes, position: float) -> SeparatedWaves:
    """Two waves at `position` from all probes, frequency by frequency over the whole record, ramps and all.

    At each frequency P_j = A exp(-i k x_j) + B exp(i k x_j) by least squares, a small ridge where probes stand a
    multiple of half a wave length apart; outside `FREQUENCY_BAND` of `omega` nothing is kept.

    Args:
        elevations: (n, p), m, at rest in the beginning.
        position: m down the flume from the first probe.
    """
    spectra, omegas, size = _spectra(elevations, dt)
    chosen = np.flatnonzero((omegas > FREQUENCY_BAND[0] * omega) & (omegas < FREQUENCY_BAND[1] * omega))
    k = wavenumber(omegas[chosen], probes.depth)
    fit, _ = _fit_two_waves(spectra[chosen] * probes.gains, k, probes.positions, RIDGE)
    waves = []
    for column, sign in ((0, -1.0), (1, 1.0)):
        whole = np.zeros(len(omegas), dtype=np.complex128)
        whole[chosen] = fit[:, column] * np.exp(sign * 1j * k * position)
        waves.append(np.fft.irfft(whole, size)[: len(elevations)])
    return SeparatedWaves(waves[0], waves[1])


def calibrate_wave_probes(
    runs: Sequence[tuple[Array, float, float]], depth: float, initial_positions: Sequence[float], ridge: float = 1e-3
) -> Probes:
    """Places and gains relative to the first probe that let two waves explain all runs best.

    Args:
        runs: elevations (n, p), dt, omega of each.
        initial_positions: of the other probes, m from the first; good to a quarter of the shortest wave.

    Raises:
        InputError: no run, or fewer than three probes.
    """
    from scipy.optimize import least_squares

    others = len(initial_positions)
    if not runs or others < 2:
        raise InputError("wave probes are calibrated from at least one run and three probes")
    bands = []
    for elevations, dt, omega in runs:
        spectra, omegas, _ = _spectra(elevations, dt)
        chosen = (omegas > CALIBRATION_BAND[0] * omega) & (omegas < CALIBRATION_BAND[1] * omega)
        bands.append((wavenumber(omegas[chosen], depth), spectra[chosen]))

    def residuals(point: Array) -> Array:
        places, gains = np.array([0.0, *point[:others]]), np.array([1.0, *point[others:]])
        left = [_fit_two_waves(z * gains, k, places, ridge)[1] / np.linalg.norm(z) for k, z in bands]
        return np.concatenate([part.ravel() for e in left for part in (e.real, e.imag)])

    found = least_squares(residuals, [*initial_positions, *([1.0] * others)])
    misfit = float(np.sqrt(np.sum(found.fun**2) / len(bands)))
    return Probes(np.array([0.0, *found.x[:others]]), np.array([1.0, *found.x[others:]]), depth, misfit)


def _spectra(elevations: Array, dt: float) -> tuple[Complex, Array, int]:
    """Spectra (f, p) with the record's end faded out, frequencies [rad/s], length of the transform."""
    count = len(elevations)
    fade = np.ones(count)
    tail = min(count // 4, round(TAPER_S / dt))
    fade[count - tail :] = 0.5 * (1.0 + np.cos(np.pi * np.arange(tail) / tail))
    size = 1 << int(np.ceil(np.log2(count + 1)))
    rest = elevations[: max(1, round(4.0 / dt))].mean(axis=0)
    spectra = np.fft.rfft((elevations - rest) * fade[:, None], size, axis=0)
    omegas = np.asarray(2.0 * np.pi * np.fft.rfftfreq(size, dt), dtype=np.float64)
    return spectra, omegas, size


def _fit_two_waves(spectra: Complex, k: Array, positions: Array, ridge: float) -> tuple[Complex, Complex]:
    """Amplitudes (f, 2) of both waves at the origin, and what they leave (f, p)."""
    phase = np.outer(k, positions)
    basis = np.stack([np.exp(-1j * phase), np.exp(1j * phase)], axis=2)
    adjoint = basis.conj().transpose(0, 2, 1)
    fit = np.linalg.solve(adjoint @ basis + ridge * np.eye(2), adjoint @ spectra[..., None])
    left = (basis @ fit)[..., 0] - spectra
    return fit[..., 0].astype(np.complex128), left.astype(np.complex128)


# The runs of the folder: record, wave frequency, and the stretch between the ramp and the beach's reflection.

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


# Runs to responses: heave, roll, sway per wave amplitude at the model, in the steady stretch.

HARMONIC_ORDERS = (1, 2, 3)


@dataclass(frozen=True, eq=False)
class SectionResponse:
    """One run in its steady stretch; complex amplitudes per m of the wave that goes on, at the model.

    Attributes:
        period_count: whole periods in the stretch.
        wave_amplitude: amplitude of the wave that goes on, m.
        paddle_ratio: wave amplitude over the paddle's stroke.
        reflected_ratio: of the wave that comes back.
        transmitted_ratio: elevation behind the model.
        heave: up, from the mean of both accelerometers, m/m.
        roll: starboard over port accelerometer, m/m: roll angle times the distance between them.
        sway: from the accelerometer, m/m; force: holding force, N/m.
        camera_sway: amplitude only; the camera's clock is its own. Zero where it is dead.
        relative_error: relative standard error of the heave amplitude by the harmonic fit.
    """

    run: FlumeRun
    period_count: int
    wave_amplitude: float
    paddle_ratio: float
    reflected_ratio: float
    transmitted_ratio: float
    heave: complex
    roll: complex
    sway: complex
    force: complex
    camera_sway: float
    relative_error: float


def calibrate_probes(runs: Sequence[FlumeRun]) -> Probes:
    """Places and gains from those runs.

    Raises:
        InputError: no run.
    """
    return calibrate_wave_probes([(r.elevations(PROBES), r.record.dt, r.omega) for r in runs], DEPTH, PROBE_PLACES)


def waves_at_model(run: FlumeRun, probes: Probes) -> SeparatedWaves:
    """Both waves at the model's place, whole record."""
    return separate_waves(run.elevations(PROBES), run.record.dt, run.omega, probes, FIRST_PROBE_TO_MODEL)


def steady_samples(run: FlumeRun, timing: Timing = STEADY_TIMING) -> slice:
    """Return the samples of whole periods in the window.

    Raises:
        InputError: the window holds no period.
    """
    return whole_periods(run.record.time, *run.steady_window(timing), run.omega)


def measure_response(run: FlumeRun, probes: Probes, timing: Timing = STEADY_TIMING) -> SectionResponse:
    """Return the complex amplitudes of one run.

    Raises:
        InputError: the window holds no period.
    """
    waves, rows, w = waves_at_model(run, probes), steady_samples(run, timing), run.omega
    record, time = with_standard_signs(run.record), run.record.time[rows]

    def first(values: Array) -> complex:
        return harmonics(time, values[rows], w, HARMONIC_ORDERS).first

    onward = first(waves.incident)
    up = harmonics(time, -0.5 * (record["z_ddot_1"] + record["z_ddot_2"])[rows], w, HARMONIC_ORDERS)
    difference = first(record["z_ddot_2"] - record["z_ddot_1"])
    turned = [first(record[s]) for s in ("v_dot", "F_y")]
    return SectionResponse(
        run=run,
        period_count=round((time[-1] - time[0]) / run.period),
        wave_amplitude=abs(onward),
        paddle_ratio=abs(onward) / _stroke_amplitude(run),
        reflected_ratio=abs(first(waves.reflected) / onward),
        transmitted_ratio=abs(first(record["zeta_6"]) / onward),
        heave=-up.first / w**2 / onward,
        roll=-difference / w**2 / onward,
        sway=-turned[0] / w**2 / onward,
        force=turned[1] / onward,
        camera_sway=abs(first(record["y0"])) / abs(onward),
        relative_error=up.relative_error,
    )


def _stroke_amplitude(run: FlumeRun) -> float:
    _, full, left = run.stroke_times
    part = run.record.between(full, left)
    return abs(harmonics(part.time, part["x_wm"], run.omega, (1,)).first)


def relative_difference(one: complex, other: complex) -> tuple[float, float]:
    """Return one over the other: per cent of amplitude, degrees of phase."""
    ratio = one / other
    return 100.0 * (abs(ratio) - 1.0), float(np.degrees(np.angle(ratio)))
