"""A designed manoeuvre: what was asked, what to steer, and what it is worth beside the standard ones. Plain values."""

from dataclasses import dataclass, field

from seatrial.core.equations import Model
from seatrial.core.values import Array, Finding, Record
from seatrial.numerics.optimise import Solution


@dataclass(frozen=True)
class Actuator:
    """An input that the helmsman may move: its range and its largest rate, SI and in the record's signs.

    `rate` is infinite where it may jump; `hold` [s] is the shortest time between two orders.
    """

    name: str
    lower: float
    upper: float
    rate: float
    hold: float


@dataclass(frozen=True)
class TrialLimits:
    """What the trial may not leave: drift angle [rad] and distance from where it begins [m]; infinite: free.

    They bind the ship as assumed; `for_every_ship`: each one drawn from the prior, too.
    """

    drift: float = float("inf")
    sea_room: float = float("inf")
    for_every_ship: bool = False


@dataclass(frozen=True, eq=False)
class ManoeuvrePrecision:
    """What one manoeuvre of the trial's duration tells of each coefficient.

    Attributes:
        name: ``designed``, ``zigzag:20/20``, ``prbs:35:10`` and the like.
        relative: standard error over the magnitude of the coefficient at the model's own values, shape (k,).
        drawn: the same for each ship drawn from the prior, shape (draws, k); NaN where the simulation diverges.
        drift, room: largest drift angle [rad] and distance [m] of the ship as assumed.
        drawn_drift, drawn_room: those of each ship drawn, shape (draws,).
        executed: simulated by the model's own values, sensors' rate; its track is the plan's.
    """

    name: str
    relative_error: Array
    sampled_relative_error: Array
    drift: float
    distance: float
    sampled_drift: Array
    sampled_distance: Array
    executed: Record

    @property
    def worst(self) -> float:
        """The least well told coefficient's relative standard error."""
        return float(self.relative_error.max())

    @property
    def mean(self) -> float:
        """Root mean square of the relative standard errors."""
        return float((self.relative_error**2).mean() ** 0.5)


@dataclass(frozen=True)
class TimedOrder:
    """One line of the helmsman's table: at `time` [s] set `values` (input -> SI, record's signs)."""

    time: float
    values: dict[str, float]


@dataclass(frozen=True, eq=False)
class Confirmation:
    """The design tried on simulated trials: fits of noisy records instead of the bound.

    Attributes:
        runs: how many were simulated; converged: how many fits succeeded.
        error: root-mean-square error over the magnitude of each coefficient, shape (k,).
        bound: root mean square of the relative standard errors that the bound foretells for the same ships, (k,).
    """

    runs: int
    converged_runs: int
    error: Array
    bound: Array


@dataclass(frozen=True, eq=False)
class Design:
    """A manoeuvre that tells the coefficients as well as the limits allow.

    Attributes:
        coefficients: names of the free coefficients, k.
        sensors: channel -> standard deviation of its noise, SI; `rate`: Hz at which they are recorded.
        designed: the manoeuvre found; rivals: standard manoeuvres of equal duration under the same limits.
        plan: inputs only, `Kind.PLANNED`, at the sensors' rate; orders: the helmsman's table.
        criterion: ``worst`` or ``mean``.
        spread: by what share of its size each coefficient of a drawn ship may differ, shape (k,): evenly up to it, or a
            standard deviation where a prior or a fit's covariance is known.
    """

    question: str
    ship: str
    model: Model
    coefficients: tuple[str, ...]
    sensors: dict[str, float]
    rate: float
    duration: float
    actuators: tuple[Actuator, ...]
    limits: TrialLimits
    criterion: str
    relative_spread: Array
    designed: ManoeuvrePrecision
    baselines: tuple[ManoeuvrePrecision, ...]
    orders: tuple[TimedOrder, ...]
    plan: Record
    solution: Solution
    confirmation: Confirmation | None
    findings: tuple[Finding, ...]
    seed: int
    elapsed_s: float
    versions: dict[str, str] = field(default_factory=dict)
