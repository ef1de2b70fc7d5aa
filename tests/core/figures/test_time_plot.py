"""What a page's script reads: one grid, every extreme, 16 bits, gaps as gaps."""

import base64
import json
from typing import Any

import numpy as np
import pytest

from seatrial.core.figures.chart import Array, Rule, Stroke
from seatrial.core.figures.run import ChannelPanel, TimeCurve
from seatrial.core.figures.time_plot import GAP_CODE, LARGEST_CODE, POINTS, grid_values, packed, plot_document

LINE = Stroke("#1b4f72", 1.4, "5 2.5")


def unpacked(data: dict[str, Any]) -> Array:
    codes = np.frombuffer(base64.b64decode(data["codes"]), dtype="<u2")
    low, high = data["range"]
    return np.where(codes == GAP_CODE, np.nan, low + (high - low) * codes / LARGEST_CODE)


def test_packing_is_exact_to_half_a_step_and_keeps_gaps(rng: np.random.Generator) -> None:
    values = rng.standard_normal(300)
    values[40:60] = np.nan
    restored = unpacked(packed(values))
    assert np.array_equal(np.isnan(restored), np.isnan(values))
    step = np.ptp(values[np.isfinite(values)]) / LARGEST_CODE
    assert np.nanmax(np.abs(restored - values)) < 0.6 * step + 1e-6
    assert unpacked(packed(np.full(3, 2.5))) == pytest.approx([2.5] * 3)
    assert np.isnan(unpacked(packed(np.full(3, np.nan)))).all()


def test_thinning_keeps_the_extremes_of_every_stretch(rng: np.random.Generator) -> None:
    time, values = np.arange(20_000.0), rng.standard_normal(20_000)
    few = grid_values(time, values)
    assert len(few) == POINTS and few.max() == values.max() and few.min() == values.min()
    for k, stretch in enumerate(values.reshape(POINTS // 2, -1)):
        assert set(few[2 * k : 2 * k + 2]) == {stretch.min(), stretch.max()}
    assert np.array_equal(grid_values(time[:90], values[:90]), values[:90])


def test_a_document_has_curves_a_band_and_levels_over_one_time_axis() -> None:
    time = np.linspace(10.0, 70.0, 61)
    measured, model = TimeCurve(time, np.sin(time), LINE, "measured"), TimeCurve(time[::2], time[::2], LINE, "model")
    limit = Rule(35.0, Stroke("#a33022", 1.0))
    panel = ChannelPanel("ψ [deg]", (measured, model), time - 1.0, time + 1.0, (limit,))
    document = plot_document([panel])
    assert (document["start"], document["stop"], document["count"]) == (10.0, 70.0, 61)
    one = document["panels"][0]
    assert unpacked(one["curves"][1]) == pytest.approx(time, abs=1e-3)
    assert one["curves"][0]["stroke"] == ["#1b4f72", 1.4, [5.0, 2.5]]
    assert unpacked(one["band"][0]).max() <= unpacked(one["band"][1]).max()
    assert one["levels"] == [{"value": 35.0, "stroke": ["#a33022", 1.0, []]}]
    assert one["ends"][0] < 0.0 and one["ends"][1] > 70.0
    assert json.loads(json.dumps(document, allow_nan=False)) == document
