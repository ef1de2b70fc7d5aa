"""Craft that are steered by thrusters taken through a programme: who works how much, and the run that follows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Provenance, Record, frozen, spelling_hint
from seatrial.core.values.record import MAX_SAMPLES
from seatrial.numerics.kernels.feedback import steer
from seatrial.physics.manoeuvres.thrust_programme import (
    EXAMPLES,
    FINISHED,
    LONGEST_S,
    NOT_FINISHED,
    ThrustProgramme,
    thrust_programme,
)
from seatrial.physics.models.thrust_orders import work_shares
from seatrial.physics.models.thruster_layout import AngleInput, ThrusterLayout
from seatrial.physics.simulate.actuators import settled_actuators
from seatrial.physics.simulate.approach import approach_speed, held_inputs
from seatrial.physics.simulate.channels import record_of
from seatrial.physics.simulate.divergence import require_bounded
from seatrial.physics.simulate.replay import trajectory

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
    layout = ThrusterLayout.from_text(model.equations.layout)
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
    layout, given = ThrusterLayout.from_text(model.equations.layout), dict(inputs or {})
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
    """Inputs at the samples (n, nu), the last state (nx,), and whether the programme has finished."""
    if not 1.0 <= longest / dt < MAX_SAMPLES:
        raise InputError(f"a manoeuvre of {longest:g} s is not between 1 and {MAX_SAMPLES:.0e} steps of {dt:g} s")
    count = int(longest / dt) + 1
    states, inputs = np.empty((count, len(start))), np.empty((count, len(held)))
    memory = programme.memory(model.states.index("psi"), model.states.index("u"), ahead, thrusters)
    lost = steer(
        model.compiled.rates, programme.helmsman, start, held.copy(), model.parameters.values, memory, dt, states,
        inputs,
    )  # fmt: skip
    if lost >= 0:
        time = frozen(dt * np.arange(lost + 1))
        require_bounded(model, time, states[: lost + 1], f"manoeuvre '{programme.text}'")
    finished = memory[FINISHED] != NOT_FINISHED
    last = min(count, round(memory[FINISHED] / dt) + 1) if finished else count
    return np.ascontiguousarray(inputs[:last]), states[last - 1].copy(), bool(finished)
