"""A trial file into a `Trial`, and corrected by what the checks are certain of."""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from seatrial.core.equations import Model
from seatrial.core.values import (
    NOTATION,
    Finding,
    ForcePoints,
    InputError,
    Severity,
    Ship,
    TrialEdit,
    channel_hint,
    si_unit,
    spelling_hint,
)
from seatrial.core.values.errors import listed
from seatrial.core.values.files import parse_toml, read_table_text, refuse_absurd_numbers
from seatrial.data.trial.amounts import schema_error
from seatrial.data.trial.craft_tables import layout_text
from seatrial.data.trial.design_request import refuse_unsuitable
from seatrial.data.trial.model_table import added_mass_findings, build_trial_model, ship_of
from seatrial.data.trial.plausibility import (
    ground_velocity_findings,
    hull_value_findings,
    refuse_used_records,
    with_estimates_named,
)
from seatrial.data.trial.priors import ResultReader, earlier_results, prior_range_findings
from seatrial.data.trial.records import load_run
from seatrial.data.trial.runs import (
    declared_channels,
    excitation_of,
    expand_variables,
    require_training_run,
    resolved_proposal,
    runs_of,
    stream_of,
)
from seatrial.data.trial.schema import NO_CHANNELS, ForcesTable, RecordsTable, TrialFile
from seatrial.data.trial.trial import Role, Run, Trial
from seatrial.physics.sensors.settings import TIMED_CHANNELS

# A trial file into a `Trial`.

_OPEN = re.compile(r"^# OPEN (\w+):", re.MULTILINE)  # as `seatrial init` marks what a person must choose


def parse_trial(path: Path) -> TrialFile:
    """The file's tables, checked key by key.

    Raises:
        InputError: no such file, no TOML, or as `parse_tables`.
    """
    return parse_tables(read_tables(path), path)


def read_tables(path: Path) -> dict:
    """Return the file's tables as they stand there.

    Raises:
        InputError: no such file, or no TOML.
    """
    try:
        return parse_toml(read_table_text(path))
    except OSError as error:
        raise InputError(f"trial file '{path}' cannot be read ({error.strerror}); check the path") from None
    except ValueError as error:
        raise InputError(f"trial file '{path}' is no valid TOML: {error}") from None


def parse_tables(table: dict, path: Path) -> TrialFile:
    """The tables of a trial file, checked key by key; path: for messages.

    Raises:
        InputError: an unknown or missing key, a value of the wrong kind, a number of no possible size.
    """
    refuse_absurd_numbers(table, str(path))
    try:
        file = TrialFile.model_validate(table)
    except ValidationError as error:
        sentence = schema_error(error, TrialFile, str(path))
        if str(sentence).endswith(NO_CHANNELS) and (names := _OPEN.findall(path.read_text(encoding="utf-8"))):
            raise _all_open(path, names) from None
        raise sentence from None
    if not file.records and file.design is None and file.follow is None:
        raise InputError(
            f"{path}: key 'records' is missing; add it, or a [design] table for 'seatrial design', or [follow] for "
            "'seatrial follow'"
        )
    return file


def _all_open(path: Path, names: list[str]) -> InputError:
    """What to say of a drafted file none of whose readings has been chosen."""
    count = "the only reading is" if len(names) == 1 else f"all {len(names)} readings are"
    return InputError(
        f"{path}: no channel is declared, {count} open ({listed(names)}); choose: below each line "
        "'# OPEN NAME' correct unit, frame and side by what it says, and remove the # before channels.NAME"
    )


def load_trial(path: str | Path, own_model: Model | None = None, read_result: ResultReader | None = None) -> Trial:
    """Read and validate a trial file; record files are found but not read, tables of force points are read.

    Args:
        path: the TOML file.
        own_model: takes the place of the built-in model that `[model] name` names; truth and bounds of parameters
            it does not have are left out.
        read_result: reads the folder of an earlier result that `priors_from` names.

    Raises:
        InputError: one sentence naming file, key and what to do.
    """
    path = Path(path)
    try:
        trial = trial_of_tables(parse_trial(path), path, own_model, read_result)
    except InputError as error:
        left_open = [name for name in _open_names(path) if re.search(rf"\b{name}\b", str(error))]
        if not left_open:
            raise
        raise InputError(f"{error}; the line '# OPEN {left_open[0]}' says what to choose") from None
    return with_estimates_named(trial, path.read_text(encoding="utf-8"))


