"""The plan of a campaign: a TOML file whose `kind` says what is varied, and the trial file behind it."""

import math
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, Field, TypeAdapter, ValidationError, model_validator

from seatrial.campaigns.work import canonical_json, refuse_count
from seatrial.core.values import InputError, spelling_hint
from seatrial.core.values.files import parse_toml, read_table_text
from seatrial.data.folder.model_file import read_earlier_result
from seatrial.data.read.record_file import file_digest
from seatrial.data.trial import EstimateSettings, Role, Trial, parse_tables, trial_of_tables
from seatrial.data.trial.amounts import InSi, PositiveDuration, SiAmount, Speed, StrictTable, schema_error
from seatrial.data.trial.load import read_tables
from seatrial.data.trial.runs import expand_variables
from seatrial.data.trial.schema import ModelTable, ShipTable, Strings
from seatrial.estimation.identify import IntervalMethod
from seatrial.physics.manoeuvres.programme import programme

# The plan of a campaign: a TOML file whose `kind` says what is varied.

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


# A trial file as part of a campaign: its tables, the files it reads, and what they contain.


@dataclass(frozen=True, eq=False)
class TrialSource:
    """A trial file and what it reads.

    Attributes:
        path: the file; table: its tables, with paths relative to its folder.
        files: record files, tables of forces and excitation, results that priors come from.
        equation_hash: of its model; empty where the trial cannot be loaded, which is the outcome of its tasks.
        training: name and session of each training run.
    """

    path: Path
    table: Mapping[str, Any]
    files: tuple[Path, ...]
    equation_hash: str
    training: tuple[tuple[str, str], ...]

    def content(self) -> str:
        """Return the canonical text of what its tasks depend on: tables, files by SHA-256, equations."""
        home = self.path.parent
        digests = {os.path.relpath(path, home): file_digest(path) for path in self.files}
        table = {"trial": _plain(self.table), "files": digests, "equations": self.equation_hash}
        return canonical_json(table).decode()


def trial_source(path: Path) -> TrialSource:
    """Read a trial file and find the files that it reads; one that is no valid trial stands for itself.

    Raises:
        InputError: it cannot be read, or is no TOML.
    """
    path = path.resolve()
    table = read_tables(path)
    try:
        parse_tables(table, path)
        table = _relative_paths(table, path.parent)
        trial = loaded(table, path)
    except InputError:
        return TrialSource(path, table, (), "", ())
    training = tuple((run.name, run.session) for run in trial.runs_with_role(Role.TRAIN))
    files = dict.fromkeys([*_record_files(trial), *_other_files(table, path.parent)])
    return TrialSource(path, table, tuple(files), trial.model.equation_hash, training)


def loaded(table: Mapping[str, Any], path: Path) -> Trial:
    """Return the trial of the tables of a file, from whose folder paths count; errors as in `load_trial`."""
    return trial_of_tables(parse_tables(dict(table), path), path, read_result=read_earlier_result)


def _record_files(trial: Trial) -> Iterator[Path]:
    for run in trial.runs:
        if run.role is not Role.LEAVE_OUT:
            yield from (file.path.resolve() for file in run.files)


def _other_files(table: Mapping[str, Any], home: Path) -> Iterator[Path]:
    base = home / table.get("data", {}).get("folder", ".")
    for block in (*table.get("forces", []), table.get("excitation", {})):
        if (path := base / str(block.get("file", ""))).is_file():
            yield path.resolve()
    for name in _strings(table.get("model", {}).get("priors_from", ())):
        if (path := home / name / "model.toml").is_file():
            yield path.resolve()


def _relative_paths(table: Mapping[str, Any], home: Path) -> dict[str, Any]:
    """Return the tables with environment variables put in and absolute paths made relative, so that files can move."""
    result = dict(table)
    if "folder" in table.get("data", {}):
        result["data"] = {**table["data"], "folder": _relative(table["data"]["folder"], home)}
    base = home / result.get("data", {}).get("folder", ".")
    if isinstance(table.get("records"), list):
        result["records"] = [_relative_files(block, base) for block in table["records"]]
    if "priors_from" in table.get("model", {}):
        names = [_relative(name, home) for name in _strings(table["model"]["priors_from"])]
        result["model"] = {**table["model"], "priors_from": names}
    return result


def _relative_files(block: Mapping[str, Any], base: Path) -> dict[str, Any]:
    result = dict(block)
    if "files" in block:
        result["files"] = [_relative(text, base) for text in _strings(block["files"])]
    if isinstance(block.get("sources"), list):
        result["sources"] = [_relative_source(source, base) for source in block["sources"]]
    return result


def _relative_source(source: Mapping[str, Any], base: Path) -> dict[str, Any]:
    return {**source, "file": _relative(source["file"], base)} if "file" in source else dict(source)


def _relative(text: str, base: Path) -> str:
    full = expand_variables(str(text))
    return os.path.relpath(full, base) if Path(full).is_absolute() else full


def _strings(value: Any) -> tuple[str, ...]:
    return (value,) if isinstance(value, str) else tuple(value)


def _plain(value: Any) -> Any:
    """Return a value of TOML as one of JSON: dates and infinities as text."""
    if isinstance(value, dict):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    is_number = isinstance(value, int) or (isinstance(value, float) and math.isfinite(value))
    return value if is_number or isinstance(value, str) else repr(value)
