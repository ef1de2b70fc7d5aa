"""Loops that follow a demand, gains and bounds from the plant: heading by rudder, speed by propulsion, pitch by fin.

Start values place poles (Fossen 2021, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., section 15.3)
on the plant of first or second order that has the same frequency response at the required natural frequency, so that
they hold for any plant and are the textbook's own for a Nomoto ship. Bounds are the same at other frequencies. All
frequencies are multiples of one that the plant's response shows where the loop works, so that plants with equal
responses there have equal gains, whatever their poles: where the heading moves as far as the rudder, where a speed
begins to lag, where pitch is largest.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from seatrial.core.values import Array, InputError, Parameter, Parameters
from seatrial.physics.loops.loop import Block, Term, TransferLoop

FOSSEN = "pole placement, Fossen 2021, section 15.3"
DAMPING_RATIO = 0.8  # of the closed loop, Fossen 2021, section 15.3
SLOWEST, START, FASTEST = 0.75, 1.5, 6.0  # bandwidths over the plant's working frequency: least, first, largest; chosen
_LARGEST_KD = 10.0  # over that which halves the motion at the resonance; chosen
_FILTER_RATIO = 0.1  # derivative filter's time constant times the largest bandwidth; chosen
_INTEGRAL_RATIO = 0.1  # KI over omega KP, Fossen 2021, section 15.3
_BAND, _SAMPLES = (1e-2, 1e2), 2000  # over the least and largest root: where a response is looked at; chosen
_TOLERANCE = 1e-14  # of the logarithm of a frequency that is sought: rounding
_NEGLIGIBLE_POLE = 1e-9  # of the largest pole, below which a pole counts as zero: rounding
_KEPT_PLANTS = 8  # whose working frequency is kept in memory: every run of a simulation asks for it; chosen
MEANINGS = {"KP": "proportional gain", "KI": "gain of the integral", "KD": "gain of the filtered derivative"}
UNITS = {"KP": "1", "KI": "1/s", "KD": "s"}
Gains = dict[str, float]
GainRange = tuple[float, float, float]


def speed_gains_at(plant: Block, omega: float) -> Gains:
    """Return KP, KI on the speed error that place the poles at omega [rad/s]; negative where the plant is reversed.

    plant: from the actuator to the speed.
    """
    inverse, slope = _equivalent_lag(plant, omega, integrators=0)
    return {"KP": 2.0 * DAMPING_RATIO * omega * slope - inverse, "KI": omega**2 * slope}


def heading_gains_at(plant: Block, omega: float, damping: float = DAMPING_RATIO) -> Gains:
    """Return KP, KI, KD on the heading error that place the poles at omega [rad/s] with that damping ratio.

    KP = omega^2 T / K, KD = (2 zeta omega T - 1) / K, KI = omega KP / 10 of the Nomoto ship K / (s (T s + 1)) that the
    plant, from the rudder to the heading, is at omega; negative where it is reversed.
    """
    inverse, slope = _equivalent_lag(plant, omega, integrators=1)
    KP = omega**2 * slope
    return {"KP": KP, "KI": _INTEGRAL_RATIO * omega * KP, "KD": 2.0 * damping * omega * slope - inverse}


def heading_loop(
    plant: Block,
    disturbance: Block,
    servo: tuple[Block, ...],
    *,
    name: str = "autopilot",
    parts: tuple[str, ...] = ("KP", "KI", "KD"),
    derivative_filter: float | None = None,
    shortest_filter: float = 0.0,
    delay: float = 0.0,
    integral_lag: float = math.inf,
    actuator: str = "delta",
    disturbance_input: str = "",
) -> TransferLoop:
    """Return PD or PID on the heading error: KP + KI / s + KD s / (tau s + 1), from psi to the rudder [rad].

    Args:
        plant: from the rudder to the heading; it may be unstable, and turn either way. parts: gains to have.
        derivative_filter: tau [s]; by default a tenth of 1 / omega of the fastest loop within the bounds, but no
            shorter than `shortest_filter` [s].
        delay: s, of dead time and half a sample, that no loop is fast against.
        integral_lag: T [s] of a slow lag T / (T s + 1) in place of 1 / s.

    Raises:
        InputError: the plant is of first order, parts are not those above, or a time constant is not positive.
    """
    if plant.order < 2:
        raise InputError(f"block '{plant.name}' is no heading: its denominator needs the integrator s from yaw rate")
    bandwidths = _bandwidths(plant, delay)
    gains, sign = _gain_ranges([heading_gains_at(plant, omega) for omega in bandwidths], "KP")
    tau = max(_FILTER_RATIO / bandwidths[-1], shortest_filter) if derivative_filter is None else derivative_filter
    names = ("psi", actuator, disturbance_input)
    return _pid_loop(name, plant, disturbance, servo, sign, gains, parts, tau, integral_lag, names)


def speed_loop(
    plant: Block,
    disturbance: Block,
    servo: tuple[Block, ...],
    *,
    name: str = "speed control",
    delay: float = 0.0,
    actuator: str = "n",
    disturbance_input: str = "",
) -> TransferLoop:
    """Return PI on the speed error, from u to the propulsion input (propeller rate or jet velocity, its SI unit).

    delay: as of `heading_loop`.

    Raises:
        InputError: the plant has no working frequency.
    """
    gains, sign = _gain_ranges([speed_gains_at(plant, omega) for omega in _bandwidths(plant, delay)], "KI")
    parts, names = ("KP", "KI"), ("u", actuator, disturbance_input)
    return _pid_loop(name, plant, disturbance, servo, sign, gains, parts, math.inf, math.inf, names)


def pitch_loop(
    plant: Block,
    disturbance: Block,
    servo: tuple[Block, ...],
    *,
    name: str = "pitch fin",
    parts: tuple[str, ...] = ("KP", "KI", "KD"),
    derivative_filter: float | None = None,
    shortest_filter: float = 0.0,
    output: str = "theta",
    actuator: str = "delta_f1",
    disturbance_input: str = "M5",
) -> TransferLoop:
    """Return PID on pitch (or heave) by a fin; gains in units of what the plant's resonance needs.

    KD of 1 / |omega P| at the resonance halves the motion there; KP of 1 / |P(0)| doubles the stiffness.

    Raises:
        InputError: the plant does not answer a constant fin angle, or parts are not those above.
    """
    if not (math.isfinite(plant.gain) and plant.gain):
        raise InputError(f"block '{plant.name}' has no restoring: a constant actuator gives no constant answer")
    top = _resonance(plant)
    there = complex(plant.frequency_response(np.array([top]))[0])
    damped = 1.0 / abs(there)
    start = {"KP": 0.0, "KI": 0.0, "KD": damped / top}
    stiff = 1.0 / abs(plant.gain)
    most = {"KP": 2.0 * stiff, "KI": 0.5 * top * stiff, "KD": _LARGEST_KD * damped / top}
    sign = math.copysign(1.0, (1.0 / there).imag)
    tau = max(_FILTER_RATIO / top, shortest_filter) if derivative_filter is None else derivative_filter
    gains = {gain: (0.0, start[gain], most[gain]) for gain in start}
    names = (output, actuator, disturbance_input)
    return _pid_loop(name, plant, disturbance, servo, sign, gains, parts, tau, math.inf, names)


@dataclass(frozen=True)
class FeedForward:
    """What the actuator needs to move the output as a reference does, without waiting for an error.

    a = level y + velocity y' + acceleration y'', of the reference y about the trim.
    """

    level: float
    velocity: float
    acceleration: float


def acceleration_feed_forward(plant: Block, omega: float) -> FeedForward:
    """Return the inverse of the lag K / (T s + 1) that the plant is at omega [rad/s], behind its integrator if any.

    Of a Nomoto ship (T r' + r) / K (Fossen 2021, section 15.3, reference feed-forward); of any plant that of the ship
    with the same frequency response at omega, which is to be that of the reference.
    """
    integrates = _integrators(plant) > 0
    inverse, slope = _equivalent_lag(plant, omega, integrators=int(integrates))
    return FeedForward(0.0, inverse, slope) if integrates else FeedForward(inverse, slope, 0.0)


@lru_cache(maxsize=_KEPT_PLANTS)
def working_frequency(plant: Block) -> float:
    """Return the frequency [rad/s] by which a loop on the plant is scaled, as its response shows it.

    Of a plant that integrates (heading by rudder) where the output moves as far as the actuator, the crossover of a
    proportional gain of one; of another (speed by propulsion) where it begins to lag.

    Raises:
        InputError: there is none.
    """
    return _unit_frequency(plant) if _integrators(plant) else lag_frequency(plant)


def _unit_frequency(plant: Block) -> float:
    """Return the lowest frequency [rad/s] at which the size of a plant that integrates falls to one."""
    omega = _frequencies(plant)
    size = np.abs(plant.frequency_response(omega))
    low, high = float(omega[0]), float(omega[-1])
    # outside all roots the response is a power of the frequency
    if size[0] < 1.0:
        return low * float(size[0]) ** (1.0 / _integrators(plant))
    below = np.flatnonzero(size < 1.0)
    if not below.size:
        return high * float(size[-1]) ** (1.0 / max(len(plant.den) - len(plant.num), 1))
    ends = np.log(omega[below[0] - 1 : below[0] + 1])
    found = brentq(
        lambda u: math.log(abs(complex(plant.frequency_response(np.array([math.exp(u)]))[0]))), *ends, xtol=_TOLERANCE
    )
    return math.exp(float(found))  # type: ignore[arg-type]


def _bandwidths(plant: Block, delay: float) -> tuple[float, float, float]:
    """Return the least, first and largest bandwidth [rad/s]: multiples of the working frequency, and slow for a delay.

    At the largest the delay costs a radian of phase at most; the others keep their ratio to it.
    """
    largest = FASTEST * working_frequency(plant)
    largest = min(largest, 1.0 / delay) if delay > 0.0 else largest
    return largest * SLOWEST / FASTEST, largest * START / FASTEST, largest


def lag_frequency(plant: Block) -> float:
    """Return the frequency [rad/s] from which on the plant, behind its integrators, lags by 45 degrees and more.

    1 / T of K / (T s + 1) and of a Nomoto ship; of any plant where the imaginary part of s^-n / P grows beyond the real
    one. A pole that a zero cancels does not count.

    Raises:
        InputError: there is none.
    """
    omega = _frequencies(plant)
    order = _integrators(plant)

    def excess(w: Array) -> Array:
        inverse = 1.0 / ((1j * w) ** order * plant.frequency_response(w))
        return np.abs(inverse.imag) - np.abs(inverse.real)

    lags = excess(omega) > 0.0
    begun = np.flatnonzero(~lags[:-1] & lags[1:])
    if not begun.size:
        raise InputError(
            f"block '{plant.name}' has no pole off the origin that its response shows; there is no frequency to scale "
            "gains by"
        )
    ends = np.log(omega[begun[0] : begun[0] + 2])
    found = brentq(lambda u: float(excess(np.exp(np.array([u])))[0]), *ends, xtol=_TOLERANCE)
    return math.exp(float(found))  # type: ignore[arg-type]


def _resonance(plant: Block) -> float:
    """Return the frequency [rad/s] of the largest response."""
    u = np.log(_frequencies(plant))

    def size(v: Array) -> Array:
        return np.abs(plant.frequency_response(np.exp(v)))

    place = int(np.argmax(size(u)))
    ends = u[max(place - 1, 0)], u[min(place + 1, len(u) - 1)]
    found = minimize_scalar(
        lambda v: -float(size(np.array([v]))[0]), bounds=ends, method="bounded", options={"xatol": _TOLERANCE}
    )
    return math.exp(float(found.x))


def _frequencies(plant: Block) -> Array:
    """Return frequencies [rad/s] over all that the plant's response does."""
    roots = np.abs(np.concatenate([plant.poles, np.roots(plant.num)]))
    some = roots[roots > _NEGLIGIBLE_POLE * roots.max(initial=0.0)]
    if not some.size:
        raise InputError(f"block '{plant.name}' has no pole off the origin; there is no frequency to scale gains by")
    return np.geomspace(_BAND[0] * some.min(), _BAND[1] * some.max(), _SAMPLES)


def _integrators(plant: Block) -> int:
    """Return the number of poles at the origin."""
    sizes = np.abs(plant.poles)
    return int(np.sum(sizes <= _NEGLIGIBLE_POLE * sizes.max(initial=0.0)))


def _equivalent_lag(plant: Block, omega: float, *, integrators: int) -> tuple[float, float]:
    """Return 1 / K and T / K of the lag K / (T s + 1), behind so many integrators, that P is at that frequency."""
    s = 1j * omega
    inverse = complex(1.0 / (s**integrators * plant.frequency_response(np.array([omega]))[0]))
    return inverse.real, inverse.imag / omega


def _gain_ranges(placements: list[Gains], leading: str) -> tuple[dict[str, GainRange], float]:
    """Lower bound, value and upper bound of each gain, none negative, and the sign of the plant.

    Only the leading gain has a lower bound: without it nothing holds the output.
    """
    low, start, most = placements
    sign = math.copysign(1.0, most[leading])
    made = {}
    for gain, value in most.items():
        upper = max(sign * value, 0.0) or abs(value)
        lower, begun = (min(max(sign * one[gain], 0.0), upper) for one in (low, start))
        made[gain] = (min(lower, begun) if gain == leading else 0.0, begun, upper)
    return made, sign


def _pid_loop(
    name: str, plant: Block, disturbance: Block, servo: tuple[Block, ...], sign: float,
    gains: dict[str, GainRange], parts: tuple[str, ...], tau: float, lag: float, names: tuple[str, str, str],
) -> TransferLoop:  # fmt: skip
    if not parts or set(parts) - set(gains):
        raise InputError(f"loop '{name}': its gains are {', '.join(gains)}, not {', '.join(parts) or 'none'}")
    if not (tau > 0.0 and lag > 0.0):
        raise InputError(f"loop '{name}': derivative filter {tau:g} s and integral lag {lag:g} s must be positive")
    blocks = {
        "KP": Block("proportional"),
        "KI": Block("integral", (1.0,), (1.0, 0.0)) if math.isinf(lag) else Block("slow lag", (lag,), (lag, 1.0)),
        "KD": Block("derivative", (1.0, 0.0), (tau, 1.0)) if math.isfinite(tau) else Block("none", (0.0,)),
    }
    output, actuator, disturbed_by = names
    return TransferLoop(
        name,
        sensor=(),
        terms=tuple(Term(gain, blocks[gain]) for gain in parts),
        filters=() if sign > 0.0 else (Block("reversed", (-1.0,)),),
        servo=servo,
        plant=plant,
        disturbance=disturbance,
        gains=Parameters(tuple(_gain_parameter(gain, *gains[gain]) for gain in parts)),
        output=output,
        actuator=actuator,
        disturbance_input=disturbed_by or actuator,
    )


def _gain_parameter(name: str, lower: float, value: float, upper: float) -> Parameter:
    return Parameter(name, value, UNITS[name], lower, upper, free=True, source=FOSSEN, meaning=MEANINGS[name])
