"""What the grids in waves simulate and how they score: equations, draws, design, the bound, results kept in files."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from benchmarks.craft_in_seas import CRAFT, nomoto
from benchmarks.criteria import beside
from benchmarks.seas_bound import likelihood, standard_errors
from benchmarks.seas_fits import ResultFile
from benchmarks.simulated_seas import (
    MODERATE,
    Conditions,
    Sea,
    discretised,
    disturbances,
    sensor_rows,
    simulated,
)
from benchmarks.waves import grid, run_cells, sample

from seatrial.physics.simulate import replay

ALL = ("psi", "r", "u", "v", "x0", "y0")


@pytest.mark.parametrize("name", CRAFT)
def test_equations_written_anew_agree_with_the_models_they_test(name: str) -> None:
    craft = CRAFT[name]()
    quiet = replace(craft, noise=dict.fromkeys(craft.noise, 0.0))
    run = simulated(quiet, Conditions("steps", rate=10.0, channels=ALL, seconds=60.0), [1])
    start = {s: float(run.motion[s][0]) for s in craft.model.states}
    replayed = replay(craft.model, run.record, start)
    for state in craft.model.states:
        np.testing.assert_allclose(replayed[state], run.motion[state], rtol=1e-5, atol=1e-6, err_msg=state)


def test_a_step_of_the_disturbances_is_two_of_half_of_it() -> None:
    A, noise = disturbances(Sea(0.02, 1.3, 2))
    half, half_covariance = discretised(A, noise, 0.5)
    whole, covariance = discretised(A, noise, 1.0)
    np.testing.assert_allclose(half @ half, whole, atol=1e-12)
    np.testing.assert_allclose(half @ half_covariance @ half.T + half_covariance, covariance, atol=1e-12)


def test_waves_on_sensors_have_the_size_that_was_set() -> None:
    sea = Sea(0.02, 0.8, 2)
    angle, rate = (rows[2] for rows in sensor_rows(sea, 50.0))
    variances = [1.0] * 3 + [v for _ in range(3) for w in sea.frequencies for v in (1.0, w**2)]
    assert np.sqrt(angle**2 @ variances) == pytest.approx(sea.rms)
    assert np.sqrt(rate**2 @ variances) == pytest.approx(sea.rms * np.sqrt(np.mean(np.square(sea.frequencies))))


@pytest.mark.parametrize("conditions", [Conditions("zigzag"), Conditions("zigzag", gusts=MODERATE)])
def test_one_seed_draws_one_record_and_waves_leave_the_rest_as_it_is(conditions: Conditions) -> None:
    steps = replace(conditions, manoeuvre="steps", seconds=120.0)  # their helm does not see the waves
    one, two = (simulated(nomoto(), steps, [7]) for _ in range(2))
    np.testing.assert_array_equal(one.record["psi"], two.record["psi"])
    wavy = simulated(nomoto(), replace(steps, sea=Sea(0.02)), [7])
    np.testing.assert_array_equal(one.motion["psi"], wavy.motion["psi"])
    assert np.std(wavy.record["psi"] - one.record["psi"]) > 0.01


def test_the_design_takes_every_level_equally_often() -> None:
    cells = grid()
    assert len(cells) <= 120
    assert len({cell.name for cell in cells}) == len(cells)
    ours = [cell.conditions for cell in cells if cell.craft == "nomoto"]
    for levels in (
        [c.rate for c in ours],
        [c.manoeuvre for c in ours],
        [c.channels for c in ours],
        [c.gusts for c in ours],
    ):
        counts = [levels.count(level) for level in set(levels)]
        assert max(counts) - min(counts) <= 1


def test_more_noise_admits_less_and_gusts_less_still() -> None:
    calm = Conditions("zigzag", channels=("psi", "r", "u"), seconds=300.0)
    waves, gusts = replace(calm, sea=Sea(0.02)), replace(calm, sea=Sea(0.02), gusts=MODERATE)
    errors = [standard_errors(nomoto(), c, simulated(nomoto(), c, [3]))["T"] for c in (calm, waves, gusts)]
    assert errors == sorted(errors)


def test_a_filter_with_the_true_disturbance_is_left_with_white_innovations() -> None:
    conditions = Conditions("autopilot", Sea(0.02, 0.8, 2), MODERATE, 2.0, ("psi", "r", "u"), 300.0)
    squared = [likelihood(nomoto(), conditions, simulated(nomoto(), conditions, [k])).squared[5:] for k in range(3)]
    assert np.mean(squared) == pytest.approx(2.0, abs=0.15)  # four standard errors of 3 * 596 values of variance 4


def test_spoilt_records_are_what_their_names_say() -> None:
    by_name = {case.name.partition(" ")[2]: case for case in beside()}
    lost = simulated(nomoto(), by_name["lost rows 10 %, zigzag"].conditions, [2])
    assert 0.85 < len(lost.record) / 901 < 0.95
    case = by_name["backlash 1 deg, zigzag"]
    gap = [simulated(nomoto(), replace(case.conditions, backlash=b), [2]).motion["psi"] for b in (0.0, 0.017)]
    assert np.max(np.abs(gap[0] - gap[1])) > 1e-3


def test_cells_are_kept_one_by_one_and_continued(tmp_path: Path) -> None:
    cell = sample()[0]
    cell = replace(cell, conditions=replace(cell.conditions, seconds=300.0))
    path = tmp_path / "waves.json"
    run_cells([cell], 1, ResultFile(path))
    again = ResultFile(path)
    (one,) = again.outcomes(cell.name)
    assert not one.refusal
    assert one.estimate["K"] == pytest.approx(nomoto().truth["K"], rel=0.02)
    run_cells([cell], 1, again)
    assert len(again.outcomes(cell.name)) == 1
