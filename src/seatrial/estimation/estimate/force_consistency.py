"""Whether static force points and records describe the same ship."""

import numpy as np

from seatrial.core.values import Finding, Severity
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.problem.static_forces import StaticForces

# rms residual in standard deviations beyond which points disagree, ours
_MAX_RMS = 2.0


def force_consistency(estimate: PointEstimate) -> tuple[Finding, ...]:
    """For each table of points the rms of its residuals at the estimate, in the stated standard deviations.

    About 1 where the points, their stated noise and the records go together; above 2 a warning `force-misfit`.
    """
    problem = estimate.problem
    values = problem.model.parameters.values
    values[[problem.model.parameters.index(n) for n in problem.free]] = estimate.common_parameters[: len(problem.free)]
    findings = []
    for table in problem.extra_terms:
        if isinstance(table, StaticForces):
            rms = {f: float(np.sqrt(np.nanmean(gap**2))) for f, gap in table.residuals(values).items()}
            findings.append(_force_finding(table, rms))
    return tuple(findings)


def _force_finding(table: StaticForces, rms: dict[str, float]) -> Finding:
    points = table.points
    evidence = "rms residual in standard deviations: " + ", ".join(f"{f} {value:.2g}" for f, value in rms.items())
    if max(rms.values()) <= _MAX_RMS:
        what = f"{points.count} forces of '{points.name}' are fitted with the records"
        return Finding(Severity.INFO, "force-points", what, evidence)
    what = f"the forces of '{points.name}' disagree with the model or the records by more than their stated noise"
    advice = "check their signs, origin, scale and what they include; state a larger sd, or free more coefficients"
    return Finding(Severity.WARNING, "force-misfit", what, evidence, advice)
