"""The fin stabiliser of Yu et al. 2014 (CAAI Transactions on Intelligent Systems 9(4), 433-438), block by block.

Two readings of its preamplifier, a lag of 30 s printed as a low-pass: as printed the proportional part acts on the
roll angle; as the high-pass ("washout") that rate-gyro controllers have, on the roll rate. The paper cannot decide.
"""

from dataclasses import replace
from enum import Enum

from seatrial.core.values import Parameter, Parameters
from seatrial.physics.loops.block import Block
from seatrial.physics.loops.loop import Term, TransferLoop

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
