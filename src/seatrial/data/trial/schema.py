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
    """A spectrum; `height` is the significant one, `period` the mean T_1 for ittc2, else that of the peak."""

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
    """`[ship]`: every key besides these is a particular by its symbol, a number in SI units or {value, unit}."""

    model_config = ConfigDict(extra="allow", frozen=True, allow_inf_nan=False)

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

    `date`, `nanoseconds`, `week`: the columns that complete a time of day, whole seconds, seconds of the GNSS week.
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
    """Where a channel stands and what its numbers mean; frame and sign default to the notation table's.

    The number in `unit` is (cell - zero) / span * scale + offset. A command is held until the next one. Of two rudders,
    nozzles or shafts `twin` is the other column: the channel is half the sum.
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
    """`[channels.NAME]`: a channel that the notation table does not have, for models of one's own."""

    meaning: str
    unit: Unit
    frame: Literal["body", "earth", "none"] = "none"
    positive: str = "none"
    kind: Literal["command", "measured"] = "measured"
    between: Literal["held", "straight"] | None = None


class WavesTable(StrictTable):
    """`[records.waves]`: heading to the waves (0 following, 180 degrees head; rad without a unit) and ship speed.

    `sea`: where neither the elevation nor the wave forces were recorded.
    """

    heading: Angle
    speed: Speed
    sea: SeaTable | None = None


@dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class ColumnsTable:
    """Where time and channels stand, in a file or in a stream."""

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
    """`[[records.sources]]`: one file of a run, with its layout and clock."""

    file: str
    format: Format | None = None
    clock_offset: float = 0.0


class PartTable(StrictTable):
    """A run cut out of a log: from and to are times after its first sample (``"120 s"``), or names of events.

    `file`: that of several files out of which it is cut, by its name without the ending; a file of which no part is
    named stays whole. Without it the part is cut out of each.
    """

    name: str
    file: str = ""
    start: str = Field("", alias="from")
    stop: str = Field("", alias="to")


class OriginTable(StrictTable):
    """Where the plane of x0 and y0 touches the ellipsoid."""

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
    """Where the GNSS antenna is, m forward of midship and to starboard of the centre line."""

    x: float = 0.0
    y: float = 0.0


@dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class RecordsTable(ColumnsTable):
    """One `[[records]]` block: files of one layout, or one run in several sources; roles, parts and trimming."""

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
    """`[follow]`: the settings of a stream, and in which columns its samples stand."""

    waves: WavesTable | None = None

    @model_validator(mode="after")
    def _columns_are_stated(self) -> Self:
        for key, missing in (("time", self.time.column == ""), ("channels", not self.channels)):
            if missing:
                raise ValueError(f"key '{key}' is missing; add it")
        return self


class MotionColumn(StrictTable):
    """A motion or input of force points: a column of the table, or one value for all points.

    Unit 1: v over U, r L over U. A drift angle must say which way the bow points from the course when it is positive.
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
    """A measured force: its column, unit (1 in a prime system), positive direction and standard deviation in it."""

    column: str | Annotated[int, Field(ge=1)]
    unit: Unit
    positive: Literal["forward", "aft", "starboard", "port"] | None = None
    sd: Annotated[float, Field(gt=0)] | None = None


class ForcesTable(StrictTable):
    """One `[[forces]]` block: static force points of captive tests or CFD."""

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
    """`[data]`: where record files are sought, relative to the trial file; ${NAME} is an environment variable."""

    folder: str = "."


class PriorTable(StrictTable):
    """Gaussian prior of one parameter, in its own unit."""

    mean: float | None = None
    sd: Annotated[float, Field(gt=0)]
    source: str = ""


class ModelTable(StrictTable):
    """`[model]`: which equations, which values, what is free."""

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

    `box`: closed form for the ship's L, B, d and stiffness; `table`: complex transfer functions in a CSV or NetCDF
    file; `capytaine`: a dataset of Capytaine at rest, speed terms by strip theory.
    """

    source: Literal["box", "table", "capytaine"]
    file: str | None = None

    @model_validator(mode="after")
    def _file_where_needed(self) -> Self:
        if (self.file is None) != (self.source == "box"):
            raise ValueError("a box needs no file" if self.file else f"source = '{self.source}' needs a file")
        return self


class TrialFile(StrictTable):
    """The whole file; records may be missing where a manoeuvre is only to be designed, or a stream to be followed."""

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
