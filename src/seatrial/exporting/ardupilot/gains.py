"""Gains of ArduPilot's heading and speed control, and the same as a PID on the heading error.

ArduPilot, libraries/APM_Control/AR_AttitudeControl.cpp: the heading error times ATC_STR_ANG_P is the desired yaw rate,
which an AC_PID (ATC_STR_RAT_*) turns into steering, -1 to 1. Another AC_PID (ATC_SPEED_*) turns the speed error into
throttle.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from seatrial.core.values import InputError


@dataclass(frozen=True)
class PidGains:
    """An AC_PID: gains on the error, feed-forward of the target, and its three filters.

    Attributes:
        P, I, D, FF: per unit of error (rad/s or m/s); I per second, D times seconds.
        integral_limit: of the integral's part of the output.
        target_filter, error_filter, derivative_filter: cut-off frequencies [Hz]; 0: no filter.
    """

    P: float
    I: float  # noqa: E741
    D: float = 0.0
    FF: float = 0.0
    integral_limit: float = 1.0
    target_filter: float = 0.0
    error_filter: float = 0.0
    derivative_filter: float = 0.0


@dataclass(frozen=True)
class CascadeGains:
    """The yaw rate wanted for each radian of heading error [1/s], 0 without a cascade, and what brings it about."""

    angle_P: float
    rate: PidGains


def cascade_from_pid(gains: Mapping[str, float], feed_forward: float, error_filter: float) -> CascadeGains:
    """Return the cascade that equals a PID with gains KP, KI, KD on the heading error, before its filters.

    With r = d(psi)/dt the cascade's output (P + FF) A e - P r + I (A int(e) - psi) has KP = (P + FF) A + I, KI = I A
    and KD = P; A is the larger root of (KD + FF) A^2 - KP A + KI = 0. Where no root is real the feed-forward gives way.

    Raises:
        InputError: the heading error has no gain, KD is negative, or no cascade equals the PID.
    """
    KP, KI, KD = (float(gains.get(name, 0.0)) for name in ("KP", "KI", "KD"))
    if not (KP > 0.0 and KI >= 0.0 and KD >= 0.0):
        raise InputError(f"a cascade needs KP > 0, KI >= 0 and KD >= 0, not {KP:.4g}, {KI:.4g} and {KD:.4g}")
    most = math.inf if KI == 0.0 else KP**2 / (4.0 * KI) - KD
    FF = min(feed_forward, most)
    if not (FF >= 0.0 and KD + FF > 0.0):
        raise InputError(
            f"no yaw-rate cascade equals KP {KP:.4g}, KI {KI:.4g}, KD {KD:.4g}: it needs KP^2 > 4 KD KI; tune with "
            "less KI"
        )
    A = (KP + math.sqrt(max(KP**2 - 4.0 * (KD + FF) * KI, 0.0))) / (2.0 * (KD + FF))
    return CascadeGains(A, PidGains(KD, KI / A, FF=FF, error_filter=error_filter))


def filter_share(frequency: float, dt: float) -> float:
    """Return the share of the way that a filter goes in a sample: dt / (dt + 1 / (2 pi f)), 1 for 0 Hz.

    AP_Math.cpp, calc_lowpass_alpha_dt.
    """
    return 1.0 if frequency == 0.0 else dt / (dt + 1.0 / (2.0 * math.pi * frequency))
