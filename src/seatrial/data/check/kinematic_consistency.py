"""Integrated velocity against position over the whole record: the place where wrong points show."""

from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, Finding, Record, Severity
from seatrial.data.check.motion import RecordedMotion, recorded_motion
from seatrial.data.check.signal import cumulative_integral, least_squares, sample_noise
from seatrial.data.check.velocity_conventions import best_convention

# factors by which another reading must reduce the residual to be certain, or possible, ours
CERTAIN_GAIN, DOUBTFUL_GAIN = 4.0, 2.0
# residuals over path length that are negligible, and large; multiple of the noise that is tolerated, ours
MIN_RELATIVE_ERROR, LARGE_RELATIVE_ERROR, NOISE_FACTOR = 1e-4, 3e-3, 1.5


@dataclass(frozen=True)
class ErrorCause:
    """A single cause that would explain a closure error, and the rms it leaves [m]."""

    name: str
    text: str
    advice: str
    coefficients: tuple[float, ...]
    residual_rms: float


def kinematic_consistency_findings(record: Record) -> tuple[Finding, ...]:
    """A finding where a clean, signed record does not close; none where the declared reading is already refuted."""
    motion = recorded_motion(record)
    if motion is None or motion.path_length == 0 or best_convention(motion).changes:
        return ()
    error = consistency_error(motion)
    rms = float(np.sqrt(np.mean(error**2))) * np.sqrt(2.0)
    ranked = sorted(candidate_causes(motion, error), key=lambda e: e.residual_rms)
    best, second = ranked[0], ranked[1]
    gain = rms / max(best.residual_rms, 1e-12)
    noise = float(np.hypot(sample_noise(motion.x), sample_noise(motion.y)))
    if rms < MIN_RELATIVE_ERROR * motion.path_length or (
        gain < DOUBTFUL_GAIN and rms < max(LARGE_RELATIVE_ERROR * motion.path_length, NOISE_FACTOR * noise)
    ):
        return ()
    named = gain >= DOUBTFUL_GAIN
    is_certain = (
        best.name == "point" and gain > CERTAIN_GAIN and second.residual_rms > DOUBTFUL_GAIN * best.residual_rms
    )
    return (
        Finding(
            Severity.ERROR if is_certain else Severity.WARNING,
            "closure",
            f"record '{record.name}': integrated velocity leaves the position"
            + (f"; {best.text} would explain it" if named else ""),
            f"{rms:.3g} m rms over {motion.path_length:.4g} m travelled"
            + (f", {best.residual_rms:.3g} m with it, {second.residual_rms:.3g} m with {second.text}" if named else ""),
            best.advice if named else "check frame, reference point, lag and bias of u, v against the positions",
        ),
    )


def consistency_error(motion: RecordedMotion) -> Array:
    """Integrated velocity minus position, each from its mean; north then east, shape (2 n,) [m]."""
    north, east = motion.velocity(motion.conventions[0])
    parts = (cumulative_integral(north, motion.dt) - motion.x, cumulative_integral(east, motion.dt) - motion.y)
    return np.concatenate([part - part.mean() for part in parts])


def candidate_causes(motion: RecordedMotion, error: Array) -> list[ErrorCause]:
    """Each single cause fitted to the closure error by least squares, the integration constants with it.

    point: velocities of a point d ahead of the position's add d (cos psi, sin psi); lag tau: -tau times the velocity;
    current or bias: grows with time; misalignment a of heading or log: a (-y, x) of the track; scale: the track.
    """
    north, east = motion.velocity(motion.conventions[0])
    x, y = cumulative_integral(north, motion.dt), cumulative_integral(east, motion.dt)
    zero, t = np.zeros_like(x), motion.time - motion.time[0]
    causes = {
        "point": [np.concatenate([np.cos(motion.psi), np.sin(motion.psi)])],
        "lag": [-np.concatenate([north, east])],
        "drift": [np.concatenate([t, zero]), np.concatenate([zero, t])],
        "misalignment": [np.concatenate([-y, x])],
        "scale": [np.concatenate([x, y])],
    }
    constants = [np.concatenate([zero + 1, zero]), np.concatenate([zero, zero + 1])]
    found = []
    for name, features in causes.items():
        answer, rms = least_squares(np.stack([*constants, *features], axis=1), error)
        value = tuple(float(a) for a in answer[2:])
        found.append(ErrorCause(name, *_cause_text(name, value), value, rms * np.sqrt(2.0)))
    return found


def _cause_text(name: str, coefficients: tuple[float, ...]) -> tuple[str, str]:
    match name:
        case "point":
            return (
                f"velocities referred to a point {coefficients[0]:+.3g} m ahead of the positions' point",
                "correct reference_point of u, v or of x0, y0",
            )
        case "lag":
            return f"a lag of {coefficients[0]:.2g} s of the velocities", "shift u, v by the lag, or estimate it"
        case "drift":
            return (
                f"a current or velocity bias of {np.hypot(coefficients[0], coefficients[1]):.3g} m/s",
                "if the speed is through water, estimate a current for the run",
            )
        case "misalignment":
            return (
                f"a misalignment of {np.degrees(coefficients[0]):+.2g} deg between heading and log",
                "check the zero of the compass",
            )
        case _:
            return f"a scale error of {coefficients[0]:+.2%} of the velocities", "check the calibration of the log"
