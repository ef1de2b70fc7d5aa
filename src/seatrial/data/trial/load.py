"""A trial file into a `Trial`."""

import tomllib
from pathlib import Path

from pydantic import ValidationError

from seatrial.core.equations import Model
from seatrial.core.values import NOTATION, InputError, Ship, nearest
from seatrial.data.check.captive import force_findings
from seatrial.data.trial.complaints import complaint
from seatrial.data.trial.design_table import brief_of
from seatrial.data.trial.excitation import excitation_of
from seatrial.data.trial.follow_table import stream_of
from seatrial.data.trial.forces import points_of
from seatrial.data.trial.literature import range_findings
from seatrial.data.trial.model_choice import chosen_model, ship_of
from seatrial.data.trial.runs import expanded, refuse_untrained, runs_of
from seatrial.data.trial.schema import EstimateTable, FamilyTable, TrialFile
from seatrial.data.trial.trial import Estimate, Family, Trial


def parse_trial(path: Path) -> TrialFile:
    """The file's tables, checked key by key.

    Raises:
        InputError: no such file, no TOML, an unknown or missing key, a value of the wrong kind.
    """
    try:
        with path.open("rb") as file:
            table = tomllib.load(file)
    except OSError as error:
        raise InputError(f"trial file '{path}' cannot be read ({error.strerror}); check the path") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"trial file '{path}' is no valid TOML: {error}") from None
    try:
        file = TrialFile.model_validate(table)
    except ValidationError as error:
        raise complaint(error, TrialFile, str(path)) from None
    if not file.records and file.design is None and file.follow is None:
        raise InputError(
            f"{path}: key 'records' is missing; add it, or a [design] table for 'seatrial design', or [follow] for "
            "'seatrial follow'"
        )
    return file


def load_trial(path: str | Path, own_model: Model | None = None) -> Trial:
    """Read and validate a trial file; record files are found but not read, tables of force points are read.

    Args:
        path: the TOML file.
        own_model: takes the place of the built-in model that `[model] name` names; the truth of parameters it does
            not have is left out.

    Raises:
        InputError: one sentence naming file, key and what to do.
    """
    path = Path(path)
    file = parse_trial(path)
    try:
        ship = ship_of(file.ship)
        model = chosen_model(file.model, ship, own_model)
        known = set(NOTATION)
        for number, block in enumerate(file.records, start=1):
            _refuse_strangers(f"records[{number}].channels", list(block.channels), known)
        if file.follow is not None:
            _refuse_strangers("follow.channels", list(file.follow.channels), known)
        _refuse_strangers("noise", list(file.noise), known)
        _refuse_strangers("estimate.channels", list(file.estimate.channels), set(model.observables))
        _refuse_strangers("estimate.offsets", list(file.estimate.offsets), known)
        _refuse_strangers("estimate.gains", list(file.estimate.gains), known)
        _refuse_strangers("estimate.delays", list(file.estimate.delays), set(model.input_names))
        for structure, names in (file.family.structures if file.family else {}).items():
            _refuse_strangers(f"family.structures.'{structure}'", list(names), set(model.parameters.names))
        if own_model is None:
            _refuse_strangers("truth", list(file.truth), set(model.parameters.names))
        unit = _force_unit(model, ship)
        ranges = range_findings(file.model.priors_from, ship)
        home = path.resolve().parent
        base = home / expanded(file.data.folder)
        excitation = excitation_of(file.excitation, ship, model, base)
        runs = runs_of(file.records, file.data.folder, home, excitation, ship.length) if file.records else ()
        if runs and file.follow is None:
            refuse_untrained(runs)
        stream = None if file.follow is None else stream_of(file.follow, base, home, excitation, ship.length)
        brief = None if file.design is None else brief_of(file.design, model, ship.length)
        forces = tuple(
            points_of(block, base, model, file.model.reference_point, f"forces[{i}]")
            for i, block in enumerate(file.forces, start=1)
        )
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    return Trial(
        ship=ship,
        runs=runs,
        model=model,
        estimate=_estimate(file.estimate),
        noise={channel: spread.in_si for channel, spread in file.noise.items() if spread.in_si is not None},
        truth={name: value for name, value in file.truth.items() if name in model.parameters},
        accept=file.accept,
        reference_point=file.model.reference_point,
        question=file.question,
        path=path,
        forces=forces,
        family=None if file.family is None else _family(file.family),
        design=brief,
        follow=stream,
        findings=(*ranges, *(finding for points in forces for finding in force_findings(points, unit))),
    )


def _family(table: FamilyTable) -> Family:
    return Family(table.structures, table.prior_factors, table.segment_factors)


def _force_unit(model: Model, ship: Ship) -> float | None:
    """rho/2 L d [kg/m^2], where ship or model know them."""
    known = {p.name: p.value for p in model.parameters} | dict(ship.particulars)
    return known["rho"] / 2 * known["L"] * known["d"] if {"rho", "L", "d"} <= set(known) else None


def _refuse_strangers(where: str, names: list[str], known: set[str]) -> None:
    for name in names:
        if name not in known:
            raise InputError(f"{where}: unknown name '{name}'{nearest(name, sorted(known))}")


def _estimate(table: EstimateTable) -> Estimate:
    return Estimate(
        criterion=table.criterion,
        channels=table.channels,
        segment_s=table.segment_s,
        segment_lengths=table.segment_lengths,
        rate=table.rate,
        robust=table.robust,
        offsets={channel: spread.in_si for channel, spread in table.offsets.items()},
        gains={channel: spread.in_si for channel, spread in table.gains.items()},
        delays={channel: spread.in_si for channel, spread in table.delays.items()},
        current=table.current,
        initial_s=table.initial_s,
    )
