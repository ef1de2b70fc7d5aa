"""The tables of a loop file: strict pydantic models, and amounts with units in SI."""

import math
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from seatrial.control.task import GeneticTuning, Heading, PlantUncertainty, ScheduleGrid
from seatrial.core.values import NOTATION, InputError, si_unit
from seatrial.data.trial.amounts import (
    Amount,
    InSi,
    Length,
    PositiveDuration,
    PositiveFrequency,
    PositiveLength,
    PositiveSpeed,
    SiAmount,
    StrictTable,
)
from seatrial.data.trial.schema import ExcitationTable, SeaTable

# Amounts of a loop file in SI units, tested for their kind; every sentence begins with the key.

_HALF_TURN = math.pi
_RATES = {"rad": "rad/s", "m": "m/s", "m/s": "m/s^2"}


def symbol_unit(symbol: str) -> str:
    """Return the SI unit of a symbol of the notation; 1 for others."""
    return NOTATION[symbol].unit if symbol in NOTATION else "1"


def rate_unit(unit: str) -> str:
    """Return the SI unit of the rate of what is measured in `unit`."""
    return _RATES.get(unit, f"{unit} per s")


def si_value(quantity: Amount, unit: str, where: str) -> float:
    """Return the amount in SI, which must be of the kind that `unit` measures."""
    if quantity.unit is None:
        return quantity.value
    factor, kind = si_unit(quantity.unit)
    if kind != unit:
        raise InputError(f"{where}: '{quantity.unit}' is no unit of what is measured in {unit}; write one that is")
    return quantity.value * factor


def positive_value(quantity: Amount, unit: str, where: str) -> float:
    """Return the amount of `si_value`, which must be above zero."""
    value = si_value(quantity, unit, where)
    if not value > 0.0:
        raise InputError(f"{where} = {quantity.value:g} is not positive; give a positive one")
    return value


def angle_value(quantity: Amount, where: str) -> float:
    """Return a positive angle below half a turn [rad]; degrees were probably meant by others."""
    return _below_half_a_turn(positive_value(quantity, "rad", where), f"{where} = ")


def _below_half_a_turn(value: float, subject: str = "") -> float:
    if value >= _HALF_TURN:
        raise InputError(
            f"{subject}{value:g} rad is half a turn or more; write it with its unit, such as "
            f'{{ value = {value:g}, unit = "deg" }}'
        )
    return value


def rate_value(quantity: Amount, unit: str, where: str) -> float:
    """A positive rate of what is measured in `unit`, SI; a bare number of half a turn a second was meant in degrees."""
    value = positive_value(quantity, rate_unit(unit), where)
    if unit == "rad" and quantity.unit is None and value >= _HALF_TURN:
        raise InputError(
            f"{where} = {value:g} is half a turn a second or more; write it with its unit, such as "
            f'{{ value = {value:g}, unit = "deg/s" }}'
        )
    return value


# The tables of a loop file: strict pydantic models; `seatrial.data.trial.amounts` words what they refuse.

Coefficients = Annotated[tuple[float, ...], Field(min_length=1)]
Share = Annotated[float, Field(gt=0, lt=1)]
Positive = Annotated[float, Field(gt=0)]
SmallAngle = Annotated[float, InSi("rad", is_positive=True), AfterValidator(_below_half_a_turn)]


def _as_objective(value: object) -> object:
    return {"name": value} if isinstance(value, str) else value


class NotchTable(StrictTable):
    """(s^2 + 2 depth damping omega s + omega^2) / (s^2 + 2 damping omega s + omega^2).

    Attributes:
        omega: frequency that it stops; damping: ratio, half its relative width; depth: gain that is left at omega.
    """

    omega: PositiveFrequency
    damping: Positive = 0.5
    depth: Annotated[float, Field(ge=0, lt=1)] = 0.1  # gain at omega; chosen


class PassTable(StrictTable):
    """Of second order: low-pass omega^2, band-pass 2 damping omega s, high-pass s^2, over the polynomial of both.

    Attributes:
        omega: natural frequency; damping: its ratio; the gain is 1 where the filter passes fully.
    """

    omega: PositiveFrequency
    damping: Positive = 0.7  # damping ratio, about that of Butterworth's filter, 0.707


