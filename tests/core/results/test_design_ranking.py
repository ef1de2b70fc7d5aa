"""Standard manoeuvres are ranked by the criterion of the design, those within its limits first."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.reporting.fabricated_design import LIMITS, fabricated_design

from seatrial.core.results import Design
from seatrial.core.results.design_ranking import (
    best_baseline,
    count_outside_limits,
    criterion_error,
    has_track,
    is_within_limits,
    ranked_baselines,
    sampled_criterion_errors,
)


@pytest.fixture(scope="module")
def design() -> Design:
    """Three standard manoeuvres: prbs beats zigzag, the turning circle leaves the limits, prbs loses a drawn ship."""
    return fabricated_design()


def test_the_smaller_error_comes_first_and_what_leaves_the_limits_last(design: Design) -> None:
    errors = [criterion_error(manoeuvre, "worst") for manoeuvre in design.baselines]
    assert errors[1] < errors[0] < errors[2] and not is_within_limits(design.baselines[2], LIMITS)
    zigzag, prbs, turn = design.baselines
    assert ranked_baselines(design) == (prbs, zigzag, turn)
    assert best_baseline(design) is prbs
    assert best_baseline(replace(design, baselines=())) is None


def test_mean_and_worst_look_at_different_errors(design: Design) -> None:
    (manoeuvre,) = design.baselines[:1]
    assert criterion_error(manoeuvre, "mean") == manoeuvre.mean <= manoeuvre.worst
    worst, mean = (sampled_criterion_errors(manoeuvre, criterion) for criterion in ("worst", "mean"))
    assert all(m <= w for m, w in zip(mean, worst, strict=True))
    np.testing.assert_allclose(worst, manoeuvre.sampled_relative_error.max(axis=1))


def test_a_drawn_ship_that_diverges_is_counted_and_left_out(design: Design) -> None:
    _, manoeuvre, _ = design.baselines
    assert manoeuvre.diverged == 1 and math.isfinite(manoeuvre.worst_sampled_error)
    lost = replace(manoeuvre, sampled_relative_error=np.full((2, 3), np.nan))
    assert math.isnan(lost.worst_sampled_error) and lost.diverged == 2


def test_drawn_ships_bind_only_where_the_limits_are_for_every_ship(design: Design) -> None:
    (manoeuvre,) = design.baselines[:1]
    wide = replace(manoeuvre, sampled_drift=np.array([0.0, 2.0 * LIMITS.drift]), sampled_distance=np.zeros(2))
    assert count_outside_limits(wide, LIMITS) == 1
    assert is_within_limits(wide, replace(LIMITS, for_every_ship=False))
    assert not is_within_limits(wide, replace(LIMITS, for_every_ship=True))


def test_a_design_without_positions_has_no_track(design: Design) -> None:
    assert has_track(design)
    assert not has_track(replace(design, designed=replace(design.designed, distance=0.0)))
