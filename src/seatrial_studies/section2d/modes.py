"""Heave, roll and sway as oscillators in regular waves: fits, what regular waves leave open, the springs of sway."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from seatrial.core.values import Array, InputError
from seatrial.physics.hydro import MOTIONS, SectionMotion, section_hydrodynamics
from seatrial_studies.cross_validation import jackknife_error
from seatrial_studies.section2d.responses import (
    FORM,
    HEAVE_PERIOD,
    HEAVE_STIFFNESS,
    HEIGHTS,
    LENGTH,
    MASS,
    ROLL_AXIS,
    ROLL_INERTIA,
    ROLL_PERIOD,
    ROLL_STIFFNESS,
    SWAY_STIFFNESS,
    FlumeRun,
    SectionResponse,
    natural_period,
    relative_difference,
)

# One motion in regular waves: potential theory with a few corrections, fitted to complex amplitudes of many periods.

Complex = NDArray[np.complex128]
OSCILLATOR_PARAMETERS = (
    "gain",
    "delay",
    "distance",
    "extra_added_mass",
    "linear_damping",
    "quadratic_damping",
    "stiffness",
)
_ITERATIONS = 60


@dataclass(frozen=True)
class SectionTheory:
    """Of the whole section at one frequency: added mass, damping, complex excitation per m of wave amplitude."""

    added_mass: float
    damping: float
    excitation: complex


@dataclass(frozen=True)
class MeasuredResponse:
    """A measured response.

    Attributes:
        omega, wavenumber: rad/s, rad/m.
        wave_amplitude: m.
        response: complex, per m of wave amplitude.
        relative_sd: relative standard deviation expected of it.
        theory: at this frequency.
    """

    omega: float
    wavenumber: float
    wave_amplitude: float
    response: complex
    relative_sd: float
    theory: SectionTheory


@dataclass(frozen=True)
class Oscillator:
    """(m + a + da) x'' + (b + b_1) x' + b_2 x'|x'| + c x = X as instruments show it, m inertia and c stiffness.

    Attributes:
        inertia, stiffness: known.
        gain: of measured response over computed one; negative where the measured axis points the other way.
        delay: s, of the response's channels against the waves'.
        distance: m, of the section beyond the place to which the wave is referred.
        extra_added_mass: da, kg (kg m^2), beside the theory's a.
        linear_damping: b_1, kg/s (kg m^2/s), beside the theory's b.
        quadratic_damping: b_2, kg/m (kg m^2), damping force over |velocity| velocity.
    """

    inertia: float
    stiffness: float
    gain: float = 1.0
    delay: float = 0.0
    distance: float = 0.0
    extra_added_mass: float = 0.0
    linear_damping: float = 0.0
    quadratic_damping: float = 0.0

    def motion_response(self, theory: SectionTheory, omega: float, wave_amplitude: float) -> complex:
        """The motion itself per m of wave amplitude, quadratic damping by its equivalent 8 omega |x| / (3 pi).

        Equal work over a period (Himeno 1981, Univ. of Michigan report 239); the amplitude is found by iteration.
        """
        spring = self.stiffness - omega**2 * (self.inertia + theory.added_mass + self.extra_added_mass)
        size = 0.0
        response = 0j
        for _ in range(_ITERATIONS):
            damping = (
                theory.damping
                + self.linear_damping
                + self.quadratic_damping * 8.0 / (3.0 * np.pi) * omega * size * wave_amplitude
            )
            response = theory.excitation / (spring + 1j * omega * damping)
            if abs(abs(response) - size) < 1e-10 * abs(response):
                break
            size = 0.5 * (size + abs(response))
        return complex(response)

    def extra_equivalent_damping(self, theory: SectionTheory, omega: float, wave_amplitude: float) -> float:
        """Both parts beside the theory's, as kg/s (kg m^2/s) at that wave amplitude."""
        size = abs(self.motion_response(theory, omega, wave_amplitude)) * wave_amplitude
        return self.linear_damping + self.quadratic_damping * 8.0 / (3.0 * np.pi) * omega * size

    def measured_response(self, measurement: MeasuredResponse) -> complex:
        """Return the response as it would be measured."""
        turned = np.exp(-1j * (measurement.wavenumber * self.distance + measurement.omega * self.delay))
        return complex(
            self.gain * turned * self.motion_response(measurement.theory, measurement.omega, measurement.wave_amplitude)
        )


