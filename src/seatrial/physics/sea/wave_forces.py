"""Wave forces from a record of the elevation, and what a linear ship does in a sea."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, Channel, InputError, Record, frozen
from seatrial.physics.hydro.excitation import BoxForceError, BoxHull, Complex, Excitation, G, encounter_frequency
from seatrial.physics.sea.spectrum import Spectrum, speed_factor, wave_frequency

# What a linear ship does in a sea: spectra and statistics of motions from response amplitude operators.

# least share of the sea's energy between the ends of a response, -; below it the response says nothing (our choice)
_LEAST_ENERGY = 1e-3


@dataclass(frozen=True)
class MotionStatistics:
    """Of one motion in a sea, SI.

    Attributes:
        m0, m2, m4: moments over the frequency of encounter: variances of the motion, its velocity, its acceleration.
    """

    m0: float
    m2: float
    m4: float

    @property
    def rms(self) -> float:
        """sqrt(m0)."""
        return math.sqrt(self.m0)

    @property
    def significant(self) -> float:
        """Mean of the highest third of the amplitudes, 2 sqrt(m0) (narrow band; Longuet-Higgins 1952)."""
        return 2.0 * self.rms

    @property
    def acceleration(self) -> float:
        """rms of the second derivative."""
        return math.sqrt(self.m4)

    @property
    def zero_crossing_period(self) -> float:
        """Mean period between upward zero crossings, 2 pi sqrt(m0 / m2), s (Rice 1945); infinite without motion."""
        return 2.0 * math.pi * math.sqrt(self.m0 / self.m2) if self.m2 > 0.0 else math.inf

    def exceedance(self, amplitude: float) -> float:
        """Probability that an amplitude exceeds this one, exp(-a^2 / (2 m0)) (Rayleigh; Longuet-Higgins 1952)."""
        return math.exp(-(amplitude**2) / (2.0 * self.m0)) if self.m0 else 0.0

    def most_probable_maximum(self, duration: float) -> float:
        """Return most probable largest amplitude in `duration` [s], sqrt(2 m0 ln N), N = duration / T_z (same source).

        Raises:
            InputError: the duration holds no whole period.
        """
        count = duration / self.zero_crossing_period
        if not count > 1.0:
            raise InputError(
                f"{duration:g} s hold no whole period of {self.zero_crossing_period:.3g} s; ask for a longer time"
            )
        return math.sqrt(2.0 * self.m0 * math.log(count))


def response_spectrum(spectrum: Spectrum, omega: Array, operator: Complex) -> Array:
    """Return |H|^2 S over the wave frequency, shape of `omega`."""
    return np.abs(operator) ** 2 * spectrum.density(omega)


def motion_statistics(spectrum: Spectrum, omega: Array, omega_e: Array, operator: Complex) -> MotionStatistics:
    """Return statistics of the motion `operator`, all arrays (n,), rad/s; trapezoids over rising omega.

    Raises:
        InputError: omega does not rise, an operator is not finite, or the sea has no energy between the ends.
    """
    if len(omega) < 2 or np.any(np.diff(omega) <= 0.0):
        raise InputError("the wave frequencies of a response must be two or more, and rise")
    _require_finite(omega, operator)
    share = float(spectrum.energy_between(omega[0], omega[-1])) / spectrum.moment(0)
    resolved = float(np.trapezoid(spectrum.density(omega), omega)) / spectrum.moment(0)
    if min(share, resolved) < _LEAST_ENERGY:
        raise InputError(
            f"the sea has no energy between {omega[0]:.3g} and {omega[-1]:.3g} rad/s; it peaks at "
            f"{spectrum.modal_frequency:.3g} rad/s"
        )
    density = response_spectrum(spectrum, omega, operator)
    m0, m2, m4 = (float(np.trapezoid(omega_e**n * density, omega)) for n in (0, 2, 4))
    return MotionStatistics(m0, m2, m4)


def vertical_motion(heave: Complex, pitch: Complex, x: float) -> Complex:
    """Return the upward motion at x [m, forward of midship] from heave [up] and pitch [rad, bow down]: z - x theta."""
    return heave - x * pitch


def motion_sickness(motion: MotionStatistics) -> float:
    """Return share of people sick within two hours in a vertical motion, 0 to 1 (O'Hanlon & McCauley 1974; Lloyd 1989).

    Phi((log10(a / g) - mu) / 0.4), mu = -0.819 + 2.32 log10(omega_e)^2, a = 0.798 sqrt(m4) the mean absolute
    acceleration, omega_e = sqrt(m4 / m2) its mean frequency.
    """
    if motion.m4 <= 0.0:
        return 0.0
    mean_absolute = 0.798 * motion.acceleration  # sqrt(2 / pi): mean over r.m.s. of a Gaussian
    mu = -0.819 + 2.32 * math.log10(math.sqrt(motion.m4 / motion.m2)) ** 2  # O'Hanlon & McCauley 1974
    from scipy.special import ndtr

    return float(ndtr((math.log10(mean_absolute / G) - mu) / 0.4))  # standard deviation 0.4, O'Hanlon & McCauley 1974


def _require_finite(omega: Array, operator: Complex) -> None:
    if np.shape(operator) != np.shape(omega):
        raise InputError(
            f"give one operator for each of the {np.size(omega)} wave frequencies, not {np.size(operator)}"
        )
    broken = np.flatnonzero(~np.isfinite(operator))
    if broken.size:
        raise InputError(f"the response operator at {omega[broken[0]]:.4g} rad/s is not a finite number")


# Wave forces from a record of the elevation at the ship's origin: the excitation as a filter of what is met.

# frequencies that hold this share of the elevation's energy pass the filter, from either end
_NEGLIGIBLE = 1e-4
# periods of the slowest of them that are lost at each end, and that the record must have besides
_LOST_PERIODS, _NEEDED_PERIODS = 1.0, 6.0
# bins of the transform that drift and the window's own leakage fill
_DRIFT_BINS = 4
# periods of the slowest waves by which the record is continued, and from which; ridge of the predictor
_EXTRAPOLATED_PERIODS, _PREDICTOR_PERIODS, _RIDGE = 2.0, 1.5, 1e-7
_MARGINS = 0.8, 1.2  # of the band's ends, within which the filter passes; chosen
_MOTIONS = ("z", "theta")
_MOST_BEYOND = 0.01  # of a motion's energy beyond the range of the forces: a tenth of its amplitude there; chosen
_STEPS_PER_PERIOD = 5.0  # of the predictor, in the shortest period; chosen


def with_wave_forces(record: Record, excitation: Excitation, U: float, beta: float) -> Record:
    """Return the record with F3 [N, up] and M5 [N m, bow down] computed from its channel zeta [m, up].

    U in m/s, beta in rad (0 following, pi head). A probe that moves with the ship, `reference_point` of zeta ahead of
    midship, sees waves from ahead earlier by their way to midship. The ends, where the filter knows only half of what
    it needs, are cut off. A record that has F3 and M5 already keeps them. Speed and mean frequency of encounter come
    along as channels.

    Raises:
        InputError: no elevation, gaps in it, a following sea (one frequency of encounter has three waves there), or a
            record too short for its longest waves, or one in which waves beyond the range of the forces matter.
    """
    if {"F3", "M5"} <= set(record.channels):
        return _with_encounter_channels(record, U)
    if "zeta" not in record:
        raise InputError(f"record '{record.name}' has neither wave forces F3 and M5 nor an elevation zeta; add either")
    zeta = record["zeta"]
    if not np.all(np.isfinite(zeta)):
        row = int(np.argmin(np.isfinite(zeta)))
        raise InputError(
            f"record '{record.name}': the elevation zeta has no value at sample {row} (t = {record.time[row]:g} s); "
            "fill the gap or cut the record there"
        )
    if np.ptp(zeta) == 0.0:
        raise InputError(f"record '{record.name}': the elevation zeta never moves; check the wave sensor")
    level = zeta - np.mean(zeta)
    band = _band(level, record.dt)
    lost = _LOST_PERIODS * 2.0 * np.pi / band[0]
    if record.duration < _NEEDED_PERIODS * lost:
        raise InputError(
            f"record '{record.name}' of {record.duration:.3g} s is too short for its longest waves, met every "
            f"{2.0 * np.pi / band[0]:.3g} s; record at least {_NEEDED_PERIODS * lost:.0f} s"
        )
    range_step = _beyond_forces(record, band, excitation, U, beta)
    forces = _filtered_forces(level, record.dt, band, excitation, U, beta, record.channel("zeta").reference_point)
    made = {name: Channel.from_notation(name, frozen(forces[:, j])) for j, name in enumerate(("F3", "M5"))}
    whole = Record(
        record.name, record.time, {**record.channels, **made}, record.kind,
        record.provenance.with_step(f"wave forces from the elevation{range_step}"),
    )  # fmt: skip
    return _with_encounter_channels(whole.between(float(record.time[0]) + lost, float(record.time[-1]) - lost), U)


def _known_range(excitation: Excitation) -> tuple[float, float]:
    """Return the wave frequencies [rad/s] that have forces; those of a box beyond its own range are small."""
    return (0.0, np.inf) if isinstance(excitation, (BoxHull, BoxForceError)) else excitation.frequency_range


def _beyond_forces(record: Record, band: tuple[float, float], excitation: Excitation, U: float, beta: float) -> str:
    """Return what lies beyond the frequencies of the forces, to be said with the record; empty where nothing does.

    Raises:
        InputError: motions of which so much lies there that the forces left out would show in them.
    """
    low, high = _known_range(excitation)
    omega_e = 2.0 * np.pi * np.fft.rfftfreq(len(record), record.dt)
    met = (omega_e >= _MARGINS[0] * band[0]) & (omega_e <= _MARGINS[1] * band[1])
    omega = np.zeros(len(omega_e))
    omega[met] = wave_frequency(omega_e[met], U, beta)
    beyond = met & ((omega < low) | (omega > high))
    if not np.any(beyond):
        return ""
    shares = {name: _share(record[name], beyond, met) for name in ("zeta", *_MOTIONS) if name in record}
    text = f"{low:g} to {high:g} rad/s; beyond lies " + enumeration(
        [f"{100.0 * share:.2g} % of the energy of '{name}'" for name, share in shares.items()]
    )
    if max((share for name, share in shares.items() if name != "zeta"), default=0.0) > _MOST_BEYOND:
        raise InputError(f"record '{record.name}': the wave forces are known from {text}; give forces of a wider range")
    return f" at {text}"


def _share(values: Array, beyond: NDArray[np.bool_], met: NDArray[np.bool_]) -> float:
    """Return the share of a channel's energy at the frequencies that are met which lies beyond, -."""
    known = np.nan_to_num(values - np.nanmean(values))
    power = np.abs(np.fft.rfft(known * np.hanning(len(known)))) ** 2
    return float(np.sum(power[beyond]) / max(np.sum(power[met]), 1e-300))  # above zero, for a division


def _with_encounter_channels(record: Record, U: float) -> Record:
    """Speed u and mean frequency of encounter omega_e of the motions as constant channels, where they are absent.

    omega_e is that of the zero crossings of heave, as the record's differences have them.
    """
    added = {"u": U}
    if "z" in record:
        z = record["z"] - np.nanmean(record["z"])
        rising = np.flatnonzero((z[:-1] < 0.0) & (z[1:] >= 0.0))
        if len(rising) > 2:
            added["omega_e"] = 2.0 * np.pi * (len(rising) - 1) / (record.dt * float(rising[-1] - rising[0]))
    made = {n: Channel.from_notation(n, frozen(np.full(len(record), v))) for n, v in added.items() if n not in record}
    return Record(record.name, record.time, {**record.channels, **made}, record.kind, record.provenance)


def _band(level: Array, dt: float) -> tuple[float, float]:
    """Return frequencies of encounter [rad/s] that hold nearly all of the energy."""
    window = np.hanning(len(level))
    power = np.abs(np.fft.rfft((level - np.average(level, weights=window)) * window)) ** 2
    power[:_DRIFT_BINS] = 0.0
    share = np.cumsum(power) / np.sum(power)
    step = 2.0 * np.pi / (len(level) * dt)
    first = int(np.searchsorted(share, _NEGLIGIBLE))
    last = int(np.searchsorted(share, 1.0 - _NEGLIGIBLE))
    return first * step, min(last + 1, len(power) - 1) * step


def _filtered_forces(
    level: Array, dt: float, band: tuple[float, float], excitation: Excitation, U: float, beta: float, place: float
) -> Array:
    """Return F3 and M5 along the record, (n, 2); both ends continued as the waves would have gone on, and faded out.

    place: of the probe, m ahead of midship; the elevation a exp(i omega_e t) at midship is a exp(i (omega_e t
    - k x cos beta)) there, k = omega^2 / g (deep water; Lloyd 1989, section 7.2).
    """
    n, more = len(level), round(_EXTRAPOLATED_PERIODS * 2.0 * np.pi / band[0] / dt)
    fade = np.cos(np.linspace(0.0, 0.5 * np.pi, more)) ** 2
    after = linear_prediction(level, more, band, dt) * fade
    before = (linear_prediction(level[::-1], more, band, dt) * fade)[::-1]
    padded = np.concatenate([before, level, after])
    omega_e = 2.0 * np.pi * np.fft.rfftfreq(len(padded), dt)
    inside = (omega_e >= _MARGINS[0] * band[0]) & (omega_e <= _MARGINS[1] * band[1])
    transfer: NDArray[np.complex128] = np.zeros((len(omega_e), 2), dtype=np.complex128)
    low, high = _known_range(excitation)
    omega = wave_frequency(omega_e[inside], U, beta)
    inside[inside] = (omega >= low) & (omega <= high)
    omega = omega[(omega >= low) & (omega <= high)]
    to_midship = np.exp(1j * omega**2 / G * place * np.cos(beta))
    F3, M5 = excitation.forces(omega, U, beta)
    transfer[inside, 0], transfer[inside, 1] = to_midship * F3, to_midship * M5
    made = np.fft.irfft(np.fft.rfft(padded)[:, None] * transfer, len(padded), axis=0)
    return made[more : more + n]


def linear_prediction(level: Array, count: int, band: tuple[float, float], dt: float) -> Array:
    """`count` samples beyond the end by linear prediction (Kay 1988, section 7.3), fitted where the waves are coarse.

    The predictor works on every k-th sample, so that its steps are a fifth of the shortest period.
    """
    k = max(1, int(2.0 * np.pi / band[1] / dt / _STEPS_PER_PERIOD))
    order = min(round(_PREDICTOR_PERIODS * 2.0 * np.pi / band[0] / (k * dt)), len(level) // (4 * k))
    windows = np.lib.stride_tricks.sliding_window_view(level, order * k + 1)[:, ::k]
    past, present = windows[:, :-1], windows[:, -1]
    gram = past.T @ past
    gram += _RIDGE * np.trace(gram) / order * np.eye(order)
    predictor = np.linalg.solve(gram, past.T @ present)
    made = np.concatenate([level[-order * k :], np.zeros(count)])
    for i in range(order * k, len(made)):
        made[i] = predictor @ made[i - order * k : i : k]
    return made[order * k :]


_CELLS = 100_000  # cells of the wave spectrum; chosen
_BAND = (5e-4, 0.9995)  # shares of the energy below either end; chosen


def force_density(spectrum: Spectrum, excitation: Excitation, U: float, beta: float, edges: Array) -> Complex:
    """Return one-sided density of F3 [N, up] and M5 [N m, bow down] between `edges` of |omega_e| [rad/s], (n, 2, 2).

    Element ij is that of E[F_i conj(F_j)]. The sea is cut into many cells of wave frequency; each brings its energy to
    the frequency at which it is met, waves that the ship overtakes as the conjugate. So a following sea, where up to
    three waves are met at one frequency, needs no Jacobian.

    Raises:
        InputError: speed or heading out of sense, or frequencies that the excitation does not know.
    """
    speed_factor(U, beta)
    bounds = np.linspace(*spectrum.band(*_BAND), _CELLS + 1)
    omega = 0.5 * (bounds[1:] + bounds[:-1])
    energy = spectrum.density(omega) * np.diff(bounds)
    met = encounter_frequency(omega, U, beta)
    F = np.stack(excitation.forces(omega, U, beta), axis=1)
    F = np.where((met < 0.0)[:, None], F.conj(), F)
    made = np.zeros((len(edges) - 1, 2, 2), dtype=np.complex128)
    place = np.searchsorted(edges, np.abs(met), side="right") - 1
    inside = (place >= 0) & (place < len(made))
    np.add.at(made, place[inside], energy[inside, None, None] * F[inside, :, None] * F[inside, None, :].conj())
    return made / np.diff(edges)[:, None, None]
