"""A fin aft against vertical acceleration, its controller written from gains.toml alone: is what is left the page's?

The simulator is this file's own: heave and pitch as two coupled equations of motion in short steps, the waves' forces
on a box in closed form (the loop file has them as a table), a fin behind its servo within limits of angle, rate, lift.
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
from seatrial.core.values import Array, Ship
from seatrial.data.folder.gains_file import gains_toml
from seatrial.data.folder.model_file import ModelFile
from seatrial.physics.models import model_named

RHO = 1025.0  # kg/m^3, sea water
WAVES, SEAS, DURATION, RUN_IN = 600, 4, 600.0, 100.0  # of the simulator's own realisations; s
STEP = 0.01  # s, of the simulator
TABLED = 400  # frequencies of the table of forces
AXES = (("33", "35"), ("53", "55"))


@dataclass(frozen=True)
class RideCraft:
    """A craft with heave up and pitch bow down, (m + a) x'' + b x' + c x = F, a fin aft, a seat at x [m].

    inertia: m, I5; added, damping, stiffness: of heave on heave, pitch on heave, heave on pitch, pitch on pitch. lift:
    N for each rad; noise: deg rms of each sample of the pitch angle. Limits in deg, deg/s; servo: num, den.
    """

    name: str
    L: float
    B: float
    T: float
    inertia: tuple[float, float]
    added: tuple[float, float, float, float]
    damping: tuple[float, float, float, float]
    stiffness: tuple[float, float, float, float]
    lift: float
    fin: float
    seat: float
    speed: float
    height: float
    heading: float
    sample_s: float
    dead_time: float
    servo: tuple[tuple[float, ...], tuple[float, ...]] = ((225.0,), (1.0, 21.0, 225.0))
    noise: float = 0.0
    limit: float = 20.0
    rate: float = 30.0
    stall: float = 18.0

    @property
    def model(self) -> ModelFile:
        """The craft as an identified model."""
        names = [a + b for letter in "abc" for row in AXES for a, b in zip(letter * 2, row, strict=True)]
        values = dict(zip(names, (*self.added, *self.damping, *self.stiffness), strict=True))
        values |= {"m": self.inertia[0], "I5": self.inertia[1], "lift_1": self.lift, "x_f1": self.fin}
        return ModelFile(
            model_named("heave_pitch").with_values(values),
            ship=Ship(self.name, {"L": self.L, "B": self.B, "d": self.T}),
        )

    def loop_file(self) -> str:
        """Return the loop file."""
        sensors = f'[sensors]\nnoise = {{ value = {self.noise}, unit = "deg" }}\n' if self.noise else ""
        num, den = (list(side) for side in self.servo)
        return f"""
