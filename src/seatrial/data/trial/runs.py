"""Which files a trial names or follows, what each is for and with which others it shares its offsets."""

import fnmatch
import glob
import math
import os
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from seatrial.core.equations import Model
from seatrial.core.values import NOTATION, InputError, RecordKind, Ship, si_unit, spelling_hint
from seatrial.core.values.arrays import Between, Kind
from seatrial.core.values.files import is_file, is_folder, is_present
from seatrial.core.values.notation import OPPOSITE, Quantity
from seatrial.data.read import ColumnSpec, Layout, format_of
from seatrial.data.read.layout import LOG_QUANTITIES, Geometry, TimeSpec, log_quantity
from seatrial.data.trial.run_data import RunFiles, SourceFile, run_name, session_of
from seatrial.data.trial.schema import (
    AntennaTable,
    ChannelColumn,
    ColumnsTable,
    DeclaredChannel,
    ExcitationTable,
    FollowTable,
    RecordsTable,
    WavesTable,
)
from seatrial.data.trial.settings import ProposalSettings, Stream, StreamSettings, StreamSource
from seatrial.data.trial.trial import Role, Run, Trial, Trimming
from seatrial.physics.hydro.excitation import BoxHull, Excitation, G
from seatrial.physics.sea.spectrum import WaveEncounter, speed_factor

# Channels that a trial file declares for models of its own: what they mean, unit, side, whether they are orders.


@dataclass(frozen=True)
class DeclaredQuantity:
    """What a declared channel means, who sets it, and how it runs between samples."""

    quantity: Quantity
    kind: Kind
    between: Between = ""

    def require_side(self, positive: str | None, where: str) -> None:
        """Refuse a column whose positive direction is neither the declared one nor its opposite.

        Raises:
            InputError: which directions there are.
        """
        positive_side = self.quantity.positive
        sides = [positive_side, *([OPPOSITE[positive_side]] if positive_side in OPPOSITE else [])]
        if positive is not None and positive not in sides:
            raise InputError(f"{where}.positive: '{positive}' is none of {' and '.join(sides)}; correct it")


Declared = Mapping[str, DeclaredQuantity]
"""Symbol -> what the trial file declares."""
NO_DECLARED: Declared = MappingProxyType({})


def declared_channels(tables: Mapping[str, DeclaredChannel]) -> Declared:
    """Return the channels of `[channels]` by symbol.

    Raises:
        InputError: a name that is no identifier, or one that the notation table has.
    """
    return {symbol: _declared(symbol, table) for symbol, table in tables.items()}


def _declared(symbol: str, table: DeclaredChannel) -> DeclaredQuantity:
    if not (symbol.isidentifier() and symbol.isascii()):
        raise InputError(f"channels.'{symbol}': a channel is named by letters, digits and _; choose another name")
    standard = NOTATION.get(symbol) or LOG_QUANTITIES.get(symbol)
    if standard is not None:
        raise InputError(f"channels.{symbol} is known already ({standard.meaning}); use it undeclared, or rename yours")
    unit = si_unit(table.unit)[1]
    meaning = Quantity(symbol, table.meaning, unit, table.frame, table.positive, symbol, symbol)
    return DeclaredQuantity(meaning, table.kind, table.between or "")


# `[excitation]` and `[records.waves]` of a trial file: wave forces, and how the ship meets the waves.

# Froude number beyond which the speed is taken for one in knots, ours
_MAX_FROUDE = 1.0
_BOX_DIMENSIONS = ("L", "B", "d", "c33", "c35", "c53", "c55")


