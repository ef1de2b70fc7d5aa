"""The published steps on our own series: cleaning, Lasso, support vectors; where their errors come from; ours."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Finding, InputError, Record
from seatrial.data.example_series.series import JET_VELOCITY, SENSOR_NOISE, SLEW_RATE, noisy
from seatrial.estimation.estimate.fit import identified
from seatrial.estimation.estimate.settings import Settings
from seatrial.estimation.regress.arithmetic import Lasso, LeastSquares
from seatrial.estimation.regress.estimators import Estimator, Regressed, Regression
from seatrial.estimation.regress.features import Motion
from seatrial.estimation.regress.named import regressions
from seatrial.estimation.regress.operators import Central, Centred, Differenced, Euler, Weak
from seatrial.estimation.regress.pipeline import Cleaning, Pipeline
from seatrial.estimation.regress.split import blocks, shuffled
from seatrial.estimation.regress.support_vectors import SupportVectors
from seatrial.estimation.regress.system import systems
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.waterjet import COEFFICIENTS
from seatrial.physics.simulate.steer import manoeuvre
from seatrial_studies.song2025.candidates import thirteen
from seatrial_studies.song2025.crafts import TRUTH, reference
from seatrial_studies.song2025.published import Run

WINDOW, SERIES = 20.0, 6
TUBES, PENALTIES = (0.1, 0.01, 0.001), (1.0, 10.0)
VELOCITY_NOISE = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2)
QUASI_DIFFERENCES = (0.0, 0.5, 0.9, 0.99, 1.0)
YAW_LENGTH = 9.8  # m: noise in r is that in u and v over one ship length


@dataclass(frozen=True, eq=False)
class Row:
    """What one way of doing it finds; errors relative to the truth, shape (11,); NaN and a note where it fails."""

    name: str
    values: Array
    errors: Array
    bias: dict[str, float]
    findings: tuple[Finding, ...] = ()
    note: str = ""

    @property
    def median(self) -> float:
        """Of the relative errors' magnitudes."""
        return float(np.median(np.abs(self.errors)))

    @property
    def largest(self) -> float:
        """Of the relative errors' magnitudes."""
        return float(np.max(np.abs(self.errors)))


@dataclass(frozen=True, eq=False)
class Selection:
    """Coefficients that Lasso keeps of the thirteen, its penalties by equation, and what setting it is."""

    setting: str
    kept: tuple[str, ...]
    dropped: tuple[str, ...]
    penalties: dict[str, float]


@dataclass(frozen=True, eq=False)
class Leak:
    """Error of the yaw rate copied from the nearest training sample, over its standard deviation."""

    shuffled: float
    blocks: float


@dataclass(frozen=True, eq=False)
class Sweep:
    """Median error of several regressions, each (levels,), against one setting."""

    levels: tuple[float, ...]
    medians: dict[str, Array]


@dataclass(frozen=True, eq=False)
class Repetition:
    """Everything computed with regressions and fits.

    Attributes:
        series, measured: the consecutive zigzags noise-free and with the sensors' noise.
        cleaning: what its steps say, noise-free and measured.
        swallowed: support vectors on the numbers as they come.
        clean, noisy: every regression on either series.
        tubes: the improved pipeline by penalty and tube.
        differences: quasi-differences of eq. (17), noise-free; noise: white noise of the velocities.
        exact, ours: output error without noise (same discretisation as the model's) and with the sensors' noise.
        ratio: rms of ours' errors over their standard errors.
        over_bound: the nearer regressions' rms errors over several series of noise, over ours' standard errors: medians
            of the coefficients.
    """

    series: Record
    measured: Record
    cleaning: tuple[tuple[str, ...], tuple[str, ...]]
    selections: tuple[Selection, ...]
    swallowed: Row
    clean: tuple[Row, ...]
    noisy: tuple[Row, ...]
    tubes: tuple[Row, ...]
    differences: Sweep
    noise: Sweep
    leak: Leak
    exact: Row
    ours: Row
    ratio: float
    over_bound: dict[str, float]

    @property
    def published(self) -> tuple[Row, Row, Row, Row]:
        """Original and improved pipeline, noise-free, then with sensor noise."""
        original, improved, noisy_original, noisy_improved = (
            row for rows in (self.clean, self.noisy) for row in rows if row.name.startswith("published")
        )
        return original, improved, noisy_original, noisy_improved