class BlockTable(StrictTable):
    """One transfer function: coefficients of s, or a filter by its kind.

    Attributes:
        name: for the report.
        num, den: coefficients of s, highest power first; the degree of `num` is no higher than that of `den`.
        notch: stops one frequency; low_pass: passes what is slow.
        band_pass: passes what is about one frequency; high_pass: passes what is fast.
        lag: time constant of a lag of first order.
        source: citation, for the report.
    """

    name: str = ""
    num: Coefficients | None = None
    den: Coefficients | None = None
    notch: NotchTable | None = None
    low_pass: PassTable | None = None
    band_pass: PassTable | None = None
    high_pass: PassTable | None = None
    lag: PositiveDuration | None = None
    source: str = ""

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        kinds = [self.num is not None or self.den is not None]
        kinds += [k is not None for k in (self.lag, self.notch, self.low_pass, self.band_pass, self.high_pass)]
        if sum(kinds) != 1 or (kinds[0] and (self.num is None or self.den is None)):
            raise ValueError("give num and den, or one of lag, notch, low_pass, band_pass, high_pass")
        return self


class TermTable(BlockTable):
    """One part of the controller in parallel: the gain of that name times the block.

    Attributes:
        gain: its name.
    """

    gain: str


class FinTable(StrictTable):
    """`[plant.fin]`: the fins; a `roll` model that was identified from decays, which show no fins, needs it, too.

    Attributes:
        K_alpha: wave slope to which a radian of fin angle is equivalent; None: the model's own.
        at_speed: where `K_alpha` holds; None: the plant's speed.
        law: how it goes with the speed.
    """

    K_alpha: Positive | None = None
    at_speed: PositiveSpeed | None = None
    law: Literal["constant", "U^2"] = "U^2"


class PlantTable(StrictTable):
    """`[plant]`: what is controlled, as transfer functions or as a model file of `identify`: one of the first three.

    Attributes:
        roll: transfer function from the wave slope to the roll angle, with `[plant.fin]`.
        response: transfer function from the actuator to the output, with `output` and `actuator`; what disturbs it acts
            like the actuator.
        model: a model file as `identify` writes it, relative to the loop file, `${NAME}` an environment variable;
            `--from FILE` takes its place.
        scale: length of the craft over that of the one identified: its model at that size by Froude's law; None: 1.
        speed: of the ship; None: `at_speed` of the fins, else the model's own.
        fin: how much the fins do.
        output, actuator: symbols of the notation; None: `phi` and `alpha_f` of a model that rolls, `psi` and `delta` of
            one that is steered.
        disturbance: symbol of the input that the waves move; None: `alpha_w` of a model that rolls.
        amplitude: roll angle about which nonlinear damping and restoring are linearised, by equal energy and first
            harmonic; None: at rest.
        inputs: those held constant, such as `{ n = 10.4 }`; None: as in the trials.
    """

    roll: BlockTable | None = None
    response: BlockTable | None = None
    model: str | None = None
    scale: Positive | None = None
    speed: PositiveSpeed | None = None
    fin: FinTable | None = None
    output: str | None = None
    actuator: str | None = None
    disturbance: str | None = None
    amplitude: SmallAngle | None = None
    inputs: dict[str, SiAmount] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if sum(part is not None for part in (self.roll, self.response, self.model)) != 1:
            raise ValueError("give one of roll, response (transfer functions) and model (a model file)")
        if self.roll is not None and (self.fin is None or self.fin.K_alpha is None):
            raise ValueError("roll needs a table [plant.fin] with K_alpha, the wave slope a radian of fin is worth")
        if self.response is not None and (self.output is None or self.actuator is None or self.fin is not None):
            raise ValueError("response needs the symbols output and actuator, and no table fin")
        of_model = (self.amplitude, self.disturbance, self.scale)
        if self.model is None and (self.inputs or any(one is not None for one in of_model)):
            raise ValueError("inputs, amplitude, disturbance and scale go with a model file; leave them out")
        return self


class GainTable(StrictTable):
    """`[controller.gains.NAME]`: where it may lie, or its value alone where it is fixed.

    Attributes:
        value: where it starts, or stays if it is fixed.
        lower, upper: bounds of a gain that is free.
        fixed: keeps the value.
    """

    value: float | None = None
    lower: float | None = None
    upper: float | None = None
    fixed: bool = False

    @model_validator(mode="after")
    def _free_or_fixed(self) -> Self:
        if self.fixed and self.value is None:
            raise ValueError("a fixed gain needs its value")
        if self.lower is not None and self.upper is not None and not self.lower < self.upper:
            raise ValueError(f"lower = {self.lower:g} is not below upper = {self.upper:g}; give the smaller first")
        return self


