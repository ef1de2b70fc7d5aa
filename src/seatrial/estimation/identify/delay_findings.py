"""Delays of inputs that are longer than what their sample interval leaves open: the recorder's, or the model's."""

from seatrial.core.text.numbers import significant
from seatrial.core.text.words import NAMES_SHOWN, enumeration
from seatrial.core.values import Finding, Severity
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.timing import UNIFORM

_CERTAIN = 2.0  # standard errors by which a delay has to exceed a sample, 95 %


def delay_findings(estimation: Estimation) -> tuple[Finding, ...]:
    """Return a warning `input-delay` for each input whose estimated delay exceeds its sample interval in a session."""
    problem, error = estimation.estimate.problem, estimation.interval.standard_error
    first, width = len(problem.session_parameters), problem.unknowns_per_session
    found = []
    for j, nuisance in enumerate(problem.nuisances, start=first):
        if nuisance.correction.kind != "delay":
            continue
        sample = UNIFORM * nuisance.prior.standard_deviation if nuisance.is_spread_fixed else problem.data.dt
        delays = estimation.estimate.session_offsets[:, j]
        errors = error[len(problem.free) :].reshape(-1, width)[:, j]
        late = {
            s: float(d)
            for s, d, e in zip(problem.data.sessions, delays, errors, strict=True)
            if abs(d) - _CERTAIN * e > sample
        }
        if late:
            found.append(_finding(nuisance.correction.input, late, sample))
    return tuple(found)


def _finding(name: str, delays: dict[str, float], sample: float) -> Finding:
    longest = max(delays.values(), key=abs)
    sizes = enumeration([f"{significant(d, 2)} s in {s}" for s, d in delays.items()], NAMES_SHOWN)
    way = "after" if longest > 0.0 else "before"
    return Finding(
        Severity.WARNING, "input-delay", f"{name} acts more than a sample {way} its record",
        f"{sizes}; a sample every {significant(sample, 2)} s",
        "compare the clocks of the recorders; with one clock, model the lag of the machinery or of a sensor",
        "the recorder's stamps are off, or the model lacks a lag; coefficients absorb the rest of it",
    )  # fmt: skip
