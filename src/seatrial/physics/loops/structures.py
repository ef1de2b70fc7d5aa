"""Controllers with more structure than three gains, still linear in them, and the fin stabiliser they are for."""

from dataclasses import replace
from enum import Enum

import numpy as np

from seatrial.core.values import InputError, Parameter, Parameters
from seatrial.physics.loops.loop import Block, Term, TransferLoop
from seatrial.physics.loops.performance import margins

# The fin stabiliser of Yu et al. 2014 (CAAI Transactions on Intelligent Systems 9(4), 433-438), block by block.

PAPER = "Yu et al. 2014, section 1"
K_ALPHA = 0.256  # fin effectiveness, Yu et al. 2014, section 1
GYRO = Block("rate gyro", (400.0, 0.0), (1.0, 80.0, 4000.0), PAPER)  # rate gyro, as printed
SERVO = Block("servo", (550.0,), (1.0, 15.0, 225.0), PAPER)  # fin servo, as printed
ROLL = Block("roll", (1.0,), (1.43242, 0.3796, 1.0), PAPER)  # roll of the ship, as printed
# filtered derivative, as printed
DERIVATIVE = Block("derivative", (0.064, 0.0), (0.064 * 0.18, 0.064 + 0.18, 1.0), f"{PAPER}, eq. (1)")
INTEGRAL = Block("integral", (1.0,), (24.607, 1.0), f"{PAPER}, eq. (1)")  # slow lag of 24.607 s, as printed
PUBLISHED_GAINS = {"KP": 11.053, "KI": 0.428, "KD": 32.736}  # as printed
BOUNDS = {"KP": (0.0, 100.0), "KI": (0.0, 50.0), "KD": (0.0, 100.0)}  # search ranges of the gains, as in Yu et al. 2014
MEANINGS = {"KP": "proportional gain", "KI": "gain of the slow lag", "KD": "gain of the filtered derivative"}


class Preamplifier(Enum):
    """How the lag of 30 s is read; the value is K_q that makes the paper's gains reduce the roll by 75.92 %.

    Fitted, not published: 18 kn, 90 deg, ITTC spectrum of 3.3 m, hull of 100 x 10.5 x 3.4 m (assumed).
    """

    PRINTED = 142.0  # K_q, fitted as above
    WASHOUT = 2.51  # K_q, fitted as above

    def block(self, K_q: float | None = None) -> Block:
        """Return G_q = K_q / ((30 s + 1) (0.056 s + 1)), with 30 s in the numerator as washout."""
        gain = self.value if K_q is None else K_q
        num = (gain,) if self is Preamplifier.PRINTED else (30.0 * gain, 0.0)  # 30 s: the lag, as printed
        return Block("preamplifier", num, (30.0 * 0.056, 30.056, 1.0), PAPER)  # lags of 30 s and 0.056 s, as printed


def published_gains() -> Parameters:
    """Return K_P, K_I, K_D as found by the paper's genetic algorithm, free within its bounds."""
    source = f"{PAPER[:-2]} 3"
    gains = ((name, value, BOUNDS[name], MEANINGS[name]) for name, value in PUBLISHED_GAINS.items())
    return Parameters(tuple(Parameter(n, v, "1", *b, free=True, source=source, meaning=m) for n, v, b, m in gains))


def fin_loop(
    preamplifier: Preamplifier = Preamplifier.WASHOUT,
    *,
    K_q: float | None = None,
    K_alpha: float = K_ALPHA,
    roll: Block = ROLL,
) -> TransferLoop:
    """The published loop, speed and wave regulators at 1 (G_h = G_l = 1), from the wave slope alpha_w to the roll phi.

    K_alpha: equivalent wave slope for each radian of fin; 0.256 in the paper, whatever the speed.
    """
    terms = (Term("KP", Block("proportional")), Term("KI", INTEGRAL), Term("KD", DERIVATIVE))
    return TransferLoop(
        f"fin {preamplifier.name.lower()}",
        sensor=(GYRO, preamplifier.block(K_q)),
        terms=terms,
        filters=(),
        servo=(SERVO,),
        plant=replace(roll.scaled(K_alpha), name="fins to roll"),
        disturbance=roll,
        gains=published_gains(),
    )


def K_alpha_at(U: float, U_reference: float, K_alpha: float = K_ALPHA) -> float:
    """Return the fin effectiveness at U, known at U_reference [m/s]: lift grows with the square of the speed."""
    return K_alpha * (U / U_reference) ** 2


# Controllers with more structure than three gains, still linear in their gains: more terms beside them, fixed filters.

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
