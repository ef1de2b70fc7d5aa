"""A tuning task: loop, disturbances, objectives, limits, and the settings of the published search for its gains."""

import dataclasses
import math
from collections.abc import Callable, Mapping
from dataclasses import field, replace
from enum import Enum, StrEnum
from functools import lru_cache
from typing import Annotated

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field
from pydantic.dataclasses import dataclass

from seatrial.core.equations import Model
from seatrial.core.results.tuning import ControllerConstraints
from seatrial.core.values import Array, InputError, display_unit
from seatrial.data.trial.amounts import (
    STRICT_FIELDS,
    InSi,
    PositiveLength,
    PositiveSpeed,
    Quantities,
    raises_input_error,
)
from seatrial.numerics.optimise import GeneticSettings, Normaliser
from seatrial.physics.loops import (
    WAVE_SLOPE,
    ActuatorDrive,
    Block,
    EncounterSpectrum,
    HullFactor,
    LiftingSurface,
    LoopSignal,
    Objective,
    TransferLoop,
    WaveEffect,
    sea_disturbance,
    variance,
)
from seatrial.physics.loops.encounter_spectrum import PointSpectrum, disturbance_spectrum
from seatrial.physics.loops.loop import MOST_SAMPLES
from seatrial.physics.loops.objective import vertical_acceleration
from seatrial.physics.sea.spectrum import Spectrum
from seatrial.physics.simulate.closed_loop import ActuatorLimits

# Settings of the published genetic algorithm: a table of the loop file, a value in Python.

Probability = Annotated[float, Field(ge=0, le=1)]
Share = Annotated[float, Field(ge=0, lt=1)]


class SearchedObjectives(StrEnum):
    """What the genetic algorithm makes small.

    PRINTED: variances of output and actuator rate, and (actuator variance - target)^2 (Yu et al. 2014, eqs. (2)-(4)),
        the target being the variance at which the allowed share of amplitudes exceeds the actuator's limit.
    ONE_SIDED: the same, an actuator quieter than the target counting as met.
    OWN: the objectives of the task (`minimise` of a loop file).
    """

    PRINTED = "printed"
    ONE_SIDED = "one-sided"
    OWN = "minimise"


@raises_input_error
@dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class GeneticTuning:
    """`[genetic]`: settings of `--method genetic` (Yu et al. 2014, section 3); the defaults are published.

    Attributes:
        population: individuals of a generation; generations: how many of them, the first included.
        crossover: probability Pc that a pair of parents crosses over; mutation: probability Pm that a bit flips.
        bits: length of each gain's code; not printed: 17 is the fewest that hold the published gains.
        largest_weight: the random integers of the weights run from 1 to this; not printed.
        normaliser: what objectives are divided by: "max" or "best" of the first generation.
        objectives: what is made small.
        seeds: searches, the first of which gives the gains and the others show how far its answer scatters.
    """

    population: Annotated[int, Field(ge=5, le=10_000)] = 50
    generations: Annotated[int, Field(ge=1, le=10_000)] = 200
    crossover: Probability = 0.8  # Pc, as published
    mutation: Probability = 0.01  # Pm, as published
    bits: Annotated[int, Field(ge=2, le=52)] = 17
    largest_weight: Annotated[int, Field(ge=1)] = 100
    normaliser: Normaliser = Normaliser.MAX
    objectives: SearchedObjectives = SearchedObjectives.PRINTED
    seeds: Annotated[int, Field(ge=1, le=1000)] = 12

    def algorithm_settings(self, objective_count: int) -> GeneticSettings:
        """Return the settings of the algorithm for so many objectives.

        Raises:
            SearchError: fewer individuals than it needs for these.
        """
        return GeneticSettings(
            population=self.population,
            generations=self.generations,
            objectives=objective_count,
            Pc=self.crossover,
            Pm=self.mutation,
            bits=self.bits,
            largest_weight=self.largest_weight,
            normaliser=self.normaliser,
        )


# What is to be tuned: a loop, what disturbs it, what is to be small, what must be kept.

