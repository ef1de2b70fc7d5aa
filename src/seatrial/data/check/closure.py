"""Integrated velocity against position over the whole record: the place where wrong points show."""

from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, Finding, Record, Severity
from seatrial.data.check.frames import best_reading
from seatrial.data.check.motion import Motion, motion_of
from seatrial.data.check.signal import integral, sample_noise, solved

CLEAR, DOUBTFUL = 4.0, 2.0
VISIBLE, LARGE, NOISY = 1e-4, 3e-3, 1.5


@dataclass(frozen=True)
class Explanation:
    """A single cause that would explain a closure error, and the rms it leaves [m]."""

    name: str
    text: str
    advice: str
    value: tuple[float, ...]
    left: float


def closure_findings(record: Record) -> tuple[Finding, ...]:
    """A finding where a clean, signed record does not close; none where the declared reading is already refuted."""
    motion = motion_of(record)
    if motion is None or motion.path == 0 or best_reading(motion).changes:
        return ()
    error = closure_error(motion)
    rms = float(np.sqrt(np.mean(error**2))) * np.sqrt(2.0)
    ranked = sorted(explanations(motion, error), key=lambda e: e.left)
    best, second = ranked[0], ranked[1]
    gain = rms / max(best.left, 1e-12)
    noise = float(np.hypot(sample_noise(motion.x), sample_noise(motion.y)))
    if rms < VISIBLE * motion.path or (gain < DOUBTFUL and rms < max(LARGE * motion.path, NOISY * noise)):
        return ()
    named = gain >= DOUBTFUL
    is_certain = best.name == "point" and gain > CLEAR and second.left > DOUBTFUL * best.left
    return (
        Finding(
            Severity.ERROR if is_certain else Severity.WARNING,
            "closure",
            f"record '{record.name}': integrated velocity leaves the position"
            + (f"; {best.text} would explain it" if named else ""),
            f"{rms:.3g} m rms over {motion.path:.4g} m sailed"
            + (f", {best.left:.3g} m with it, {second.left:.3g} m with {second.text}" if named else ""),
            best.advice if named else "check frame, reference point, lag and bias of u, v against the positions",
        ),
    )


def closure_error(motion: Motion) -> Array:
    """Integrated velocity minus position, each from its mean; north then east, shape (2 n,) [m]."""
    north, east = motion.velocity(motion.readings[0])
    parts = (integral(north, motion.dt) - motion.x, integral(east, motion.dt) - motion.y)
    return np.concatenate([part - part.mean() for part in parts])


def explanations(motion: Motion, error: Array) -> list[Explanation]:
    """Each single cause fitted to the closure error by least squares, the integration constants with it.

    point: velocities of a point d ahead of the position's add d (cos psi, sin psi); lag tau: -tau times the velocity;
    current or bias: grows with time; misalignment a of heading or log: a (-y, x) of the track; scale: the track.
    """
    north, east = motion.velocity(motion.readings[0])
    x, y = integral(north, motion.dt), integral(east, motion.dt)
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
        answer, rms = solved(np.stack([*constants, *features], axis=1), error)
        value = tuple(float(a) for a in answer[2:])
        found.append(Explanation(name, *_words(name, value), value, rms * np.sqrt(2.0)))
    return found


def _words(name: str, value: tuple[float, ...]) -> tuple[str, str]:
    match name:
        case "point":
            return (
                f"velocities referred to a point {value[0]:+.3g} m ahead of the positions' point",
                "mend reference_point of u, v or of x0, y0",
            )
        case "lag":
            return f"a lag of {value[0]:.2g} s of the velocities", "shift u, v by the lag, or estimate it"
        case "drift":
            return (
                f"a current or velocity bias of {np.hypot(value[0], value[1]):.3g} m/s",
                "if the speed is through water, estimate a current for the run",
            )
        case "misalignment":
            return (
                f"a misalignment of {np.degrees(value[0]):+.2g} deg between heading and log",
                "check the zero of the compass",
            )
        case _:
            return f"a scale error of {value[0]:+.2%} of the velocities", "check the calibration of the log"
