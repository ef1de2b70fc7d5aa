"""Messages of an NMEA 2000 bus and of MAVLink become samples, also over UDP; garbage is counted and passed over."""

import math
import socket
import struct

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from seatrial.core.results.online import Sample
from seatrial.core.values import InputError
from seatrial.data.read import ColumnSpec, Layout
from seatrial.data.trial.settings import Stream, StreamSource
from seatrial.onboard.lines import LineBatch
from seatrial.onboard.messages import BusDecoder, MavlinkDecoder, MessageReader
from seatrial.onboard.sources import open_source

TIME = np.arange(20) * 0.5  # s
HEADING = np.radians(350.0 + 2.0 * np.arange(20))  # rad
RATE = np.radians(4.0)  # rad/s


def layout(columns: tuple[ColumnSpec, ...], time: str = "stamp") -> Layout:
    return Layout("text", ColumnSpec("time", time, "s"), columns)


def bus_line(second: float, number: int, data: bytes) -> bytes:
    """A line of canboat's FAST text."""
    cells = ",".join(f"{byte:02x}" for byte in data)
    return f"2026-08-03T05:05:{second:06.3f}Z,2,{number},35,255,{len(data)},{cells}".encode()


def bus_lines() -> list[bytes]:
    """PGN 127250 (heading), 127251 (rate of turn), 129025 (position), 129026 (course and speed): canboat's layout."""
    lines = []
    for k, t in enumerate(TIME):
        heading = round(float(HEADING[k] % (2.0 * np.pi)) * 1e4)
        position = (round((60.0 + 1e-5 * k) * 1e7), round(5.0 * 1e7))
        lines += [
            bus_line(t, 127250, struct.pack("<BHhhB", 255, heading, 0x7FFF, 0x7FFF, 0xFC)),
            bus_line(t + 0.01, 127251, struct.pack("<BiBH", 255, round(RATE / 3.125e-8), 0xFF, 0xFFFF)),
            bus_line(t + 0.02, 129025, struct.pack("<ii", *position)),
            bus_line(t + 0.03, 129026, struct.pack("<BBHHH", 255, 0xFC, round(0.5 * np.pi * 1e4), 250, 0xFFFF)),
        ]
    return lines


BUS = layout((
    ColumnSpec("psi", "vesselHeading:True/heading", "rad"), ColumnSpec("r", "rateOfTurn/rate", "rad/s"),
    ColumnSpec("x0", "positionRapidUpdate/latitude", "m"), ColumnSpec("y0", "positionRapidUpdate/longitude", "m"),
    ColumnSpec("u", "cogSogRapidUpdate:True/north", "m/s", "earth"),
    ColumnSpec("v", "cogSogRapidUpdate:True/east", "m/s", "earth"),
))  # fmt: skip


def mavlink_datagrams() -> list[bytes]:
    mav = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    packets = []
    for k, t in enumerate(TIME):
        boot = 5000 + round(1e3 * float(t))
        pulses = [1500, 1900, *([0] * 14)]
        messages = (
            mav.attitude_encode(boot, 0.0, 0.0, float(HEADING[k]), 0.0, 0.0, RATE),
            mav.servo_output_raw_encode(boot * 1000, 0, *pulses[:8], *pulses[8:]),
        )
        packets.append(b"".join(message.pack(mav) for message in messages))
    return packets


MAV = layout((
    ColumnSpec("psi", "ATTITUDE/yaw", "rad"), ColumnSpec("r", "ATTITUDE/yawspeed", "rad/s"),
    ColumnSpec("command_1", "SERVO_OUTPUT_RAW/servo2_raw", "us", zero=1500.0, span=400.0),
))  # fmt: skip


def read_all(reader: MessageReader, items: list[bytes]) -> list[Sample]:
    return [*reader.samples(LineBatch(items)), *reader.flush()]


def test_messages_of_a_bus_become_samples() -> None:
    reader = MessageReader(BUS, BusDecoder(), rate=2.0)
    samples = read_all(reader, bus_lines())
    values = np.array([one.values for one in samples])
    assert np.diff([one.time for one in samples]) == pytest.approx(np.full(19, 0.5))
    np.testing.assert_allclose(np.unwrap(values[:, 0]), HEADING, atol=1e-4)
    np.testing.assert_allclose(values[:, 1], RATE, atol=1e-7)
    # 1e-5 deg of latitude at 60 deg north: meridian radius 6 383 454 m (WGS 84)
    np.testing.assert_allclose(values[:, 2], 6_383_454.0 * math.radians(1e-5) * np.arange(20), atol=0.02)
    np.testing.assert_allclose(values[:, 3:], np.tile([0.0, 0.0, 2.5], (20, 1)), atol=1e-4)
    assert reader.counts.garbled == 0


def test_messages_of_mavlink_become_samples_on_the_clock_of_the_sender() -> None:
    reader = MessageReader(MAV, MavlinkDecoder(), rate=2.0)
    samples = read_all(reader, [mavlink_datagrams()[0][:10], *mavlink_datagrams()[1:], b"\x00garbage"])
    values = np.array([one.values for one in samples])
    assert [samples[0].time, samples[-1].time] == [5.5, 14.5] and reader.counts.garbled == 2
    np.testing.assert_allclose(values[:, 0], HEADING[1:], atol=1e-6)
    np.testing.assert_allclose(values[:, 2], 1.0)


def test_a_step_without_a_reading_leaves_it_out_and_arrival_dates_what_has_no_stamp() -> None:
    now = iter([0.1, 0.2, 1.3, 1.4, 2.6])
    reader = MessageReader(layout(BUS.columns[:2], "arrival"), BusDecoder(), rate=1.0, clock=lambda: next(now))
    samples = read_all(reader, [*bus_lines()[:2], bus_lines()[0], bus_lines()[2], bus_lines()[1]])
    assert [one.time for one in samples] == [0.0, 1.0, 2.0]
    assert np.isnan([one.values for one in samples]).tolist() == [[False, False], [False, True], [True, False]]


def test_what_cannot_be_read_is_refused_or_counted() -> None:
    with pytest.raises(InputError, match="a column of messages is called topic/field, such as 'ATTITUDE/yaw'"):
        MessageReader(layout((ColumnSpec("psi", "yaw", "rad"),)), MavlinkDecoder(), rate=1.0)
    with pytest.raises(InputError, match="time of messages comes from 'stamp' or 'arrival', not from 't'"):
        MessageReader(layout(MAV.columns, "t"), MavlinkDecoder(), rate=1.0)
    reader = MessageReader(BUS, BusDecoder(), rate=1.0)
    assert read_all(reader, [b"\xff\xfe", b"no message", b""]) == [] and reader.counts.garbled == 1


@pytest.mark.parametrize(
    ("source", "columns", "items"),
    [(StreamSource.NMEA2000_UDP, BUS, bus_lines()), (StreamSource.MAVLINK_UDP, MAV, mavlink_datagrams())],
)
def test_a_stream_over_udp_is_followed(source: StreamSource, columns: Layout, items: list[bytes]) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    stream = Stream(source=source, rate=2.0, port=port, layout=columns)
    followed = open_source(stream)
    samples: list[Sample] = []
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for item in items:
                sender.sendto(item, ("127.0.0.1", port))
        while len(samples) < 19 and (arrived := followed.poll(2.0)):
            samples += arrived
    finally:
        followed.close()
    values = np.array([one.values for one in samples])
    np.testing.assert_allclose(np.unwrap(values[:, 0]), HEADING[: len(samples)], atol=1e-4)
    assert len(samples) == 19
