"""Settings of the estimator and of the comparison of models: tables of a trial file, values in Python."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Annotated, Self

from pydantic import AfterValidator, BeforeValidator, Field, model_validator
from pydantic.dataclasses import dataclass

from seatrial.core.values import InputError
from seatrial.data.trial.amounts import STRICT_FIELDS, DelayDeviation, Deviation
from seatrial.data.trial.estimate_method import EstimateMethod, FitCriterion, method_named
from seatrial.data.trial.schema_errors import raises_input_error
from seatrial.data.trial.search_settings import SearchSettings
from seatrial.data.trial.window_lengths import window_lengths


def _as_deviations(value: object) -> object:
    """Names alone have the estimator's own priors."""
    return dict.fromkeys(value) if isinstance(value, list | tuple) else value


def _checked_windows(value: str) -> str:
    """Lengths that can be read."""
    try:
        window_lengths(value)
    except InputError as error:
        raise ValueError(str(error)) from None
    return value


Positive = Annotated[float, Field(gt=0)]
Method = Annotated[EstimateMethod, BeforeValidator(method_named)]
Deviations = Annotated[Mapping[str, Deviation], BeforeValidator(_as_deviations)]
DelayDeviations = Annotated[Mapping[str, DelayDeviation], BeforeValidator(_as_deviations)]


@raises_input_error
@dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class EstimateSettings:
    """`[estimate]`: settings of the estimator; what is not given follows the decision table.

    Attributes:
        method: the package's own criteria, or a published method, which is compared with the package's own estimate.
        search: settings of a search by a population; None: those of the method's source.
        channels: observables that are fitted; empty: all that the records measure.
        segment_s: length of a multiple-shooting segment [s].
        segment_lengths: the same in ship lengths travelled at the median speed of the runs.
        rate: Hz at which records are resampled; None keeps their own.
        robust: whether the loss is Huber's.
        offsets: channel -> prior standard deviation (SI, None: the estimator's own) of its zero, one for each session.
        covariates: channel of `offsets` -> input on whose rms over a session its zero may depend, linearly.
        gains: channel -> prior standard deviation (None: the estimator's own) of its gain, one for each session.
        delays: input -> prior standard deviation [s] (None: the estimator's own) of its delay, one for each session; 0:
            its timing is known. Inputs that are not named are taken to be uncertain by their source's sample interval.
            A measured channel (psi, r, x0, y0) -> standard deviation [s] of its lag, likewise.
        current: prior standard deviation of a uniform current in each run [m/s]; 0: none is estimated.
        starts: points from which to search; None: 6 for craft with thrusters, else one.
        initial_s: s of a validation run from which its initial state is estimated; None: L/U.
        offsets_from_start: whether these seconds of a run of a new session move what is expected of its offsets, too.
        windows: in which validation runs are predicted, by the longest of which the fit is judged, as ``10s,5L``;
            empty: by the length of the run.
    """

    method: Method = EstimateMethod.AUTO
    search: SearchSettings | None = None
    channels: tuple[str, ...] = ()
    segment_s: Positive | None = None
    segment_lengths: Positive | None = None
    rate: Positive | None = None
    robust: bool = False
    offsets: Deviations = Field(default_factory=dict)
    covariates: Mapping[str, str] = Field(default_factory=dict)
    gains: Deviations = Field(default_factory=dict)
    delays: DelayDeviations = Field(default_factory=dict)
    current: Annotated[float, Field(ge=0)] = 0.0
    starts: Annotated[int, Field(ge=1, le=100)] | None = None
    initial_s: Positive | None = None
    offsets_from_start: bool = False
    windows: Annotated[str, AfterValidator(_checked_windows)] = ""

    @property
    def criterion(self) -> FitCriterion:
        """Return what the package's own estimate minimises."""
        return self.method.criterion

    def with_known_timing(self, inputs: Iterable[str]) -> "EstimateSettings":
        """Return these settings with no delay of these inputs, but for those that the settings name."""
        return replace(self, delays={**dict.fromkeys(inputs, 0.0), **self.delays})

    def with_method(self, name: str) -> "EstimateSettings":
        """Return these settings with the method of that name.

        Raises:
            InputError: there is no such method; the nearest is named.
        """
        method_named(name)
        return replace(self, method=EstimateMethod(name))

    @model_validator(mode="after")
    def _covariates_of_offsets(self) -> Self:
        for name in self.covariates:
            if name not in self.offsets:
                raise ValueError(f"covariates: '{name}' is not under offsets; add it there, or take it out here")
        return self

    @model_validator(mode="after")
    def _one_segment_length(self) -> Self:
        if self.segment_s is not None and self.segment_lengths is not None:
            raise ValueError("segment_s and segment_lengths are both given; keep one")
        return self


@raises_input_error
@dataclass(frozen=True, config=STRICT_FIELDS)
class ModelFamily:
    """`[family]`: models to compare on runs left out of the fit.

    Attributes:
        structures: name -> parameters that the structure frees beyond the trial's own.
        prior_factors: factors on the widths of all priors; segment_factors: on the length of segments.
    """

    structures: Mapping[str, tuple[str, ...]] = Field(default_factory=dict)
    prior_factors: tuple[Positive, ...] = ()
    segment_factors: tuple[Positive, ...] = ()