name = "{self.name}"
minimise = [{{ name = "vertical_acceleration", x = {self.seat} }}, "actuator_rate"]
[plant]
model = "model.toml"
output = "theta"
actuator = "delta_f1"
speed = {self.speed}
[controller]
kind = "pid"
parts = ["KP", "KD"]
sample_s = {self.sample_s}
[actuator]
limit = {{ value = {self.limit}, unit = "deg" }}
rate = {{ value = {self.rate}, unit = "deg/s" }}
stall = {{ value = {self.stall}, unit = "deg" }}
dead_time = {self.dead_time}
servo = [{{ num = {num}, den = {den} }}]
[excitation]
source = "table"
file = "forces.csv"
[[seas]]
spectrum = "ittc"
height = {self.height}
heading = {{ value = {self.heading}, unit = "deg" }}
{sensors}"""

    @property
    def highest(self) -> float:
        """Frequency of the shortest waves that there are: as long as six draughts [rad/s]."""
        return math.sqrt(G / self.T)

    def forces(self, omega: Array) -> tuple[Array, Array]:
        """Return force up and moment bow down of a metre of wave on a box, under the pressure at its bottom."""
        k = omega**2 / G
        q = k * math.cos(self.heading * DEGREE)
        half = 0.5 * self.L * q
        pressure = RHO * G * self.B * np.exp(-k * self.T)
        moment = 2j * pressure * (np.sin(half) - half * np.cos(half)) / q**2
        return pressure * self.L * np.sinc(half / math.pi) + 0j, moment

    def table(self) -> str:
        """Return the forces as a file."""
        omega = np.linspace(0.2, self.highest, TABLED)
        F3, M5 = self.forces(omega)
        columns = np.column_stack([omega, np.full(TABLED, self.heading), F3.real, F3.imag, M5.real, M5.imag])
        rows = (",".join(f"{x:.12g}" for x in row) for row in columns.tolist())
        return "\n".join(["omega,heading_deg,F3_real,F3_imag,M5_real,M5_imag", *rows]) + "\n"


_SHIP = RideCraft(
    "ship of 60 m", 60.0, 7.137, 2.27, (4.42e5, 9.945e7), (6.311e5, 3.281e6, 7.865e6, 1.525e8),
    (8.033e5, 9.429e6, -2.267e6, 2.091e8), (3.15e6, 6.83e6, 6.83e6, 6.54e8), lift=791060.0, fin=-25.0, seat=20.0,
    speed=9.26, height=1.5, heading=135.0, sample_s=0.05, dead_time=0.05,
)  # fmt: skip
RIDES = (
    _SHIP,
    RideCraft(
        "catamaran of 30 m", 30.0, 4.0, 1.2, (1.1e5, 6.0e6), (8.0e4, 2.0e5, 2.0e5, 4.5e6),
        (2.2e5, 4.0e5, -1.0e5, 1.3e7), (1.15e6, 1.0e6, 1.0e6, 7.5e7), lift=3.5e5, fin=-12.0, seat=10.0, speed=12.0,
        height=0.9, heading=180.0, sample_s=0.05, dead_time=0.05, noise=0.05,
    ),
)  # fmt: skip


def wave_forces(craft: RideCraft, seed: int) -> Array:
    """Return force and moment of one sea at every step, (2, n)."""
    rng = np.random.default_rng([seed, 3147])
    B = 3.11 / craft.height**2
    omega, amplitude = ittc_waves(craft.height, WAVES, rng, 1e-6, math.exp(-B / craft.highest**4))
    met = omega - omega**2 / G * craft.speed * math.cos(craft.heading * DEGREE)
    t = STEP * np.arange(round((DURATION + RUN_IN) / STEP))
    phase = np.exp(2j * math.pi * rng.random(WAVES)) * amplitude
    F3, M5 = (each * phase for each in craft.forces(omega))
    made = np.zeros((2, len(t)))
    for w, force, moment in zip(met, F3, M5, strict=True):
        turn = np.exp(1j * w * t)
        made += [(force * turn).real, (moment * turn).real]
    return made


def acceleration_rms(craft: RideCraft, text: str | None, waves: Array, seed: int) -> float:
    """Return the rms of the vertical acceleration at the seat, under the controller of gains.toml or without any."""
    own = None if text is None else OwnController(text)
    rng, every = np.random.default_rng([seed, 47]), 1 if own is None else round(own.T / STEP)
    servo = OwnBlocks([craft.servo], STEP)
    fin = OwnActuator(STEP, own.dead_time if own else 0.0, lambda order: servo.move(order, order),
                      craft.limit * DEGREE, craft.rate * DEGREE)  # fmt: skip
    M, B, C = (np.reshape(each, (2, 2)) for each in (craft.added, craft.damping, craft.stiffness))
    inverse = np.linalg.inv(M + np.diag(craft.inertia))
    by_x, by_v, by_fin = -inverse @ C, -inverse @ B, inverse @ [craft.lift, -craft.fin * craft.lift]
    pushed = (inverse @ waves).T
    x, v, order, made = np.zeros(2), np.zeros(2), 0.0, np.empty(len(pushed))
    at = np.array([1.0, -craft.seat])
    for k, push in enumerate(pushed):
        angle = 0.0
        if own is not None:
            if k % every == 0:
                # the pitch angle is read bow up
                order = own.order(x[1] - craft.noise * DEGREE * float(rng.standard_normal()), 0.0)
            angle = stalled(fin.move(order), craft.stall * DEGREE)
        push = push + by_fin * angle
        made[k] = at @ (by_x @ x + by_v @ v + push)
        middle = v + 0.5 * STEP * (by_x @ x + by_v @ v + push)
        half = x + 0.5 * STEP * v
        v = v + STEP * (by_x @ half + by_v @ middle + push)
        x = x + STEP * middle
    return float(np.std(made[round(RUN_IN / STEP) :]))


def lines_of(crafts: Sequence[RideCraft], effort: Effort | None = None) -> list[Line]:
    """Return the lines of some crafts: what is left of the acceleration, page over simulator."""
    lines = []
    for craft in crafts:
        _, tuning = tuning_of(craft.loop_file(), craft.model, effort, {"forces.csv": craft.table()})
        page, text = 1.0 - float(np.mean(tuning.seaway_simulations[0].stalled)), gains_toml(tuning)
        seas = [(wave_forces(craft, seed), seed) for seed in range(SEAS)]
        left = np.mean([acceleration_rms(craft, text, *sea) / acceleration_rms(craft, None, *sea) for sea in seas])
        lines.append(at_most(f"{craft.name}: acceleration left {page:.3f}, page over simulator",
                             abs(100.0 * (page / float(left) - 1.0)), "%", RMS))  # fmt: skip
    return lines


def run() -> list[Line]:
    """Return the lines of the ship of 60 m, a sample of all."""
    return lines_of(RIDES[:1], QUICK)


if __name__ == "__main__":
    for each in RIDES:
        print_lines(lines_of([each], QUICK))
