"""Sentences against values worked out by hand from published examples."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.onboard.sentences import sentence

from seatrial.data.read.nmea_sentence import Sentence, SentenceFault, parse_sentence, readings, utc_time

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
    assert read(b"$IIVHW,201.1,T,209.2,M,6.5,N,12.0,K*6E") == {"VHW": 6.5 * KNOT, "VHW heading": math.radians(201.1)}


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
        ("GPRMC,010203,V,3000.0,N,06000.0,E,10.0,0.0,010224,,", {}),
        ("PASHR,1,2,3", {}),
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
