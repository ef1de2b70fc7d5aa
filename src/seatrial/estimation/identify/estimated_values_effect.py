"""Which of the values that a trial file marks as estimated matters: the coefficients and predictions that it moves."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.text.numbers import percent, signed_percent, significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import NOT_MEASURED, Finding, Severity
from seatrial.data.trial.estimated_values import ESTIMATED_VALUES
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.identify.assumed_information import assumed_information
from seatrial.estimation.identify.identifiability import RELATIVE_CHANGE

MATTERS = 1.0
"""Change of a coefficient over half its interval, and of predictions over the noise, from which a value matters: an
interval that is right but for this value would no longer hold the truth; chosen."""
PLAUSIBLE_ERROR = {"rho": 0.025}
"""Relative error of values that are known better than to `RELATIVE_CHANGE`: water between fresh and salt."""
MAX_NAMED = 3
"""Values of which a warning says what they do; chosen."""


@dataclass(frozen=True)
class EstimatedValueEffect:
    """What it does to a fit that an estimated value is too small by a share of it.

    Attributes:
        name: of the value; error: the share.
        coefficient: that which moves most, over half its interval.
        relative_change: of it; NaN where its interval contains 0.
        share_of_interval: its change over half its interval.
        prediction: rms change of everything compared over the training runs, over the noise.
    """

    name: str
    error: float
    coefficient: str
    relative_change: float
    share_of_interval: float
    prediction: float

    @property
    def matters(self) -> bool:
        """Whether a coefficient leaves its interval, or predictions move by more than the noise."""
        return max(self.share_of_interval, self.prediction) >= MATTERS

    @property
    def sentence(self) -> str:
        """``m 10 % larger moves Y_v by +12 % (3.1 of half its interval), and predictions by 0.020 of the noise``."""
        times = f"{significant(self.share_of_interval, 2)} of half its interval"
        is_signed = math.isfinite(self.relative_change)
        how_far = f"{signed_percent(self.relative_change)} ({times})" if is_signed else times
        return (
            f"{self.name} {percent(self.error)} % larger moves {self.coefficient} by {how_far}, and predictions of the "
            f"training runs by {significant(self.prediction, 2)} of the noise"
        )


def estimated_value_effects(estimation: Estimation) -> tuple[EstimatedValueEffect, ...]:
    """Return what each estimated value does that the model holds and that is not zero; the most first."""
    model = estimation.model
    names = [p.name for p in model.parameters if not p.free and p.value and p.source.startswith(NOT_MEASURED)]
    if not names:
        return ()
    known, free = assumed_information(estimation, names), estimation.estimate.problem.free
    half = np.maximum(estimation.interval.half_width[: known.count], 1e-300)  # above zero, for a division
    effects = []
    for name in names:
        error = PLAUSIBLE_ERROR.get(name, RELATIVE_CHANGE)
        moves, growth = known.shifts(known.unit(name) * error * model.parameters[name].value)
        most = int(np.argmax(np.abs(moves) / half))
        value = model.parameters[free[most]].value
        relative = float(moves[most] / value) if abs(value) > half[most] else math.nan
        rms = float(np.sqrt(growth / known.samples))
        share = float(abs(moves[most]) / half[most])
        effects.append(EstimatedValueEffect(name, error, free[most], relative, share, rms))
    return tuple(sorted(effects, key=lambda e: -max(e.share_of_interval, e.prediction)))


def with_effects(findings: Sequence[Finding], estimation: Estimation) -> Iterator[Finding]:
    """Yield the findings of a trial, that on estimated values with what these do: a note where none matters."""
    for finding in findings:
        is_of_values = finding.code == ESTIMATED_VALUES
        yield finding_with_effects(finding, estimated_value_effects(estimation)) if is_of_values else finding


def finding_with_effects(finding: Finding, effects: Sequence[EstimatedValueEffect]) -> Finding:
    """Return the finding on estimated values with what these do, the worst first: a note where none matters."""
    worst = [e for e in effects if e.matters]
    if not worst:
        text = f"none of them matters much: {effects[0].sentence}" if effects else "the model itself holds none of them"
        return replace(finding, severity=Severity.INFO, evidence=text, consequence="")
    rest = [e.name for e in effects if not e.matters]
    parts = [
        "; ".join(e.sentence for e in worst[:MAX_NAMED]),
        *([f"{enumeration([e.name for e in worst[MAX_NAMED:]])} too"] if len(worst) > MAX_NAMED else []),
        *([f"{enumeration(rest)} {'matter' if len(rest) > 1 else 'matters'} less"] if rest else []),
    ]
    return replace(
        finding, evidence="; ".join(parts),
        advice=f"measure {worst[0].name} first, write it in place of the estimate, and remove the mark",
    )  # fmt: skip
