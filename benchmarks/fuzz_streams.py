"""What is fuzzed of streams: columns, NMEA 0183 sentences, frames of NMEA 2000 and MAVLink."""

import io
import math
from collections.abc import Iterable
from pathlib import Path

import numpy as np

import seatrial as st
from seatrial.core.results.online import Sample
from seatrial.onboard.columns import ColumnReader
from seatrial.onboard.lines import LineBatch
from seatrial.onboard.messages import BusDecoder, MavlinkDecoder, MessageReader
from seatrial.onboard.nmea import NmeaReader
from seatrial.onboard.sources import LineReader

_STREAM = st.Layout(
    "text", st.ColumnSpec("time", "stamp", "s"), tuple(st.ColumnSpec(s, s, "1") for s in ("psi", "r", "u", "x0"))
)
_NUMBERED = st.Layout(
    "text", st.ColumnSpec("time", 1, "s"), (st.ColumnSpec("u", 2, "m/s"), st.ColumnSpec("psi", 3, "deg"))
)
_TOPICS = st.Layout(
    "text", st.ColumnSpec("time", "stamp", "s"),
    (st.ColumnSpec("psi", "vesselHeading:True/heading", "rad"), st.ColumnSpec("r", "ATTITUDE/yawspeed", "rad/s"),
     st.ColumnSpec("x0", "GLOBAL_POSITION_INT/lat", "1"), st.ColumnSpec("y0", "GLOBAL_POSITION_INT/lon", "1")),
)  # fmt: skip


def _samples(reader: LineReader, lines: list[bytes]) -> object:
    """Samples of a stream; only infinity counts, since a channel without a reading is NaN."""
    samples = [*reader.samples(LineBatch(lines)), *reader.flush()]
    str(reader.counts)
    return infinities(samples)


def infinities(samples: Iterable[Sample]) -> list[float]:
    """Return an infinity for each sample that holds one."""
    return [math.inf for sample in samples if np.isinf([sample.time, *sample.values]).any()]


def read_nmea(data: bytes, place: Path) -> object:  # noqa: ARG001
    """Read NMEA 0183 sentences as a stream; no file is needed."""
    return _samples(NmeaReader(_STREAM, rate=10.0), data.split(b"\n"))


def read_columns(data: bytes, place: Path) -> object:  # noqa: ARG001
    """Read rows of columns as a stream; no file is needed."""
    return _samples(ColumnReader(_NUMBERED), data.split(b"\n"))


def read_bus(data: bytes, place: Path) -> object:  # noqa: ARG001
    """Read frames of NMEA 2000 as a stream; no file is needed."""
    return _samples(MessageReader(_TOPICS, BusDecoder(), rate=10.0), data.split(b"\n"))


def read_mavlink(data: bytes, place: Path) -> object:  # noqa: ARG001
    """Read MAVLink packets as a stream; no file is needed."""
    return _samples(MessageReader(_TOPICS, MavlinkDecoder(), rate=10.0), [data])


def nmea_sentences() -> list[bytes]:
    from tests.onboard.sentences import sentence

    bodies = ("GPZDA,000001.00,01,02,2024,,", "HEHDT,40.1,T", "HEROT,3.2,A", "IIRSA,-3.1,A,,V", "VDVBW,3.1,0.0,A,,,V",
              "GPRMC,000002.00,A,5230.1,N,01322.5,E,6.1,40.0,010224,,,A", "GPVTG,40.0,T,,M,6.1,N,11.3,K,A",
              "GPGGA,000003.00,5230.1,N,01322.5,E,1,08,1.0,10.0,M,,M,,")  # fmt: skip
    return [b"\n".join(sentence(body) for body in bodies[first:] + bodies) for first in range(len(bodies))]


def bus_lines() -> list[bytes]:
    return [
        b"2024-02-01-10:00:00.0,2,127250,35,255,8,00,10,27,ff,7f,ff,7f,fd",
        b"(1706781600.000) can0 09F11223#00102700FF7FFD",
        b"A000057.055 09FF7 1F201 00102700FF7FFD",
    ]


def mavlink_packets() -> list[bytes]:
    from pymavlink.dialects.v20 import ardupilotmega

    link = ardupilotmega.MAVLink(io.BytesIO())
    link.srcSystem, link.srcComponent = 1, 1
    messages = (
        ardupilotmega.MAVLink_attitude_message(1000, 0.1, 0.2, 0.3, 0.01, 0.02, 0.03),
        ardupilotmega.MAVLink_global_position_int_message(1000, 525000000, 133000000, 0, 0, 10, 20, 0, 100),
    )
    return [message.pack(link) for message in messages]
