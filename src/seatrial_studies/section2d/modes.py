"""Heave and roll as oscillators: what trains, what is held out, natural periods, intervals from leaving periods out."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial_studies.section2d import tank
from seatrial_studies.section2d.multipoles import SectionMotion, section_hydrodynamics
from seatrial_studies.section2d.oscillator import (
    MeasuredResponse,
    Oscillator,
    OscillatorFit,
    SectionTheory,
    fit_oscillator,
)
from seatrial_studies.section2d.responses import SectionResponse, relative_difference

REPEATABILITY, CROSS_AXIS = 0.005, 0.02
EXTRA_COEFFICIENTS = ("linear_damping", "stiffness")
_ITERATIONS = 30


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
    Oscillator(tank.MASS, tank.HEAVE_STIFFNESS, gain=1.1, quadratic_damping=100.0),
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
    tank.HEAVE_PERIOD,
)
ROLL = Mode(
    SectionMotion.ROLL,
    6,
    1.0,
    Oscillator(tank.ROLL_INERTIA, tank.ROLL_STIFFNESS, gain=0.3, delay=-0.02, quadratic_damping=0.3),
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
    tank.ROLL_PERIOD,
)


def theory_of_model(motion: SectionMotion, omega: float, sign: float = 1.0) -> SectionTheory:
    """Of the whole model."""
    one = section_hydrodynamics(tank.FORM, omega, motion, tank.ROLL_AXIS)
    return SectionTheory(one.added_mass * tank.LENGTH, one.damping * tank.LENGTH, sign * one.excitation * tank.LENGTH)


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
    for _ in range(_ITERATIONS):
        added = theory_of_model(mode.motion, 2.0 * np.pi / period).added_mass + oscillator.extra_added_mass
        period = tank.natural_period(oscillator.inertia + added, oscillator.stiffness)
    return period


def equivalent_viscous_damping(mode: Mode, oscillator: Oscillator) -> float:
    """Damping beside the wave damping at the documented natural period, waves of the smaller nominal height."""
    omega = 2.0 * np.pi / mode.documented_period
    theory = theory_of_model(mode.motion, omega, mode.sign)
    return oscillator.extra_equivalent_damping(theory, omega, 0.5 * min(tank.HEIGHTS.values()))


def fit_with_extra(
    mode: Mode, start: Oscillator, observations: Sequence[MeasuredResponse], coefficient: str
) -> OscillatorFit:
    """One coefficient more."""
    return fit_oscillator(start, observations, (*mode.free, coefficient), mode.scales)


def jackknife_error(values: Sequence[float]) -> float:
    """Standard error from values with one period left out each (Tukey 1958, Ann. Math. Stat. 29, 614)."""
    given = np.asarray(values, dtype=float)
    return float(np.sqrt((len(given) - 1) / len(given) * np.sum((given - given.mean()) ** 2)))
