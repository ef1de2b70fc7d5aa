"""Sentences without a time of their own are placed by the logger's receipt, on the clock of those that have one."""

from pathlib import Path

import numpy as np
import pytest

from seatrial.api import survey_log
from seatrial.data.read.nmea_sentence import checksum, on_the_clock, receipt_time


@pytest.mark.parametrize(
    ("head", "time"),
    [
        (b"2026-09-23T06:41:07.131Z\t", 1790145667.131),
        (b"2026-09-23 06:41:07,131;COM3;", 1790145667.131),
        (b"1790145667.131 ", 1790145667.131),
        (b"1790145667131,", 1790145667.131),
        (b"2026-09-23T06:41:07Z ", np.nan),
        (b"", np.nan),
    ],
)
def test_the_time_before_a_sentence_is_read_to_parts_of_a_second(head: bytes, time: float) -> None:
    assert receipt_time(head + b"$HEHDT,1790145667131.1,T*00") == pytest.approx(time, abs=1e-6, nan_ok=True)


def test_receipts_are_moved_to_the_clock_of_the_stamps() -> None:
    """The logger is 100 s ahead, the line 0.04 s late."""
    truth = np.arange(0.0, 20.0, 0.25)
    stamps = np.where(truth % 1.0 == 0.0, truth, np.nan)
    np.testing.assert_allclose(on_the_clock(truth + 100.04, stamps), truth, atol=1e-9)
    assert on_the_clock(truth[::-1], stamps) is None and on_the_clock(truth + np.nan, stamps) is None


@pytest.mark.parametrize(("with_receipt", "early_s"), [(True, 0.01), (False, 1.0)])
def test_a_sentence_before_the_stamp_of_its_epoch_is_placed_by_its_receipt(
    tmp_path: Path, with_receipt: bool, early_s: float
) -> None:
    """A heading that turns by 1 deg/s, sent 10 ms before the position of the same second."""
    lines = []
    for k in range(60):
        sentences = (f"HEHDT,{k:.1f},T", f"GPGGA,0641{k:02d}.00,5427.5953,N,01043.1859,E,4,14,0.8,18.2,M,42.0,M,,")
        for part, body in zip((".010", ".020"), sentences, strict=True):
            head = f"2026-09-23T06:41:{k:02d}{part}Z " if with_receipt else ""
            lines.append(f"{head}${body}*{checksum(body.encode()):02X}")
    (tmp_path / "log.txt").write_text("\n".join(lines), encoding="ascii")
    tables = {one.topic: one for one in survey_log(tmp_path / "log.txt").log.tables}
    (time, heading), stamps = tables["HDT"].cells, np.asarray(tables["GGA"].cells[0])
    second = np.rint(np.degrees(heading)).astype(int)
    np.testing.assert_allclose(stamps[second] - time, early_s, atol=1e-6)
