"""Inputs of a craft: rudder, thrusters, orders that step, and inputs that follow outputs."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.text.numbers import p_value
from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, Finding, InputError, Record, Severity
from seatrial.core.values.arrays import travel
from seatrial.core.values.notation import COMMANDS as THRUSTER_COMMANDS
from seatrial.data.check.channels import yaw_rate_lag
from seatrial.data.check.phases import rolls_out
from seatrial.data.check.time_base import INPUT_CHANNELS
from seatrial.numerics.local_polynomials import smoothed_locally
from seatrial.physics.models.thruster_layout import AngleInput, Thruster, ThrusterLayout, layout_of

# Does the rudder move?

# rudder range [rad] that counts as excitation; chosen: more than the noise of a sensor
MIN_RUDDER_RANGE = math.radians(0.2)
ZIGZAG_ADVICE = "run a zigzag, for example 10/10 or 20/20"


def is_excited(record: Record) -> bool:
    """Return whether the rudder moves by more than 0.2 degrees in all; False without a rudder."""
    if "delta" not in record:
        return False
    delta = record["delta"][np.isfinite(record["delta"])]
    return delta.size > 1 and float(np.ptp(delta)) > MIN_RUDDER_RANGE


def excitation_findings(record: Record) -> tuple[Finding, ...]:
    """Return a warning on a rudder that never moves, but for a ship that rolls out from a release."""
    if "delta" not in record or is_excited(record) or rolls_out(record):
        return ()
    text = f"record '{record.name}': the rudder never moves, so nothing can be learnt about steering"
    span = f"range {math.degrees(float(np.ptp(record['delta']))):.2g} deg"
    return (Finding(Severity.WARNING, "no-excitation", text, span, ZIGZAG_ADVICE),)


# Thrusters of a craft: which command drives and turns it which way, dead commands, readings out of range.

SURE_EFFECT = 6.0
"""Standard errors by which an effect must differ from none before its sign counts; chosen."""
_SMOOTHING_S = 0.7
"""Window of the local polynomials that differentiate velocities [s]; chosen: some samples of a small craft's log."""
_LEAST_SAMPLES = 5
"""Samples of such a window at least: two more than the parabola needs; chosen."""
_CORRELATED_S = 1.0
"""Time over which residuals of such a regression count as one [s]; chosen: longer than a thruster's lag."""
_LEAST_LEVER = 0.05
"""Lever of a thruster over the largest of the craft below which it turns nothing; chosen."""
_SPAN_MARGIN = 1.1
"""Share of full command up to which readings may go; chosen: trims and wear of a remote control."""
_MAX_ANGLE = 4.0 * np.pi
"""Largest reading of a direction in rad; chosen: two turns, beyond which it is one in degrees."""
_STILL = 1e-3
"""Range of a command, share of full, that counts as none; chosen."""


@dataclass(frozen=True)
class ThrusterEffect:
    """Standard errors by which a thruster's effect on surge and on yaw is positive as the layout has it; 0: unclear."""

    surge: float
    yaw: float


def thruster_findings(layout: ThrusterLayout, records: Sequence[Record]) -> tuple[Finding, ...]:
    """Return findings on the thrusters of a layout, from all records that hold their channels, standard conventions.

    Sides and signs are judged where velocities u and r are measured and commands move apart from one another; what the
    records do not show is not mentioned.
    """
    channels = {t.command.channel for t in layout.thrusters}
    channels |= {t.angle.channel for t in layout.thrusters if isinstance(t.angle, AngleInput)}
    complete = [r for r in records if channels <= set(r.channels)]
    if not complete:
        return ()
    ranges = [f for t in layout.thrusters for f in (*_command_findings(t, complete), *_angle_findings(t, complete))]
    if ranges:
        return tuple(ranges)
    moving = [r for r in complete if {"u", "r"} <= set(r.channels)]
    return tuple(_side_findings(layout, moving)) if moving else ()


