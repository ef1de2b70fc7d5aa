"""A trial file corrected by what the checks are certain of; each change is kept only if it removes errors."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import tomlkit
from tomlkit.exceptions import TOMLKitError

from seatrial.core.values import Finding, InputError, Severity, TrialEdit, si_unit
from seatrial.core.values.files import parse_toml, read_table_text
from seatrial.data.trial.load import parse_tables
from seatrial.data.trial.records import load_run
from seatrial.data.trial.runs import runs_of
from seatrial.data.trial.schema import RecordsTable, TrialFile
from seatrial.data.trial.trial import Role

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
            edited = _edited(text, path, index, finding.edits)
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


def _edited(text: str, path: Path, index: int, edits: tuple[TrialEdit, ...]) -> str:
    """The text with the edits in one block.

    Raises:
        InputError: the block has no such key.
    """
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
        what = f"{change.block}: {edits}"
        yield f"not changed: {what}: {change.refusal}" if change.refusal else f"changed {what} ({change.finding.text})"
