"""A tuned controller: judged in theory and in simulation, the search, the front, the choice, the schedule. SI."""

import math
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field, computed_field

from seatrial.core.results.fields import (
    ComplexArray,
    ListedArray,
    Number,
    ReportedFinding,
    StoredArray,
    StoredRecord,
    StoredSolution,
    Summarised,
    Summary,
    named_by,
)
from seatrial.core.results.station import StationKeeping
from seatrial.core.values import Array, InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure


# A published search for gains: the answers of several seeds, and what one search costs.


@dataclass(frozen=True, eq=False)
class GainSearch:
    """A published search for gains: what it made small, its answers by seed, its cost. Rows: one for each seed."""

    source: Annotated[str, Field(description="the publication")]
    settings: Annotated[dict[str, str], Field(description="name -> value, as in the loop file")]
    objectives: Annotated[dict[str, str], Field(description="what was made small: name -> unit")]
    evaluations: Annotated[int, Field(description="controllers that one search evaluates")]
    cpu_s: Annotated[Number, Field(description="CPU time of one search with its front, median of the seeds")]
    histories: Annotated[
        ListedArray,
        Field(description="J of the fittest under equal weights in each generation, shape (seeds, generations)"),
    ]
    gain_names: Annotated[tuple[str, ...], Field(description="columns of `gains`, `lower`, `upper` and `spread`")]
    gains: Annotated[ListedArray, Field(description="answers, shape (seeds, g); the first is the controller chosen")]
    lower: Annotated[ListedArray, Field(description="bounds of the search, shape (g,)")]
    upper: Annotated[ListedArray, Field(description="bounds of the search, shape (g,)")]
    spread: Annotated[
        ListedArray, Field(description="largest minus smallest answer over the range searched, shape (g,)")
    ]
    values: Annotated[ListedArray, Field(description="objectives of the tuning at the answers, shape (seeds, m)")]
    Ms: Annotated[ListedArray, Field(description="of the answers, shape (seeds,)")]
    is_feasible: Annotated[tuple[bool, ...], Field(description="whether each answer keeps all constraints")]
    dominated: Annotated[int, Field(description="answers beaten in every objective by a controller of the front")]
    hypervolume: Annotated[
        Number,
        Field(description="of what the first search saw within the constraints, over that of the package's front"),
    ]

    @computed_field(description="J of the fittest in each generation, first seed")
    @property
    def history(self) -> tuple[float, ...]:
        """Return J of the fittest in each generation of the first seed."""
        return tuple(float(value) for value in self.histories[0])

    @property
    def feasible_count(self) -> int:
        """Return how many answers keep all constraints."""
        return int(np.sum(self.is_feasible))


# A tuned controller: judged by linear theory and in simulation, the front, the choice, the schedule. SI.


SECONDS_AN_HOUR = 3600.0  # s, by definition


@dataclass(frozen=True)
class Component:
    """One block of the loop: num(s) / den(s), coefficients of s [rad/s], highest power first."""

    role: Annotated[str, Field(description="sensor, term, filter, servo, plant, disturbance")]
    name: str
    num: tuple[float, ...]
    den: tuple[float, ...]
    gain: Annotated[str, Field(description="name of the gain that multiplies a term; empty for other blocks")] = ""
    source: str = ""


@dataclass(frozen=True)
class DiscreteBlock:
    """One block of the controller as y[k] = b_0 x[k] + b_1 x[k-1] + ... - a_1 y[k-1] - ...; terms stand in parallel."""

    role: Annotated[str, Field(description="term or filter")]
    name: str
    gain: Annotated[str, Field(description="name of the gain that multiplies a term; empty for a filter")]
    b: Annotated[tuple[float, ...], Field(description="of the input, newest first")]
    a: Annotated[tuple[float, ...], Field(description="the first is 1")]
    hold: Annotated[
        int,
        Field(
            description="of a term that keeps its last output where the actuator is at a limit, the sign of its share "
            "of the order; 0: it keeps none"
        ),
    ] = 0


