"""A passive wave observer beside the notch: the least heading rms that each leaves at the same rudder rate and Ms.

Observer of heading, yaw rate and wave motion (Fossen & Strand 1999, Automatica 35(1), 3-16; gains of its wave part by
Fossen 2021, section 13.4), driven by heading and rudder angle; PID on its heading and yaw rate. Every structure is
searched alike, by differential evolution: for stability, Ms and rudder rate kept, the least heading.
"""

import math
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path

import numpy as np
from autopilots import EXAMPLES, tasks
from measure import Line
from scipy.optimize import differential_evolution

from seatrial import api
from seatrial.control.task import TuningTask
from seatrial.core.values import Array
from seatrial.physics.loops import Block, controllable_form, in_series
from seatrial.physics.loops.autopilot import acceleration_feed_forward, heading_gains_at, working_frequency
from seatrial.physics.loops.structures import notch

WAVE_DAMPING, NOTCH_DAMPING = 0.1, 1.0  # of the observer's waves and of the notch it makes, Fossen 2021, section 13.4
SHARES = (0.1, 0.25, 0.5)  # rms of the rudder rate over the largest that the loop file allows; spread
GENERATIONS, POPULATION, SEED = 80, 12, 1  # of the search
PENALTY = 10.0  # of what is not kept, on the logarithm of the heading's rms
SAMPLES, LOWEST, HIGHEST = 400, 1e-2, 1e3  # frequencies of Ms, as multiples of the plant's working frequency
DECADES = 2.0  # about the gains of pole placement, that are searched


@dataclass(frozen=True, eq=False)
class Controller:
    """delta = c z, z' = A z + b psi: from heading to rudder angle, the steering gear included."""

    A: Array
    b: Array
    c: Array

    def response(self, omega: Array) -> Array:
        """Return K at omega [rad/s], (n,), of delta = -K psi."""
        matrices = 1j * omega[:, None, None] * np.eye(len(self.b)) - self.A
        return -(
            np.linalg.solve(matrices, np.broadcast_to(self.b[:, None], (len(omega), len(self.b), 1)))[..., 0] @ self.c
        )


@dataclass(frozen=True, eq=False)
class Course:
    """A course to be kept: the plant, servo and disturbances of a tuning task."""

    task: TuningTask

    @cached_property
    def plant(self) -> tuple[Array, Array, Array, float]:
        return controllable_form(self.task.loop.plant)

    @cached_property
    def servo(self) -> tuple[Array, Array, Array, float]:
        return controllable_form(in_series("servo", self.task.loop.servo))

    @cached_property
    def band(self) -> Array:
        return np.geomspace(LOWEST, HIGHEST, SAMPLES) * working_frequency(self.task.loop.plant)

    @cached_property
    def free(self) -> list[tuple[Array, Array]]:
        """Frequencies and energy of the heading without control, of each disturbance."""
        made = []
        for one in self.task.disturbances:
            loop, spectrum = one.disturbed(self.task.loop), one.exposure(self.task.loop)
            response = loop.disturbance.frequency_response(spectrum.omega_e)
            made.append((spectrum.omega_e, np.abs(response) ** 2 * spectrum.energy))
        return made

    @cached_property
    def wave_frequency(self) -> float:
        """Mean frequency [rad/s] at which the first sea acts."""
        return self.task.disturbances[0].exposure(self.task.loop).mean_frequency(Block("action"))

    @cached_property
    def gains(self) -> Array:
        """KP, KI, KD of pole placement at one and a half times the working frequency."""
        plant = self.task.loop.plant
        return np.array([*heading_gains_at(plant, 1.5 * working_frequency(plant)).values()])

    def is_stable(self, one: Controller) -> bool:
        A, b, c, _ = self.plant
        whole = np.block([[A, np.outer(b, one.c)], [np.outer(one.b, c), one.A]])
        return bool(np.linalg.eigvals(whole).real.max() < 0.0)

    def rms(self, one: Controller) -> tuple[float, float, float]:
        """Return rms of heading [rad] and rudder rate [rad/s] over the disturbances, and Ms; of a stable loop."""
        heading, rate = 0.0, 0.0
        for omega, free in self.free:
            K = one.response(omega)
            left = free / np.abs(1.0 + self.task.loop.plant.frequency_response(omega) * K) ** 2
            heading += float(np.sum(left)) / len(self.free)
            rate += float(np.sum(np.abs(omega * K) ** 2 * left)) / len(self.free)
        L = self.task.loop.plant.frequency_response(self.band) * one.response(self.band)
        return math.sqrt(heading), math.sqrt(rate), float(np.max(1.0 / np.abs(1.0 + L)))

    def least_heading(self, build: Callable[[Array], Controller], dimensions: int, rate: float) -> float:
        """Return the least heading rms [rad] of a structure over the unit cube, the rudder rate and Ms kept."""

        def cost(point: Array) -> float:
            one = build(point)
            if not self.is_stable(one):
                return 2.0 * PENALTY
            heading, used, Ms = self.rms(one)
            over = max(math.log(used / rate), 0.0) + max(math.log(Ms / self.task.constraints.Ms), 0.0)
            return math.log(heading) + PENALTY * over

        found = differential_evolution(
            cost, [(0.0, 1.0)] * dimensions, maxiter=GENERATIONS, popsize=POPULATION, rng=SEED
        )
        return math.exp(found.fun)