# damping ratio below which a swing counts as undamped: a tenth of the least of bare hulls (0.01: Lloyd 1989); chosen
_UNDAMPED = 1e-3
OUTPUT = variance("output", "rad^2", LoopSignal.OUTPUT)
_KEPT_LOOPS = 64  # with other dead times, kept in memory; chosen
_KEPT_SEAS = 256  # whose quadrature is kept: those of a schedule and between, of fronts on the same plant; chosen
_sea_disturbance = lru_cache(maxsize=_KEPT_SEAS)(sea_disturbance)
_ROUNDING = 1e-9  # rad by which a heading may lie outside
_SLOWEST, _FASTEST = 1e-3, 1e2  # frequencies of a slow disturbance over its bandwidth; chosen
_BEYOND = 30.0  # its highest frequency over the plant's fastest pole; chosen


@dataclasses.dataclass(frozen=True)
class Seaway:
    """A sea met at a speed and heading: U [m/s], beta [rad, 0 following]; spreading: exponent s, None long-crested.

    effect: what its waves do to the loop; path: from there to the output, where it is not the loop's own disturbance.
    at_points: what they do at the loop's points, in their order.
    """

    spectrum: Spectrum
    U: float
    beta: float
    effect: WaveEffect = WAVE_SLOPE
    spreading: float | None = None
    path: Block | None = None
    at_points: tuple[WaveEffect, ...] = ()

    @property
    def directions(self) -> tuple[float, ...]:
        """The heading [rad], and those to either side of it that a short-crested sea has much of."""
        aside = (0.0,) if self.spreading is None else (-0.25 * math.pi, 0.0, 0.25 * math.pi)
        return tuple(math.acos(math.cos(self.beta + angle)) for angle in aside)

    @property
    def is_output(self) -> bool:
        """Whether the effect is the output itself without control, with nothing between."""
        return self.path is not None and not self.path.order

    def disturbed(self, loop: TransferLoop) -> TransferLoop:
        """Return the loop with the path of the waves to its output."""
        return loop if self.path is None else replace(loop, disturbance=self.path)

    def exposure(self, loop: TransferLoop) -> EncounterSpectrum:
        """Return what the waves do to the loop that `disturbed` returns."""
        response = loop.plant if self.is_output else self.disturbed(loop).disturbance
        return _sea_disturbance(
            self.spectrum, self.U, self.beta, response, self.effect, spreading=self.spreading, at_points=self.at_points
        )

    @property
    def description(self) -> str:
        """In words."""
        crests = "long-crested" if self.spreading is None else "short-crested"
        by = "" if self.path is None else f", by the {self.effect.name}"
        return (
            f"{self.spectrum.name} {self.spectrum.significant_height:.3g} m, {crests}, "
            f"{math.degrees(self.beta):.0f} deg, {self.U:.3g} m/s{by}"
        )


@dataclasses.dataclass(frozen=True)
class SlowDisturbance:
    """A slow disturbance: coloured noise of `rms` [`unit`] and `bandwidth` [rad/s], `acting_like` an input.

    Its one-sided density is 2 rms^2 bandwidth / pi / (omega^2 + bandwidth^2), that of a first-order Gauss-Markov
    process (Gelb 1974, Applied Optimal Estimation, section 3.8). U: m/s, the ship's speed; path: to the output,
    where it is not the loop's own disturbance.
    """

    rms: float
    bandwidth: float
    U: float
    unit: str = "rad"
    acting_like: str = "of the actuator"
    path: Block | None = None

    def disturbed(self, loop: TransferLoop) -> TransferLoop:
        """Return the loop with the path of the disturbance to its output: its own where there is none."""
        return loop if self.path is None else replace(loop, disturbance=self.path)

    def _fastest(self, loop: TransferLoop) -> float:
        """Return the highest frequency [rad/s]: with a path of its own beyond the plant's fastest pole, too."""
        poles = np.abs(loop.plant.poles) if self.path is not None else np.zeros(1)
        return max(_FASTEST * self.bandwidth, _BEYOND * float(poles.max(initial=0.0)))

    def exposure(self, loop: TransferLoop) -> EncounterSpectrum:
        """Return the disturbance over five decades about its bandwidth.

        Of a loop with points it acts like the actuator.
        """
        b = self.bandwidth
        made = disturbance_spectrum(
            lambda w: 2.0 * self.rms**2 * b / math.pi / (w**2 + b**2), _SLOWEST * b, self._fastest(loop),
            self.disturbed(loop).disturbance, self.description,
        )  # fmt: skip
        moved = [point.plant.frequency_response(made.omega_e) for point in loop.points]
        return replace(made, points=tuple(PointSpectrum(np.abs(q) ** 2 * made.energy, q * made.energy) for q in moved))

    @property
    def description(self) -> str:
        """In words."""
        factor, unit = display_unit(self.unit)
        amount = f"{self.rms * factor:.3g} {unit}".removesuffix(" 1")
        return f"disturbance like {amount} {self.acting_like} below {self.bandwidth:.3g} rad/s"


