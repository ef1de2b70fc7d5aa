"""Thrust that no training run shows: its coefficients are held, not sought."""

from collections.abc import Sequence

from seatrial.core.equations import Model
from seatrial.core.text.words import enumeration
from seatrial.core.values import Finding, Record, Severity
from seatrial.physics.models.thruster_layout import Thruster, ThrusterLayout

_ASTERN = ("k_b", "p_b", "k_4")  # thrust at full command, exponent, loss with speed: docs/thrusters.md
_LEAST_ORDER = 0.02  # share of full command astern that drives a thruster, where it has no dead band; chosen


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


def _is_driven_astern(thruster: Thruster, record: Record) -> bool:
    command = thruster.command
    if command.channel not in record:
        return False
    order = (record[command.channel] - command.zero) / command.span
    return bool((order < -max(thruster.dead_band, _LEAST_ORDER)).any())