@dataclass(frozen=True, eq=False)
class OscillatorFit:
    """The fitted oscillator; `errors` by name from residuals, `misfit` the root mean square of weighted residuals."""

    oscillator: Oscillator
    free: tuple[str, ...]
    errors: Mapping[str, float]
    misfit: float


def fit_oscillator(
    start: Oscillator,
    measurements: Sequence[MeasuredResponse],
    free: Sequence[str] = OSCILLATOR_PARAMETERS,
    scales: Mapping[str, float] | None = None,
) -> OscillatorFit:
    """Least squares on relative complex errors over their spreads.

    Args:
        free: names of `Oscillator`'s fields to estimate.
        scales: typical size of each.

    Raises:
        InputError: an unknown name, or more unknowns than measured numbers.
    """
    from scipy.optimize import least_squares

    unknown = [name for name in free if name not in OSCILLATOR_PARAMETERS]
    if unknown:
        raise InputError(
            f"an oscillator has no '{unknown[0]}' to be free; choose from {', '.join(OSCILLATOR_PARAMETERS)}"
        )
    frequencies = {round(o.omega, 6) for o in measurements}
    if len(free) > 2 * len(frequencies):
        raise InputError(
            f"{len(free)} unknowns cannot be identified from {len(frequencies)} wave periods, which give two numbers "
            "each; fix some or add periods"
        )
    sizes = np.array([(scales or {}).get(name, 1.0) for name in free])
    measured = np.array([o.response for o in measurements])
    spreads = np.array([o.relative_sd for o in measurements])

    def oscillator_at(point: Array) -> Oscillator:
        return replace(start, **{name: float(v) for name, v in zip(free, point * sizes, strict=True)})

    def residuals(point: Array) -> Array:
        shaped = oscillator_at(point)
        left = (np.array([shaped.measured_response(o) for o in measurements]) / measured - 1.0) / spreads
        return np.concatenate([left.real, left.imag])

    first = np.array([getattr(start, name) for name in free]) / sizes
    found = least_squares(residuals, first, x_scale="jac")
    degrees = max(1, 2 * len(frequencies) - len(free))
    variance = float(found.fun @ found.fun) / degrees
    jacobian = np.asarray(found.jac)
    covariance = variance * np.linalg.pinv(jacobian.T @ jacobian)
    errors = {name: float(s * e) for name, s, e in zip(free, sizes, np.sqrt(np.diag(covariance)), strict=True)}
    return OscillatorFit(oscillator_at(found.x), tuple(free), errors, float(np.sqrt(np.mean(found.fun**2))))


# What regular waves alone cannot identify: added mass, damping and excitation when nothing ties them together.

ORDER = 2


def untied_mass_error(
    observations: Sequence[MeasuredResponse], inertia: float, stiffness: float, order: int = ORDER
) -> float:
    """Return the standard error [kg, kg m^2] of an added mass when the excitation is only known to be smooth.

    Unknown: added mass, damping, the excitation's log amplitude and phase, each a polynomial of that order in
    frequency; neither Haskind's relation nor a shape. Linearised at the theory, with each response's own spread; the
    error is that at the mean frequency. Infinite where the periods do not determine the unknowns at all.
    """
    omegas = np.array([o.omega for o in observations])
    spread = np.array([o.relative_sd for o in observations])
    scaled = (omegas - omegas.mean()) / max(float(np.ptp(omegas)), 1e-9)
    smooth = np.stack([scaled**k for k in range(order + 1)], axis=1)
    impedance = np.array(
        [
            stiffness - o.omega**2 * (inertia + o.theory.added_mass) + 1j * o.omega * o.theory.damping
            for o in observations
        ]
    )
    by_mass, by_damping = omegas**2 / impedance, -1j * omegas / impedance
    rows = (
        np.column_stack([by_mass[:, None] * smooth, by_damping[:, None] * smooth, smooth, 1j * smooth])
        / spread[:, None]
    )
    jacobian: Array = np.concatenate([rows.real, rows.imag])
    sizes = np.linalg.norm(jacobian, axis=0)
    values = np.linalg.svd(jacobian / sizes, compute_uv=False)
    if len(values) < jacobian.shape[1] or values[-1] < 1e-9 * values[0]:
        return float("inf")
    information = (jacobian / sizes).T @ (jacobian / sizes)
    return float(np.sqrt(np.linalg.inv(information)[0, 0]) / sizes[0])