class Effectiveness(Enum):
    """How the actuator's effect goes with the ship's speed."""

    CONSTANT = "constant"
    SPEED_SQUARED = "U^2"


def _amounts(value: object) -> object:
    """Return a list of amounts for a table of values with one unit; anything else as it is."""
    if not (isinstance(value, dict) and {"values"} <= set(value) <= {"values", "unit"}):
        return value
    return [{"value": number, "unit": value.get("unit")} for number in value["values"]]


def _heading(value: float) -> float:
    """Return a heading to the waves, 0 following to pi head [rad]."""
    if not -_ROUNDING <= value <= math.pi + _ROUNDING:
        raise InputError(
            f"{value:g} rad is no heading to the waves from 0 (following) to half a turn (head); write it with its "
            f'unit, such as {{ value = {value:g}, unit = "deg" }}'
        )
    return min(max(value, 0.0), math.pi)


Heading = Annotated[float, InSi("rad"), AfterValidator(_heading)]
_OneOrMore = Field(min_length=1), BeforeValidator(_amounts, json_schema_input_type=tuple[float, ...] | Quantities)


@raises_input_error
@dataclass(frozen=True, config=STRICT_FIELDS)
class ScheduleGrid:
    """`[schedule]`: every combination gets its own gains, in the first sea's spectrum.

    Attributes:
        speeds: of the ship, m/s; headings: to the waves, 0 following, rad; heights: significant heights, m.
        largest_step: of a gain between neighbouring conditions, as a share of the larger one.
    """

    speeds: Annotated[tuple[PositiveSpeed, ...], *_OneOrMore]
    headings: Annotated[tuple[Heading, ...], *_OneOrMore]
    heights: Annotated[tuple[PositiveLength, ...], *_OneOrMore]
    largest_step: Annotated[float, Field(gt=0, lt=1)] = 0.3  # chosen


@dataclasses.dataclass(frozen=True)
class SimulationSettings:
    """Nonlinear simulation: seeds of the sea, duration [s], step [s]."""

    seeds: int = 20  # seas; chosen
    duration: float = 1000.0  # s; chosen
    dt: float = 0.05  # s, step of the simulation; chosen


@dataclasses.dataclass(frozen=True)
class Demand:
    """What a servo loop has to follow: a change of the output and a zigzag, through a reference filter.

    Attributes:
        change: of the output, its unit; overshoot: largest share of it allowed; time_constant: s, of the second-order
            reference filter, critically damped; duration: s.
        settling: s, the longest allowed until the output stays within 5 % of the change.
        feeds_forward: whether the actuator is also moved by what the reference needs, so that the gains serve to keep
            the output and the reference alone shapes its changes.
    """

    change: float
    overshoot: float
    time_constant: float
    duration: float
    settling: float = math.inf
    feeds_forward: bool = False


@dataclasses.dataclass(frozen=True)
class TrackDemand:
    """A track to be kept in a current across it: coloured noise of rms `current` [m/s] and `bandwidth` [rad/s].

    turn: rad, of the corner on which the guidance is tried; acceptance: m along the track before it at which the next
    leg is taken.
    """

    current: float
    bandwidth: float
    turn: float
    acceptance: float


