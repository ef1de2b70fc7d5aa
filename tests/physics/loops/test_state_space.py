"""The states behind a loop and the model made of them: frequency responses, lsim, free gains."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lsim
from tests.physics.loops.example_loops import second_order

from seatrial.core.equations import Model
from seatrial.core.values import InputError
from seatrial.physics.loops import Block, TransferLoop
from seatrial.physics.loops.fin import BOUNDS, PUBLISHED_GAINS, ROLL, Preamplifier, fin_loop
from seatrial.physics.loops.state_space import controllable_form, loop_model, state_space
from seatrial.physics.simulate.harmonics import frequency_response, linear_system
from seatrial.physics.simulate.linear import LinearBatch

OMEGA = np.geomspace(1e-2, 30.0, 25)
OTHER_SEA = replace(fin_loop(), disturbance=Block("met", (1.0, 0.2), (2.0, 0.9, 1.0)))
LOOPS = [*(fin_loop(reading) for reading in Preamplifier), OTHER_SEA]
IDS = ["printed", "washout", "own poles"]


@pytest.fixture(scope="module")
def model() -> Model:
    return loop_model(fin_loop())


@pytest.mark.parametrize(
    "block",
    [Block("one", (2.0,)), Block("lag", (1.0, 3.0), (2.0, 1.0)), Block("third", (1.0, 0.0), (1e-3, 0.2, 1.0, 9.0))],
    ids=lambda block: block.name,
)
def test_the_canonical_form_answers_as_the_block(block: Block) -> None:
    A, b, c, d = controllable_form(block)
    n = len(b)
    x = np.linalg.solve(1j * OMEGA[:, None, None] * np.eye(n) - A, np.broadcast_to(b[:, None], (25, n, 1)))[..., 0]
    np.testing.assert_allclose(x @ c + d, block.frequency_response(OMEGA), rtol=1e-11)


@pytest.mark.parametrize("loop", LOOPS, ids=IDS)
def test_states_answer_as_the_loop(loop: TransferLoop, rng: np.random.Generator) -> None:
    made = state_space(loop)
    n = len(made.b)
    assert made.A.shape == (4, n, n) and made.a.shape == (4, n) and len(set(made.names)) == n
    for gains in rng.random((5, 3)) * 30.0:
        b = np.broadcast_to(made.b[:, None], (25, n, 1))
        x = np.linalg.solve(1j * OMEGA[:, None, None] * np.eye(n) - made.closed_loop_matrix(gains), b)[..., 0]
        L = gains @ loop.open_loop_terms(OMEGA)
        output = loop.disturbance.frequency_response(OMEGA) / (1.0 + L)
        np.testing.assert_allclose(x @ made.c, output, rtol=1e-8)
        np.testing.assert_allclose(
            x @ made.actuator_row(gains), -L / loop.plant.frequency_response(OMEGA) * output, rtol=1e-8
        )


def test_gains_of_the_model_are_its_free_parameters(model: Model) -> None:
    assert model.parameters.names == tuple(PUBLISHED_GAINS)
    assert {p.name: (p.value, p.lower, p.upper) for p in model.parameters.free} == {
        name: (value, *BOUNDS[name]) for name, value in PUBLISHED_GAINS.items()
    }
    assert model.inputs[0].name == "alpha_w"
    assert model.outputs == ("phi", "alpha_f")
    assert model.is_affine


def test_the_model_answers_as_the_loop_at_other_gains_too(model: Model) -> None:
    for gains in (np.array(list(PUBLISHED_GAINS.values())), np.array([30.0, 2.0, 5.0])):
        of = linear_system(model.with_values(dict(zip(PUBLISHED_GAINS, gains, strict=True))), ("phi", "alpha_f"))
        seen = frequency_response(of, OMEGA)[..., 0]
        loop = fin_loop().with_gains(gains)
        phi = ROLL.frequency_response(OMEGA) / (1.0 + loop.open_loop(OMEGA))
        np.testing.assert_allclose(seen[:, 0], phi, rtol=1e-8)
        np.testing.assert_allclose(seen[:, 1], -(gains @ loop.controller_terms(OMEGA)) * phi, rtol=1e-8)


def test_the_model_simulated_equals_lsim(model: Model, rng: np.random.Generator) -> None:
    dt, count = 0.1, 1200
    t = np.arange(count) * dt
    slope = 0.05 * sum(np.sin(w * t + p) for w, p in zip((0.4, 0.8, 1.3), rng.uniform(0.0, 6.0, 3), strict=True))
    batch = LinearBatch(model, slope[:, None], np.array([0, count]), dt, model.outputs)
    y, failed = batch.simulate(0, 1, np.zeros((1, len(model.states))), model.parameters.values[None], np.empty((1, 0)))
    assert failed.tolist() == [-1]
    u, pieces = batch.fine_inputs(0)
    of = linear_system(model, model.outputs)
    _, expected, _ = lsim((of.A, of.B, of.C, of.D), u[:, 0], np.arange(len(u)) * dt / pieces)
    np.testing.assert_allclose(y, expected[::pieces], atol=1e-10 * np.abs(expected).max())
    assert np.abs(y[:, 0]).max() > 1e-3


@pytest.mark.parametrize("what", ["plant", "disturbance"])
@pytest.mark.parametrize("block", [Block("one"), Block("at once", (1.0, 0.0, 1.0), (1.0, 0.6, 1.0))])
def test_what_answers_at_once_is_refused(what: str, block: Block) -> None:
    loop = second_order(0.3)
    at_once = replace(loop, plant=block) if what == "plant" else replace(loop, disturbance=block)
    with pytest.raises(InputError, match=f"the {what} of loop 'second order' answers at once"):
        state_space(at_once)
