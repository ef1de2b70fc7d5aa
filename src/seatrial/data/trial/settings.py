"""Settings of estimator, search, comparison, proposal and stream: tables of a trial file, values in Python."""

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Self

from pydantic import AfterValidator, BeforeValidator, Field, InstanceOf, model_validator
from pydantic.dataclasses import dataclass as pydantic_dataclass

from seatrial.core.values import InputError, spelling_hint
from seatrial.data.read import Layout
from seatrial.data.trial.amounts import STRICT_FIELDS, DelayDeviation, Deviation, raises_input_error
from seatrial.physics.sea.spectrum import WaveEncounter

# Lengths of the windows in which validation runs are predicted: of a trial file's `windows` and of `--windows`.


@dataclass(frozen=True)
class WindowLength:
    """Length of a window; `unit`: s, or L for the time of a ship length at the run's speed."""

    value: float
    unit: str

    def __str__(self) -> str:
        return f"{self.value:g} {self.unit}"


def window_lengths(text: str) -> tuple[WindowLength, ...]:
    """Return the lengths that a text such as ``10s,5L`` names.

    Raises:
        InputError: a part is no positive number with s or L.
    """
    lengths = []
    for part in filter(None, (p.strip() for p in text.split(","))):
        match = re.fullmatch(r"(\d+\.?\d*|\.\d+)\s*([sL])", part)
        if match is None or not float(match[1]) > 0.0:
            raise InputError(f"windows: '{part}' is no length of a window; write seconds or ship lengths, as 10s,5L")
        lengths.append(WindowLength(float(match[1]), match[2]))
    return tuple(lengths)


# Methods of estimation by the names that trial files and the command line have for them.


class FitCriterion(StrEnum):
    """What the package's own estimate minimises; `auto` is the decision table's choice."""

    AUTO = "auto"
    OUTPUT_ERROR = "output-error"
    MULTIPLE_SHOOTING = "multiple-shooting"
    PREDICTION_ERROR = "prediction-error"


class EstimateMethod(StrEnum):
    """The package's own criteria, searches by a population, and regressions."""

    AUTO = "auto"
    OUTPUT_ERROR = "output-error"
    MULTIPLE_SHOOTING = "multiple-shooting"
    PREDICTION_ERROR = "prediction-error"

    PSO = "pso"
    WHO = "who"
    IWHO = "iwho"
    ICPSO = "icpso"
    DE = "de"
    CMA_ES = "cma-es"

    EULER = "euler"
    EULER_DIFFERENCED = "euler-differenced"
    EULER_CENTRED = "euler-centred"
    OLS = "ols"
    RIDGE = "ridge"
    TSVD = "tsvd"
    LASSO = "lasso"
    LS_SVM = "ls-svm"
    SVR = "svr"
    SMOOTHED = "smoothed"
    WEAK_FORM = "weak-form"
    WEAK_FORM_RIDGE = "weak-form-ridge"
    SONG2025 = "song2025"
    SONG2025_IMPROVED = "song2025-improved"
    INSTRUMENTAL_VARIABLES = "iv"

    @property
    def criterion(self) -> FitCriterion:
        """Return what the package's own estimate minimises, which a published method is compared with."""
        return FitCriterion.AUTO if self.is_published else FitCriterion(self.value)

    @property
    def is_search(self) -> bool:
        """Whether a population searches a box of coefficients."""
        return self in SEARCHES

    @property
    def is_published(self) -> bool:
        """Whether the estimate is not the package's own."""
        return self.value not in [criterion.value for criterion in FitCriterion]


SEARCHES = (
    EstimateMethod.PSO, EstimateMethod.WHO, EstimateMethod.IWHO, EstimateMethod.ICPSO, EstimateMethod.DE,
    EstimateMethod.CMA_ES,
)  # fmt: skip
"""Methods in which a population searches a box of coefficients."""


def method_named(name: object) -> object:
    """Return the method of that name, for a validator: what is no text is passed on.

    Raises:
        InputError: there is no such method; the nearest is named.
    """
    if not isinstance(name, str):
        return name
    names = [method.value for method in EstimateMethod]
    if name not in names:
        raise InputError(f"unknown method '{name}'{spelling_hint(name, names)}")
    return EstimateMethod(name)