@dataclasses.dataclass(frozen=True, eq=False)
class StationDemand:
    """A place and heading to be kept in a steady `current` [m/s] from any direction, and in what varies.

    Attributes:
        model: of a craft with thrusters, driven by its commands; covariance: of its free parameters, (k, k) or (0, 0).
        current_rms, current_bandwidth: how the current varies [m/s, rad/s].
        gust_rms, gust_bandwidth: of forces from outside ahead and to the side, in the model's unit of force, rad/s.
        limit: share of full command that may be used; dead_time: of the thrusters [s].
        hull: over which waves are averaged; None where there are no seas.
    """

    model: Model
    covariance: Array
    current: float
    current_rms: float
    current_bandwidth: float
    gust_rms: float
    gust_bandwidth: float
    limit: float
    dead_time: float
    hull: HullFactor | None


@raises_input_error
@dataclass(frozen=True, config=STRICT_FIELDS)
class ActuatorSpread:
    """`[uncertainty.actuator]`: shares by which rate, dead time and stall may differ from what is declared.

    Controllers are ranked with actuators drawn from it; what a log of the actuator shows has the log's interval.

    Attributes:
        rate: of the largest rate; dead_time: of the dead time; stall: of the angle of stall.
    """

    rate: Share = 0.2  # of the largest rate; chosen
    dead_time: Share = 0.2  # of the dead time; chosen
    stall: Share = 0.2  # of the angle of stall; chosen

    def actuator_at(
        self, place: Array, limits: ActuatorLimits, loop: TransferLoop
    ) -> tuple[ActuatorLimits, TransferLoop]:
        """Return limits and loop at a place of the spread, -1 to 1 of rate, dead time and stall, (3,)."""
        rate, late, stall = (1.0 + np.array([self.rate, self.dead_time, self.stall]) * place).tolist()
        there = replace(limits, rate=rate * limits.rate, stall=stall * limits.stall)
        return there, _with_dead_time(loop, late)


@lru_cache(maxsize=_KEPT_LOOPS)
def _with_dead_time(loop: TransferLoop, factor: float) -> TransferLoop:
    """Return a loop with its dead time times a factor, no more than is modelled."""
    sampling = loop.required_sampling
    if not sampling.dead_time:
        return loop
    dead_time = min(factor * sampling.dead_time, MOST_SAMPLES * sampling.sample_s)
    return replace(loop, sampling=replace(sampling, dead_time=dead_time))


SLOWEST = np.array([-1.0, 1.0, 0.0])
"""Place in a spread of the actuator that a loop follows a demand by least."""


@raises_input_error
@dataclass(frozen=True, config=STRICT_FIELDS)
class PlantUncertainty:
    """`[uncertainty]`: how far a ship may differ from the model, and its actuator from what is declared.

    Attributes:
        gain, time: share by which the plant's gain, and all its time constants, may differ, either way.
        dead_time: that may be added, the longest; None: as declared.
        actuator: that of each sea of the ranking is drawn from these shares; results have the declared one.
    """

    gain: Share = 0.2  # share of the plant's gain; chosen
    time: Share = 0.1  # share of its time constants; chosen
    dead_time: Annotated[float, InSi("s"), Field(ge=0)] | None = None
    actuator: ActuatorSpread = ActuatorSpread()


_UNCERTAINTY = PlantUncertainty()


@dataclasses.dataclass(frozen=True, eq=False)
class TrimmedShip:
    """The model behind the plant, for simulation and for draws.

    Attributes:
        state, inputs: trim about which it was linearised, SI; covariance: of the free parameters (k, k) or (0, 0).
        actuator, disturbance, output: names; the disturbance may be empty.
        warnings: of the fit, a sentence each: what holds for every use of its values.
    """

    model: Model
    state: Array
    inputs: Array
    actuator: str
    output: str
    disturbance: str = ""
    covariance: Array = field(default_factory=lambda: np.empty((0, 0)))
    warnings: tuple[str, ...] = ()


