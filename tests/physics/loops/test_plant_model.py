"""A plant of transfer functions as a model: its rates have those transfer functions."""

from dataclasses import replace

import numpy as np
import pytest
from tests.physics.loops.example_loops import second_order

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError
from seatrial.numerics.kernels.integrate import evaluate
from seatrial.physics.loops import Block, TransferLoop
from seatrial.physics.loops.loop_states import plant_model
from seatrial.physics.loops.structures import fin_loop

OMEGA = np.array([0.05, 0.3, 0.84, 2.0, 7.0])
ROLL = Block("roll", (1.0,), (1.43242, 0.3796, 1.0))
SLOWER = Block("fins through a lag", (0.256,), tuple(np.polymul((1.43242, 0.3796, 1.0), (2.0, 1.0))))
APART = Block("gusts", (0.3, 0.1), (2.0, 1.0, 0.5))


def responses(model: Model) -> Array:
    """c (j omega - A)^-1 B of a linear model whose first state is the output, (inputs, n)."""
    nx, nu = len(model.states), len(model.inputs)
    points, out = np.eye(nx + nu), np.empty((nx + nu, nx))
    x, u = np.ascontiguousarray(points[:, :nx]), np.ascontiguousarray(points[:, nx:])
    evaluate(model.compiled.rates, x, u, model.parameters.values, 0.0, out)
    A, B = out[:nx].T, out[nx:].T
    return np.stack([np.linalg.solve(1j * w * np.eye(nx) - A, B)[0] for w in OMEGA], axis=1)


@pytest.mark.parametrize(
    ("loop", "order"),
    [
        (fin_loop(), 2),
        (replace(fin_loop(), plant=SLOWER), 3),
        (replace(fin_loop(), plant=ROLL, disturbance=SLOWER), 3),
        (replace(fin_loop(), disturbance=APART), 4),
        (second_order(0.3), 4),
    ],
)
def test_both_inputs_have_their_transfer_functions(loop: TransferLoop, order: int) -> None:
    """Of no higher order than needed: shared where one denominator holds the other."""
    model = plant_model(loop)
    assert model.states[0] == loop.output
    assert len(model.states) == order
    wanted = [loop.plant.frequency_response(OMEGA), loop.disturbance.frequency_response(OMEGA)]
    assert responses(model) == pytest.approx(np.array(wanted), rel=1e-9)


def test_plants_of_one_order_share_their_equations() -> None:
    loop = fin_loop()
    faster = replace(loop, plant=loop.plant.scaled(1.5))
    assert plant_model(loop).equation_hash == plant_model(faster).equation_hash


def test_a_loop_without_a_symbol_for_its_disturbance_gets_one() -> None:
    assert plant_model(replace(fin_loop(), disturbance_input="")).input_names == ("alpha_f", "disturbance")


def test_a_plant_that_answers_at_once_is_refused() -> None:
    with pytest.raises(InputError, match="answers at once"):
        plant_model(replace(fin_loop(), disturbance=Block("at once", (1.0, 1.0), (1.0, 2.0))))
