"""Roll fins and ride control under a controller written from gains.toml alone: is their motion that of the page?

The simulator is this file's own. A sea is a sum of regular waves at equal steps of energy, each at its frequency of
encounter; the hull is a differential equation in short steps, the gyro's blocks are state-space forms in the same
steps; noise and steps of reading stand for a sample before them, the order for a sample and after the dead time, behind
its servo, within its limits of angle, rate and lift.
"""

import math
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from controllers_at_sea import DEGREE, QUICK, RMS, OwnController
from measure import Line, at_most

from seatrial import api
from seatrial.control.front import Effort
from seatrial.control.tune import tune
from seatrial.core.values import Array
from seatrial.data.folder.gains_file import gains_toml

G = 9.80665  # m/s^2, standard gravity
WAVES, SEAS, DURATION, RUN_IN = 600, 4, 600.0, 100.0  # of the simulator's own realisations; s
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


class OwnBlocks:
    """Blocks num / den in a row, as a companion form in steps of dt, for an input that runs straight over a step."""

    def __init__(self, blocks: Sequence[tuple[Sequence[float], Sequence[float]]], dt: float) -> None:
        num, den = np.ones(1), np.ones(1)
        for above, below in blocks:
            num, den = np.polymul(num, above), np.polymul(den, below)
        num, den = num / den[0], den / den[0]
        n = len(den) - 1
        num = np.concatenate([np.zeros(n + 1 - len(num)), num])
        self.direct, self.c = float(num[0]), num[1:] - num[0] * den[1:]
        A = np.eye(n, k=-1)
        A[0] = -den[1:]
        b = np.eye(n)[0]
        inverse = np.linalg.inv(np.eye(n) - 0.5 * dt * A)
        self.E, self.g = inverse @ (np.eye(n) + 0.5 * dt * A), inverse @ b * dt
        self.x, self.before = np.zeros(n), 0.0

    def move(self, begun: float, ended: float) -> float:
        """Return the output after a step in which the input went from one value to the other."""
        self.x = self.E @ self.x + 0.5 * (begun + ended) * self.g
        return self.shown(ended)

    def shown(self, value: float) -> float:
        """Return the output at an input."""
        return float(self.c @ self.x) + self.direct * value


def wave_slopes(craft: FinCraft, seed: int) -> Array:
    """Return the slope of one sea across the craft [rad] at every step: ITTC's spectrum of one parameter."""
    rng = np.random.default_rng([seed, 2147])
    A, B = 8.1e-3 * G**2, 3.11 / craft.height**2
    # energy below omega is A / (4 B) exp(-B / omega^4): equal shares, a random place in each
    share = (np.arange(WAVES) + rng.random(WAVES)) / WAVES * (1.0 - 2e-4) + 1e-4
    omega = (B / -np.log(share)) ** 0.25
    amplitude = np.full(WAVES, math.sqrt(2.0 * A / (4.0 * B) / WAVES))
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
    waiting = [0.0] * (0 if own is None else round(own.dead_time / STEP))
    limit, slew, stall = craft.limit * DEGREE, craft.rate * DEGREE * STEP, craft.stall * DEGREE
    phi = p = order = fin = served = misread = 0.0
    w, made = craft.omega, np.empty(len(slopes))
    for k, slope in enumerate(slopes.tolist()):
        made[k] = phi
        if own is not None and sensor is not None:
            if k % every == 0:
                misread = craft.noise * DEGREE * float(rng.standard_normal())
                order = own.order(sensor.shown(-phi - misread), 0.0)
            waiting.append(order)
            late = waiting.pop(0)
            served = servo.move(late, late)
            before, seen = fin, phi
            fin += min(max(min(max(served, -limit), limit) - fin, -slew), slew)
        lift = 0.5 * (before + fin) if own is not None else 0.0
        lift = math.copysign(min(abs(lift), max(2.0 * stall - abs(lift), 0.0)), lift)
        push = w * w * (slope + craft.K_alpha * lift)
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
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "loop.toml"
            path.write_text(craft.loop_file(), encoding="utf-8")
            tuning = tune(api.load_loop(path), effort=effort)
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
    for line in lines_of(FINS, QUICK):
        print(f"{line.quantity:<75} {line.value:>10.4g} {line.unit:<8} {line.verdict}", flush=True)
