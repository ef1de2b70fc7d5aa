"""How often the interval of the angle of rest holds it, where slow forces heel the ship from decay to decay.

Series of roll decays like those of `examples/fin_decay.toml`, simulated with an angle of rest of 0.12 degrees, 0.05
degrees of sensor noise and a heel of 0.1 degrees by slow forces with a memory (first-order Markov). Few decays, for
which there is no jackknife; `python benchmarks/angle_of_rest.py SERIES` prints the share of intervals that hold it.
"""

import math
import sys

import numpy as np

from seatrial.core.values import Array, Record
from seatrial.estimation.estimate import EstimatorOptions, Runs, estimate_model
from seatrial.physics.models import model_named
from seatrial.physics.simulate.replay import trajectory

TRUE = {"b_1": 0.06, "b_2": 0.35, "c_1": 0.698, "c_3": -0.25, "phi_0": math.radians(0.12)}
STEP, ROWS = 0.1, 750  # s, samples of a decay: as the example's
RELEASE, NOISE, HEEL = (math.radians(angle) for angle in (16.0, 0.05, 0.1))  # the first release; chosen, chosen
CASES = ((1, 10.0), (1, 20.0), (2, 20.0), (3, 20.0), (3, 1000.0))  # decays, memory of the forces [s]; chosen
SERIES = 200  # standard error of a coverage near 95 %: 1.5 %


def slow_heel(rng: np.random.Generator, memory: float) -> Array:
    """Heel (ROWS,) [rad] by a first-order Markov process."""
    kept = math.exp(-STEP / memory)
    heel = HEEL * rng.standard_normal(ROWS)
    heel[1:] *= math.sqrt(1.0 - kept**2)
    for k in range(1, ROWS):
        heel[k] += kept * heel[k - 1]
    return heel


def decays(seed: int, count: int, memory: float) -> list[Record]:
    """Releases to both sides in turn, each from a tenth less than the one before."""
    rng, model, records = np.random.default_rng(seed), model_named("roll").with_values(TRUE), []
    for k in range(count):
        inputs = np.zeros((ROWS, len(model.inputs)))
        inputs[:, model.input_names.index("alpha_w")] = slow_heel(rng, memory)
        start = np.array([RELEASE * (-1.0) ** k * (1.0 - 0.1 * k), 0.0])
        phi = trajectory(model, inputs, STEP, start)[0][:, model.states.index("phi")]
        measured = phi + NOISE * rng.standard_normal(ROWS)
        records.append(Record.from_arrays(f"decay_{k + 1}", STEP * np.arange(0.0, ROWS), {"phi": measured}))
    return records


def holds(seed: int, count: int, memory: float) -> tuple[bool, float]:
    """Whether the interval holds the angle of rest, and its half width [rad]."""
    model = model_named("roll")
    model = model.with_parameters(model.parameters.only_free(list(TRUE)))
    fit = estimate_model(model, Runs.one_session_each(decays(seed, count, memory), 5.0), options=EstimatorOptions())
    half = fit.interval.half_width[fit.estimate.problem.free.index("phi_0")]
    return bool(abs(fit.model.parameters["phi_0"].value - TRUE["phi_0"]) <= half), float(half)


def main(series: int) -> None:
    """Print the coverage and the median half width of each case."""
    for count, memory in CASES:
        held, half = zip(*(holds(seed, count, memory) for seed in range(series)), strict=True)
        print(f"{count} decays, memory {memory:g} s: {100.0 * np.mean(held):.1f} % of {series} intervals hold it, "
              f"half width {math.degrees(float(np.median(half))):.3f} deg")  # fmt: skip


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else SERIES)
