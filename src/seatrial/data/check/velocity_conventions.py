"""Velocities against the derivative of position: frame, sign, unit; the declared reading against the best."""

import math
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.values import Finding, Severity, TrialEdit
from seatrial.data.check.consequences import REVERSED
from seatrial.data.check.motion import DOUBTFUL_RATIO, PositionReading, RecordedMotion, VelocityConvention

# factor by which another convention must reduce the misfit to be certain; chosen
CERTAIN_RATIO = 3.0
# rms difference from the track over rms speed that is acceptable, rough, and negligible; chosen
ACCEPTABLE_MISFIT, ROUGH_MISFIT, NEGLIGIBLE_MISFIT = 0.3, 0.1, 0.03
# misfit over that of the noise of the positions, up to which a slow craft shows nothing; chosen
NOISE_FACTOR = 2.0
# departure of a factor on the speed from another, relative, up to which they are the same; chosen: units differ by more
SAME_SCALE = 0.1
# heading [rad] by which psi must be off before that is said here; chosen: smaller ones show in closure
LARGE_OFFSET = math.radians(15.0)
# factor from the number in the file, taken as m/s, to the true m/s (SI brochure 2019; 1 kn = 1852 m/h), what to write
_SPEED_UNITS = {
    "in knots": (1852.0 / 3600.0, 'unit = "kn"'),
    "in km/h": (1.0 / 3.6, 'unit = "km/h"'),
    "in mm/s": (1e-3, "scale = 0.001"),
    "in m/s although declared in knots": (3600.0 / 1852.0, 'unit = "m/s"'),
    "in m/s although declared in km/h": (3.6, 'unit = "m/s"'),
}


def velocity_convention_findings(motion: RecordedMotion) -> tuple[Finding, ...]:
    """Findings on u, v and psi of a record; none where it stays at one place."""
    if np.ptp(motion.record["x0"]) + np.ptp(motion.record["y0"]) == 0:
        return ()
    best = motion.best_reading
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
        return self.motion.is_refuted and self.declared_misfit > max(least, ratio * self.best_misfit)

    def finding(
        self, severity: Severity, code: str, text: str, advice: str, edits: tuple[TrialEdit, ...] = ()
    ) -> Finding:
        """Return a finding whose evidence are the misfits."""
        evidence = (
            f"rms misfit with the derivative of position {self.declared_misfit:.1%} as declared, "
            f"{self.best_misfit:.1%} otherwise"
        )
        return Finding(severity, code, f"record '{self.motion.record.name}': {text}", evidence, advice, edits=edits)


def _comparison_findings(comparison: _Comparison) -> list[Finding]:
    best, motion = comparison.best, comparison.motion
    angle, misfit = motion.heading_offset() if motion.frame == "body" else (0.0, np.inf)
    if abs(angle) > LARGE_OFFSET and misfit * CERTAIN_RATIO < comparison.best_misfit:
        return [_heading_offset_finding(comparison, angle, misfit)]
    if comparison.best_misfit > max(ACCEPTABLE_MISFIT, NOISE_FACTOR * motion.noise_misfit):
        text = "u, v fit the derivative of position in no frame"
        advice = "check columns, units and noise of positions and velocities"
        return [comparison.finding(Severity.WARNING, "velocity-frame", text, advice)]
    findings = _speed_unit_findings(motion, best)
    if comparison.is_better_by(CERTAIN_RATIO, NEGLIGIBLE_MISFIT):
        return [*_contradiction_findings(comparison), *findings]
    if comparison.is_better_by(DOUBTFUL_RATIO, ROUGH_MISFIT):
        doubts = _contradiction_findings(comparison)
        readings = "; ".join(doubt.message.partition(": ")[2] for doubt in doubts)
        text = f"another reading fits the position better: {readings}"
        advice = "check frame, sign and unit of u, v and psi"
        return [comparison.finding(Severity.WARNING, doubts[0].code, text, advice), *findings]
    return findings


