"""The plan of a campaign: a TOML file whose `kind` says what is varied."""

import math
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, Field, TypeAdapter, ValidationError, model_validator

from seatrial.campaigns.work import refuse_count
from seatrial.core.values import InputError, spelling_hint
from seatrial.core.values.files import parse_toml, read_table_text
from seatrial.data.trial import EstimateSettings
from seatrial.data.trial.amounts import InSi, PositiveDuration, SiAmount, Speed, StrictTable, schema_error
from seatrial.data.trial.schema import ModelTable, ShipTable, Strings
from seatrial.estimation.identify import IntervalMethod
from seatrial.physics.manoeuvres.programme import programme

# most seeds of a plan: chosen, as many as a campaign may have tasks
Count = Annotated[int, Field(ge=1, le=1_000_000)]
Grid = dict[str, Annotated[tuple[Any, ...], Field(min_length=1)]]
PositiveRate = Annotated[float, InSi("rad/s", is_positive=True)]


class RepeatedPlan(StrictTable):
    """What every kind has.

    Attributes:
        question: one sentence for the page.
        seeds: number of seeds; first_seed: the first of them, the others follow.
        intervals: as `--intervals` of identify.
    """

    question: str = ""
    seeds: Count = 1
    first_seed: Annotated[int, Field(ge=0)] = 0
    intervals: IntervalMethod = IntervalMethod.AUTO


class MonteCarloPlan(RepeatedPlan):
    """`kind = "montecarlo"`: a model as truth; each seed adds noise to its manoeuvres, which are then identified.

    Attributes:
        truth: a model file of identify; or the tables [ship] and [model] of a trial file state the truth.
        start: where the search starts: at the truth, at zero, or at these values of coefficients.
        manoeuvres: as `--manoeuvre` of simulate; each is a training run.
        speed: approach speed [m/s]; without it the one at which surge balances.
        inputs: constant inputs besides the rudder, SI.
        rudder_rate: of the rudder [rad/s]; without it SOLAS's at the ship's scale.
        approach: straight run before the first order [s].
        step: of the simulation [s], finer than the records, so that no model fits its own integrator.
        rate: of the records [Hz].
        noise: channel -> standard deviation of its white Gaussian noise; these channels are measured.
        estimate: as in a trial file.
    """

    kind: Literal["montecarlo"]
    truth: str | None = None
    ship: ShipTable | None = None
    model: ModelTable | None = None
    start: Literal["truth", "zero"] | dict[str, SiAmount] = "truth"
    manoeuvres: Annotated[Strings, Field(min_length=1)]
    speed: Speed | None = None
    inputs: dict[str, SiAmount] = Field(default_factory=dict)
    rudder_rate: PositiveRate | None = None
    approach: PositiveDuration = 10.0
    step: PositiveDuration = 0.02
    rate: Annotated[float, Field(gt=0)] = 10.0
    noise: Annotated[dict[str, SiAmount], Field(min_length=1)]
    estimate: EstimateSettings = EstimateSettings()

    @model_validator(mode="after")
    def _one_truth(self) -> Self:
        if (self.truth is None) == (self.model is None):
            raise ValueError("the truth is stated by truth = 'model.toml', or by [ship] and [model]; give one of them")
        if self.model is not None and self.ship is None:
            raise ValueError("[ship], with name and L, is missing; add it")
        for text in self.manoeuvres:
            programme(text)
        return self


class GridPlan(RepeatedPlan):
    """`kind = "grid"`: one trial, identified with every combination of overridden keys.

    Attributes:
        trial: the trial file.
        grid: key of the trial file, with dots (`estimate.rate`, `records.1.rate`; blocks count from 1) -> its values.
    """

    kind: Literal["grid"]
    trial: str
    grid: Annotated[Grid, Field(min_length=1)]


class FoldsPlan(RepeatedPlan):
    """`kind = "folds"`: one trial, each training run or session left out in turn and predicted.

    Attributes:
        trial: the trial file; its own validation runs are left out of all folds.
        by: what is left out.
        grid: as in a grid; each combination is cross-validated.
    """

    kind: Literal["folds"]
    trial: str
    by: Literal["run", "session"] = "run"
    grid: Grid = Field(default_factory=dict)


class FleetPlan(RepeatedPlan):
    """`kind = "fleet"`: many trial files, each identified.

    Attributes:
        trials: paths or patterns (`fleet/*.toml`, `**/trial.toml`) from the plan's folder.
        grid: as in a grid, for every trial.
    """

    kind: Literal["fleet"]
    trials: Annotated[Strings, Field(min_length=1)]
    grid: Grid = Field(default_factory=dict)


CampaignPlan = MonteCarloPlan | GridPlan | FoldsPlan | FleetPlan
KINDS: dict[str, type[BaseModel]] = {
    "montecarlo": MonteCarloPlan, "grid": GridPlan, "folds": FoldsPlan, "fleet": FleetPlan,
}  # fmt: skip


def read_plan(path: Path) -> CampaignPlan:
    """Return the plan of a file.

    Raises:
        InputError: no such file, no TOML, an unknown kind or key, a value of the wrong kind, or too many tasks.
    """
    try:
        table = parse_toml(read_table_text(path))
    except OSError as error:
        raise InputError(f"plan '{path}' cannot be read ({error.strerror}); check the path") from None
    except ValueError as error:
        raise InputError(f"plan '{path}' is no valid TOML: {error}") from None
    return parse_plan(table, str(path))


def parse_plan(table: dict[str, Any], where: str) -> CampaignPlan:
    """Return the plan of its table; `where` begins the messages. Errors as in `read_plan`."""
    if "kind" not in table:
        raise InputError(f"{where}: key 'kind' is missing; add one of {', '.join(KINDS)}")
    kind = KINDS.get(str(table["kind"]))
    if kind is None:
        raise InputError(f"{where}: unknown kind '{table['kind']}'{spelling_hint(str(table['kind']), list(KINDS))}")
    try:
        plan: CampaignPlan = kind.model_validate(table)  # type: ignore[assignment]
        refuse_count(plan.seeds * math.prod(len(values) for values in getattr(plan, "grid", {}).values()))
    except ValidationError as error:
        raise schema_error(error, kind, where) from None
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    return plan


def plan_schema() -> dict[str, Any]:
    """Return the JSON Schema of a plan, for editors."""
    return TypeAdapter(Annotated[CampaignPlan, Field(discriminator="kind")]).json_schema()
