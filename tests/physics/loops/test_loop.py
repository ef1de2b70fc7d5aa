"""Loops as polynomials: against products of frequency responses, eigenvalues of the states, their own refusals."""

from dataclasses import replace

import numpy as np
import pytest
from tests.physics.loops.example_loops import second_order

from seatrial.core.values import InputError, Parameter, Parameters
from seatrial.physics.loops import Block, Term, TransferLoop
from seatrial.physics.loops.loop_states import state_space
from seatrial.physics.loops.structures import Preamplifier, fin_loop

OMEGA = np.geomspace(1e-3, 1e2, 40)
LOOPS = [fin_loop(reading) for reading in Preamplifier]
GAINS = {"a": 0.4, "b": 1.1, "c": 0.3, "d": 0.2}
# terms of three denominators, a filter, a disturbance that shares no poles with the plant
RICH = TransferLoop(
    "rich",
    sensor=(Block("sensor", (1.0, 0.1), (0.2, 1.0)),),
    terms=(
        Term("a", Block("one")),
        Term("b", Block("lag", (1.0,), (5.0, 1.0))),
        Term("c", Block("band", (1.0, 0.0), (1.0, 0.4, 1.0))),
        Term("d", Block("same lag", (2.0,), (5.0, 1.0))),
    ),
    filters=(Block("notch", (1.0, 0.1, 4.0), (1.0, 2.0, 4.0)),),
    servo=(Block("servo", (1.0,), (0.3, 1.0)),),
    plant=Block("plant", (0.7,), (1.0, 0.3, 1.0)),
    disturbance=Block("met", (1.0, 0.0), (2.0, 0.5, 1.0)),
    gains=Parameters(tuple(Parameter(n, v, "1", 0.0, 9.0, free=True) for n, v in GAINS.items())),
)


@pytest.mark.parametrize("loop", [*LOOPS, RICH, second_order(0.3)], ids=lambda loop: loop.name)
def test_polynomials_equal_products_of_responses(loop: TransferLoop) -> None:
    d, n = loop.polynomials
    s = 1j * OMEGA
    of_blocks = np.prod(
        [b.frequency_response(OMEGA) for b in (*loop.sensor, *loop.filters, *loop.servo, loop.plant)], axis=0
    )
    for row, term, seen in zip(n, loop.terms, loop.open_loop_terms(OMEGA), strict=True):
        expected = term.block.frequency_response(OMEGA) * of_blocks
        np.testing.assert_allclose(np.polyval(row, s) / np.polyval(d, s), expected, rtol=1e-10)
        np.testing.assert_allclose(seen, expected, rtol=1e-10)
    np.testing.assert_allclose(loop.open_loop(OMEGA), loop.gain_values @ loop.open_loop_terms(OMEGA), rtol=1e-14)


@pytest.mark.parametrize("loop", [*LOOPS, RICH, second_order(0.3)], ids=lambda loop: loop.name)
def test_closed_poles_are_among_the_eigenvalues_of_the_states(loop: TransferLoop, rng: np.random.Generator) -> None:
    made, upper = state_space(loop), np.array([gain.upper for gain in loop.gains])
    for gains in rng.random((20, len(loop.terms))) * upper:
        poles = loop.with_gains(gains).closed_loop_poles
        eigenvalues = np.linalg.eigvals(made.closed_loop_matrix(gains))
        nearest = np.abs(poles[:, None] - eigenvalues).min(axis=1)
        assert np.all(nearest <= 1e-5 * np.maximum(np.abs(poles), 1e-2))
        assert np.any(poles.real > 0.0) == np.any(eigenvalues.real > 0.0)


def test_denominators_in_common_are_counted_once() -> None:
    assert len(RICH.polynomials[0]) - 1 == 1 + 1 + 2 + 2 + 1 + 2


def test_gains_in_another_order_than_terms_are_refused() -> None:
    with pytest.raises(InputError, match="loop 'rich': give one gain for each term"):
        replace(RICH, gains=Parameters(RICH.gains.free[::-1]))
    with pytest.raises(InputError, match="give one gain for each term"):
        replace(RICH, terms=(), gains=Parameters(()))


def test_a_free_gain_without_bounds_is_refused() -> None:
    unbounded = Parameters((Parameter("k", 1.0, "1", 0.0, free=True),))
    with pytest.raises(InputError, match="gain k needs finite bounds"):
        replace(second_order(0.3), gains=unbounded)
