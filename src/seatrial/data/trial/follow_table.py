"""The table `[follow]` of a trial file into a `Stream`: columns as in `[[records]]`, places and lengths tested."""

import re
from dataclasses import replace
from pathlib import Path

from seatrial.core.values import InputError, nearest
from seatrial.data.trial.excitation import waves_of
from seatrial.data.trial.runs import expanded, layout_of
from seatrial.data.trial.schema import FollowTable
from seatrial.data.trial.trial import Feed, Stream, Trial, run_name
from seatrial.physics.hydro.excitation import Excitation

_FROM_FILE = (Feed.FILE, Feed.NMEA_FILE)
_FROM_SOCKET = (Feed.UDP, Feed.NMEA_UDP)
_HOST = re.compile(r"[A-Za-z0-9.:_-]+")


def stream_of(
    table: FollowTable, base: Path, home: Path, excitation: Excitation | None = None, length: float = 1.0
) -> Stream:
    """The stream that the table describes; files count from `base`, the journal from the trial file's folder `home`.

    excitation, length [m]: of a ship that meets waves.

    Raises:
        InputError: a unit of another kind than the channel's, waves that no excitation turns into forces or that are
            known by their spectrum alone, a host that is no address.
    """
    if table.waves is not None and table.waves.sea is not None:
        raise InputError(
            "follow.waves.sea: a sea known by its spectrum alone cannot be followed sample by sample; record the "
            "elevation zeta, or run 'seatrial identify' on the whole record"
        )
    if not _HOST.fullmatch(table.host):
        raise InputError(f"follow.host = '{table.host}' is no address; give one such as 127.0.0.1")
    file = None if table.file is None else base / expanded(table.file)
    return Stream(
        feed=Feed(table.source),
        layout=layout_of(table, "text", "follow"),
        rate=table.rate,
        name=_name(Feed(table.source), file),
        file=file,
        host=table.host,
        port=table.port or 0,
        waves=waves_of(table.waves, excitation, length, "follow"),
        whole=table.whole_s,
        forgetting=table.forgetting_s,
        longest_gap=table.longest_gap_s,
        page=table.page,
        journal=None if table.journal is None else home / expanded(table.journal),
    )


def fed_from(trial: Trial, feed: str) -> Trial:
    """The trial with its stream coming from elsewhere: the same columns, another source.

    Raises:
        InputError: the trial has no [follow], no such source, columns in place of NMEA sentences or the reverse, or a
            place ([follow] file, port) that the table does not name.
    """
    stream = followed(trial)
    if feed not in [one.value for one in Feed]:
        raise InputError(f"unknown source '{feed}'{nearest(feed, [one.value for one in Feed])}")
    wanted = Feed(feed)
    if _is_nmea(wanted) != _is_nmea(stream.feed):
        raise InputError(
            f"source '{wanted}' has other columns than [follow] source = '{stream.feed}'; change the table"
        )
    if wanted in _FROM_FILE and stream.file is None:
        raise InputError(f"source '{wanted}' needs a file; add file to [follow]")
    if wanted in _FROM_SOCKET and not stream.port:
        raise InputError(f"source '{wanted}' needs a port; add port to [follow]")
    return replace(trial, follow=replace(stream, feed=wanted, name=_name(wanted, stream.file)))


def followed(trial: Trial) -> Stream:
    """The trial's stream.

    Raises:
        InputError: it has none.
    """
    if trial.follow is None:
        where = f"{trial.path}: " if trial.path else ""
        raise InputError(f"{where}there is no [follow] that says where samples come from; add it")
    return trial.follow


def _is_nmea(feed: Feed) -> bool:
    return feed in (Feed.NMEA_FILE, Feed.NMEA_STDIN, Feed.NMEA_UDP)


def _name(feed: Feed, file: Path | None) -> str:
    """Runs are called after the file, or after where they come from."""
    return run_name(file) if file is not None and feed in _FROM_FILE else feed.value.removeprefix("nmea-")
