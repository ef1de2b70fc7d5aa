"""Priors that the records contradict: the estimate lies many of their standard deviations away."""

from seatrial.core.text.numbers import significant
from seatrial.core.text.words import counted
from seatrial.core.values import Finding, Severity
from seatrial.estimation.estimate.fit import Estimation

REFUTED = 3.0
"""Distance of an estimate from its prior's mean, in the prior's standard deviations, from which on records and prior
disagree: of a normal prior one in 370 lies so far out by chance; chosen."""
_MOST_NAMED = 6  # that a message holds, the farthest first; chosen


def refuted_prior_findings(estimation: Estimation) -> tuple[Finding, ...]:
    """Return a warning `prior-refuted` with the priors that the estimate left, and by how far; else nothing."""
    distances = {
        p.name: abs(p.value - p.prior.mean) / p.prior.standard_deviation
        for p in estimation.model.parameters.free
        if p.prior is not None and p.prior.standard_deviation > 0.0
    }
    off = sorted((n for n, d in distances.items() if d > REFUTED), key=lambda n: -distances[n])
    if not off:
        return ()
    sizes = [f"{name} by {significant(distances[name], 2)}" for name in off[:_MOST_NAMED]]
    more = f", and {len(off) - len(sizes)} more" if len(off) > len(sizes) else ""
    return (Finding(
        Severity.WARNING, "prior-refuted",
        f"the records contradict the priors of {counted(len(off), 'coefficient')}",
        f"prior standard deviations from their means: {', '.join(sizes)}{more}",
        "check that the priors' source is of this ship, loading and scale, widen them under [model.priors], or free "
        "the term whose effect these coefficients may have taken; until then do not read them one by one",
        "intervals count each such prior as wrong by as much",
    ),)  # fmt: skip
