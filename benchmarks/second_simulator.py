"""A second simulator for benchmarks of controllers: gains.toml as one codes it, actuators, weather, limits of the page.

Nothing of the package's loops and simulators is used but `tuning_of`, which has the page's numbers: equations are
written out here and in the benchmarks `*_at_sea`.
"""

import math
import tempfile
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from measure import Line

from seatrial import api
from seatrial.control.front import Effort
from seatrial.control.task import TuningTask
from seatrial.control.tune import tune
from seatrial.core.results.tuning import Tuning
from seatrial.core.values import Array
from seatrial.data.folder.model_file import ModelFile, write_model

G = 9.80665  # m/s^2, standard gravity
DEGREE = math.pi / 180.0
# points, %, %, Ms: by how much page and simulator may differ
OVERSHOOT, SETTLING, RMS, PEAK = 2.0, 10.0, 5.0, 0.05
QUICK = Effort(refined=12, fill_rounds=2, neighbours=4000)


def tuning_of(
    text: str, model: ModelFile | None = None, effort: Effort | None = None, files: Mapping[str, str] | None = None
) -> tuple[TuningTask, Tuning]:
    """Return task and tuning of a loop file, model.toml and other files beside it."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "loop.toml"
        for name, content in {path.name: text, **(files or {})}.items():
            path.with_name(name).write_text(content, encoding="utf-8")
        if model is not None:
            write_model(model, path.with_name("model.toml"))
        task = api.load_loop(path)
    return task, tune(task, effort=effort)


def amount_of(table: Mapping[str, Any], name: str) -> float:
    """Return an amount of gains.toml in SI, by the unit at the end of its key; infinite where there is none."""
    key = next((key for key in table if key.startswith(name) and "saturation" not in key), None)
    return math.inf if key is None else table[key] * (DEGREE if "deg" in key else 1.0)


class OwnController:
    """A controller as one codes it from gains.toml."""

    def __init__(self, text: str) -> None:
        table = tomllib.loads(text)
        discrete, kept = table["discrete"], table.get("constraints", {})
        self.T, self.blocks, self.gains = discrete["sample_s"], discrete["blocks"], table["gains"]
        self.dead_time = discrete["dead_time_s"]
        self.limit, self.rate = amount_of(kept, "limit"), amount_of(kept, "rate")
        self.reference, self.sensor = table.get("reference", {}), discrete.get("sensor", [])
        self.noise, self.resolution = discrete["noise"], discrete["resolution"]
        self.past = [([0.0] * len(one["b"]), [0.0] * len(one["b"])) for one in self.blocks]
        self.excess = self.achieved = self.x = self.v = 0.0

    def follow(self, ordered: float) -> tuple[float, float]:
        """Return the reference now and what it feeds forward, and go on for a sample, in a hundred short steps."""
        w, fastest = 1.0 / self.reference["time_constant_s"], amount_of(self.reference, "rate")
        x, v = self.x, self.v
        acceleration = w * w * (ordered - x) - 2.0 * w * v
        if abs(v) >= fastest and acceleration * v > 0.0:
            acceleration = 0.0
        h = self.T / 100
        for _ in range(100):
            faster = min(max(self.v + h * (w * w * (ordered - self.x) - 2.0 * w * self.v), -fastest), fastest)
            self.x += 0.5 * h * (self.v + faster)
            self.v = faster
        fed = self.reference["level"] * x + self.reference["velocity"] * v
        return x, fed + self.reference["acceleration"] * acceleration

    def order(self, error: float, fed: float) -> float:
        """Return the order of a sample."""
        total = 0.0
        for block, (inputs, outputs) in zip(self.blocks, self.past, strict=True):
            if block["role"] == "term":
                total += self.gains[block["gain"]] * self._answer(block, inputs, outputs, error)
        for block, (inputs, outputs) in zip(self.blocks, self.past, strict=True):
            if block["role"] == "filter":
                total = self._answer(block, inputs, outputs, total)
        total += fed
        way = min(max(total, -self.limit), self.limit) - self.achieved
        self.achieved += min(max(way, -self.rate * self.T), self.rate * self.T)
        self.excess = total - self.achieved
        return total

    def response(self, z: Array) -> Array:
        """Return the controller's response at z (n,)."""
        made = np.zeros(len(z), dtype=complex)
        for block in self.blocks:
            answer = np.polyval(block["b"], z) / np.polyval(block["a"], z)
            made = made + self.gains[block["gain"]] * answer if block["role"] == "term" else made * answer
        return made

    def _answer(self, block: dict[str, Any], inputs: list[float], outputs: list[float], x: float) -> float:
        inputs.insert(0, x)
        inputs.pop()
        y = sum(b * u for b, u in zip(block["b"], inputs, strict=True))
        y -= sum(a * o for a, o in zip(block["a"][1:], outputs, strict=False))
        if block["hold"] and self.excess * block["hold"] * self.gains[block["gain"]] * (y - outputs[0]) > 0.0:
            y = outputs[0]
        outputs.insert(0, y)
        outputs.pop()
        return y