def refuse_impossible_commands(model: Model, record: Record) -> None:
    """Refuse inputs that no thruster can follow: commands beyond their span, directions that are degrees.

    Raises:
        InputError: which command or direction of the record, and what to correct.
    """
    if not model.has_thrusters:
        return
    for thruster in layout_of(model).thrusters:
        commands = _command_findings(thruster, [record]) if thruster.command.channel in record else []
        for finding in (*commands, *_angle_findings(thruster, [record])):
            if finding.severity is Severity.ERROR:
                raise InputError(f"record '{record.name}': {finding.text}; {finding.advice}")


def _orders(thruster: Thruster, record: Record) -> Array:
    return (record[thruster.command.channel] - thruster.command.zero) / thruster.command.span


def _command_findings(thruster: Thruster, records: Sequence[Record]) -> list[Finding]:
    orders = np.concatenate([_orders(thruster, r) for r in records])
    where, channel = f"thruster '{thruster.name}'", thruster.command.channel
    readings = np.concatenate([r[channel] for r in records])
    is_of_percent = thruster.command.zero == 0.0 and abs(thruster.command.span) > 1.0
    if is_of_percent and 0.0 < float(np.max(np.abs(readings))) <= 1.0:
        return [Finding(
            Severity.ERROR, "command-range", f"{where}: '{channel}' is scaled twice, to {np.max(orders):.2g} of full",
            f"readings {np.min(readings):.3g} to {np.max(readings):.3g}, which are shares of full command already",
            f"take unit, zero and span out of its command, or out of channels.{channel}",
        )]  # fmt: skip
    if np.ptp(orders) < _STILL:
        return [Finding(
            Severity.WARNING, "dead-thruster", f"{where}: its command '{channel}' never moves in any run",
            f"{orders[0]:.3g} of full throughout",
        )]  # fmt: skip
    worst = float(np.max(np.abs(orders)))
    if worst <= _SPAN_MARGIN:
        return []
    return [Finding(
        Severity.ERROR, "command-range", f"{where}: '{channel}' goes to {worst:.3g} of full command",
        f"readings {np.min(readings):.6g} to {np.max(readings):.6g}, zero {thruster.command.zero:g}, span "
        f"{thruster.command.span:g}",
    )]  # fmt: skip


def _angle_findings(thruster: Thruster, records: Sequence[Record]) -> list[Finding]:
    if not isinstance(thruster.angle, AngleInput):
        return []
    channel = thruster.angle.channel
    jumps = [np.abs(np.diff(r[channel])) for r in records if channel in r]
    largest = max((float(np.max(j, initial=0.0)) for j in jumps), default=0.0)
    reach = max((float(np.ptp(r[channel])) for r in records if channel in r), default=0.0)
    if max(largest, reach) <= _MAX_ANGLE:
        return []
    return [Finding(
        Severity.ERROR, "wrong-unit", f"thruster '{thruster.name}': '{channel}' ranges over {reach:.4g} rad",
        f"{reach / (2.0 * np.pi):.0f} turns, or {reach:.0f} degrees",
        f'set unit = "deg" for {channel} in [records.channels]',
    )]  # fmt: skip


def _side_findings(layout: ThrusterLayout, records: Sequence[Record]) -> list[Finding]:
    effects = thruster_effects(layout, records)
    findings = []
    for thruster, effect in zip(layout.thrusters, effects, strict=True):
        evidence = (
            f"effect on speed {effect.surge:+.0f}, on yaw rate {effect.yaw:+.0f} standard errors against the layout"
        )
        is_inverted = effect.surge < -SURE_EFFECT
        is_across = effect.yaw > SURE_EFFECT if is_inverted else effect.yaw < -SURE_EFFECT
        if not (is_inverted or is_across):
            continue
        other = "astern" if thruster.command.span > 0 else "ahead"
        sides = "exchange the channels of port and starboard, or the signs of their y"
        if isinstance(thruster.angle, AngleInput):
            sides = f"state the other side as positive for channels.{thruster.angle.channel}"
        faults = ["works inverted"] * is_inverted + ["turns the craft as one on the other side would"] * is_across
        advice = [f'set command.positive = "{other}" for it'] * is_inverted + [sides] * is_across
        text = f"thruster '{thruster.name}' ('{thruster.command.channel}') {' and '.join(faults)}"
        findings.append(Finding(Severity.ERROR, "thruster-side", text, evidence, " and ".join(advice)))
    return findings


