"""Fixes at 0/0 and values that stand for no reading are emptied before anything is joined, and found with their number
and times.
"""

import numpy as np
from tests.data.read.test_assembly import TIME, layout, log

from seatrial.data.check import examined_record
from seatrial.data.read import ColumnSpec
from seatrial.data.read.assemble import assemble_record

LOST = [60, 61, 120]  # rows without a fix, and without a yaw rate
FIXES = (ColumnSpec("lat", "gnss/lat", "deg"), ColumnSpec("lon", "gnss/lon", "deg"))


def columns() -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """A craft that goes north-east at 57 degrees north, and its yaw rate; deg, deg/s."""
    lat, lon, rate = 57.0 + 1e-5 * TIME, 11.0 + 1e-5 * TIME, 3.0 * np.sin(TIME)
    lat[LOST], lon[LOST], rate[LOST] = 0.0, 0.0, -999.0
    return {"time": TIME, "lat": lat, "lon": lon}, {"time": TIME + 0.03, "rate": rate}


def test_fixes_at_zero_are_empty_and_found() -> None:
    record = assemble_record(log(gnss=columns()[0]), layout(*FIXES), "")
    assert np.flatnonzero(np.isnan(record["x0"])).tolist() == LOST
    (finding,) = [one for one in examined_record(record).findings if one.code == "no-reading"]
    assert "'lat', 'lon': 3 of 200 fixes lie at 0/0, the first and the last at t = 6 to 12 s" in finding.text


def test_clocks_that_differ_do_not_smear_what_is_no_reading() -> None:
    gnss, gyro = columns()
    record = assemble_record(log(gnss=gnss, gyro=gyro), layout(*FIXES, ColumnSpec("r", "gyro/rate", "deg/s")), "")
    assert np.nanmax(np.abs(record["x0"])) < 30.0 and np.nanmax(np.abs(record["r"])) < np.radians(3.01)
    texts = [one.text for one in examined_record(record).findings if one.code == "no-reading"]
    assert len(texts) == 2 and "3 of 200 fixes lie at 0/0" in texts[0]
    assert "'r': 3 of 200 readings are -17.4358 rad/s" in texts[1]