def repetition(*, quick: bool, seed: int, progress: Callable[[str], None] | None) -> Repetition:
    """All of it; `quick` leaves out the slow settings of the support vectors and most noise levels."""
    tell = progress or (lambda _: None)
    tell("the series")
    clean = reference(Run.CONSECUTIVE)
    measured = noisy(clean, np.random.default_rng(seed), seed)
    tell("regressions")
    improved = Pipeline()
    unscaled = Pipeline(name="unscaled", operator=Euler(), arithmetic=SupportVectors(standardised=False))
    of_clean = tuple(row(e, clean) for e in regressions(WINDOW))
    of_noisy = tuple(row(e, measured) for e in regressions(WINDOW))
    tell("where the errors come from")
    tubes = tuple(
        row(replace(improved, name=f"C = {c:g}, tube {t:g}", arithmetic=SupportVectors(c, t)), clean)
        for c in PENALTIES[: 1 if quick else None]
        for t in TUBES[: 2 if quick else None]
    )
    differences = _sweep(QUASI_DIFFERENCES, lambda rho: (clean, _least_squares(Differenced(Euler(), rho))))
    tell("noise")
    levels = VELOCITY_NOISE[1::2] if quick else VELOCITY_NOISE
    noise = _noise(clean, levels, seed)
    tell("output error")
    exact, ours, errors = _ours(measured)
    ratio = float(np.sqrt(np.mean((ours.errors / errors) ** 2)))
    return Repetition(
        clean, measured, (_cleaning(clean), _cleaning(measured)), _selections(clean, measured),
        row(unscaled, clean), of_clean, of_noisy, tubes, differences, noise, _leak(clean, seed), exact, ours, ratio,
        _over_bound(clean, errors, seed),
    )  # fmt: skip


def truth() -> Array:
    """The eleven coefficients."""
    return np.array([p.value for p in TRUTH.craft().parameters.free])


def blank() -> Model:
    """The craft whose coefficients are not known."""
    return TRUTH.craft().with_values(dict.fromkeys(COEFFICIENTS, 0.0))


def row(estimator: Estimator, record: Record) -> Row:
    """One estimator on one record."""
    try:
        found = estimator.estimate(blank(), [record])
    except InputError as error:
        none = np.full(len(COEFFICIENTS), np.nan)
        return Row(estimator.name, none, none, {}, (), str(error))
    return _row(estimator.name, found)


def _row(name: str, found: Regressed) -> Row:
    return Row(name, found.values, found.values / truth() - 1.0, found.bias, found.findings)


def _least_squares(operator: Euler | Central | Weak | Differenced | Centred) -> Regression:
    return Regression("least squares", operator, LeastSquares())


def _sweep(levels: Sequence[float], case: Callable[[float], tuple[Record, Regression]]) -> Sweep:
    rows = [row(estimator, record) for record, estimator in map(case, levels)]
    return Sweep(tuple(levels), {"least squares": np.array([r.median for r in rows])})


def _noise(clean: Record, levels: Sequence[float], seed: int) -> Sweep:
    operators = {
        "Euler": Euler(), "Euler, differenced": Differenced(Euler()), "central": Central(), "weak form": Weak(WINDOW)
    }  # fmt: skip
    medians: dict[str, list[float]] = {name: [] for name in operators}
    for level in levels:
        record = _with_noise(clean, level, np.random.default_rng(seed))
        for name, operator in operators.items():
            medians[name].append(row(_least_squares(operator), record).median)
    return Sweep(tuple(levels), {name: np.array(values) for name, values in medians.items()})