def thruster_effects(layout: ThrusterLayout, records: Sequence[Record]) -> list[ThrusterEffect]:
    """Return what each thruster drives and turns as the records show it, standard conventions, with u and r.

    Least squares of du/dt and dr/dt on what each thruster should give, with the motion's own damping and turning axes.
    """
    surge = _regression([_columns(layout, r, "u") for r in records], records[0].dt, len(layout.thrusters))
    yaw = _regression([_columns(layout, r, "r") for r in records], records[0].dt, len(layout.thrusters))
    return [ThrusterEffect(a, b) for a, b in zip(surge, yaw, strict=True)]


def _columns(layout: ThrusterLayout, record: Record, channel: str) -> tuple[Array, Array]:
    """Features (n, k), one for each thruster first, and acceleration (n,); no rows of a run shorter than a window."""
    u, r = record["u"], record["r"]
    v = record["v"] if "v" in record else np.zeros(len(u))
    levers = [_levers(t, record, channel) for t in layout.thrusters]
    features = [
        (o := _orders(t, record)) * np.abs(o) * lever for t, lever in zip(layout.thrusters, levers, strict=True)
    ]
    own = record[channel]
    width = max(_LEAST_SAMPLES, 2 * round(0.5 * _SMOOTHING_S / record.dt) + 1)
    acceleration = smoothed_locally(own, width, 2, 1, record.dt) if len(own) >= width else np.full(len(own), np.nan)
    # turning axes: surge gains v r (Fossen 2011, eq. 3.56), yaw the moments of |u| r and u v
    of_turning = [r * np.abs(u), u * v] if channel == "r" else [v * r]
    damping = [own, own * np.abs(own), *of_turning, np.ones(len(own))]
    table = np.stack([*features, *damping], axis=1)
    known = np.all(np.isfinite(table), axis=1) & np.isfinite(acceleration)
    return table[known], acceleration[known]


def _levers(thruster: Thruster, record: Record, channel: str) -> Array:
    """Surge or yaw that a unit of thrust should give, (n,)."""
    n = len(record)
    a = record[thruster.angle.channel] if isinstance(thruster.angle, AngleInput) else np.full(n, thruster.angle)
    return np.cos(a) if channel == "u" else thruster.x * np.sin(a) - thruster.y * np.cos(a)


def _regression(parts: Sequence[tuple[Array, Array]], dt: float, count: int) -> list[float]:
    """Estimate over standard error of the first `count` coefficients; 0 where a feature is hardly there."""
    table, target = np.concatenate([p[0] for p in parts]), np.concatenate([p[1] for p in parts])
    if not len(table):
        return [0.0] * count
    size = np.sqrt(np.mean(table**2, axis=0))
    present = size > _LEAST_LEVER * np.max(size[:count], initial=0.0)
    present[count:] = size[count:] > 0.0
    scaled = table[:, present] / size[present]
    if len(scaled) <= scaled.shape[1]:
        return [0.0] * count
    point, *_ = np.linalg.lstsq(scaled, target, rcond=None)
    effective = max(1.0, len(target) * dt / _CORRELATED_S)
    variance = np.sum((target - scaled @ point) ** 2) / effective
    spread = np.sqrt(variance * np.diag(np.linalg.pinv(scaled.T @ scaled)))
    ratios = np.zeros(len(size))
    ratios[present] = point / np.maximum(spread, np.finfo(float).tiny)
    return [float(x) for x in ratios[:count]]


# Inputs that step from sample to sample, and records of a simulation that stepped with its own sample interval.

_HALF = 0.5  # samples by which an explicit step moves the heading against the yaw rate (Euler's method)
_CERTAIN = 4.0  # standard errors by which that lag differs from none; chosen, as real clocks are seldom so even
_SLACK = 0.05  # samples by which such a lag may differ besides its error; chosen
_LARGEST_ERROR = 0.1  # samples, standard error of a lag above which nothing is said; chosen