def pid(course: Course, point: Array, filters: Iterable[Block] = ()) -> Controller:
    """Return PID of the loop file's terms with the gains of the first three coordinates, filters and the servo."""
    gains, loop = spread_gains(course, point), course.task.loop
    dens = [term.block.den for term in loop.terms]
    common = in_series("dens", [Block("", (1.0,), den) for den in dens]).den
    num = np.zeros(len(common))
    for gain, term in zip(gains, loop.terms, strict=True):
        rest = np.polymul(term.block.num, np.polydiv(common, term.block.den)[0])
        num[len(num) - len(rest) :] += gain * rest
    A, b, c, d = controllable_form(in_series("K", [Block("", tuple(num), common), *filters, *loop.servo]))
    assert d == 0.0
    return Controller(A, -b, c)


def with_notch(course: Course, point: Array) -> Controller:
    """Return PID with a notch near the waves: its frequency, damping and depth are coordinates."""
    omega = course.wave_frequency * 2.0 ** (2.0 * point[3] - 1.0)
    return pid(course, point, [notch(omega, 10.0 ** (1.5 * point[4] - 1.0), 0.9 * point[5])])


def with_observer(course: Course, point: Array) -> Controller:
    """Return PID on the heading and yaw rate of the observer; coordinates: its wave frequency, cut-off, yaw gain."""
    KP, KI, KD = spread_gains(course, point)
    omega = course.wave_frequency * 2.0 ** (2.0 * point[3] - 1.0)
    cut_off = omega * 10.0 ** (1.5 * point[4])
    k1 = -2.0 * (NOTCH_DAMPING - WAVE_DAMPING) * cut_off / omega
    k2, k3 = 2.0 * omega * (NOTCH_DAMPING - WAVE_DAMPING), cut_off
    k4 = cut_off**2 * 10.0 ** (4.0 * point[5] - 4.0)
    law = acceleration_feed_forward(course.task.loop.plant, 1.5 * working_frequency(course.task.loop.plant))
    sA, sb, sc, sd = course.servo
    n = 5 + len(sb)
    A, b, c = np.zeros((n, n)), np.zeros(n), np.zeros(n)
    # wave position and velocity, heading, yaw rate, integral of the heading; then the servo
    A[0, 1], A[1, 0], A[1, 1] = 1.0, -(omega**2), -2.0 * WAVE_DAMPING * omega
    A[2, 3], A[3, 3], A[4, 2] = 1.0, -law.velocity / law.acceleration, 1.0
    b[:4] = k1, k2, k3, k4
    seen = np.zeros(n)
    seen[[1, 2]] = 1.0
    A -= np.outer(b, seen)
    order = np.zeros(n)
    order[[2, 4, 3]] = -KP, -KI, -KD
    c[5:] = sc
    c += sd * order
    A[5:, 5:] += sA
    A[5:] += np.outer(sb, order)
    A[3] += c / law.acceleration
    return Controller(A, b, c)


def spread_gains(course: Course, point: Array) -> Array:
    """Return KP, KI, KD within two decades to either side of pole placement."""
    return course.gains * 10.0 ** (DECADES * (2.0 * point[:3] - 1.0))


def compare(name: str, task: TuningTask) -> list[Line]:
    """Return the heading rms of each structure at each share of the allowed rudder rate, and observer over notch."""
    course, lines = Course(task), []
    allowed = task.constraints.rate / math.sqrt(2.0 * math.log(1.0 / task.constraints.rate_saturation))
    for share in SHARES:
        rate = share * allowed
        at = f"{name}, rudder rate {math.degrees(rate):.2g} deg/s rms"
        none, filtered, observed = (
            course.least_heading(partial(build, course), dimensions, rate)
            for build, dimensions in ((pid, 3), (with_notch, 6), (with_observer, 6))
        )
        lines += [
            Line(f"{at}: heading rms without a filter", math.degrees(none), "deg"),
            Line(f"{at}: with the notch", math.degrees(filtered), "deg"),
            Line(f"{at}: with the observer", math.degrees(observed), "deg"),
            Line(f"{at}: observer over notch", observed / filtered, "x"),
        ]
    return lines


def run() -> list[Line]:
    """Return the lines of each craft."""
    return [line for name, task in tasks() for line in compare(name, task)]


if __name__ == "__main__":
    for path in sys.argv[1:]:
        loop, model = path.split("=")
        for line in compare(loop, api.load_loop(EXAMPLES / f"{loop}.toml", model_file=Path(model))):
            print(line.quantity, f"{line.value:.4g}", line.unit)
