"""Craft with thrusters taken through a programme: who works how much, by an angle or by difference of thrust."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Provenance, Record, frozen, spelling_hint
from seatrial.physics.manoeuvres.programme import Programme, programme
from seatrial.physics.manoeuvres.thrust_programme import (
    EXAMPLES,
    FINISHED,
    LONGEST_S,
    ThrustProgramme,
    thrust_programme,
)
from seatrial.physics.models.thrust_orders import AHEAD as ORDER_AHEAD
from seatrial.physics.models.thrust_orders import YAW, with_orders, work_shares
from seatrial.physics.models.thruster_layout import (
    ORDER,
    AngleInput,
    ThrusterLayout,
    layout_of,
    steering_angles,
    with_steering_order,
)
from seatrial.physics.simulate.replay import record_of, require_bounded, trajectory
from seatrial.physics.simulate.states import approach_speed, balancing_input, held_inputs, settled_actuators
from seatrial.physics.simulate.steer import SOLAS_SLEW_RATE, manoeuvre, steer_programme

# Craft that are steered by thrusters taken through a programme: who works how much, and the run that follows.

AHEAD = "ahead"
"""Name of the order ahead of a zigzag, share of full command, among the constant inputs."""
DEFAULT_AHEAD = 0.5
"""Order ahead of a zigzag, share of full command; chosen."""
STEP_S = 0.05
"""Step of the simulation [s]: a quarter of a small thruster's time constant; chosen."""
_NUDGE = 1e-3  # rad/s, with which a straight run is disturbed: below any gyro's noise; chosen
_ORDER_STEP = 1e-6  # to which the order ahead of a speed is found; chosen
_LAST_SHARE = 0.1  # of a run, over which its yaw rate is averaged; chosen


@dataclass(frozen=True, eq=False)
class StraightRun:
    """A steady straight run of a craft with thrusters: speed ahead [m/s] and inputs (nu,), the model's signs."""

    speed: float
    inputs: Array

    def state(self, model: Model) -> Array:
        """Return the state (nx,) of it: thrusters settled, at this speed, at the origin."""
        state = settled_actuators(model, self.inputs)
        state[model.states.index("u")] = self.speed
        return state


def straight_by_thrusters(
    model: Model, ahead: float = DEFAULT_AHEAD, inputs: Mapping[str, float] | None = None
) -> StraightRun:
    """Return the run in which surge balances at an order ahead, a share of full command; no yaw, no drift.

    Args:
        inputs: other inputs by name, SI, as ``voltage``; names that the model does not have are left out.

    Raises:
        InputError: an input is missing, or the craft has no steady speed ahead.
    """
    layout = layout_of(model)
    rest = _at_rest(layout)
    further = {name: value for name, value in (inputs or {}).items() if name in model.input_names and name not in rest}
    held = held_inputs(model, rest | further, "")
    for row in _allocation(model, layout):
        held[int(row[0])] = row[1] + row[2] * row[3] * ahead
    return StraightRun(approach_speed(model, held), held)


def straight_at_speed(model: Model, speed: float, inputs: Mapping[str, float] | None = None) -> StraightRun:
    """Return the steady straight run at a speed [m/s]; that of full command where no order is as fast.

    Raises:
        InputError: as `straight_by_thrusters`.
    """
    from scipy.optimize import brentq

    def beyond(ahead: float) -> float:
        try:
            return straight_by_thrusters(model, ahead, inputs).speed - speed
        except InputError:  # it does not go ahead by so small an order
            return -speed

    if beyond(1.0) <= 0.0:
        return straight_by_thrusters(model, 1.0, inputs)
    return straight_by_thrusters(model, float(brentq(beyond, 0.0, 1.0, xtol=_ORDER_STEP)), inputs)


def settled_yaw_rate(model: Model, run: StraightRun) -> float:
    """Return the yaw rate [rad/s, positive to starboard] in which a straight run ends after a nudge to starboard.

    Raises:
        InputError: the simulation diverges.
    """
    start = run.state(model)
    start[model.states.index("r")] = _NUDGE
    steps = round(LONGEST_S / STEP_S)
    states, _ = trajectory(model, np.tile(run.inputs, (steps + 1, 1)), STEP_S, start)
    require_bounded(model, frozen(STEP_S * np.arange(steps + 1)), states, "a straight run")
    return float(np.mean(states[-round(_LAST_SHARE * steps) :, model.states.index("r")]))


def thrust_manoeuvre(
    model: Model,
    programme: ThrustProgramme,
    *,
    dt: float = STEP_S,
    duration: float | None = None,
    inputs: Mapping[str, float] | None = None,
) -> Record:
    """Return the record of a craft with thrusters taken through a programme.

    Spins and straight runs begin at rest, stops and zigzags in the steady straight run of their order ahead.

    Args:
        model: of equations with a thruster layout.
        duration: s at the longest; by default `LONGEST_S`, and it ends when the programme has finished.
        inputs: other inputs held constant, by name in SI units (``voltage``), and ``ahead`` of a zigzag; angles of
            azimuth thrusters are 0, ahead, and wind and current those of the model.

    Raises:
        InputError: an input is missing or unknown, the duration is no time, or the simulation diverges.
    """
    layout, given = layout_of(model), dict(inputs or {})
    takes_ahead = programme.ahead is None
    ahead = require_share(given.pop(AHEAD, DEFAULT_AHEAD)) if programme.ahead is None else programme.ahead
    undriven_inputs(model, layout, programme.text, given, takes_ahead=takes_ahead)
    thrusters = _allocation(model, layout)
    longest = LONGEST_S if duration is None else duration
    held = held_inputs(model, {**_at_rest(layout), **given}, "")
    start = np.zeros(len(model.states))
    if not programme.is_from_rest:
        run_up = thrust_programme(f"straight:{100.0 * ahead:g}") if ahead > 0.0 else None
        start = start if run_up is None else _steered(model, run_up, ahead, thrusters, start, held, dt, LONGEST_S)[1]
        start[[model.states.index(s) for s in ("psi", "x0", "y0")]] = 0.0
    used, _, finished = _steered(model, programme, ahead, thrusters, start, held, dt, longest)
    if len(used) < 2:
        raise InputError(f"manoeuvre '{programme.text}' ends where it begins: this craft does not move by its orders")
    time = frozen(dt * np.arange(len(used)))
    states, outputs = trajectory(model, used, float(time[-1] - time[0]) / (len(time) - 1), start)
    require_bounded(model, time, states, f"manoeuvre '{programme.text}'")
    simulated = record_of(model, programme.text, time, states, outputs, used)
    ending = f"finished at {time[-1]:g} s" if finished else f"not finished after {time[-1]:g} s"
    source = f"manoeuvre '{programme.text}' of model '{model.name}'"
    return replace(simulated, provenance=Provenance(source, steps=(f"ahead {ahead:g}", ending)))


