"""A designed manoeuvre as strict JSON: the one source of its documented schema. SI units and radians; null for none."""

from typing import Any

from pydantic import Field

from seatrial.core.results import Confirmation, Design, ManoeuvrePrecision
from seatrial.core.results.design_ranking import count_diverged, worst_sampled_error
from seatrial.core.values import Array
from seatrial.data.folder.fit_entries import Entry, Number
from seatrial.data.folder.fit_json import FindingEntry, finding_entry

FORMAT = 1


class ActuatorEntry(Entry):
    """An input that may be moved, in the signs of a record."""

    name: str
    lower: float
    upper: float
    rate: Number = Field(description="largest change in a second; null: it may jump")
    hold: float = Field(description="s, the shortest time between two orders")


class LimitsEntry(Entry):
    """What the trial may not leave; null: free."""

    drift: Number
    sea_room: Number
    for_every_ship: bool = Field(description="whether they bind the drawn ships, too")


class WorthEntry(Entry):
    """What one manoeuvre tells: standard errors over the magnitude of the coefficients."""

    name: str
    worst: Number = Field(description="largest of `relative`")
    mean: Number = Field(description="root mean square of `relative`")
    worst_sampled_error: Number = Field(
        description="largest over all drawn ships that do not diverge; null: none drawn"
    )
    diverged: int = Field(description="drawn ships that the simulation loses")
    relative_error: dict[str, Number] = Field(
        description="coefficient -> relative standard error, by the model's own values"
    )
    sampled_relative_error: list[dict[str, Number]] = Field(
        description="the same for each drawn ship; null where it diverges"
    )
    drift: Number = Field(description="largest drift angle of the ship as assumed, rad")
    distance: Number = Field(description="largest distance of the ship as assumed from the beginning, m")
    sampled_drift: list[Number] = Field(description="the same for each drawn ship")
    sampled_distance: list[Number]


class OrderEntry(Entry):
    """At this time [s] set these inputs."""

    time: float
    values: dict[str, float]


class ConfirmationEntry(Entry):
    """Fits of simulated noisy records: error found and error foretold, over the magnitude of each coefficient."""

    runs: int
    converged_runs: int
    error: dict[str, Number]
    bound: dict[str, Number]


class DesignDocument(Entry):
    """`design.json`, and what `seatrial design --json` writes."""

    format: int = FORMAT
    question: str
    ship: str
    model: str
    equation_hash: str
    criterion: str = Field(pattern="^(worst|mean)$")
    duration: float
    rate: float = Field(description="Hz at which the sensors are recorded")
    sensors: dict[str, float] = Field(description="channel -> standard deviation of its noise")
    actuators: list[ActuatorEntry]
    limits: LimitsEntry
    values: dict[str, Number] = Field(description="coefficient -> the value it is designed for")
    relative_spread: dict[str, Number] = Field(
        description="coefficient -> share by which drawn ships differ; standard deviation where it has a prior"
    )
    designed: WorthEntry
    baselines: list[WorthEntry] = Field(description="standard manoeuvres of equal duration")
    orders: list[OrderEntry]
    confirmation: ConfirmationEntry | None = Field(description="null: not tried")
    findings: list[FindingEntry]
    evaluations: int
    status: str = Field(description="how the search ended")
    elapsed_s: float
    versions: dict[str, str]
    seed: int


def design_json(design: Design) -> dict[str, Any]:
    """The documented schema, ready for `strict_json`."""
    names = design.coefficients
    known, parameters = design.confirmation, design.model.parameters
    document = DesignDocument(
        question=design.question,
        ship=design.ship,
        model=design.model.name,
        equation_hash=design.model.equation_hash,
        criterion=design.criterion,
        duration=design.duration,
        rate=design.rate,
        sensors=design.sensors,
        actuators=[ActuatorEntry.model_validate(a) for a in design.actuators],
        limits=LimitsEntry.model_validate(design.limits),
        values={name: parameters[name].value for name in names},
        relative_spread=_by_name(names, design.relative_spread),
        designed=_worth(design.designed, names),
        baselines=[_worth(rival, names) for rival in design.baselines],
        orders=[OrderEntry.model_validate(order) for order in design.orders],
        confirmation=_confirmation(known, names) if known else None,
        findings=[finding_entry(f) for f in design.findings],
        evaluations=design.solution.evaluations,
        status=design.solution.status.value,
        elapsed_s=design.elapsed_s,
        versions=design.versions,
        seed=design.seed,
    )
    return document.model_dump()


def design_schema() -> dict[str, Any]:
    """JSON Schema of `design_json`."""
    return DesignDocument.model_json_schema()


def _by_name(names: tuple[str, ...], values: Array) -> dict[str, Number]:
    return {name: float(value) for name, value in zip(names, values, strict=True)}


def _worth(worth: ManoeuvrePrecision, names: tuple[str, ...]) -> WorthEntry:
    return WorthEntry(
        name=worth.name,
        worst=worth.worst,
        mean=worth.mean,
        worst_sampled_error=worst_sampled_error(worth),
        diverged=count_diverged(worth),
        relative_error=_by_name(names, worth.relative_error),
        sampled_relative_error=[_by_name(names, row) for row in worth.sampled_relative_error],
        drift=worth.drift,
        distance=worth.distance,
        sampled_drift=[float(angle) for angle in worth.sampled_drift],
        sampled_distance=[float(distance) for distance in worth.sampled_distance],
    )


def _confirmation(confirmation: Confirmation, names: tuple[str, ...]) -> ConfirmationEntry:
    return ConfirmationEntry(
        runs=confirmation.runs,
        converged_runs=confirmation.converged_runs,
        error=_by_name(names, confirmation.error),
        bound=_by_name(names, confirmation.bound),
    )