@dataclass(frozen=True)
class ReferenceFilter:
    """What the loop follows in place of an order r: x'' + 2 w x' + w^2 x = w^2 r, |x'| <= rate, w = 1 / time_constant.

    To the actuator's order level x + velocity x' + acceleration x'' is added, each times SI; zero without feed-forward.
    """

    time_constant: Annotated[float, Field(description="s")]
    rate: Annotated[Number, Field(description="fastest change of the output asked, SI per second; null: any")]
    level: Annotated[float, Field(description="SI of the actuator for each of the output")] = 0.0
    velocity: Annotated[float, Field(description="the same, times s")] = 0.0
    acceleration: Annotated[float, Field(description="the same, times s^2")] = 0.0


@dataclass(frozen=True)
class DiscreteController:
    """The chosen controller by Tustin's rule, from what the sensor gives to the servo's order, as it was simulated."""

    sample_s: Annotated[float, Field(description="s; the order stands for as long")]
    blocks: tuple[DiscreteBlock, ...]
    dead_time: Annotated[float, Field(description="s from the order to the servo, as it was simulated")] = 0.0
    noise: Annotated[float, Field(description="rms of each sample of the output, SI, as it was simulated")] = 0.0
    resolution: Annotated[float, Field(description="step in which the output is read, SI, as it was simulated")] = 0.0
    reference: Annotated[ReferenceFilter | None, Field(description="null: no demand is followed")] = None
    sensor: Annotated[
        tuple[Component, ...], Field(description="in s, in a row between the error of the output and its sample")
    ] = ()


@dataclass(frozen=True)
class ControllerConstraints:
    """What every controller must keep."""

    Ms: Annotated[Number, Field(description="largest Ms")] = 2.0
    saturation: Annotated[
        Number, Field(description="largest share of actuator amplitudes beyond its limit (Rayleigh)")
    ] = 0.2  # dimensionless, chosen
    # dimensionless, chosen
    rate_saturation: Annotated[Number, Field(description="largest share of rate amplitudes beyond its rate")] = 0.2
    limit: Annotated[Number, Field(description="of the actuator, SI; null: none (infinite)")] = float("inf")
    rate: Annotated[Number, Field(description="of the actuator, SI per second; null: none (infinite)")] = float("inf")
    stall: Annotated[Number, Field(description="of the actuator, SI; null: none (infinite)")] = float("inf")
    delay: Annotated[Number, Field(description="least delay margin, s: twice the declared dead time")] = 0.0


@dataclass(frozen=True, eq=False)
class Controller:
    """One set of gains and what linear theory says of it in the seas of the task."""

    name: Annotated[str, Field(description="chosen, given, fitted baseline and the like")]
    gains: Annotated[dict[str, float], Field(description="name -> value")]
    objectives: Annotated[Array, named_by("objectives"), Field(description="objective -> value, shape (m,)")]
    rms: Annotated[
        dict[str, Number],
        Field(description="of output, actuator, actuator_rate, and motion if named, SI, mean square over the seas"),
    ]
    reduction: Annotated[
        Number,
        Field(
            description="of the rms of output, or motion if named, against no control, 0 to 1; null: nothing to compare"
        ),
    ]
    Ms: Annotated[Number, Field(description="Ms, the largest |S|; null: unstable")]
    gain_margin: Annotated[Number, Field(description="factor by which the loop gain may grow; null: any")]
    phase_margin: Annotated[Number, Field(description="rad; null: the loop gain never crosses one")]
    delay_margin: Annotated[Number, Field(description="s of dead time until the loop is unstable; null: any")]
    damping: Annotated[Number, Field(description="least damping ratio of a closed-loop pole")]
    saturation: Annotated[
        Number, Field(description="share of actuator amplitudes beyond the limit, worst of the seas, 0 to 1")
    ]
    rate_saturation: Annotated[Number, Field(description="the same of rate amplitudes")]
    violated: Annotated[tuple[str, ...], Field(description="constraints not kept, a phrase each; empty: feasible")]
    omega: Annotated[ListedArray, Field(description="rad/s at which the open loop is given, shape (n,)")]
    open_loop: Annotated[
        ComplexArray, Field(description="L there, real and imaginary part; the sensitivity is 1 / (1 + L)")
    ]
    lower_gain_margin: Annotated[
        Number, Field(description="factor to which the loop gain may fall; 0: any; null: unstable")
    ] = math.nan
    noise_gain: Annotated[
        Number, Field(description="largest |K S|: actuator amplitude for each unit of sensor noise; null: unstable")
    ] = math.nan
    reversals: Annotated[
        Number, Field(description="times an hour that the actuator turns back, mean over the seas; null: unstable")
    ] = math.nan
    energy: Annotated[
        Number, Field(description="J that the drive gives for each reversal; null: no inertia was declared")
    ] = math.nan

    @computed_field(description="W, mean power of the drive: energy times reversals; null: no inertia was declared")
    @property
    def power(self) -> Number:
        """Return the mean power of the drive [W]."""
        return self.energy * self.reversals / SECONDS_AN_HOUR


