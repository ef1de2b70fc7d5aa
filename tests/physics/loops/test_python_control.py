"""python-control's objects in and out."""

import control
import numpy as np
import pytest
from tests.physics.loops.example_loops import second_order
from tests.physics.loops.sampled_loops import RIB, sampled_loop

from seatrial.core.values import InputError
from seatrial.physics.loops import Block, Sampling, TransferLoop
from seatrial.physics.loops.discrete import (
    block_from_system,
    controller_transfer_function,
    open_loop_transfer_function,
    transfer_function,
)
from seatrial.physics.loops.structures import DERIVATIVE, GYRO, ROLL, SERVO, Preamplifier, fin_loop

OMEGA = np.geomspace(1e-3, 1e2, 50)
BLOCKS = [GYRO, SERVO, ROLL, DERIVATIVE, Block("one")]
LOOPS = [*(fin_loop(reading) for reading in Preamplifier), second_order(0.3)]


def answer(system: control.TransferFunction | control.StateSpace) -> np.ndarray:
    return np.asarray(system(1j * OMEGA))


@pytest.mark.parametrize("block", BLOCKS, ids=lambda block: block.name)
def test_a_block_comes_back_from_a_transfer_function_as_it_was(block: Block) -> None:
    system = transfer_function(block)
    np.testing.assert_allclose(answer(system), block.frequency_response(OMEGA), rtol=1e-13)
    back = block_from_system(system, block.name)
    assert (back.name, back.num, back.den) == (block.name, block.num, block.den)


@pytest.mark.parametrize("block", BLOCKS, ids=lambda block: block.name)
def test_a_block_comes_back_from_a_state_space(block: Block) -> None:
    back = block_from_system(control.ss(transfer_function(block)), "back")
    np.testing.assert_allclose(back.frequency_response(OMEGA), block.frequency_response(OMEGA), rtol=1e-9)
    assert back.order == block.order


def test_a_state_space_written_by_hand_becomes_its_block() -> None:
    oscillator = control.ss([[0.0, 1.0], [-4.0, -0.4]], [[0.0], [3.0]], [[1.0, 0.0]], [[0.5]])
    expected = 0.5 + 3.0 / ((1j * OMEGA) ** 2 + 0.4j * OMEGA + 4.0)
    np.testing.assert_allclose(
        block_from_system(oscillator, "oscillator").frequency_response(OMEGA), expected, rtol=1e-10
    )


@pytest.mark.parametrize(
    ("system", "said"),
    [
        (control.TransferFunction([1.0], [1.0, 0.5], 0.1), "system 'given' is in discrete time"),
        (control.ss(-np.eye(2), np.eye(2), np.eye(2), np.zeros((2, 2))), "has 2 inputs and 2 outputs"),
        (control.TransferFunction([1.0, 0.0, 1.0], [1.0, 1.0]), "block 'given': the numerator is of degree 2"),
    ],
)
def test_what_is_no_block_is_refused(system: control.TransferFunction | control.StateSpace, said: str) -> None:
    with pytest.raises(InputError, match=said):
        block_from_system(system, "given")


@pytest.mark.parametrize("loop", LOOPS, ids=lambda loop: loop.name)
def test_the_open_loop_is_the_controller_times_the_plant(loop: TransferLoop) -> None:
    np.testing.assert_allclose(answer(open_loop_transfer_function(loop)), loop.open_loop(OMEGA), rtol=1e-9)
    np.testing.assert_allclose(
        answer(controller_transfer_function(loop)) * loop.plant.frequency_response(OMEGA),
        loop.open_loop(OMEGA),
        rtol=1e-9,
    )


@pytest.mark.parametrize("loop", LOOPS, ids=lambda loop: loop.name)
def test_python_control_closes_the_loop_on_the_same_poles(loop: TransferLoop) -> None:
    theirs = control.feedback(open_loop_transfer_function(loop), 1.0).poles()
    ours = loop.closed_loop_poles
    nearest = np.abs(theirs[:, None] - ours).min(axis=1)
    assert len(theirs) == len(ours)
    assert np.all(nearest <= 1e-6 * np.maximum(np.abs(theirs), 1e-2))


def test_a_sampled_loop_is_one_in_z() -> None:
    loop = sampled_loop(RIB, Sampling(0.2, 0.3))
    made, omega = open_loop_transfer_function(loop), np.geomspace(0.1, 10.0, 30)
    np.testing.assert_allclose(made(np.exp(0.2j * omega)), loop.open_loop(omega), rtol=1e-7)
