"""Runs simulated open loop and compared with their measurement, by the fit and by other estimators."""

from dataclasses import dataclass, field
from typing import Annotated

from pydantic import Field

from seatrial.core.results.fields import ListedArray, Number, ReportedFinding, StoredArray, StoredRecord
from seatrial.core.results.window_scores import WindowScore
from seatrial.core.values import RecordKind


@dataclass(frozen=True)
class Measure:
    """One manoeuvring measure, measured against simulated."""

    measured: Annotated[Number | None, Field(description="null: the record does not show it")]
    simulated: Annotated[Number | None, Field(description="null: the simulation does not show it")]
    lower: Annotated[
        Number | None, Field(description="95 % interval of the simulated value; null until a method defends it")
    ] = None
    upper: Annotated[Number | None, Field(description="as `lower`")] = None
    is_determined: Annotated[
        bool, Field(description="false: the records leave the simulated value open, its interval would say nothing")
    ] = True


@dataclass(frozen=True)
class Extrapolation:
    """How far a prediction leaves the training runs."""

    index: Annotated[Number, Field(description="largest of the ratios; up to 1 is interpolation")]
    ratios: Annotated[
        dict[str, Number],
        Field(
            description="yaw_rate, drift, rudder, fastest speed of the run over those of the training runs, and their "
            "slowest speed over the run's; command NAME ahead or astern, also by the direction of motion: 1 and the "
            "distance beyond the training runs as a share of the whole range; rudder to port or starboard: the same, "
            "as a share of their largest angle, where that side was used less"
        ),
    ]
    untrained_kind: Annotated[
        str,
        Field(description="kind of manoeuvre, as zigzag, that no training run shows; empty: none"),
    ] = ""


@dataclass(frozen=True)
class Divergence:
    """Where a simulated run leaves all bounds, and what drives it there; the run is scored up to that time."""

    time: Annotated[Number, Field(description="s on the record's clock, first sample that is not scored")]
    seconds: Annotated[Number, Field(description="s from the run's first sample that are scored")]
    state: Annotated[str, Field(description="the state that leaves its bounds first")]
    terms: Annotated[
        tuple[str, ...],
        Field(description="parameters whose terms in the state's equation drive it away, the strongest first"),
    ] = ()


@dataclass(frozen=True, eq=False)
class Prediction:
    """One run simulated open loop, compared with its measurement."""

    record: Annotated[str, Field(description="name of the run")]
    role: Annotated[str, Field(description="validation or training")]
    measured: StoredRecord
    simulated: StoredRecord
    rms: Annotated[
        dict[str, Number], Field(description="psi_deg, position_m, u and v (m/s), r (rad/s), as far as measured")
    ]
    measures: Annotated[
        dict[str, Measure],
        Field(description="such as overshoot_1_deg, advance_L; names end in _L (ship lengths), _deg or _s"),
    ]
    initial_seconds: Annotated[
        Number, Field(description="s of the start of the run from which the initial state was estimated")
    ]
    extrapolation: Annotated[Extrapolation | None, Field(description="null: not known")] = None
    half_width: Annotated[
        dict[str, StoredArray],
        Field(description="psi, x0, y0, phi, z, theta -> half width of its 95 % band at every sample, (n,), SI"),
    ] = field(default_factory=dict)
    noise_floor: Annotated[
        dict[str, Number],
        Field(
            description="rms errors, keys as in `rms`, that the process noise of the fit leaves by itself, model error "
            "in it; none above the error itself"
        ),
    ] = field(default_factory=dict)
    tied_spread: Annotated[
        dict[str, Number], Field(description="standard deviation over tied models, keys as in `measures` and `rms`")
    ] = field(default_factory=dict)
    divergence: Annotated[
        Divergence | None, Field(description="null: the simulation lasts as long as the run; else NaN follows it")
    ] = None
    offsets: Annotated[
        dict[str, Number],
        Field(
            description="offset of the run (delta zero; gain; delay, s) or parameter of its session -> value with "
            "which it was simulated, SI; empty: none"
        ),
    ] = field(default_factory=dict)
    session: Annotated[str, Field(description="with whose runs it shares its offsets; empty: not known")] = ""
    windows: Annotated[
        tuple[WindowScore, ...], Field(description="windows of the run, each predicted by itself; validation runs only")
    ] = ()

    @property
    def is_reference_simulated(self) -> bool:
        """Return whether the record that the run is compared with is itself a simulation."""
        return self.measured.kind is RecordKind.SIMULATED

    @property
    def reference_word(self) -> str:
        """Return what figures and tables call that record: ``measured``, or ``reference`` where it is simulated."""
        return "reference" if self.is_reference_simulated else "measured"

    @property
    def model_word(self) -> str:
        """Return what they call the model's run: ``simulated``, or ``model`` where the other one is simulated too."""
        return "model" if self.is_reference_simulated else "simulated"


