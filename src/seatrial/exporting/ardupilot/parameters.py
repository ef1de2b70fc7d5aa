"""The parameter file: names, values and units of ArduPilot, with what they are based on in the comments before them."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from seatrial.core.values import NOTATION
from seatrial.exporting.ardupilot.choice import (
    LARGEST_MS,
    LARGEST_OVERSHOOT,
    ArduPilotTuning,
    SampledMargins,
    StepResponse,
    tune_ardupilot,
)
from seatrial.exporting.ardupilot.controller import (
    LOOP_RATE,
    SLEW_RATE,
    PidGains,
    SteeredCraft,
    steered_craft,
    unsuitable_for_ardupilot,
)
from seatrial.exporting.source import Export, ExportSource, provenance_lines, range_text, rendered, require_values

_BOAT = 2.0  # FRAME_CLASS (Rover/Parameters.cpp)
_STEERING_THROTTLE_MIX = 0.5  # MOT_STR_THR_MIX, default: steering and throttle give way alike (AP_MotorsUGV.cpp)
_LEAST_OFFSET = 0.05  # deg, of a rudder that is stated; chosen
_DIGITS = 6  # of a value: ArduPilot keeps single precision


@dataclass(frozen=True)
class ParameterLine:
    """A parameter, and what it is."""

    name: str
    value: float
    note: str

    @property
    def text(self) -> str:
        """The value as it is written."""
        return f"{self.value:.{_DIGITS}g}"


def export_ardupilot(source: ExportSource, name: str) -> Export:
    """Return ``name.param``, as ground stations load it.

    Raises:
        InputError: a parameter has no value, the craft has no straight run, or no gains keep it stable.
    """
    require_values(source)
    craft = steered_craft(source.file)
    tuning = tune_ardupilot(craft, source.gains)
    results = result_lines(craft, tuning)
    content = rendered(
        "ardupilot.param",
        head=[*provenance_lines(source), range_text(source)],
        assumptions=assumption_lines(craft, source.gains),
        results=results,
        parameters=parameter_lines(craft, tuning),
    )
    return Export({f"{name}.param": content}, (*results, range_text(source)))


def unsuitable_boat(source: ExportSource) -> str:
    """Return why ArduPilot has no place for a model; empty where it has one."""
    return unsuitable_for_ardupilot(source.file)


def parameter_lines(craft: SteeredCraft, tuning: ArduPilotTuning) -> tuple[ParameterLine, ...]:
    """Return the parameters in the order of the file."""
    gains = tuning.gains
    return (
        ParameterLine("FRAME_CLASS", _BOAT, "a boat"),
        ParameterLine("SCHED_LOOP_RATE", LOOP_RATE, "Hz"),
        ParameterLine("ATC_STR_ANG_P", gains.heading.angle_P, "1/s, yaw rate wanted for a heading error"),
        *_pid_lines("ATC_STR_RAT", gains.heading.rate, "rad/s"),
        ParameterLine("ATC_STR_RAT_MAX", math.degrees(gains.rate_max), "deg/s, of a turn at cruising speed"),
        ParameterLine("ATC_STR_ACC_MAX", math.degrees(gains.turn_acceleration), "deg/s^2, beginning that turn"),
        *_speed_lines(craft, tuning),
        *_motor_lines(craft),
    )


def _pid_lines(prefix: str, pid: PidGains, unit: str) -> tuple[ParameterLine, ...]:
    order = "steering" if prefix == "ATC_STR_RAT" else "throttle"
    return (
        ParameterLine(f"{prefix}_P", pid.P, f"{order}, -1 to 1, for an error of 1 {unit}"),
        ParameterLine(f"{prefix}_I", pid.I, f"the same for each second of an error of 1 {unit}"),
        ParameterLine(f"{prefix}_D", pid.D, f"s, the same for an error that grows by 1 {unit} a second"),
        ParameterLine(f"{prefix}_FF", pid.FF, f"the same for a wanted 1 {unit}"),
        ParameterLine(f"{prefix}_IMAX", pid.integral_limit, "largest part of the integral"),
        ParameterLine(f"{prefix}_FLTT", pid.target_filter, "Hz, 0: none"),
        ParameterLine(f"{prefix}_FLTE", pid.error_filter, "Hz"),
        ParameterLine(f"{prefix}_FLTD", pid.derivative_filter, "Hz, 0: none"),
    )


def _speed_lines(craft: SteeredCraft, tuning: ArduPilotTuning) -> tuple[ParameterLine, ...]:
    speed = (ParameterLine("CRUISE_SPEED", craft.speed, "m/s"),)
    if tuning.gains.speed is None:
        return speed
    return (
        *speed,
        ParameterLine("CRUISE_THROTTLE", 100.0 * craft.cruise_throttle, "%"),
        *_pid_lines("ATC_SPEED", tuning.gains.speed, "m/s"),
        ParameterLine("ATC_ACCEL_MAX", tuning.gains.speed_acceleration, "m/s^2, of the wanted speed"),
        ParameterLine("ATC_BRAKE", float(craft.is_skid), "1: the throttle may reverse"),
    )


def _motor_lines(craft: SteeredCraft) -> tuple[ParameterLine, ...]:
    lines = [
        ParameterLine("MOT_SLEWRATE", 100.0 * SLEW_RATE, "% of full throttle a second"),
        ParameterLine("MOT_THR_MAX", 100.0, "%"),
        ParameterLine("MOT_THR_MIN", 0.0, "%, what the thrusters do not answer is in the model"),
        ParameterLine("MOT_THST_EXPO", 0.0, "the thrust curve is in the model"),
    ]
    if craft.is_skid:
        return (
            *lines,
            ParameterLine("MOT_STR_THR_MIX", _STEERING_THROTTLE_MIX, "steering and throttle give way alike"),
        )
    return (
        *lines,
        ParameterLine("MOT_SPD_SCA_BASE", craft.scaling_speed, "m/s, above it steering falls with the speed"),
    )


def assumption_lines(craft: SteeredCraft, gains: Mapping[str, float] | None) -> tuple[str, ...]:
    """Return what the parameters take for granted of the craft's outputs, a sentence each."""
    chosen = (
        f"Gains: of a grid with Ms <= {LARGEST_MS:g}, least integral of time times error of a heading step."
        if gains is None
        else "Gains: those given, " + ", ".join(f"{n} {v:.4g}" for n, v in gains.items()) + ", as a cascade."
    )
    if craft.is_skid:
        outputs = (
            "Outputs: ThrottleLeft drives the thrusters to port, ThrottleRight those to starboard; 100 % is their full "
            "command."
        )
    else:
        outputs = _rudder_text(craft) + (_throttle_text(craft) if craft.throttle else "")
    delay = (
        f"Simulated at {LOOP_RATE:g} Hz on the nonlinear model, what a loop computes acting with the next "
        f"({1000.0 / LOOP_RATE:g} ms) and held over it; lags of sensors and of the state estimate are not in it and "
        "count against the delay margin."
    )
    return (chosen, outputs, delay)


