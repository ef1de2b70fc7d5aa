"""The estimator behind a fit: noise re-estimated, rounding distinguished from noise."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import Prior, Record
from seatrial.estimation.estimate.point_estimate import (
    COLOUR_ROUNDS,
    NEAR_ENOUGH,
    PointEstimate,
    fallen_inflation,
    fit_output_error,
    residual_correlation,
    residual_spread,
    rounding_level,
)
from seatrial.estimation.estimate.start import ConcentratedLikelihood
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.numerics.optimise import Status
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.simulate.steer import manoeuvre


@pytest.fixture(scope="module")
def model() -> Model:
    return nomoto().with_values({"K": 0.15, "T": 8.0})


@pytest.fixture(scope="module")
def clean(model: Model) -> Record:
    return manoeuvre(model, programme("zigzag:20/20"), dt=0.2, speed=1.0, duration=300.0).without("x0", "y0")


def problem_of(model: Model, record: Record) -> OutputError:
    return OutputError(model, cut_segments(model, [record], ("r", "psi"), None), np.array([1e-2, 1e-1]), workers=1)


def noisy(record: Record, rng: np.random.Generator) -> Record:
    for symbol, size in (("r", 2e-3), ("psi", 4e-3)):
        channel = record.channel(symbol)
        record = record.with_channel(
            symbol, channel.with_values(channel.values + size * rng.standard_normal(len(record)))
        )
    return record


def made_from(model: Model, record: Record, known: dict[str, float] | None = None, **changes: float) -> PointEstimate:
    problem = replace(problem_of(model.with_values({"K": 0.1, "T": 10.0}), record), **changes)
    return fit_output_error(problem, problem.start(), problem.measured_initial_states(), known or {})


def test_noise_levels_come_back(model: Model, clean: Record, rng: np.random.Generator) -> None:
    made = made_from(model, noisy(clean, rng))
    np.testing.assert_allclose(made.problem.noise, [2e-3, 4e-3], rtol=0.06)
    np.testing.assert_allclose(made.common_parameters, [0.15, 8.0], rtol=0.01)


def test_a_search_goes_on_until_another_gains_next_to_nothing(
    model: Model, clean: Record, rng: np.random.Generator
) -> None:
    record = noisy(clean, rng)
    problem = problem_of(model.with_values({"K": 0.4, "T": 60.0}), record)
    start, stated = (problem.start(), problem.measured_initial_states()), {"r": 2e-3, "psi": 4e-3}
    best = fit_output_error(problem, *start, stated)
    short = fit_output_error(problem, *start, stated, rounds=1, evaluations=6)
    assert short.optimum.solution.status is Status.CONVERGED
    assert short.optimum.solution.evaluations > 6 + 6  # of the search and that with the noise found by it
    assert short.optimum.solution.value - best.optimum.solution.value <= NEAR_ENOUGH
    stuck = fit_output_error(problem, *start, stated, rounds=1, evaluations=3)  # no step is tried that far off
    assert stuck.optimum.solution.status is Status.EXHAUSTED


def test_known_noise_is_kept(model: Model, clean: Record, rng: np.random.Generator) -> None:
    made = made_from(model, noisy(clean, rng), {"psi": 0.02})
    assert made.problem.noise[1] == 0.02
    assert made.problem.noise[0] == pytest.approx(2e-3, rel=0.06)


def test_a_robust_loss_shrugs_off_jumps(model: Model, clean: Record, rng: np.random.Generator) -> None:
    record = noisy(clean, rng)
    values = record["psi"].copy()
    values[::25] += 1.0
    spoilt = record.with_channel("psi", record.channel("psi").with_values(values))
    plain, robust = made_from(model, spoilt), made_from(model, spoilt, huber=3.0)
    assert robust.problem.noise[1] < 0.1 * plain.problem.noise[1]
    np.testing.assert_allclose(robust.common_parameters, [0.15, 8.0], rtol=0.01)


def test_rounding_is_no_noise_and_has_no_colour(model: Model, clean: Record) -> None:
    made = made_from(model, clean)
    np.testing.assert_allclose(made.common_parameters, [0.15, 8.0], rtol=1e-10)
    np.testing.assert_array_equal(made.problem.noise, rounding_level(made.problem))
    np.testing.assert_array_equal(residual_correlation(made.problem, made.residuals())[1], 1.0)
    assert made.optimum.solution.evaluations < 20


def test_unknowns_count_against_the_samples(model: Model, clean: Record, rng: np.random.Generator) -> None:
    problem = problem_of(model, clean)
    residuals = 1e-3 * rng.standard_normal((len(clean), 2))
    unknowns, count = problem.size + len(problem.starts), residuals.size
    expected = np.sqrt(np.mean(residuals**2, axis=0) / (1 - unknowns / count))
    np.testing.assert_allclose(residual_spread(problem, residuals), expected)


def test_coloured_residuals_are_seen(model: Model, clean: Record, rng: np.random.Generator) -> None:
    shaky = clean.channel("psi").with_values(clean["psi"] + np.convolve(
        1e-2 * rng.standard_normal(len(clean) + 19), np.ones(20) / 20, "valid"))  # fmt: skip
    made = made_from(model, clean.with_channel("psi", shaky))
    inflation = residual_correlation(made.problem, made.residuals())[1]
    assert inflation[1] > 5.0


def cubic_ship(seed: int) -> Record:
    """A first-order ship with a cubic term and a slow moment that no model has: own equations, Euler steps of 10 ms."""
    rng, step, every, count = np.random.default_rng(seed), 0.01, 20, 1000
    time = step * every * np.arange(count)
    delta = 0.35 * np.sign(np.sin(2.0 * np.pi * time / 60.0))
    r, psi, rates, headings = 0.0, 0.0, [], []
    for k, angle in enumerate(delta):
        rates.append(r)
        headings.append(psi)
        for j in range(every):
            at = time[k] + step * j
            moment = 1e-3 * np.sin(0.21 * at) * np.sin(0.013 * at + seed)
            r += step * ((0.15 * angle - r - 20.0 * r**3) / 8.0 + moment)
            psi += step * r
    read = {"r": np.array(rates) + 2e-4 * rng.standard_normal(count)}
    read["psi"] = np.array(headings) + 1e-3 * rng.standard_normal(count)
    return Record.from_arrays("run", time, {"delta": delta, **read})


def narrowly_known(*further: str) -> Model:
    """Return Nomoto's ship with priors far from that ship; further: coefficients freed about 0."""
    known = {"K": Prior(0.1, 0.02, "test"), "T": Prior(10.0, 2.0, "test"), "alpha": Prior(0.0, 50.0, "test")}
    parameters = nomoto().with_values({"K": 0.1, "T": 10.0}).parameters.freed(*further)
    return nomoto().with_parameters(parameters.with_priors({n: known[n] for n in ("K", "T", *further)}))


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_model_that_contains_another_never_fits_worse_by_the_objective_held(seed: int) -> None:
    record = cubic_ship(seed)
    small, large = (
        OutputError(m, cut_segments(m, [record], ("r", "psi"), 30.0), np.array([1e-2, 1e-1]), workers=1)
        for m in (narrowly_known(), narrowly_known("alpha"))
    )
    inner = fit_output_error(small, small.start(), small.measured_initial_states(), {})
    assert inner.problem.inflation is not None
    held = replace(large, noise=inner.problem.noise, inflation=inner.problem.inflation)
    contained = np.append(inner.common_parameters, 0.0)
    outer = fit_output_error(held, contained, inner.optimum.local, {}, colour_rounds=0)
    np.testing.assert_array_equal(outer.problem.inflation, inner.problem.inflation)
    objective = ConcentratedLikelihood(held, {})
    gain = objective.cost(contained, inner.optimum.local) - objective.cost(outer.common_parameters, outer.optimum.local)
    assert inner.is_settled
    assert outer.is_settled
    assert gain > 0.0


