"""The table `[follow]` of a trial file into a `Stream`: its settings, paths resolved, columns as in `[[records]]`."""

import re
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from seatrial.core.values import InputError, spelling_hint
from seatrial.data.trial.declared_channels import NO_DECLARED, Declared
from seatrial.data.trial.excitation import wave_encounter
from seatrial.data.trial.proposal_settings import ProposalSettings
from seatrial.data.trial.run_data import run_name
from seatrial.data.trial.runs import expand_variables, layout_of
from seatrial.data.trial.schema import FollowTable
from seatrial.data.trial.stream import Stream, StreamSettings, StreamSource
from seatrial.data.trial.trial import Trial
from seatrial.physics.hydro.excitation import Excitation

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
    if source not in [one.value for one in StreamSource]:
        raise InputError(f"unknown source '{source}'{spelling_hint(source, [one.value for one in StreamSource])}")
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
