"""The output-error cost, its gradient and its Gauss-Newton model, against central differences."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from seatrial.core.equations import Model
from seatrial.core.values import Prior, Record
from seatrial.estimation.problem import output_error
from seatrial.estimation.problem.output_error import Nuisance, OutputError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate import replay
from seatrial.physics.simulate.batch import InputCorrection, SegmentBatch

Array = NDArray[np.float64]
OUTPUTS = ("u", "v", "r", "psi", "x0", "y0")
NOISE = np.array([0.02, 0.02, 2e-3, 4e-3, 0.5, 0.5])
NUISANCES = (
    Nuisance(InputCorrection("delta", "zero"), Prior(0.0, 0.03), "rad"),
    Nuisance(InputCorrection("v_j", "gain"), Prior(1.0, 0.1), "1"),
    Nuisance(InputCorrection("delta", "delay"), Prior(0.0, 0.5), "s"),
)
CURRENT = (("current_north", Prior(0.0, 0.1)), ("current_east", Prior(0.0, 0.1)))


def planned(name: str, seed: int, rows: int = 160) -> Record:
    rng, time = np.random.default_rng(seed), 0.25 * np.arange(rows)
    corners = np.interp(time, np.arange(0.0, time[-1] + 4.0, 4.0), rng.uniform(-0.5, 0.5, int(time[-1] / 4) + 2))
    thrust = 1.866 + 0.2 * np.sin(0.2 * time)
    return Record.from_arrays(name, time, {"delta": corners, "v_j": thrust})


@pytest.fixture(scope="module")
def model() -> Model:
    model = waterjet()
    return model.with_parameters(model.parameters.only_free(("X_uu", "Y_v", "N_r", "N_v")))


@pytest.fixture(scope="module")
def records(model: Model) -> tuple[Record, ...]:
    rng, made = np.random.default_rng(4), []
    for seed, name in enumerate(("a", "b", "c")):
        record = replay(model, planned(name, seed), {"u": 0.9, "v": 0.0, "r": 0.0})
        for symbol, size in zip(OUTPUTS, NOISE, strict=True):
            channel = record.channel(symbol)
            record = record.with_channel(
                symbol, channel.with_values(channel.values + size * rng.standard_normal(len(record)))
            )
        made.append(record)
    return tuple(made)


@pytest.fixture(scope="module")
def problem(model: Model, records: tuple[Record, ...]) -> OutputError:
    """Three runs of two days in segments of 10 s, nuisances of all kinds, priors, gaps."""
    sparse = records[1]["psi"].copy()
    sparse[10:40] = np.nan
    gappy = records[1].with_channel("psi", replace(records[1].channel("psi"), values=sparse))
    data = cut_segments(model, [records[0], gappy, records[2].without("u")], OUTPUTS, 10.0, ["x", "y", "x"])
    the_with_prior = model.with_parameters(model.parameters.with_priors({"Y_v": Prior(-0.3, 0.05)}))
    return OutputError(the_with_prior, data, NOISE, NUISANCES, CURRENT, workers=1)


def point(problem: OutputError) -> tuple[Array, Array]:
    rng = np.random.default_rng(8)
    shared = problem.start()
    shared[: len(problem.free)] *= 1 + 0.1 * rng.standard_normal(len(problem.free))
    own = shared[len(problem.free) :].reshape(-1, problem.unknowns_per_session)
    own += np.array([0.03, -0.02, 0.02, 0.05, 0.31])
    return shared, problem.measured_initial_states() + 0.01


def differences(problem: OutputError, shared: Array, local: Array) -> tuple[Array, Array]:
    steps = 1e-6 * np.maximum(np.abs(shared), 0.1)
    outer = [
        (problem.cost(shared + h, local) - problem.cost(shared - h, local)) / (2 * np.max(h)) for h in np.diag(steps)
    ]
    inner = np.zeros_like(local)
    for index in np.ndindex(local.shape):
        h = np.zeros_like(local)
        h[index] = 1e-7
        inner[index] = (problem.cost(shared, local + h) - problem.cost(shared, local - h)) / 2e-7
    return np.array(outer), inner


@pytest.mark.parametrize("inflation", [None, np.array([1.0, 2.0, 30.0, 4.0, 1.0, 9.0])])
@pytest.mark.parametrize("huber", [np.inf, 1.5])
def test_gradient_with_all_nuisances(problem: OutputError, huber: float, inflation: Array | None) -> None:
    problem = replace(problem, huber=huber, inflation=inflation)
    shared, local = point(problem)
    normal = problem.normal(shared, local)
    assert normal.cost == pytest.approx(problem.cost(shared, local), rel=1e-12)
    outer, inner = differences(problem, shared, local)
    np.testing.assert_allclose(normal.gradient, outer, rtol=2e-5, atol=1e-5 * np.max(np.abs(outer)))
    np.testing.assert_allclose(normal.local_gradient, inner, rtol=2e-5, atol=1e-5 * np.max(np.abs(inner)))


def test_hessian_is_the_jacobians_square(problem: OutputError) -> None:
    """Without noise the gradient's derivative is the Gauss-Newton Hessian: no second-order term is left."""
    shared, local = point(problem)
    truth = problem.simulated_outputs(shared, local)
    exact = replace(
        problem, data=replace(problem.data, measured=np.where(np.isfinite(problem.data.measured), truth, np.nan))
    )
    normal = exact.normal(shared, local)
    steps = 1e-5 * np.maximum(np.abs(shared), 0.1)
    rows = [
        (exact.normal(shared + h, local).gradient - exact.normal(shared - h, local).gradient) / (2 * np.max(h))
        for h in np.diag(steps)
    ]
    scale = np.sqrt(np.outer(np.diag(normal.hessian), np.diag(normal.hessian)))
    np.testing.assert_allclose(np.array(rows) / scale, normal.hessian / scale, atol=1e-5)


