"""The disturbances that were compared: one row each, as users of continuous-time stochastic models know it."""

from collections.abc import Sequence
from dataclasses import dataclass

from seatrial.core.results import DisturbanceCandidate
from seatrial.core.text.numbers import fixed, p_value, significant

# decimal places of log-likelihoods: differences below a tenth decide nothing
_LIKELIHOOD_PLACES = 1
# the same of ratios of errors
_RATIO_PLACES = 2


@dataclass(frozen=True)
class DisturbanceRow:
    """One candidate in words; `ratio` against the first one, `critical` what chance gives once in a thousand."""

    name: str
    parameters: str
    log_likelihood: str
    degrees_of_freedom: int
    ratio: str
    critical: str
    whiteness: str
    left_out: str
    is_chosen: bool


def disturbance_rows(candidates: Sequence[DisturbanceCandidate]) -> tuple[DisturbanceRow, ...]:
    """Return the table of candidates, the simplest first."""
    return tuple(_row(c) for c in candidates)


def _row(c: DisturbanceCandidate) -> DisturbanceRow:
    has_ratio = c.critical_ratio > 0.0
    return DisturbanceRow(
        name=c.name,
        parameters=", ".join(f"{name} {significant(value, 2)}" for name, value in c.parameters.items()),
        log_likelihood=fixed(c.log_likelihood, _LIKELIHOOD_PLACES),
        degrees_of_freedom=c.degrees_of_freedom,
        ratio=fixed(c.likelihood_ratio, _LIKELIHOOD_PLACES) if has_ratio else "",
        critical=fixed(c.critical_ratio, _LIKELIHOOD_PLACES) if has_ratio else "",
        whiteness=f"{'white' if c.is_white else 'not white'}, {p_value(c.whiteness_p)}",
        left_out="" if c.left_out_error is None else fixed(c.left_out_error, _RATIO_PLACES),
        is_chosen=c.is_chosen,
    )
