"""A fit: a solution read in the field's terms, with everything a report shows."""

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
from seatrial.core.results.fields import ListedArray, NamedModel, ReportedFinding, StoredRecord, StoredSolution
from seatrial.core.results.frequency_response import FrequencyResponse
from seatrial.core.results.identifiability import Identifiability
from seatrial.core.results.k_step import KStepErrors
from seatrial.core.results.posterior import Posterior
from seatrial.core.results.prediction import Baseline, IntervalBasis, Prediction
from seatrial.core.results.published_method import ReferenceEstimate, Search
from seatrial.core.results.search_attempts import SearchAttempt
from seatrial.core.results.ship_motions import RollCharacteristics, Seakeeping
from seatrial.core.results.summary import Summarised, Summary
from seatrial.core.results.thruster_craft import ThrusterCraft
from seatrial.core.values import InputError, Record, Ship, spelling_hint

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure


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
        Field(description="the package's own estimate, which a published method is compared with; null: this is it"),
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

    offset_populations: Annotated[
        tuple[OffsetPopulation, ...], Field(description="each kind of offset over sessions; empty: no offsets")
    ] = ()

    @computed_field(description="the predictions of runs that were not fitted")
    @property
    def validation(self) -> tuple[Prediction, ...]:
        """Return the predictions of runs that were not fitted."""
        return tuple(p for p in self.predictions if p.role == "validation")

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