def excitation_of(table: ExcitationTable | None, ship: Ship, model: Model, data_folder: Path) -> Excitation | None:
    """The excitation that the table names; files lie under `base`.

    Raises:
        InputError: a model that knows no wave force, a dimension of the box that nobody gives, or a file that cannot be
            read.
    """
    if table is None:
        return None
    if not {"F3", "M5"} <= set(model.input_names):
        raise InputError(f"[excitation]: model '{model.name}' has no inputs F3 and M5; remove the table")
    if table.source == "table":
        from seatrial.physics.hydro.tabulated import read_transfer

        return read_transfer(data_folder / str(table.file))
    if table.source == "capytaine":
        from seatrial.physics.hydro.capytaine_data import HullExcitation, read_capytaine

        return HullExcitation(read_capytaine(data_folder / str(table.file)))
    return _box_excitation(ship, model)


def _box_excitation(ship: Ship, model: Model) -> BoxHull:
    values = {p.name: p.value for p in model.parameters} | dict(ship.particulars)
    for name in _BOX_DIMENSIONS:
        if name not in values:
            raise InputError(f"[excitation] source = 'box' needs ship.{name}; add it")
    L, B, T, c33, c35, c53, c55 = (values[name] for name in _BOX_DIMENSIONS)
    return BoxHull(L, B, T, c33, c35, c53, c55)


def wave_encounter(
    table: WavesTable | None, excitation: Excitation | None, length: float, where: str
) -> WaveEncounter | None:
    """How a block's runs met the waves; None for records that carry their wave forces themselves. length: m.

    Raises:
        InputError: waves without an excitation, or a speed or heading out of sense.
    """
    if table is None:
        return None
    froude = table.speed / math.sqrt(G * length)
    if froude > _MAX_FROUDE:
        raise InputError(
            f"{where}.waves: {table.speed:.3g} m/s is a Froude number of {froude:.2g} at L = {length:g} m, where "
            "no strip theory holds; is the speed in knots?"
        )
    if excitation is None:
        raise InputError(f"{where}.waves: nothing turns the elevation into forces; add [excitation] source = 'box'")
    try:
        speed_factor(table.speed, table.heading)
    except InputError as error:
        raise InputError(f"{where}.waves: {error}") from None
    spectrum = None if table.sea is None else table.sea.to_spectrum(f"{where}.waves.sea")
    return WaveEncounter(excitation, table.speed, table.heading, spectrum)


# Which files a trial names, what each is for and with which others it shares its offsets.

_VARIABLE = re.compile(r"\$\{(\w+)\}")


def expand_variables(text: str, quote: Callable[[str], str] = str) -> str:
    """`text` with every ${NAME} replaced by the environment variable; a folder in it counts from the working folder.

    quote: applied to each value.

    Raises:
        InputError: the variable is not set.
    """

    def value(match: re.Match[str]) -> str:
        name = match.group(1)
        if not os.environ.get(name):
            raise InputError(f"the environment variable {name} in '{text}' is not set; set it to the data's folder")
        folder = Path(os.environ[name])
        return quote(str(folder.resolve()) if is_folder(folder) else os.environ[name])

    return _VARIABLE.sub(value, text)


def runs_of(
    blocks: Sequence[RecordsTable],
    folder: str,
    trial_folder: Path,
    excitation: Excitation | None = None,
    length: float | None = 1.0,
    declared: Declared = NO_DECLARED,
) -> tuple[Run, ...]:
    """Every run of every block, each with one role; files in sorted order.

    excitation, length [m]: of the ships that met waves; without a length waves are left out. declared: channels of the
    trial's own.

    Raises:
        InputError: a glob or a role pattern that matches nothing, a run with two roles, a name used twice.
    """
    base = trial_folder / expand_variables(folder)
    runs = [
        run
        for i, block in enumerate(blocks, start=1)
        for run in _block_runs(block, base, f"records[{i}]", excitation, length, declared)
    ]
    names = [run.name for run in runs]
    for name in names:
        if names.count(name) > 1:
            raise InputError(
                f"two runs are called '{name}'; rename one, narrow the globs, or cut one log into named parts: "
                'parts = [{ name = "zz1", from = "0 s", to = "120 s" }]'
            )
    return tuple(runs)


