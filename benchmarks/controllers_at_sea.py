"""Controllers written from gains.toml alone, on the plant that was declared: do they do what their page says?

Heading and speed; fins and tracks have files of their own (`fins_at_sea`, `tracks_at_sea`). The simulator is its own:
difference equations as gains.toml prints them, a reference filter, an order that is held for a sample and acts after
the dead time, a lag as steering gear, limits of angle and rate, the noise and steps of what is read, the plant as
differential equations in short steps. Margins are its own, too: the plant's answer to the order of one sample, in the
same steps, transformed at each frequency.
"""

import argparse
import math
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from measure import Line, at_most
from second_simulator import (
    DEGREE,
    OVERSHOOT,
    PEAK,
    QUICK,
    RMS,
    SETTLING,
    OwnActuator,
    OwnController,
    gauss_markov,
    lag_of,
    print_lines,
    tuning_of,
)

from seatrial.control.front import Effort
from seatrial.core.results.tuning import Tuning
from seatrial.core.values import Array
from seatrial.data.folder.gains_file import gains_toml

SHORT = 0.02  # step of the simulator over the craft's fastest time constant, its gear's lag and its dead time, at most
FREQUENCIES = 2000  # at which the simulator's Ms is read off
CYCLES = 3000.0  # time constants of what disturbs, of the simulator's own realisation: 2 % of its rms


@dataclass(frozen=True)
class Craft:
    """A craft on its heading or speed y: states x' = A x + b a, y = c x, and what its loop file declares.

    Attributes:
        A, b, c: of the plant; response: num and den as the loop file gives them.
        sample_s: None: as the package chooses; gear: lag [s], 0: none.
        limit, rate, change, noise, resolution: in degrees, deg/s of a heading, else in the symbols' units.
        trim: of the actuator, rms, of the slow disturbance below `bandwidth` [rad/s].
    """

    name: str
    A: tuple[tuple[float, ...], ...]
    b: tuple[float, ...]
    c: tuple[float, ...]
    response: tuple[tuple[float, ...], tuple[float, ...]]
    speed: float
    limit: float
    rate: float
    dead_time: float
    change: float
    time_constant: float
    trim: float
    bandwidth: float
    sample_s: float | None = None
    gear: float = 0.0
    noise: float = 0.0
    resolution: float = 0.0
    output: str = "psi"
    actuator: str = "delta"
    parts_of_pid: str = '"KP", "KI", "KD"'
    settings: Sequence[str] = field(default_factory=tuple)

    @property
    def unit(self) -> float:
        """Return SI units in one of the declared amounts."""
        return DEGREE if self.output == "psi" else 1.0

    def amount(self, value: float, per: str = "") -> str:
        """Return an amount as a loop file has it."""
        return f'{{ value = {value}, unit = "deg{per}" }}' if self.output == "psi" else repr(value)

    def parts(self, T: float) -> int:
        """Return how many steps of the simulator make a sample of T [s]."""
        fastest = 1.0 / float(np.abs(np.linalg.eigvals(np.array(self.A))).max())
        times = (fastest, *(t for t in (5.0 * self.gear, 5.0 * self.dead_time) if t))
        return max(1, math.ceil(T / (SHORT * min(times))))

    def loop_file(self) -> str:
        """Return the loop file."""
        num, den = (", ".join(f"{c!r}" for c in side) for side in self.response)
        sample = "" if self.sample_s is None else f"sample_s = {self.sample_s}"
        gear = f"servo = [{{ lag = {self.gear} }}]" if self.gear else ""
        sensors = ""
        if self.noise or self.resolution:
            sensors = "[sensors]\n" + "".join(
                f"{key} = {self.amount(value)}\n"
                for key, value in (("noise", self.noise), ("resolution", self.resolution))
                if value
            )
        return f"""
name = "{self.name}"
[plant]
response = {{ num = [{num}], den = [{den}] }}
output = "{self.output}"
actuator = "{self.actuator}"
speed = {self.speed}
[controller]
kind = "pid"
parts = [{self.parts_of_pid}]
{sample}
[actuator]
limit = {self.amount(self.limit)}
rate = {self.amount(self.rate, "/s")}
dead_time = {self.dead_time}
{gear}
[[slow_disturbances]]
rms = {self.amount(self.trim)}
bandwidth = {self.bandwidth}
[demand]
change = {self.amount(self.change)}
time_constant = {self.time_constant}
{sensors}
{chr(10).join(self.settings)}
"""


def nomoto(name: str, K: float, T: float, **declared: Any) -> Craft:
    """Return a craft with T r' + r = K delta."""
    return Craft(
        name,
        A=((0.0, 1.0), (0.0, -1.0 / T)),
        b=(0.0, K / T),
        c=(1.0, 0.0),
        response=((K,), (T, 1.0, 0.0)),
        **declared,
    )


