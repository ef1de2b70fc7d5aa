"""Sentences to samples: one for each time stamp, every sentence accounted for, whatever else comes."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.onboard.sentences import sentence

from seatrial.core.results.online import Sample
from seatrial.core.values import InputError
from seatrial.data.read import ColumnSpec, Layout
from seatrial.onboard.lines import LineBatch, LineSplitter
from seatrial.onboard.nmea import NmeaReader, east_distance, north_distance

STAMP, ARRIVAL = ColumnSpec("time", "stamp", "s"), ColumnSpec("time", "arrival", "s")


def layout(*symbols: str, time: ColumnSpec = STAMP) -> Layout:
    return Layout("text", time, tuple(ColumnSpec(symbol, symbol, "1") for symbol in symbols))


def feed(reader: NmeaReader, *bodies: str) -> list[Sample]:
    return reader.samples(LineBatch([sentence(body) for body in bodies]))


def zigzag(count: int, *, start: float = 0.0) -> list[str]:
    """A second apart: stamp, heading, rate of turn, rudder and speed, all of them counted up."""
    bodies = []
    for k in range(count):
        second = (start + k) % 86400.0
        clock = f"{second // 3600:02.0f}{second // 60 % 60:02.0f}{second % 60:05.2f}"
        bodies += [
            f"GPZDA,{clock},01,02,2024,,",
            f"HEHDT,{k % 360:.1f},T",
            f"HEROT,{k:.1f},A",
            f"IIRSA,{-k / 10:.1f},A,,V",
            f"VDVBW,{k:.1f},0.0,A,,,V",
        ]
    return bodies


def test_one_sample_for_each_stamp() -> None:
    reader = NmeaReader(layout("psi", "r", "delta", "u"), rate=1.0)
    found = feed(reader, *zigzag(5)) + reader.flush()
    assert [s.time for s in found] == [0.0, 1.0, 2.0, 3.0, 4.0]
    k = np.arange(5)
    expected = np.column_stack([np.radians(k), np.radians(k) / 60, -np.radians(k) / 10, k * 1852 / 3600])
    np.testing.assert_allclose(np.array([s.values for s in found]), expected, rtol=1e-14)
    assert (reader.used, reader.unused) == (25, 0)


def test_midnight_is_passed() -> None:
    reader = NmeaReader(layout("psi"), rate=1.0)
    found = feed(reader, *zigzag(6, start=86397.0)) + reader.flush()
    assert [s.time for s in found] == [86397.0 + k for k in range(6)]


def test_the_reading_nearest_the_stamp_counts_and_a_missing_one_is_nan() -> None:
    reader = NmeaReader(layout("psi", "r"), rate=1.0)
    found = feed(reader, "GPZDA,000000", "HEHDT,10,T", "HEHDT,11,T", "GPZDA,000001", "HEROT,6,A", "GPZDA,000002")
    np.testing.assert_allclose([s.values for s in found], [[math.radians(10), np.nan], [np.nan, math.radians(0.1)]])
    assert (reader.used, reader.unused) == (5, 1)


def test_stamps_of_several_sentences_of_one_epoch_are_one() -> None:
    reader = NmeaReader(layout("x0", "y0", "psi"), rate=10.0)
    fix = "5400.0000,N,01000.0000,E"
    found = feed(
        reader,
        f"GPRMC,120000.00,A,{fix},5.0,90.0,010224,,", f"GPGGA,120000.00,{fix},1,08", f"GPGLL,{fix},120000.01,A",
        "HEHDT,1,T", "GPZDA,120000.10", "HEHDT,2,T", "GPZDA,120000.20",
    )  # fmt: skip
    assert [s.time for s in found] == pytest.approx([43200.0, 43200.1])
    np.testing.assert_allclose(found[0].values, [0.0, 0.0, math.radians(1)])


def test_a_relay_behind_its_time_is_late_and_a_clock_set_back_is_followed() -> None:
    reader = NmeaReader(layout("psi"), rate=1.0)
    found = feed(reader, "GPZDA,000100", "HEHDT,1,T", "IIZDA,000058", "GPZDA,000101", "GPZDA,000010", "HEHDT,2,T")
    found += reader.flush()
    assert [s.time for s in found] == [60.0, 61.0, 10.0] and reader.counts.late == 1


def test_position_on_the_plane_of_the_first_fix() -> None:
    """A minute of latitude is 1855.1 m and one of longitude 1092.9 m at 54 degrees north on WGS 84."""
    reader = NmeaReader(layout("x0", "y0"), rate=1.0)
    found = feed(
        reader,
        "GPGGA,000000,5400.0000,N,17959.5000,E,1,08", "GPGGA,000001,5401.0000,N,17959.5000,W,1,08",
    ) + reader.flush()  # fmt: skip
    np.testing.assert_allclose(found[0].values, [0.0, 0.0])
    np.testing.assert_allclose(found[1].values, [1855.1, 1092.9], atol=0.06)
    assert reader.origin == (math.radians(54), math.radians(179 + 59.5 / 60))
    again = NmeaReader(layout("x0", "y0"), rate=1.0, origin=reader.origin)
    feed(again, "GPGGA,000001,5401.0000,N,17959.5000,W,1,08")
    np.testing.assert_array_equal(again.flush()[0].values, found[1].values)


@given(st.floats(-1.3, 1.3), st.floats(-3.1, 3.1), st.floats(-1e-4, 1e-4), st.floats(-1e-4, 1e-4))
def test_the_plane_touches_the_ellipsoid(latitude: float, longitude: float, north: float, east: float) -> None:
    """Distance on the plane against the chord through the ellipsoid (Snyder 1987), within 900 m."""

    def point(phi: float, lam: float) -> np.ndarray:
        a, e2 = 6378137.0, 6.69437999014e-3
        n = a / math.sqrt(1 - e2 * math.sin(phi) ** 2)
        flat = n * math.cos(phi)
        return np.array([flat * math.cos(lam), flat * math.sin(lam), n * (1 - e2) * math.sin(phi)])

    origin = (latitude, longitude)
    chord = np.linalg.norm(point(latitude + north, longitude + east) - point(*origin))
    plane = math.hypot(north_distance(latitude + north, origin), east_distance(longitude + east, origin))
    assert plane == pytest.approx(float(chord), rel=1e-3, abs=1e-6)


def test_the_better_sensor_takes_over_and_the_worse_one_is_not_mixed_in() -> None:
    reader = NmeaReader(layout("u"), rate=1.0)
    found = feed(
        reader,
        "GPZDA,000000", "IIVHW,,T,,M,10,N,,K", "GPZDA,000001", "IIVHW,,T,,M,10,N,,K", "VDVBW,8,0,A,,,V",
        "GPZDA,000002", "IIVHW,,T,,M,10,N,,K", "GPZDA,000003",
    )  # fmt: skip
    np.testing.assert_allclose([s.values[0] * 3600 / 1852 for s in found], [10.0, 8.0, np.nan])


def test_a_place_can_be_named() -> None:
    columns = (
        ColumnSpec("u", "VTG north", "m/s", frame="earth"),
        ColumnSpec("v", "VTG east", "m/s", frame="earth"),
        ColumnSpec("phi", "XDR rl", "deg"),
        ColumnSpec("n", "RPM S2", "rpm"),
    )
    reader = NmeaReader(Layout("text", STAMP, columns), rate=1.0)
    feed(reader, "GPZDA,000000", "GPVTG,90,T,,M,10,N,,K", "IIXDR,A,90,D,RL", "IIRPM,S,2,60,,A", "IIRPM,S,1,30,,A")
    np.testing.assert_allclose(reader.flush()[0].values, [0.0, 10 * 1852 / 3600, math.pi / 2, 1.0], atol=1e-15)


def test_by_arrival_a_repeated_reading_begins_the_next_sample() -> None:
    now = [100.0]
    reader = NmeaReader(layout("psi", "r", time=ARRIVAL), rate=1.0, clock=lambda: now[0])
    assert feed(reader, "HEHDT,1,T", "HEROT,60,A") == []
    now[0] = 101.0
    (first,) = feed(reader, "HEHDT,2,T", "HEROT,120,A")
    now[0] = 104.0
    found = feed(reader, "HEHDT,3,T", "HEHDT,4,T", "HEHDT,5,T")
    assert first.time == 100.0
    assert [s.time for s in found] == pytest.approx([101.0, 102.0, 103.0])
    assert [s.time for s in reader.flush()] == [104.0]
    np.testing.assert_allclose(first.values, np.radians([1.0, 1.0]))


def test_wrong_checksums_and_garbled_sentences_are_counted() -> None:
    reader = NmeaReader(layout("psi"), rate=1.0)
    good = sentence("HEHDT,90,T")
    lines = [sentence("GPZDA,000000"), good.replace(b"9", b"8"), b"\xff\xfe", b"$HEHDT,90", b"", good, b"hello"]
    reader.samples(LineBatch(lines))
    assert (reader.counts.checksum, reader.counts.garbled) == (1, 3) and reader.counts.last_problem.isascii()
    np.testing.assert_allclose(reader.flush()[0].values, [math.pi / 2])


KINDS = ["HDT", "ROT", "RSA", "VTG", "RMC", "GGA", "GLL", "VHW", "VBW", "RPM", "XDR", "ZDA", "GNS", "THS", "ABC"]
FIELD = st.one_of(
    st.sampled_from(["A", "V", "N", "T", "", "S", "1", "120000", "5400.0", "01000.0", "D", "ROLL"]),
    st.floats(allow_nan=False).map(str),
    st.text("0123456789.-,ABC", max_size=6),
)
BODY = st.builds(
    lambda kind, fields: ",".join(["XX" + kind, *fields]), st.sampled_from(KINDS), st.lists(FIELD, max_size=14)
)
LINE = st.one_of(
    BODY.map(sentence), st.binary(max_size=40), st.builds(lambda b, n: sentence(b)[:n], BODY, st.integers(0, 50))
)


@given(st.lists(LINE, max_size=40), st.sampled_from([STAMP, ARRIVAL]))
def test_no_bytes_raise_and_every_sentence_is_accounted_for(lines: list[bytes], time: ColumnSpec) -> None:
    reader = NmeaReader(layout("psi", "x0", "y0", "u", "phi", "n", time=time), rate=1.0, clock=lambda: 5.0)
    found = reader.samples(LineBatch(lines)) + reader.flush()
    counts = reader.counts
    counted = reader.used + reader.unused + counts.garbled + counts.checksum + counts.late
    assert counted == sum(bool(line.strip()) for line in lines)
    assert all(math.isfinite(s.time) and not np.isinf(s.values).any() for s in found)


@given(st.lists(st.integers(0, 4000), max_size=12))
def test_cuts_in_the_stream_do_not_matter(cuts: list[int]) -> None:
    stream = b"".join(map(sentence, zigzag(20)))
    edges = [0, *sorted(min(cut, len(stream)) for cut in cuts), len(stream)]
    reader, cutter, found = NmeaReader(layout("psi", "r"), rate=1.0), LineSplitter(), []
    for a, b in pairwise(edges):
        found += reader.samples(LineBatch(cutter.split(stream[a:b])))
    whole = NmeaReader(layout("psi", "r"), rate=1.0).samples(LineBatch(stream.split(b"\n")))
    assert [s.time for s in found] == [s.time for s in whole] == list(range(19))
    np.testing.assert_array_equal([s.values for s in found], [s.values for s in whole])


def test_without_any_stamp_it_is_said() -> None:
    reader = NmeaReader(layout("psi"), rate=1.0)
    assert feed(reader, *["HEHDT,1,T"] * 200) == []
    assert "arrival" in reader.counts.last_problem and reader.unused == 200


@pytest.mark.parametrize(
    ("columns", "text"),
    [
        ((ColumnSpec("F3", "F3", "N"),), "no NMEA 0183 sentence contains channel 'F3'"),
        ((ColumnSpec("psi", "HTD", "deg"),), "no NMEA field 'HTD'; did you mean 'HDT'"),
        ((ColumnSpec("psi", "ROT", "deg"),), "is in rad/s"),
    ],
)
def test_a_channel_that_nothing_tells_is_refused(columns: tuple[ColumnSpec, ...], text: str) -> None:
    with pytest.raises(InputError, match=text):
        NmeaReader(Layout("text", STAMP, columns), rate=1.0)


def test_another_clock_is_refused() -> None:
    with pytest.raises(InputError, match="'stamp' or 'arrival'"):
        NmeaReader(layout("psi", time=ColumnSpec("time", "gps", "s")), rate=1.0)
