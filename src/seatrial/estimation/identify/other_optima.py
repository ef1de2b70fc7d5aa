"""What searches from several starting points say of the estimate: optima that are as good, and better ones."""

import numpy as np

from seatrial.core.values import Finding, Severity
from seatrial.estimation.estimate import Estimation

_AS_GOOD = 2.0
"""Loss above the lowest (negative log-likelihood) up to which records hardly distinguish two optima; chosen: about the
95 % limit of one coefficient, half of 3.84."""
_APART = 3.0
"""Standard errors by which some coefficient differs at another optimum; chosen."""


def other_optima(estimation: Estimation) -> list[Finding]:
    """Return findings on ends of the search that explain the records as well with other coefficients.

    Ends are compared with the best one: where the criterion is another than that of the search, the estimate went on.
    """
    problem, errors = estimation.estimate.problem, estimation.interval.standard_error
    findings = []
    for attempt in estimation.search_attempts[1:]:
        if attempt.loss > _AS_GOOD:
            continue
        point = [estimation.search_attempts[0].values[name] for name in problem.free]
        apart = np.array([attempt.values[name] - point[i] for i, name in enumerate(problem.free)])
        ratio = np.abs(apart) / np.maximum(errors[: len(apart)], np.finfo(float).tiny)
        worst = int(np.argmax(ratio))
        if ratio[worst] > _APART:
            name = problem.free[worst]
            findings.append(Finding(
                Severity.WARNING, "equal-optimum", f"other coefficients explain the records as well: {name} = "
                f"{attempt.values[name]:.3g} instead of {point[worst]:.3g}",
                f"search from {attempt.origin}: loss {attempt.loss:.2g} above the lowest",
                "give a prior or a bound by what is known of the craft, or a manoeuvre that distinguishes them",
            ))  # fmt: skip
    return findings
