"""Thrusters of a craft: which command drives and turns it which way, dead commands, readings out of range."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Finding, InputError, Record, Severity
from seatrial.numerics.local_polynomials import smoothed_locally
from seatrial.physics.models.thruster_layout import AngleInput, Thruster, ThrusterLayout

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
    if not model.equations.layout:
        return
    for thruster in ThrusterLayout.from_text(model.equations.layout).thrusters:
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
            f"{orders[0]:.3g} of full throughout", "leave the thruster out, or name the channel that drives it",
        )]  # fmt: skip
    worst = float(np.max(np.abs(orders)))
    if worst <= _SPAN_MARGIN:
        return []
    return [Finding(
        Severity.ERROR, "command-range", f"{where}: '{channel}' goes to {worst:.3g} of full command",
        f"readings {np.min(readings):.6g} to {np.max(readings):.6g}, zero {thruster.command.zero:g}, span "
        f"{thruster.command.span:g}",
        "correct unit, zero and span of its command (us: 1500 and 400; percent: 0 and 100)",
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
        Severity.ERROR, "angle-unit", f"thruster '{thruster.name}': '{channel}' ranges over {reach:.4g} rad",
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
        other = "astern" if thruster.command.span > 0 else "ahead"
        inverted = f'set command.positive = "{other}" for it'
        sides = "exchange the channels of port and starboard, or the signs of their y"
        if isinstance(thruster.angle, AngleInput):
            sides = f"state the other side as positive for channels.{thruster.angle.channel}"
        if effect.surge < -SURE_EFFECT and effect.yaw < -SURE_EFFECT:
            what, advice = "works inverted: more command drives and turns the craft the other way", inverted
        elif effect.surge < -SURE_EFFECT and effect.yaw > SURE_EFFECT:
            what, advice = "works inverted and on the other side", f"{inverted} and {sides}"
        elif effect.yaw < -SURE_EFFECT < effect.surge:
            what, advice = "turns the craft as one on the other side would", sides
        elif effect.surge < -SURE_EFFECT:
            what, advice = "works inverted: more command drives the craft the other way", inverted
        else:
            continue
        findings.append(Finding(
            Severity.ERROR, "thruster-side", f"thruster '{thruster.name}' ('{thruster.command.channel}') {what}",
            evidence, advice,
        ))  # fmt: skip
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