@dataclass(frozen=True, eq=False)
class ParetoFront:
    """Controllers of which none is better than another in all objectives; a row of each array for each."""

    name: Annotated[str, Field(description="three gains and the like")]
    gain_names: Annotated[tuple[str, ...], Field(description="columns of `gains`")]
    gains: Annotated[ListedArray, Field(description="shape (n, g)")]
    objectives: Annotated[ListedArray, Field(description="shape (n, m), columns in the order of the objectives")]
    Ms: Annotated[ListedArray, Field(description="shape (n,)")]
    evaluations: Annotated[int, Field(description="number of controllers evaluated")]
    hypervolume: Annotated[Number, Field(description="of the front over that of a brute-force grid; null: no grid")] = (
        float("nan")
    )
    cpu_s: Annotated[Number, Field(description="CPU time of the search; null: not measured")] = float("nan")


@dataclass(frozen=True, eq=False)
class OperatingPoint:
    """One condition of the schedule; a cost is the output's rms over that without control.

    Of a loop that follows a demand it is the rms itself, SI: a heading has none without control.
    """

    U: Annotated[float, Field(description="m/s")]
    beta: Annotated[float, Field(description="rad, 0: following sea, pi: head sea")]
    height: Annotated[float, Field(description="m, significant wave height")]
    gains: dict[str, float]
    cost: Number
    Ms: Number
    saturation: Number
    baseline_costs: Annotated[dict[str, Number], Field(description="name of other gains -> their cost there")]
    is_feasible: bool
    lacks: Annotated[
        tuple[str, ...], Field(description="what is not kept there, in simulation too, a phrase each; empty: nothing")
    ] = ()


@dataclass(frozen=True)
class ScheduleTrade:
    """What a largest step between neighbouring conditions costs."""

    largest_step: Annotated[Number, Field(description="of a gain, as a share of the larger of two; null: any")]
    cost: Annotated[float, Field(description="mean over the conditions")]


@dataclass(frozen=True)
class ScheduleCheck:
    """The schedule with its gains interpolated, in the middle between its conditions too."""

    conditions: int
    feasible: Annotated[int, Field(description="how many of them keep the constraints")]
    Ms: Annotated[Number, Field(description="the largest of them; null: unstable somewhere")]


@dataclass(frozen=True)
class PerformanceBound:
    """The least output variance that a linear controller of its kind reaches."""

    name: str
    ratio: Annotated[Number, Field(description="output variance over that of the chosen controller")]
    conditions: Annotated[str, Field(description="what is held equal (actuator rate energy), the spectrum and the Ms")]
    note: Annotated[str, Field(description="what it means")]


