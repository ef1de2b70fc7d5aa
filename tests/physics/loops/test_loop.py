"""Loops as polynomials: against products of frequency responses, eigenvalues of the states, their own refusals."""

from dataclasses import replace

import numpy as np
import pytest
from tests.physics.loops.example_loops import second_order

from seatrial.core.values import InputError, Parameter, Parameters
from seatrial.physics.loops import (
    Block,
    EncounterSpectrum,
    LoopSignal,
    Performance,
    Term,
    TransferLoop,
    WeightedVariance,
)
from seatrial.physics.loops.loop_states import state_space
from seatrial.physics.loops.performance import margins
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


def test_an_integrator_without_gain_leaves_the_loop_that_has_none() -> None:
    """It moves nothing, so that neither poles nor margins nor variances know of it."""
    plant = Block("plant", (0.7,), (1.0, 0.3, 1.0))
    parts = {
        "KP": Block("one"),
        "KI": Block("integral", (1.0,), (1.0, 0.0)),
        "KD": Block("rate", (1.0, 0.0), (0.1, 1.0)),
    }

    def loop_of(**gains: float) -> TransferLoop:
        terms = tuple(Term(name, parts[name]) for name in gains)
        values = Parameters(tuple(Parameter(name, value, "1", 0.0, 9.0, free=True) for name, value in gains.items()))
        return TransferLoop("loop", (), terms, (), (), plant, plant, values)

    idle, without, weak = loop_of(KP=1.0, KI=0.0, KD=2.0), loop_of(KP=1.0, KD=2.0), loop_of(KP=1.0, KI=1e-9, KD=2.0)
    assert np.sort_complex(idle.closed_loop_poles) == pytest.approx(
        np.sort_complex(without.closed_loop_poles), rel=1e-12
    )
    assert len(weak.closed_loop_poles) == len(idle.closed_loop_poles) + 1
    assert margins(idle).Ms == pytest.approx(margins(without).Ms, rel=1e-12) and margins(idle).is_stable
    omega = np.linspace(0.2, 3.0, 50)
    sea = EncounterSpectrum(omega, np.full(50, 0.1), "even")
    rows = (WeightedVariance(LoopSignal.OUTPUT, np.ones_like), WeightedVariance(LoopSignal.ACTUATOR, np.ones_like))
    mixed = Performance(idle, sea, rows).evaluate(np.array([[1.0, 0.0, 2.0], [1.0, 1e-9, 2.0], [1.0, -1e-9, 2.0]]))
    alone = Performance(without, sea, rows).evaluate(np.array([[1.0, 2.0]]))
    np.testing.assert_allclose(mixed.variances[:2], np.repeat(alone.variances, 2, axis=0), rtol=1e-6)
    assert np.isinf(mixed.Ms[2])


def test_an_integrating_plant_that_nothing_controls_is_no_stable_loop() -> None:
    loop = replace(second_order(0.3), plant=Block("integrator", (1.0,), (1.0, 0.0)))
    idle = loop.with_gains(np.zeros(len(loop.terms)))
    assert np.any(idle.closed_loop_poles == 0.0) and not margins(idle).is_stable


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
