"""The published pipeline: cleaning by the model's own channels, selection, what differencing does with noise.

Half of the record trains: one execute of each angle takes up to 152 s.
"""

from dataclasses import replace

import numpy as np
import pytest
from tests.estimation.regress.linear import zigzags

from seatrial.core.values import InputError
from seatrial.data.example_series.series import with_sensor_noise
from seatrial.estimation.regress.operators import Central, Euler
from seatrial.estimation.regress.pipeline import Cleaning, Pipeline
from seatrial.estimation.regress.solvers import Lasso, OrdinaryLeastSquares
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


def test_what_is_not_selected_is_zero_and_told() -> None:
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