@dataclasses.dataclass(frozen=True, eq=False)
class TuningTask:
    """One tuning.

    Attributes:
        loop: at the speed `U`; `effectiveness` gives it at others.
        disturbances: one or more; objectives are means over them, restrictions bind in each.
        baselines: gains by name of the controller; extended_structures: loops with more terms on the same plant.
        trimmed_ship: behind the plant; None where only transfer functions are known (simulated from those).
        demand: for servo loops (autopilot, speed); None for stabilisers.
        genetic: settings of the published search, used where that method is chosen.
        sample_s: sample time of the controller on board [s]; None: as the loop allows.
        drive, surface: of the actuator, for its energy; None where no inertia, no area is known.
        uncertainty: of the ships that the controllers are tried on.
        track: to be kept around the heading loop; None where none is.
        station: to be kept beside it; None where none is.
        at_speed: the same task at another speed [m/s], where the plant there is known; None: `effectiveness` gives it.

    Raises:
        InputError: nothing disturbs the loop, a plant with poles right of the axis, gains of other names.
    """

    question: str
    name: str
    plant: str
    loop: TransferLoop
    disturbances: tuple[Seaway | SlowDisturbance, ...]
    objectives: tuple[Objective, ...]
    constraints: ControllerConstraints
    U: float
    effectiveness: Effectiveness = Effectiveness.CONSTANT
    baselines: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    extended_structures: tuple[TransferLoop, ...] = ()
    schedule_grid: ScheduleGrid | None = None
    simulation: SimulationSettings | None = None
    trimmed_ship: TrimmedShip | None = None
    demand: Demand | None = None
    genetic: GeneticTuning = field(default_factory=GeneticTuning)
    drive: ActuatorDrive | None = None
    surface: LiftingSurface | None = None
    sample_s: float | None = None
    uncertainty: PlantUncertainty = _UNCERTAINTY
    track: TrackDemand | None = None
    station: StationDemand | None = None
    at_speed: "Callable[[float], TuningTask] | None" = None

    def __post_init__(self) -> None:
        if not self.disturbances or not self.objectives:
            raise InputError("a tuning needs a sea or another disturbance, and an objective")
        for name, gains in self.baselines.items():
            if set(gains) != set(self.loop.gains.names):
                raise InputError(f"controller '{name}' gives {', '.join(gains)}, the loop has "
                                 f"{', '.join(self.loop.gains.names)}; give exactly these")  # fmt: skip
        if self.demand is None:
            refuse_unstable(self.loop)

    @property
    def motion(self) -> Objective:
        """Of what the controller is to reduce: the acceleration at a point where the first objective is one, else the
        output.
        """
        row = self.objectives[0].variances[0]
        return vertical_acceleration(row.x) if row.signal is LoopSignal.POINT else OUTPUT

    @property
    def actuator_limits(self) -> ActuatorLimits:
        """What the actuator cannot do, as declared."""
        return ActuatorLimits(self.constraints.limit, self.constraints.rate, self.constraints.stall)

    @property
    def required_demand(self) -> Demand:
        """The demand.

        Raises:
            InputError: there is none.
        """
        if self.demand is None:
            raise InputError(f"tuning '{self.name}' follows no demand; give a change")
        return self.demand

    def loop_at(self, U: float, loop: TransferLoop | None = None) -> TransferLoop:
        """Return the loop (the task's own if none is given) at the speed U [m/s]."""
        made = self.loop if loop is None else loop
        if self.effectiveness is Effectiveness.CONSTANT or U == self.U:
            return made
        return replace(made, plant=made.plant.scaled((U / self.U) ** 2))


def refuse_unstable(loop: TransferLoop) -> None:
    """Refuse a plant that runs away by itself: what it does without control has no variance."""
    for block in (loop.plant, loop.disturbance):
        undamped = block.poles[(np.abs(block.poles.real) <= _UNDAMPED * np.abs(block.poles)) & (block.poles.imag > 0.0)]
        if undamped.size:
            omega = float(undamped[0].imag)
            raise InputError(
                f"block '{block.name}' swings undamped at {omega:.4g} rad/s (a period of {2.0 * math.pi / omega:.3g} s "
                f"with a damping ratio of {-undamped[0].real / abs(undamped[0]):.1g}): without control its motion has "
                "no bound; give its denominator the damping that every real one has, 0.01 and more"
            )
    for block in (loop.plant, loop.disturbance, *loop.sensor, *loop.servo, *loop.filters):
        poles = block.poles
        if block.order and poles.real.max() > 0.0:
            pole = poles[int(np.argmax(poles.real))]
            raise InputError(
                f"block '{block.name}' has a pole in the right half plane, at {pole.real:.4g} rad/s: it is unstable "
                "without control and its motion has no variance; check the signs of its denominator"
            )
