"""How far a prediction leaves the ground that the training runs cover."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.results import Extrapolation
from seatrial.core.values import Array, Record
from seatrial.physics.manoeuvres import REACH_PERCENTILE, to_starboard
from seatrial.physics.models.thruster_layout import AngleInput, Thruster, ThrusterLayout, with_steering_order
from seatrial.physics.simulate.steer import RUDDER_RATE, sustained_rudder_rate

# Where thrusters worked: their commands and the speed of the water along them, sample by sample.


@dataclass(frozen=True, eq=False)
class ThrusterConditions:
    """Of one thruster along some records: order, share of full command, (n,); speed through it, m/s, (n,)."""

    order: Array
    speed: Array

    def quadrants(self) -> dict[str, Array]:
        """Return the size of order times speed, m/s, in each quadrant by name, zero at samples in the others."""
        orders = {"ahead": np.maximum(self.order, 0.0), "astern": np.maximum(-self.order, 0.0)}
        speeds = {"ahead": np.maximum(self.speed, 0.0), "astern": np.maximum(-self.speed, 0.0)}
        return {f"{a}, moving {b}": order * speed for a, order in orders.items() for b, speed in speeds.items()}


def thruster_conditions(layout: str, records: Sequence[Record]) -> dict[str, ThrusterConditions]:
    """Return the conditions of each thruster over all records, by name; empty without surge speed or commands.

    layout: text of the craft's layout, empty for other models. Speeds are those recorded, u - y r and v + x r resolved
    along the thruster (Fossen 2021, section 9.2); of azimuth thrusters along their channel.
    """
    if not layout:
        return {}
    conditions = {}
    for thruster in ThrusterLayout.from_text(layout).thrusters:
        kept = [r for r in records if {"u", thruster.command.channel} <= set(r.channels)]
        if kept:
            order, speed = (np.concatenate(parts) for parts in zip(*(_along(thruster, r) for r in kept), strict=True))
            valid = np.isfinite(order) & np.isfinite(speed)
            conditions[thruster.name] = ThrusterConditions(order[valid], speed[valid])
    return conditions


def _along(thruster: Thruster, record: Record) -> tuple[Array, Array]:
    """Order and speed along a thruster, (n,) each."""
    zero = np.zeros(len(record))
    held = {"v": zero, "r": zero} | {c: record[c] for c in record.channels}
    v, r = held["v"], held["r"]
    angle = held.get(thruster.angle.channel, zero) if isinstance(thruster.angle, AngleInput) else thruster.angle
    cosine, sine = np.cos(angle), np.sin(angle)
    order = (record[thruster.command.channel] - thruster.command.zero) / thruster.command.span
    return order, (record["u"] - thruster.y * r) * cosine + (v + thruster.x * r) * sine


# How far a prediction leaves the ground the training runs cover: coefficients are known only where they had effect.

SIDES = ("port", "starboard")
"""Of the rudder: to which it turns the ship; ranges are called ``rudder to port`` and ``rudder to starboard``."""
_IN_WAVES = {"heave": "z", "pitch": "theta", "elevation": "zeta"}  # ranges of a craft in waves -> channels
# rad/s, rad, m/s; m and rad in waves: below which a range counts as none; chosen
NEGLIGIBLE = {
    "yaw_rate": 1e-4, "drift": 1e-3, "rudder": 1e-3, "roll": 1e-3, "fastest": 1e-3, "slowest": 1e-3,
    "heave": 1e-5, "pitch": 1e-4, "elevation": 1e-5,
}  # fmt: skip
REST_SHARE = 0.1
"""Share of the fastest speed of the training runs below which a craft counts as at rest; chosen."""
COMMAND = "command "
"""What names of a thruster's ranges begin with; its name follows, then the direction of thrust and of motion."""
COMMAND_GAIN = 1.0
"""Growth of the index over the whole range of commands (benchmarks/prediction_bands.py)."""


PROPELLER_RATE = "propeller_rate"
"""Name of the least rate of the propeller under way in the training runs [rps]: engines slow down in turns."""
_IDLE = 0.5  # of the median rate of a propeller, below which it is stopped or started; chosen


def motion_envelope(records: Sequence[Record], layout: str = "") -> dict[str, float]:
    """What the records cover, SI: ranges of motion, rudder and commands, rates of the rudder and the propeller.

    The rate of the rudder's fastest move (`sustained_rudder_rate`) and the propeller's least rate are no limits of a
    prediction. What no record holds is absent. Of a craft
    whose `layout` has thrusters that turn, the rudder is the order of their angle.
    """
    records = _with_orders(records, layout)
    rates = [rate for r in records if (rate := sustained_rudder_rate(r)) is not None]
    shafts = [np.abs(r["n"]) for r in records if "n" in r]
    turning = [n[n > _IDLE * np.nanmedian(n)] for n in shafts]
    slowest = [float(np.nanpercentile(n, 100.0 - REACH_PERCENTILE)) for n in turning if n.size]
    return (
        _ranges(records, layout)
        | ({RUDDER_RATE: max(rates)} if rates else {})
        | ({PROPELLER_RATE: min(slowest)} if slowest else {})
    )