@dataclass(frozen=True, eq=False)
class SeawaySimulation:
    """One controller over seeds of the sea: reductions of the rms as of `Controller`, 0 to 1, shape (seeds,)."""

    name: str
    linear: Annotated[ListedArray, Field(description="without limits")]
    limited: Annotated[ListedArray, Field(description="with limits of angle and rate")]
    stalled: Annotated[ListedArray, Field(description="with stall, too")]
    record: Annotated[
        StoredRecord,
        Field(
            description="first seed, all limits on: output, actuator, disturbance, and the output of the same sea "
            "without control, its name with _uncontrolled"
        ),
    ]
    drive_energy: Annotated[
        ListedArray, Field(description="J in an hour by the drive, all limits on; empty: no inertia was declared")
    ] = field(default_factory=lambda: np.empty(0))
    drag_energy: Annotated[
        ListedArray,
        Field(
            description="J in an hour by the drag of fins or rudders, all limits on, without losses of the propulsion; "
            "empty: no area was declared"
        ),
    ] = field(default_factory=lambda: np.empty(0))

    @computed_field(description="reduction lost to limits of angle and rate, mean over the seeds")
    @property
    def saturation_loss(self) -> Number:
        """Return the reduction lost to limits of angle and rate, mean over the seeds."""
        return float(np.mean(self.linear - self.limited))


@dataclass(frozen=True)
class DisturbanceSimulation:
    """The chosen controller in one disturbance: rms of output, actuator and actuator_rate, SI, over realisations."""

    disturbance: Annotated[str, Field(description="in words")]
    seeds: int
    predicted: Annotated[dict[str, Number], Field(description="by linear theory")]
    unlimited: Annotated[dict[str, Number], Field(description="simulated without limits")]
    limited: Annotated[
        dict[str, Number], Field(description="simulated with the actuator's limits of angle and rate; null: runs away")
    ]
    standard_error: Annotated[dict[str, Number], Field(description="of `unlimited`, from its scatter over the seeds")]


@dataclass(frozen=True)
class PairedDifference:
    """Reduction of the chosen controller minus that of another on the same seas, with its 95 % interval."""

    baseline: Annotated[str, Field(description="name of the other controller")]
    stage: Annotated[str, Field(description="linear, limited or stalled")]
    mean: Number
    lower: Number
    upper: Number
    seeds: int


@dataclass(frozen=True, eq=False)
class ManoeuvreResponse:
    """One controller through a demand with the nonlinear model: a course or speed change, a zigzag."""

    name: str
    controller: Annotated[str, Field(description="name of the controller")]
    record: Annotated[StoredRecord, Field(description="demand and response")]
    output: Annotated[str, Field(description="symbol of the output")]
    overshoot: Annotated[Number, Field(description="share of the change")]
    settling: Annotated[Number, Field(description="s to stay within 5 %; null: never")]
    stable_draws: Annotated[int, Field(description="ships drawn from the fit's covariance with a stable loop")]
    draws: Annotated[int, Field(description="ships drawn from the fit's covariance")]
    worst_overshoot: Annotated[Number, Field(description="over the ships drawn; null: none drawn")]
    sampled_outputs: Annotated[
        StoredArray, Field(description="outputs of some of the ships drawn, on the record's time, shape (k, n)")
    ]
    is_to_settle: Annotated[
        bool, Field(description="whether it is to settle: false for a zigzag, whose legs end before")
    ] = True


@dataclass(frozen=True)
class Robustness:
    """One controller on ships that differ from the model, by linear theory."""

    controller: Annotated[str, Field(description="name of the controller")]
    draws: Annotated[int, Field(description="ships drawn from the fit's covariance; 0: it has none")]
    stable_draws: int
    draws_Ms: Annotated[Number, Field(description="the largest Ms of them; null: unstable, or none drawn")]
    corners: Annotated[int, Field(description="corners of the box of gain, time constants and dead time")]
    stable_corners: int
    corners_Ms: Annotated[Number, Field(description="the largest Ms of them; null: unstable")]
    worst_corner: Annotated[str, Field(description="the corner of the largest Ms, in words")]


class TuningMethod(StrEnum):
    """Where the chosen gains come from: the package's own front, or a published search."""

    FRONT = "front"
    GENETIC = "genetic"


