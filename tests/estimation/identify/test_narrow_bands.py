"""Bands that held-out runs leave too often are named with the share that lies inside."""

import numpy as np
import pytest

from seatrial.core.results import Prediction, WindowScore
from seatrial.core.results.prediction import ChannelScore
from seatrial.core.values import Record
from seatrial.estimation.identify.warnings import narrow_band_findings


def prediction(role: str, inside: float | None) -> Prediction:
    run = Record.from_arrays("run", np.arange(3.0), {"phi": np.zeros(3)})
    windows = (
        WindowScore("5 s", 5.0, 4, {"phi_deg": ChannelScore(1.0, 50.0, 0.7, 0.1)}),
        WindowScore("20 s", 20.0, 1, {"phi_deg": ChannelScore(1.0, 50.0, 0.7, inside)}),
    )
    return Prediction("run_2", role, run, run, {}, {}, 0.0, windows=windows)


def test_half_of_a_held_out_run_outside_is_a_warning_with_a_cure() -> None:
    (finding,) = narrow_band_findings([prediction("validation", 0.5), prediction("training", 0.5)])
    assert finding.code == "narrow-band" and finding.evidence == "inside are 50 % of phi_deg in run_2"
    assert "four runs" in finding.advice


@pytest.mark.parametrize(("role", "inside"), [("validation", 0.8), ("validation", None), ("training", 0.2)])
def test_what_chance_may_do_is_not(role: str, inside: float | None) -> None:
    assert narrow_band_findings([prediction(role, inside)]) == ()
