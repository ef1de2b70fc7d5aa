"""Thrust that no training run shows: its coefficients are held, not sought; and thrust shown at one order alone."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.text.numbers import percent, significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, Finding, Record, Severity
from seatrial.physics.models.thruster_layout import Thruster, ThrusterLayout

_ASTERN = ("k_b", "p_b", "k_4")  # thrust at full command, exponent, loss with speed: docs/thrusters.md
_LEAST_ORDER = 0.02  # share of full command astern that drives a thruster, where it has no dead band; chosen
_ORDER_PERCENTILES = (10.0, 90.0)  # of the orders to one side: between them lie those that are held, not slews; chosen
_ONE_ORDER = 0.1  # share of full command between these percentiles up to which there was one order; chosen


@dataclass(frozen=True)
class _Side:
    """One direction of thrust: its name, the sign of its orders, and the two coefficients of its curve."""

    name: str
    sign: float
    symbols: tuple[str, str]


_SIDES = (_Side("ahead", 1.0, ("k_f", "p_f")), _Side("astern", -1.0, ("k_b", "p_b")))


def with_unexcited_thrust_held(model: Model, records: Sequence[Record]) -> tuple[Model, tuple[Finding, ...]]:
    """Return the model with the thrust astern of thrusters that no record drives astern held, and a finding of each.

    Without an order astern these coefficients change nothing, and a search carries them anywhere. A coefficient with a
    prior stays free. Models without thrusters are returned as they are.
    """
    if not model.equations.layout:
        return model, ()
    layout, findings = ThrusterLayout.from_text(model.equations.layout), list[Finding]()
    for leader in layout.leaders:
        alike = [t for t in layout.thrusters if layout.leader(t) is leader]
        symbols = [symbol + layout.suffix(leader) for symbol in _ASTERN]
        held = [p.name for p in model.parameters.free if p.name in symbols and p.prior is None]
        if not held or any(_is_driven_astern(t, r) for t in alike for r in records):
            continue
        names = " or ".join(t.name for t in alike)
        model = model.with_parameters(model.parameters.fixed(*held))
        findings.append(
            Finding(
                Severity.WARNING, "no-thrust-astern", f"no training run has an order astern of {names}: "
                f"{enumeration(held)} are held where they start", "",
                "train on a run with orders astern, or simulate none with this model",
            )
        )  # fmt: skip
    return model, tuple(findings)


def single_order_findings(model: Model, records: Sequence[Record]) -> tuple[Finding, ...]:
    """Return a warning `single-order` for each curve of thrust whose both coefficients are free on one order alone.

    At one order any exponent fits with the thrust at full command that goes with it; elsewhere the curve is a guess.
    """
    if not model.equations.layout:
        return ()
    layout, free = ThrusterLayout.from_text(model.equations.layout), {p.name for p in model.parameters.free}
    findings = list[Finding]()
    for leader in layout.leaders:
        alike = [t for t in layout.thrusters if layout.leader(t) is leader]
        for side in _SIDES:
            names = [symbol + layout.suffix(leader) for symbol in side.symbols]
            orders = np.concatenate([_orders(t, r, side.sign) for t in alike for r in records] or [np.zeros(0)])
            is_open = all(n in free and model.parameters[n].prior is None for n in names)
            if is_open and len(orders) and float(np.ptp(np.percentile(orders, _ORDER_PERCENTILES))) <= _ONE_ORDER:
                thrusters = " or ".join(t.name for t in alike)
                findings.append(_single_order(side, thrusters, names, float(np.median(orders))))
    return tuple(findings)


def _single_order(side: _Side, thrusters: str, names: Sequence[str], order: float) -> Finding:
    scale, exponent = names
    return Finding(
        Severity.WARNING, "single-order", f"the training runs hold orders {side.name} of {thrusters} only near "
        f"{percent(order)} % of full command: {scale} and {exponent} together give the thrust there, neither by itself",
        "", f"record a second order {side.name}, or fix {exponent} under [model.fixed]",
        f"thrust {side.name} at any other order is a guess: full command is {significant(1.0 / order, 2)} times that "
        "order",
    )  # fmt: skip


def _is_driven_astern(thruster: Thruster, record: Record) -> bool:
    return bool(len(_orders(thruster, record, -1.0)))


def _orders(thruster: Thruster, record: Record, sign: float) -> Array:
    """The orders to one side that drive a thruster, as positive shares of full command."""
    command = thruster.command
    if command.channel not in record:
        return np.zeros(0)
    order = sign * (record[command.channel] - command.zero) / command.span
    return order[order > max(thruster.dead_band, _LEAST_ORDER)]
