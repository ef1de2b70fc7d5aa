"""Velocities against the derivative of position: frame, sign, unit; the declared reading against the best."""

import math

import numpy as np

from seatrial.core.values import Finding, Record, Severity
from seatrial.data.check.motion import RecordedMotion, VelocityConvention, recorded_motion

# factors by which another convention must reduce the misfit to be certain, or possible, ours
CERTAIN_RATIO, DOUBTFUL_RATIO = 3.0, 1.5
# rms difference from the track over rms speed that is acceptable, and negligible, ours
ACCEPTABLE_MISFIT, NEGLIGIBLE_MISFIT = 0.3, 0.03
# factor from the number in the file, taken as m/s, to the true m/s (SI brochure 2019; 1 kn = 1852 m/h)
_SPEED_UNITS = {
    "in knots": 1852.0 / 3600.0,
    "in km/h": 1.0 / 3.6,
    "in mm/s": 1e-3,
    "in m/s although declared in knots": 3600.0 / 1852.0,
    "in m/s although declared in km/h": 3.6,
}


def velocity_convention_findings(record: Record) -> tuple[Finding, ...]:
    """Findings on u, v and psi of a clean, signed record; none where positions or velocities are missing."""
    motion = recorded_motion(record)
    if motion is None or np.ptp(motion.x) + np.ptp(motion.y) == 0:
        return ()
    declared = motion.conventions[0]
    best = best_convention(motion)
    declared_misfit, reached = motion.misfit(declared), motion.misfit(best)
    if reached > ACCEPTABLE_MISFIT:
        return (_no_convention_finding(record, declared_misfit, reached),)
    findings = []
    if best.changes and declared_misfit > NEGLIGIBLE_MISFIT and declared_misfit > CERTAIN_RATIO * reached:
        findings += _contradiction_findings(record, motion, best, declared_misfit, reached)
    elif best.changes and declared_misfit > 0.1 and declared_misfit > DOUBTFUL_RATIO * reached:
        findings.append(_doubtful_convention_finding(record, best, declared_misfit, reached))
    return (*findings, *_speed_unit_findings(record, motion, best))


def best_convention(motion: RecordedMotion) -> VelocityConvention:
    """The reading that fits best; each further change must pay with a misfit smaller by half."""
    return min(motion.conventions, key=lambda r: max(motion.misfit(r), 1e-6) * DOUBTFUL_RATIO**r.changes)


def _misfit_text(declared_misfit: float, best_misfit: float) -> str:
    return f"rms misfit with the derivative of position {declared_misfit:.1%} as declared, {best_misfit:.1%} otherwise"


def _velocity_labels(record: Record) -> str:
    return ", ".join(f"'{record.channel(s).label or s}'" for s in ("u", "v"))


def _contradiction_findings(
    record: Record, motion: RecordedMotion, best: VelocityConvention, declared_misfit: float, best_misfit: float
) -> list[Finding]:
    findings: list[tuple[str, str, str]] = []
    if best.frame != motion.frame:
        words = {"earth": "earth-fixed (north, east)", "body": "the ship's own (surge, sway)"}
        findings.append(
            (
                "velocity-frame",
                f"u, v ({_velocity_labels(record)}) are {words[best.frame]} velocities, not "
                f"'{motion.frame}' as declared",
                f'declare frame = "{best.frame}" for u and v',
            )
        )
    if best.v_sign < 0:
        findings.append(
            ("velocity-sign", "v has the opposite sign", f'declare positive = "{_opposite_direction(record)}" for v')
        )
    if best.psi_factor == -1.0:
        findings.append(("heading-sign", "psi turns the other way", "declare the opposite positive direction for psi"))
    elif best.psi_factor != 1.0:
        is_degrees = best.psi_factor < 1.0
        wrong, right = ("radians", "degrees") if is_degrees else ("degrees", "radians")
        unit = "deg" if is_degrees else "rad"
        findings.append(("angle-unit", f"psi is in {right}, not in {wrong}", f'declare unit = "{unit}" for psi'))
    return [
        Finding(
            Severity.ERROR, code, f"record '{record.name}': {what}", _misfit_text(declared_misfit, best_misfit), advice
        )
        for code, what, advice in findings
    ]


def _opposite_direction(record: Record) -> str:
    """The positive direction v should have been declared with, seen from the signed record."""
    return "west" if record.channel("v").frame == "earth" else "the other side (port instead of starboard)"


def _doubtful_convention_finding(
    record: Record, best: VelocityConvention, declared_misfit: float, best_misfit: float
) -> Finding:
    return Finding(
        Severity.WARNING,
        "velocity-frame",
        f"record '{record.name}': another reading of u, v, psi fits the position better ({best.frame}-fixed, "
        f"v times {best.v_sign:+.0f}, psi times {best.psi_factor:.3g})",
        _misfit_text(declared_misfit, best_misfit),
        "check frame, sign and unit of u, v and psi",
    )


def _no_convention_finding(record: Record, declared_misfit: float, best_misfit: float) -> Finding:
    return Finding(
        Severity.WARNING,
        "velocity-frame",
        f"record '{record.name}': u, v fit the derivative of position in no frame",
        _misfit_text(declared_misfit, best_misfit),
        "check columns, units and noise of positions and velocities",
    )


def _speed_unit_findings(record: Record, motion: RecordedMotion, best: VelocityConvention) -> list[Finding]:
    k = motion.speed_scale(best)
    if k <= 0 or abs(k - 1.0) < 0.1:
        return []
    unit, factor = min(_SPEED_UNITS.items(), key=lambda item: abs(math.log(k / item[1])))
    evidence = f"derivative of position is {k:.3g} times the velocity"
    if abs(math.log(k / factor)) < 0.1:
        what = f"record '{record.name}': u, v are {unit}"
        return [Finding(Severity.ERROR, "speed-unit", what, evidence, "correct the unit of u and v")]
    return [
        Finding(
            Severity.WARNING,
            "speed-unit",
            f"record '{record.name}': u, v and the positions differ in scale",
            evidence,
            "check units, the scale of the log, and whether the speed is through water",
        )
    ]