def test_effective_numbers_are_held_after_the_first_rounds() -> None:
    problem = OutputError(
        narrowly_known(), cut_segments(narrowly_known(), [cubic_ship(0)], ("r", "psi"), 30.0), np.array([1e-2, 1e-1]),
        workers=1,
    )  # fmt: skip
    start = problem.start(), problem.measured_initial_states()
    begun = fit_output_error(problem, *start, {}, rounds=COLOUR_ROUNDS)
    settled = fit_output_error(problem, *start, {})
    assert begun.problem.inflation is not None
    np.testing.assert_array_equal(settled.problem.inflation, begun.problem.inflation)


@pytest.mark.parametrize(
    ("held", "current", "expected"),
    [
        ([20.0, 3.0], [1.4, 2.0], [1.4, 3.0]),
        ([20.0, 3.0], [50.0, 6.0], [20.0, 3.0]),
        ([20.0, 3.0], None, None),
        (None, [4.0, 1.0], None),
    ],
)
def test_effective_numbers_only_rise_and_only_where_residuals_whiten_much(
    held: list[float] | None, current: list[float] | None, expected: list[float] | None
) -> None:
    made = fallen_inflation(*(None if x is None else np.array(x) for x in (held, current)))
    assert (made is None) == (expected is None)
    np.testing.assert_array_equal([] if made is None else made, expected or [])