def stepped_input_findings(record: Record) -> tuple[Finding, ...]:
    """Return a note on the inputs of a clean record that are taken as held because they step within single samples."""
    travels = {
        s: travel(record.channel(s).values) for s in INPUT_CHANNELS if s in record and not _is_declared(record, s)
    }
    stepped = [s for s, one in travels.items() if one.is_stepped]
    if not stepped:
        return ()
    names, verb = enumeration(stepped, len(stepped)), "changes" if len(stepped) == 1 else "change"
    text = f"record '{record.name}': {names} {verb} within single samples, as orders do"
    share = min(travels[s].steps / travels[s].total for s in stepped)
    evidence = f"{100.0 * share:.0f} % of their travel; held from sample to sample, steps known to one sample"
    advice = 'declare between = "straight" for a sensor that moved evenly between samples'
    return (Finding(Severity.INFO, "stepped-input", text, evidence, advice),)


def _is_declared(record: Record, symbol: str) -> bool:
    channel = record.channel(symbol)
    return bool(channel.between) or channel.is_command


def integration_step_findings(record: Record) -> tuple[Finding, ...]:
    """Return a warning where heading and yaw rate of a clean record are half a sample apart, as Euler's method leaves.

    With psi(k+1) = psi(k) + dt r(k) the heading lies half a step behind the rate (Hairer, Norsett & Wanner 1993,
    section I.7), and a time constant T decays as one of -dt / ln(1 - dt / T): shorter by half a step.
    """
    lag, error = yaw_rate_lag(record) or (0.0, 0.0)
    distance = abs(abs(lag) - _HALF * record.dt)
    if abs(lag) < _CERTAIN * error or distance > 2.0 * error + _SLACK * record.dt or error > _LARGEST_ERROR * record.dt:
        return ()
    if not any(travel(record[s]).is_stepped for s in INPUT_CHANNELS if s in record):
        return ()  # a loop that integrates by whole samples orders by whole samples, too
    text = f"record '{record.name}': heading and yaw rate are half a sample apart, as in a simulation by Euler's method"
    evidence = f"{lag / record.dt:.2f} samples, standard error {error / record.dt:.2g}"
    advice = f"simulate in steps far below {record.dt:g} s and keep every so many; of a log, correct the clocks"
    return (Finding(Severity.WARNING, "integration-step", text, evidence, advice),)


# Do inputs follow outputs? A controller or helmsman who answers to the ship's motion ties disturbances to the inputs.

COMMANDS = ("delta", "alpha_f", "delta_f1", "delta_f2", *THRUSTER_COMMANDS)
"""Channels that a controller works."""

MOTIONS = ("psi", "r", "v", "phi", "p", "theta", "theta_dot")
"""Channels that a controller answers to."""

FEEDBACK_P = 1e-5
"""p-value of the test below which inputs follow outputs; small, because ships are not linear as the test is; chosen."""

FEEDBACK_CORRELATION = 0.06
"""Cross-correlation that feedback has at least; chosen: what ships do nonlinearly makes up to 0.04, an autopilot with
orders in half degrees and an hour of records at 1 Hz 0.07."""

# lags of the regressions and of the correlation; most samples that are used; chosen
_LAGS, _MOST_SAMPLES = 10, 20_000
# fewest rows for each unknown of the regressions; chosen
_ROWS_PER_UNKNOWN = 4
# fewest samples that carry an input's unpredictable part: of single orders no correlation can be shown; chosen
_FEWEST_EVENTS = 15.0
# rms of an input's unpredictable part, over that of the input, that is rounding
_ROUNDING = 1e-9
# smallest norm that is divided by, and singular values over the largest that count as zero: rounding
_SMALLEST, _SINGULAR = 1e-300, 1e-10


@dataclass(frozen=True)
class FeedbackTest:
    """Whether an input follows outputs.

    Attributes:
        command: the input; motion: the output it follows most clearly.
        correlation: their largest cross-correlation, the output `lag` [s] before the input.
        p: that all cross-correlations up to ten samples are chance, smallest over the outputs times their number.
    """

    command: str
    motion: str
    lag: float
    correlation: float
    p: float

    @property
    def has_feedback(self) -> bool:
        """Whether the input follows outputs."""
        return self.p < FEEDBACK_P and abs(self.correlation) >= FEEDBACK_CORRELATION


