"""Velocities against the derivative of position: frame, sign, unit; the declared reading against the best."""

import math
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Finding, Severity
from seatrial.data.check.motion import RecordedMotion, VelocityConvention

# factors by which another convention must reduce the misfit to be certain, or possible; chosen
CERTAIN_RATIO, DOUBTFUL_RATIO = 3.0, 1.5
# rms difference from the track over rms speed that is acceptable, rough, and negligible; chosen
ACCEPTABLE_MISFIT, ROUGH_MISFIT, NEGLIGIBLE_MISFIT = 0.3, 0.1, 0.03
# departure of a factor on the speed from another, relative, up to which they are the same; chosen: units differ by more
SAME_SCALE = 0.1
# factor from the number in the file, taken as m/s, to the true m/s (SI brochure 2019; 1 kn = 1852 m/h)
_SPEED_UNITS = {
    "in knots": 1852.0 / 3600.0,
    "in km/h": 1.0 / 3.6,
    "in mm/s": 1e-3,
    "in m/s although declared in knots": 3600.0 / 1852.0,
    "in m/s although declared in km/h": 3.6,
}


def velocity_convention_findings(motion: RecordedMotion) -> tuple[Finding, ...]:
    """Findings on u, v and psi of a record; none where it stays at one place."""
    if np.ptp(motion.record["x0"]) + np.ptp(motion.record["y0"]) == 0:
        return ()
    best = best_convention(motion)
    comparison = _Comparison(motion, best, motion.misfit(motion.conventions[0]), motion.misfit(best))
    return tuple(_comparison_findings(comparison))


@dataclass(frozen=True)
class _Comparison:
    """The declared reading of a motion and the best one, with their misfits."""

    motion: RecordedMotion
    best: VelocityConvention
    declared_misfit: float
    best_misfit: float

    def is_better_by(self, ratio: float, least: float) -> bool:
        """Return whether the best reading departs from the declared one, which is worse than `least` and by `ratio`."""
        return self.best.changes > 0 and self.declared_misfit > max(least, ratio * self.best_misfit)

    def finding(self, severity: Severity, code: str, text: str, advice: str) -> Finding:
        """Return a finding whose evidence are the misfits."""
        evidence = (
            f"rms misfit with the derivative of position {self.declared_misfit:.1%} as declared, "
            f"{self.best_misfit:.1%} otherwise"
        )
        return Finding(severity, code, f"record '{self.motion.record.name}': {text}", evidence, advice)


def _comparison_findings(comparison: _Comparison) -> list[Finding]:
    best = comparison.best
    if comparison.best_misfit > ACCEPTABLE_MISFIT:
        text = "u, v fit the derivative of position in no frame"
        advice = "check columns, units and noise of positions and velocities"
        return [comparison.finding(Severity.WARNING, "velocity-frame", text, advice)]
    findings = _speed_unit_findings(comparison.motion, best)
    if comparison.is_better_by(CERTAIN_RATIO, NEGLIGIBLE_MISFIT):
        return [*_contradiction_findings(comparison), *findings]
    if comparison.is_better_by(DOUBTFUL_RATIO, ROUGH_MISFIT):
        text = (
            f"another reading of u, v, psi fits the position better ({best.frame}-fixed, v times {best.v_sign:+.0f}, "
            f"psi times {best.psi_factor:.3g})"
        )
        advice = "check frame, sign and unit of u, v and psi"
        return [comparison.finding(Severity.WARNING, "velocity-frame", text, advice), *findings]
    return findings


def best_convention(motion: RecordedMotion) -> VelocityConvention:
    """Return the reading that fits best; each further change must pay with a misfit smaller by half."""
    least = 1e-6  # misfit below which readings are alike; chosen: rounding
    return min(motion.conventions, key=lambda r: max(motion.misfit(r), least) * DOUBTFUL_RATIO**r.changes)


def _contradiction_findings(comparison: _Comparison) -> list[Finding]:
    record, best, findings = comparison.motion.record, comparison.best, list[tuple[str, str, str]]()
    if best.frame != comparison.motion.frame:
        labels = ", ".join(f"'{record.channel(s).label or s}'" for s in ("u", "v"))
        words = {"earth": "earth-fixed (north, east)", "body": "the ship's own (surge, sway)"}[best.frame]
        text = f"u, v ({labels}) are {words} velocities, not '{comparison.motion.frame}' as declared"
        findings.append(("velocity-frame", text, f'declare frame = "{best.frame}" for u and v'))
    if best.v_sign < 0:
        is_earth_fixed = record.channel("v").frame == "earth"
        side = "west" if is_earth_fixed else "the other side (port instead of starboard)"
        findings.append(("velocity-sign", "v has the opposite sign", f'declare positive = "{side}" for v'))
    if best.psi_factor == -1.0:
        findings.append(("heading-sign", "psi turns the other way", "declare the opposite positive direction for psi"))
    elif best.psi_factor != 1.0:
        is_degrees = best.psi_factor < 1.0
        wrong, right = ("radians", "degrees") if is_degrees else ("degrees", "radians")
        unit = "deg" if is_degrees else "rad"
        findings.append(("angle-unit", f"psi is in {right}, not in {wrong}", f'declare unit = "{unit}" for psi'))
    return [comparison.finding(Severity.ERROR, code, text, advice) for code, text, advice in findings]


def _speed_unit_findings(motion: RecordedMotion, best: VelocityConvention) -> list[Finding]:
    k = motion.speed_scale(best)
    if k <= 0 or abs(k - 1.0) < SAME_SCALE:
        return []
    unit, factor = min(_SPEED_UNITS.items(), key=lambda item: abs(math.log(k / item[1])))
    name, evidence = f"record '{motion.record.name}'", f"derivative of position is {k:.3g} times the velocity"
    if abs(math.log(k / factor)) < SAME_SCALE:
        advice = "correct the unit of u and v"
        return [Finding(Severity.ERROR, "speed-unit", f"{name}: u, v are {unit}", evidence, advice)]
    advice = "check units, the scale of the log, and whether the speed is through water"
    text = f"{name}: u, v and the positions differ in scale"
    return [Finding(Severity.WARNING, "speed-unit", text, evidence, advice)]
