"""Tables of motions in waves: sickness stands where somebody is aboard."""

import pytest

from seatrial.core.results import Seakeeping
from seatrial.core.results.ship_motions import PointMotion
from seatrial.reporting.seakeeping_chapter import tables

CURVE = (1.0, 0.5)
SEA = Seakeeping("run", 5.0, 180.0, "a sea", CURVE, CURVE, CURVE, CURVE, CURVE, CURVE, CURVE, CURVE, CURVE, 0.6, 3.0,
                 (5.0, 6.0), (PointMotion("bow", 30.0, 1.2, 0.9, 0.2),))  # fmt: skip


@pytest.mark.parametrize(("length", "has_sickness"), [(3.2, False), (60.0, True), (0.0, True)])
def test_sickness_is_given_where_somebody_is_aboard(length: float, has_sickness: bool) -> None:
    motions, along = tables(SEA, length)
    assert (along.header[-1] == "sick in two hours, %") == has_sickness == ("sickness" in along.note)
    assert len(along.rows[0]) == len(along.header) and motions.rows[0][0] == "heave, m"