class ControllerTable(StrictTable):
    """`[controller]`: what turns the output into the order to the actuator.

    Attributes:
        kind: `yu2014`: rate gyro, preamplifier and three terms of Yu et al. 2014; `pid`: KP + KI / s + KD s / (T s + 1)
            on the output error, positive gains oppose the motion; `blocks`: terms one by one.
        preamplifier: of `yu2014`: 30 s / (30 s + 1), the usual rate-gyro law, or 1 / (30 s + 1) as the paper has it.
        parts: of `pid`: which of the three; None: those with gains named, else `KP` and `KI` for a speed, all for
            others.
        derivative_filter: of `pid`: T, half a sample at least, since a shorter one rings; None: a tenth of the fastest
            loop's time.
        sample_s: sample time on board, whose hold is in every margin and simulation; None: 30 samples a period of the
            frailest frequency.
        sensor: blocks between output and terms.
        terms: of `blocks`: gain and transfer function of each.
        filters: blocks common to all terms, notches for example.
        gains: bounds or value of each; None: the published bounds of `yu2014`, those of the plant's poles for `pid`.
    """

    kind: Literal["yu2014", "pid", "blocks"]
    preamplifier: Literal["printed", "washout"] = "washout"
    parts: tuple[Literal["KP", "KI", "KD"], ...] = ()
    derivative_filter: PositiveDuration | None = None
    sample_s: PositiveDuration | None = None
    sensor: tuple[BlockTable, ...] = ()
    terms: tuple[TermTable, ...] = ()
    filters: tuple[BlockTable, ...] = ()
    gains: dict[str, GainTable] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _keys_of_the_kind(self) -> Self:
        of_others = {
            "yu2014": ("sensor", "terms", "parts", "derivative_filter"),
            "pid": ("terms", "preamplifier"),
            "blocks": ("parts", "derivative_filter", "preamplifier"),
        }
        for key in of_others[self.kind]:
            if key in self.model_fields_set:
                raise ValueError(f"kind '{self.kind}' knows no '{key}'; leave it out")
        if self.kind == "blocks" and not self.terms:
            raise ValueError("kind 'blocks' needs at least one entry in [[controller.terms]]")
        return self


class ExtendedStructureTable(StrictTable):
    """`[[extended_structures]]`: a loop with more terms, compared and, where simulation shows it to be better, chosen.

    Attributes:
        name: for tables; None: from what is added.
        add: a band-pass (gain `KB`) and a low-pass (gain `KL`) in parallel to the terms, a notch in all.
        band_pass, low_pass: where they are set; None: at 0.63 and 3.2 times the plant's own frequency, as found for the
            published fins.
        notch: where it is set; None: at the plant's own frequency.
    """

    name: str = ""
    add: Annotated[tuple[Literal["band-pass", "low-pass", "notch"], ...], Field(min_length=1)]
    band_pass: PassTable | None = None
    low_pass: PassTable | None = None
    notch: NotchTable | None = None

    @model_validator(mode="after")
    def _added_once(self) -> Self:
        if len(set(self.add)) != len(self.add):
            raise ValueError("add names a part twice; name each once")
        for part in ("band-pass", "low-pass", "notch"):
            key = part.replace("-", "_")
            if getattr(self, key) is not None and part not in self.add:
                raise ValueError(f"'{key}' is described but not added; put '{part}' into add")
        return self


class ActuatorTable(StrictTable):
    """`[actuator]`: what the fins, rudders or nozzles can do.

    Attributes:
        limit: largest excursion from the steady value; rate: largest rate.
        stall: fin angle beyond which lift is lost, in simulation.
        dead_time: from the order to the servo, without the sampling; it is in every margin and simulation, and as long
            again is to be tolerated; None: 0.
        log: record or trial file with the angle (`delta`) and its order (`delta_ref`): gives `rate`, `dead_time` and
            lag that do not stand here, with intervals.
        inertia: of all fins or rudders about their stocks, for the energy; efficiency: of their drive.
        area: of all fins or rudders, for the drag; aspect_ratio: the effective one, twice the geometric one at a hull.
        servo: blocks from the order to the actuator; None: for `yu2014` its own.
    """

    limit: SiAmount | None = None
    rate: SiAmount | None = None
    stall: SiAmount | None = None
    dead_time: PositiveDuration | None = None
    log: str = ""
    inertia: Annotated[float, InSi("kg m^2", is_positive=True)] | None = None
    efficiency: Annotated[float, Field(gt=0, le=1)] = 1.0
    area: Annotated[float, InSi("m^2", is_positive=True)] | None = None
    aspect_ratio: Positive | None = None
    servo: tuple[BlockTable, ...] = ()


class SeawayTable(SeaTable):
    """One `[[seas]]` block: a sea, met under a heading at a speed.

    Attributes:
        heading: to the waves, 0 following, 180 degrees head.
        speed: of the ship; None: the plant's.
        spreading: exponent s of cos^2s over half a turn; None: long-crested.
    """

    heading: Heading
    speed: PositiveSpeed | None = None
    spreading: Positive | None = None


