"""Time constants that are estimated below the step of the records: what happens between two samples is not seen."""

from seatrial.core.text.numbers import significant
from seatrial.core.values import Finding, Severity
from seatrial.estimation.estimate.fit import Estimation

_SECONDS = "s"  # unit of time constants and delays


def short_time_constant_findings(estimation: Estimation) -> tuple[Finding, ...]:
    """Return a note `short-time-constant` on those free coefficients in s that are below the step; else nothing."""
    step, parameters = estimation.estimate.problem.data.dt, estimation.model.parameters
    short = [p for p in parameters.free if p.unit == _SECONDS and p.value < step]
    if not short:
        return ()
    names = " and ".join(p.name for p in short)
    sizes = ", ".join(f"{p.name} {significant(p.value, 2)} s" for p in short)
    verb = "is" if len(short) == 1 else "are"
    return (Finding(
        Severity.INFO, "short-time-constant", f"{names} {verb} below the step of the records",
        f"{sizes}; a sample every {significant(step, 2)} s",
        "take it as shorter than a sample; where a controller needs more, log commands and motion at a higher rate",
        "it is not distinguishable from a delay of the logged commands",
    ),)  # fmt: skip
