"""Tables of motions in waves: sickness stands where somebody is aboard."""

import pytest
from tests.reporting.section_text import cells, header

from seatrial.core.results import Seakeeping
from seatrial.core.results.ship_motions import PointMotion
from seatrial.reporting.seakeeping_chapter import seakeeping_section

CURVE = (1.0, 0.5)
SEA = Seakeeping("run", 5.0, 180.0, "a sea", CURVE, CURVE, CURVE, CURVE, CURVE, CURVE, CURVE, CURVE, CURVE, 0.6, 3.0,
                 (5.0, 6.0), (PointMotion("bow", 30.0, 1.2, 0.9, 0.2),))  # fmt: skip


@pytest.mark.parametrize(("length", "has_sickness"), [(3.2, False), (60.0, True), (0.0, True)])
def test_sickness_is_given_where_somebody_is_aboard(length: float, has_sickness: bool) -> None:
    chapter = seakeeping_section(SEA, length)
    (along, *_) = chapter.parts
    assert (header(along.table)[-1] == "sick in two hours, %") == has_sickness == ("Sickness" in along.note)
    assert cells(chapter.table)[0][0] == "heave, m"