class SlowDisturbanceTable(StrictTable):
    """One `[[slow_disturbances]]` block: a Gauss-Markov process, for gusts, current and slow forces of waves.

    Attributes:
        rms: it acts like the actuator, in its unit, or like `plant.disturbance` where that is stated.
        bandwidth: how fast it changes.
        speed: of the ship; None: the plant's.
    """

    rms: SiAmount
    bandwidth: PositiveFrequency
    speed: PositiveSpeed | None = None


class SensorsTable(StrictTable):
    """`[sensors]`: errors of the output as it is read, in every variance and simulation.

    Attributes:
        noise: rms of the white noise in each sample, before the controller's `sensor`; None: 0.
        resolution: the step in which it is read; None: 0.
    """

    noise: SiAmount | None = None
    resolution: SiAmount | None = None


class HullTable(StrictTable):
    """`[hull]`: the box over which the slope of short waves is averaged.

    Attributes:
        L, B, T: length, breadth and draught; without the table, the ship's own of the model file.
    """

    L: PositiveLength
    B: PositiveLength
    T: PositiveLength


ObjectiveName = Literal[
    "output", "output_rate", "output_acceleration", "actuator", "actuator_rate", "actuator_off_target",
    "roll", "roll_rate", "fin", "fin_rate", "fin_off_target", "motion_interruptions", "motion_sickness",
    "vertical_acceleration", "motion_sickness_dose", "energy",
]  # fmt: skip


class ObjectiveTable(StrictTable):
    """One entry of `minimise`, or a name alone: what is to be small.

    Attributes:
        name: variances of the output and the actuator and of their rates, `roll` and `fin` where these are meant;
            others in the table of the page.
        height: of a standing person's centre of gravity above the axis, for interruptions; friction: of shoe and deck.
        lever: of sickness by roll, off the axis.
        x: of what heave and pitch do at a point, forward of the origin.
        duration: of a sickness dose.
        target: rms aimed at; None: where the share `limits.saturation` of amplitudes lies beyond `actuator.limit`.
        one_sided: `false` counts a quiet actuator as missed, too, as Yu et al. print it.
    """

    name: ObjectiveName
    height: Length | None = None
    friction: Positive = 0.25
    lever: Length | None = None
    x: Length | None = None
    duration: PositiveDuration = 7200.0  # s; two hours, as O'Hanlon & McCauley 1974
    target: SiAmount | None = None
    one_sided: bool = True

    @model_validator(mode="after")
    def _keys_of_what(self) -> Self:
        own = {
            "motion_interruptions": {"height", "friction"},
            "motion_sickness": {"lever", "x"},
            "motion_sickness_dose": {"x", "duration"},
            "vertical_acceleration": {"x"},
            "fin_off_target": {"target", "one_sided"},
            "actuator_off_target": {"target", "one_sided"},
        }.get(self.name, set())
        for key in sorted(self.model_fields_set - own - {"name"}):
            raise ValueError(f"'{self.name}' knows no '{key}'; leave it out")
        needed = {"motion_interruptions": "height", "motion_sickness_dose": "x", "vertical_acceleration": "x"}
        key = needed.get(self.name, "")
        if key and getattr(self, key) is None:
            raise ValueError(f"'{self.name}' needs {key} in metres")
        if self.name == "motion_sickness" and (self.lever is None) == (self.x is None):
            raise ValueError("'motion_sickness' needs lever (of roll) or x (of heave and pitch) in metres")
        return self


class LimitsTable(StrictTable):
    """`[limits]`: what every controller keeps.

    Attributes:
        Ms: largest peak of the sensitivity.
        saturation, rate_saturation: largest share of amplitudes, and of rate amplitudes, beyond the actuator's, by
            Rayleigh's distribution.
    """

    Ms: Annotated[float, Field(gt=1)] = 1.6  # tolerates 38 degrees of phase, a factor of 2.7 in gain; chosen
    saturation: Share = 0.2  # of amplitudes beyond the limit; chosen
    rate_saturation: Share = 0.2  # of rate amplitudes beyond the rate; chosen


class SimulationTable(StrictTable):
    """`[simulation]`: the nonlinear check; without the table, of stabilisers only.

    Attributes:
        seeds: seas that it runs through, 0: none; duration: of each; step: of the integration.
    """

    seeds: Annotated[int, Field(ge=0, le=1000)] = 20  # seas, as in `SimulationSettings`
    duration: PositiveDuration = 1000.0  # s, as in `SimulationSettings`
    step: PositiveDuration = 0.05  # s, as in `SimulationSettings`


