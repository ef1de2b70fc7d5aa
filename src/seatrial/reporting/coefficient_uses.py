"""What each free coefficient can be used for, one row each, and three lines on what that means; nothing is computed."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from types import MappingProxyType

from seatrial.core.results import Coefficient, Fit, Identifiability
from seatrial.core.text.numbers import DASH, fixed, signed_percent, significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import NOT_MEASURED
from seatrial.reporting.correlations import MIN_VARIANCE_INFLATION, Partner

# share of its prior's standard deviation from which on the records say next to nothing of a coefficient; chosen
PRIOR_SHARE = 0.9
# relative standard error from which on a value is known vaguely only, as of combinations in the same chapter; chosen
WELL_DETERMINED = 0.1
# names that a line holds, chosen
MAX_NAMES = 8


class Use(StrEnum):
    """What a coefficient can be used for, the most first."""

    BY_ITSELF = "by itself"
    VAGUELY = "by itself, vaguely"
    AS_A_SET = "with others only"
    FROM_PRIOR = "from its prior"
    SIGN_OPEN = "sign open"
    NO_INTERVAL = "no interval"


@dataclass(frozen=True)
class CoefficientUse:
    """A free coefficient: how well it is known, how much it does, what it depends on, and what it can be used for."""

    name: str
    half_width: str
    effect: str
    variance_inflation: str
    partner: str
    use: Use


def coefficient_uses(
    coefficients: Sequence[Coefficient],
    content: Identifiability,
    strong: Mapping[str, Partner] = MappingProxyType({}),
) -> tuple[CoefficientUse, ...]:
    """Return a row for each free coefficient: those that can be used by themselves first, the widest interval last.

    strong: coefficients whose errors are strongly correlated in the intervals' covariance, as `strong_partners` has it.
    """
    collinear = {c.parameter: c for c in content.collinearity}
    effects = {s.parameter: s.effect for s in content.sensitivities}
    rows = []
    for c in (c for c in coefficients if not c.fixed):
        tied, spread = collinear.get(c.name), _relative_half_width(c)
        inflation = tied.variance_inflation if tied else math.nan
        use = _use(c, inflation, is_paired=c.name in strong)
        partner = strong.get(c.name) or (Partner(tied.partner, tied.correlation) if tied and tied.partner else None)
        row = CoefficientUse(
            c.name, f"± {significant(100.0 * spread, 2)}" if math.isfinite(spread) else DASH,
            significant(effects.get(c.name), 2), "∞" if math.isinf(inflation) else significant(inflation, 2),
            f"{partner.name} {fixed(partner.correlation, 2)}" if partner else "", use,
        )  # fmt: skip
        rows.append((list(Use).index(use), spread if math.isfinite(spread) else math.inf, row))
    return tuple(row for *_, row in sorted(rows, key=lambda one: one[:2]))


def _use(c: Coefficient, inflation: float, *, is_paired: bool) -> Use:
    if c.lower is None or c.upper is None:
        return Use.NO_INTERVAL
    if c.is_sign_open:
        return Use.SIGN_OPEN
    if c.prior_standard_deviation and (c.standard_error or 0.0) >= PRIOR_SHARE * c.prior_standard_deviation:
        return Use.FROM_PRIOR
    if is_paired or inflation >= MIN_VARIANCE_INFLATION:
        return Use.AS_A_SET
    if c.is_level:
        return Use.BY_ITSELF
    return Use.VAGUELY if (c.standard_error or 0.0) >= WELL_DETERMINED * abs(c.estimate) else Use.BY_ITSELF


def _relative_half_width(c: Coefficient) -> float:
    if c.lower is None or c.upper is None or c.estimate == 0.0 or c.is_level:
        return math.nan
    return 0.5 * (c.upper - c.lower) / abs(c.estimate)


def meaning_lines(fit: Fit, content: Identifiability, uses: Sequence[CoefficientUse]) -> tuple[tuple[str, str], ...]:
    """Return what the identifiability means for predictions, for single values, and for what was assumed."""
    lines = [
        ("Predictions", "of manoeuvres like those recorded rest only on what is determined; those of another kind may "
                        "rest on what is not."),
        ("Single values", _single_values(uses)),
    ]  # fmt: skip
    assumed = _assumptions(fit, content)
    return (*lines, ("Assumed values", assumed)) if assumed else tuple(lines)


def _single_values(uses: Sequence[CoefficientUse]) -> str:
    names = {use: [row.name for row in uses if row.use is use] for use in Use}
    free = names[Use.BY_ITSELF]
    parts = [f"{enumeration(free, MAX_NAMES) if free else 'no coefficient'} can be used by "
             f"{'themselves' if len(free) > 1 else 'itself'}"]  # fmt: skip
    sentences = {
        Use.VAGUELY: "{} only vaguely, with standard errors above 10 %",
        Use.AS_A_SET: "{} only together, as their errors depend on one another",
        Use.FROM_PRIOR: "{} as far as the prior is right: the records add next to nothing",
        Use.SIGN_OPEN: "not even the sign of {} is known",
        Use.NO_INTERVAL: "{} without an interval",
    }
    parts += [words.format(enumeration(names[use], MAX_NAMES)) for use, words in sentences.items() if names[use]]
    return "; ".join(parts) + "."


def _assumptions(fit: Fit, content: Identifiability) -> str:
    tied = {name for symmetry in content.structural for name in symmetry.parameters}
    held = [c.name for c in fit.coefficients if c.fixed and c.name in tied]
    parts = [f"{enumeration(held, MAX_NAMES)} {'are' if len(held) > 1 else 'is'} held, as no manoeuvre identifies "
             f"{'them' if len(held) > 1 else 'it'} apart from the others"] if held else []  # fmt: skip
    guessed = [c.name for c in fit.coefficients if c.is_unmeasured]
    if guessed:
        parts.append(f"{enumeration(guessed, MAX_NAMES)} {'are' if len(guessed) > 1 else 'is'} {NOT_MEASURED}")
    is_open = {c.name for c in fit.coefficients if c.is_sign_open}
    moves = [(abs(x), c, n, x) for c in content.consequences for n, x in c.estimate_changes.items() if n not in is_open]
    if moves:
        _, worst, name, change = max(moves, key=lambda move: move[0])
        parts.append(f"a change of {worst.parameter} by {signed_percent(worst.change)} would change {name} by "
                     f"{signed_percent(change)}")  # fmt: skip
    return "; ".join(parts) + "." if parts else ""
