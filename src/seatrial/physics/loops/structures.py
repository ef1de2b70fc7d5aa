"""Controllers with more structure than three gains, still linear in their gains: more terms beside them, fixed filters.

The five-gain controller of the fins is three terms of the published one, a band-pass and a low-pass. With the gains
found for it the low-pass, subtracted from the proportional part, leaves a high-pass that advances the phase where the
three gains had to give roll reduction away for stability, and the band-pass works on the long waves below the natural
roll frequency.
"""

from dataclasses import replace

import numpy as np

from seatrial.core.values import InputError, Parameter, Parameters
from seatrial.physics.loops.block import Block
from seatrial.physics.loops.fin import PUBLISHED_GAINS
from seatrial.physics.loops.loop import Term, TransferLoop
from seatrial.physics.loops.margins import margins

ADDED_GAINS = ("KB", "KL")
ADDED_GAIN_LIMIT = 100.0  # to either side; the largest bound of the published gains
# Found by `python benchmarks/fin_structures.py`: CMA-ES over both frequencies and dampings, the five gains by SLSQP at
# each, for the least mean roll variance in three beam seas of 3.3 m (ITTC, JONSWAP, ITTC short-crested) with no more
# fin-rate energy than the published gains in any and Ms <= 1.9; frequencies and dampings rounded, gains found again
# and rounded so that no sea asks for more rate.
FREQUENCIES_AND_DAMPINGS = (0.53, 0.66), (2.7, 0.4)
SEARCHED_GAINS = {"KP": 34.2, "KI": 0.0, "KD": 0.0, "KB": 24.4, "KL": -32.8}  # found with these, as above
SOURCE = "searched, see seatrial.physics.loops.structures"


def band_pass(omega: float, damping: float) -> Block:
    """Return 2 zeta omega s / (s^2 + 2 zeta omega s + omega^2): 1 at omega [rad/s]; its width is 2 zeta omega.

    Raises:
        InputError: frequency or damping is not positive.
    """
    width = 2.0 * _positive("band-pass", "damping", damping) * _positive("band-pass", "frequency", omega)
    return Block("band-pass", (width, 0.0), (1.0, width, omega**2))


def low_pass(omega: float, damping: float = 0.7) -> Block:  # damping about that of Butterworth's filter
    """Return omega^2 / (s^2 + 2 zeta omega s + omega^2): 1 at rest, falling above omega [rad/s].

    Raises:
        InputError: frequency or damping is not positive.
    """
    width = 2.0 * _positive("low-pass", "damping", damping) * _positive("low-pass", "frequency", omega)
    return Block("low-pass", (omega**2,), (1.0, width, omega**2))


def notch(omega: float, damping: float, depth: float) -> Block:
    """(s^2 + 2 zeta depth omega s + omega^2) / (s^2 + 2 zeta omega s + omega^2): `depth` at omega, 1 far from it.

    Args:
        depth: what is left at omega, 0 (nothing) to 1 (no notch).

    Raises:
        InputError: frequency or damping is not positive, or the depth does not lie between 0 and 1.
    """
    if not 0.0 <= depth < 1.0:
        raise InputError(f"notch: the depth is the share left at its frequency, from 0 to below 1, not {depth:g}")
    width = 2.0 * _positive("notch", "damping", damping) * _positive("notch", "frequency", omega)
    return Block("notch", (1.0, depth * width, omega**2), (1.0, width, omega**2))


def high_pass(omega: float, damping: float) -> Block:
    """Return s^2 / (s^2 + 2 zeta omega s + omega^2): 1 far above omega [rad/s], falling below."""
    width = 2.0 * _positive("high-pass", "damping", damping) * _positive("high-pass", "frequency", omega)
    return Block("high-pass", (1.0, 0.0, 0.0), (1.0, width, omega**2))


def _positive(block: str, quantity: str, value: float) -> float:
    if not (np.isfinite(value) and value > 0.0):
        raise InputError(f"{block}: the {quantity} must be positive, not {value:g}")
    return value


def with_terms(loop: TransferLoop, *extra: Term, gains: tuple[Parameter, ...]) -> TransferLoop:
    """Return the loop with more terms beside its own; `gains`: one for each, in the order of the terms.

    Raises:
        InputError: gains and terms do not go together, a gain lacks a bound, or the loop has a term of that name.
    """
    for term in extra:
        if term.gain in loop.gains:
            raise InputError(f"loop '{loop.name}' has a gain '{term.gain}' already; give the added term another name")
    return replace(
        loop,
        name=f"{loop.name} + {', '.join(term.block.name for term in extra)}",
        terms=(*loop.terms, *extra),
        gains=Parameters((*loop.gains, *gains)),
    )


def with_filters(loop: TransferLoop, *filters: Block) -> TransferLoop:
    """Return the loop with fixed filters common to all its terms, notches for example."""
    return replace(loop, filters=(*loop.filters, *filters))


BAND_PASS, LOW_PASS = band_pass(*FREQUENCIES_AND_DAMPINGS[0]), low_pass(*FREQUENCIES_AND_DAMPINGS[1])


def five_gain_loop(loop: TransferLoop, band: Block = BAND_PASS, low: Block = LOW_PASS) -> TransferLoop:
    """Return a fin loop with a band-pass (KB) and a low-pass (KL) beside its three terms; added gains may be negative.

    Its gains are those found for the published loop with washout where they keep this loop stable with Ms <= 2; its
    own, with nothing of the added terms, where not (another plant or preamplifier).

    Raises:
        InputError: the loop has gains of these names already.
    """
    meanings = ("gain of the band-pass", "gain of the low-pass")
    gains = tuple(
        Parameter(name, 0.0, "1", -ADDED_GAIN_LIMIT, ADDED_GAIN_LIMIT, free=True, source=SOURCE, meaning=meaning)
        for name, meaning in zip(ADDED_GAINS, meanings, strict=True)
    )
    made = with_terms(loop, Term("KB", band), Term("KL", low), gains=gains)
    if loop.gains.names != tuple(PUBLISHED_GAINS):
        return made
    found = replace(made, gains=made.gains.with_values(SEARCHED_GAINS, SOURCE))
    return found if margins(found).Ms <= 2.0 else made