# Heave and roll as oscillators: what trains, what is held out, natural periods, intervals from leaving periods out.

REPEATABILITY, CROSS_AXIS = 0.005, 0.02
EXTRA_COEFFICIENTS = ("linear_damping", "stiffness")
_PERIOD_ITERATIONS = 30


@dataclass(frozen=True)
class Mode:
    """How one motion is fitted.

    Attributes:
        scenario: of the runs it is fitted on.
        sign: of the response's axis against the theory's.
        free: for the fit that predicts; scales: their typical sizes.
        cross_axis_share: share of the sway acceleration that the accelerometers' mean may feel.
        documented_period: natural period, s.
    """

    motion: SectionMotion
    scenario: int
    sign: float
    start: Oscillator
    free: tuple[str, ...]
    scales: dict[str, float]
    cross_axis_share: float
    documented_period: float

    def measured_response(self, response: SectionResponse) -> complex:
        """Return the measured response of this mode."""
        return response.heave if self.motion is SectionMotion.HEAVE else response.roll


@dataclass(frozen=True)
class ResponseScore:
    """A measured response beside the predicted one, and whether it trained."""

    response: SectionResponse
    is_training: bool
    is_interpolated: bool
    amplitude_error: float
    phase_error: float


@dataclass(frozen=True, eq=False)
class ModeFit:
    """Trained on half of the periods, scored on all; then fitted on all with a jackknife over periods.

    Attributes:
        period: natural period, s.
        viscous_damping: damping besides the wave damping at that period in waves of nominal height, kg/s (kg m^2/s).
        standard_errors, period_error, viscous_damping_error: by leaving each wave period out.
        extended_fits: name -> the fit on all periods with that coefficient free as well.
    """

    mode: Mode
    half_of_periods: OscillatorFit
    scores: tuple[ResponseScore, ...]
    all_periods: OscillatorFit
    period: float
    viscous_damping: float
    standard_errors: dict[str, float]
    period_error: float
    viscous_damping_error: float
    extended_fits: dict[str, OscillatorFit]


HEAVE = Mode(
    SectionMotion.HEAVE,
    4,
    -1.0,
    Oscillator(MASS, HEAVE_STIFFNESS, gain=1.1, quadratic_damping=100.0),
    ("gain", "delay", "distance", "extra_added_mass", "quadratic_damping"),
    {
        "gain": 1.0,
        "delay": 0.02,
        "distance": 0.02,
        "extra_added_mass": 2.0,
        "linear_damping": 10.0,
        "quadratic_damping": 100.0,
        "stiffness": 100.0,
    },
    CROSS_AXIS,
    HEAVE_PERIOD,
)
ROLL = Mode(
    SectionMotion.ROLL,
    6,
    1.0,
    Oscillator(ROLL_INERTIA, ROLL_STIFFNESS, gain=0.3, delay=-0.02, quadratic_damping=0.3),
    ("gain", "delay", "extra_added_mass", "quadratic_damping"),
    {
        "gain": 0.1,
        "delay": 0.02,
        "extra_added_mass": 0.02,
        "linear_damping": 0.1,
        "quadratic_damping": 0.1,
        "stiffness": 1.0,
    },
    0.0,
    ROLL_PERIOD,
)