@dataclass(frozen=True, eq=False)
class IntervalBasis:
    """What intervals of any further prediction of a fit are made of; kept in model.toml.

    Attributes:
        covariance: of the free coefficients, without the spread of tied models, shape (n, n).
        degrees_of_freedom: of Student's t.
        factor: multiplies a predicted standard deviation where no training run shows that kind of measure.
        measure_deviation: kind of measure -> standard deviation that is added, in its unit.
        offsets: offset (``delta zero``) -> standard deviation between sessions, SI; empty where one session alone was
            recorded, which shows nothing of it.
        process: state -> intensity of process noise, SI over the root of a second.
        training_envelope: what the training runs cover, SI (see `estimation.information.motion_envelope`).
        tied: parameter -> value of each tied model.
    """

    covariance: ListedArray
    degrees_of_freedom: float
    factor: float = 1.0
    measure_deviation: dict[str, float] = field(default_factory=dict)
    offsets: dict[str, float] = field(default_factory=dict)
    process: dict[str, float] = field(default_factory=dict)
    training_envelope: dict[str, float] = field(default_factory=dict)
    tied: tuple[dict[str, float], ...] = ()


NO_COMPARISON = "no-comparison"
"""Code of the finding that says why other estimators could not be compared."""


@dataclass(frozen=True)
class OpenLoopScores:
    """Runs simulated open loop, scored together; rms and correlation are empty where one diverges."""

    rms: Annotated[
        dict[str, Number], Field(description="keys as in `Prediction.rms`, root of the mean of squares over the runs")
    ] = field(default_factory=dict)
    correlation: Annotated[
        dict[str, Number], Field(description="u, v, r: Pearson's coefficient of measured and simulated, mean over runs")
    ] = field(default_factory=dict)
    diverged: Annotated[tuple[str, ...], Field(description="names of the runs whose simulation diverges")] = ()


@dataclass(frozen=True)
class RowScore:
    """Rows of one equation that were kept for testing, predicted by the regression."""

    rmse: Annotated[Number, Field(description="of the target, its unit")]
    correlation: Annotated[Number, Field(description="Pearson's coefficient of target and prediction")]
    explained: Annotated[Number, Field(description="1 - residual variance over variance, about the mean (R squared)")]
    rows: Annotated[int, Field(description="number of rows")]


@dataclass(frozen=True)
class Baseline:
    """An estimator on the records of a fit; first the fit itself, then, if it has any, without its offsets."""

    name: str
    values: Annotated[dict[str, Number], Field(description="coefficient -> SI; empty where the estimator failed")] = (
        field(default_factory=dict)
    )
    normalised_difference: Annotated[
        dict[str, Number], Field(description="coefficient -> difference from the fit's estimate in its standard errors")
    ] = field(default_factory=dict)
    error: Annotated[dict[str, Number], Field(description="relative, where the true value is known and not zero")] = (
        field(default_factory=dict)
    )
    training: Annotated[
        OpenLoopScores, Field(description="training runs with these values, from the initial states of the fit")
    ] = field(default_factory=OpenLoopScores)
    validation: Annotated[OpenLoopScores, Field(description="the same of the runs that were not fitted")] = field(
        default_factory=OpenLoopScores
    )
    bias: Annotated[
        dict[str, Number], Field(description="equation -> constant that the estimator allowed itself in addition")
    ] = field(default_factory=dict)
    test: Annotated[dict[str, RowScore], Field(description="equation -> score on rows kept for testing")] = field(
        default_factory=dict
    )
    findings: tuple[ReportedFinding, ...] = ()
    note: Annotated[str, Field(description="why the estimator failed; empty where it did not")] = ""
    is_fit: Annotated[bool, Field(description="whether these are the coefficients of the fit")] = False

    @property
    def diverged(self) -> tuple[str, ...]:
        """Return the names of all runs whose simulation diverges."""
        return (*self.training.diverged, *self.validation.diverged)

    def relative_deviation(self, fit: "Baseline") -> dict[str, float]:
        """Return the relative error of each coefficient where the truth is known, else its difference from the fit."""
        if fit.error:
            return self.error
        return {n: value / fit.values[n] - 1.0 for n, value in self.values.items() if fit.values.get(n)}