def test_shared_unknowns_are_laid_out_by_session(problem: OutputError) -> None:
    assert problem.free == ("X_uu", "Y_v", "N_v", "N_r")
    assert problem.unknowns_per_session == 5
    assert problem.size == 4 + 2 * 5
    np.testing.assert_array_equal(problem.columns_of(1), [0, 1, 2, 3, 9, 10, 11, 12, 13])
    start = problem.start()
    np.testing.assert_allclose(start[4:], [0.0, 0.0, 0.0, 1.0, 0.0] * 2)


def test_priors_cost_what_they_say(problem: OutputError) -> None:
    shared, local = point(problem)
    bare = replace(problem, model=problem.model.with_parameters(problem.model.parameters.without_priors()))
    expected = 0.5 * ((shared[1] + 0.3) / 0.05) ** 2
    assert problem.cost(shared, local) - bare.cost(shared, local) == pytest.approx(expected, rel=1e-6)
    inside, outside = problem.normal(shared, local), bare.normal(shared, local)
    assert (inside.hessian - outside.hessian)[1, 1] == pytest.approx(0.05**-2, rel=1e-6)
    assert inside.gradient[1] - outside.gradient[1] == pytest.approx((shared[1] + 0.3) / 0.05**2, rel=1e-6)


def test_huber_counts_a_jump_linearly(model: Model, records: tuple[Record, ...]) -> None:
    data = cut_segments(model, records[:1], OUTPUTS, None)
    problem = OutputError(model, data, NOISE, huber=2.0, workers=1)
    shared, local = problem.start(), problem.measured_initial_states()

    def spoilt(by: float) -> float:
        measured = data.measured.copy()
        measured[50, 0] += by * NOISE[0]
        return replace(problem, data=replace(data, measured=measured)).cost(shared, local)

    assert spoilt(200.0) - spoilt(100.0) == pytest.approx(2.0 * 100.0, rel=1e-9)


