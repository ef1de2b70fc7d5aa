"""Trials of the known ships with two screws and in shallow water: what they show, and what their instruments add."""

import numpy as np
import pytest

from seatrial.problems.twin_ships import (
    DEPTHS,
    shallow_water_ship,
    shallow_water_trials,
    twin_jet_craft,
    twin_jet_trials,
    twin_screw_ship,
    twin_screw_trials,
)


def test_kicks_turn_the_ferry_to_the_side_of_the_shaft_astern_and_slow_it_down() -> None:
    kicks = twin_screw_trials(twin_screw_ship()).runs[-1]
    against = (kicks["n"] == 0.0) & (kicks["n_difference"] > 0.0)
    assert kicks["r"][against][-1] > 0.0
    assert np.ptp(kicks["delta_difference"]) > 0.5
    assert np.min(kicks["u"]) < 0.8 * kicks["u"][0]


def test_kicks_turn_the_craft_away_from_the_faster_jet_and_buckets_stop_it() -> None:
    kicks = twin_jet_trials(twin_jet_craft()).runs[-1]
    port_faster = (kicks["v_j_difference"] > 0.0) & (kicks["delta"] == 0.0)
    assert kicks["r"][port_faster][-1] > 0.0
    backing = kicks["bucket"] > 0.8
    assert kicks["u"][backing][-1] < 0.5 * kicks["u"][backing][0]


def test_the_tanker_advances_farther_in_shallow_water(rng: np.random.Generator) -> None:
    trials = shallow_water_trials(shallow_water_ship())
    circles = [run for run in trials.runs if run.name.startswith("turning-circle")]
    assert [float(run["depth"][0]) for run in circles] == pytest.approx([ratio * 0.46 for ratio in DEPTHS])
    advances = [float(np.interp(np.pi / 2, run["psi"], run["x0"])) for run in circles]
    assert advances[1] > 1.05 * advances[0]
    noisy = trials.noisy(rng)[0]
    assert np.std(noisy["psi"] - trials.runs[0]["psi"]) == pytest.approx(trials.noise["psi"], rel=0.2)
