"""The recursive filter against the batch, over a million samples, with faults, and where the ship changes."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from tests.estimation.estimate.online.streams import DT, NAMES, NOISE, OUTPUTS, SeaStream, truth_of

from seatrial.core.equations import Model, Sheet
from seatrial.core.values import InputError, Prior
from seatrial.estimation.estimate.online.recursive import DivergenceGuard, Forgetting, GaussianState, RecursiveFilter
from seatrial.estimation.estimate.online.window import filter_from_fit, gaussian_state_from_fit
from seatrial.estimation.problem.output_error import Nuisance, OutputError
from seatrial.estimation.problem.segments import Segments
from seatrial.numerics.optimise import Optimum, levenberg_marquardt
from seatrial.physics.models.roll import roll
from seatrial.physics.simulate.batch import InputCorrection, SegmentBatch, batch_class
from seatrial.physics.simulate.linear import LinearBatch
from seatrial_studies.seaway import fin_commands, ship

Array = np.ndarray
FIRST = 601


def additive(*, is_affine: bool, is_held: bool = False) -> Model:
    """x' = v, v' = -x - v/2 + b delta + c: linear in b, c and the state, as the outputs x and x + e are."""
    sheet = Sheet("additive")
    x, v = sheet.states("x0 v")
    delta = sheet.input("delta", is_held=is_held)
    b, c, e = (sheet.parameter(n, value, free=True) for n, value in (("b", 0.7), ("c", 0.1), ("e", 0.3)))
    push = sp.sin(delta) if not is_affine else delta
    sheet.rate(x, v)
    sheet.rate(v, b * push + c - x - v / 2)
    sheet.output("seen", x + e)
    return sheet.model()


EXACT = {"rtol": 1e-9, "atol": 1e-12}
# a smooth input is known a few samples ahead, not for the whole record
NEAR = {"rtol": 2e-4, "atol": 1e-5}


@pytest.mark.parametrize(
    ("model", "tolerance"),
    [
        (additive(is_affine=True, is_held=True), EXACT),
        (additive(is_affine=True), NEAR),
        (additive(is_affine=False), EXACT),
    ],
    ids=["exact steps, held input", "exact steps, smooth input", "Runge-Kutta"],
)
def test_a_linear_problem_ends_where_the_batch_does(
    model: Model, tolerance: dict[str, float], rng: np.random.Generator
) -> None:
    """Weighted least squares over three runs with holes, prior and free starts, against a filter in blocks of 7."""
    rows, dt, names, outputs = 120, 0.2, ("b", "c", "e"), ("x0", "seen")
    noise, prior, spread = np.array([0.1, 0.3]), np.array([0.5, 0.2, 0.4]), np.diag([0.3, 0.6]) ** 2
    inputs = np.cumsum(0.3 * rng.standard_normal((3 * rows, 1)), axis=0)
    batch = batch_class(model)(model, inputs, rows * np.arange(4), dt, outputs, names, (), model.states)
    values, start = np.tile(model.parameters.values, (3, 1)), np.zeros((3, 2))
    y, s, _ = batch.differentiate(0, 3, start, values, np.empty((3, 0)))
    measured = y + noise * rng.standard_normal(y.shape)
    measured[30:45, 0], measured[200, 1] = np.nan, np.nan

    wide = np.zeros((3 * rows, 2, 3 + 6))
    wide[:, :, :3] = s[:, :, :3]
    for run in range(3):
        own = slice(run * rows, (run + 1) * rows)
        wide[own, :, 3 + 2 * run : 5 + 2 * run] = s[own, :, 3:]
    seen = np.isfinite(measured)
    jacobian = (wide / noise[:, None])[seen]
    residual = ((measured - y) / noise)[seen]
    known = np.concatenate([prior**-2.0, np.tile(1.0 / np.diagonal(spread), 3)])
    covariance = np.linalg.inv(jacobian.T @ jacobian + np.diag(known))
    moved = covariance @ jacobian.T @ residual

    at = model.parameters.values[[model.parameters.index(n) for n in names]]
    belief = GaussianState(at, np.diag(prior**2), np.zeros(2), np.zeros((2, 3)), spread)
    made = RecursiveFilter(model, names, outputs, noise, dt, belief, guard=DivergenceGuard(huber_limit=np.inf))
    for run in range(3):
        if run:
            made.begin_run(np.zeros(2), spread)
        for row in range(run * rows, (run + 1) * rows, 7):
            until = min(row + 7, (run + 1) * rows)
            ahead = made.estimate_with(measured[row:until], inputs[row:until])
            made.update(measured[row:until], inputs[row:until])
    made.flush()
    np.testing.assert_allclose(made.value - at, moved[:3], **tolerance)
    # the last block before it was taken in
    np.testing.assert_allclose(ahead[0], made.value, rtol=1e-4)
    np.testing.assert_allclose(ahead[1], made.covariance, rtol=1e-3, atol=1e-9)
    np.testing.assert_allclose(made.covariance, covariance[:3, :3], **tolerance)


@pytest.mark.parametrize("heading", [45, 90, 135, 180])
def test_ten_minutes_in_a_sea_end_at_the_batch(heading: int) -> None:
    """A tenth of the standard errors that the batch has after the same ten minutes, from a fit of the first one."""
    stream = SeaStream.from_heading(heading, 600.0, 1)
    measured = stream.measured(heading)
    made = stream.run_filter(stream.filter(stream.batch_state(measured, FIRST), FIRST), measured, FIRST)
    batch = stream.batch_state(measured, len(measured))
    error = np.sqrt(np.diagonal(batch.covariance))
    assert np.max(np.abs(made.value - batch.value) / error) < 0.1
    np.testing.assert_allclose(made.standard_error / error, 1.0, atol=0.05)
    assert made.is_sound
    np.testing.assert_allclose(made.innovations.variance_ratio, 1.0, atol=0.35)
    np.testing.assert_allclose(made.state, batch.state, atol=5e-3)


def test_a_filter_takes_over_with_the_noise_of_the_fit() -> None:
    """Coloured channels count for fewer samples in both, so that intervals agree."""
    stream = SeaStream.from_heading(90, 120.0, 4)
    measured = stream.measured(4)

    def fitted(rows: int) -> tuple[OutputError, Optimum]:
        data = replace(stream.clean, inputs=np.ascontiguousarray(stream.clean.inputs[:rows]), measured=measured[:rows],
                       offsets=np.array([0, rows]))  # fmt: skip
        problem = OutputError(stream.ship, data, NOISE, inflation=np.array([4.0, 1.0]))
        return problem, levenberg_marquardt(
            problem, problem.start(), problem.measured_initial_states(), negligible=1e-9
        )

    problem, found = fitted(FIRST)
    made = stream.run_filter(filter_from_fit(problem, found.solution.point, found.local, found.normal), measured, FIRST)
    whole = fitted(len(measured))[1]
    error = np.sqrt(np.diagonal(np.linalg.inv(whole.normal.without_local()[1])))
    np.testing.assert_allclose(made.standard_error / error, 1.0, atol=0.05)
    assert np.max(np.abs(made.value - whole.solution.point) / error) < 0.1
    assert made.innovations.variance_ratio[0] < 0.5


def test_what_is_estimated_for_each_run_is_not_carried_on() -> None:
    stream = SeaStream.from_heading(90, 60.0, 4)
    gain = Nuisance(InputCorrection("F3", "gain"), Prior(1.0, 0.1, "test"), "1")
    problem = OutputError(stream.ship, replace(stream.clean, measured=stream.measured(1)), NOISE, (gain,))
    shared, local = problem.start(), problem.measured_initial_states()
    with pytest.raises(InputError, match="F3 gain"):
        filter_from_fit(problem, shared, local, problem.normal(shared, local))


@pytest.fixture(scope="module")
def beam() -> tuple[SeaStream, Array, GaussianState]:
    stream = SeaStream.from_heading(90, 180.0, 2)
    measured = stream.measured(3)
    return stream, measured, stream.batch_state(measured, FIRST)


def test_how_samples_are_cut_into_blocks_does_not_matter(beam: tuple[SeaStream, Array, GaussianState]) -> None:
    stream, measured, belief = beam
    ends = [stream.run_filter(stream.filter(belief, FIRST), measured, FIRST, block) for block in (1, 13, len(measured))]
    for other in ends[1:]:
        assert np.max(np.abs(other.value - ends[0].value) / ends[0].standard_error) < 1e-3


def test_what_is_handed_over_and_back_is_the_same(beam: tuple[SeaStream, Array, GaussianState]) -> None:
    stream, _, belief = beam
    again = stream.filter(belief, FIRST).gaussian_state()
    np.testing.assert_allclose(again.covariance, belief.covariance, rtol=1e-9)
    np.testing.assert_allclose(again.sensitivity, belief.sensitivity, rtol=1e-6, atol=1e-12)
    np.testing.assert_array_equal(again.value, belief.value)


def test_holes_and_spikes_do_little_harm(
    beam: tuple[SeaStream, Array, GaussianState], rng: np.random.Generator
) -> None:
    stream, measured, belief = beam
    spoilt = measured.copy()
    spoilt[700:730], spoilt[900, 0] = np.nan, np.nan
    whole = stream.run_filter(stream.filter(belief, FIRST), spoilt, FIRST)
    hit = rng.choice(np.arange(FIRST, len(measured)), 12, replace=False)
    spoilt[hit, 0] += 2.0 * rng.choice([-1.0, 1.0], 12)
    made = stream.run_filter(stream.filter(belief, FIRST), spoilt, FIRST)
    assert made.innovations.outlier_count[0] == np.isfinite(spoilt[hit, 0]).sum() > 9
    assert made.innovations.outlier_count[1] == 0
    assert made.is_sound
    assert np.max(np.abs(made.value - whole.value) / whole.standard_error) < 1.0
    assert whole.innovations.sample_count[1] == len(measured) - FIRST - 30


def test_a_million_samples_stay_positive_and_consistent() -> None:
    """The covariance falls as 1/N, stays positive, holds the truth; the state is what the coefficients make of it."""
    rng, block, model = np.random.default_rng(3), 100_000, ship(90)
    at, x, last = truth_of(model), np.zeros((1, 4)), np.zeros((1, 4))
    prior = 0.05 * np.abs(at)
    value = at + prior * rng.standard_normal(8)
    belief = GaussianState(value, np.diag(prior**2), np.zeros(4), np.zeros((4, 8)), np.zeros((4, 4)))
    made = RecursiveFilter(model, NAMES, OUTPUTS, NOISE, DT, belief, recent_inputs=np.zeros((1, 4)))
    early = np.eye(8)
    for piece in range(10):
        u = np.zeros((block + 1, 4))
        u[0], u[1:, 2] = last, fin_commands(block, DT, rng)
        run = LinearBatch(model, u, np.array([0, block + 1]), DT, model.states)
        y, _ = run.simulate(0, 1, x, model.parameters.values[None], np.empty((1, 0)))
        x, last = y[-1:].copy(), u[-1:]
        made.update(y[1:, [0, 2]] + NOISE * rng.standard_normal((block, 2)), u[1:])
        if piece == 0:
            early = made.covariance
    made.flush()
    scale = np.outer(made.standard_error, made.standard_error)
    assert np.linalg.eigvalsh(made.covariance / scale)[0] > 0.05
    np.testing.assert_allclose(np.diagonal(made.covariance) / np.diagonal(early), 0.1, rtol=0.1)
    off = made.value - at
    assert off @ np.linalg.solve(made.covariance, off) < 26.1  # chi-squared, 8 degrees, 0.1 %
    assert made.is_sound
    assert np.max(made.gaussian_state().state_covariance) < 1e-20
    assert len(made._buffer.inputs) < 40


def test_runs_of_a_nonlinear_model_end_at_the_batch(rng: np.random.Generator) -> None:
    """Twelve roll decays from unknown starts: the first four fitted, the rest followed."""
    model = roll().with_values({"b_1": 0.05, "b_2": 0.4, "c_1": 0.5, "c_3": 0.0, "c_5": 0.0, "b_3": 0.0, "phi_0": 0.0})
    names = ("b_1", "b_2", "c_1")
    for fixed in set(model.parameters.free_names) - set(names):
        model = model.with_parameters(model.parameters.fixed(fixed))
    runs, rows, dt, noise = 12, 400, 0.1, np.array([np.radians(0.1)])
    inputs = np.zeros((runs * rows, len(model.inputs)))
    offsets = rows * np.arange(runs + 1)
    start = np.column_stack([rng.uniform(0.2, 0.4, runs), np.zeros(runs)])
    batch = SegmentBatch(model, inputs, offsets, dt, ("phi",))
    clean = batch.simulate(0, runs, start, np.tile(model.parameters.values, (runs, 1)), np.empty((runs, 0)))[0]
    measured = clean + noise * rng.standard_normal(clean.shape)

    def fitted(count: int) -> tuple[OutputError, GaussianState]:
        one = np.arange(count)
        named = tuple(str(i) for i in one)
        data = Segments(inputs[: count * rows], measured[: count * rows], offsets[: count + 1], one, one, named, named,
                        ("phi",), dt)  # fmt: skip
        problem = OutputError(model, data, noise)
        found = levenberg_marquardt(problem, problem.start(), problem.measured_initial_states(), negligible=1e-9)
        return problem, gaussian_state_from_fit(problem, found.solution.point, found.local, found.normal)

    made = RecursiveFilter(model, fitted(4)[0].free, ("phi",), noise, dt, fitted(4)[1], recent_inputs=inputs[:1])
    for run in range(4, runs):
        own = slice(run * rows, (run + 1) * rows)
        made.begin_run(np.array([measured[own][0, 0], 0.0]), np.diag([0.1, 0.1]) ** 2)
        made.update(measured[own], inputs[own])
    whole = fitted(runs)[1]
    error = np.sqrt(np.diagonal(whole.covariance))
    assert np.max(np.abs(made.value - whole.value) / error) < 0.2
    np.testing.assert_allclose(made.standard_error / error, 1.0, atol=0.05)


def test_another_ship_is_noticed(beam: tuple[SeaStream, Array, GaussianState]) -> None:
    """Damping of the opposite sign, and sure of it: the filter says that it is lost."""
    stream, measured, belief = beam
    wrong = replace(belief, value=belief.value * np.array([1, 1, 1, 1, 0.3, 1, 0.3, -1]))
    made = stream.run_filter(stream.filter(wrong, FIRST), measured, FIRST)
    assert not made.is_sound
    assert made.innovations.outlier_count.sum() > 100


def test_a_ship_that_blows_up_stops_the_filter(beam: tuple[SeaStream, Array, GaussianState]) -> None:
    stream, measured, belief = beam
    negative = belief.value * np.array([1, 1, 1, 1, -30, 1, -30, 1])
    unstable = replace(belief, value=negative, covariance=1e-12 * belief.covariance)
    made = stream.run_filter(stream.filter(unstable, FIRST), measured, FIRST)
    assert not made.is_sound


def test_without_excitation_forgetting_ends_at_the_widest(beam: tuple[SeaStream, Array, GaussianState]) -> None:
    stream, _, belief = beam
    widest = 0.3 * np.abs(truth_of(stream.ship))
    made = stream.filter(belief, FIRST, Forgetting(5.0, tuple(widest)))
    for _ in range(20):
        made.update(np.full((500, 2), np.nan), np.zeros((500, 4)))
    np.testing.assert_allclose(made.standard_error, widest, rtol=1e-3)
    assert made.is_sound


def test_forgetting_follows_a_ship_that_is_loaded(beam: tuple[SeaStream, Array, GaussianState]) -> None:
    """Ten per cent more mass and inertia show up as added mass, a33 and a55; a filter without forgetting lags."""
    stream = beam[0]
    heavy = stream.ship.with_values({n: 1.1 * stream.ship.parameters[n].value for n in ("m", "I5")})
    inputs = stream.clean.inputs
    run = LinearBatch(heavy, inputs, np.array([0, len(inputs)]), DT, OUTPUTS)
    y, _ = run.simulate(0, 1, np.zeros((1, 4)), heavy.parameters.values[None], np.empty((1, 0)))
    measured = y + NOISE * np.random.default_rng(5).standard_normal(y.shape)
    light = beam[2]
    truth = truth_of(stream.ship)
    target = truth.copy()
    target[[0, 2]] += [0.1 * stream.ship.parameters[n].value for n in ("m", "I5")]
    start = replace(
        light, state=y[FIRST - 1, [0, 0, 1, 1]] * [1, 0, 1, 0], state_covariance=np.diag([0.1, 0.3, 0.03, 0.1]) ** 2
    )
    made = stream.run_filter(stream.filter(start, FIRST, Forgetting(20.0, tuple(0.5 * np.abs(truth)))), measured, FIRST)
    stiff = stream.run_filter(stream.filter(start, FIRST), measured, FIRST)
    moved = np.abs(made.value / target - 1.0)[[0, 2]]
    assert np.all(moved < 0.02)
    assert np.mean(moved) < 0.5 * np.mean(np.abs(stiff.value / target - 1.0)[[0, 2]])
    assert made.is_sound


@pytest.mark.parametrize(
    ("measured", "inputs", "part"),
    [
        (np.zeros((3, 2)), np.zeros((4, 4)), "do not go with"),
        (np.zeros((3, 1)), np.zeros((3, 4)), "do not go with"),
        (np.zeros((3, 2)), np.zeros((3, 3)), "4 columns"),
        (np.zeros((3, 2)), np.full((3, 4), np.nan), "finite"),
    ],
)
def test_bad_samples_are_refused(
    beam: tuple[SeaStream, Array, GaussianState], measured: Array, inputs: Array, part: str
) -> None:
    made = beam[0].filter(beam[2], FIRST)
    with pytest.raises(InputError, match=part):
        made.update(measured, inputs)


def test_a_bad_beginning_is_refused(beam: tuple[SeaStream, Array, GaussianState]) -> None:
    stream, _, belief = beam
    with pytest.raises(InputError, match="covariance is not positive"):
        stream.filter(replace(belief, covariance=-belief.covariance), FIRST)
    with pytest.raises(InputError, match="finite numbers"):
        replace(belief, state=np.zeros(3))
    with pytest.raises(InputError, match="widest"):
        stream.filter(belief, FIRST, Forgetting(60.0))
    with pytest.raises(InputError, match="noise must be positive"):
        RecursiveFilter(stream.ship, NAMES, OUTPUTS, np.zeros(2), DT, belief)
