"""The file of proposed gains: angles in degrees, what is infinite left out."""

import math
import tomllib

import pytest

from seatrial.core.results.online import Estimated, GainMargins, Proposal
from seatrial.data.folder.gains_file import proposal_toml

ANY = Estimated(math.inf, 2.0, math.inf)
ANGLE = Estimated(1.0, 0.5, 2.0)


def test_infinite_margins_are_left_out_and_angles_are_degrees() -> None:
    margins = GainMargins(ANGLE, ANY, ANGLE, ANY, ANGLE, ANGLE, 40, 40)
    table = tomllib.loads(proposal_toml(Proposal("fins", 0.0, 1200.0, {"KP": 3.0}, ("why",), margins=margins)))
    assert table["gains"] == {"KP": 3.0}
    assert table["margins"]["gain_margin"] == {"lower": 2.0}
    assert table["margins"]["phase_margin_deg"]["value"] == pytest.approx(math.degrees(1.0), rel=1e-5)


def test_a_proposal_without_gains_says_why() -> None:
    table = tomllib.loads(proposal_toml(Proposal("fins", math.nan, math.nan, {}, ("too little roll",))))
    assert not table["has_gains"]
    assert table["reasons"] == ["too little roll"]
    assert "sea" not in table
