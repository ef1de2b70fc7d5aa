"""Runs of several speeds or loadings fitted as one ship are named, and the interval holds what they differ by."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from standard_craft import NOMOTO

from seatrial.core.values import Record
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.fit import Estimation, estimate_model
from seatrial.estimation.estimate.settings import EstimatorOptions
from seatrial.estimation.identify.assumed_values import differing_runs, with_estimated_values
from seatrial.physics.models.roll import roll
from seatrial.problems.disturbed_craft import Disturbance, independent_nomoto

FREE = ("b_1", "b_2", "c_1", "phi_0")


def decay(name: str, b_1: float, heel: float, seed: int, waves: float = 0.0) -> Record:
    """A roll of 1.6 s from a release at rest, b_2 0.5 1/rad, 50 Hz, noise 0.05 degrees.

    waves: rad/s^2 of two accelerations of 1.4 and 1.2 s, of random phases.
    """
    time, noise = np.arange(0.0, 20.0, 0.02), np.random.default_rng(seed)

    phases = np.random.default_rng(100 + seed).uniform(0.0, 2.0 * np.pi, 2)

    def rates(t: float, x: np.ndarray) -> list[float]:
        sea = waves * float(np.sum(np.cos(2.0 * np.pi * t / np.array([1.4, 1.2]) + phases)))
        return [x[1], -15.0 * x[0] - b_1 * x[1] - 0.5 * x[1] * abs(x[1]) + sea]

    phi = solve_ivp(rates, (0.0, time[-1]), [heel, 0.0], t_eval=time, rtol=1e-8, atol=1e-10).y[0]
    return Record.from_arrays(name, time, {"phi": phi + np.radians(0.05) * noise.standard_normal(len(time))})


def fitted(damping: Sequence[float], waves: float = 0.0, seed: int = 0) -> Estimation:
    decays = [decay(f"decay {i}", b, 0.22 - 0.02 * i, seed + i, waves) for i, b in enumerate(damping)]
    model = roll().with_values({"b_1": 0.2, "b_2": 0.5, "c_1": 15.0})
    fixed = model.parameters.fixed(*(n for n in model.parameters.free_names if n not in FREE)).freed(*FREE)
    return estimate_model(
        model.with_parameters(fixed), Runs.one_session_each(decays, 2.6), None, EstimatorOptions(workers=1)
    )


@pytest.mark.parametrize("damping", [(0.1, 0.24, 0.38), (0.1, 0.1, 0.24, 0.24, 0.38)])
def test_decays_of_several_speeds_are_named_and_in_the_interval(damping: tuple[float, ...]) -> None:
    estimation = fitted(damping)
    found = differing_runs(estimation)
    assert found is not None
    assert found.name == "b_1"
    assert "runs do not share one b_1" in found.finding("1/s").text
    free = estimation.estimate.problem.free
    value, column = estimation.model.parameters["b_1"].value, free.index("b_1")
    widened = with_estimated_values(estimation, [found.shift(free)]).interval.half_width[column]
    assert all(abs(value - b) < widened for b in damping)


def test_decays_of_one_ship_are_one() -> None:
    assert differing_runs(fitted((0.2, 0.2, 0.2))) is None


def test_waves_that_nobody_measured_are_no_difference_between_runs() -> None:
    """A decay of 1.6 s follows waves of 1.4 s: a stiffness of its own explains a fifth of what they leave."""
    assert differing_runs(fitted((0.2, 0.2, 0.2, 0.2), waves=0.3, seed=50)) is None


@pytest.mark.parametrize("gains", [(0.1, 0.07), (0.1, 0.1)])
def test_a_boat_that_is_loaded_between_runs_is_named(gains: tuple[float, float]) -> None:
    """Gusts and all: the gain of each run by its innovations."""
    runs = list[Record]()
    for seed, gain in enumerate(gains):
        craft = replace(NOMOTO, model=NOMOTO.model.with_values({"K": gain}))
        stream = np.random.default_rng([2, seed])
        (run,) = independent_nomoto(craft, Disturbance(0.3, 5.0), 1, stream, is_closed=False, seconds=300.0)
        runs.append(run.renamed(f"run {seed}"))
    start = NOMOTO.model.with_values(dict(NOMOTO.guess))
    found = differing_runs(
        estimate_model(start, Runs.one_session_each(runs, NOMOTO.length), None, EstimatorOptions(workers=1))
    )
    assert (found is not None) == (gains[0] != gains[1])
    assert found is None or (found.name == "K" and found.values == pytest.approx(gains, rel=0.2))