def _open_names(path: Path) -> list[str]:
    """What a drafted file leaves to choose; nothing of one that cannot be read."""
    try:
        return _OPEN.findall(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return []


def trial_of_tables(
    file: TrialFile, path: Path, own_model: Model | None = None, read_result: ResultReader | None = None
) -> Trial:
    """Return the trial of checked tables; `path`, from which files count, need not hold them. Else as `load_trial`."""
    if file.ship is None or file.model is None:
        missing = "[ship], with name and L, is" if file.ship is None else "[model], with the name of its equations, is"
        raise InputError(
            f"{path}: {missing} missing; add it: 'seatrial models' lists the models, 'seatrial models NAME' prints "
            "both tables"
        )
    try:
        ship = ship_of(file.ship)
        layout = layout_text(file.model.name, file.model.damping, file.thruster, ship)
        home = path.resolve().parent
        results = earlier_results(file.model.priors_from, home, expand_variables, read_result)
        model = build_trial_model(file.model, ship, own_model, layout, file.sensors, results)
        declared = declared_channels(file.channels)
        symbols = {*NOTATION, *declared}
        _refuse_unknown_names("noise", list(file.noise), symbols)
        _refuse_unknown_names("estimate.channels", list(file.estimate.channels), set(model.observables))
        resting = {state for state in model.states if model.rest_parameter(state)}
        for key, names, correctable in (
            ("offsets", file.estimate.offsets, resting),
            ("gains", file.estimate.gains, set()),
        ):
            _refuse_unknown_names(f"estimate.{key}", list(names), {*model.input_names, *correctable}, _correction_hint)
        timed = {c for channels in TIMED_CHANNELS.values() for c in channels} & set(model.channels)
        _refuse_unknown_names("estimate.delays", list(file.estimate.delays), {*model.input_names, *timed})
        if file.feedback is not None:
            _refuse_unknown_names("feedback.input", [file.feedback.input], set(model.input_names))
            _refuse_unknown_names("feedback.output", [file.feedback.output], set(model.observables))
            if isinstance(file.feedback.reference, str):
                _refuse_unknown_names("feedback.reference", [file.feedback.reference], symbols)
        for structure, names in (file.family.structures if file.family else {}).items():
            _refuse_unknown_names(
                f"family.structures.'{structure}'", list(names), set(model.parameters.names), spelling_hint
            )
        if own_model is None:
            _refuse_unknown_names("truth", list(file.truth), set(model.parameters.names), spelling_hint)
        unit = _reference_force(model, ship)
        ranges = prior_range_findings(file.model.priors_from, ship)
        base = home / expand_variables(file.data.folder)
        excitation = excitation_of(file.excitation, ship, model, base)
        runs = runs_of(file.records, file.data.folder, home, excitation, ship.length, declared) if file.records else ()
        runs = tuple(run.with_differences(model.input_names) for run in runs)
        refuse_used_records(runs, results)
        if runs and file.follow is None:
            require_training_run(runs)
        stream = None if file.follow is None else stream_of(file.follow, base, home, excitation, ship.length, declared)
        stream = None if stream is None else stream.with_differences(model.input_names)
        proposal = resolved_proposal(file.proposal, stream, home)
        if file.design is not None:
            refuse_unsuitable(file.design, model, ship.length)
        forces, force_findings = _force_points(file.forces, base, model, file.model.reference_point, unit)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    return Trial(
        ship=ship,
        runs=runs,
        model=model,
        estimate=file.estimate,
        noise={channel: deviation for channel, deviation in file.noise.items() if deviation is not None},
        truth={name: value for name, value in file.truth.items() if name in model.parameters},
        accept=file.accept,
        reference_point=file.model.reference_point,
        question=file.question,
        path=path,
        forces=forces,
        family=file.family,
        compare=file.compare,
        design_request=file.design,
        stream=stream,
        proposal=proposal,
        feedback=file.feedback,
        joint_priors=tuple(p for r in results.values() if (p := r.joint_prior_of(model.parameters)).names),
        findings=(
            *ranges,
            *added_mass_findings(model, ship),
            *hull_value_findings(ship),
            *ground_velocity_findings(model, file.sensors, file.records),
            *force_findings,
        ),
    )


def load_runs(path: str | Path) -> tuple[Run, ...]:
    """Read the runs that a trial file describes, without ship and model: what checking records needs.

    Waves are left out, as their forces need the ship.

    Raises:
        InputError: as `load_trial`, of the tables of records alone.
    """
    path = Path(path)
    file = parse_trial(path)
    try:
        declared = declared_channels(file.channels)
        return runs_of(file.records, file.data.folder, path.resolve().parent, length=None, declared=declared)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def _force_points(
    forces: Sequence[ForcesTable], base: Path, model: Model, reference_point: float, unit: float | None
) -> tuple[tuple[ForcePoints, ...], tuple[Finding, ...]]:
    """Return the tables of static forces and what is found of them; unit: reference force [kg/m^2]."""
    if not forces:
        return (), ()
    from seatrial.data.check.captive_forces import force_findings
    from seatrial.data.trial.forces import read_force_points

    tables = tuple(
        read_force_points(block, base, model, reference_point, f"forces[{i}]")
        for i, block in enumerate(forces, start=1)
    )
    return tables, tuple(finding for points in tables for finding in force_findings(points, unit))


def _reference_force(model: Model, ship: Ship) -> float | None:
    """rho/2 L d [kg/m^2], where ship or model know them."""
    values = {p.name: p.value for p in model.parameters} | dict(ship.particulars)
    return values["rho"] / 2 * values["L"] * values["d"] if {"rho", "L", "d"} <= set(values) else None


def _correction_hint(name: str, inputs: list[str]) -> str:
    """What may be corrected in each session, and what is stated in the channel instead."""
    stated = f"; state the zero and the scale of '{name}' in channels.{name}" if name in NOTATION else ""
    return f"; inputs of the model are {', '.join(inputs)}{stated}"


def _refuse_unknown_names(
    where: str, names: list[str], valid_names: set[str], hint: Callable[[str, list[str]], str] = channel_hint
) -> None:
    for name in names:
        if name not in valid_names:
            raise InputError(f"{where}: unknown name '{name}'{hint(name, sorted(valid_names))}")


# A trial file corrected by what the checks are certain of; each change is kept only if it removes errors.

_DECIMALS = 6  # of numbers that are written to the file; chosen
_MOST_CHANGES = 20  # of one file; chosen: more than the channels that can be wrong


@dataclass(frozen=True)
class Change:
    """What a correction did, or did not, on a finding: the block it concerns, and why it was not done."""

    block: str
    finding: Finding
    refusal: str = ""


@dataclass(frozen=True)
class Correction:
    """A corrected trial file.

    Attributes:
        text: of the corrected file; that of the original where nothing is changed.
        changes: in their order, those that were refused among them.
        findings: of the checks on the corrected file.
    """

    text: str
    changes: tuple[Change, ...]
    findings: tuple[Finding, ...]

    @property
    def applied(self) -> tuple[Change, ...]:
        """The changes that are in the text."""
        return tuple(change for change in self.changes if not change.refusal)


def corrected_trial(path: str | Path) -> Correction:
    """Return the trial file with the edits of its error findings, each kept only where fewer errors are left with it.

    Comments and layout of the file stay. Edits of warnings are advice, and are not made.

    Raises:
        InputError: the file or its records cannot be read.
    """
    path = Path(path)
    text = _read(path)
    changes: list[Change] = []
    findings: list[Finding] = []
    for index in range(len(_tables(text, path).records)):
        text, more, left_over = _corrected_block(text, path, index)
        changes += more
        findings += left_over
    return Correction(text, tuple(changes), tuple(findings))


def _corrected_block(text: str, path: Path, index: int) -> tuple[str, list[Change], list[Finding]]:
    """The text with one block corrected, what was done, and what the checks find in it now."""
    changes: list[Change] = []
    tried: set[tuple[TrialEdit, ...]] = set()
    findings = _findings(text, path, index)
    for _ in range(_MOST_CHANGES):
        finding = next((f for f in _errors(findings) if f.edits and f.edits not in tried), None)
        if finding is None:
            break
        tried.add(finding.edits)
        refusal = ""
        try:
            edited = edited_text(text, path, index, finding.edits)
            after = _findings(edited, path, index)
            if len(_errors(after)) < len(_errors(findings)):
                text, findings = edited, after
            else:
                refusal = "as many errors are left with it"
        except InputError as error:
            refusal = str(error)
        changes.append(Change(f"records[{index + 1}]", finding, refusal))
    return text, changes, findings


def _errors(findings: list[Finding]) -> list[Finding]:
    return [finding for finding in findings if finding.severity is Severity.ERROR]


def _findings(text: str, path: Path, index: int) -> list[Finding]:
    """The findings on the records of one block."""
    file = _tables(text, path)
    runs = runs_of([file.records[index]], file.data.folder, path.resolve().parent, length=None)
    used = (run for run in runs if run.role is not Role.LEAVE_OUT)
    return [finding for run in used for finding in load_run(run, 0.0).findings if finding.code not in file.accept]


def _read(path: Path) -> str:
    try:
        return read_table_text(path)
    except (OSError, ValueError) as error:
        raise InputError(f"trial file '{path}' cannot be read ({error}); check the path") from None


def _tables(text: str, path: Path) -> TrialFile:
    try:
        table = parse_toml(text)
    except ValueError as error:
        raise InputError(f"trial file '{path}' is no valid TOML: {error}") from None
    return parse_tables(table, path)


def edited_text(text: str, path: Path, index: int, edits: tuple[TrialEdit, ...]) -> str:
    """Return the text with the edits in one block, from 0.

    Raises:
        InputError: the block has no such key.
    """
    import tomlkit
    from tomlkit.exceptions import TOMLKitError

    block = _tables(text, path).records[index]
    try:
        document = tomlkit.parse(text)
        for edit in edits:
            channels = _channels_with(document["records"][index], edit.key.split(".")[1])  # type: ignore[index]
            _apply(channels, edit, block)
    except TOMLKitError as error:
        raise InputError(f"the file cannot be edited: {error}") from None
    return tomlkit.dumps(document)


def _channels_with(block: dict, symbol: str) -> dict:
    """The table of channels of a block, or of the source in it, that has the channel."""
    for table in (block, *block.get("sources", ())):
        if symbol in table.get("channels", {}):
            return table["channels"]
    raise InputError(f"'{symbol}' is no column of the file: it is derived from others; correct these by hand")


def _apply(channels: dict, edit: TrialEdit, block: RecordsTable) -> None:
    _, symbol, *rest = edit.key.split(".")
    if edit.exchanged_with:
        _exchange(channels, symbol, edit.exchanged_with.split(".")[1])
        return
    (key,) = rest
    value = parse_toml(f"value = {edit.value}")["value"]
    if edit.unit:
        value = round(value / si_unit(channels[symbol]["unit"])[0] + channels[symbol].get(key, 0.0), _DECIMALS)
    elif key == "scale":
        value *= channels[symbol].get(key, 1.0)
    elif key == "reference_point":
        value = round(value / block.scale, _DECIMALS)
    channels[symbol][key] = value


def _exchange(channels: dict, one: str, other: str) -> None:
    """Exchange what two channels say, key by key, so that the layout of the file stays; or rename the first."""
    if other not in channels:
        channels[other] = channels[one]
        del channels[one]
        return
    contents = dict(channels[one]), dict(channels[other])
    for name, content in ((one, contents[1]), (other, contents[0])):
        for key in list(channels[name]):
            if key not in content:
                del channels[name][key]
        for key, value in content.items():
            channels[name][key] = value


def change_lines(correction: Correction) -> Iterator[str]:
    """Return what was changed, and what was not and why, a line each."""
    for change in correction.changes:
        edits = "; ".join(map(str, change.finding.edits))
        corrected = f"{change.block}: {edits}"
        yield (
            f"not changed: {corrected}: {change.refusal}"
            if change.refusal
            else f"changed {corrected} ({change.finding.text})"
        )
