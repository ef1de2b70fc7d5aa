"""Do inputs follow outputs? A controller or helmsman who answers to the ship's motion ties disturbances to the inputs.

What an input's own past does not explain of it, and what the past of inputs and outputs does not explain of an output,
are uncorrelated with the output before the input, unless there is feedback: the cross-correlation at negative lags of
both remainders (Haugh 1976, J. Am. Stat. Assoc. 71, 378; Caines & Chan 1975, IEEE Trans. Autom. Control 20, 498).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.text.numbers import p_value
from seatrial.core.values import Array, Finding, Record, Severity
from seatrial.core.values.notation import COMMANDS as THRUSTER_COMMANDS

COMMANDS = ("delta", "alpha_f", "delta_f1", "delta_f2", *THRUSTER_COMMANDS)
"""Channels that a controller works."""

MOTIONS = ("psi", "r", "v", "phi", "p", "theta", "theta_dot")
"""Channels that a controller answers to."""

FEEDBACK_P = 1e-5
"""p-value of the test below which inputs follow outputs; small, because ships are not linear as the test is; chosen."""

FEEDBACK_CORRELATION = 0.1
"""Cross-correlation that feedback has at least: what ships do nonlinearly makes less than this; chosen."""

# lags of the regressions and of the correlation; most samples that are used; chosen
_LAGS, _MOST_SAMPLES = 10, 20_000
# fewest rows for each unknown of the regressions; chosen
_ROWS_PER_UNKNOWN = 4
# fewest samples that carry an input's unpredictable part: of single orders no correlation can be shown; chosen
_FEWEST_EVENTS = 15.0
# rms of an input's unpredictable part, over that of the input, that is rounding
_ROUNDING = 1e-9
# smallest norm that is divided by, and singular values over the largest that count as zero: rounding
_SMALLEST, _SINGULAR = 1e-300, 1e-10


@dataclass(frozen=True)
class FeedbackTest:
    """Whether an input follows outputs.

    Attributes:
        command: the input; motion: the output it follows most clearly.
        correlation: their largest cross-correlation, the output `lag` [s] before the input.
        p: that all cross-correlations up to ten samples are chance, smallest over the outputs times their number.
    """

    command: str
    motion: str
    lag: float
    correlation: float
    p: float

    @property
    def has_feedback(self) -> bool:
        """Whether the input follows outputs."""
        return self.p < FEEDBACK_P and abs(self.correlation) >= FEEDBACK_CORRELATION


def feedback_tests(record: Record) -> tuple[FeedbackTest, ...]:
    """Test every command of a complete record that moves, against all measured motions."""
    motions = [m for m in MOTIONS if m in record and np.ptp(record[m]) > 0.0]
    commands = [c for c in COMMANDS if c in record and np.ptp(record[c]) > 0.0]
    if not motions or not all(np.all(np.isfinite(record[n])) for n in (*motions, *commands)):
        return ()
    rows = slice(0, _MOST_SAMPLES)
    outputs = np.stack([record[m][rows] for m in motions], axis=1)
    tests = (_feedback_test(c, record[c][rows], motions, outputs, record.dt) for c in commands)
    return tuple(t for t in tests if t is not None)


def has_feedback(record: Record) -> bool:
    """Return whether any command of a record follows its motions."""
    return any(test.has_feedback for test in feedback_tests(record))


def feedback_findings(record: Record) -> tuple[Finding, ...]:
    """A note where commands follow motions."""
    return tuple(
        Finding(
            Severity.INFO,
            "feedback",
            f"record '{record.name}': '{t.command}' follows '{t.motion}' (a controller, or a helmsman as in a zigzag): "
            "output error would take disturbances that are answered for the ship's own response; identify uses "
            "prediction error with a disturbance model",
            f"cross-correlation {t.correlation:.2f}, output {t.lag:.2g} s before input, {p_value(t.p)}",
            "a stretch of rudder steps that do not depend on the motion identifies the coefficients better",
        )
        for t in feedback_tests(record)
        if t.has_feedback
    )


def _feedback_test(
    command: str, values: Array, motions: Sequence[str], outputs: Array, dt: float
) -> FeedbackTest | None:
    rows, ny = len(values) - _LAGS, len(motions)
    if rows < _ROWS_PER_UNKNOWN * (2 + _LAGS * (1 + ny)):
        return None
    own = np.hstack([np.ones((rows, 1)), _past(values[:, None])])
    order = _remainder(own, values[_LAGS:, None])[:, 0]
    power = float(order @ order)
    if power <= _ROUNDING**2 * float(values @ values) or power**2 < _FEWEST_EVENTS * float(np.sum(order**4)):
        return None
    motion = _remainder(np.hstack([own, values[_LAGS:, None], _past(outputs - outputs[0])]), outputs[_LAGS:])
    size = np.sqrt(power) * np.maximum(np.linalg.norm(motion, axis=0), _SMALLEST)
    correlations = np.array([order[k:] @ motion[:-k] for k in range(1, _LAGS + 1)]) / size
    p = chi_square_tail(_LAGS, rows * np.sum(correlations**2, axis=0))
    j = int(np.argmin(p))
    k = int(np.argmax(np.abs(correlations[:, j])))
    return FeedbackTest(command, motions[j], (k + 1) * dt, float(correlations[k, j]), min(1.0, ny * float(p[j])))


def chi_square_tail(degrees: int, statistic: Array) -> Array:
    """Return the probability that a chi-square variable of an even number of degrees of freedom exceeds a value.

    Abramowitz & Stegun 1964, eq. (26.4.21); `check` would load a library for this one number.
    """
    half = 0.5 * statistic
    return np.exp(-half) * sum(half**i / math.factorial(i) for i in range(degrees // 2))


def _past(values: Array) -> Array:
    """Columns of the values 1 to 10 rows before, (n - 10, 10 * columns)."""
    return np.hstack([values[_LAGS - k : len(values) - k] for k in range(1, _LAGS + 1)])


def _remainder(features: Array, target: Array) -> Array:
    """What features (n, k) do not explain of the target (n, m)."""
    unit = features / np.maximum(np.linalg.norm(features, axis=0), _SMALLEST)
    directions, triangle = np.linalg.qr(unit)
    independent = directions[:, np.abs(np.diagonal(triangle)) > _SINGULAR]
    return target - independent @ (independent.T @ target)
