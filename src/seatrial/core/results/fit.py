"""A fit: a solution read in the field's terms, what the records identify, draws, searches; all that a report shows."""

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Annotated

from pydantic import Field, computed_field

from seatrial.core.results.coefficients import (
    CandidateModel,
    Coefficient,
    Method,
    Noise,
    NoiseModel,
    Offset,
    OffsetPopulation,
    Residuals,
    at_level,
)
from seatrial.core.results.fields import (
    ListedArray,
    NamedModel,
    Number,
    ReportedFinding,
    StoredArray,
    StoredRecord,
    StoredSolution,
    Summarised,
    Summary,
)
from seatrial.core.results.prediction import Baseline, IntervalBasis, KStepErrors, Prediction, sensor_errors
from seatrial.core.results.published_method import ReferenceEstimate, Search
from seatrial.core.results.ship_motions import FrequencyResponse, RollCharacteristics, Seakeeping, ThrusterCraft
from seatrial.core.results.term_selection import TermSelection
from seatrial.core.text.numbers import exact
from seatrial.core.values import InputError, Record, Ship, spelling_hint

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure


# What the records identify of a model and what they do not, in numbers and in sentences.

NOT_CONVERGED, SIGN_OPEN = "not-converged", "sign-open"
"""Codes of the findings that coefficients must not be used, or some of them not alone."""
COURSE_UNSTABLE = "course-unstable"
"""Code of the finding that a craft does not hold a straight course by itself."""


@dataclass(frozen=True)
class Symmetry:
    """A change of parameters that no record of the compared outputs can show, whatever the manoeuvre."""

    parameters: Annotated[tuple[str, ...], Field(description="those involved, free and fixed")]
    text: Annotated[str, Field(description="in a sentence, with what to fix")]
    change: Annotated[
        dict[str, Number],
        Field(description="parameter -> relative change for a unit step; absolute where the value is zero"),
    ]


@dataclass(frozen=True)
class Direction:
    """One combination of free coefficients with an independent error (eigen-direction of the Fisher information)."""

    combination: Annotated[
        dict[str, Number], Field(description="parameter -> part of a unit vector of relative changes, largest first")
    ]
    standard_deviation: Annotated[
        Number, Field(description="of the relative change along it, 1: 100 %; null: no information at all")
    ]
    text: str


@dataclass(frozen=True)
class Collinearity:
    """How far one coefficient can be replaced by others, and by which most."""

    parameter: str
    variance_inflation: Annotated[Number, Field(description="factor; null: without limit")]
    partner: Annotated[str, Field(description="the most correlated other coefficient")]
    correlation: Annotated[Number, Field(description="with the partner, -1 to 1")]


@dataclass(frozen=True)
class Sensitivity:
    """Change of the compared outputs (rms, in units of their noise) for 10 % of a coefficient."""

    parameter: str
    effect: Annotated[Number, Field(description="over all outputs together")]
    outputs: Annotated[dict[str, Number], Field(description="output -> its own change")]


@dataclass(frozen=True)
class Consequence:
    """What a wrong assumed value would do to the estimates."""

    parameter: Annotated[str, Field(description="the fixed one")]
    change: Annotated[Number, Field(description="relative")]
    estimate_changes: Annotated[
        dict[str, Number], Field(description="free coefficient -> relative change of its estimate, largest first")
    ]
    misfit: Annotated[Number, Field(description="increase of chi squared by which the records would show it")]
    text: str


@dataclass(frozen=True)
class Stability:
    """Course stability on a straight course; intervals are at 95 %."""

    index: Annotated[Number, Field(description="stability index C, positive: stable")]
    lower: Number
    upper: Number
    text: str
    speed: Annotated[Number | None, Field(description="ahead, m/s; null: not stated")] = None
    growth_rate: Annotated[
        Number | None,
        Field(description="largest real part of the eigenvalues of sway and yaw, 1/s; positive: a deviation grows"),
    ] = None
    growth_lower: Annotated[Number | None, Field(description="end of its interval, 1/s")] = None
    growth_upper: Annotated[Number | None, Field(description="end of its interval, 1/s")] = None
    stable_below: Annotated[
        Number | None, Field(description="speed below which an unstable craft is stable, m/s; null: none in the runs")
    ] = None

    @property
    def is_unstable(self) -> bool:
        """Whether a deviation grows beyond doubt: the whole interval of its rate lies above zero, or C's below.

        C is the product of two rates, and the one that decides may be well known where the other is not.
        """
        return self.upper < 0.0 or (self.growth_lower is not None and self.growth_lower > 0.0)

    @property
    def is_stable(self) -> bool:
        """Whether a deviation dies out beyond doubt: the whole interval of its rate lies below zero."""
        return self.growth_upper is not None and self.growth_upper < 0.0


