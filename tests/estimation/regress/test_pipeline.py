"""The published pipeline: cleaning by the model's own channels, selection, what differencing does with noise.

Half of the record trains: one execute of each angle takes up to 152 s.
"""

from dataclasses import replace

import numpy as np
import pytest
from tests.estimation.regress.linear import zigzags

from seatrial.core.values import InputError
from seatrial.data.example_series import with_sensor_noise
from seatrial.data.trial.settings import CompareSettings, SupportVectorSettings
from seatrial.estimation.regress.estimators import Lasso, OrdinaryLeastSquares, SupportVectors
from seatrial.estimation.regress.operators import Central, Euler
from seatrial.estimation.regress.pipeline import NO_CLEANING, Cleaning, Pipeline, ablations, pipelines, row_score
from seatrial.physics.models.waterjet import TABLE_2, waterjet

TRUE = np.array(list(TABLE_2.values()))
HALF = Pipeline(training_share=0.5)
BLANK = waterjet().with_values(dict.fromkeys(TABLE_2, 0.0))


def median_error(pipeline: Pipeline, seed: int | None = None) -> float:
    """Over the eleven coefficients."""
    record = zigzags() if seed is None else with_sensor_noise(zigzags(), np.random.default_rng(seed), seed)
    return float(np.median(np.abs(pipeline.estimate(BLANK, [record]).values / TRUE - 1.0)))


def test_differencing_helps_without_noise_and_is_fatal_with_it() -> None:
    """The paper's improvement, and what its paper did not try: sensors."""
    original, improved = replace(HALF, operator=Euler()), HALF
    assert median_error(improved) < 0.5 * median_error(original)
    assert median_error(improved, seed=3) > 10.0


def test_the_constant_is_near_zero_where_the_regression_is_good() -> None:
    """Song et al. 2025, eq. (26): the weights count only then."""
    found = HALF.estimate(BLANK, [zigzags()])
    assert set(found.bias) == {"u", "v", "r"}
    assert max(map(abs, found.bias.values())) < 1e-5


def test_what_is_not_selected_is_zero_and_stated() -> None:
    """A large penalty leaves little."""
    pipeline = replace(HALF, selection=Lasso((2000.0,)), operator=Central(), solver=OrdinaryLeastSquares())
    found = pipeline.estimate(BLANK, [zigzags()])
    dropped = [n for n, value in zip(TABLE_2, found.values, strict=True) if value == 0.0]
    assert dropped
    assert all(any(n in f.text for f in found.findings) for n in dropped)


def test_cleaning_looks_at_the_velocities() -> None:
    """A spike goes; so do samples near zero; a hole in the heading goes too."""
    clean = zigzags()
    v = clean["v"].copy()
    v[1200] = 5.0
    psi = clean["psi"].copy()
    psi[1300] = np.nan
    spoiled = clean.with_channel("v", clean.channel("v").with_values(v))
    spoiled = spoiled.with_channel("psi", clean.channel("psi").with_values(psi))
    kept = Cleaning().clean(waterjet(), spoiled)
    assert clean.time[1200] not in kept.time
    assert clean.time[1300] not in kept.time
    assert len(kept) > 0.7 * len(clean)
    assert np.abs(kept["v"]).min() > 0.0


def test_a_block_shorter_than_a_manoeuvre_is_refused() -> None:
    """Two hundredths of 415 s hold no execute."""
    with pytest.raises(InputError, match="shorter than the longest manoeuvre"):
        replace(Pipeline(), training_share=0.98).estimate(BLANK, [zigzags()])


def test_one_chain_from_thirteen_terms_to_the_selected_ones() -> None:
    """What Lasso keeps beyond the model's own terms is estimated, said and simulated."""
    record = zigzags()
    free = replace(HALF, selection=Lasso((1e-6,)), operator=Central(), solver=OrdinaryLeastSquares())
    found = free.estimate(BLANK, [record])
    assert set(found.candidates) == {"N_vrr", "N_vvr"}
    assert max(map(abs, found.candidates.values())) < 0.01
    assert any(f.code == "candidate-kept" and "N_vrr" in f.text for f in found.findings)
    ship = found.in_model(BLANK)
    assert ship.parameters["N_vrr"].value == found.candidates["N_vrr"]


def test_the_rows_kept_for_testing_are_predicted_and_scored() -> None:
    found = replace(HALF, operator=Central(), solver=OrdinaryLeastSquares()).estimate(BLANK, [zigzags()])
    assert set(found.test) == {"u", "v", "r"}
    for score in found.test.values():
        assert score.correlation > 0.999 and score.explained > 0.999 and score.rows > 1000


def test_a_score_is_that_of_its_definition() -> None:
    target, predicted = np.array([1.0, 2.0, 3.0, 6.0]), np.array([1.0, 2.0, 4.0, 5.0])
    score = row_score(target, predicted)
    assert score.rmse == pytest.approx(np.sqrt(0.5))
    assert score.correlation == pytest.approx(np.corrcoef(target, predicted)[0, 1])
    assert score.explained == pytest.approx(1.0 - 2.0 / np.sum((target - 3.0) ** 2))
    assert np.isnan(row_score(target, np.ones(4)).correlation)


def test_a_search_that_does_not_converge_ends_at_its_limit_with_a_finding() -> None:
    improved = pipelines(SupportVectorSettings(test_share=0.5))[1]
    found = replace(improved, solver=SupportVectors(1000.0, 1e-4, max_iterations=50)).estimate(BLANK, [zigzags()])
    assert sum(f.code == "not-converged" and "50 iterations" in f.text for f in found.findings) == 3


def test_settings_of_a_trial_make_the_pipelines() -> None:
    settings = SupportVectorSettings(outlier_score=0.0, small_share=0.0, folds=5, ablation=True, test_share=0.25)
    published, improved, *without = pipelines(settings)
    assert improved.selection == Lasso(tuple(np.geomspace(1e-6, 1e6, 49).tolist()), folds=5)
    assert improved.training_share == 0.75 and improved.cleaning.max_score == 0.0
    assert isinstance(published.operator, Euler)
    assert without == list(ablations(improved))
    assert without[0].cleaning == NO_CLEANING and without[1].selection is None
    assert CompareSettings().svr == SupportVectorSettings()


@pytest.mark.parametrize(
    ("setting", "says"),
    [
        ({"C": 0.0}, "C"),
        ({"epsilon": -1.0}, "epsilon"),
        ({"test_share": 1.0}, "test_share"),
        ({"folds": 1}, "folds"),
        ({"lambda": (1.0, 0.1)}, "give the smaller first"),
    ],
)
def test_settings_that_cannot_be_are_one_sentence(setting: dict[str, float], says: str) -> None:
    with pytest.raises(InputError, match=says) as refused:
        SupportVectorSettings(**setting)
    assert "\n" not in str(refused.value)


def test_nothing_is_cleaned_where_every_threshold_is_zero() -> None:
    assert len(NO_CLEANING.clean(waterjet(), zigzags())) == len(zigzags())
