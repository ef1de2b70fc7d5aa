"""Snapshots nobody estimated: numbers that converge as they would, for the table and the page to show."""

from collections.abc import Iterator

import numpy as np

from seatrial.core.results.online import CoefficientChange, EstimatorPhase, SampleCounts, Snapshot
from seatrial.core.values import Finding, Severity

HEAVE_PITCH = {
    "a33": (1.42e5, "kg"), "b33": (2.31e5, "kg/s"), "a35": (-4.1e4, "kg m"), "b35": (6.3e5, "kg m/s"),
    "a55": (3.87e6, "kg m^2"), "b55": (8.8e6, "kg m^2/s"), "a53": (2.2e4, "kg m"), "b53": (-3.9e5, "kg m/s"),
}  # fmt: skip
MMG = {
    "X_vv": (-0.0423, "1"), "X_vr": (0.0021, "1"), "X_rr": (0.0113, "1"), "X_vvvv": (0.771, "1"), "Y_v": (-0.3151, "1"),
    "Y_r": (0.0832, "1"), "Y_vvv": (-1.607, "1"), "Y_vvr": (0.379, "1"), "Y_vrr": (-0.391, "1"), "Y_rrr": (0.008, "1"),
    "N_v": (-0.137, "1"), "N_r": (-0.049, "1"), "N_vvv": (-0.03, "1"), "N_vvr": (-0.294, "1"),
    "delta_0": (0.0175, "rad"),
}  # fmt: skip
CHANGE = CoefficientChange(220.0, (220.0, 220.0), 223.0, 31.2, "b33", {"b33": 2.31e5}, {"b33": 1e4})
ADVICE = "A zigzag 20/20 would tell Y_rrr and X_vr: both need a large yaw rate with little drift."


def heave_pitch(seconds: float, *, step: float = 0.5, seed: int = 3) -> Iterator[Snapshot]:
    """Eight coefficients in waves: waiting for 5 s, a window until a minute, then recursive."""
    yield from _converging_snapshots(HEAVE_PITCH, {"z": 0.0102, "theta": 3.6e-4}, seconds, step, seed)


def mmg(seconds: float, *, step: float = 0.5, seed: int = 4) -> Iterator[Snapshot]:
    """Fifteen manoeuvring coefficients, some of them not identified, one in degrees."""
    yield from _converging_snapshots(MMG, {"u": 0.021, "v": 0.018, "r": 0.0017, "psi": 0.0034}, seconds, step, seed)


def faulty_counts() -> SampleCounts:
    """Counts of a stream that is not quite what it should be."""
    last = "line 611: 'abc' is not a number in column 'theta'"
    return SampleCounts(accepted=6104, late=3, repeated=1, missing=12, garbled=2, checksum=4, last_problem=last)


def _converging_snapshots(
    coefficients: dict[str, tuple[float, str]], noise: dict[str, float], seconds: float, step: float, seed: int
) -> Iterator[Snapshot]:
    rng = np.random.default_rng(seed)
    truth = np.array([value for value, _ in coefficients.values()])
    hardness = 0.02 * rng.lognormal(0.0, 1.1, len(truth))
    error = rng.standard_normal(len(truth))
    for k in range(int(seconds / step) + 1):
        t = k * step
        error += -error * step / (t + 5.0) + rng.standard_normal(len(truth)) * np.sqrt(2.0 * step / (t + 5.0))
        share = hardness * np.sqrt(60.0 / (t + 1.0)) * (1.0 + 20.0 * np.exp(-t / 8.0))
        is_waiting, swell = t < 5.0, 1.0 + 0.3 * np.exp(-t / 20.0)
        standard_error = np.full(len(truth), np.inf) if is_waiting else share * np.abs(truth)
        value = truth * 0.6 if is_waiting else truth + error * standard_error
        untold = tuple(n for n, s, v in zip(coefficients, standard_error, value, strict=True) if s > 0.08 * abs(v))
        yield Snapshot(
            time=t,
            samples=10 * int(t * 1.0) + 1,
            runs=1,
            phase=EstimatorPhase.WAITING
            if is_waiting
            else EstimatorPhase.WINDOW
            if t < 60.0
            else EstimatorPhase.RECURSIVE,
            names=tuple(coefficients),
            units=tuple(unit for _, unit in coefficients.values()),
            value=value,
            standard_error=standard_error,
            noise={} if is_waiting else {n: s * swell * rng.normal(1.0, 0.01) for n, s in noise.items()},
            unidentified=untold,
            advice=ADVICE if untold else "",
            change=CHANGE if t > 280.0 else None,
            findings=FINDINGS if t > 20 else (),
        )


FINDINGS = (
    Finding(Severity.INFO, "white", "The residuals of theta are white", "p 0.41"),
    Finding(Severity.WARNING, "coloured", "The residuals of z are coloured", "lag-1 correlation 0.31",
            "Take the intervals as lower limits."),
)  # fmt: skip