@dataclass(frozen=True)
class Profile:
    """Profile likelihood of one coefficient: the others are fitted again at each value."""

    parameter: str
    values: Annotated[tuple[Number, ...], Field(description="SI")]
    costs: Annotated[
        tuple[Number, ...],
        Field(description="twice the loss above its minimum: chi squared, one degree of freedom"),
    ]
    lower: Annotated[Number | None, Field(description="where the cost passes 3.84 (95 %); null: not within the values")]
    upper: Annotated[Number | None, Field(description="as `lower`")]


@dataclass(frozen=True)
class Identifiability:
    """What the records identify, together."""

    structural: Annotated[tuple[Symmetry, ...], Field(description="changes that no record can show")]
    directions: Annotated[tuple[Direction, ...], Field(description="weakest first")]
    effective_parameters: Annotated[
        Number,
        Field(description="number of coefficients that the data determine (trace of information over it with prior)"),
    ]
    condition: Annotated[
        Number, Field(description="condition number of the information scaled to unit diagonal; null: singular")
    ]
    collinearity: tuple[Collinearity, ...] = ()
    sensitivities: tuple[Sensitivity, ...] = ()
    consequences: tuple[Consequence, ...] = ()
    stability: Annotated[Stability | None, Field(description="null: not known")] = None
    profiles: tuple[Profile, ...] = ()


# Draws from what records and priors leave open: credible intervals, and how far the draws can be trusted.


@dataclass(frozen=True)
class CredibleInterval:
    """One coefficient as the draws have it, next to the interval that the fit would have without them, both at 95 %."""

    name: str
    unit: Annotated[str, Field(description="SI; 1 for a number, in the prime system of the model's source")]
    mean: Annotated[Number, Field(description="of the draws")]
    standard_deviation: Annotated[Number, Field(description="of the draws")]
    lower: Annotated[Number, Field(description="2.5 % quantile of the draws")]
    upper: Annotated[Number, Field(description="97.5 % quantile of the draws")]
    other_lower: Annotated[Number, Field(description="lower end by `other_intervals`")]
    other_upper: Annotated[Number, Field(description="as `other_lower`")]
    r_hat: Annotated[Number, Field(description="split R-hat (Vehtari et al. 2021): 1 where the chains agree")]
    effective_size: Annotated[Number, Field(description="independent draws that the draws are worth")]


@dataclass(frozen=True, eq=False)
class Posterior:
    """Draws of the free coefficients, those of sessions and disturbances marginalised."""

    coefficients: tuple[CredibleInterval, ...]
    points: Annotated[StoredArray, Field(description="shape (chains, draws, coefficients), SI; also in posterior.npz")]
    log_density: Annotated[StoredArray, Field(description="shape (chains, draws), up to a constant")]
    tempering: Annotated[
        dict[str, Number],
        Field(description="channel -> correlated samples that count as one; empty: all count in full"),
    ]
    other_intervals: Annotated[str, Field(description="method of the intervals that stand next to the credible ones")]
    acceptance: Annotated[Number, Field(description="share of the proposals that were taken")]
    is_converged: Annotated[bool, Field(description="R-hat at most 1.01 and 400 independent draws of each unknown")]
    is_interrupted: Annotated[bool, Field(description="whether a user ended the draws early")] = False

    @property
    def sentences(self) -> tuple[str, ...]:
        """Return how much was drawn, whether the chains agree, and what counted for less, as sentences."""
        chains, draws = self.points.shape[:2]
        fewest, worst = min(c.effective_size for c in self.coefficients), max(c.r_hat for c in self.coefficients)
        agree = "agree" if self.is_converged else "do not agree" if not self.is_interrupted else "were interrupted"
        sampled = (
            f"Sampling: {chains} chains of {draws} draws {agree}: R-hat at most {worst:.3f}, at least {fewest:.0f} "
            f"independent draws of each coefficient; {100.0 * self.acceptance:.0f} % of the proposals were taken."
        )
        if not self.tempering:
            return (sampled,)
        counted = ", ".join(f"{exact(many, 2)} of {name}" for name, many in self.tempering.items())
        return sampled, f"Residuals are correlated; so many samples count as one: {counted}."


