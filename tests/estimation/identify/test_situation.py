"""The decision table of `identify`: one row of situations a test, and a strategy for every situation."""

from collections.abc import Callable

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import Record
from seatrial.data.trial import Role, TrialRecord
from seatrial.estimation.identify.identification import Situation, situation_of
from seatrial.estimation.identify.identify import STRATEGIES
from seatrial.physics.hydro.excitation import BoxHull
from seatrial.physics.models import model_named
from seatrial.physics.sea.spectrum import Spectrum, WaveEncounter, ittc

TIME = np.arange(50.0)
MOVING, STILL = np.sin(TIME), np.zeros(50)
BOX = BoxHull(6.0, 0.6, 0.3, 3.5e4, 0.0, 0.0, 1.1e5)


def run(channels: dict[str, np.ndarray], spectrum: Spectrum | None = None, *, has_waves: bool = False) -> TrialRecord:
    waves = WaveEncounter(BOX, 1.0, np.pi, spectrum) if has_waves else None
    return TrialRecord(Record.from_arrays("run", TIME, channels), Role.TRAIN, "run", waves)


def never() -> bool:
    raise AssertionError("only roll without inputs needs an estimate to be recognised")


def situation(
    model: str | Model,
    item: TrialRecord,
    *,
    has_force_points: bool = False,
    is_criterion_free: bool = True,
    is_explained: Callable[[], bool] = never,
) -> Situation:
    return situation_of(
        model_named(model) if isinstance(model, str) else model,
        [item],
        has_force_points=has_force_points,
        is_criterion_free=is_criterion_free,
        is_explained=is_explained,
    )


def test_a_rudder_makes_a_steered_ship() -> None:
    zigzag = run({"delta": MOVING, "u": 1.0 + STILL, "r": MOVING, "psi": MOVING})
    assert situation("nomoto", zigzag) is Situation.STEERED
    assert situation("mmg", zigzag) is Situation.STEERED


def test_force_points_beside_manoeuvres_are_a_situation_of_their_own() -> None:
    zigzag = run({"delta": MOVING, "u": 1.0 + STILL})
    assert situation("mmg", zigzag, has_force_points=True) is Situation.STATIC_FORCES


@pytest.mark.parametrize("has_waves", [True, False])
def test_forces_or_an_elevation_in_the_record_are_recorded_waves(has_waves: bool) -> None:
    seaway = run({"z": MOVING, "theta": MOVING, "F3": MOVING, "M5": MOVING}, has_waves=has_waves)
    assert situation("heave_pitch", seaway) is Situation.RECORDED_WAVES


def test_a_sea_known_by_its_spectrum_comes_before_everything_else() -> None:
    seaway = run({"z": MOVING, "theta": MOVING}, ittc(1.0), has_waves=True)
    assert situation("heave_pitch", seaway) is Situation.WAVE_SPECTRUM
    assert situation("heave_pitch", seaway, is_criterion_free=False) is Situation.WAVE_SPECTRUM


@pytest.mark.parametrize("name", ["alpha_w", "alpha_f"])
def test_roll_by_a_recorded_input_is_driven(name: str) -> None:
    assert situation("roll", run({"phi": MOVING, name: MOVING})) is Situation.DRIVEN_ROLL


def test_roll_that_initial_states_explain_is_a_free_decay() -> None:
    decay = run({"phi": MOVING, "alpha_w": STILL})
    assert situation("roll", decay, is_explained=lambda: True) is Situation.FREE_DECAY
    assert situation("roll", decay, is_explained=lambda: True, is_criterion_free=False) is Situation.FREE_DECAY


def test_roll_that_nothing_explains_is_in_unknown_waves_unless_a_criterion_is_set() -> None:
    seaway = run({"phi": MOVING})
    assert situation("roll", seaway, is_explained=lambda: False) is Situation.UNKNOWN_WAVES
    driven = situation("roll", seaway, is_explained=lambda: False, is_criterion_free=False)
    assert driven is Situation.DRIVEN_ROLL


def test_a_held_angle_and_its_release_are_a_decay_and_no_waves_even_if_unexplained() -> None:
    held = np.where(TIME < 15.0, 1.0, np.exp(-0.1 * (TIME - 15.0)) * np.cos(TIME - 15.0))
    assert situation("roll", run({"phi": held}), is_explained=lambda: False) is Situation.FREE_DECAY


def test_every_situation_has_its_strategy() -> None:
    assert set(STRATEGIES) == set(Situation)
    assert len(set(STRATEGIES.values())) == len(Situation)
