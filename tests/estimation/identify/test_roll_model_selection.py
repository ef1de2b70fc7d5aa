"""Roll models compared by runs they were not fitted to."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import InputError, Record
from seatrial.data.trial import EstimateSettings, ModelFamily
from seatrial.estimation.estimate import EstimatorOptions, Runs, estimate_model
from seatrial.estimation.identify.model_selection import SelectedModel, roll_structures, select_roll_model
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.roll import roll
from seatrial.physics.simulate.replay import trajectory

TRUE = {"b_1": 0.03, "b_2": 0.25, "c_1": 6.0, "c_3": 5.0, "phi_0": 0.002}
DT, ROWS, NOISE = 0.05, 900, np.radians(0.02)


def decay(name: str, start: float, seed: int) -> Record:
    """Quadratic damping, cubic restoring, from `start` [rad]."""
    states, _ = trajectory(roll().with_values(TRUE), np.zeros((ROWS, 2)), DT, np.array([start, 0.0]))
    noise = NOISE * np.random.default_rng(seed).standard_normal(ROWS)
    return Record.from_arrays(name, DT * np.arange(0.0, ROWS), {"phi": states[:, 0] + noise})


LARGE, SMALL = decay("large", 0.3, 1), decay("small", 0.2, 2)


def choice(train: list[Record], model: Model | None = None) -> SelectedModel:
    """Of the house's family."""
    own, runs, options = model or roll(), Runs.one_session_each(train, 5.0), EstimatorOptions(workers=1)
    found = estimate_model(own, runs, options=options)
    return select_roll_model(found, own, runs, 5.0, EstimateSettings(), options, None)


def test_a_single_decay_is_chosen_by_its_halves() -> None:
    """Fitted to the larger swings, the true structure predicts the smaller to 1.2 of the noise, poorer ones do not."""
    selected = choice([LARGE])
    (used,) = [row for row in selected.candidates if row.is_chosen]
    assert used.name == "quadratic damping, cubic restoring"
    assert used.roll_deg is not None and used.roll_deg <= 1.2 * np.degrees(NOISE)
    assert selected.estimation.model.parameters.free_names == ("b_1", "b_2", "c_1", "c_3", "phi_0")
    errors = {row.name: row.roll_deg or np.inf for row in selected.candidates}
    assert errors["linear damping, linear restoring"] > 5.0 * errors[used.name]
    assert selected.findings == ()


def test_two_training_runs_judge_one_another() -> None:
    selected = choice([LARGE, SMALL])
    assert selected.findings == ()
    (used,) = [row for row in selected.candidates if row.is_chosen]
    assert used.name == "quadratic damping, cubic restoring"


def test_damping_that_decreases_with_amplitude_is_listed_and_not_taken() -> None:
    """A decay with b_2 < 0, as a sensor's lag or a slack mooring may show it: constant damping is taken."""
    odd = {**TRUE, "b_1": 0.08, "b_2": -0.1, "c_3": 0.0}
    states, _ = trajectory(roll().with_values(odd), np.zeros((ROWS, 2)), DT, np.array([0.3, 0.0]))
    noise = NOISE * np.random.default_rng(4).standard_normal(ROWS)
    selected = choice([Record.from_arrays("odd", DT * np.arange(0.0, ROWS), {"phi": states[:, 0] + noise})])
    notes = {row.name: row.note for row in selected.candidates}
    assert notes["quadratic damping, linear restoring"] == "its damping decreases with amplitude"
    (used,) = [row for row in selected.candidates if row.is_chosen]
    assert used.name.startswith("linear damping") and not used.note


def test_what_cannot_be_judged_is_refused() -> None:
    """A run that no decay explains, whichever of two structures."""
    rng = np.random.default_rng(5)
    waves = replace(SMALL, channels={"phi": SMALL.channel("phi").with_values(0.1 * rng.standard_normal(ROWS))})
    with pytest.raises(InputError, match="no model predicts the runs left out"):
        choice([LARGE, waves.rows(slice(300))], roll().with_parameters(roll().parameters.fixed("b_3", "c_3", "c_5")))


def test_a_family_is_the_packages_or_the_trials_own() -> None:
    """Nine of the house; a declared one frees further coefficients; one member is no family."""
    assert len(roll_structures(roll(), None)) == 9
    quadratic = roll().with_parameters(roll().parameters.fixed("b_3", "c_3", "c_5"))
    assert list(roll_structures(quadratic, None)) == ["as in the trial", "linear damping, linear restoring"]
    own = roll_structures(quadratic, ModelFamily({"cubic": ("b_3",)}))
    assert own["cubic"].parameters.free_names == ("b_1", "b_2", "b_3", "c_1", "phi_0")
    with pytest.raises(InputError, match="no family to choose from"):
        roll_structures(nomoto(), None)