def _rudder_text(craft: SteeredCraft) -> str:
    name, full = craft.ship.actuator, math.degrees(abs(craft.full_steering))
    trim = float(craft.ship.inputs[craft.model.input_names.index(name)])
    offset = math.degrees(trim * math.copysign(1.0, craft.full_steering))
    has_offset = abs(offset) >= _LEAST_OFFSET
    return (
        f"Outputs: full GroundSteering is {full:.3g} deg of '{name}' either way (SOLAS), positive steering turns to "
        f"starboard; it moves at {full * craft.steering_rate:.3g} deg/s"
        + (f"; steering 0 is {offset:.3g} deg, which keeps a straight course." if has_offset else ".")
    )


def _throttle_text(craft: SteeredCraft) -> str:
    unit = f" {NOTATION[craft.throttle].unit}" if craft.throttle in NOTATION else ""
    return (
        f" Throttle 100 % is taken as {craft.full_throttle:.4g}{unit} of '{craft.throttle}', twice that of the "
        "approach: where yours is another, multiply ATC_SPEED_P, ATC_SPEED_I and CRUISE_THROTTLE by "
        f"{craft.full_throttle:.4g} over it."
    )


def result_lines(craft: SteeredCraft, tuning: ArduPilotTuning) -> tuple[str, ...]:
    """Return margins and steps, a sentence each."""
    step = tuning.heading_step
    lines = [
        f"Heading at {craft.speed:.3g} m/s: {_margin_text(tuning.heading_margins)}.",
        f"Heading step of {math.degrees(step.step):.3g} deg: {_step_text(step, 'steering')}.",
    ]
    if tuning.draws:
        lines.append(
            f"Of {tuning.draws} craft drawn from the covariance of the fit the heading loop keeps "
            f"{tuning.stable_draws} stable."
        )
    if tuning.speed_margins is not None and tuning.speed_step is not None:
        lines.append(f"Speed: {_margin_text(tuning.speed_margins)}.")
        lines.append(f"Speed step of {tuning.speed_step.step:.3g} m/s: {_step_text(tuning.speed_step, 'throttle')}.")
    elif not craft.throttle:
        lines.append("Speed control: not in this file, since the model has no single input that drives the craft.")
    return tuple(lines)


def _margin_text(margins: SampledMargins) -> str:
    gain = f"gain margin {20.0 * math.log10(margins.gain):.3g} dB" if math.isfinite(margins.gain) else "any gain"
    phase = f"phase margin {math.degrees(margins.phase):.3g} deg" if math.isfinite(margins.phase) else "any phase"
    delay = f"delay margin {margins.delay:.3g} s" if math.isfinite(margins.delay) else "any delay"
    aim = f" (above the {LARGEST_MS:g} aimed at)" if margins.Ms > LARGEST_MS else ""
    return f"Ms {margins.Ms:.3g}{aim}, {gain}, {phase}, {delay}"


def _step_text(step: StepResponse, order: str) -> str:
    settling = (
        "does not settle within 5 %" if math.isnan(step.settling) else f"settles within 5 % in {step.settling:.3g} s"
    )
    aim = f" (above the {100.0 * LARGEST_OVERSHOOT:g} % aimed at)" if step.overshoot > LARGEST_OVERSHOOT else ""
    return (
        f"{settling}, overshoot {100.0 * step.overshoot:.2g} %{aim}, largest {order} {100.0 * step.largest_order:.3g} %"
    )
