"""Controlled runs: the motion without control where it is known; limits about the actuator's steady value."""

from dataclasses import replace

import numpy as np
import pytest
from tests.reporting.fabricated_tuning import fabricated_autopilot, fabricated_bare, fabricated_fin

from seatrial.core.values import Record, frozen
from seatrial.reporting.figures.control_charts import (
    FREE,
    first_channel,
    manoeuvre_view,
    seaway_view,
    uncontrolled_channel,
)


def test_the_motion_without_control_is_shown_where_it_is_known() -> None:
    fin = fabricated_fin()
    bare = [replace(s, record=s.record.without("phi_uncontrolled")) for s in fin.seaway_simulations]
    chart, alone = seaway_view(fin), seaway_view(replace(fin, seaway_simulations=tuple(bare)))
    assert chart is not None and alone is not None
    assert [entry.words for entry in chart.legend] == ["with control", "without"]
    assert [entry.words for entry in alone.legend] == ["with control"]
    free = [curve.stroke is FREE for panel in chart.channels for curve in panel.curves]
    assert sum(free) == len(fin.seaway_simulations)
    assert seaway_view(fabricated_bare()) is None


def test_panels_of_one_quantity_share_their_axes() -> None:
    chart = seaway_view(fabricated_fin())
    assert chart is not None
    for name in ("φ [deg]", "α [deg]"):
        assert len({panel.ends for panel in chart.channels if panel.label.startswith(name)}) == 1


def test_a_demand_is_drawn_with_the_ships() -> None:
    tuning = fabricated_autopilot()
    chart = manoeuvre_view(tuning.manoeuvres[0], tuning)
    assert chart is not None and len(chart.channels) == 2
    assert [entry.words for entry in chart.legend] == ["response", "demand", "reference", "range of 12 ships drawn"]
    assert chart.channels[0].lower is not None
    assert manoeuvre_view(replace(tuning.manoeuvres[0], output="none"), tuning) is None


def test_limits_of_an_actuator_lie_about_its_steady_value() -> None:
    """A jet that runs at two metres a second may do so much more or less than that."""
    tuning = fabricated_autopilot()
    response = tuning.manoeuvres[0]
    rudder = response.record.channel("delta")
    limit = 1.2 * float(np.max(np.abs(rudder.values - rudder.values[0])))
    near = replace(tuning, constraints=replace(tuning.constraints, limit=limit))
    record = response.record.with_channel("delta", replace(rudder, values=frozen(rudder.values + 2.0)))

    def limits(record_of_run: Record) -> list[float]:
        chart = manoeuvre_view(replace(response, record=record_of_run), near)
        assert chart is not None
        return [rule.value for rule in chart.channels[1].limits]

    assert np.array(limits(record)) - limits(response.record) == pytest.approx(np.degrees([2.0, 2.0]))


def test_channels_of_a_record() -> None:
    record = fabricated_fin().seaway_simulations[0].record
    assert first_channel(record, "nothing", "phi") == "phi" and first_channel(record, "nothing") == ""
    assert uncontrolled_channel(record, "phi") == "phi_uncontrolled" and uncontrolled_channel(record, "psi") == ""