class DemandTable(StrictTable):
    """`[demand]`: a change of the output that the loop has to follow.

    Attributes:
        change: of the output, through a critically damped reference filter; overshoot: largest share of it.
        settling: longest time until the output stays within 5 % of the change; None: any.
        feed_forward: the reference moves the actuator, too, by what the plant needs for its rate and acceleration.
        time_constant: of the reference filter; None: ship's length over speed.
    """

    change: SiAmount
    overshoot: Annotated[float, Field(ge=0, lt=1)] = 0.02  # share of the change; chosen
    settling: PositiveDuration | None = None
    feed_forward: bool = False
    time_constant: PositiveDuration | None = None


class TrackTable(StrictTable):
    """`[track]`: a track to be kept by line of sight around the heading loop.

    Attributes:
        current: rms of the current across the track; bandwidth: how fast it changes.
        corner: turn of the track on which the guidance is tried.
        acceptance: distance before the corner at which the next leg is taken; None: two ship's lengths.
    """

    current: PositiveSpeed
    bandwidth: PositiveFrequency
    corner: SmallAngle = math.radians(60.0)  # a usual corner of survey lines; chosen
    acceptance: PositiveLength | None = None


class StationTable(StrictTable):
    """`[station]`: a place and heading to be kept by a craft with thrusters, beside its heading loop.

    Attributes:
        current: steady, from any direction; current_rms: how much it varies; bandwidth: how fast.
        gust: rms of a force ahead and of one to the side, N, or m/s^2 where no thrust is known in newtons.
        gust_bandwidth: how fast it changes.
        limit: share of full command that may be used.
    """

    current: PositiveSpeed
    current_rms: PositiveSpeed
    bandwidth: PositiveFrequency
    gust: SiAmount | None = None
    gust_bandwidth: PositiveFrequency | None = None
    limit: Annotated[float, Field(gt=0, le=1)] = 1.0

    @model_validator(mode="after")
    def _gust_with_its_bandwidth(self) -> Self:
        if (self.gust is None) != (self.gust_bandwidth is None):
            raise ValueError("gust and gust_bandwidth go together; give both or neither")
        return self


class LoopFile(StrictTable):
    """The whole file.

    Attributes:
        question: a sentence for the report; name: of the loop; None: from actuator and output.
        plant: what is controlled; controller: what controls it; actuator: what the fins, rudders or nozzles can do.
        sensors: errors of the output as it is read.
        hull: box over which the slope of short waves is averaged.
        excitation: how an elevation becomes a force; `file` relative to the loop file.
        seas, slow_disturbances: what disturbs; objectives are means over all, limits bind in each.
        minimise: what is to be small, names or tables; the first serves best to name the motion.
        limits: what every controller keeps.
        baselines: gains to stand beside ours: `[baselines.NAME]` with a line for each, `KP = 11.053`.
        extended_structures: controllers with more terms, to be compared.
        schedule: gains for every combination of speed, heading and height; simulation: the nonlinear check.
        demand: a change of the output to follow; track: a track to keep; station: a place to keep.
        uncertainty: ships and actuators that differ from what is declared.
        genetic: settings of `--method genetic`.
    """

    question: str = ""
    name: str = ""
    plant: PlantTable
    controller: ControllerTable
    actuator: ActuatorTable = ActuatorTable()
    sensors: SensorsTable = SensorsTable()
    hull: HullTable | None = None
    excitation: ExcitationTable | None = None
    seas: tuple[SeawayTable, ...] = ()
    slow_disturbances: tuple[SlowDisturbanceTable, ...] = ()
    minimise: Annotated[tuple[Annotated[ObjectiveTable, BeforeValidator(_as_objective)], ...], Field(min_length=1)] = (
        ObjectiveTable(name="output"),
        ObjectiveTable(name="actuator_rate"),
    )
    limits: LimitsTable = LimitsTable()
    baselines: dict[str, dict[str, float]] = Field(default_factory=dict)
    extended_structures: tuple[ExtendedStructureTable, ...] = ()
    schedule: ScheduleGrid | None = None
    simulation: SimulationTable | None = None
    demand: DemandTable | None = None
    track: TrackTable | None = None
    station: StationTable | None = None
    uncertainty: PlantUncertainty = PlantUncertainty()
    genetic: GeneticTuning = GeneticTuning()


def loop_schema() -> dict[str, Any]:
    """Return JSON Schema of a loop file, for editors."""
    return LoopFile.model_json_schema()