def require_share(ahead: float) -> float:
    """Return an order ahead that is a share of full command.

    Raises:
        InputError: it is none.
    """
    if not 0.0 <= ahead <= 1.0:
        raise InputError(f"the order ahead {ahead:g} is no share of full command; give 0 to 1")
    return ahead


def undriven_inputs(
    model: Model, layout: ThrusterLayout, text: str, given: Mapping[str, float], *, driven: Sequence[str] = (),
    takes_ahead: bool = True,
) -> Mapping[str, float]:  # fmt: skip
    """Return inputs that are given for a manoeuvre, none of which it orders itself.

    Args:
        text: the manoeuvre; driven: angles that it orders besides the commands; takes_ahead: whether `AHEAD` may be
            given with it.

    Raises:
        InputError: one of them is ordered by the manoeuvre or no input of the model.
    """
    commands = [t.command.channel for t in layout.thrusters]
    free = [name for name in model.input_names if name not in {*commands, *driven}]
    allowed = [*free, *([AHEAD] if takes_ahead else [])]
    for name in given:
        if name in commands or name in driven:
            kind = "angle" if name in driven else "command"
            raise InputError(f"the manoeuvre '{text}' gives the {kind} '{name}' itself; do not set it")
        if name not in free:
            hint = spelling_hint(name, allowed) if allowed else "; nothing can"
            raise InputError(f"'{name}' cannot be set in the manoeuvre '{text}'{hint}")
    return given


def refuse_rudder_options(programme: ThrustProgramme, speed: float | None, rudder_rate: float | None) -> None:
    """Refuse what a programme by thrust alone does not have.

    Raises:
        InputError: a rudder rate is given, or an approach speed where the programme orders the thrust itself.
    """
    if speed is not None and programme.ahead is not None:
        raise InputError(
            f"the speed of the manoeuvre '{programme.text}' follows from its commands; leave --speed out and change "
            f"these, as in {EXAMPLES['stop']}"
        )
    if rudder_rate is not None:
        raise InputError(f"the manoeuvre '{programme.text}' turns no rudder and no thruster; leave --rudder-rate out")


def _at_rest(layout: ThrusterLayout) -> dict[str, float]:
    """Readings of all commands at rest, and angles ahead."""
    angles = {t.angle.channel: 0.0 for t in layout.thrusters if isinstance(t.angle, AngleInput)}
    return {t.command.channel: t.command.zero for t in layout.thrusters} | angles


def _allocation(model: Model, layout: ThrusterLayout) -> Array:
    """Table of the thrusters (n, 5): input, reading at rest, from there to full ahead, shares of ahead and of yaw."""
    rows = [
        (model.input_names.index(t.command.channel), t.command.zero, t.command.span, share.ahead, share.yaw)
        for t, share in zip(layout.thrusters, work_shares(layout), strict=True)
    ]
    return np.array(rows, dtype=np.float64)


def _steered(
    model: Model, programme: ThrustProgramme, ahead: float, thrusters: Array, start: Array, held: Array, dt: float,
    longest: float,
) -> tuple[Array, Array, bool]:  # fmt: skip
    """Return what `steer_programme` does."""
    memory = programme.memory(model.states.index("psi"), model.states.index("u"), ahead, thrusters)
    return steer_programme(model, programme, memory, FINISHED, dt, start, held, longest)


# Manoeuvres of craft with thrusters: by an angle, as ships by their rudder, or by difference of thrust.

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
    if not model.has_heading:
        return False
    return bool(steering_angles(layout_of(model))) if model.has_thrusters else model.has_rudder


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
    layout = layout_of(model)
    angles = steering_angles(layout)
    ahead = require_share(given.pop(AHEAD, DEFAULT_AHEAD))
    further = undriven_inputs(model, layout, orders.text, given, driven=list(angles))
    ordered = manoeuvre(
        with_orders(model), orders, dt=STEP_S, duration=duration, slew_rate=slew_rate, length=layout.length,
        inputs={ORDER_AHEAD: ahead, YAW: 0.0, **further},
    )  # fmt: skip
    run = straight_by_thrusters(model, ahead, further)
    used = np.tile(run.inputs, (len(ordered), 1))
    for channel, sign in angles.items():
        used[:, model.input_names.index(channel)] = sign * ordered[ORDER]
    states, outputs = trajectory(model, used, ordered.dt, run.state(model))
    record = with_steering_order(record_of(model, orders.text, ordered.time, states, outputs, used), layout)
    source = f"manoeuvre '{orders.text}' of model '{model.name}'"
    return replace(record, provenance=Provenance(source, steps=(f"ahead {ahead:g}", *ordered.provenance.steps)))