def require_training_run(runs: Sequence[Run]) -> None:
    """Raises:
    InputError: none of the runs is one to train on.
    """
    if not any(run.role is Role.TRAIN for run in runs):
        raise InputError("no run is left to train on; narrow 'validate' or 'leave_out'")


def _block_runs(
    block: RecordsTable,
    data_folder: Path,
    where: str,
    excitation: Excitation | None,
    length: float | None,
    declared: Declared,
) -> list[Run]:
    located = _sources_of if block.sources else _files_of
    files = located(block, data_folder, where, declared)
    _require_files_of_parts(block, [run.name for run in files], where)
    data = [part for run in files for part in _parts(block, run, is_alone=len(files) == 1)]
    trimming = Trimming(block.skip_acceleration, block.rate, block.from_release)
    roles = _roles(block, [run.name for run in data], where)
    encounter = None if length is None else wave_encounter(block.waves, excitation, length, where)
    kind = None if block.kind is None else RecordKind(block.kind)
    sessions = [
        session_of(Path(block.name) if block.sources else run.files[0].path, block.session, run.first_day)
        for run in data
    ]
    return [
        Run(run, role, session, trimming, block.source, encounter, kind)
        for run, role, session in zip(data, roles, sessions, strict=True)
    ]


def _files_of(block: RecordsTable, data_folder: Path, where: str, declared: Declared) -> list[RunFiles]:
    paths = sorted({path for text in block.files for path in _matching_files(text, data_folder, where)})
    layouts = [layout_of(block, block.format or format_of(path), where, declared) for path in paths]
    return [RunFiles.of_file(path, _joined(layout, block)) for path, layout in zip(paths, layouts, strict=True)]


def _sources_of(block: RecordsTable, data_folder: Path, where: str, declared: Declared) -> list[RunFiles]:
    files = []
    for i, source in enumerate(block.sources, start=1):
        place = f"{where}.sources[{i}]"
        (path,) = _matching_files(source.file, data_folder, place)[:1]
        layout = layout_of(source, source.format or format_of(path), place, declared)
        files.append(SourceFile(path, _joined(layout, block, source.clock_offset)))
    return [RunFiles(block.name, tuple(files))]


def _joined(layout: Layout, block: RecordsTable, clock_offset: float = 0.0) -> Layout:
    """The layout with what the whole block says: scale, geometry, rate, offset of the clock [s]."""
    origin = None if block.origin is None else (block.origin.lat, block.origin.lon)
    antenna = block.antenna or AntennaTable()  # midship, where nobody says
    return replace(
        layout,
        time=replace(layout.time, clock_offset=block.clock_offset + clock_offset),
        scale=block.scale,
        geometry=Geometry(origin, block.variation, antenna.x, antenna.y, block.antenna is not None),
        rate=block.rate,
    )


def _parts(block: RecordsTable, run: RunFiles, *, is_alone: bool) -> list[RunFiles]:
    """The parts into which a record is cut, called after its file where several are cut alike; else the whole."""
    prefix = "" if is_alone else f"{run.name}-"
    parts = [part for part in block.parts if part.file in ("", run.name)]
    return [
        replace(run, name=part.name if part.file else prefix + part.name, start=part.from_, stop=part.to)
        for part in parts
    ] or [run]


def _require_files_of_parts(block: RecordsTable, names: Sequence[str], where: str) -> None:
    """Raises:
    InputError: a part of a file that the block does not have.
    """
    for part in block.parts:
        if part.file and part.file not in names:
            hint = spelling_hint(part.file, list(names))
            raise InputError(f"{where}.parts: '{part.name}' is of file '{part.file}', which is not among files{hint}")


