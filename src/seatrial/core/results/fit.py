"""A fit: a solution read in the field's terms, with everything a report shows. Plain values only."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from seatrial.core.equations import Model
from seatrial.core.results.baseline import Baseline
from seatrial.core.results.identifiability import Identifiability
from seatrial.core.results.roll import RollCharacteristics
from seatrial.core.results.seakeeping import Seakeeping
from seatrial.core.values import Array, Finding, InputError, Record, Ship, spelling_hint
from seatrial.numerics.optimise import Solution

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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


@dataclass(frozen=True)
class NoiseModel:
    """What is between model and record: process noise in the states, measurement noise in the channels.

    Attributes:
        method: ``output error`` or ``prediction error``, the criterion of the fit.
        whiteness_p: smallest p-value over the channels that the residuals (innovations) are white.
        process: state -> intensity, SI unit of the state over the root of a second; 0 where none is needed.
        measurement: channel -> standard deviation, SI.
        text: why this criterion, in words.
    """

    method: str
    whiteness_p: float
    process: dict[str, float]
    measurement: dict[str, float]
    text: str = ""


@dataclass(frozen=True)
class Extrapolation:
    """How far a prediction leaves the training runs.

    Attributes:
        index: largest of the ratios; up to 1 is interpolation.
        ratios: ``yaw_rate``, ``drift``, ``rudder``, ``speed`` of the predicted run over those of the training runs.
    """

    index: float
    ratios: dict[str, float]


@dataclass(frozen=True, eq=False)
class IntervalBasis:
    """What intervals of any further prediction of a fit are made of.

    Attributes:
        covariance: of the free coefficients, without the spread of tied models, shape (n, n).
        degrees_of_freedom: of Student's t.
        factor: by which a foreseen standard deviation is multiplied where no training run shows that kind of measure.
        kinds: kind of measure -> standard deviation that comes on top, in its unit.
        offsets: offset (``delta zero``) -> standard deviation between sessions, SI.
        process: state -> intensity of process noise, SI over the root of a second.
        covered: what the training runs reach, SI (see `seatrial.estimation.information.extrapolation.reach`).
        tied: parameter -> value of each tied model.
    """

    covariance: Array
    degrees_of_freedom: float
    factor: float = 1.0
    measure_deviation: dict[str, float] = field(default_factory=dict)
    offsets: dict[str, float] = field(default_factory=dict)
    process: dict[str, float] = field(default_factory=dict)
    training_envelope: dict[str, float] = field(default_factory=dict)
    tied: tuple[dict[str, float], ...] = ()


@dataclass(frozen=True)
class CandidateModel:
    """One model of the declared family, scored over whole runs left out.

    Attributes:
        name: structure, prior and segment length in words; free: number of free coefficients.
        heading_deg, position_m: mean rms over windows of the runs left out; None where the fit failed or the ship has
            none.
        roll_deg: mean rms over whole runs left out, of a ship that swings about a rest.
        tied: not told from the best one by its runs.
        note: why it failed.
    """

    name: str
    free_count: int
    heading_deg: float | None
    position_m: float | None
    is_tied: bool
    is_chosen: bool = False
    note: str = ""
    roll_deg: float | None = None


@dataclass(frozen=True, eq=False)
class Prediction:
    """One run simulated open loop beside its measurement.

    Attributes:
        role: ``validation`` or ``training``.
        rms: keys ``psi_deg``, ``position_m``, ``u``, ``v``, ``r`` (m/s, m/s, rad/s) as far as measured.
        measures: keys as in `seatrial.physics.manoeuvres.measures`, e.g. ``overshoot_1_deg``, ``advance_L``.
        initial_seconds: from how much of the run's beginning the initial state was taken.
        half_width: channel (psi, x0, y0) -> half width of its 95 % band at every sample, shape (n,), SI.
        floor: rms error, keys as in `rms`, that process noise alone would leave with a perfect model.
        spread: standard deviation over tied models, keys as in `measures` and `rms`.
    """

    record: str
    role: str
    measured: Record
    simulated: Record
    rms: dict[str, float]
    measures: dict[str, Measure]
    initial_seconds: float
    extrapolation: Extrapolation | None = None
    half_width: dict[str, Array] = field(default_factory=dict)
    noise_floor: dict[str, float] = field(default_factory=dict)
    tied_spread: dict[str, float] = field(default_factory=dict)


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
        identifiability: what the records can tell; disturbance: noise and criterion; family: models compared.
        margin: what intervals of further predictions are made of.
        seakeeping: what the ship does in the waves of her trial; None where she met none that are known.
        rolling: what the coefficients of a roll model mean; None for any other model.
        rivals: other estimators on the same records, the fit itself first; empty where none were asked for.
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
    identifiability: Identifiability | None = None
    noise_model: NoiseModel | None = None
    candidate_models: tuple[CandidateModel, ...] = ()
    interval_basis: IntervalBasis | None = None
    seakeeping: Seakeeping | None = None
    baselines: tuple[Baseline, ...] = ()
    roll: RollCharacteristics | None = None

    def validation(self) -> tuple[Prediction, ...]:
        """The predictions of runs that were not fitted."""
        return tuple(p for p in self.predictions if p.role == "validation")

    def plot(self, record: str | None = None) -> "Figure":
        """Draw the free coefficients with their 95 % intervals, or one run, as a Matplotlib figure.

        Args:
            record: name of a training or validation run, to be drawn measured and simulated.

        Raises:
            InputError: the fit has no such run, or no free coefficient.
        """
        from seatrial.core.figures.matplotlib_axes import matplotlib_figure
        from seatrial.core.results.fit_charts import coefficients_chart, prediction_chart

        if record is None:
            chart = coefficients_chart(self.coefficients)
            if chart is None:
                raise InputError(
                    f"the fit of '{self.model.name}' has no free coefficient to plot; name one of its runs"
                )
            return matplotlib_figure(chart)
        by_name = {p.record: p for p in self.predictions}
        if record not in by_name:
            raise InputError(f"the fit has no run '{record}'{spelling_hint(record, list(by_name))}")
        length = self.ship.particulars.get("L", 0.0)
        return matplotlib_figure(prediction_chart(by_name[record], length, self.model.input_names))
