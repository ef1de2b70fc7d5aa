"""Has the ship changed? False alarms and power, on streams of known truth."""

import numpy as np
import pytest
from scipy.stats import chi2, kstest
from tests.estimation.estimate.online.streams import DT, NAMES, NOISE, SeaStream

from seatrial.core.equations import Model
from seatrial.core.results.online import CoefficientChange
from seatrial.core.values import InputError
from seatrial.estimation.estimate.online.carried_information import (
    ChangeDetector,
    GaussianEstimate,
    independent_change,
    nested_change,
)
from seatrial.physics.simulate.linear import LinearBatch

Array = np.ndarray
FIRST, STRETCH = 601, 30.0


def regressed(
    rng: np.random.Generator, shift: Array | None = None
) -> tuple[GaussianEstimate, GaussianEstimate, GaussianEstimate]:
    """Least squares from 60 rows, from 30 others, and from all: three coefficients, the others' moved by `shift`."""
    x, at = rng.standard_normal((90, 3)), np.array([1.0, -2.0, 0.5])
    y = x @ at + rng.standard_normal(90)
    if shift is not None:
        y[60:] += x[60:] @ shift

    def change(rows: slice) -> GaussianEstimate:
        covariance = np.linalg.inv(x[rows].T @ x[rows])
        return GaussianEstimate(covariance @ x[rows].T @ y[rows], covariance)

    return change(slice(60)), change(slice(60, 90)), change(slice(90))


def test_nested_estimates_say_what_independent_ones_do(rng: np.random.Generator) -> None:
    before, latest, after = regressed(rng, np.array([0.5, 0.0, 0.0]))
    apart, within = independent_change(before, latest), nested_change(before, after)
    assert within.statistic == pytest.approx(apart.statistic, rel=1e-9)
    assert within.p == pytest.approx(chi2.sf(apart.statistic, 3), rel=1e-9)
    assert within.degrees_of_freedom == 3


def test_without_change_p_is_uniform() -> None:
    rng = np.random.default_rng(11)
    p = [nested_change(made[0], made[2]).p for made in (regressed(rng) for _ in range(400))]
    assert kstest(p, "uniform").pvalue > 0.01


def test_the_coefficient_that_moved_is_named(rng: np.random.Generator) -> None:
    before, _, after = regressed(rng, np.array([0.0, 3.0, 0.0]))
    moved = nested_change(before, after)
    assert moved.most_changed == 1
    assert moved.p < 1e-6


def test_data_that_say_nothing_tell_no_change() -> None:
    same = GaussianEstimate(np.ones(2), np.diag([0.1, 0.2]))
    moved = nested_change(same, same)
    assert (moved.statistic, moved.degrees_of_freedom, moved.p) == (0.0, 0, 1.0)


def test_looks_share_the_false_alarms() -> None:
    watch = ChangeDetector(("a",), interval=10.0, alpha=0.06)
    one = np.eye(1)
    assert watch.update(0.0, np.zeros(1), one) is None
    assert watch.update(9.9, np.full(1, 5.0), 0.5 * one) is None
    first = watch.update(10.0, np.full(1, 2.1 * np.sqrt(0.5)), 0.5 * one)
    assert first is not None and first.since == 0.0 and first.statistic == pytest.approx(2.1**2)
    assert not first.is_significant  # p 0.036, more than a half of alpha
    second = watch.update(20.0, np.full(1, 9.0), 0.25 * one)
    assert second is not None and second.is_significant and watch.detected is second
    watch.reset()
    assert watch.update(30.0, np.zeros(1), one) is second


def looks(stream: SeaStream, measured: Array) -> list[CoefficientChange]:
    """What every look found, a look each 30 s from 60 s on."""
    made, watch = stream.filter(stream.batch_state(measured, FIRST), FIRST), ChangeDetector(NAMES, STRETCH)
    watch.update((FIRST - 1) * DT, made.value, made.covariance)
    found = []
    for row in range(FIRST, len(measured), 300):
        made.update(measured[row : row + 300], stream.clean.inputs[row : row + 300])
        found.append(watch.update((row + 299) * DT, made.value, made.covariance))
    return found


@pytest.fixture(scope="module")
def beam() -> SeaStream:
    return SeaStream.from_heading(90, 240.0, 7)


def test_a_hundred_streams_without_change_raise_few_alarms(beam: SeaStream) -> None:
    """Six looks at each; alpha is 5 % for any number of them."""
    change = [any(c.is_significant for c in looks(beam, beam.measured(100 + k))) for k in range(100)]
    assert np.mean(change) <= 0.05


@pytest.mark.parametrize("seed", range(5))
def test_a_loaded_ship_is_stated_within_a_minute(beam: SeaStream, seed: int) -> None:
    """Mass and inertia grow by 10 % in the middle of a stretch, at 135 s."""
    inputs, at = beam.clean.inputs, 1350
    model = beam.ship
    heavy = model.with_values({n: 1.1 * model.parameters[n].value for n in ("m", "I5")})

    def run(ship: Model, u: Array, x: Array) -> Array:
        batch = LinearBatch(ship, np.ascontiguousarray(u), np.array([0, len(u)]), DT, model.states)
        return batch.simulate(0, 1, x, ship.parameters.values[None], np.empty((1, 0)))[0]

    before = run(model, inputs[: at + 1], np.zeros((1, 4)))
    y = np.concatenate([before[:-1], run(heavy, inputs[at:], before[-1:])])
    measured = y[:, [0, 2]] + NOISE * np.random.default_rng([seed, 3]).standard_normal((len(y), 2))
    change = next(c for c in looks(beam, measured) if c.is_significant)
    assert at * DT < change.since + STRETCH < at * DT + 60.0
    assert change.most_changed in ("a33", "a35", "a55", "a53")


def test_a_watch_that_cannot_be_is_refused() -> None:
    with pytest.raises(InputError, match="stretch"):
        ChangeDetector(("a",), interval=0.0)
