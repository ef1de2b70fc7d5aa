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
        tied, spread = collinear.get(c.name), relative_half_width(c)
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
    if c.is_level or (c.standard_error or 0.0) < WELL_DETERMINED * abs(c.estimate):
        return Use.BY_ITSELF
    return Use.AS_A_SET if is_paired or inflation >= MIN_VARIANCE_INFLATION else Use.VAGUELY


def relative_half_width(c: Coefficient) -> float:
    """Return half the 95 % interval over the estimate; NaN where there is none, and of an angle or level about 0."""
    if c.lower is None or c.upper is None or c.estimate == 0.0 or c.is_level:
        return math.nan
    return 0.5 * (c.upper - c.lower) / abs(c.estimate)


def meaning_sentences(fit: Fit, content: Identifiability, uses: Sequence[CoefficientUse]) -> tuple[str, ...]:
    """Return what the identifiability means for predictions, for single values, and for what was assumed."""
    predictions = (
        "Predictions of manoeuvres like those recorded rest on combinations that are determined; others may not."
    )
    return tuple(text for text in (predictions, _single_values(uses), _assumptions(fit, content)) if text)


def _single_values(uses: Sequence[CoefficientUse]) -> str:
    names = {use: [row.name for row in uses if row.use is use] for use in Use}
    sentences = {
        Use.BY_ITSELF: "{} {are} known, with standard errors below 10 %.",
        Use.VAGUELY: "{} {are} known vaguely, with standard errors above 10 %.",
        Use.AS_A_SET: "{} {are} known together only: their errors depend on one another.",
        Use.FROM_PRIOR: "{} {are} as good as the prior: the records add next to nothing.",
        Use.SIGN_OPEN: "{} {have} an open sign.",
        Use.NO_INTERVAL: "{} {have} no interval.",
    }
    return " ".join(
        words.format(enumeration(names[use], MAX_NAMES), are="are" if len(names[use]) > 1 else "is",
                     have="have" if len(names[use]) > 1 else "has")
        for use, words in sentences.items() if names[use]
    )  # fmt: skip


def _assumptions(fit: Fit, content: Identifiability) -> str:
    tied = {name for symmetry in content.structural for name in symmetry.parameters}
    held = [c.name for c in fit.coefficients if c.fixed and c.name in tied]
    guessed = [c.name for c in fit.coefficients if c.is_unmeasured]
    sentences = []
    if held:
        sentences.append(f"No manoeuvre identifies {enumeration(held, MAX_NAMES)} apart from the others.")
    if guessed:
        are = "are" if len(guessed) > 1 else "is"
        sentences.append(f"{enumeration(guessed, MAX_NAMES)} {are} {NOT_MEASURED}.")
    is_open = {c.name for c in fit.coefficients if c.is_sign_open}
    moves = [(abs(x), c, n, x) for c in content.consequences for n, x in c.estimate_changes.items() if n not in is_open]
    if moves:
        _, worst, name, change = max(moves, key=lambda move: move[0])
        sentences.append(f"Changing {worst.parameter} by {signed_percent(worst.change)} would change {name} by "
                         f"{signed_percent(change)}.")  # fmt: skip
    return " ".join(sentences)
