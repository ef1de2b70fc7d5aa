"""Other estimators beside a fit: like for like, none stops the others, and what correlations cannot see."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.estimation.identify.conftest import WriteTrial

from seatrial.core.equations import Model
from seatrial.core.results import Baseline, Fit, Offset
from seatrial.core.results.prediction import NO_COMPARISON
from seatrial.core.values import InputError, Record
from seatrial.data.trial import EstimateMethod, load_trial
from seatrial.data.trial.settings import SupportVectorSettings
from seatrial.estimation.identify import identify
from seatrial.estimation.identify.baselines import (
    compare_estimators,
    correlation,
    pooled_errors,
    simulation_errors,
    with_baselines,
)
from seatrial.estimation.regress.estimators import LinearRegression, OrdinaryLeastSquares, RegressionEstimate
from seatrial.estimation.regress.operators import Weak
from seatrial.estimation.regress.pipeline import standard_estimators
from seatrial.physics.simulate.replay import replay


@dataclass(frozen=True)
class Fixed:
    """An estimator that has its mind made up: every coefficient times a factor."""

    factor: float
    name: str = "fixed"

    def estimate(self, model: Model, records: Sequence[Record]) -> RegressionEstimate:
        assert records
        return RegressionEstimate(self.factor * np.array([p.value for p in model.parameters.free]))


@dataclass(frozen=True)
class Failing:
    """An estimator that raises."""

    error: Exception
    name: str = "failing"

    def estimate(self, model: Model, records: Sequence[Record]) -> RegressionEstimate:
        assert model.parameters.free and records
        raise self.error


@pytest.fixture(scope="module")
def fit(repository: Path) -> Fit:
    """The waterjet craft of the examples, compared; of known timing: no offsets to set to zero."""
    trial = load_trial(repository / "examples" / "waterjet.toml")
    return identify(
        replace(trial, estimate=replace(trial.estimate, delays={"delta": 0.0}, method=EstimateMethod.OUTPUT_ERROR)),
        compare=True,
    )


@pytest.fixture(scope="module")
def train(fit: Fit) -> list[Record]:
    return [p.measured for p in fit.predictions if p.role == "training"]


def named(fit: Fit, name: str) -> Baseline:
    return next(r for r in fit.baselines if r.name == name)


def median(rival: Baseline) -> float:
    return float(np.median(np.abs(list(rival.error.values()))))


def test_the_fit_stands_first_with_its_own_numbers(fit: Fit) -> None:
    first = fit.baselines[0]
    assert first.is_fit and first.name == f"this fit: {fit.method.criterion}"
    assert first.values == {c.name: c.estimate for c in fit.coefficients if not c.fixed}
    assert set(first.normalised_difference.values()) == {0.0}
    rms = [p.rms["psi_deg"] for p in fit.validation]
    assert first.validation.rms["psi_deg"] == pytest.approx(np.sqrt(np.mean(np.square(rms))))
    assert [r.name for r in fit.baselines[1:]] == [
        e.name for e in standard_estimators(10.0, SupportVectorSettings(ablation=True))
    ]


def test_gaps_and_errors_are_what_they_say(fit: Fit) -> None:
    rival = named(fit, "weak form, least squares")
    for c in (c for c in fit.coefficients if not c.fixed):
        assert c.standard_error and c.truth
        assert rival.normalised_difference[c.name] * c.standard_error == pytest.approx(
            rival.values[c.name] - c.estimate
        )
        assert rival.error[c.name] * c.truth == pytest.approx(rival.values[c.name] - c.truth)


def test_noise_spoils_differences_and_spares_the_weak_form(fit: Fit) -> None:
    own, weak, euler = median(fit.baselines[0]), "weak form, least squares", "Euler differences, least squares"
    assert own < 0.05 < median(named(fit, weak)) < 0.5 < 2.0 < median(named(fit, euler))


def test_good_correlations_stand_beside_wrong_coefficients(fit: Fit) -> None:
    """More than 0.92 for u, v and r on runs that were held out, and coefficients wrong by nine tenths."""
    rival = named(fit, "central differences, truncated SVD")
    assert min(rival.validation.correlation.values()) > 0.92
    assert median(rival) > 0.8


def test_without_noise_the_weak_form_gives_the_truth_back_and_sails_like_it(fit: Fit, train: list[Record]) -> None:
    truth = fit.model.with_values({c.name: c.truth for c in fit.coefficients if c.truth})
    clean = [replay(truth, record) for record in train]
    (_, rival) = compare_estimators(fit, clean, [LinearRegression("weak", Weak(5.0), OrdinaryLeastSquares())])
    assert max(map(abs, rival.error.values())) < 0.02
    assert rival.validation.rms["psi_deg"] < 1.0


def test_the_fit_s_own_coefficients_sail_as_the_fit_does(fit: Fit, train: list[Record]) -> None:
    first, same = compare_estimators(fit, train, [Fixed(1.0)])
    assert same.values == first.values
    assert same.training.rms == pytest.approx(first.training.rms, rel=1e-6)
    assert same.validation.correlation == pytest.approx(first.validation.correlation, rel=1e-6)


def test_one_that_fails_or_diverges_stops_none_of_the_others(fit: Fit, train: list[Record]) -> None:
    singular, refused = np.linalg.LinAlgError("singular"), InputError("run a: features are collinear")
    rivals = compare_estimators(
        fit, train, [Failing(refused), Failing(singular), Fixed(-300.0), Fixed(np.nan), Fixed(1.0)]
    )
    assert [r.note for r in rivals] == [
        "", "run a: features are collinear", "its equations are singular in these records", "",
        "its coefficients are no finite numbers", "",
    ]  # fmt: skip
    assert rivals[3].training.diverged == (train[0].name,)
    assert rivals[3].validation.rms == {} and rivals[3].validation.correlation == {}
    assert not rivals[1].values and not rivals[4].values and rivals[5].validation.rms


def test_other_mistakes_are_not_hidden(fit: Fit, train: list[Record]) -> None:
    with pytest.raises(ZeroDivisionError):
        compare_estimators(fit, train, [Failing(ZeroDivisionError())])


def test_offsets_are_taken_away_for_a_second_row(fit: Fit, train: list[Record]) -> None:
    """Regressions have no offsets, so that the fit stands there without them as well."""
    rows = compare_estimators(replace(fit, offsets=(Offset("delta zero", "a", "rad", 0.02, 0.001),)), train, [])
    assert [r.is_fit for r in rows] == [True, True]
    held = [p for p in fit.predictions if p.role == "validation"]
    assert rows[1].validation == simulation_errors(fit.model, held)


@given(gain=st.floats(0.1, 10.0), shift=st.floats(-1.0, 1.0), seed=st.integers(0, 99))
def test_correlation_sees_neither_gain_nor_offset(gain: float, shift: float, seed: int) -> None:
    """A ship that turns ten times too fast has a correlation of 1."""
    rate = np.random.default_rng(seed).standard_normal(50)
    time = np.arange(50.0)
    one, two = (Record.from_arrays("a", time, {"r": r}) for r in (rate, gain * rate + shift))
    assert correlation(one, two)["r"] == pytest.approx(1.0)


def test_constant_channels_and_gaps_have_no_say() -> None:
    time, r = np.arange(6.0), np.array([0.0, 1.0, np.nan, -1.0, 2.0, 0.5])
    measured = Record.from_arrays("a", time, {"u": np.ones(6), "r": r})
    simulated = Record.from_arrays("a", time, {"u": np.arange(6.0), "r": np.where(np.isfinite(r), -r, 9.0)})
    assert correlation(measured, simulated) == {"r": pytest.approx(-1.0)}
    assert pooled_errors([]).rms == {}


def test_a_model_that_is_not_linear_says_so_in_one_sentence(trial_of: WriteTrial) -> None:
    fit = identify(load_trial(trial_of({"a": 0.0, "v_1": 0.0})), compare=True)
    said, *_ = [f for f in fit.findings if f.code == NO_COMPARISON]
    assert fit.baselines == ()
    assert said.text.startswith("no other estimators to compare: model 'nomoto' is not linear in K, T")
    assert with_baselines(fit, [fit.records[0]], 5.0).baselines == ()


def test_nothing_is_compared_unasked(trial_of: WriteTrial) -> None:
    fit = identify(load_trial(trial_of({"a": 0.0})))
    assert fit.baselines == () and NO_COMPARISON not in {f.code for f in fit.findings}