@dataclass(frozen=True, eq=False)
class CornerResponse:
    """A corner of a track, taken by the nonlinear model within its limits in a steady current towards the outside."""

    turn: Annotated[float, Field(description="of the track, rad, positive to starboard")]
    acceptance: Annotated[float, Field(description="m along the track before the corner at which the leg is taken")]
    current: Annotated[float, Field(description="m/s, across the new leg")]
    record: Annotated[StoredRecord, Field(description="position from the corner, heading, actuator, distance")]
    overshoot: Annotated[Number, Field(description="m beyond the new leg")]
    worst_overshoot: Annotated[Number, Field(description="m, over the craft drawn that are stable; null: none")]
    stable_draws: Annotated[
        int, Field(description="craft drawn from the fit's covariance that settle behind the corner")
    ]
    draws: Annotated[int, Field(description="craft drawn from the fit's covariance")]
    is_kept: Annotated[bool, Field(description="whether the identified craft settles there")] = True


@dataclass(frozen=True, eq=False)
class TrackKeeping:
    """Line of sight with an integral around the heading loop: psi_d = chi - atan((e + sigma q) / Delta).

    q' = Delta e / ((e + sigma q)^2 + Delta^2) (Borhaug, Pavlov & Pettersen 2008). Margins are those of the outer loop,
    at the heading order, with the heading loop closed.
    """

    lookahead: Annotated[Number, Field(description="Delta, m")]
    integral_gain: Annotated[Number, Field(description="sigma, m/s")]
    order_rate: Annotated[Number, Field(description="fastest change of the heading order, rad/s")]
    speed: Annotated[Number, Field(description="m/s, at which it was tuned")]
    Ms: Number
    gain_margin: Annotated[Number, Field(description="factor; null: any")]
    phase_margin: Annotated[Number, Field(description="rad; null: any")]
    delay_margin: Annotated[Number, Field(description="s; null: any")]
    disturbances: Annotated[
        tuple[DisturbanceSimulation, ...], Field(description="distance [m], actuator and its rate on a straight track")
    ]
    corner: CornerResponse


_EQUAL_GAINS = 1e-3  # share of a gain by which controllers that count as equal differ at most; chosen


def _has_equal_gains(one: Controller, other: Controller) -> bool:
    """Return whether two controllers have the same terms and gains."""
    return one.gains.keys() == other.gains.keys() and all(
        math.isclose(value, other.gains[name], rel_tol=_EQUAL_GAINS) for name, value in one.gains.items()
    )