def _with_noise(record: Record, level: float, generator: np.random.Generator) -> Record:
    channels = dict(record.channels)
    for symbol, deviation in (("u", level), ("v", level), ("r", level / YAW_LENGTH)):
        channel = record.channel(symbol)
        channels[symbol] = channel.with_values(channel.values + deviation * generator.standard_normal(len(record)))
    return replace(record, channels=channels)


def _selections(clean: Record, measured: Record) -> tuple[Selection, ...]:
    cases = (
        ("noise-free, Euler (as published)", clean, Euler()),
        ("noise-free, central differences", clean, Central()),
        ("sensor noise, Euler (as published)", measured, Euler()),
        ("sensor noise, weak form", measured, Weak(WINDOW)),
    )
    return tuple(_selection(*case) for case in cases)


def _selection(setting: str, record: Record, operator: Euler | Central | Weak) -> Selection:
    craft = thirteen()
    train = blocks(Cleaning().cleaned(craft, record), 0.8)[0] if not isinstance(operator, Weak) else record
    kept, dropped, penalties = list[str](), list[str](), {}
    for system in systems(craft, [Motion.of(craft, train)], operator):
        solved = Lasso().solve(system)
        penalties[system.title] = solved.settings["penalty"]
        for name, value in zip(system.names, solved.coefficients, strict=True):
            (kept if value != 0.0 else dropped).append(name)
    return Selection(setting, tuple(kept), tuple(dropped), penalties)


def _cleaning(record: Record) -> tuple[str, ...]:
    return tuple(s for s in Cleaning().cleaned(TRUTH.craft(), record).provenance.steps if "left out" in s)


def _leak(record: Record, seed: int) -> Leak:
    """The last of eq. (9)'s training samples before, or the nearest of those drawn."""
    train, test = blocks(record, 0.8)
    drawn, left = shuffled(len(record), 0.8, np.random.default_rng(seed))
    nearest = drawn[np.abs(drawn[:, None] - left[None, ::20]).argmin(axis=0)]
    size = float(np.std(record["r"]))
    copied = float(np.sqrt(np.mean((record["r"][left[::20]] - record["r"][nearest]) ** 2)))
    held = float(np.sqrt(np.mean((test["r"] - train["r"][-1]) ** 2)))
    return Leak(copied / size, held / size)


def _over_bound(clean: Record, errors: Array, seed: int) -> dict[str, float]:
    near = [e for e in regressions(WINDOW) if e.name.startswith(("weak", "smoothed"))]
    streams = np.random.SeedSequence(seed).spawn(SERIES)
    records = [noisy(clean, np.random.default_rng(stream), seed) for stream in streams]
    rms = {e.name: np.sqrt(np.mean([row(e, r).errors ** 2 for r in records], axis=0)) for e in near}
    return {name: float(np.median(values / errors)) for name, values in rms.items()}


def _ours(measured: Record) -> tuple[Row, Row, Array]:
    """Output error without noise and with it, and its relative standard errors (11,)."""
    length = TRUTH.craft().parameters["L"].value
    own = manoeuvre(TRUTH.craft(), programme(Run.CONSECUTIVE), inputs={"v_j": JET_VELOCITY}, slew_rate=SLEW_RATE)
    exact = identified(blank(), [own], [own.name], length, Settings())
    known = Settings(noise=dict(SENSOR_NOISE))
    found = identified(blank(), [measured], [measured.name], length, known)
    count = len(COEFFICIENTS)
    errors = found.interval.standard_error[:count] / np.abs(truth())
    rows = [Regressed(f.made.shared[:count]) for f in (exact, found)]
    return _row("output error, noise-free", rows[0]), _row("output error, sensor noise", rows[1]), errors
