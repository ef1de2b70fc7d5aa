"""What estimated values of a trial file may be wrong by, and the coefficients and predictions that they move."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.text.numbers import percent, signed_percent, significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import NOT_MEASURED, Array, Finding, Parameter, Severity
from seatrial.data.trial.plausibility import ESTIMATED_VALUES
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.identify.identifiability import RELATIVE_CHANGE
from seatrial.estimation.identify.score_test import Candidate, own_criterion, score_test
from seatrial.estimation.problem.output_error import OutputError

MATTERS = 1.0
"""Change of a coefficient over half its interval, and of predictions over the noise, from which a value matters: an
interval that is right but for this value would no longer hold the truth; chosen."""
PLAUSIBLE_ERROR = {"rho": 0.025}
"""Standard deviation of values that are known better than to `RELATIVE_CHANGE`: water between fresh and salt."""
_STEP = 0.01  # of such an error, of differences by it: small against the curve of outputs; chosen
_LEVER = "y_"  # begins the names of the places of thrusters across the craft
MAX_NAMED = 3
"""Values of which a warning says what they do; chosen."""


@dataclass(frozen=True, eq=False)
class EstimatedValueShift:
    """How the free coefficients move, (k,), SI, where an estimated value is too small by a share of it.

    Attributes:
        name: of the value; error: the share, a standard deviation.
        moves: of the free coefficients.
        prediction: rms change of everything compared over the training runs, over the noise.
    """

    name: str
    error: float
    moves: Array
    prediction: float


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
        """Return what it moves: ``m 10 % larger moves Y_v by +12 % (3.1 of half …), and predictions …``."""
        times = f"{significant(self.share_of_interval, 2)} of half its interval by the records alone"
        is_signed = math.isfinite(self.relative_change)
        how_far = f"{signed_percent(self.relative_change)} ({times})" if is_signed else times
        return (
            f"{self.name} {percent(self.error)} % larger moves {self.coefficient} by {how_far}, and predictions of the "
            f"training runs by {significant(self.prediction, 2)} of the noise"
        )


def estimated_value_shifts(estimation: Estimation) -> tuple[EstimatedValueShift, ...]:
    """Return what each estimated or assumed value does that the model holds and that is not zero.

    It is wrong by the prior that it would have if it were free, else by what such a value commonly is.
    """
    model = estimation.model
    held = {p.name: p for p in model.parameters if not p.free and p.value}
    names = [n for n, p in held.items() if p.source.startswith(NOT_MEASURED) or _spread(p) > 0.0]
    if not names:
        return ()
    groups = [[held[name] for name in group] for group in _wrong_together(names)]
    errors = [_spread(g[0]) or PLAUSIBLE_ERROR.get(g[0].name, RELATIVE_CHANGE) for g in groups]
    candidates = [_larger(group, error) for group, error in zip(groups, errors, strict=True)]
    test, problem = score_test(own_criterion(estimation), candidates), estimation.estimate.problem
    visible = np.sqrt(test.information / np.isfinite(problem.data.measured).sum())
    moves = test.by_candidates[: len(problem.free)].T
    return tuple(map(EstimatedValueShift, test.names, errors, moves, visible.tolist()))


def _larger(group: Sequence[Parameter], error: float) -> Candidate:
    """Values that are larger by a share together, as a candidate of which 1 is that share."""

    def problem_with(problem: OutputError, size: float) -> OutputError:
        values = {p.name: (1.0 + size * error) * p.value for p in group}
        return replace(problem, model=problem.model.with_values(values))

    return Candidate(enumeration([p.name for p in group]), problem_with, _STEP)


def _spread(parameter: Parameter) -> float:
    """Standard deviation of a parameter's prior over its value, which is not zero; 0: it has none."""
    if parameter.prior is None or not math.isfinite(parameter.prior.standard_deviation):
        return 0.0
    return parameter.prior.standard_deviation / abs(parameter.value)


def _wrong_together(names: Sequence[str]) -> list[list[str]]:
    """The names, those of the levers of thrusters in one group: they are estimated from one size of the craft."""
    levers = [name for name in names if name.startswith(_LEVER)]
    return [*([levers] if levers else []), *([name] for name in names if name not in levers)]


def errors_of(shifts: Sequence[EstimatedValueShift], free: Sequence[str]) -> dict[str, float]:
    """Return the standard deviation, SI, that estimated values put into each free coefficient, by its name."""
    if not shifts:
        return {}
    return dict(zip(free, np.sqrt(np.sum([shift.moves**2 for shift in shifts], axis=0)).tolist(), strict=True))


def with_estimated_values(estimation: Estimation, shifts: Sequence[EstimatedValueShift]) -> Estimation:
    """Return the estimation whose intervals hold what estimated values may be wrong by, independently of one another.

    The covariance is of coefficients beside other values than the model's: for their intervals, not for other craft.
    """
    if not shifts:
        return estimation
    moves, interval = np.array([shift.moves for shift in shifts]), estimation.interval
    count, covariance = moves.shape[1], interval.covariance.copy()
    covariance[:count, :count] += moves.T @ moves
    errors = sorted({shift.error for shift in shifts})
    shares = " or ".join(f"{percent(error)} %" for error in errors)
    meaning = f"{interval.meaning}, with {enumeration([s.name for s in shifts])} wrong by {shares} (standard deviation)"
    widened = replace(interval, covariance=covariance, meaning=meaning)
    return replace(estimation, uncertainty=replace(estimation.uncertainty, interval=widened))


def estimated_value_effects(
    estimation: Estimation, shifts: Sequence[EstimatedValueShift]
) -> tuple[EstimatedValueEffect, ...]:
    """Return what each estimated value does to the coefficient that it moves most; the most first."""
    free, effects = estimation.estimate.problem.free, []
    half = np.maximum(estimation.interval.half_width[: len(free)], 1e-300)  # above zero, for a division
    for shift in shifts:
        most = int(np.argmax(np.abs(shift.moves) / half))
        value = estimation.model.parameters[free[most]].value
        relative = float(shift.moves[most] / value) if abs(value) > half[most] else math.nan
        share = float(abs(shift.moves[most]) / half[most])
        effects.append(EstimatedValueEffect(shift.name, shift.error, free[most], relative, share, shift.prediction))
    return tuple(sorted(effects, key=lambda e: -max(e.share_of_interval, e.prediction)))


def with_effects(
    findings: Sequence[Finding], estimation: Estimation, shifts: Sequence[EstimatedValueShift]
) -> Iterator[Finding]:
    """Yield the findings of a trial, that on estimated values with what these do: a note where none matters."""
    effects = estimated_value_effects(estimation, shifts)
    for finding in findings:
        yield finding_with_effects(finding, effects) if finding.code == ESTIMATED_VALUES else finding


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
        consequence="the intervals of coefficients hold these errors, those of predictions do not",
        advice=f"measure {worst[0].name} first, write it in place of the estimate, and remove the mark",
    )  # fmt: skip
