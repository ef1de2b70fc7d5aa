"""The tables of a trial file: strict pydantic models; `seatrial.data.trial.amounts` words what they refuse."""

from collections.abc import Callable
from math import pi
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, model_validator
from pydantic.dataclasses import dataclass

from seatrial.core.values import InputError, si_unit
from seatrial.data.read.layout import TEXT_CLOCKS, Separator
from seatrial.data.read.registry import require_format
from seatrial.data.trial.amounts import (
    STRICT_FIELDS,
    Angle,
    Deviation,
    PositiveDuration,
    PositiveLength,
    SiAmount,
    Speed,
    StrictTable,
    Unit,
)
from seatrial.data.trial.craft_tables import Feedback, ThrusterTable
from seatrial.data.trial.design_request import DesignRequest
from seatrial.data.trial.run_data import valid_session
from seatrial.data.trial.settings import (
    CompareSettings,
    EstimateSettings,
    ModelFamily,
    ProposalSettings,
    StreamSettings,
)
from seatrial.physics.models.thruster_layout import Damping
from seatrial.physics.sea.spectrum import Spectrum, bretschneider, ittc, ittc_two_parameter, jonswap, sea_state
from seatrial.physics.sensors import Sensors

# A sea in a file: the spectrum by its name and what it needs.

_NEEDED = {"ittc": {"height"}, "sea-state": {"state"}}
_NEEDED_BY_OTHERS = {"height", "period"}


class SeaTable(StrictTable):
    """A spectrum.

    Attributes:
        spectrum: the ITTC's by the height alone (``ittc``) or with the mean period (``ittc2``); ``bretschneider``,
            ``jonswap`` by the peak period; ``sea-state`` of the WMO code.
        height: significant height.
        period: the mean T_1 of ``ittc2``, else that of the peak.
        gamma: peak enhancement of ``jonswap``.
        state: of ``sea-state``.
    """

    spectrum: Literal["ittc", "ittc2", "bretschneider", "jonswap", "sea-state"] = "ittc"
    height: PositiveLength | None = None
    period: PositiveDuration | None = None
    gamma: float = 3.3  # mean peak enhancement of JONSWAP, Hasselmann et al. 1973
    state: Annotated[int, Field(ge=0, le=9)] | None = None  # sea states of the WMO code

    @model_validator(mode="after")
    def _keys_of_the_spectrum(self) -> Self:
        needed = _NEEDED.get(self.spectrum, _NEEDED_BY_OTHERS)
        given = {key for key in ("height", "period", "state") if getattr(self, key) is not None}
        for key in sorted(needed - given):
            raise ValueError(f"spectrum '{self.spectrum}' needs a {key}")
        for key in sorted(given - needed):
            raise ValueError(f"spectrum '{self.spectrum}' has no {key}")
        return self

    def to_spectrum(self, where: str) -> Spectrum:
        """Return the spectrum; `where` is the key of the table, for messages.

        Raises:
            InputError: a sea state without waves, or a peak enhancement out of range.
        """
        height, period = self.height or 0.0, self.period or 0.0
        match self.spectrum:
            case "sea-state":
                return _with_key(where, lambda: sea_state(self.state or 0).spectrum())
            case "ittc":
                return ittc(height)
            case "ittc2":
                return ittc_two_parameter(height, period)
            case "bretschneider":
                return bretschneider(height, period)
            case "jonswap":
                return _with_key(f"{where}.gamma", lambda: jonswap(height, period, self.gamma))


def _with_key(where: str, make: Callable[[], Spectrum]) -> Spectrum:
    try:
        return make()
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def _as_tuple(value: object) -> object:
    return (value,) if isinstance(value, str) else value


def _valid_clock(unit: object) -> object:
    if isinstance(unit, str) and unit not in TEXT_CLOCKS:
        si_unit(unit)
    return unit


def _not_zero(value: float) -> float:
    if value == 0.0:
        raise ValueError("0 makes every number the same; give another")
    return value


NO_CHANNELS = "key 'channels' is missing; add it"
ClockUnit = Annotated[str, BeforeValidator(_valid_clock)]
NonZero = Annotated[float, AfterValidator(_not_zero)]
Strings = Annotated[tuple[str, ...], BeforeValidator(_as_tuple)]
Format = Annotated[str, AfterValidator(require_format)]
Bound = Annotated[float, Field(allow_inf_nan=True)]


