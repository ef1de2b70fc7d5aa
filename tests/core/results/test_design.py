"""Manoeuvres compared: the criterion's error, the limits, the order of the standard ones."""

from dataclasses import replace

import numpy as np
import pytest
from tests.reporting.fabricated_design import fabricated_design

from seatrial.core.results import Design, TrialLimits
from seatrial.core.results.design import (
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
    return fabricated_design()


def test_the_criterion_chooses_the_error(design: Design) -> None:
    error = design.designed.relative_error
    assert criterion_error(design.designed, "worst") == error.max()
    assert criterion_error(design.designed, "mean") == pytest.approx(np.sqrt(np.mean(error**2)))


@pytest.mark.parametrize("criterion", ["worst", "mean"])
def test_a_drawn_ship_that_diverges_has_no_error(design: Design, criterion: str) -> None:
    lost = next(m for m in design.baselines if m.diverged)
    errors = sampled_criterion_errors(lost, criterion)
    assert sum(np.isnan(errors)) == lost.diverged == 1
    assert lost.worst_sampled_error == np.nanmax(lost.sampled_relative_error)


def test_without_drawn_ships_there_is_no_worst(design: Design) -> None:
    alone = replace(design.designed, sampled_relative_error=np.empty((0, len(design.coefficients))))
    assert np.isnan(alone.worst_sampled_error) and alone.diverged == 0


def test_manoeuvres_within_the_limits_come_first(design: Design) -> None:
    ranked = ranked_baselines(design)
    within = [is_within_limits(m, design.limits) for m in ranked]
    assert within == sorted(within, reverse=True) and not all(within)
    errors = [m.worst for m, inside in zip(ranked, within, strict=True) if inside]
    assert errors == sorted(errors) and best_baseline(design) is ranked[0]
    assert best_baseline(replace(design, baselines=())) is None


def test_limits_may_bind_every_drawn_ship(design: Design) -> None:
    far = replace(design.designed, sampled_drift=np.array([0.1, 0.9]), sampled_distance=np.array([10.0, 10.0]))
    limits = TrialLimits(drift=0.5, sea_room=1e6)
    assert count_outside_limits(far, limits) == 1
    assert is_within_limits(far, limits) and not is_within_limits(far, replace(limits, for_every_ship=True))


def test_a_manoeuvre_that_stays_in_place_has_no_track(design: Design) -> None:
    assert has_track(design)
    assert not has_track(replace(design, designed=replace(design.designed, distance=0.0)))
