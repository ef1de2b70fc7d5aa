"""Roll fins under a controller written from gains.toml alone: is their motion that of the page?

The simulator is this file's own. A sea is a sum of regular waves at equal steps of energy, each at its frequency of
encounter; the hull is a differential equation in short steps, the gyro's blocks are state-space forms in the same
steps; noise and steps of reading stand for a sample before them, the order for a sample and after the dead time, behind
its servo, within its limits of angle, rate and lift.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from measure import Line, at_most
from second_simulator import (
    DEGREE,
    QUICK,
    RMS,
    G,
    OwnActuator,
    OwnBlocks,
    OwnController,
    ittc_waves,
    print_lines,
    stalled,
    tuning_of,
)

from seatrial.control.front import Effort
from seatrial.core.values import Array
from seatrial.data.folder.gains_file import gains_toml

WAVES, SEAS, DURATION, RUN_IN = 600, 4, 600.0, 100.0  # of the simulator's own realisations; s
CUT = 1e-4  # of the energy at either end of the spectrum
STEP = 0.01  # s, of the simulator: a sixth of the gyro's 1/63 s


@dataclass(frozen=True)
class FinCraft:
    """A roll equation phi'' + 2 zeta w phi' + w^2 phi = w^2 (alpha_w + K alpha_f) with the published gyro and servo.

    noise: deg rms of each sample of the roll angle; dead_time, sample_s: s.
    """

    name: str
    omega: float
    damping: float
    K_alpha: float
    speed: float
    height: float
    heading: float
    sample_s: float
    dead_time: float
    noise: float = 0.0
    limit: float = 22.0
    rate: float = 25.0
    stall: float = 18.0

    def loop_file(self) -> str:
        """Return the loop file."""
        sensors = f'[sensors]\nnoise = {{ value = {self.noise}, unit = "deg" }}\n' if self.noise else ""
        den = (1.0 / self.omega**2, 2.0 * self.damping / self.omega, 1.0)
        return f"""
name = "{self.name}"
[plant]
roll = {{ num = [1.0], den = [{den[0]!r}, {den[1]!r}, {den[2]!r}] }}
speed = {self.speed}
[plant.fin]
K_alpha = {self.K_alpha}
[controller]
kind = "yu2014"
sample_s = {self.sample_s}
[actuator]
limit = {{ value = {self.limit}, unit = "deg" }}
rate = {{ value = {self.rate}, unit = "deg/s" }}
stall = {{ value = {self.stall}, unit = "deg" }}
dead_time = {self.dead_time}
[[seas]]
spectrum = "ittc"
height = {self.height}
heading = {{ value = {self.heading}, unit = "deg" }}
{sensors}"""


FINS = (
    FinCraft("ship of 100 m with fins", 0.8355, 0.1586, 0.256, 9.26, 3.3, 90.0, sample_s=0.1, dead_time=0.1),
    FinCraft("ship of 100 m with fins, noisy angle", 0.8355, 0.1586, 0.256, 9.26, 3.3, 90.0, sample_s=0.1,
             dead_time=0.1, noise=0.05),
    FinCraft("patrol boat with fins", 1.6, 0.10, 0.5, 12.0, 1.2, 120.0, sample_s=0.05, dead_time=0.05),
)  # fmt: skip


def wave_slopes(craft: FinCraft, seed: int) -> Array:
    """Return the slope of one sea across the craft [rad] at every step: ITTC's spectrum of one parameter."""
    rng = np.random.default_rng([seed, 2147])
    omega, amplitude = ittc_waves(craft.height, WAVES, rng, CUT, 1.0 - CUT)
    beta = craft.heading * DEGREE
    met = omega - omega**2 / G * craft.speed * math.cos(beta)
    slope = omega**2 / G * math.sin(beta) * amplitude
    phase = 2.0 * math.pi * rng.random(WAVES)
    t = STEP * np.arange(round((DURATION + RUN_IN) / STEP))
    return sum(s * np.cos(w * t + p) for s, w, p in zip(slope, met, phase, strict=True))


def roll_rms(craft: FinCraft, text: str | None, slopes: Array, seed: int) -> float:
    """Return the rms of roll in a sea, under the controller of gains.toml or without any."""
    own = None if text is None else OwnController(text)
    servo = OwnBlocks([((550.0,), (1.0, 15.0, 225.0))], STEP)  # as published
    sensor = None if own is None else OwnBlocks([(b["num"], b["den"]) for b in own.sensor], STEP)
    rng, every = np.random.default_rng([seed, 47]), 1 if own is None else round(own.T / STEP)
    fin = OwnActuator(STEP, own.dead_time if own else 0.0, lambda order: servo.move(order, order),
                      craft.limit * DEGREE, craft.rate * DEGREE)  # fmt: skip
    phi = p = order = misread = lift = seen = 0.0
    w, made = craft.omega, np.empty(len(slopes))
    for k, slope in enumerate(slopes.tolist()):
        made[k] = phi
        if own is not None and sensor is not None:
            if k % every == 0:
                misread = craft.noise * DEGREE * float(rng.standard_normal())
                order = own.order(sensor.shown(-phi - misread), 0.0)
            seen, lift = phi, fin.move(order)
        push = w * w * (slope + craft.K_alpha * stalled(lift, craft.stall * DEGREE))
        middle = p + 0.5 * STEP * (push - 2.0 * craft.damping * w * p - w * w * phi)
        half = phi + 0.5 * STEP * p
        p += STEP * (push - 2.0 * craft.damping * w * middle - w * w * half)
        phi += STEP * middle
        if sensor is not None:
            sensor.move(-seen - misread, -phi - misread)
    return float(np.std(made[round(RUN_IN / STEP) :]))


def lines_of(crafts: Sequence[FinCraft], effort: Effort | None = None) -> list[Line]:
    """Return the lines of some crafts: what is left of the roll, page over simulator."""
    lines = []
    for craft in crafts:
        _, tuning = tuning_of(craft.loop_file(), effort=effort)
        page = 1.0 - float(np.mean(tuning.seaway_simulations[0].stalled))
        text = gains_toml(tuning)
        seas = [(wave_slopes(craft, seed), seed) for seed in range(SEAS)]
        left = np.mean([roll_rms(craft, text, *sea) / roll_rms(craft, None, *sea) for sea in seas])
        lines.append(at_most(f"{craft.name}: roll left {page:.3f}, page over simulator",
                             abs(100.0 * (page / float(left) - 1.0)), "%", RMS))  # fmt: skip
    return lines


def run() -> list[Line]:
    """Return the lines of the ship of 100 m, a sample of all."""
    return lines_of(FINS[:1], QUICK)


if __name__ == "__main__":
    for each in FINS:
        print_lines(lines_of([each], QUICK))