# A tanker unstable on its course at full size: (s + z) b over s (s + p) (s - q), q the pole that turns it away.
_B, _Z, _P, _Q = 2.2e-3, 0.022, 0.06, 2.0e-3  # 1/s^2, rad/s, rad/s, rad/s: of a VLCC's size
CRAFTS = (
    nomoto("RIB at 1 Hz", 1.0, 0.6, speed=12.0, limit=30.0, rate=20.0, dead_time=0.2, change=30.0, time_constant=1.0,
           trim=1.0, bandwidth=0.2, sample_s=1.0),
    nomoto("RIB at 10 Hz", 1.0, 0.6, speed=12.0, limit=30.0, rate=20.0, dead_time=0.2, change=30.0, time_constant=1.0,
           trim=1.0, bandwidth=0.2, sample_s=0.1),
    nomoto("patrol boat", 0.16, 4.0, speed=9.0, limit=35.0, rate=4.0, dead_time=0.5, change=60.0, time_constant=5.0,
           trim=2.0, bandwidth=0.05, gear=0.5),
    nomoto("patrol boat, noisy compass", 0.16, 4.0, speed=9.0, limit=35.0, rate=4.0, dead_time=0.5, change=60.0,
           time_constant=5.0, trim=2.0, bandwidth=0.05, gear=0.5, noise=0.1),
    Craft(
        "tanker unstable on its course",
        A=((0.0, 1.0, 0.0), (0.0, -(_P - _Q), 1.0), (0.0, _P * _Q, 0.0)),
        b=(0.0, _B, _B * _Z),
        c=(1.0, 0.0, 0.0),
        response=((_B, _B * _Z), (1.0, _P - _Q, -_P * _Q, 0.0)),
        speed=8.0, limit=35.0, rate=2.3, dead_time=1.0, change=20.0, time_constant=40.0, trim=1.0, bandwidth=0.01,
        gear=2.0,
    ),
    # 0.005 m/s of a log's noise, and a water jet's or propeller's own lag of 2 s
    Craft(
        "catamaran, speed",
        A=((-0.05,),),
        b=(0.2,),
        c=(1.0,),
        response=((4.0,), (20.0, 1.0)),
        speed=8.0, limit=1.0, rate=0.1, dead_time=0.5, change=1.0, time_constant=10.0, trim=0.05, bandwidth=0.05,
        sample_s=0.5, gear=2.0, noise=0.005, output="u", actuator="T", parts_of_pid='"KP", "KI"',
    ),
)  # fmt: skip


@dataclass(frozen=True)
class Run:
    """Heading and rudder [rad] at every step."""

    heading: Array
    rudder: Array
    dt: float


def simulate(
    craft: Craft, text: str, ordered: Callable[[float], float], duration: float, disturbance: Array | None = None,
    seed: int = 0,
) -> Run:  # fmt: skip
    """Return a run of the craft under the controller of gains.toml; disturbance: rudder [rad] at every step."""
    own, rng = OwnController(text), np.random.default_rng([seed, 47])
    parts = craft.parts(own.T)
    dt = own.T / parts
    A, b, c = (np.array(side, dtype=float) for side in (craft.A, craft.b, craft.c))
    x, gear = np.zeros(len(b)), lag_of(craft.gear, dt)
    actuator = OwnActuator(dt, craft.dead_time, gear, craft.limit * craft.unit, craft.rate * craft.unit)
    samples = math.ceil(duration / own.T)
    heading, moved = np.empty(samples * parts), np.empty(samples * parts)
    step, unit = np.eye(len(b)) + dt * A + 0.5 * dt * dt * (A @ A), craft.resolution * craft.unit
    push = dt * (b + 0.5 * dt * (A @ b))
    for k in range(samples):
        seen = float(c @ x) + craft.noise * craft.unit * float(rng.standard_normal())
        seen = unit * math.floor(seen / unit + 0.5) if unit else seen
        wanted, fed = own.follow(ordered(k * own.T))
        order = own.order(wanted - seen, fed)
        for j in range(parts):
            i = k * parts + j
            heading[i], moved[i] = c @ x, actuator.angle
            acting = actuator.move(order) + (0.0 if disturbance is None else float(disturbance[i]))
            x = step @ x + push * acting
    return Run(heading, moved, dt)


