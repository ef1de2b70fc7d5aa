"""Integrated velocity against position over the whole record: the place where wrong points show."""

from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, Finding, Severity
from seatrial.data.check.motion import RecordedMotion
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


def kinematic_consistency_findings(motion: RecordedMotion) -> tuple[Finding, ...]:
    """A finding where a record does not close; none where the declared reading is already refuted."""
    record = motion.record
    if motion.path_length == 0 or best_convention(motion).changes:
        return ()
    error = consistency_error(motion)
    rms = float(np.sqrt(np.mean(error**2))) * np.sqrt(2.0)
    ranked = sorted(candidate_causes(motion, error), key=lambda e: e.residual_rms)
    best, second = ranked[0], ranked[1]
    gain = rms / max(best.residual_rms, 1e-12)  # above zero, for a division
    noise = float(np.hypot(sample_noise(record["x0"]), sample_noise(record["y0"])))
    if rms < MIN_RELATIVE_ERROR * motion.path_length or (
        gain < DOUBTFUL_GAIN and rms < max(LARGE_RELATIVE_ERROR * motion.path_length, NOISE_FACTOR * noise)
    ):
        return ()
    message = f"record '{record.name}': integrated velocity leaves the position"
    evidence = f"{rms:.3g} m rms over {motion.path_length:.4g} m travelled"
    if gain < DOUBTFUL_GAIN:
        advice = "check frame, reference point, lag and bias of u, v against the positions"
        return (Finding(Severity.WARNING, "closure", message, evidence, advice),)
    message += f"; {best.text} would explain it"
    evidence += f", {best.residual_rms:.3g} m with it, {second.residual_rms:.3g} m with {second.text}"
    is_alone = second.residual_rms > DOUBTFUL_GAIN * best.residual_rms
    is_certain = best.name == "point" and gain > CERTAIN_GAIN and is_alone
    return (Finding(Severity.ERROR if is_certain else Severity.WARNING, "closure", message, evidence, best.advice),)


def consistency_error(motion: RecordedMotion) -> Array:
    """Integrated velocity minus position, each from its mean; north then east, shape (2 n,) [m]."""
    x, y = _integrated_velocity(motion)
    return np.concatenate([part - part.mean() for part in (x - motion.record["x0"], y - motion.record["y0"])])


def _integrated_velocity(motion: RecordedMotion) -> tuple[Array, Array]:
    north, east = motion.velocity(motion.conventions[0])
    return cumulative_integral(north, motion.record.dt), cumulative_integral(east, motion.record.dt)


def candidate_causes(motion: RecordedMotion, error: Array) -> list[ErrorCause]:
    """Each single cause fitted to the closure error by least squares, the integration constants with it.

    point: velocities of a point d ahead of the position's add d (cos psi, sin psi); lag tau: -tau times the velocity;
    current or bias: grows with time; misalignment a of heading or log: a (-y, x) of the track; scale: the track.
    """
    x, y = _integrated_velocity(motion)
    zero, t, psi = np.zeros_like(x), motion.record.time - motion.record.time[0], motion.record["psi"]
    causes = {
        "point": [np.concatenate([np.cos(psi), np.sin(psi)])],
        "lag": [-np.concatenate(motion.velocity(motion.conventions[0]))],
        "drift": [np.concatenate([t, zero]), np.concatenate([zero, t])],
        "misalignment": [np.concatenate([-y, x])],
        "scale": [np.concatenate([x, y])],
    }
    constants = [np.concatenate([zero + 1, zero]), np.concatenate([zero, zero + 1])]
    fitted = []
    for name, features in causes.items():
        solution, rms = least_squares(np.stack([*constants, *features], axis=1), error)
        value = tuple(float(a) for a in solution[2:])
        fitted.append(ErrorCause(name, *_cause_text(name, value), value, rms * np.sqrt(2.0)))
    return fitted


def _cause_text(name: str, coefficients: tuple[float, ...]) -> tuple[str, str]:
    match name:
        case "point":
            text = f"velocities referred to a point {coefficients[0]:+.3g} m ahead of the positions' point"
            return text, "correct reference_point of u, v or of x0, y0"
        case "lag":
            return f"a lag of {coefficients[0]:.2g} s of the velocities", "shift u, v by the lag, or estimate it"
        case "drift":
            text = f"a current or velocity bias of {np.hypot(coefficients[0], coefficients[1]):.3g} m/s"
            return text, "if the speed is through water, estimate a current for the run"
        case "misalignment":
            text = f"a misalignment of {np.degrees(coefficients[0]):+.2g} deg between heading and log"
            return text, "check the zero of the compass"
        case _:
            return f"a scale error of {coefficients[0]:+.2%} of the velocities", "check the calibration of the log"
