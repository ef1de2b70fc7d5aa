"""Campaigns over trial files: a grid of overridden keys, runs left out, a fleet."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

from seatrial.campaigns.engines import CarriedFiles, carried_files, common_folder
from seatrial.campaigns.plan import FleetPlan, FoldsPlan, GridPlan, TrialSource, loaded, trial_source
from seatrial.campaigns.work import Row, Work, fit_rows, overridden, refuse_count
from seatrial.core.values import InputError
from seatrial.data.trial import Role, Trial, parse_tables
from seatrial.estimation.identify import IntervalMethod, identify

TRIAL, FOLD, SEED = "trial", "fold", "seed"


@dataclass(frozen=True, eq=False)
class TrialTask:
    """Identifies one trial of a campaign.

    Attributes:
        root: folder that holds all files; names: trial -> path of its file below that; tables: trial -> its tables.
        files: of all trials.
        by: what a fold leaves out, ``run`` or ``session``.
    """

    root: Path
    names: Mapping[str, str]
    tables: Mapping[str, Mapping[str, Any]]
    files: tuple[Path, ...]
    by: str
    intervals: IntervalMethod

    def __call__(self, keys: Mapping[str, Any]) -> Sequence[Row]:
        """Return the rows of one task; errors are those of loading the trial and of `identify`."""
        name = keys.get(TRIAL, next(iter(self.names)))
        overrides = {key: value for key, value in keys.items() if key not in (TRIAL, FOLD, SEED)}
        trial = loaded(overridden(self.tables[name], overrides), self.root / self.names[name])
        if FOLD in keys:
            trial = without_fold(trial, keys[FOLD], self.by)
        return fit_rows(identify(trial, keys[SEED], intervals=self.intervals))

    def carried(self) -> CarriedFiles:
        """Read the files that travel to another machine."""
        return carried_files(self.root, self.files)

    def moved(self, root: Path) -> "TrialTask":
        """Return the same where the files lie in another folder."""
        return replace(self, root=root)


def without_fold(trial: Trial, fold: str, by: str) -> Trial:
    """Return the trial with one training run or session held out for validation, and no other validation run.

    Raises:
        InputError: the trial has no such run or session.
    """
    is_out = [run.role is Role.TRAIN and (run.name if by == "run" else run.session) == fold for run in trial.runs]
    if not any(is_out):
        raise InputError(f"the trial has no training {by} '{fold}' with these overrides; give others")
    roles = [Role.VALIDATE if out else Role.TRAIN if run.role is Role.TRAIN else Role.LEAVE_OUT
             for run, out in zip(trial.runs, is_out, strict=True)]  # fmt: skip
    return replace(trial, runs=tuple(replace(run, role=role) for run, role in zip(trial.runs, roles, strict=True)))


def trial_work(plan: GridPlan | FoldsPlan | FleetPlan, folder: Path) -> Work:
    """Return the work of a plan over trial files; paths count from `folder`.

    Raises:
        InputError: a trial that cannot be read, is no TOML or (but for a fleet) is no valid trial; a pattern that
            matches nothing; a value of the grid that no trial can have; a trial without folds; too many tasks.
    """
    paths = _fleet(plan, folder) if isinstance(plan, FleetPlan) else {"": folder / plan.trial}
    sources = {name: trial_source(path) for name, path in paths.items()}
    if not isinstance(plan, FleetPlan):
        loaded(sources[""].table, sources[""].path)  # its sentence now, not one for each task
    for source in sources.values():
        _refuse_values(plan.grid, source)
    keys = list(_keys(plan, sources))
    files = [path for source in sources.values() for path in (source.path, *source.files)]
    root = common_folder(files)
    names = {name: source.path.relative_to(root).as_posix() for name, source in sources.items()}
    tables = {name: source.table for name, source in sources.items()}
    by = plan.by if isinstance(plan, FoldsPlan) else ""
    function = TrialTask(root, names, tables, tuple(dict.fromkeys(files)), by, plan.intervals)
    description = {"kind": plan.kind, "intervals": plan.intervals.value, "by": by}
    contents = {name: source.content() for name, source in sources.items()}
    if not isinstance(plan, FleetPlan):
        description["trial"] = contents[""]
    return Work(description, keys, function, contents, plan.question)


def _fleet(plan: FleetPlan, folder: Path) -> dict[str, Path]:
    paths: dict[str, Path] = {}
    for pattern in plan.trials:
        root, text = (Path(Path(pattern).anchor), pattern) if Path(pattern).is_absolute() else (folder, pattern)
        matching = sorted(root.glob(str(Path(text).relative_to(Path(text).anchor))))
        if not matching:
            raise InputError(f"trials: '{pattern}' matches no file in '{root}'; correct it")
        paths |= {(p.relative_to(folder) if p.is_relative_to(folder) else p).as_posix(): p for p in matching}
    return paths


def _refuse_values(grid: Mapping[str, Sequence[Any]], source: TrialSource) -> None:
    """Raises:
    InputError: a value of the grid that the keys of a trial file do not take.
    """
    if not source.equation_hash:
        return
    for key, values in grid.items():
        for value in values:
            parse_tables(overridden(source.table, {key: value}), source.path)


def _keys(plan: GridPlan | FoldsPlan | FleetPlan, sources: Mapping[str, TrialSource]) -> Iterator[dict[str, Any]]:
    seeds = range(plan.first_seed, plan.first_seed + plan.seeds)
    folds = _folds(plan, sources)
    refuse_count(len(sources) * max(len(folds), 1) * len(seeds) * _combinations(plan.grid))
    for name in sources:
        for values in product(*plan.grid.values()):
            for fold in folds or [None]:
                for seed in seeds:
                    of_fleet = {TRIAL: name} if isinstance(plan, FleetPlan) else {}
                    of_fold = {} if fold is None else {FOLD: fold}
                    yield of_fleet | dict(zip(plan.grid, values, strict=True)) | of_fold | {SEED: seed}


def _combinations(grid: Mapping[str, Sequence[Any]]) -> int:
    count = 1
    for values in grid.values():
        count *= len(values)
    return count


def _folds(plan: GridPlan | FoldsPlan | FleetPlan, sources: Mapping[str, TrialSource]) -> list[str]:
    if not isinstance(plan, FoldsPlan):
        return []
    column = 0 if plan.by == "run" else 1
    folds = list(dict.fromkeys(names[column] for source in sources.values() for names in source.training))
    if len(folds) < 2:
        raise InputError(
            f"the trial has {len(folds)} training {plan.by}, nothing is left when it is left out; add runs"
        )
    return folds