class OwnActuator:
    """An actuator in steps of dt: an order that acts after the dead time, through a servo, within angle and rate.

    serve: value of the servo after a step in which its order stood.
    """

    def __init__(self, dt: float, dead_time: float, serve: Callable[[float], float], limit: float, rate: float) -> None:
        self.waiting = [0.0] * round(dead_time / dt)
        self.serve, self.limit, self.slew, self.angle = serve, limit, rate * dt, 0.0

    def move(self, order: float) -> float:
        """Return the mean angle over a step."""
        self.waiting.append(order)
        served = self.serve(self.waiting.pop(0))
        way, before = min(max(served, -self.limit), self.limit) - self.angle, self.angle
        self.angle += min(max(way, -self.slew), self.slew)
        return 0.5 * (before + self.angle)


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


def stalled(angle: float, stall: float) -> float:
    """Return the angle whose lift a fin has: beyond stall it falls as it rose, down to nothing."""
    return math.copysign(min(abs(angle), max(2.0 * stall - abs(angle), 0.0)), angle)


def lag_of(time_constant: float, dt: float) -> Callable[[float], float]:
    """Return a servo that is a lag [s], or none."""
    share, value = 1.0 - math.exp(-dt / time_constant) if time_constant else 1.0, 0.0

    def serve(order: float) -> float:
        nonlocal value
        value += share * (order - value)
        return value

    return serve


def nomoto_step(K: float, T: float, dt: float) -> Callable[[float, float, float], tuple[float, float]]:
    """Return the step of T r' + r = K delta: heading and rate of turn behind a step of a rudder."""

    def step(psi: float, r: float, rudder: float) -> tuple[float, float]:
        faster = r + dt / T * (K * rudder - r)
        return psi + 0.5 * dt * (r + faster), faster

    return step


def gauss_markov(rms: float, bandwidth: float, dt: float, count: int, rng: np.random.Generator) -> Array:
    """Return coloured noise of that rms, exactly from step to step."""
    stay = math.exp(-bandwidth * dt)
    kicks = rms * math.sqrt(1.0 - stay * stay) * rng.standard_normal(count)
    made, now = np.empty(count), rms * float(rng.standard_normal())
    for k, kick in enumerate(kicks.tolist()):
        made[k] = now
        now = stay * now + kick
    return made


def ittc_waves(height: float, count: int, rng: np.random.Generator, first: float, last: float) -> tuple[Array, Array]:
    """Return frequencies [rad/s] and amplitudes [m] of waves of equal energy: ITTC's spectrum of one parameter.

    Energy below omega is A / (4 B) exp(-B / omega^4); a random place in each part between two shares of it.
    """
    A, B = 8.1e-3 * G**2, 3.11 / height**2
    share = first + (np.arange(count) + rng.random(count)) / count * (last - first)
    return (B / -np.log(share)) ** 0.25, np.full(count, math.sqrt(2.0 * A / (4.0 * B) * (last - first) / count))


def print_lines(lines: Iterable[Line]) -> None:
    """Print lines as they come."""
    for line in lines:
        print(f"{line.quantity:<90} {line.value:>10.4g} {line.unit:<8} {line.verdict}", flush=True)
