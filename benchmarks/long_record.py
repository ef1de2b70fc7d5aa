"""Long records: processor time, memory and Kalman passes of `identify` from ten thousand samples to a million.

A craft of first order in gusts with a memory of 5 s, random binary rudder, 10 Hz, channels delta, r, psi, u, made
without the package. Each size is a process of its own, its compiled code cached; `python benchmarks/long_record.py
ROWS` is the measured process itself.
"""

import json
import math
import resource
import subprocess
import sys
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from measure import Line, at_most, machine
from scipy.signal import lfilter
from warm_start import FLOOR

SIZES = (10_000, 100_000, 1_000_000)
DT, K, T, MEMORY = 0.1, 0.15, 8.0, 5.0  # s, 1/s, s, s
RUDDER, GUST = math.radians(4.0), math.radians(1.2)
NOISE = {"r": math.radians(0.1), "psi": math.radians(0.2), "u": 0.02}
LIMIT, MEMORY_LIMIT_MB, PASSES_LIMIT, EXPONENT_LIMIT = 40.0, 1000.0, 20.0, 1.0  # required; the first over the floor
MEGABYTE_OF_KILOBYTES = 1000.0


@dataclass(frozen=True)
class Cost:
    """Of one identification: processor time [s], memory above that before it [MB], samples filtered over all samples.

    Attributes:
        error: of K and T in standard errors.
    """

    rows: int
    seconds: float
    memory: float
    passes: float
    error: tuple[float, float]


def steered(rows: int, seed: int = 6) -> dict[str, np.ndarray]:
    """Return the channels of T r' + r = K (delta + w), w of first order; exact for forces straight between samples."""
    rng = np.random.default_rng(seed)
    bits = np.repeat(rng.choice([-RUDDER, RUDDER], rows // 40 + 1), 40)[:rows]
    delta = np.convolve(bits, np.ones(8) / 8.0, "same")
    keep, decay = np.exp(-DT / MEMORY), np.exp(-DT / T)
    gust = GUST * lfilter([np.sqrt(1.0 - keep**2)], [1.0, -keep], rng.standard_normal(rows))
    force, ramp = K * (delta + gust), T / DT * (1.0 - decay)
    r = np.concatenate([[0.0], lfilter([1.0], [1.0, -decay], (ramp - decay) * force[:-1] + (1.0 - ramp) * force[1:])])
    psi = np.concatenate([[0.0], np.cumsum(0.5 * DT * (r[1:] + r[:-1]))])
    clean = {"delta": delta, "r": r, "psi": psi, "u": np.full(rows, 5.0)}
    return {c: v + NOISE.get(c, 0.0) * rng.standard_normal(rows) for c, v in clean.items()}


def cost_of(rows: int) -> Cost:
    """Identify one record of that length in this process."""
    from seatrial.core.values import Record, Ship
    from seatrial.data.trial import Role, Run, Trial
    from seatrial.estimation.identify import identify
    from seatrial.physics.models.nomoto import nomoto
    from seatrial.physics.simulate.filtering import KalmanFilter

    record = Record.from_arrays("long", DT * np.arange(rows), steered(rows))
    trial = Trial(Ship("craft", {"L": 50.0}), (Run(record, Role.TRAIN),), nomoto())
    filtered, run = [0], KalmanFilter._run

    def counted(self, segment, *arguments, **keywords):
        filtered[0] += int(self.offsets[segment + 1] - self.offsets[segment])
        return run(self, segment, *arguments, **keywords)

    KalmanFilter._run = counted
    memory, began = _memory(), time.process_time()
    fit = identify(trial)
    seconds = time.process_time() - began
    errors = [(fit[n].estimate - v) / (fit[n].standard_error or math.inf) for n, v in (("K", K), ("T", T))]
    return Cost(rows, seconds, _memory() - memory, filtered[0] / rows, (errors[0], errors[1]))


def _memory() -> float:
    """Largest resident memory so far [MB] (Linux counts in kB)."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / MEGABYTE_OF_KILOBYTES


def _floor() -> float:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, "-c", FLOOR], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def _measured(rows: int) -> Cost:
    command = [sys.executable, str(Path(__file__)), str(rows)]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return Cost(**json.loads(done.stdout.splitlines()[-1]))


def run() -> list[Line]:
    """Measure every size."""
    _measured(SIZES[0])  # compiles
    floor = min(_floor() for _ in range(3))
    costs = [_measured(rows) for rows in SIZES]
    lines = [Line("import floor", floor, "s")]
    for c in costs:
        name = f"{c.rows:.0e} samples of four channels"
        lines.append(Line(f"{name}: processor time", c.seconds, "s"))
        lines.append(Line(f"{name}: errors, largest", max(map(abs, c.error)), "std. error"))
    first, last = costs[0], costs[-1]
    lines.append(at_most("1e+06 samples: processor time over the import floor", last.seconds / floor, "", LIMIT))
    lines.append(at_most("the same: passes of the Kalman filter", last.passes, "", PASSES_LIMIT))
    lines.append(at_most("the same: memory above the start", last.memory, "MB", MEMORY_LIMIT_MB))
    exponent = math.log(last.seconds / first.seconds) / math.log(last.rows / first.rows)
    lines.append(at_most("exponent of processor time, 1e4 to 1e6 samples", exponent, "", EXPONENT_LIMIT))
    return lines


if __name__ == "__main__":
    if len(sys.argv) > 1:
        print(json.dumps(asdict(cost_of(int(sys.argv[1])))))
        sys.exit()
    print(machine())
    for line in run():
        print(f"  {line.quantity:<66} {line.value:>10.4g} {line.unit:<10} {line.verdict}", flush=True)