def test_pinned_unknowns_have_no_room(problem: OutputError) -> None:
    own = problem.start()
    held = replace(problem, pinned=own)
    np.testing.assert_array_equal(held.lower, own)
    np.testing.assert_array_equal(held.upper, own)
    assert np.all(np.isinf(problem.lower))


def test_bounds_are_the_parameters(model: Model, records: tuple[Record, ...]) -> None:
    bounded = model.with_parameters(model.parameters.bounded("Y_v", -0.5, -0.1))
    problem = OutputError(bounded, cut_segments(model, records[:1], OUTPUTS, None), NOISE)
    assert problem.lower[1] == -0.5
    assert problem.upper[1] == -0.1


def test_a_diverging_segment_costs_infinitely(problem: OutputError) -> None:
    shared, local = point(problem)
    shared[0] = 1e3
    assert problem.cost(shared, local) == np.inf


def test_only_states_that_reach_an_output_start_free(records: tuple[Record, ...]) -> None:
    model = nomoto()
    data = cut_segments(model, [records[0]], ("r", "psi"), None)
    assert OutputError(model, data, np.ones(2)).starts == ("r", "psi")
    data = cut_segments(model, [records[0]], ("r", "psi", "x0"), None)
    assert OutputError(model, data, np.ones(3)).starts == ("r", "psi", "x0")


def test_starts_skip_what_was_not_measured(problem: OutputError) -> None:
    local = problem.measured_initial_states()
    assert local[0, 0] == problem.data.measured[0, 0]
    last = problem.data.offsets[-2]
    assert local[-1, 0] == 0.0
    assert np.isnan(problem.data.measured[last, 0])


def test_workers_change_no_bit(problem: OutputError, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(output_error, "_ROWS_PER_RANGE", 100)  # so that two of them have their fill
    shared, local = point(problem)
    one, two = (replace(problem, workers=n, data=replace(problem.data)).normal(shared, local) for n in (1, 2))
    np.testing.assert_array_equal(one.hessian, two.hessian)
    np.testing.assert_array_equal(one.gradient, two.gradient)


@pytest.mark.parametrize("most", [10**9, 0])
def test_slopes_at_a_point_are_worked_out_once(
    problem: OutputError, monkeypatch: pytest.MonkeyPatch, most: int
) -> None:
    monkeypatch.setattr(output_error, "_MOST_KEPT", most)
    data, calls = replace(problem.data), list[Array]()
    plain = SegmentBatch.differentiate

    def counted(batch: SegmentBatch, *arguments: Any) -> Any:
        calls.append(arguments[2])
        return plain(batch, *arguments)

    monkeypatch.setattr(SegmentBatch, "differentiate", counted)
    shared, local = point(problem)
    known = replace(problem, data=data)
    louder, shifted = replace(known, noise=3.0 * NOISE), shared + 1e-3 * np.abs(shared)
    finer = replace(known, substeps=2)
    at = [(known, shared), (louder, shared), (known, shifted), (louder, shifted), (finer, shifted)]
    found = [one.normal(where, local) for one, where in at]
    assert len(calls) == (3 if most else len(at))
    for (one, where), normal in zip(at, found, strict=True):
        again = replace(one, data=replace(data)).normal(where, local)
        np.testing.assert_array_equal(normal.hessian, again.hessian)
        np.testing.assert_array_equal(normal.gradient, again.gradient)


def test_normal_equations_of_runs_add_up(problem: OutputError) -> None:
    shared, local = point(problem)
    blocks, whole = problem.segment_normals(shared, local), problem.normal(shared, local)
    runs = [np.flatnonzero(problem.data.run == r) for r in range(3)]
    parts = [problem.assemble(blocks, shared, chosen, with_prior=False) for chosen in runs]
    mean, weight = problem.priors
    np.testing.assert_allclose(sum(p.gradient for p in parts) + weight * (shared - mean), whole.gradient, rtol=1e-10)
    np.testing.assert_allclose(sum(p.without_local()[1] for p in parts) + np.diag(weight), whole.without_local()[1],
                               rtol=1e-6, atol=1e-6)  # fmt: skip