@dataclass(frozen=True, eq=False, repr=False)
class Tuning(Summarised):
    """A tuned controller with everything its page shows."""

    question: str
    name: str
    plant: Annotated[str, Field(description="where it comes from, in a sentence")]
    seas: Annotated[tuple[str, ...], Field(description="those it is tuned in, a sentence each")]
    output: Annotated[str, Field(description="symbol of what is to stay small")]
    actuator: Annotated[str, Field(description="symbol of what moves")]
    objectives: Annotated[dict[str, str], Field(description="name -> unit, in order")]
    constraints: ControllerConstraints
    chosen: Annotated[Controller, Field(description="the recommendation")]
    reasons: Annotated[tuple[str, ...], Field(description="why, sentence by sentence")]
    baselines: Annotated[tuple[Controller, ...], Field(description="given gains and other choices")]
    front: Annotated[ParetoFront, Field(description="with the task's own gains")]
    extended_fronts: Annotated[
        tuple[ParetoFront, ...], Field(description="fronts of more structure or other comparisons")
    ]
    components: Annotated[
        tuple[Component, ...], Field(description="blocks of the chosen loop, so that other programs can rebuild it")
    ]
    seaway_simulations: tuple[SeawaySimulation, ...]
    paired_differences: tuple[PairedDifference, ...]
    schedule: Annotated[
        tuple[OperatingPoint, ...], Field(description="smooth: neighbouring gains differ by the largest step at most")
    ]
    bounds: tuple[PerformanceBound, ...]
    manoeuvres: tuple[ManoeuvreResponse, ...]
    findings: tuple[ReportedFinding, ...]
    solution: StoredSolution
    seed: int
    elapsed_s: float
    versions: Annotated[dict[str, str], Field(description="package -> version")] = field(default_factory=dict)
    method: Annotated[TuningMethod, Field(description="where the chosen gains come from")] = TuningMethod.FRONT
    search: Annotated[GainSearch | None, Field(description="the published search; null: none")] = None
    reference: Annotated[
        Controller | None, Field(description="the package's own choice beside that of a published search; null: chosen")
    ] = None
    gain_units: Annotated[dict[str, str], Field(description="name of a gain -> its unit")] = field(default_factory=dict)
    discrete: Annotated[DiscreteController | None, Field(description="difference equations; null: unstable")] = None
    schedule_trades: Annotated[tuple[ScheduleTrade, ...], Field(description="smoothness against cost")] = ()
    schedule_check: Annotated[ScheduleCheck | None, Field(description="between conditions; null: no schedule")] = None
    designs: Annotated[
        tuple[Controller, ...], Field(description="a more robust and a harder working design beside the chosen one")
    ] = ()

    disturbance_simulations: Annotated[
        tuple[DisturbanceSimulation, ...], Field(description="of a servo loop: the output kept, with limits")
    ] = ()
    motion: Annotated[
        str, Field(description="of what reductions are, its rms in m/s^2 under `motion`; empty: of the output")
    ] = ""
    robustness: Annotated[
        tuple[Robustness, ...], Field(description="of the stable controllers compared, the chosen one first")
    ] = ()
    energy_savings: Annotated[
        tuple[PairedDifference, ...],
        Field(description="J in an hour that the chosen gains need less than others in the same seas, all limits on"),
    ] = ()
    track: Annotated[TrackKeeping | None, Field(description="guidance along a track; null: none")] = None
    station: Annotated[StationKeeping | None, Field(description="a place kept by thrusters; null: none")] = None

    @property
    def compared(self) -> tuple[Controller, ...]:
        """Return the chosen controller, the package's own, designs and baselines; equal ones as one, of all names."""
        return tuple(replace(c, name=self.shared_names[c.name]) for c in self._named if c.name in self.shared_names)

    @property
    def shared_names(self) -> dict[str, str]:
        """Return of each first of equal controllers its name with those of the others."""
        groups: list[list[Controller]] = []
        for c in self._named:
            group = next((group for group in groups if _has_equal_gains(group[0], c)), None)
            groups.append([c]) if group is None else group.append(c)
        return {group[0].name: ", ".join(c.name for c in group) for group in groups}

    @property
    def _named(self) -> tuple[Controller, ...]:
        return (self.chosen, *(() if self.reference is None else (self.reference,)), *self.designs, *self.baselines)

    @property
    def units(self) -> tuple[str, ...]:
        """Return the unit of each objective, in order."""
        return tuple(self.objectives.values())

    @computed_field(description="number of controllers evaluated")
    @property
    def evaluations(self) -> int:
        """Return the number of controllers evaluated."""
        return self.solution.evaluations

    @computed_field(description="how the search ended and what to do next")
    @property
    def status(self) -> str:
        """Return how the search ended and what to do next."""
        return self.solution.status.value

    def plot(self) -> "Figure":
        """Draw the front with the controllers compared, or the magnitudes of S and T where there is one objective.

        Raises:
            InputError: neither a front nor a loop is known.
        """
        from seatrial.core.figures.matplotlib_axes import matplotlib_figure
        from seatrial.core.results.front_chart import front_chart
        from seatrial.core.results.loop_charts import sensitivity_chart

        chart = front_chart(self) or sensitivity_chart(self)
        if chart is None:
            raise InputError(f"the tuning '{self.name}' has neither a front nor a stable loop to plot")
        return matplotlib_figure(chart)

    def summary(self) -> Summary:
        """Return the gains and margins of the chosen and the other controllers as a table."""
        header = ("controller", *self.chosen.gains, "Ms", "gain margin", "phase margin [deg]", "damping")
        rows = tuple(
            (
                c.name, *(f"{c.gains[name]:.5g}" if name in c.gains else "" for name in self.chosen.gains),
                f"{c.Ms:.3g}", f"{c.gain_margin:.3g}", f"{math.degrees(c.phase_margin):.3g}", f"{c.damping:.2g}",
            )
            for c in self.compared
        )  # fmt: skip
        facts = {"plant": self.plant, "output": self.output, "actuator": self.actuator, "search": self.status}
        return Summary(f"Tuning of {self.name}", header, rows, facts, self.reasons)
