"""How often the intervals of roll damping and restoring hold them, where forces with a memory disturb few decays.

Releases of a model in a basin, roll angle and rate recorded 50 times a second, heeled by 0.3 degrees by slow forces
(first-order Markov) all the while. `python benchmarks/decay_intervals.py SERIES` prints the share of intervals that
hold the truth.
"""

import math
import sys

import numpy as np
from scipy.signal import lfilter

from seatrial.core.values import Array, Record
from seatrial.estimation.estimate import EstimatorOptions, Runs, estimate_model
from seatrial.physics.models import model_named
from seatrial.physics.simulate.replay import trajectory

TRUE = {"b_1": 0.09, "b_2": 0.16, "c_1": 7.15, "c_3": -4.0, "phi_0": math.radians(0.35)}  # a period of 2.35 s
STEP, ROWS = 0.02, 1900  # s, samples of a decay: sixteen swings
ANGLE_NOISE, RATE_NOISE, HEEL = math.radians(0.04), math.radians(0.15), math.radians(0.3)  # rad, rad/s, rad; chosen
RELEASES = (17.0, -12.0, 14.0)  # deg, in turn
CASES = ((1, 0.3), (1, 3.0), (1, 20.0), (2, 3.0), (3, 3.0))  # decays, memory of the forces [s]; chosen
SERIES = 100  # standard error of a coverage near 95 %: 2 %
AMPLITUDE = math.radians(7.5)  # of the equivalent linear damping; chosen: half of a release
NAMES = ("b_1", "b_2", "c_1", "b_e")  # b_e: the equivalent linear damping at that amplitude


def decays(seed: int, count: int, memory: float) -> list[Record]:
    """Releases to both sides in turn."""
    rng, model, records = np.random.default_rng(seed), model_named("roll").with_values(TRUE), []
    kept = math.exp(-STEP / memory)
    for k, release in enumerate(RELEASES[:count]):
        driving = math.sqrt(1.0 - kept**2) * rng.standard_normal(ROWS)
        driving[0] = rng.standard_normal()
        inputs = np.zeros((ROWS, len(model.inputs)))
        inputs[:, model.input_names.index("alpha_w")] = HEEL * lfilter([1.0], [1.0, -kept], driving)
        states = trajectory(model, inputs, STEP, np.array([math.radians(release), 0.0]))[0]
        phi, p = (states[:, model.states.index(name)] for name in ("phi", "p"))
        channels = {
            "phi": phi + ANGLE_NOISE * rng.standard_normal(ROWS), "p": p + RATE_NOISE * rng.standard_normal(ROWS)
        }  # fmt: skip
        records.append(Record.from_arrays(f"decay_{k + 1}", STEP * np.arange(0.0, ROWS), channels))
    return records


def _combinations(free: tuple[str, ...]) -> Array:
    """Weights (4, k) that make what is named of the free coefficients."""
    rows = np.array([[float(one == name) for one in free] for name in ("b_1", "b_2", "c_1")])
    slope = 8.0 / (3.0 * math.pi) * math.sqrt(TRUE["c_1"]) * AMPLITUDE  # Himeno 1981
    return np.vstack([rows, rows[0] + slope * rows[1]])


def standardised(seed: int, count: int, memory: float) -> Array:
    """Errors over half widths of the intervals, (4,)."""
    model = model_named("roll")
    model = model.with_parameters(model.parameters.only_free(list(TRUE)))
    fit = estimate_model(model, Runs.one_session_each(decays(seed, count, memory), 5.0), options=EstimatorOptions())
    free = fit.estimate.problem.free
    combine = _combinations(free)
    error = combine @ (fit.estimate.common_parameters[: len(free)] - np.array([TRUE[name] for name in free]))
    share = fit.interval.half_width[0] / fit.interval.standard_error[0]  # Student's t, or the normal's 1.96
    covariance = fit.interval.covariance[: len(free), : len(free)]
    return error / (share * np.sqrt(np.einsum("ik,kl,il->i", combine, covariance, combine)))


def main(series: int) -> None:
    """Print the coverage of each case."""
    for count, memory in CASES:
        away = np.array([standardised(seed, count, memory) for seed in range(series)])
        held = ", ".join(
            f"{name} {100.0 * share:.0f} %"
            for name, share in zip(NAMES, np.mean(np.abs(away) <= 1.0, axis=0), strict=True)
        )
        print(f"{count} decays, memory {memory:g} s: {held} of {series} intervals hold it")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else SERIES)
