"""Where thrusters worked: their commands and the speed of the water along them, sample by sample."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, Record
from seatrial.physics.models.thruster_layout import AngleInput, Thruster, ThrusterLayout


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