class OwnEstimate(StrEnum):
    """When the package's own estimate is made of records that a published method estimates from.

    FIRST: before the method, which takes the initial states of the runs from it.
    AFTER: behind the method, which takes them from the records.
    NONE: not at all; the method alone stands in the result.
    """

    FIRST = "first"
    AFTER = "after"
    NONE = "none"


# Settings of a search by a population: a table of a trial file, a value in Python.


class SearchFitness(StrEnum):
    """What one iteration of a search judges candidates by."""

    RECORD = "record"
    SAMPLE = "sample"


@raises_input_error
@pydantic_dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class SearchSettings:
    """`[estimate.search]`: a search by a population; what is not given is as the method's source has it.

    Attributes:
        population: points of one iteration.
        iterations: populations judged, the first included.
        fitness: the whole record, or one sample in each iteration (Qi et al. 2025, eq. (28)).
        restarts: searches with random numbers of their own, at least 1.
        bounds: coefficient -> ends of its range, SI; those of `[model.bounds]` where it is not named.
        constants: of the method, in the notation of its source, as ``P_S``; those of the source where not named.
    """

    population: Annotated[int, Field(ge=1)] | None = None
    iterations: Annotated[int, Field(ge=1)] | None = None
    fitness: SearchFitness = SearchFitness.RECORD
    restarts: Annotated[int, Field(ge=1)] = 3
    bounds: Mapping[str, tuple[float, float]] = Field(default_factory=dict)
    constants: Mapping[str, float] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _ends_in_order(self) -> Self:
        for name, (lower, upper) in self.bounds.items():
            if not lower < upper:
                raise ValueError(
                    f"the bounds of {name} run from {lower:g} to {upper:g}; write {name} = [{upper:g}, {lower:g}]"
                    if lower > upper
                    else f"both bounds of {name} are {lower:g}; widen them, or fix {name} under [model]"
                )
        return self


# Settings of the regressions that `--compare` sets beside a fit: tables of a trial file, values in Python.

Positive = Annotated[float, Field(gt=0)]


@raises_input_error
@pydantic_dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class SupportVectorSettings:
    """`[compare.svr]`: the pipeline of Song et al. 2025, clean, split, select by Lasso, regress by support vectors.

    C, epsilon and thresholds are not printed there; their defaults are ours.

    Attributes:
        C: penalty of what lies outside the tube, eq. (19).
        epsilon: half width of the tube in standard deviations of the target.
        outlier_score: largest standard score that stays, eq. (5); 0 keeps all samples.
        small_share: least absolute value that stays, as a share of each velocity's standard deviation, eq. (8).
        folds: contiguous folds of Lasso's cross-validation.
        lambda_: smallest and largest penalty of Lasso, eq. (12).
        test_share: share of each record, its end, that is kept for testing, eq. (9).
        ablation: whether the pipeline is repeated with each of its steps left out.
    """

    C: Positive = 1.0
    epsilon: Annotated[float, Field(ge=0)] = 0.1
    outlier_score: Annotated[float, Field(ge=0)] = 3.0
    small_share: Annotated[float, Field(ge=0)] = 1e-3
    folds: Annotated[int, Field(ge=2)] = 10
    lambda_: Annotated[tuple[Positive, Positive], Field(alias="lambda")] = (1e-6, 1e6)
    test_share: Annotated[float, Field(gt=0, lt=1)] = 0.2
    ablation: bool = False

    @model_validator(mode="after")
    def _penalties_in_order(self) -> Self:
        if self.lambda_[0] >= self.lambda_[1]:
            low, high = self.lambda_
            raise ValueError(f"lambda runs from {low:g} to {high:g}; give the smaller first")
        return self


@raises_input_error
@pydantic_dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class CompareSettings:
    """`[compare]`: settings of the regressions that `--compare` sets beside the fit.

    Attributes:
        svr: of the pipeline of Song et al. 2025.
    """

    svr: SupportVectorSettings = Field(default_factory=SupportVectorSettings)


# Settings of the estimator and of the comparison of models: tables of a trial file, values in Python.


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


