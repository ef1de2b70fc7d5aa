"""Orders of a craft with thrusters: how far it is to go ahead and to turn, shared out over the thrusters.

Each thruster works for the order ahead to the side its thrust drives the craft, and for yaw to the side it turns it.
Azimuth thrusters and outboards point ahead, but for an order of their angle to starboard, which is that of a rudder. An
autopilot or a speed control gives such orders.
"""

import math
from dataclasses import dataclass, replace
from pathlib import Path

from seatrial.core.equations import Model
from seatrial.core.equations.bindings import Binding, Input, ModelEquations
from seatrial.core.equations.manifest import stored_equations
from seatrial.core.values import InputError
from seatrial.physics.models.thruster_layout import AngleInput, Thruster, ThrusterLayout
from seatrial.physics.models.thruster_steering import ORDER, steering_angles

AHEAD, YAW = "order_ahead", "order_yaw"
"""Inputs of `with_orders`: shares of full command, positive ahead and to starboard."""
_NO_MOMENT = 0.05
"""Arm over the longest one, and cosine of the angle, below which a thruster does not work for yaw or ahead; chosen."""


@dataclass(frozen=True)
class WorkShare:
    """What a thruster does of the orders: -1, 0 or 1 of that ahead and of that to starboard."""

    ahead: float
    yaw: float


def work_shares(layout: ThrusterLayout) -> tuple[WorkShare, ...]:
    """Return what each thruster does of the orders, in the order of the layout."""
    arms = [_arm(thruster) for thruster in layout.thrusters]
    longest = max(abs(arm) for arm in arms)
    drives = [math.cos(_angle(thruster)) for thruster in layout.thrusters]
    return tuple(
        WorkShare(
            math.copysign(1.0, drive) if abs(drive) > _NO_MOMENT else 0.0,
            math.copysign(1.0, arm) if abs(arm) > _NO_MOMENT * longest else 0.0,
        )
        for arm, drive in zip(arms, drives, strict=True)
    )


def with_orders(model: Model) -> Model:
    """Return a craft with thrusters driven by `AHEAD` and `YAW` in place of its commands.

    A thruster's share of full command is the sum of what it does of both; it is not limited here. A craft that is
    steered by angles has the input `ORDER` in place of these, too; other azimuth thrusters stay at 0.

    Raises:
        InputError: the model has no thrusters.
    """
    if not model.equations.layout:
        raise InputError(
            f"model '{model.name}' has no thrusters; orders ahead and to starboard are for craft with them"
        )
    layout = ThrusterLayout.from_text(model.equations.layout)
    # places are parameters, which the equations' hash does not hold, and decide who turns the craft to which side
    key = (model.equation_hash, "orders", work_shares(layout), steering_angles(layout))
    equations = stored_equations(key, lambda: _ordered(model, layout), (Path(__file__).parent,))
    return replace(model, equations=equations)


def _ordered(model: Model, layout: ThrusterLayout) -> ModelEquations:
    import sympy as sp

    old = model.equations
    commands = {t.command.channel for t in layout.thrusters}
    angles = {t.angle.channel for t in layout.thrusters if isinstance(t.angle, AngleInput)}
    ahead, yaw = sp.Symbol(AHEAD, real=True), sp.Symbol(YAW, real=True)
    orders = {
        f"order_{t.name}": share.ahead * ahead + share.yaw * yaw
        for t, share in zip(layout.thrusters, work_shares(layout), strict=True)
    }
    steers = {angle.channel: angle.sign * sp.Symbol(ORDER, real=True) for angle in steering_angles(layout)}
    turned = {sp.Symbol(name, real=True): steers.get(name, sp.Integer(0)) for name in {*angles, *steers}}

    def rewritten(binding: Binding) -> Binding:
        return binding.bound_to(
            orders.get(binding.name, binding.expression).subs(list(turned.items()), simultaneous=True)
        )

    kept = tuple(i for i in old.inputs if i.name not in {*commands, *angles, *steers})
    steering = (Input(ORDER),) if steers else ()
    return replace(
        old, name=f"{old.name} by orders", inputs=(Input(AHEAD), Input(YAW), *steering, *kept), layout="",
        bindings=tuple(map(rewritten, old.bindings)), rates=tuple(map(rewritten, old.rates)),
    )  # fmt: skip


def _angle(thruster: Thruster) -> float:
    return 0.0 if isinstance(thruster.angle, AngleInput) else thruster.angle


def _arm(thruster: Thruster) -> float:
    """Yaw moment of unit thrust [m], positive to starboard (Fossen 2021, section 9.1)."""
    angle = _angle(thruster)
    return thruster.x * math.sin(angle) - thruster.y * math.cos(angle)