def feedback_tests(record: Record) -> tuple[FeedbackTest, ...]:
    """Test every command of a complete record that moves, against all measured motions."""
    motions = [m for m in MOTIONS if m in record and np.ptp(record[m]) > 0.0]
    commands = [c for c in COMMANDS if c in record and np.ptp(record[c]) > 0.0]
    if not motions or not all(np.all(np.isfinite(record[n])) for n in (*motions, *commands)):
        return ()
    rows = slice(0, _MOST_SAMPLES)
    outputs = np.stack([record[m][rows] for m in motions], axis=1)
    tests = (_feedback_test(c, record[c][rows], motions, outputs, record.dt) for c in commands)
    return tuple(t for t in tests if t is not None)


def has_feedback(record: Record) -> bool:
    """Return whether any command of a record follows its motions."""
    return any(test.has_feedback for test in feedback_tests(record))


def feedback_findings(record: Record) -> tuple[Finding, ...]:
    """A note where commands follow motions."""
    return tuple(
        Finding(
            Severity.INFO,
            "feedback",
            f"record '{record.name}': '{t.command}' follows '{t.motion}' (a controller, or a helmsman as in a zigzag): "
            "output error would take disturbances that are answered for the ship's own response; identify uses "
            "prediction error with a disturbance model",
            f"cross-correlation {t.correlation:.2f}, output {t.lag:.2g} s before input, {p_value(t.p)}",
        )
        for t in feedback_tests(record)
        if t.has_feedback
    )


def _feedback_test(
    command: str, values: Array, motions: Sequence[str], outputs: Array, dt: float
) -> FeedbackTest | None:
    rows, ny = len(values) - _LAGS, len(motions)
    if rows < _ROWS_PER_UNKNOWN * (2 + _LAGS * (1 + ny)):
        return None
    own = np.hstack([np.ones((rows, 1)), _past(values[:, None])])
    order = _remainder(own, values[_LAGS:, None])[:, 0]
    power = float(order @ order)
    if power <= _ROUNDING**2 * float(values @ values) or power**2 < _FEWEST_EVENTS * float(np.sum(order**4)):
        return None
    motion = _remainder(np.hstack([own, values[_LAGS:, None], _past(outputs - outputs[0])]), outputs[_LAGS:])
    size = np.sqrt(power) * np.maximum(np.linalg.norm(motion, axis=0), _SMALLEST)
    correlations = np.array([order[k:] @ motion[:-k] for k in range(1, _LAGS + 1)]) / size
    p = chi_square_tail(_LAGS, rows * np.sum(correlations**2, axis=0))
    j = int(np.argmin(p))
    k = int(np.argmax(np.abs(correlations[:, j])))
    return FeedbackTest(command, motions[j], (k + 1) * dt, float(correlations[k, j]), min(1.0, ny * float(p[j])))


def chi_square_tail(degrees: int, statistic: Array) -> Array:
    """Return the probability that a chi-square variable of an even number of degrees of freedom exceeds a value.

    Abramowitz & Stegun 1964, eq. (26.4.21); `check` would load a library for this one number.
    """
    half = 0.5 * statistic
    return np.exp(-half) * sum(half**i / math.factorial(i) for i in range(degrees // 2))


def _past(values: Array) -> Array:
    """Columns of the values 1 to 10 rows before, (n - 10, 10 * columns)."""
    return np.hstack([values[_LAGS - k : len(values) - k] for k in range(1, _LAGS + 1)])


def _remainder(features: Array, target: Array) -> Array:
    """What features (n, k) do not explain of the target (n, m)."""
    unit = features / np.maximum(np.linalg.norm(features, axis=0), _SMALLEST)
    directions, triangle = np.linalg.qr(unit)
    independent = directions[:, np.abs(np.diagonal(triangle)) > _SINGULAR]
    return target - independent @ (independent.T @ target)