class ShipTable(BaseModel):
    """`[ship]`: every key besides these is a particular by its symbol, a number in SI units or {value, unit}.

    Attributes:
        name: of the craft, in the report.
        source: citation of the particulars.
        scale: of a model; 45.7 for 1:45.7.
    """

    model_config = ConfigDict(extra="allow", frozen=True, allow_inf_nan=False, defer_build=True)

    name: str
    source: str = ""
    scale: Annotated[float, Field(gt=0)] = 1.0
    __pydantic_extra__: dict[str, SiAmount] = Field(init=False)  # type: ignore[assignment]

    @property
    def particulars(self) -> dict[str, float]:
        """Symbol -> value in SI units."""
        return {symbol: amount.in_si for symbol, amount in (self.__pydantic_extra__ or {}).items()}

    @property
    def units(self) -> dict[str, str]:
        """Symbol -> unit, of the particulars that state one."""
        return {symbol: amount.unit for symbol, amount in (self.__pydantic_extra__ or {}).items() if amount.unit}


class TimeColumn(StrictTable):
    """Where the time stands: header name, or number counted from 1; without one the log's own time stamps count.

    Attributes:
        column: without it: the log's own stamps.
        unit: of the numbers, or how date and time are written: ``utc``, ``hhmmss``, ``excel``.
        date: column that completes a time of day.
        nanoseconds: column that completes whole seconds.
        week: column that completes seconds of the GNSS week.
    """

    column: str | Annotated[int, Field(ge=1)] = ""
    unit: ClockUnit = "s"
    date: str | Annotated[int, Field(ge=1)] = ""
    nanoseconds: str | Annotated[int, Field(ge=1)] = ""
    week: str | Annotated[int, Field(ge=1)] = ""

    @model_validator(mode="after")
    def _one_complement(self) -> Self:
        if sum(part != "" for part in (self.date, self.nanoseconds, self.week)) > 1:
            raise ValueError("date, nanoseconds and week complete a time each in its own way; keep one")
        return self


class ChannelColumn(StrictTable):
    """Where a channel stands and what its numbers mean: (cell - zero) / span * scale + offset in its unit.

    Attributes:
        column: header name, or number counted from 1.
        unit: of its numbers.
        frame: without it: that of the notation; ``earth`` makes u, v the velocity north and east, ``enu`` axes to the
            east and north.
        positive: the side to which the column counts; without it: that of the notation.
        reference_point: of the sensor, m forward of midship.
        zero: reading at rest.
        span: reading from there to one.
        scale: factor behind the span.
        offset: added last.
        twin: column of the starboard one of two rudders, nozzles or shafts; the channel is half the sum.
        kind: who set it; a command is held until the next one. Without it: ``command`` for command_1, command_2 and so
            on, else ``measured``.
        between: how it runs between samples; without it: from the samples.
    """

    column: str | Annotated[int, Field(ge=1)]
    unit: Unit
    frame: Literal["body", "earth", "none", "enu"] | None = None
    positive: Literal["forward", "aft", "ahead", "astern", "starboard", "port", "north", "south", "east", "west",
                      "up", "down", "bow up", "bow down", "none"] | None = None  # fmt: skip
    reference_point: float = 0.0
    zero: float = 0.0
    span: NonZero = 1.0
    scale: NonZero = 1.0
    offset: float = 0.0
    twin: str | Annotated[int, Field(ge=1)] | None = None
    kind: Literal["command", "measured"] | None = None
    between: Literal["held", "straight"] | None = None


class DeclaredChannel(StrictTable):
    """`[channels.NAME]`: a channel that the notation table does not have, for models of one's own.

    Attributes:
        meaning: in words.
        unit: of its numbers.
        frame: ``body``, ``earth`` or ``none``.
        positive: direction in words.
        kind: a command is an order, and is never corrected.
        between: how it runs between samples.
    """

    meaning: str
    unit: Unit
    frame: Literal["body", "earth", "none"] = "none"
    positive: str = "none"
    kind: Literal["command", "measured"] = "measured"
    between: Literal["held", "straight"] | None = None


class WavesTable(StrictTable):
    """`[records.waves]`: how the ship met the waves, for `[excitation]`.

    Attributes:
        heading: to the waves; 0 following, 180 degrees head.
        speed: of the ship.
        sea: the spectrum, where neither the elevation nor the wave forces were recorded.
    """

    heading: Angle
    speed: Speed
    sea: SeaTable | None = None


@dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class ColumnsTable:
    """Where time and channels stand, in a file or in a stream.

    Attributes:
        header_lines: of a text file, above the names of its columns.
        encoding: of a text file.
        separator: of a text file; a comma that separates no cells is a decimal sign.
        time: column of the time, its unit and what completes it.
        channels: symbol -> its column, with unit, frame and sign.
    """

    header_lines: Annotated[int, Field(ge=0)] = 0
    encoding: str = "utf-8"
    separator: Separator = "auto"
    time: TimeColumn = TimeColumn()
    channels: dict[str, ChannelColumn] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _one_channel_a_column(self) -> Self:
        owner: dict[str | int, str] = {self.time.column: "time"}
        for symbol, channel in self.channels.items():
            for column in (channel.column, channel.twin):
                if column in owner:
                    raise ValueError(f"column {column!r} is named for '{owner[column]}' and '{symbol}'; keep one")
                if column is not None:
                    owner[column] = symbol
        return self


@dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class SourceTable(ColumnsTable):
    """`[[records.sources]]`: one file of a run, with its layout and clock.

    Attributes:
        file: under the folder of `[data]`.
        format: without it: by the first bytes, or the ending.
        clock_offset: s added to its stamps.
    """

    file: str
    format: Format | None = None
    clock_offset: float = 0.0


class PartTable(StrictTable):
    """A run cut out of a log.

    Attributes:
        name: of the run.
        file: that of several files out of which it is cut, by its name without the ending; a file of which no part is
            named stays whole. Without it the part is cut out of each.
        from_: time after the first sample (``"120 s"``), or name of an event (``"MODE AUTO"``); without it: the start.
        to: likewise; without it: the end.
    """

    name: str
    file: str = ""
    from_: str = Field("", alias="from")
    to: str = ""


class OriginTable(StrictTable):
    """Where the plane of x0 and y0 touches the ellipsoid.

    Attributes:
        lat: latitude, positive to the north.
        lon: longitude, positive to the east.
    """

    lat: Angle
    lon: Angle

    @model_validator(mode="after")
    def _on_the_earth(self) -> Self:
        for key, angle, largest in (("lat", self.lat, pi / 2), ("lon", self.lon, 2 * pi)):
            if abs(angle) > largest:
                raise ValueError(
                    f"{key} = {angle:g} rad is no place on the earth; "
                    f'for degrees write {key} = {{ value = {angle:g}, unit = "deg" }}'
                )
        return self


class AntennaTable(StrictTable):
    """Where the GNSS antenna is.

    Attributes:
        x: m forward of midship.
        y: m to starboard of the centre line.
    """

    x: float = 0.0
    y: float = 0.0


@dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class RecordsTable(ColumnsTable):
    """One `[[records]]` block: files of one layout, or one run in several sources; roles, parts and trimming.

    Attributes:
        files: a glob or a list of globs, under the folder of `[data]`.
        name: of the run that `sources` make.
        sources: the files of one run, each with its own layout and clock.
        parts: runs cut out of a log.
        clock_offset: s added to the stamps.
        origin: where the plane of x0 and y0 touches the earth; without it: the first fix.
        variation: of the compass, positive to the east.
        antenna: place of the GNSS antenna.
        format: one of those on the page Logs; without it: by the first bytes, or the ending.
        scale: length ratio by which the record is Froude-scaled.
        source: citation of the records.
        kind: figures and tables call a simulated record a reference; without it: as the file says, else ``measured``.
        train: patterns of file names without ending; with it all that is not named is left out.
        validate_: patterns of the runs that are predicted and not fitted.
        leave_out: patterns of the runs that are not read.
        session: which runs share their offsets: ``run`` (each file, with its parts), ``all``, ``day`` (date in the file
            name, else of the first stamp), or a template as ``*_{day}_*``: braces stand for what names the session, *
            and ? for any letters and for one.
        rate: Hz to which the records are resampled.
        skip_acceleration: whether the acceleration run is dropped.
        from_release: whether what lies before the largest swing of a decay is dropped.
        waves: how the ship met the waves.
    """

    files: Strings = ()
    name: str = ""
    sources: tuple[SourceTable, ...] = ()
    parts: tuple[PartTable, ...] = ()
    clock_offset: float = 0.0
    origin: OriginTable | None = None
    variation: Angle | None = None
    antenna: AntennaTable | None = None
    format: Format | None = None
    scale: Annotated[float, Field(gt=0)] = 1.0
    source: str = ""
    kind: Literal["measured", "simulated"] | None = None
    train: Strings = ()
    validate_: Strings = Field((), alias="validate")
    leave_out: Strings = ()
    session: Annotated[str, BeforeValidator(valid_session)] = "run"
    rate: Annotated[float, Field(gt=0)] | None = None
    skip_acceleration: bool = False
    from_release: bool = False
    waves: WavesTable | None = None

    @model_validator(mode="after")
    def _files_or_sources(self) -> Self:
        if bool(self.files) == bool(self.sources):
            raise ValueError(
                "give files, or sources of one run, and not both" if self.files else "key 'files' is missing; add it"
            )
        if self.sources and not self.name:
            raise ValueError("a run of several sources needs a name; add it")
        if self.sources and self.channels:
            raise ValueError("channels of a run of several sources belong to each of [[records.sources]]; move them")
        if not any(table.channels for table in self.sources or (self,)):
            raise ValueError(NO_CHANNELS)
        return self


@dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class FollowTable(ColumnsTable, StreamSettings):
    """`[follow]`: the settings of a stream, and in which columns its samples stand.

    Attributes:
        waves: how the ship meets them, without `sea`.
    """

    waves: WavesTable | None = None

    @model_validator(mode="after")
    def _columns_are_stated(self) -> Self:
        for key, missing in (("time", self.time.column == ""), ("channels", not self.channels)):
            if missing:
                raise ValueError(f"key '{key}' is missing; add it")
        return self


class MotionColumn(StrictTable):
    """A motion or input of force points: a column of the table, or one value for all points.

    Attributes:
        column: header name, or number counted from 1.
        value: the same for all points.
        unit: 1 for v over U, r L over U.
        positive: must be stated of a drift angle: which way the bow points from the course.
    """

    column: str | Annotated[int, Field(ge=1)] | None = None
    value: float | None = None
    unit: Unit
    positive: Literal["forward", "aft", "ahead", "astern", "starboard", "port", "bow to starboard",
                      "bow to port"] | None = None  # fmt: skip

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if (self.column is None) == (self.value is None):
            raise ValueError("give either column or value, and not both")
        return self


class ForceColumn(StrictTable):
    """A measured force.

    Attributes:
        column: empty cells are not measured.
        unit: 1 in a prime system.
        positive: without it: that of the notation.
        sd: standard deviation, in that unit.
    """

    column: str | Annotated[int, Field(ge=1)]
    unit: Unit
    positive: Literal["forward", "aft", "starboard", "port"] | None = None
    sd: Annotated[float, Field(gt=0)] | None = None


class ForcesTable(StrictTable):
    """One `[[forces]]` block: static force points of captive tests or CFD.

    Attributes:
        file: the table; format and header are read from it.
        includes: what the forces hold.
        motion: u or U; v or beta; r; the model's inputs. v and r are 0 where they are not given.
        measured: what of X, Y, N was measured.
        prime: of forces of unit 1: ``rho/2 L d U^2`` (MMG) or ``rho/2 L^2 U^2`` (SNAME), moments with one L more;
            without it: N and N m.
        origin: m forward of midship: the point the moments are about, and at which v or beta is measured.
        motion_origin: the same for v and beta alone; without it: `origin`.
        sd_percent: standard deviation in per cent of the force's range in the table; this or an sd of each is required.
        scale: length ratio by which the table is Froude-scaled: dimensional values and `origin` alike.
        source: citation.
    """

    file: str
    includes: Literal["hull", "hydrodynamic", "pressure", "balance"]
    motion: dict[Literal["u", "v", "U", "beta", "r", "delta", "n", "v_j"], MotionColumn]
    measured: Annotated[dict[Literal["X", "Y", "N"], ForceColumn], Field(min_length=1)]
    prime: str = ""
    origin: float = 0.0
    motion_origin: float | None = None
    sd_percent: Annotated[float, Field(gt=0)] | None = None
    scale: Annotated[float, Field(gt=0)] = 1.0
    source: str = ""

    @model_validator(mode="after")
    def _motion_is_complete(self) -> Self:
        given = set(self.motion)
        if len(given & {"u", "U"}) != 1:
            raise ValueError("motion needs the surge velocity u or the speed U, one of them")
        if {"beta", "v"} <= given:
            raise ValueError("motion has both v and the drift angle beta; keep one")
        if "v" in given and ("U" in given) != (self.motion["v"].unit == "1"):
            raise ValueError("motion.v goes with u in m/s, or with U as v/U of unit 1")
        return self


class DataTable(StrictTable):
    """`[data]`: where record files are sought.

    Attributes:
        folder: relative to the trial file; ${NAME} is an environment variable.
    """

    folder: str = "."