# Searches from several starting points, and where each ended.


@dataclass(frozen=True)
class SearchAttempt:
    """One short search; losses are negative log-likelihoods, the noise of each channel at its residuals' own."""

    origin: Annotated[str, Field(description="where it started")]
    start_loss: Annotated[Number, Field(description="at its start, above the lowest end of all; null: diverges there")]
    loss: Annotated[Number, Field(description="at its end, above the lowest end of all; null: no finite one")]
    evaluations: Annotated[int, Field(description="of the residuals")]
    values: Annotated[dict[str, Number], Field(description="coefficient -> SI, at its end")]
    is_used: Annotated[bool, Field(description="whether the estimate goes on from its end")]


# A fit: a solution read in the field's terms, with everything a report shows.


@dataclass(frozen=True, eq=False, repr=False)
class Fit(Summarised):
    """An estimated model with everything a report shows.

    `ship`, `covariance` (of the free coefficients in the order of `model.parameters.free_names`, shape (n, n), with
    the fixed values as they stand, while intervals of coefficients hold what estimated ones may be wrong by) and
    `interval_basis` (what intervals of further predictions are made of) are kept in model.toml.
    """

    question: Annotated[str, Field(description="one sentence")]
    ship: Annotated[Ship, Field(exclude=True)]
    model: Annotated[NamedModel, Field(description="name of the model; its estimated values stand in model.toml")]
    coefficients: tuple[Coefficient, ...]
    covariance: Annotated[ListedArray, Field(exclude=True)]
    solution: StoredSolution
    method: Method
    offsets: tuple[Offset, ...]
    channel_noise: Annotated[tuple[Noise, ...], Field(description="of the training residuals")]
    residuals: tuple[Residuals, ...]
    predictions: Annotated[tuple[Prediction, ...], Field(description="all runs, training and validation")]
    findings: tuple[ReportedFinding, ...]
    records: Annotated[tuple[StoredRecord, ...], Field(description="training and validation records as used")]
    seed: int
    elapsed_s: float
    versions: Annotated[dict[str, str], Field(description="package -> version")]
    identifiability: Annotated[Identifiability | None, Field(description="null: not examined")] = None
    noise_model: Annotated[NoiseModel | None, Field(description="null: not examined")] = None
    candidate_models: Annotated[
        tuple[CandidateModel, ...],
        Field(description="models compared over complete runs left out; empty: none declared"),
    ] = ()
    interval_basis: Annotated[IntervalBasis | None, Field(exclude=True)] = None
    seakeeping: Annotated[
        Seakeeping | None, Field(description="the ship in the waves of its trial; null: none known")
    ] = None
    baselines: Annotated[
        tuple[Baseline, ...],
        Field(description="other estimators on the same records, the fit itself first; empty: not compared"),
    ] = ()
    roll: Annotated[
        RollCharacteristics | None, Field(description="meaning of a roll model's coefficients; null: another model")
    ] = None
    thruster_craft: Annotated[
        ThrusterCraft | None,
        Field(description="a craft with thrusters in the terms of those who steer it; null: another model"),
    ] = None
    search: Annotated[Search | None, Field(description="what a published search did; null: the estimate is none")] = (
        None
    )
    search_attempts: Annotated[
        tuple[SearchAttempt, ...],
        Field(description="short searches from several starting points, the best first; empty: one start"),
    ] = ()
    reference: Annotated[
        ReferenceEstimate | None,
        Field(description="the package's own estimate beside a published method; null: this is it, or it was left out"),
    ] = None

    posterior: Annotated[
        Posterior | None, Field(description="draws from what records and priors leave open; null: not sampled")
    ] = None
    k_step_errors: Annotated[
        tuple[KStepErrors, ...],
        Field(description="errors so many samples ahead; empty: not computed, or samples too far apart for a filter"),
    ] = ()
    frequency_responses: Annotated[
        tuple[FrequencyResponse, ...],
        Field(description="of outputs to inputs, records and model; empty: no input moves, or runs too short"),
    ] = ()

    term_selection: Annotated[
        TermSelection | None,
        Field(description="Lasso's choice of terms beside the package's own; null: not compared, or no state shown"),
    ] = None
    offset_populations: Annotated[
        tuple[OffsetPopulation, ...], Field(description="each kind of offset over sessions; empty: no offsets")
    ] = ()

    @computed_field(description="the predictions of runs that were not fitted")
    @property
    def validation(self) -> tuple[Prediction, ...]:
        """Return the predictions of runs that were not fitted."""
        return tuple(p for p in self.predictions if p.role == "validation")

    @property
    def sensor_errors(self) -> dict[str, float]:
        """Return the errors that a perfect model would show, by the sensors' noise; empty where none is estimated."""
        return {} if self.noise_model is None else sensor_errors(self.noise_model.measurement)

    @computed_field(description="method of the intervals")
    @property
    def intervals(self) -> str:
        """Return the method by which the intervals of the coefficients were found."""
        return self.method.intervals

    @property
    def params(self) -> dict[str, float]:
        """Return the estimate of each free coefficient, SI."""
        return {c.name: c.estimate for c in self.coefficients if not c.fixed}

    def __getitem__(self, name: str) -> Coefficient:
        """Return the coefficient of that name, free or fixed.

        Raises:
            InputError: the model has no such coefficient; the nearest is named.
        """
        by_name = {c.name: c for c in self.coefficients}
        if name not in by_name:
            raise InputError(f"the fit has no coefficient '{name}'{spelling_hint(name, list(by_name))}")
        return by_name[name]

    def to_dataframe(self) -> "pandas.DataFrame":
        """Return the coefficients as a table: a row for each, indexed by name; 95 % intervals, SI."""
        import pandas

        return pandas.DataFrame([asdict(c) for c in self.coefficients]).set_index("name")

    def conf_int(self, level: float = 0.95) -> "pandas.DataFrame":
        """Return the interval of each free coefficient: columns lower and upper, indexed by name, SI.

        Args:
            level: probability, 0 to 1; other levels than 0.95 widen or narrow each side of the 95 % interval by the
                ratio of the quantiles of Student's t.

        Raises:
            InputError: `level` is not between 0 and 1.
        """
        import pandas

        degrees = self.interval_basis.degrees_of_freedom if self.interval_basis else float("inf")
        free = [c for c in self.coefficients if not c.fixed]
        rows = [at_level(c, level, degrees) for c in free]
        return pandas.DataFrame(
            rows, columns=["lower", "upper"], index=pandas.Index([c.name for c in free], name="name")
        )

    def predict(self, record: Record) -> Record:
        """Return the fitted model's response to the inputs of a record, on the record's time base.

        It starts at the record's first sample; offsets of sensors are not added.

        Raises:
            InputError: an input channel is missing, the time base is uneven, or the simulation diverges.
        """
        from seatrial.physics.simulate import replay

        return replay(self.model, record)

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

    def summary(self) -> Summary:
        """Return the free coefficients with their standard errors and 95 % intervals as a table."""
        free = [c for c in self.coefficients if not c.fixed]
        rows = tuple(
            (c.name, c.unit, f"{c.estimate:.5g}", _number(c.standard_error, 2), _number(c.lower), _number(c.upper))
            for c in free
        )
        facts = {
            "ship": self.ship.name, "criterion": self.method.criterion, "intervals": self.intervals,
            "coefficients": f"{len(free)} free, {len(self.coefficients) - len(free)} fixed",
            "runs": f"{len(self.records)}, of these {len(self.validation)} for validation",
            "search": self.search.effort if self.search else self.solution.status.value,
        }  # fmt: skip
        header = ("coefficient", "unit", "estimate", "std. error", "lower 95 %", "upper 95 %")
        return Summary(f"Fit of model {self.model.name}", header, rows, facts)


def _number(value: float | None, digits: int = 5) -> str:  # significant digits, chosen
    return "" if value is None else f"{value:.{digits}g}"
