"""Manoeuvres of craft with thrusters: by an angle, as ships by their rudder, or by difference of thrust."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import InputError, Provenance, Record
from seatrial.physics.manoeuvres.programme import Programme, programme
from seatrial.physics.manoeuvres.thrust_programme import EXAMPLES, ThrustProgramme, thrust_programme
from seatrial.physics.models.thrust_orders import AHEAD as ORDER_AHEAD
from seatrial.physics.models.thrust_orders import YAW, with_orders, work_shares
from seatrial.physics.models.thruster_layout import ThrusterLayout
from seatrial.physics.models.thruster_steering import ORDER, steering_angles, with_steering_order
from seatrial.physics.simulate.approach import approach_speed, balancing_input, held_inputs
from seatrial.physics.simulate.channels import record_of
from seatrial.physics.simulate.replay import trajectory
from seatrial.physics.simulate.steer import SOLAS_SLEW_RATE, manoeuvre
from seatrial.physics.simulate.thrust import (
    AHEAD,
    DEFAULT_AHEAD,
    STEP_S,
    require_share,
    straight_by_thrusters,
    thrust_manoeuvre,
    undriven_inputs,
)

CraftProgramme = Programme | ThrustProgramme
_BY_ANGLE = ("zigzag:20/20", "consecutive-zigzags:5", "turning-circle:35", "pull-out:20", "spiral:25", "prbs:20")
_DRIVEN = ("straight:50", "stop:50")  # by thrust alone, whatever steers the craft


def craft_programme(layout: ThrusterLayout, text: str) -> CraftProgramme:
    """Return the programme that a text names for a craft: of its steering angle where it has one, else of its thrust.

    Raises:
        InputError: the text cannot be read, or the craft cannot do it.
    """
    kind = _kind(text)
    possible = craft_programmes(layout)
    if kind not in map(_kind, possible):
        reason = _reason(layout) if kind in (*EXAMPLES, *map(_kind, _BY_ANGLE)) else ""
        listed = ", ".join(possible)
        raise InputError(f"this craft cannot do the manoeuvre '{text}'{reason}; it can do {listed}")
    by_angle = steering_angles(layout) and kind in map(_kind, _BY_ANGLE)
    return programme(text) if by_angle else thrust_programme(text)


def craft_programmes(layout: ThrusterLayout) -> tuple[str, ...]:
    """Return an example of each programme that a craft can do, those that turn it first."""
    turns_by_thrust = any(share.yaw for share in work_shares(layout))
    if steering_angles(layout):
        return (*_BY_ANGLE, *(["spin:50"] if turns_by_thrust else []), *_DRIVEN)
    return (*(["spin:50", "zigzag:30/20"] if turns_by_thrust else []), *_DRIVEN)


def is_steered_by_angle(model: Model) -> bool:
    """Return whether a model goes through the manoeuvres of ships: by a rudder, or by thrusters that turn."""
    if "psi" not in model.states:
        return False
    layout = model.equations.layout
    return bool(steering_angles(ThrusterLayout.from_text(layout))) if layout else ORDER in model.input_names


def _kind(text: str) -> str:
    return text.strip().partition(":")[0]


def _reason(layout: ThrusterLayout) -> str:
    """Why one of the known programmes is none for a craft."""
    if steering_angles(layout):
        return ": its thrusters turn, and a difference of their thrust has no moment"
    if any(share.yaw for share in work_shares(layout)):
        return ": its thrusters are fixed, with no angle to order"
    return ": no thruster turns it"


def craft_manoeuvre(
    model: Model,
    orders: CraftProgramme,
    *,
    duration: float | None = None,
    speed: float | None = None,
    inputs: Mapping[str, float] | None = None,
    slew_rate: float = SOLAS_SLEW_RATE,
) -> Record:
    """Return the record of a craft with thrusters taken through a programme.

    One by an angle begins in the straight run of its order ahead, which is then held. Its record has the order itself,
    too, as channel ``delta``, so that it is measured as that of a rudder.

    Args:
        model: of equations with a thruster layout; orders: as `craft_programme` returns them for it.
        duration: s at the longest.
        speed: approach speed [m/s], of which the order ahead follows; None: that of the order ahead.
        inputs: other inputs held constant, by name in SI units, and ``ahead``, the order ahead.
        slew_rate: of the angles [rad/s].

    Raises:
        InputError: an input is missing or unknown, the craft does not reach the speed, or the simulation diverges.
    """
    given = dict(inputs or {})
    if speed is not None:
        if AHEAD in given:
            raise InputError(f"give the approach speed or the order {AHEAD}, not both")
        given[AHEAD] = order_at_speed(model, speed, given)
    if isinstance(orders, ThrustProgramme):
        return thrust_manoeuvre(model, orders, duration=duration, inputs=given)
    return _by_angle(model, orders, duration, given, slew_rate)


def order_at_speed(model: Model, speed: float, inputs: Mapping[str, float] | None = None) -> float:
    """Return the order ahead, a share of full command, at which a craft with thrusters goes straight at a speed [m/s].

    Raises:
        InputError: the speed is not positive, or beyond that at full command.
    """
    if not speed > 0.0:
        raise InputError(f"the approach speed {speed:g} m/s is not positive; a craft that is steered makes way")
    ordered = with_orders(model)
    held = partial(_held, ordered, inputs or {})
    if approach_speed(ordered, held(1.0)) < speed:
        most = approach_speed(ordered, held(1.0))
        raise InputError(f"the craft makes {most:.3g} m/s at full command, not {speed:g} m/s; give a lower --speed")
    return balancing_input(ordered, held(0.0), ORDER_AHEAD, speed)


def _held(ordered: Model, inputs: Mapping[str, float], ahead: float) -> np.ndarray:
    return held_inputs(ordered, {ORDER_AHEAD: ahead, YAW: 0.0, **inputs}, ORDER)


def _by_angle(
    model: Model, orders: Programme, duration: float | None, given: dict[str, float], slew_rate: float
) -> Record:
    layout = ThrusterLayout.from_text(model.equations.layout)
    angles = steering_angles(layout)
    ahead = require_share(given.pop(AHEAD, DEFAULT_AHEAD))
    further = undriven_inputs(model, layout, orders.text, given, driven=[angle.channel for angle in angles])
    ordered = manoeuvre(
        with_orders(model), orders, dt=STEP_S, duration=duration, slew_rate=slew_rate, length=layout.length,
        inputs={ORDER_AHEAD: ahead, YAW: 0.0, **further},
    )  # fmt: skip
    run = straight_by_thrusters(model, ahead, further)
    used = np.tile(run.inputs, (len(ordered), 1))
    for angle in angles:
        used[:, model.input_names.index(angle.channel)] = angle.sign * ordered[ORDER]
    states, outputs = trajectory(model, used, ordered.dt, run.state(model))
    record = with_steering_order(record_of(model, orders.text, ordered.time, states, outputs, used), layout)
    source = f"manoeuvre '{orders.text}' of model '{model.name}'"
    return replace(record, provenance=Provenance(source, steps=(f"ahead {ahead:g}", *ordered.provenance.steps)))