def largest_sensitivity(craft: Craft, text: str) -> float:
    """Return Ms of the sampled loop: 1 / |1 + C G| up to the Nyquist frequency.

    G is the transform of the heading's answer to an order of one sample: of its steps, over 1 - 1/z.
    """
    own = OwnController(text)
    T, parts = own.T, craft.parts(own.T)
    dt = T / parts
    A, b, c = (np.array(side, dtype=float) for side in (craft.A, craft.b, craft.c))
    step = np.eye(len(b)) + dt * A + 0.5 * dt * dt * (A @ A)
    push = dt * (b + 0.5 * dt * (A @ b))
    omega = np.geomspace(1e-4 / T, 0.999 * math.pi / T, FREQUENCIES)
    z = np.exp(1j * omega * T)
    # one sample's step of the plant with its gear as a matrix: the transform is a linear system at each z
    n, late = len(b), round(craft.dead_time / dt)
    size = n + 1 + late
    M, push_order, row = np.zeros((size, size)), np.zeros(size), np.zeros(size)
    share = 1.0 - math.exp(-dt / craft.gear) if craft.gear else 1.0
    M[:n, :n], row[:n] = step, c
    M[n, n] = 1.0 - share
    if late:
        M[n, n + late] = share
        M[n + 2 :, n + 1 : n + late] = np.eye(late - 1)
        push_order[n + 1] = 1.0
    else:
        push_order[n] = share
    served = M[n].copy()
    served[n] += 1.0
    M[:n] += np.outer(push, 0.5 * served)
    push_order[:n] = push * 0.5 * push_order[n]
    whole, kicks, power = np.eye(size), np.zeros(size), np.eye(size)
    for _ in range(parts):
        kicks, whole = kicks + power @ push_order, M @ whole
        power = M @ power
    plant = np.array([row @ np.linalg.solve(one * np.eye(size) - whole, kicks) for one in z])
    return float(np.max(1.0 / np.abs(1.0 + own.response(z) * plant)))


@dataclass(frozen=True)
class Difference:
    """What the page says less what the simulator does: points of overshoot, % of settling and rms, Ms."""

    craft: str
    overshoot: float
    settling: float
    heading: float
    rudder: float
    Ms: float


def difference(craft: Craft, tuning: Tuning) -> Difference:
    """Return page against simulator for one craft."""
    text, change = gains_toml(tuning), tuning.manoeuvres[0]
    T = tomllib.loads(text)["discrete"]["sample_s"]
    duration = float(change.record.time[-1])
    run = simulate(craft, text, lambda t: craft.change * craft.unit if t >= T * 0.5 else 0.0, duration)
    share = run.heading / (craft.change * craft.unit)
    over = max(0.0, float(share.max()) - 1.0)
    outside = np.flatnonzero(np.abs(share - 1.0) > 0.05)
    settles = run.dt * (outside[-1] + 1) - T if outside[-1] + 1 < len(share) else math.inf
    heading, rudder = _weather(craft, text)
    page = tuning.disturbance_simulations[0].limited
    return Difference(
        craft.name,
        100.0 * (change.overshoot - over),
        100.0 * (change.settling / settles - 1.0)
        if math.isfinite(settles) or change.settling == change.settling
        else 0.0,
        100.0 * (page["output"] / heading - 1.0),
        100.0 * (page["actuator"] / rudder - 1.0),
        tuning.chosen.Ms - largest_sensitivity(craft, text),
    )


def _weather(craft: Craft, text: str) -> tuple[float, float]:
    """Return the rms of heading and rudder in the slow disturbance, in the simulator's own realisation."""
    T = tomllib.loads(text)["discrete"]["sample_s"]
    parts = craft.parts(T)
    duration = CYCLES / craft.bandwidth
    count, first = math.ceil(duration / T) * parts, math.ceil(10.0 / craft.bandwidth / T) * parts
    met = gauss_markov(craft.trim * craft.unit, craft.bandwidth, T / parts, count, np.random.default_rng(47))
    run = simulate(craft, text, lambda _: 0.0, duration, met)
    heading, rudder = (math.sqrt(float(np.mean(one[first:] ** 2))) for one in (run.heading, run.rudder))
    return heading, rudder


def lines_of(crafts: Sequence[Craft], effort: Effort | None = None) -> list[Line]:
    """Return the lines of some crafts."""
    lines = []
    for craft in crafts:
        made = difference(craft, tuning_of(craft.loop_file(), effort=effort)[1])
        lines += [
            at_most(f"{craft.name}: overshoot, page less simulator", abs(made.overshoot), "points", OVERSHOOT),
            at_most(f"{craft.name}: settling, page over simulator", abs(made.settling), "%", SETTLING),
            at_most(f"{craft.name}: output rms in weather, page over simulator", abs(made.heading), "%", RMS),
            at_most(f"{craft.name}: actuator rms in weather, page over simulator", abs(made.rudder), "%", RMS),
            at_most(f"{craft.name}: Ms, page less simulator", abs(made.Ms), "", PEAK),
        ]
    return lines


def run() -> list[Line]:
    """Return the lines of the two fastest crafts, a sample of all."""
    return lines_of(CRAFTS[:2], QUICK)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="every craft, or those named")
    parser.add_argument("names", nargs="*")
    given = parser.parse_args().names
    for each in CRAFTS:
        if not given or each.name in given:
            print_lines(lines_of([each]))
