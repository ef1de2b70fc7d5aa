"""yu2014's point, energy: W by its definition, losses against closed forms, the joint search, the records."""

import math

import numpy as np
import pytest

from seatrial.physics.loops import Preamplifier, reversals_per_hour
from seatrial_studies.study_file import read_study
from seatrial_studies.yu2014.published import (
    PUBLISHED,
    PUBLISHED_VALUES,
    TABLE_1,
    TARGET,
    SeaCondition,
    performance,
    regulator_settings,
    roll_response,
    sea_regulator,
    speed_regulator,
)
from seatrial_studies.yu2014.reproduction import (
    EFFICIENCY,
    compare_energy,
    fin_drag_power,
    fin_energy,
    fit_table_1,
    lift_slope,
    work,
)
from seatrial_studies.yu2014.searches import joint_optimum, wave_slope_record

WASHOUT = Preamplifier.WASHOUT


@pytest.fixture(scope="module")
def energy():
    return compare_energy(fit_table_1(WASHOUT, following_is_zero=True))


def test_work_is_that_of_eq_3() -> None:
    assert work(5.07) == pytest.approx(PUBLISHED.inertia * (5.07 * math.pi / 180.0) ** 2 / EFFICIENCY)
    of = performance(WASHOUT)
    assert fin_energy(of, PUBLISHED_VALUES, 18.0).work == pytest.approx(work(roll_response(of).rate), rel=1e-9)


def test_ratios_of_the_print_are_those_of_its_table(energy) -> None:
    assert [round(e.printed_rate_ratio, 2) for e in energy] == [0.77, 0.75, 0.68, 0.91, 1.04, 0.85]
    assert [round(e.saved(e.printed)) for e in energy] == [40, 44, 54, 18, -9, 28]


def test_ours_does_not_give_the_printed_ratios(energy) -> None:
    assert all(0.95 < e.fitted_rate_ratio < 1.02 for e in energy)
    for e, row in zip(energy, TABLE_1, strict=True):
        assert e.row == row.name
        assert e.fitted_rate_ratio**2 == pytest.approx(e.fitted[1].work / e.fitted[0].work)


def test_lift_and_drag_are_those_of_low_aspect_ratios() -> None:
    """Jones's slope pi a / 2 at vanishing aspect ratio bounds it from above; at no angle only profile drag."""
    assert 0.8 * math.pi * 1.06 / 2.0 < lift_slope() < math.pi * 1.06 / 2.0
    still = fin_drag_power(0.0, 18.0)
    assert fin_drag_power(0.0, 22.0) / still == pytest.approx((22.0 / 18.0) ** 3)
    induced = [fin_drag_power(angle, 18.0) - still for angle in (2.0, 4.0)]
    assert induced[1] / induced[0] == pytest.approx(4.0)


def test_a_harmonic_turns_back_twice_a_period() -> None:
    omega = 0.8
    assert reversals_per_hour(omega, omega**2) == pytest.approx(2.0 * 3600.0 / (2.0 * math.pi / omega))


def test_the_speed_regulator_keeps_the_loop() -> None:
    slow, fast = (performance(WASHOUT, SeaCondition(speed, 90.0)) for speed in (18.0, 22.0))
    held = fast.loop.with_gains(speed_regulator(22.0) * PUBLISHED_VALUES)
    omega = np.geomspace(0.1, 10.0, 20)
    assert np.allclose(held.open_loop(omega), slow.loop.with_gains(PUBLISHED_VALUES).open_loop(omega))
    assert speed_regulator(18.0) == 1.0


def test_the_sea_regulator_meets_the_target_or_is_one() -> None:
    for setting in regulator_settings(Preamplifier.PRINTED):
        assert setting.fins[0] ** 2 * math.radians(1.0) ** 2 == pytest.approx(TARGET, rel=1e-6)
        assert 0.0 < setting.Gh < 1.0
    assert sea_regulator(WASHOUT, 2.0) == 1.0


def test_the_joint_search_keeps_its_limits_and_is_the_same_again() -> None:
    first, again = (joint_optimum(WASHOUT, 1, 0) for _ in range(2))
    assert first.gains.tobytes() == again.gains.tobytes()
    assert 0.9 < first.worst_ratio < 1.0
    assert np.all(first.Ms <= 2.0 + 1e-9)
    assert first.genetic_worst_ratios[0] > first.worst_ratio
    for k, row in enumerate(TABLE_1):
        of = performance(WASHOUT, SeaCondition(row.speed, row.heading))
        ratio = of.evaluate(first.gains).variances / of.evaluate(PUBLISHED_VALUES).variances
        assert np.allclose(ratio[0], first.ratios[k])


def test_the_record_of_the_search_has_the_variance_of_its_spectrum() -> None:
    slopes = [wave_slope_record(np.random.default_rng(seed)).var() for seed in range(12)]
    assert np.mean(slopes) == pytest.approx(float(performance(WASHOUT).spectrum.energy.sum()), rel=0.1)


def test_every_figure_has_a_counterpart_and_every_symbol_a_meaning() -> None:
    declared = read_study("yu2014")
    assert len(declared.paper_figures) == 7
    assert all(meaning and value for _, meaning, _, value in declared.symbols)