def theory_of_model(motion: SectionMotion, omega: float, sign: float = 1.0) -> SectionTheory:
    """Of the whole model."""
    one, k = section_hydrodynamics(FORM, omega, ROLL_AXIS), MOTIONS.index(motion)
    return SectionTheory(
        LENGTH * float(one.added_mass[k, k]),
        LENGTH * float(one.damping[k, k]),
        LENGTH * sign * complex(one.excitation[k]),
    )


def observation(mode: Mode, response: SectionResponse) -> MeasuredResponse:
    """Return a response with its spread: repeatability and what sway may leak into the accelerometers."""
    value = mode.measured_response(response)
    spread = float(np.hypot(REPEATABILITY, mode.cross_axis_share * abs(response.sway / value)))
    theory = theory_of_model(mode.motion, response.run.omega, mode.sign)
    return MeasuredResponse(response.run.omega, response.run.wavenumber, response.wave_amplitude, value, spread, theory)


def split_periods(indices: Sequence[int]) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Wave periods that train and that are held out: half of them, evenly spread from the longest to the shortest."""
    order = sorted(set(indices))
    chosen = {order[round(k)] for k in np.linspace(0, len(order) - 1, (len(order) + 1) // 2)}
    return tuple(k for k in order if k in chosen), tuple(k for k in order if k not in chosen)


def fit_mode(mode: Mode, responses: Sequence[SectionResponse]) -> ModeFit:
    """Train, score, fit all, leave each period out.

    Raises:
        InputError: fewer wave periods than the unknowns need.
    """
    runs = [r for r in responses if r.run.scenario == mode.scenario]
    train, _ = split_periods([r.run.period_index for r in runs])

    def fit_on(chosen: Callable[[SectionResponse], bool]) -> OscillatorFit:
        return fit_oscillator(mode.start, [observation(mode, r) for r in runs if chosen(r)], mode.free, mode.scales)

    trained = fit_on(lambda r: r.run.period_index in train)
    whole = fit_on(lambda _: True)
    periods = sorted({r.run.period_index for r in runs})
    left = [fit_on(lambda r, out=k: r.run.period_index != out) for k in periods]
    spread = {name: jackknife_error([getattr(f.oscillator, name) for f in left]) for name in mode.free}
    return ModeFit(
        mode,
        trained,
        tuple(_score(mode, trained, r, train) for r in runs),
        whole,
        mode_natural_period(mode, whole.oscillator),
        equivalent_viscous_damping(mode, whole.oscillator),
        spread,
        jackknife_error([mode_natural_period(mode, f.oscillator) for f in left]),
        jackknife_error([equivalent_viscous_damping(mode, f.oscillator) for f in left]),
        {
            name: fit_with_extra(mode, whole.oscillator, [observation(mode, r) for r in runs], name)
            for name in EXTRA_COEFFICIENTS
        },
    )


def _score(mode: Mode, fit: OscillatorFit, response: SectionResponse, train: Sequence[int]) -> ResponseScore:
    amplitude, phase = relative_difference(
        fit.oscillator.measured_response(observation(mode, response)), mode.measured_response(response)
    )
    between = min(train) < response.run.period_index < max(train)
    return ResponseScore(response, response.run.period_index in train, between, amplitude, phase)


def mode_natural_period(mode: Mode, oscillator: Oscillator) -> float:
    """s, undamped, with the added mass of that period."""
    period = mode.documented_period
    for _ in range(_PERIOD_ITERATIONS):
        added = theory_of_model(mode.motion, 2.0 * np.pi / period).added_mass + oscillator.extra_added_mass
        period = natural_period(oscillator.inertia + added, oscillator.stiffness)
    return period


def equivalent_viscous_damping(mode: Mode, oscillator: Oscillator) -> float:
    """Damping beside the wave damping at the documented natural period, waves of the smaller nominal height."""
    omega = 2.0 * np.pi / mode.documented_period
    theory = theory_of_model(mode.motion, omega, mode.sign)
    return oscillator.extra_equivalent_damping(theory, omega, 0.5 * min(HEIGHTS.values()))


def fit_with_extra(
    mode: Mode, start: Oscillator, observations: Sequence[MeasuredResponse], coefficient: str
) -> OscillatorFit:
    """One coefficient more."""
    return fit_oscillator(start, observations, (*mode.free, coefficient), mode.scales)


# Sway stiffness: spring tensions over the camera's sway, its clock's delay and drift fitted along.

LEAST_SWAY_M, LEAST_SHARE = 0.003, 0.9
_DELAYS = np.arange(-0.4, 0.41, 0.05)
_DRIFTS = np.arange(-0.016, 0.0161, 0.004)
_MARGIN_S = 2.0


@dataclass(frozen=True)
class SpringRegression:
    """One run.

    Attributes:
        lower, upper: N/m, regression of tension on sway and its inverse; all noise in the one or the other.
        delay, drift: s, s/s of the camera.
        explained_share: share of the tension.
    """

    run: str
    lower: float
    upper: float
    delay: float
    drift: float
    explained_share: float

    @property
    def geometric_mean(self) -> float:
        """Return the slope [N/m] of the reduced major axis: the geometric mean of both."""
        return float(np.sqrt(self.lower * self.upper))


@dataclass(frozen=True)
class SwayStiffness:
    """Mean over the runs used, N/m, and its standard error from leaving runs out."""

    runs: tuple[SpringRegression, ...]
    mean: float
    error: float

    @property
    def value(self) -> float:
        """Return the stiffness [N/m]; the middle of the documented range where no run identifies it."""
        return self.mean if np.isfinite(self.mean) else sum(SWAY_STIFFNESS) / 2.0


def sway_stiffness(runs: Sequence[FlumeRun]) -> SwayStiffness:
    """Of the runs in which the section sways freely, the camera lives and tensions follow sway.

    Runs whose tension is explained to less than nine tenths are left out: slack springs, camera clocks that jump.
    """
    made = [one for run in runs if run.scenario in (3, 4) for one in spring_regression(run)]
    used = [s.geometric_mean for s in made if s.explained_share > LEAST_SHARE]
    if len(used) < 2:
        return SwayStiffness(tuple(made), float("nan"), float("nan"))
    means = [float(np.mean(used[:k] + used[k + 1 :])) for k in range(len(used))]
    return SwayStiffness(tuple(made), float(np.mean(used)), jackknife_error(means))


def spring_regression(run: FlumeRun) -> tuple[SpringRegression, ...]:
    """Empty where the camera is dead or the sway small."""
    from scipy.optimize import minimize

    start, stop = run.stroke_times[1], float(run.record.time[-1]) - _MARGIN_S
    part = run.record.between(start, stop)
    sway, whole = run.record["y0"], run.record.time
    if float(np.std(part["y0"])) < LEAST_SWAY_M:
        return ()
    tension = part["S_1"] - part["S_2"]
    centre = part.time - part.time.mean()

    def features(point: Array) -> Array:
        return np.column_stack([np.interp(part.time + point[0] + point[1] * centre, whole, sway), np.ones(len(centre))])

    def residuals(point: Array) -> Array:
        basis = features(point)
        return tension - basis @ np.linalg.lstsq(basis, tension, rcond=None)[0]

    def misfit(point: Array) -> float:
        return float(np.sum(residuals(point) ** 2))

    first = min(((d, s) for d in _DELAYS for s in _DRIFTS), key=lambda p: misfit(np.array(p)))
    corners = np.array([first, (first[0] + 0.02, first[1]), (first[0], first[1] + 0.002)])
    found = minimize(misfit, first, method="Nelder-Mead", options={"initial_simplex": corners, "xatol": 1e-5})
    slope = float(np.linalg.lstsq(features(found.x), tension, rcond=None)[0][0])
    explained = 1.0 - float(found.fun / np.sum((tension - tension.mean()) ** 2))
    return (SpringRegression(run.name, slope, slope / explained, float(found.x[0]), float(found.x[1]), explained),)
