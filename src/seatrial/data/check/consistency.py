"""Channels that must agree: integrated velocity with position, yaw rate with heading."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, Finding, Record, Severity, TrialEdit
from seatrial.data.check.consequences import REVERSED
from seatrial.data.check.motion import (
    MIN_SAMPLES,
    ComplexArray,
    RecordedMotion,
    cumulative_integral,
    least_squares,
    sample_noise,
    smoothed,
    smoothed_derivative,
    window_length,
)
from seatrial.numerics.resolution import resolution

# Integrated velocity against position over the whole record: the place where wrong points show.

ESTIMATE_CURRENT = "if the speed is through water, estimate a current for the run: [estimate] current = 0.3"
"""What to do where a current explains how far velocities and positions are apart; 0.3 m/s: an example."""
_WITHOUT_VELOCITIES = 'channels = ["x0", "y0", "psi"] under [estimate]'
# factors by which another reading must reduce the residual to be certain, or possible, ours
CERTAIN_GAIN, DOUBTFUL_GAIN = 4.0, 2.0
# ratio of residuals up to which two causes explain an error alike, and both are named; chosen
AMBIGUOUS_RATIO = 1.2
# causes that a message names at most, and residuals listed beside the best one; chosen: it stays one sentence
MOST_CAUSES, MOST_RESIDUALS = 3, 3
# error of sway over sway where its sign is wrong, and how far from it a fit may end; chosen
REVERSED_SWAY, SWAY_MARGIN = 2.0, 0.4
# what a cause must explain, in rms of integrated velocity noise and in rms of the noise of positions, where it does not
# halve the error; chosen
WALK_FACTOR, NOISE_SHARE = 2.5, 0.25
# residuals over path length that are negligible, and large; multiple of the noise that is tolerated, ours
MIN_RELATIVE_ERROR, LARGE_RELATIVE_ERROR, NOISE_FACTOR = 1e-4, 3e-3, 1.5
# error of a velocity over the mean speed up to which it is a note: half of what a speed log may be wrong by
# (IMO A.824(19), accuracy of measurement: 2 % of the speed), and below what planted_faults.py plants
SMALL_SPEED_ERROR = 0.01


@dataclass(frozen=True)
class ErrorCause:
    """A single cause that would explain a closure error, and the rms it leaves [m]."""

    name: str
    text: str
    advice: str
    coefficients: tuple[float, ...]
    residual_rms: float
    edits: tuple[TrialEdit, ...] = ()

    def speed_error(self, mean_speed: float, turning: float) -> float:
        """The error of the velocity [m/s] that the cause is, at a mean speed [m/s]; infinite where it is none.

        turning: rms of the yaw rate [rad/s], by which velocity and heading change in a lag.
        """
        match self.name:
            case "current" | "bias of u" | "bias of v":
                return math.hypot(*self.coefficients)
            case "scale" | "misalignment":  # a small angle [rad] turns that share of the velocity aside
                return abs(self.coefficients[0]) * mean_speed
            case "lag of velocity" | "lag of heading":
                return abs(self.coefficients[0]) * turning * mean_speed
            case _:
                return math.inf

    def rank(self) -> float:
        """Residual with which causes are compared: one with two coefficients must leave less than one with one."""
        return self.residual_rms * AMBIGUOUS_RATIO ** (len(self.coefficients) - 1)


def kinematic_consistency_findings(motion: RecordedMotion) -> tuple[Finding, ...]:
    """A finding where a record does not close; of what is stated nothing is refuted."""
    record = motion.record
    if motion.path_length == 0:
        return ()
    error = consistency_error(motion)
    rms = float(np.sqrt(np.mean(error**2))) * np.sqrt(2.0)
    ranked = sorted(candidate_causes(motion, error), key=ErrorCause.rank)
    best, second = ranked[0], ranked[1]
    gain = rms / max(best.residual_rms, 1e-12)  # above zero, for a division
    noise = float(np.hypot(sample_noise(record["x0"]), sample_noise(record["y0"])))
    is_large = rms > max(LARGE_RELATIVE_ERROR * motion.path_length, NOISE_FACTOR * noise)
    explained = float(np.sqrt(max(rms**2 - best.residual_rms**2, 0.0)))
    is_significant = explained > max(WALK_FACTOR * integrated_noise(motion), NOISE_SHARE * noise)
    if rms < MIN_RELATIVE_ERROR * motion.path_length or not (is_large or gain > DOUBTFUL_GAIN or is_significant):
        return ()
    message = f"record '{record.name}': integrated velocity leaves the position"
    evidence = f"{rms:.3g} m rms over {motion.path_length:.4g} m travelled"
    if gain < DOUBTFUL_GAIN and not is_significant:
        advice = (
            "check u, v against the positions: frame, reference_point and offset of u and v under [records.channels]; "
            f"if none is wrong, fit without them, {_WITHOUT_VELOCITIES}"
        )
        return (Finding(Severity.WARNING, "closure", message, evidence, advice),)
    alike = [one for one in ranked if one.residual_rms <= AMBIGUOUS_RATIO * best.residual_rms]
    message += f"; {' or '.join(one.text for one in alike[:MOST_CAUSES])} would explain it"
    evidence += f", {_residuals_text(ranked)}"
    mean_speed = motion.path_length / record.duration
    turning = float(np.sqrt(np.mean(np.gradient(record["psi"], record.dt) ** 2)))
    rounding = 0.5 * math.hypot(resolution(record["u"]), resolution(record["v"]))  # m/s, of a reading at most
    small = max(SMALL_SPEED_ERROR * mean_speed, rounding)
    if max(one.speed_error(mean_speed, turning) for one in alike) < small:
        advice = (
            f"no action needed: it is below {SMALL_SPEED_ERROR:.0%} of the speed, and a good log may have twice that"
            if small > rounding
            else f"no action needed: it is below the {rounding:.2g} m/s by which u and v are rounded"
        )
        return (Finding(Severity.INFO, "closure", message, evidence, advice),)
    is_distinct = second.residual_rms > DOUBTFUL_GAIN * best.residual_rms
    is_certain = best.name in ("point", "sway") and gain > CERTAIN_GAIN and is_distinct
    severity = Severity.ERROR if is_certain else Severity.WARNING
    edits = best.edits if is_distinct else ()
    written = "; ".join(str(edit) for edit in best.edits)
    advice = best.advice if edits or not written else f"{best.advice}; if it is the first, write {written}"
    return (Finding(severity, "closure", message, evidence, advice, edits=edits),)


def _residuals_text(ranked: Sequence[ErrorCause]) -> str:
    """The rms that each cause leaves: of the best one and the next by name, of the rest the range."""
    texts = [f"{one.name} {one.residual_rms:.2g} m" for one in ranked[1 : 1 + MOST_RESIDUALS]]
    rest = [one.residual_rms for one in ranked[1 + MOST_RESIDUALS :]]
    others = f", {len(rest)} others {min(rest):.2g} to {max(rest):.2g} m" if rest else ""
    return f"{ranked[0].residual_rms:.2g} m with it; with {', '.join(texts)}{others}"


def integrated_noise(motion: RecordedMotion) -> float:
    """Return the rms [m] that white noise of u, v and psi alone leaves in the integrated velocity, about its mean.

    A random walk of steps s sqrt(dt) in each of two directions has the variance s^2 dt T / 6 about its mean.
    """
    record = motion.record
    sway = float(np.mean(np.hypot(record["u"], record["v"]))) * sample_noise(record["psi"])
    speed = float(np.sqrt(sample_noise(record["u"]) ** 2 + sample_noise(record["v"]) ** 2 + sway**2))
    return speed * float(np.sqrt(record.dt * record.duration / 6.0))  # of the variance above


def consistency_error(motion: RecordedMotion) -> Array:
    """Integrated velocity minus position, each from its mean; north then east, shape (2 n,) [m]."""
    x, y = _integrated_velocity(motion)
    return np.concatenate([part - part.mean() for part in (x - motion.record["x0"], y - motion.record["y0"])])


def _integrated_velocity(motion: RecordedMotion) -> tuple[Array, Array]:
    north, east = motion.velocity
    return cumulative_integral(north, motion.record.dt), cumulative_integral(east, motion.record.dt)


def candidate_causes(motion: RecordedMotion, error: Array) -> list[ErrorCause]:
    """Each single cause fitted to the closure error by least squares, the integration constants with it.

    Velocities of a point d ahead of the positions' add d (cos psi, sin psi); moved there without turning the lever,
    d (0, psi), or d (cos psi, sin psi - psi) where the point is declared; a lag tau of u, v -tau times the velocity,
    one of psi -tau times the integral of velocity across times yaw rate; a current grows with time, a bias of the log
    with the time on each heading; a misalignment a of heading or log adds a (-y, x) of the track, a scale error
    the track.
    """
    dt, psi = motion.record.dt, motion.record["psi"]
    north, east = motion.velocity
    x, y = cumulative_integral(north, dt), cumulative_integral(east, dt)
    t, zero, turning = motion.record.time - motion.record.time[0], np.zeros_like(x), np.gradient(psi, dt)
    c, s = np.cos(psi), np.sin(psi)
    sway = north * -s + east * c
    ahead, aside = cumulative_integral(c, dt), cumulative_integral(s, dt)
    causes = {
        "point": [(c, s)],
        "unturned lever": [(zero, psi)],
        "unturned lever to the point": [(c, s - psi)],
        "lag of velocity": [(-north, -east)],
        "lag of heading": [(cumulative_integral(east * turning, dt), -cumulative_integral(north * turning, dt))],
        "current": [(t, zero), (zero, t)],
        "bias of u": [(ahead, aside)],
        "bias of v": [(-aside, ahead)],
        "sway": [(-cumulative_integral(sway * s, dt), cumulative_integral(sway * c, dt))],
        "misalignment": [(-y, x)],
        "scale": [(x, y)],
    }
    if motion.frame == "earth":  # of a receiver: it has no zero ahead and across of its own
        causes = {name: features for name, features in causes.items() if not name.startswith("bias")}
    constants = [np.concatenate([zero + 1, zero]), np.concatenate([zero, zero + 1])]
    fitted = []
    for name, features in causes.items():
        table = np.stack([*constants, *(np.concatenate(pair) for pair in features)], axis=1)
        solution, rms = least_squares(table, error)
        value = tuple(float(a) for a in solution[2:])
        if name == "misalignment":
            value, rms = _exact_misalignment(x + 1j * y, motion.record["x0"] + 1j * motion.record["y0"])
        if name == "sway" and abs(value[0] - REVERSED_SWAY) > SWAY_MARGIN:
            continue
        text, advice, edits = _cause_text(name, value, motion)
        fitted.append(ErrorCause(name, text, advice, value, rms * np.sqrt(2.0), edits))
    return fitted


def _exact_misalignment(integrated: ComplexArray, position: ComplexArray) -> tuple[tuple[float], float]:
    """The angle [rad] by which the integrated track is turned, and the rms that is left: a large one is not linear."""
    track, truth = integrated - integrated.mean(), position - position.mean()
    angle = float(np.angle(np.sum(track * np.conj(truth))))
    return (angle,), float(np.sqrt(0.5 * np.mean(np.abs(track * np.exp(-1j * angle) - truth) ** 2)))


def shift_text(lag: float) -> str:
    """Return how a channel is written that lags by this [s], or leads by its negative: ``0.3 s earlier``."""
    return f"{abs(lag):.2g} s {'earlier' if lag > 0.0 else 'later'}"


def _cause_text(
    name: str, coefficients: tuple[float, ...], motion: RecordedMotion
) -> tuple[str, str, tuple[TrialEdit, ...]]:
    """What the cause is, what to do, and the edit where there is one."""
    size = coefficients[0]
    match name:
        case "point":
            place = motion.record.channel("v").reference_point + size
            edits = tuple(TrialEdit(f"channels.{symbol}.reference_point", f"{place:.4g}") for symbol in ("u", "v"))
            text = f"velocities of a point {size:+.3g} m ahead of the positions'"
            return text, "correct reference_point of u, v or of x0, y0", edits
        case "unturned lever" | "unturned lever to the point":
            text = f"a lever of {size:+.3g} m not turned with the heading"
            return text, "give the velocities as they were measured, and reference_point", ()
        case "lag of velocity":
            advice = f"write u, v {shift_text(size)} into the file, or fit without them, {_WITHOUT_VELOCITIES}"
            return f"a lag of {size:.2g} s of the velocities", advice, ()
        case "lag of heading":
            return f"a lag of {size:.2g} s of the heading", f"write psi {shift_text(size)} into the file", ()
        case "current":
            speed = np.hypot(coefficients[0], coefficients[1])
            text = f"a current or velocity bias of {speed:.3g} m/s"
            return text, ESTIMATE_CURRENT, ()
        case "bias of u" | "bias of v":
            edits = (TrialEdit(f"channels.{name[-1]}.offset", f"{-size:.4g}", "m/s"),)
            return f"a {name} by {size:+.3g} m/s", "correct the zero of the log", edits
        case "sway":
            return "v with the opposite sign", "turn positive of v round", (TrialEdit("channels.v.positive", REVERSED),)
        case "misalignment":
            edits = (TrialEdit("channels.psi.offset", f"{-size:.4g}", "rad"),)
            if motion.frame == "earth":
                return f"velocities turned by {np.degrees(size):+.2g} deg against the positions", "check their axes", ()
            text = f"a misalignment of {np.degrees(size):+.2g} deg between heading and log (magnetic variation?)"
            return text, "check the zero of the compass", edits
        case _:
            edits = tuple(TrialEdit(f"channels.{symbol}.scale", f"{1.0 / (1.0 + size):.5g}") for symbol in ("u", "v"))
            return f"a scale error of {size:+.2%} of the velocities", "check the calibration of the log", edits


# The rate of the heading, and how a channel is called.

# heading range [rad] below which the yaw rate is not compared; chosen: above the noise of a compass
MIN_HEADING_RANGE = math.radians(2.0)
# correlation with the rate of the heading from which on a yaw rate follows it; chosen
FOLLOWS = 0.8


def heading_rate(record: Record) -> Array | None:
    """Return the smoothed d(psi)/dt [rad/s]; None where the heading is missing or hardly moves."""
    if "psi" not in record or len(record) < MIN_SAMPLES:
        return None
    length = window_length(len(record))
    if np.ptp(smoothed(record["psi"], length)) < MIN_HEADING_RANGE:
        return None
    return smoothed_derivative(record["psi"], record.dt, length)


def channel_name(record: Record, symbol: str) -> str:
    """Return how messages name a channel: its symbol, and its name in the file."""
    label = record.channel(symbol).label if symbol in record else ""
    return f"'{symbol}' ({label})" if label else f"'{symbol}'"