def _matching_files(text: str, data_folder: Path, where: str) -> list[Path]:
    full = data_folder / expand_variables(text)
    if is_file(full):
        return [full]
    if is_present(full):
        raise InputError(f"{where}.files: '{full}' is a folder, a device or a pipe; name a file")
    if not any(c in text for c in "*?["):
        raise InputError(f"{where}.files: there is no file '{full}'; check the name and [data] folder")
    # brackets in the names of folders that are not part of the pattern are brackets
    pattern = Path(expand_variables(text, quote=glob.escape))
    root = Path(pattern.anchor) if pattern.is_absolute() else data_folder
    try:
        matching = [p for p in root.glob(str(pattern.relative_to(pattern.anchor))) if is_file(p)]
    except (ValueError, OSError) as error:  # '**' within a name, a name too long
        raise InputError(f"{where}.files: '{text}' is no pattern ({error}); correct it") from None
    if not matching:
        raise InputError(f"{where}.files: '{full}' matches no file; check the pattern and [data] folder")
    return matching


def _roles(block: RecordsTable, names: Sequence[str], where: str) -> list[Role]:
    """The role of each run; without `train` patterns all that is not otherwise named trains."""
    patterns = {Role.TRAIN: block.train, Role.VALIDATE: block.validate_, Role.LEAVE_OUT: block.leave_out}
    for role, texts in patterns.items():
        for text in texts:
            if not any(fnmatch.fnmatchcase(name, text) for name in names):
                raise InputError(f"{where}.{role}: no run is called '{text}'{spelling_hint(text, list(names))}")
    default = Role.LEAVE_OUT if block.train else Role.TRAIN
    roles = []
    for name in names:
        matching = [r for r, texts in patterns.items() if any(fnmatch.fnmatchcase(name, t) for t in texts)]
        if len(matching) > 1:
            raise InputError(f"{where}: run '{name}' is named under both '{matching[0]}' and '{matching[1]}'; keep one")
        roles.append(matching[0] if matching else default)
    return roles


def layout_of(block: ColumnsTable, file_format: str, where: str, declared: Declared = NO_DECLARED) -> Layout:
    """How to parse one file or stream of the block, in the terms of `seatrial.data.read`.

    Raises:
        InputError: a unit of another kind than the channel's.
    """
    time = block.time
    return Layout(
        format=file_format,
        time=TimeSpec("time", time.column, time.unit, date=time.date, nanoseconds=time.nanoseconds, week=time.week),
        columns=tuple(_column(s, c, f"{where}.channels.{s}", declared.get(s)) for s, c in block.channels.items()),
        header_lines=block.header_lines,
        encoding=block.encoding,
        separator=block.separator,
    )


def _column(symbol: str, column: ChannelColumn, where: str, declared: DeclaredQuantity | None) -> ColumnSpec:
    try:
        standard = log_quantity(symbol) if declared is None else declared.quantity
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    is_share = standard.unit == "1" and column.span != 1.0
    if si_unit(column.unit)[1] != standard.unit and not is_share:
        raise InputError(f"{where}.unit: '{column.unit}' is no unit of {standard.meaning}, which is in {standard.unit}")
    if declared is not None:
        declared.require_side(column.positive, where)
    usual = declared.kind if declared is not None else "command" if symbol.startswith("command_") else ""
    return ColumnSpec(
        symbol,
        column.column,
        column.unit,
        column.frame or "",
        column.positive or "",
        column.reference_point,
        zero=column.zero,
        span=column.span,
        factor=column.scale,
        offset=column.offset,
        twin=column.twin or "",
        kind=column.kind or usual,
        between=column.between or ("" if declared is None else declared.between),
        declared=None if declared is None else declared.quantity,
    )


# The table `[follow]` of a trial file into a `Stream`: its settings, paths resolved, columns as in `[[records]]`.

_TEXT_SOURCES = (StreamSource.FILE, StreamSource.STDIN, StreamSource.UDP)
_FILE_SOURCES = (StreamSource.FILE, StreamSource.NMEA_FILE)
_UDP_SOURCES = tuple(source for source in StreamSource if source.endswith("udp"))
_HOST_PATTERN = re.compile(r"[A-Za-z0-9.:_-]+")


