"""How inputs run between samples where no record says: by their steps, and by the delay that these leave."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from seatrial.core.results import Fit
from seatrial.core.values import Record, Ship
from seatrial.core.values.arrays import Array
from seatrial.data.trial import EstimateMethod, EstimateSettings, Run, Trial
from seatrial.estimation.identify import identify
from seatrial.physics.models import nomoto

Orders = Callable[[np.random.Generator], Array]
K, T, DT, PARTS = 0.12, 9.0, 1.0, 100
NOISE = {"psi": math.radians(0.05), "r": math.radians(0.02)}


def fit_of(rudder: Array, rng: np.random.Generator, *, is_held: bool) -> Fit:
    """The fit of a craft of first order, in fine steps, whose rudder is held or straight between samples."""
    time, fine = DT * np.arange(len(rudder)), DT / PARTS
    moments = (np.arange((len(rudder) - 1) * PARTS) + 0.5) * fine
    acting = rudder[(moments / DT).astype(int)] if is_held else np.interp(moments, time, rudder)
    decay, psi, r = math.exp(-fine / T), np.zeros(len(moments) + 1), np.zeros(len(moments) + 1)
    for k, delta in enumerate(acting.tolist()):
        r[k + 1] = K * delta + (r[k] - K * delta) * decay
        psi[k + 1] = psi[k] + 0.5 * fine * (r[k] + r[k + 1])
    values = {"delta": rudder, "psi": psi[::PARTS], "r": r[::PARTS]}
    values |= {s: values[s] + size * rng.normal(size=len(time)) for s, size in NOISE.items()}
    record = Record.from_arrays("run", time, values)
    settings = EstimateSettings(method=EstimateMethod.OUTPUT_ERROR)
    return identify(Trial(Ship("boat", {"L": 8.0}), (Run(record),), nomoto(), settings))


def steps(rng: np.random.Generator) -> Array:
    """A rudder that goes from side to side within one sample."""
    return 0.2 * np.sign(np.sin(2.0 * np.pi * (DT * np.arange(400) + rng.uniform(0.2, 0.4)) / 26.0))


def orders_of_a_helmsman(rng: np.random.Generator) -> Array:
    """Orders that change in every sample: no steps to be seen."""
    order = np.zeros(400)
    for k in range(1, 400):
        order[k] = np.clip(0.9 * order[k - 1] + 0.08 * rng.normal(), -0.4, 0.4)
    return order


@pytest.mark.parametrize(("orders", "is_held"), [(steps, False), (orders_of_a_helmsman, True)])
def test_a_delay_of_half_a_sample_is_the_other_course(orders: Orders, is_held: bool, rng: np.random.Generator) -> None:
    fit = fit_of(orders(rng), rng, is_held=is_held)
    assert (fit.model.held == {"delta"}) == is_held
    found = {c.name: c for c in fit.coefficients}
    assert all(abs(found[n].estimate - v) < 3.0 * (found[n].standard_error or 0.0) for n, v in (("K", K), ("T", T)))
    (delay,) = (o for o in fit.offsets if o.name == "delta delay")
    assert abs(delay.estimate) < 0.05 * DT
    (note,) = (f for f in fit.findings if f.code == "stepped-input")
    assert ("held" if is_held else "straight") in note.message


@pytest.mark.parametrize(("orders", "is_held"), [(steps, True), (orders_of_a_helmsman, False)])
def test_a_course_that_is_judged_rightly_stays(orders: Orders, is_held: bool, rng: np.random.Generator) -> None:
    fit = fit_of(orders(rng), rng, is_held=is_held)
    assert (fit.model.held == {"delta"}) == is_held
    assert not any("the records show" in f.message for f in fit.findings if f.code == "stepped-input")