def _ranges(records: Sequence[Record], layout: str) -> dict[str, float]:
    """Largest yaw rate, drift, rudder angle, also to each side, roll, fastest and slowest speed, commands; in waves
    heave, pitch and elevation about their means.

    The largest is the 99.5th percentile of all samples, so that a single bad one does not count; of roll, which a decay
    has once, the largest of all. What no record holds is absent. Drift is atan2(-v, u). Of every thruster of a `layout`
    (its text): ``command NAME ahead`` and ``astern``, largest share of full command, and ``command NAME ahead, moving
    astern`` and so on, largest share times speed along it in that quadrant [m/s].
    """
    made: dict[str, float] = {}
    records = _with_orders(records, layout)
    for name, samples in (
        ("yaw_rate", [np.abs(r["r"]) for r in records if "r" in r]),
        ("drift", [np.abs(np.arctan2(-r["v"], r["u"])) for r in records if {"u", "v"} <= set(r.channels)]),
        ("rudder", [np.abs(r["delta"]) for r in records if "delta" in r]),
    ):
        if samples:
            made[name] = float(np.nanpercentile(np.concatenate(samples), REACH_PERCENTILE))
    for name, channel in _IN_WAVES.items() if any("zeta" in r for r in records) else ():
        samples = [np.abs(r[channel] - np.nanmean(r[channel])) for r in records if channel in r]
        made |= {name: float(np.nanpercentile(np.concatenate(samples), REACH_PERCENTILE))} if samples else {}
    steered = [to_starboard(r, "delta") for r in records if "delta" in r]
    for side, sign in zip(SIDES, (-1.0, 1.0), strict=True) if steered else ():
        angles = np.maximum(sign * np.concatenate(steered), 0.0)
        made[f"rudder to {side}"] = float(np.nanpercentile(angles, REACH_PERCENTILE))
    rolls = [float(np.nanmax(np.abs(r["phi"]))) for r in records if "phi" in r]
    if rolls:
        made["roll"] = max(rolls)
    speeds = [_speed(r) for r in records if "u" in r]
    if speeds:
        flow = np.concatenate(speeds)
        made["fastest"] = float(np.nanpercentile(flow, REACH_PERCENTILE))
        made["slowest"] = float(np.nanpercentile(flow, 100.0 - REACH_PERCENTILE))
    for name, conditions in thruster_conditions(layout, records).items():
        ranges = {"ahead": conditions.order, "astern": -conditions.order} | conditions.quadrants()
        for kind, samples in ranges.items():
            made[f"{COMMAND}{name} {kind}"] = float(np.percentile(np.maximum(samples, 0.0), REACH_PERCENTILE))
    return made


def _with_orders(records: Sequence[Record], layout: str) -> Sequence[Record]:
    """Records of a craft that thrusters steer by their angle, with the order of it as that of a rudder."""
    return [with_steering_order(r, ThrusterLayout.from_text(layout)) for r in records] if layout else records


def _speed(record: Record) -> Array:
    return np.hypot(record["u"], record["v"]) if "v" in record else np.abs(record["u"])


def with_recorded_speed(simulated: Record, measured: Record) -> Record:
    """Return the simulated run with the measured surge speed where the model has none of its own (steering, roll)."""
    if "u" in simulated or "u" not in measured:
        return simulated
    return simulated.with_channel("u", measured.channel("u"))


def extrapolation(predicted: Record, training_envelope: Mapping[str, float], layout: str = "") -> Extrapolation | None:
    """Ratios of a run's `motion_envelope` to that of the training runs; None where nothing can be compared.

    That of the slowest speed is turned round, so that a run that goes half as fast as any training run has 2; the last
    tenth of the speed down to rest adds nothing, or a run from rest would be infinitely far away. Commands and the
    quadrants of thrusters may not have been trained at all: theirs is 1 and `COMMAND_GAIN` times the distance beyond
    the training runs, as a share of full command, of quadrants also of their fastest speed. So may be a side of the
    rudder: a run that goes there as far as the training runs went to the other side has 2 where they never went there.
    """
    own = _ranges([predicted], layout)
    both = {n: (own[n], training_envelope[n]) for n in own if training_envelope.get(n, 0.0) > NEGLIGIBLE.get(n, 0.0)}
    ratios = {n: both[n][0] / both[n][1] for n in ("yaw_rate", "drift", "rudder", "roll", *_IN_WAVES) if n in both}
    for name in (f"rudder to {side}" for side in SIDES) if "rudder" in both else ():
        reach = both["rudder"][1]
        beyond = min(own[name], reach) - training_envelope.get(name, reach)
        if beyond > NEGLIGIBLE["rudder"]:
            ratios[name] = 1.0 + beyond / reach
    if {"fastest", "slowest"} <= set(both):
        ratios["fastest"] = both["fastest"][0] / both["fastest"][1]
        rest = max(REST_SHARE * both["fastest"][1], NEGLIGIBLE["slowest"])
        ratios["slowest"] = max(both["slowest"][1], rest) / max(both["slowest"][0], rest)
        fastest = both["fastest"][1]
        for name in (n for n in own if n.startswith(COMMAND) and n in training_envelope):
            reach = fastest if ", moving " in name else 1.0
            ratios[name] = 1.0 + COMMAND_GAIN * max(own[name] - training_envelope[name], 0.0) / reach
    return Extrapolation(max(ratios.values()), ratios) if ratios else None


def extrapolation_index(predicted: Record, training: Sequence[Record], layout: str = "") -> float:
    """Extrapolation index of a run against others; 1 where nothing can be compared."""
    found = extrapolation(predicted, _ranges(training, layout), layout)
    return found.index if found else 1.0
