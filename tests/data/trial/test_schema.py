"""The origin of a plane of positions: angles in radians, or with their unit."""

from math import radians

import pytest
from pydantic import ValidationError

from seatrial.data.trial.schema import OriginTable


def test_degrees_written_as_radians_are_refused_with_the_edit() -> None:
    with pytest.raises(ValidationError, match=r'lat = 57\.62 rad is no place.*lat = { value = 57\.62, unit = "deg" }'):
        OriginTable.model_validate({"lat": 57.62, "lon": 0.19})


def test_an_origin_in_degrees_is_read() -> None:
    origin = OriginTable.model_validate({"lat": {"value": 57.62, "unit": "deg"}, "lon": 0.19})
    assert origin.lat == pytest.approx(radians(57.62))
