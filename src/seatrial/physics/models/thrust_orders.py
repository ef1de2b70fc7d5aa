"""Orders of a craft with thrusters, its matrices, and forces from outside that its equations do not have."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.equations.bindings import Binding, Input, ModelEquations
from seatrial.core.equations.model import stored_equations
from seatrial.core.values import Array, InputError
from seatrial.physics.models.thruster_layout import (
    ORDER,
    AngleInput,
    Thruster,
    ThrusterLayout,
    layout_of,
    steering_angles,
)

# Orders of a craft with thrusters: how far it is to go ahead and to turn, shared out over the thrusters.

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
    if not model.has_thrusters:
        raise InputError(
            f"model '{model.name}' has no thrusters; orders ahead and to starboard are for craft with them"
        )
    layout = layout_of(model)
    # places are parameters, which the equations' hash does not hold, and decide who turns the craft to which side
    key = (model.equation_hash, "orders", work_shares(layout), tuple(steering_angles(layout).items()))
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
    steers = {channel: sign * sp.Symbol(ORDER, real=True) for channel, sign in steering_angles(layout).items()}
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


# A craft with thrusters that something outside pushes: gusts and waves, as forces that its equations do not have.

OUTSIDE_FORCES = ("X_outside", "Y_outside", "N_outside")
"""Inputs of `with_outside_forces`: force ahead and to starboard, moment to starboard, in the model's unit of force."""
_SUMS = ("X_sum", "Y_sum", "N_sum")  # bindings of the model `thrusters` that they are added to


def with_outside_forces(model: Model) -> Model:
    """Return a craft of the model ``thrusters`` with the inputs `OUTSIDE_FORCES` behind its own."""
    return replace(model, equations=stored_equations((model.equation_hash, "outside"), lambda: _pushed(model)))


def _pushed(model: Model) -> ModelEquations:
    import sympy as sp

    added = dict(zip(_SUMS, OUTSIDE_FORCES, strict=True))

    def rewritten(binding: Binding) -> Binding:
        if binding.name not in added:
            return binding
        return binding.bound_to(binding.expression + sp.Symbol(added[binding.name], real=True))

    old = model.equations
    return replace(
        old, name=f"{old.name} pushed from outside", inputs=(*old.inputs, *map(Input, OUTSIDE_FORCES)),
        bindings=tuple(map(rewritten, old.bindings)),
    )  # fmt: skip


# Matrices of M dnu/dt + C(M) nu + D(nu) nu = B T of a craft with thrusters, nu = (u, v, r), from its coefficients.


def inertia_matrix(model: Model) -> Array:
    """Return mass and added mass (3, 3) (Fossen 2021, eqs. (6.14) and (6.40), surge, sway and yaw)."""
    M_u, M_v, M_r, M_c = (model.parameters.value_of(f"M_{x}", 0.0) for x in "uvrc")
    return np.array([[M_u, 0.0, 0.0], [0.0, M_v, M_c], [0.0, M_c, M_r]])


def thrust_configuration(model: Model, thrusters: Sequence[Thruster], angles: Sequence[float]) -> Array:
    """Return B (3, n): rows of (cos a, sin a, x sin a - y cos a), the side force of the wash with them.

    angles: direction of each thrust clockwise from ahead [rad] (Fossen 2021, section 9.2).
    """
    X, Y = np.cos(angles), np.sin(angles)
    N = np.array([t.x for t in thrusters]) * Y - np.array([t.y for t in thrusters]) * X
    Y = Y + model.parameters.value_of("Y_T", 0.0) * X + model.parameters.value_of("Y_NT", 0.0) * N
    return np.stack([X, Y, N])