class PriorTable(StrictTable):
    """Gaussian prior of one parameter, in its own unit.

    Attributes:
        mean: without it: the start value.
        sd: standard deviation.
        source: citation.
    """

    mean: float | None = None
    sd: Annotated[float, Field(gt=0)]
    source: str = ""


class ModelTable(StrictTable):
    """`[model]`: which equations, which values, what is free.

    Attributes:
        name: of the equations; ``seatrial models`` lists them.
        parameter_set: a published set of values.
        damping: of the model ``thrusters``.
        reference_point: m forward of midship: where the model's u, v, x0, y0 are.
        fixed: parameter -> value; it is not estimated.
        start: parameter -> value from which the search starts.
        free: exactly these are estimated; without it: the model's own choice.
        bounds: parameter -> lower and upper limit; without it: the model's own.
        priors: parameter -> mean, standard deviation and source.
        prior_sd_percent: prior of all other free parameters around their start, or what `priors_from` says.
        priors_from: sources of priors, of which later ones win: literature, which needs `prior_sd_percent`, or the
            folder of an earlier result.
    """

    name: str
    parameter_set: str | None = None
    damping: Damping | None = None
    reference_point: float = 0.0
    fixed: dict[str, SiAmount] = Field(default_factory=dict)
    start: dict[str, SiAmount] = Field(default_factory=dict)
    free: tuple[str, ...] | None = None
    bounds: dict[str, tuple[Bound, Bound]] = Field(default_factory=dict)
    priors: dict[str, PriorTable] = Field(default_factory=dict)
    prior_sd_percent: Annotated[float, Field(gt=0)] | None = None
    priors_from: Strings = ()


class ExcitationTable(StrictTable):
    """`[excitation]`: how an elevation becomes a wave force.

    Attributes:
        source: ``box``: closed form for the ship's L, B, d and stiffness; ``table``: complex transfer functions in a
            CSV or NetCDF file; ``capytaine``: a dataset of Capytaine at rest, speed terms by strip theory.
        file: of a table or dataset; of a trial file under the folder of `[data]`.
    """

    source: Literal["box", "table", "capytaine"]
    file: str | None = None

    @model_validator(mode="after")
    def _file_where_needed(self) -> Self:
        if (self.file is None) != (self.source == "box"):
            raise ValueError("a box needs no file" if self.file else f"source = '{self.source}' needs a file")
        return self


class TrialFile(StrictTable):
    """The whole file; records may be missing where a manoeuvre is only to be designed, or a stream to be followed.

    Attributes:
        question: a sentence for the report.
        accept: codes of errors despite which runs are used.
        ship: name and particulars.
        channels: channels that the notation lacks, for a model of one's own.
        data: where record files are sought.
        records: a block for each layout of files.
        model: equations, values, what is free.
        thruster: a block for each thruster of the model ``thrusters``.
        sensors: what stands between motion and records.
        forces: static force points of captive tests or CFD.
        excitation: how an elevation becomes a wave force.
        family: models to compare.
        compare: published pipeline that is set beside the fit.
        noise: channel -> known standard deviation, as ``u = 0.02`` or ``psi = { sd = 0.2, unit = "deg" }``; else it is
            estimated.
        truth: parameter -> true value, for simulated records.
        estimate: settings of the estimator.
        feedback: a controller that was on.
        design: a manoeuvre to be designed.
        follow: a stream of samples.
        proposal: gains proposed while a stream is followed.
    """

    question: str = ""
    accept: tuple[str, ...] = ()
    ship: ShipTable | None = None
    channels: dict[str, DeclaredChannel] = Field(default_factory=dict)
    data: DataTable = DataTable()
    records: tuple[RecordsTable, ...] = ()
    model: ModelTable | None = None
    thruster: tuple[ThrusterTable, ...] = ()
    sensors: Sensors = Sensors()
    forces: tuple[ForcesTable, ...] = ()
    excitation: ExcitationTable | None = None
    family: ModelFamily | None = None
    compare: CompareSettings = CompareSettings()
    noise: dict[str, Deviation] = Field(default_factory=dict)
    truth: dict[str, float] = Field(default_factory=dict)
    estimate: EstimateSettings = EstimateSettings()
    feedback: Feedback | None = None
    design: DesignRequest | None = None
    follow: FollowTable | None = None
    proposal: ProposalSettings | None = None


def trial_schema() -> dict[str, Any]:
    """JSON Schema of a trial file, for editors."""
    return TrialFile.model_json_schema()
