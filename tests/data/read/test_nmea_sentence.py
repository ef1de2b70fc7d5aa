"""Sentences against values worked out by hand from published examples."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.onboard.sentences import sentence

from seatrial.data.read.formats.nmea0183 import read_nmea0183
from seatrial.data.read.layout import ColumnSpec, Layout
from seatrial.data.read.log import Log
from seatrial.data.read.nmea_sentence import (
    Sentence,
    SentenceFault,
    SentenceReader,
    parse_sentence,
    readings,
    utc_time,
)
from seatrial.data.read.registry import format_of

KNOT = 1852 / 3600


def read(line: bytes) -> dict[str, float]:
    found = parse_sentence(line)
    assert isinstance(found, Sentence)
    return {place: value for place, value in readings(found).items() if not math.isnan(value)}


def test_published_examples_with_their_own_checksums() -> None:
    """Examples from manuals: a GGA of 12:35:19 at 48 07.038 N 11 31.000 E, an RSA of 10.5 degrees, an XDR of pitch."""
    fix = parse_sentence(b"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n")
    assert isinstance(fix, Sentence) and utc_time(fix) == 12 * 3600 + 35 * 60 + 19
    assert readings(fix)["GGA lat"] == pytest.approx(math.radians(48 + 7.038 / 60), rel=1e-15)
    assert readings(fix)["GGA lon"] == pytest.approx(math.radians(11 + 31 / 60), rel=1e-15)
    assert read(b"$IIRSA,10.5,A,,V*4D") == {"RSA": math.radians(10.5)}
    assert read(b"$YXXDR,A,86.0,D,PTCH,A,-85.2,D,ROLL*71") == {
        "XDR PTCH": math.radians(86.0),
        "XDR ROLL": math.radians(-85.2),
    }
    assert read(b"$HCHDT,115.1,T*2D") == {"HDT": math.radians(115.1)}
    assert read(b"$IIVHW,201.1,T,209.2,M,6.5,N,12.0,K*6E") == {
        "VHW": 6.5 * KNOT, "VHW heading": math.radians(201.1), "VHW magnetic": math.radians(209.2)
    }  # fmt: skip


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("HEROT,-30.0,A", {"ROT": math.radians(-0.5)}),
        ("HEROT,-30.0,V", {}),
        ("HETHS,90.0,A", {"THS": math.pi / 2}),
        ("HETHS,90.0,V", {}),
        ("IIRSA,-5.0,A,7.0,A", {"RSA": math.radians(-5), "RSA port": math.radians(7)}),
        ("GPVTG,90.0,T,,M,10.0,N,18.5,K,A", {"VTG north": 0.0, "VTG east": 10 * KNOT,
                                               "VTG speed": 10 * KNOT, "VTG course": math.pi / 2}),
        ("GPVTG,180.0,T,,M,,N,36,K", {"VTG north": -10.0, "VTG east": 0.0, "VTG speed": 10.0,
                                             "VTG course": math.pi}),
        ("GPVTG,90.0,T,,M,10.0,N,18.5,K,N", {}),
        ("GPVTG,,T,,M,0.0,N,0.0,K", {}),
        ("VDVBW,10.0,-0.5,A,9.0,0.5,A", {"VBW": 10 * KNOT, "VBW transverse": -0.5 * KNOT,
                                         "VBW ground": 9 * KNOT, "VBW ground transverse": 0.5 * KNOT}),
        ("VDVBW,10.0,-0.5,V,9.0,,A", {"VBW ground": 9 * KNOT}),
        ("WIMWV,270.0,R,10.0,N,A", {"MWV angle": 1.5 * math.pi, "MWV speed": 10 * KNOT}),
        ("WIMWV,30.0,T,18.0,K,A", {"MWV true angle": math.pi / 6, "MWV true speed": 5.0}),
        ("WIMWV,30.0,R,4.0,M,V", {}),
        ("IIRPM,S,1,120.0,100.0,A", {"RPM S1": 2.0}),
        ("IIRPM,S,1,120.0,100.0,V", {}),
        ("IIXDR,D,-1.5,M,HEAVE,C,20.1,C,AIR,A,3.0,D,rl", {"XDR HEAVE": -1.5, "XDR RL": math.radians(3)}),
        ("GPGLL,3000.00,S,06000.00,W,010203.50,A,A", {"GLL lat": math.radians(-30), "GLL lon": math.radians(-60)}),
        ("GPGLL,3000.00,S,06000.00,W,010203.50,V,N", {}),
        ("GPGGA,010203,3000.00,S,06000.00,W,0,,,,M,,M,,", {}),
        ("GNGNS,010203,3000.00,N,06000.00,E,AN,08,,,,,", {"GNS lat": math.radians(30), "GNS lon": math.radians(60)}),
        ("GNGNS,010203,,,,,NN,00,,,,,", {}),
        ("GPZDA,010203.00,01,02,2024,00,00", {}),
        ("GPRMC,010203,A,3000.0,N,06000.0,E,10.0,0.0,010224,,", {"RMC lat": math.radians(30),
         "RMC lon": math.radians(60), "RMC north": 10 * KNOT, "RMC east": 0.0,
         "RMC speed": 10 * KNOT, "RMC course": 0.0}),
        ("GPRMC,010203,A,,,,,,,010224,2.5,W", {"RMC variation": math.radians(-2.5)}),
        ("GPRMC,010203,V,3000.0,N,06000.0,E,10.0,0.0,010224,,", {}),
        ("PASHR,1,2,3", {}),
        ("PASHR,010203.00,90.0,T,2.0,-1.0,0.3,0.1,0.1,0.1,1,1", {
            "PASHR heading": math.pi / 2, "PASHR roll": math.radians(2), "PASHR pitch": math.radians(-1),
            "PASHR heave": 0.3}),
        ("HCHDG,15.0,5.0,W,10.0,W", {"HDG magnetic": math.radians(10), "HDG variation": math.radians(-10)}),
        ("HCHDG,15.0,,,3.0,E", {"HDG magnetic": math.radians(15), "HDG variation": math.radians(3)}),
        ("RAOSD,90.0,A,91.0,B,10.0,W,,,N", {"OSD heading": math.pi / 2, "OSD speed": 10 * KNOT}),
        ("RAOSD,90.0,A,91.0,B,10.0,B,,,N", {"OSD heading": math.pi / 2}),
        ("SDDPT,12.5,0.5", {"DPT depth": 12.5}),
        ("SDDBT,10.0,f,,M,,F", {"DBT depth": 3.048}),
        ("WIMWD,270.0,T,,M,10.0,N,,M", {"MWD direction": 1.5 * math.pi, "MWD speed": 10 * KNOT}),
        ("IIVWR,30.0,L,10.0,N,,M,,K", {"VWR angle": -math.pi / 6, "VWR speed": 10 * KNOT}),
        ("IIXDR,A,5.0,D,rudder#0,T,120,R,shaft", {"XDR RUDDER#0": math.radians(5), "XDR SHAFT": 2.0}),
        ("HEHDT", {}),
    ],
)  # fmt: skip
def test_fields_in_si(body: str, expected: dict[str, float]) -> None:
    found = read(sentence(body))
    assert found == pytest.approx(expected, rel=1e-14, abs=1e-14)


@pytest.mark.parametrize(
    "body",
    [
        "HEHDT,abc,T", "HEHDT,1_0,T", "HEHDT,nan,T", "HEHDT,1e3,T", "GPGGA,250000,3000.0,N,06000.0,E,1",
        "GPGGA,010203,9100.0,N,06000.0,E,1", "GPGGA,010203,3000.0,Q,06000.0,E,1", "GPGGA,010203,3000.0,,06000.0,E,1",
        "GPZDA,126099",
    ],
)  # fmt: skip
def test_a_field_that_is_not_what_it_should_be_raises(body: str) -> None:
    found = parse_sentence(sentence(body))
    assert isinstance(found, Sentence)
    with pytest.raises(ValueError, match=r"not a (number|time|latitude)"):
        utc_time(found)
        readings(found)


@pytest.mark.parametrize(
    "line", [b"$HEHDT,90.0,T*00", b"$HEHDT,90.0,T*", b"$HEHDT,91.0,T" + sentence("HEHDT,90.0,T")[-5:]]
)
def test_a_wrong_checksum_is_stated(line: bytes) -> None:
    assert parse_sentence(line) is SentenceFault.CHECKSUM


@pytest.mark.parametrize("line", [b"", b"hello", b"$HEHDT,90.0,T", b"$\xff\xff*00", sentence("he,1,2"), b"$*00"])
def test_what_is_no_sentence_is_stated(line: bytes) -> None:
    assert parse_sentence(line) is SentenceFault.GARBLED


def test_what_a_logger_writes_before_the_sentence_is_left_out() -> None:
    assert read(b"2024-05-01T10:00:00Z \\s:gyro*12\\" + sentence("HEHDT,90.0,T")) == {"HDT": math.pi / 2}


@given(st.integers(0, 60), st.integers(1, 255))
def test_one_changed_byte_is_always_noticed(place: int, change: int) -> None:
    line = bytearray(sentence("GPRMC,010203,A,3000.0,N,06000.0,E,10.0,0.0,010224,,").strip())
    whole = parse_sentence(bytes(line))
    place %= len(line)
    line[place] ^= change
    found = parse_sentence(bytes(line))
    assert isinstance(found, SentenceFault) or found == whole


@given(st.binary(max_size=100))
def test_no_bytes_raise(body: bytes) -> None:
    for line in (body, b"$" + body, sentence("X").replace(b"X", body)):
        found = parse_sentence(line)
        if isinstance(found, Sentence):
            try:
                utc_time(found)
                readings(found)
            except ValueError:
                pass


def test_a_magnetic_heading_becomes_true_by_the_last_variation() -> None:
    reader = SentenceReader()
    bodies = ("HCHDM,30.0,M", "GPRMC,010203,A,,,,,,,010224,10.0,W", "HCHDM,30.0,M", "IIVHW,,T,40.0,M,5.0,N,,K")
    heard = [reader.read(sentence(body)) for body in bodies]
    values = [one.values for one in heard if one is not None]
    assert "HDM true" not in values[0]
    assert math.degrees(values[2]["HDM true"]) == pytest.approx(20.0)
    assert math.degrees(values[3]["VHW heading"]) == pytest.approx(30.0)


def test_checksums_are_required_from_the_first_right_one_on() -> None:
    reader = SentenceReader()
    lines = (b"$HEHDT,90.0,T", sentence("HEHDT,91.0,T"), b"$HEHDT,92.0,T", b"$HEHDT,93.0,T*00")
    assert [reader.read(line) is not None for line in lines] == [True, True, False, False]
    assert reader.unchecked == 1
    assert reader.faults == {SentenceFault.GARBLED: 1, SentenceFault.CHECKSUM: 1}


def test_a_late_sentence_of_the_day_before_stays_there() -> None:
    reader = SentenceReader()
    clocks = ("235958.00", "235959.00", "000000.00", "235959.50", "000001.00")
    heard = [reader.read(sentence(f"GPZDA,{clock},01,09,2025,,")) for clock in clocks]
    assert [one.stamp - 86400.0 for one in heard if one is not None] == [-2.0, -1.0, 0.0, -0.5, 1.0]


def _log(path: Path, *lines: str) -> Log:
    path.write_text("".join(f"{line}\n" for line in lines))
    assert format_of(path) == "nmea0183"
    return read_nmea0183(path, Layout("nmea0183", ColumnSpec("time", "", "s"), ()))


def _line(body: str) -> str:
    return sentence(body).decode().strip()


@pytest.mark.parametrize(
    "written",
    [
        lambda body: _line(body),
        lambda body: f"\\s:GP0001,c:1756720800*00\\{_line(body)}",
        lambda body: f'2025-09-01T10:00:00.5,"{_line(body)}",ok',
        lambda body: f"[12.5] COM3> {_line(body)}",
        lambda body: f"${body}",
    ],
    ids=["plain", "tag block", "cell of a table", "prefix", "no checksum"],
)
def test_sentences_are_known_by_their_content(written: Callable[[str], str], tmp_path: Path) -> None:
    bodies = [
        body for k in range(3) for body in (f"GPZDA,0102{k:02},01,09,2025,,", f"IIRSA,,V,{k}.0,A", "GPGSV,3,1,11")
    ]
    log = _log(tmp_path / "trip.log", *map(written, bodies))
    rudder = log.tables[log.topics.index("RSA")]
    np.testing.assert_allclose(rudder.numbers(ColumnSpec("delta", "angle", "rad")), np.radians([0.0, 1.0, 2.0]))
    assert "sentences that are not read: GSV (3)" in log.notes
    assert any("no checksum" in note for note in log.notes) is (written("A") == "$A")