def stream_of(
    table: FollowTable,
    data_folder: Path,
    trial_folder: Path,
    excitation: Excitation | None = None,
    length: float = 1.0,
    declared: Declared = NO_DECLARED,
) -> Stream:
    """Return the stream that the table describes; files count from `data_folder`, the journal from `trial_folder`.

    excitation, length [m]: of a ship that meets waves. declared: channels of the trial's own.

    Raises:
        InputError: a unit of another kind than the channel's, waves that no excitation turns into forces or that are
            known by their spectrum alone, a host that is no address.
    """
    if table.waves is not None and table.waves.sea is not None:
        raise InputError(
            "follow.waves.sea: a sea known by its spectrum alone cannot be followed sample by sample; record the "
            "elevation zeta, or run 'seatrial identify' on the whole record"
        )
    twins = [symbol for symbol, column in table.channels.items() if column.twin]
    if twins and table.source not in _TEXT_SOURCES:
        raise InputError(
            f"follow.channels.{twins[0]}: twins are read from lines of a text file or of datagrams; follow one of both"
        )
    if not _HOST_PATTERN.fullmatch(table.host):
        raise InputError(f"follow.host = '{table.host}' is no address; give one such as 127.0.0.1")
    file = None if table.file is None else data_folder / expand_variables(str(table.file))
    journal = None if table.journal is None else trial_folder / expand_variables(str(table.journal))
    resolved = replace(table, file=file, journal=journal)
    settings: dict[str, Any] = {setting.name: getattr(resolved, setting.name) for setting in fields(StreamSettings)}
    return Stream(
        **settings,
        layout=layout_of(table, "text", "follow", declared),
        name=_stream_name(table.source, file),
        waves=wave_encounter(table.waves, excitation, length, "follow"),
    )


def resolved_proposal(settings: ProposalSettings | None, stream: Stream | None, home: Path) -> ProposalSettings | None:
    """Return the settings with their files counted from `home`.

    Raises:
        InputError: there is no stream to follow.
    """
    if settings is None:
        return None
    if stream is None:
        raise InputError("proposal: gains are proposed while a stream is followed; add [follow]")
    loop, gains = (home / expand_variables(str(path)) for path in (settings.loop, settings.gains))
    return replace(settings, loop=loop, gains=gains)


def with_source(trial: Trial, source: str) -> Trial:
    """The trial with its stream coming from elsewhere: the same columns, another source.

    Raises:
        InputError: the trial has no [follow], no such source, columns in place of NMEA sentences or the reverse, or a
            place ([follow] file, port) that the table does not name.
    """
    stream = require_stream(trial)
    if source not in [kind.value for kind in StreamSource]:
        raise InputError(f"unknown source '{source}'{spelling_hint(source, [kind.value for kind in StreamSource])}")
    wanted = StreamSource(source)
    if _kind(wanted) != _kind(stream.source):
        raise InputError(
            f"source '{wanted}' has other columns than [follow] source = '{stream.source}'; change the table"
        )
    if wanted in _FILE_SOURCES and stream.file is None:
        raise InputError(f"source '{wanted}' needs a file; add file to [follow]")
    if wanted in _UDP_SOURCES and not stream.port:
        raise InputError(f"source '{wanted}' needs a port; add port to [follow]")
    return replace(trial, stream=replace(stream, source=wanted, name=_stream_name(wanted, stream.file)))


def require_stream(trial: Trial) -> Stream:
    """The trial's stream.

    Raises:
        InputError: it has none.
    """
    if trial.stream is None:
        where = f"{trial.path}: " if trial.path else ""
        raise InputError(f"{where}there is no [follow] that says where samples come from; add it")
    return trial.stream


def _kind(source: StreamSource) -> str:
    """What the samples are written in: nmea, nmea2000, mavlink; empty: columns."""
    return source.value.rpartition("-")[0]


def _stream_name(source: StreamSource, file: Path | None) -> str:
    """Runs are called after the file, or after where they come from."""
    return run_name(file) if file is not None and source in _FILE_SOURCES else source.value.rpartition("-")[2]
