"""The states behind a loop and the model made of them: frequency responses, lsim, free gains."""

from dataclasses import replace

import numpy as np
import pytest
from tests.physics.loops.example_loops import second_order

from seatrial.core.values import InputError
from seatrial.physics.loops import Block, TransferLoop
from seatrial.physics.loops.loop import controllable_form
from seatrial.physics.loops.loop_states import state_space
from seatrial.physics.loops.structures import Preamplifier, fin_loop

OMEGA = np.geomspace(1e-2, 30.0, 25)
OTHER_SEA = replace(fin_loop(), disturbance=Block("met", (1.0, 0.2), (2.0, 0.9, 1.0)))
LOOPS = [*(fin_loop(reading) for reading in Preamplifier), OTHER_SEA]
IDS = ["printed", "washout", "own poles"]


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


@pytest.mark.parametrize("what", ["plant", "disturbance"])
@pytest.mark.parametrize("block", [Block("one"), Block("at once", (1.0, 0.0, 1.0), (1.0, 0.6, 1.0))])
def test_what_answers_at_once_is_refused(what: str, block: Block) -> None:
    loop = second_order(0.3)
    at_once = replace(loop, plant=block) if what == "plant" else replace(loop, disturbance=block)
    with pytest.raises(InputError, match=f"the {what} of loop 'second order' answers at once"):
        state_space(at_once)
