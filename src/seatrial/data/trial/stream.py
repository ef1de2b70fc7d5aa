"""A stream of samples and how it is followed: the keys of the table `[follow]`, and a `Stream` in Python."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, InstanceOf, model_validator
from pydantic.dataclasses import dataclass

from seatrial.data.read import Layout
from seatrial.data.trial.amounts import STRICT_FIELDS
from seatrial.data.trial.schema_errors import raises_input_error
from seatrial.data.trial.settings import Positive
from seatrial.physics.sea.encounter import WaveEncounter


class StreamSource(StrEnum):
    """Where samples come from: lines of columns, NMEA 0183 sentences, messages of a bus or an autopilot."""

    FILE = "file"
    STDIN = "stdin"
    UDP = "udp"
    NMEA_FILE = "nmea-file"
    NMEA_STDIN = "nmea-stdin"
    NMEA_UDP = "nmea-udp"
    NMEA2000_UDP = "nmea2000-udp"
    MAVLINK_UDP = "mavlink-udp"


@dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class StreamSettings:
    """Where samples come from while the record is being made, and how they are followed.

    Attributes:
        source: lines of a growing file, of standard input or of UDP datagrams, or NMEA 0183 sentences from them; NMEA
            2000 as text and MAVLink in UDP datagrams.
        rate: nominal rate of the samples [Hz].
        file: of a source that is a file.
        host, port: on which UDP is listened to.
        batch_window_s: time over which the batch criterion is kept [s].
        forgetting_time_s: time after which the past counts 1/e [s]; None: it counts for ever.
        longest_gap_s: time without a sample after which a new run begins [s].
        page: port of the local page; 0: none.
        journal: file in which admitted samples are kept; None: beside the result.
    """

    source: StreamSource
    rate: Positive
    file: Path | None = None
    host: str = "127.0.0.1"
    port: Annotated[int, Field(ge=1, le=65535)] | None = None
    batch_window_s: Positive = 3600.0
    forgetting_time_s: Positive | None = None
    longest_gap_s: Positive = 30.0
    page: Annotated[int, Field(ge=0, le=65535)] = 0
    journal: Path | None = None

    @model_validator(mode="after")
    def _place_where_needed(self) -> Self:
        if self.source.endswith("file") and self.file is None:
            raise ValueError(f"source = '{self.source}' needs a file; add it")
        if self.source.endswith("udp") and self.port is None:
            raise ValueError(f"source = '{self.source}' needs a port; add it")
        if self.longest_gap_s * self.rate < 1.0:
            raise ValueError(
                f"longest_gap_s = {self.longest_gap_s:g} is shorter than a step at {self.rate:g} Hz; make it longer"
            )
        return self


@raises_input_error
@dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class Stream(StreamSettings):
    """Samples that come while the record is being made, with the layout of their columns.

    Attributes:
        layout: which column is what.
        name: of the runs it makes, as the stem of a file names a record's.
        waves: how the ship meets them, for an elevation in the stream.
    """

    layout: InstanceOf[Layout]
    name: str = "stream"
    waves: InstanceOf[WaveEncounter] | None = None