def _heading_offset_finding(comparison: _Comparison, angle: float, misfit: float) -> Finding:
    turned = replace(comparison, best_misfit=misfit)
    text = f"psi is off by {math.degrees(angle):+.1f} deg: a misaligned compass, a magnetic variation, or another zero"
    edit = TrialEdit("channels.psi.offset", f"{angle:.6g}", "rad")
    return turned.finding(Severity.ERROR, "heading-zero", text, "", (edit,))


def _contradiction_findings(comparison: _Comparison) -> list[Finding]:
    motion, best = comparison.motion, comparison.best
    statements = (*_position_statements(best), *_velocity_statements(motion, best), *_heading_statements(best))
    return [comparison.finding(Severity.ERROR, code, text, "", edits) for code, text, edits in statements]


_Statement = tuple[str, str, tuple[TrialEdit, ...]]  # code, text, edits of a finding


def _position_statements(best: VelocityConvention) -> list[_Statement]:
    match best.position:
        case PositionReading.EXCHANGED:
            edit = TrialEdit("channels.x0", exchanged_with="channels.y0")
            return [("position-axes", "x0 and y0 are exchanged (x0 counts to the east)", (edit,))]
        case PositionReading.REVERSED_EAST:
            return [("position-sign", "y0 has the opposite sign", (_reversed("y0"),))]
        case _:
            return []


def _velocity_statements(motion: RecordedMotion, best: VelocityConvention) -> list[_Statement]:
    record, statements = motion.record, list[_Statement]()
    if best.is_exchanged:
        edit = TrialEdit("channels.u", exchanged_with="channels.v")
        statements.append(("velocity-axes", "u and v are exchanged", (edit,)))
    if best.frame != motion.frame:
        labels = ", ".join(f"'{record.channel(s).label or s}'" for s in ("u", "v"))
        words = {"earth": "earth-fixed (north, east)", "body": "the ship's own (surge, sway)"}[best.frame]
        text = f"u, v ({labels}) are {words} velocities, not '{motion.frame}' as declared"
        edits = tuple(TrialEdit(f"channels.{s}.frame", f'"{best.frame}"') for s in ("u", "v"))
        statements.append(("velocity-frame", text, edits))
    if best.v_sign < 0:
        statements.append(("velocity-sign", "v has the opposite sign", (_reversed("v"),)))
    return statements


def _heading_statements(best: VelocityConvention) -> list[_Statement]:
    if best.psi_from_east:
        edit = TrialEdit("channels.psi.frame", '"enu"')
        return [("heading-zero", "psi counts from east, counter-clockwise, not from north", (edit,))]
    if best.psi_factor == -1.0:
        return [("heading-sign", "psi turns the other way", (_reversed("psi"),))]
    if best.psi_factor != 1.0:
        wrong, right = ("radians", "degrees") if best.psi_factor < 1.0 else ("degrees", "radians")
        edit = TrialEdit("channels.psi.unit", f'"{right[:3]}"')
        return [("angle-unit", f"psi is in {right}, not in {wrong}", (edit,))]
    return []


def _reversed(symbol: str) -> TrialEdit:
    return TrialEdit(f"channels.{symbol}.positive", REVERSED)


def _speed_unit_findings(motion: RecordedMotion, best: VelocityConvention) -> list[Finding]:
    k = motion.speed_scale(best)
    if k <= 0 or abs(k - 1.0) < SAME_SCALE:
        return []
    unit, (factor, key_value) = min(_SPEED_UNITS.items(), key=lambda item: abs(math.log(k / item[1][0])))
    name, evidence = f"record '{motion.record.name}'", f"derivative of position is {k:.3g} times the velocity"
    if abs(math.log(k / factor)) < SAME_SCALE:
        key, value = key_value.split(" = ")
        edits = tuple(TrialEdit(f"channels.{symbol}.{key}", value) for symbol in ("u", "v"))
        return [Finding(Severity.ERROR, "speed-unit", f"{name}: u, v are {unit}", evidence, edits=edits)]
    advice = "check units, the scale of the log, and whether the speed is through water"
    text = f"{name}: u, v and the positions differ in scale"
    return [Finding(Severity.WARNING, "speed-scale", text, evidence, advice)]
