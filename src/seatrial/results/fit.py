"""A fit: a solution read in the field's terms, with everything a report shows. Plain values only."""

from dataclasses import dataclass, field

from seatrial.equations import Model
from seatrial.optimise import Solution
from seatrial.values import Array, Finding, Record, Ship


@dataclass(frozen=True)
class Coefficient:
    """One parameter of the model after the fit, SI units; intervals at 95 %.

    `standard_error`, `lower`, `upper` are None for a fixed parameter; `truth` is None unless known.
    """

    name: str
    unit: str
    estimate: float
    standard_error: float | None
    lower: float | None
    upper: float | None
    fixed: bool
    truth: float | None = None
    prior_mean: float | None = None
    prior_standard_deviation: float | None = None
    source: str = ""
    meaning: str = ""
    latex: str = ""


@dataclass(frozen=True)
class Offset:
    """One nuisance: what it is (``delta zero``), the run or session it belongs to, SI value and standard error."""

    name: str
    group: str
    unit: str
    estimate: float
    standard_error: float | None


@dataclass(frozen=True)
class Noise:
    """Estimated noise of one channel and what its residuals look like.

    Attributes:
        standard_deviation: SI.
        unit: SI unit.
        correlation_time: s, integral scale of the residuals' autocorrelation.
        whiteness_p: p-value of a portmanteau test (Ljung & Box 1978) on the residuals.
    """

    channel: str
    unit: str
    standard_deviation: float
    correlation_time: float
    whiteness_p: float


@dataclass(frozen=True)
class Measure:
    """One manoeuvring measure, measured against simulated; bounds are None until a method defends them."""

    measured: float | None
    simulated: float | None
    lower: float | None = None
    upper: float | None = None


@dataclass(frozen=True, eq=False)
class Prediction:
    """One run simulated open loop beside its measurement.

    Attributes:
        role: ``validation`` or ``training``.
        rms: keys ``psi_deg``, ``position_m``, ``u``, ``v``, ``r`` (m/s, m/s, rad/s) as far as measured.
        measures: keys as in `seatrial.manoeuvres.measures`, e.g. ``overshoot_1_deg``, ``advance_L``.
        initial_seconds: from how much of the run's beginning the initial state was taken.
    """

    record: str
    role: str
    measured: Record
    simulated: Record
    rms: dict[str, float]
    measures: dict[str, Measure]
    initial_seconds: float


@dataclass(frozen=True)
class Method:
    """What was used and why, in words a report can print."""

    criterion: str
    start: str
    intervals: str
    reasons: tuple[str, ...] = ()
    settings: dict[str, float | str] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Residuals:
    """Residuals of one channel of the training runs, in order, for whiteness plots.

    Attributes:
        rate: Hz.
        values: shape (n,), SI; runs one after another.
        autocorrelation: shape (k,), lags 0.. at `rate`, averaged over segments.
    """

    channel: str
    rate: float
    values: Array
    autocorrelation: Array


@dataclass(frozen=True, eq=False)
class Fit:
    """Everything a report shows.

    Attributes:
        question: one sentence, what was asked.
        model: with the estimated parameters.
        covariance: of the free coefficients in the order of `model.parameters.free_names`, shape (n, n).
        records: the training and validation records as used.
        seed, elapsed_s, versions: how to get the same again.
    """

    question: str
    ship: Ship
    model: Model
    coefficients: tuple[Coefficient, ...]
    covariance: Array
    solution: Solution
    method: Method
    offsets: tuple[Offset, ...]
    noise: tuple[Noise, ...]
    residuals: tuple[Residuals, ...]
    predictions: tuple[Prediction, ...]
    findings: tuple[Finding, ...]
    records: tuple[Record, ...]
    seed: int
    elapsed_s: float
    versions: dict[str, str]

    def validation(self) -> tuple[Prediction, ...]:
        """The predictions of runs that were not fitted."""
        return tuple(p for p in self.predictions if p.role == "validation")
