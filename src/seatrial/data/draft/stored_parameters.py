"""What an autopilot's parameters, stored in its log, say of outputs and antennas."""

from collections.abc import Mapping
from dataclasses import dataclass

_MIDDLE = 0.1  # of the range, by which a trim may differ from its middle and still have two directions; chosen
# ArduPilot, libraries/SRV_Channel/SRV_Channel.h: number of a function -> what the output drives
_ARDUPILOT = {
    4: "aileron", 19: "elevator", 21: "rudder", 26: "rudder", 70: "throttle", 73: "left throttle",
    74: "right throttle", 89: "main sail", **{32 + k: f"motor {k}" for k in range(1, 9)},
}  # fmt: skip
# PX4, parameter reference, PWM_MAIN_FUNC1: the first motor and the first servo, of twelve and eight
_PX4_MOTOR, _PX4_MOTORS, _PX4_SERVO, _PX4_SERVOS = 101, 12, 201, 8
PX4_MAIN_OUTPUTS = 8
"""Outputs of the first bank (MAIN, of the IO processor) of a PX4 board; those of the second (AUX) are counted on."""
_PX4_BANKS = ("MAIN", "AUX")
_RUDDER = "rudder"
# GNSS antennas from the autopilot, forward and to starboard [m]: names since version 4.6 of ArduPilot, and before
_ANTENNAS = (("GPS1_POS_X", "GPS1_POS_Y"), ("GPS_POS1_X", "GPS_POS1_Y"))


@dataclass(frozen=True)
class OutputSetting:
    """One output of an autopilot.

    Attributes:
        drives: what; empty where the log does not say.
        zero, span: pulse at rest and from there to full [us]; a span of 0: the log does not say.
        is_reversed: whether a larger pulse means less.
        evidence: which parameters say so.
    """

    drives: str
    zero: float
    span: float
    is_reversed: bool
    evidence: str

    @property
    def is_rudder(self) -> bool:
        """Whether it steers."""
        return self.drives == _RUDDER


@dataclass(frozen=True)
class AntennaPlace:
    """Where a GNSS antenna is from the autopilot, m forward and to starboard."""

    x: float
    y: float
    evidence: str


def output_setting(parameters: Mapping[str, float], number: int) -> OutputSetting | None:
    """Return the setting of an output counted from 1, None where no parameter mentions it."""
    return _ardupilot_output(parameters, number) or _px4_output(parameters, number)


def is_disabled(parameters: Mapping[str, float], number: int) -> bool:
    """Return whether an output is stated to drive nothing."""
    bank, place = _px4_bank(parameters, number)
    names = (f"SERVO{number}_FUNCTION", f"PWM_{bank}_FUNC{place}")
    return any(parameters.get(name) == 0.0 for name in names)


def _px4_bank(parameters: Mapping[str, float], number: int) -> tuple[str, int]:
    """The bank of an output, MAIN or AUX, and its number in it; the first outputs are AUX where only these do anything.

    PX4 starts the IO processor before the flight controller's own outputs (ROMFS, init.d/rcS), so that its outputs are
    the first topic; without one all are AUX or all are MAIN.
    """
    if number > PX4_MAIN_OUTPUTS:
        return "AUX", number - PX4_MAIN_OUTPUTS
    drives = {bank: any(v for k, v in parameters.items() if k.startswith(f"PWM_{bank}_FUNC")) for bank in _PX4_BANKS}
    return ("AUX" if drives["AUX"] and not drives["MAIN"] else "MAIN"), number


def antenna_place(parameters: Mapping[str, float]) -> AntennaPlace | None:
    """Return where the first antenna is; None where the log does not say or says that it is at the autopilot."""
    for x, y in _ANTENNAS:
        if parameters.get(x) or parameters.get(y):
            return AntennaPlace(parameters.get(x, 0.0), parameters.get(y, 0.0), f"{x} and {y}, from the autopilot")
    return None


def _ardupilot_output(parameters: Mapping[str, float], number: int) -> OutputSetting | None:
    keys = {key: f"SERVO{number}_{key}" for key in ("FUNCTION", "TRIM", "MIN", "MAX", "REVERSED")}
    stated = {key: parameters[name] for key, name in keys.items() if name in parameters}
    if not stated:
        return None
    zero, span, is_reversed = 0.0, 0.0, bool(stated.get("REVERSED", 0.0))
    if {"TRIM", "MIN", "MAX"} <= set(stated) and stated["MIN"] < stated["MAX"]:
        ends = stated["MAX"], stated["MIN"]
        zero, span = _rest_and_span(stated["TRIM"], *(ends[::-1] if is_reversed else ends))
    drives = _ARDUPILOT.get(int(stated.get("FUNCTION", 0.0)), "")
    return OutputSetting(drives, zero, span, is_reversed, _listed(f"SERVO{number}_", list(stated), drives))


def _px4_output(parameters: Mapping[str, float], number: int) -> OutputSetting | None:
    bank, place = _px4_bank(parameters, number)
    function = int(parameters.get(f"PWM_{bank}_FUNC{place}", 0.0))
    is_motor = _PX4_MOTOR <= function < _PX4_MOTOR + _PX4_MOTORS
    if not is_motor and not _PX4_SERVO <= function < _PX4_SERVO + _PX4_SERVOS:
        return None
    index = function - (_PX4_MOTOR if is_motor else _PX4_SERVO)
    low, high = (parameters.get(f"PWM_{bank}_{key}{place}") for key in ("MIN", "MAX"))
    is_two_way = not is_motor or bool(int(parameters.get("CA_R_REV", 0.0)) >> index & 1)
    zero, span = 0.0, 0.0
    if low is not None and high is not None and low < high:
        zero, span = (0.5 * (low + high), 0.5 * (high - low)) if is_two_way else (low, high - low)
    is_reversed = bool(int(parameters.get(f"PWM_{bank}_REV", 0.0)) >> (place - 1) & 1)
    drives = f"motor {index + 1}" if is_motor else f"servo {index + 1}"
    evidence = f"PWM_{bank}_FUNC{place}, _MIN{place}, _MAX{place} ({drives})" + _px4_place(parameters, index, is_motor)
    return OutputSetting(drives, zero, span, is_reversed, evidence)


def _px4_place(parameters: Mapping[str, float], index: int, is_motor: bool) -> str:
    x, y = (parameters.get(f"CA_ROTOR{index}_{key}") for key in ("PX", "PY"))
    if not is_motor or x is None or y is None:
        return ""
    return f", {x:g} m forward and {y:g} m to starboard (CA_ROTOR{index}_PX, _PY)"


def _rest_and_span(trim: float, ahead: float, astern: float) -> tuple[float, float]:
    """Pulse at rest and from there to full ahead [us]; the whole range where there is but one direction.

    ArduPilot, SRV_Channel::pwm_from_angle and pwm_from_range: a trim at one end belongs to an output of one direction.
    """
    if min(abs(trim - astern), abs(trim - ahead)) < _MIDDLE * abs(ahead - astern):
        return astern, abs(ahead - astern)
    return trim, abs(ahead - trim)


def _listed(prefix: str, keys: list[str], drives: str) -> str:
    names = ", ".join([f"{prefix}{keys[0]}", *(f"_{key}" for key in keys[1:])])
    return f"{names} of the log" + (f" ({drives})" if drives else "")