Method = Annotated[EstimateMethod, BeforeValidator(method_named)]
Deviations = Annotated[Mapping[str, Deviation], BeforeValidator(_as_deviations)]
DelayDeviations = Annotated[Mapping[str, DelayDeviation], BeforeValidator(_as_deviations)]


@raises_input_error
@pydantic_dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class EstimateSettings:
    """`[estimate]`: settings of the estimator; what is not given follows the decision table.

    Attributes:
        method: the package's own criteria, or a published method, which is compared with the package's own estimate.
        search: settings of a search by a population; None: those of the method's source.
        own_estimate: when the package's own estimate is made beside a published method.
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
    own_estimate: OwnEstimate = OwnEstimate.FIRST
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
@pydantic_dataclass(frozen=True, config=STRICT_FIELDS)
class ModelFamily:
    """`[family]`: models to compare on runs left out of the fit.

    Attributes:
        structures: name -> parameters that the structure frees beyond the trial's own.
    """

    structures: Mapping[str, tuple[str, ...]] = Field(default_factory=dict)


# The table `[proposal]` of a trial file: for which loop gains are proposed while a stream is followed.


@raises_input_error
@pydantic_dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class ProposalSettings:
    """`[proposal]`: gains proposed for what the stream shows: the sea and roll, or the coefficients of the moment.

    Attributes:
        loop: the loop file that was tuned.
        gains: the ``gains.toml`` of its tuning; of a roll stabiliser with a schedule.
        stretch_s: length of the stretch at one speed and heading that a proposal rests on [s].
        every_s: s of the stream between two proposals.
    """

    loop: Path
    gains: Path
    stretch_s: Positive = 1200.0
    every_s: Positive = 300.0


# A stream of samples and how it is followed: the keys of the table `[follow]`, and a `Stream` in Python.


class StreamSource(StrEnum):
    """Where samples come from: lines of columns, NMEA 0183 sentences, messages of a bus or an autopilot."""

    FILE = "file"
    STDIN = "stdin"
    UDP = "udp"
    NMEA_FILE = "nmea-file"
    NMEA_STDIN = "nmea-stdin"
    NMEA_UDP = "nmea-udp"
    NMEA2000_UDP = "nmea2000-udp"
    MAVLINK_UDP = "mavlink-udp"


@pydantic_dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class StreamSettings:
    """Where samples come from while the record is being made, and how they are followed.

    Attributes:
        source: lines of a growing file, of standard input or of UDP datagrams, or NMEA 0183 sentences from them; NMEA
            2000 as text and MAVLink in UDP datagrams.
        rate: nominal rate of the samples [Hz].
        file: of a source that is a file.
        host, port: on which UDP is listened to.
        batch_window_s: time over which the batch criterion is kept [s].
        forgetting_time_s: time after which the past counts 1/e [s]; None: it counts for ever.
        page: port of the page on this machine, which `--page` overrides; 0: none.
        journal: file in which admitted samples are kept, relative to the trial file, which `--journal` overrides;
            None: beside the result.
    """

    source: StreamSource
    rate: Positive
    file: Path | None = None
    host: str = "127.0.0.1"
    port: Annotated[int, Field(ge=1, le=65535)] | None = None
    batch_window_s: Positive = 3600.0
    forgetting_time_s: Positive | None = None
    page: Annotated[int, Field(ge=0, le=65535)] = 0
    journal: Path | None = None

    @model_validator(mode="after")
    def _place_where_needed(self) -> Self:
        if self.source.endswith("file") and self.file is None:
            raise ValueError(f"source = '{self.source}' needs a file; add it")
        if self.source.endswith("udp") and self.port is None:
            raise ValueError(f"source = '{self.source}' needs a port; add it")
        return self


@raises_input_error
@pydantic_dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class Stream(StreamSettings):
    """Samples that come while the record is being made, with the layout of their columns.

    Attributes:
        layout: which column is what.
        name: of the runs it makes, as the stem of a file names a record's.
        waves: how the ship meets them, for an elevation in the stream.
    """

    layout: InstanceOf[Layout]
    name: str = "stream"
    waves: InstanceOf[WaveEncounter] | None = None

    def with_differences(self, symbols: Collection[str]) -> Self:
        """Return the stream with what twins differ by as channels, where that is among these symbols."""
        return replace(self, layout=self.layout.with_differences(symbols))
