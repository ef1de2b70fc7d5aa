"""Heave and roll as oscillators: what trains, what is held out, natural periods, intervals from leaving periods out."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.estimation.problem.oscillator import Observed, Oscillator, OscillatorFit, Theory, fitted
from seatrial.physics.hydro.multipoles import Motion, hydrodynamics
from seatrial_studies.section2d import tank
from seatrial_studies.section2d.responses import Response, difference

REPEATABILITY, CROSS_AXIS = 0.005, 0.02
FREED = ("linear", "stiffness")
_ROUNDS = 30


@dataclass(frozen=True)
class Mode:
    """How one motion is fitted.

    Attributes:
        scenario: of the runs it is fitted on.
        sign: of the response's axis against the theory's.
        free: for the fit that predicts; scales: their typical sizes.
        cross: share of the sway acceleration that the accelerometers' mean may feel.
        documented: natural period, s.
    """

    motion: Motion
    scenario: int
    sign: float
    start: Oscillator
    free: tuple[str, ...]
    scales: dict[str, float]
    cross: float
    documented: float

    def measured(self, one: Response) -> complex:
        """The response of this mode."""
        return one.heave if self.motion is Motion.HEAVE else one.roll


@dataclass(frozen=True)
class Score:
    """A measured response beside the predicted one, and whether it trained."""

    response: Response
    trained: bool
    between: bool
    amplitude: float
    phase: float


@dataclass(frozen=True, eq=False)
class ModeFit:
    """Trained on half of the periods, scored on all; then fitted on all with a jackknife over periods.

    Attributes:
        period: natural period, s.
        beside: damping beside the wave damping at that period in waves of the nominal height, kg/s (kg m^2/s).
        errors, period_error, beside_error: standard errors by leaving each wave period out.
        freed: name -> the fit on all periods with that coefficient free as well.
    """

    mode: Mode
    trained: OscillatorFit
    scores: tuple[Score, ...]
    whole: OscillatorFit
    period: float
    beside: float
    errors: dict[str, float]
    period_error: float
    beside_error: float
    freed: dict[str, OscillatorFit]


HEAVE = Mode(
    Motion.HEAVE,
    4,
    -1.0,
    Oscillator(tank.MASS, tank.HEAVE_STIFFNESS, gain=1.1, quadratic=100.0),
    ("gain", "delay", "distance", "added", "quadratic"),
    {
        "gain": 1.0,
        "delay": 0.02,
        "distance": 0.02,
        "added": 2.0,
        "linear": 10.0,
        "quadratic": 100.0,
        "stiffness": 100.0,
    },
    CROSS_AXIS,
    tank.HEAVE_PERIOD,
)
ROLL = Mode(
    Motion.ROLL,
    6,
    1.0,
    Oscillator(tank.ROLL_INERTIA, tank.ROLL_STIFFNESS, gain=0.3, delay=-0.02, quadratic=0.3),
    ("gain", "delay", "added", "quadratic"),
    {"gain": 0.1, "delay": 0.02, "added": 0.02, "linear": 0.1, "quadratic": 0.1, "stiffness": 1.0},
    0.0,
    tank.ROLL_PERIOD,
)


def theory_at(motion: Motion, omega: float, sign: float = 1.0) -> Theory:
    """Of the whole model."""
    one = hydrodynamics(tank.FORM, omega, motion, tank.ROLL_AXIS)
    return Theory(one.added * tank.LENGTH, one.damping * tank.LENGTH, sign * one.excitation * tank.LENGTH)


def observed(mode: Mode, one: Response) -> Observed:
    """A response with its spread: repeatability and what sway may leak into the accelerometers."""
    value = mode.measured(one)
    spread = float(np.hypot(REPEATABILITY, mode.cross * abs(one.sway / value)))
    theory = theory_at(mode.motion, one.run.omega, mode.sign)
    return Observed(one.run.omega, one.run.wavenumber, one.wave, value, spread, theory)


def halves(indices: Sequence[int]) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Wave periods that train and that are held out: half of them, evenly spread from the longest to the shortest."""
    order = sorted(set(indices))
    chosen = {order[round(k)] for k in np.linspace(0, len(order) - 1, (len(order) + 1) // 2)}
    return tuple(k for k in order if k in chosen), tuple(k for k in order if k not in chosen)


def mode_fit(mode: Mode, responses: Sequence[Response]) -> ModeFit:
    """Train, score, fit all, leave each period out.

    Raises:
        InputError: fewer wave periods than the unknowns need.
    """
    runs = [r for r in responses if r.run.scenario == mode.scenario]
    train, _ = halves([r.run.index for r in runs])

    def on(chosen: Callable[[Response], bool]) -> OscillatorFit:
        return fitted(mode.start, [observed(mode, r) for r in runs if chosen(r)], mode.free, mode.scales)

    trained = on(lambda r: r.run.index in train)
    whole = on(lambda _: True)
    periods = sorted({r.run.index for r in runs})
    left = [on(lambda r, out=k: r.run.index != out) for k in periods]
    spread = {name: jackknife([getattr(f.oscillator, name) for f in left]) for name in mode.free}
    return ModeFit(
        mode,
        trained,
        tuple(_score(mode, trained, r, train) for r in runs),
        whole,
        natural_period(mode, whole.oscillator),
        beside(mode, whole.oscillator),
        spread,
        jackknife([natural_period(mode, f.oscillator) for f in left]),
        jackknife([beside(mode, f.oscillator) for f in left]),
        {name: freed(mode, whole.oscillator, [observed(mode, r) for r in runs], name) for name in FREED},
    )


def _score(mode: Mode, fit: OscillatorFit, one: Response, train: Sequence[int]) -> Score:
    amplitude, phase = difference(fit.oscillator.seen(observed(mode, one)), mode.measured(one))
    between = min(train) < one.run.index < max(train)
    return Score(one, one.run.index in train, between, amplitude, phase)


def natural_period(mode: Mode, oscillator: Oscillator) -> float:
    """s, undamped, with the added mass of that period."""
    period = mode.documented
    for _ in range(_ROUNDS):
        added = theory_at(mode.motion, 2.0 * np.pi / period).added + oscillator.added
        period = tank.natural_period(oscillator.inertia + added, oscillator.stiffness)
    return period


def beside(mode: Mode, oscillator: Oscillator) -> float:
    """Damping beside the wave damping at the documented natural period, waves of the smaller nominal height."""
    omega = 2.0 * np.pi / mode.documented
    theory = theory_at(mode.motion, omega, mode.sign)
    return oscillator.equivalent_damping(theory, omega, 0.5 * min(tank.HEIGHTS.values()))


def freed(mode: Mode, start: Oscillator, used: Sequence[Observed], name: str) -> OscillatorFit:
    """One coefficient more."""
    return fitted(start, used, (*mode.free, name), mode.scales)


def jackknife(values: Sequence[float]) -> float:
    """Standard error from values with one period left out each (Tukey 1958, Ann. Math. Stat. 29, 614)."""
    given = np.asarray(values, dtype=float)
    return float(np.sqrt((len(given) - 1) / len(given) * np.sum((given - given.mean()) ** 2)))
