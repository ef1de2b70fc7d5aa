"""Known truth over and over: errors against the Cramer-Rao bound, coverage of the intervals, convergence.

The craft of Song et al. 2025 in consecutive zigzags of 2075 s at 10 Hz with sensor noise, generated ten times finer
than it is fitted; every run starts from coefficients zero. `python benchmarks/montecarlo.py --runs 200` alone.
`examples/coverage.toml` is the same study as a campaign; this one hands its draws to other estimators as well.
"""

import argparse
import sys
import time
from dataclasses import dataclass, replace

import numpy as np
from measure import Line, machine
from numpy.typing import NDArray

from seatrial.core.equations import Model
from seatrial.core.values import Record
from seatrial.data.example_series import SENSOR_NOISE, true_model, with_sensor_noise
from seatrial.data.example_series import simulate_run as steered
from seatrial.estimation.identify import EstimatorOptions, Runs, estimate_model
from seatrial.estimation.information.covariance import from_information
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import cut_segments

Array = NDArray[np.float64]
RATIO, COVERAGE, POOLED = (0.85, 1.2), (0.90, 0.99), (0.93, 0.97)
EXECUTES, RUNS, SEED = 5, 200, 7


@dataclass(frozen=True, eq=False)
class Series:
    """Errors and half widths of the 95 % intervals, both (runs, coefficients), beside the bound (coefficients,).

    Attributes:
        white: runs whose residuals passed as white, so that whole runs were fitted.
    """

    names: tuple[str, ...]
    values: Array
    bound: Array
    errors: Array
    half_widths: Array
    converged: int
    white: int
    seconds: float

    @property
    def runs(self) -> int:
        """How many there are."""
        return len(self.errors)

    @property
    def ratio(self) -> Array:
        """Root-mean-square error over the bound, each coefficient."""
        return np.sqrt(np.mean(self.errors**2, axis=0)) / self.bound

    @property
    def coverage(self) -> Array:
        """Share of the intervals that hold the truth, each coefficient."""
        return np.mean(np.abs(self.errors) <= self.half_widths, axis=0)


def bound(model: Model, clean: Record) -> Array:
    """Cramer-Rao bound of each free coefficient: information at the truth, true noise, initial state unknown."""
    outputs = tuple(SENSOR_NOISE)
    problem = OutputError(
        model, cut_segments(model, [clean], outputs, None), np.array(list(SENSOR_NOISE.values())), workers=1
    )
    return from_information(
        problem.normal(problem.start(), problem.measured_initial_states()).without_local()[1]
    ).standard_error


def series(runs: int = RUNS, seed: int = SEED, executes: int = EXECUTES) -> Series:
    """`runs` noisy repeats of one manoeuvre, each identified from nothing."""
    model = true_model()
    names = model.parameters.free_names
    values = np.array([model.parameters[n].value for n in names])
    clean = steered(model, f"consecutive-zigzags:{executes}")
    blank = model.with_values(dict.fromkeys(names, 0.0))
    length, options = model.parameters["L"].value, EstimatorOptions(workers=1)
    estimate_model(blank, Runs.one_session_each([clean], length), options=replace(options, evaluations=2))
    began = time.perf_counter()
    errors, halves, converged, white = [], [], 0, 0
    for stream in np.random.SeedSequence(seed).spawn(runs):
        noisy = with_sensor_noise(clean, np.random.default_rng(stream), seed)
        found = estimate_model(blank, Runs.one_session_each([noisy], length), options=options)
        errors.append(found.estimate.common_parameters[: len(names)] - values)
        halves.append(found.interval.half_width[: len(names)])
        converged += found.estimate.optimum.solution.status.is_success
        white += "whole runs" in found.criterion
    seconds = (time.perf_counter() - began) / runs
    return Series(names, values, bound(model, clean), np.array(errors), np.array(halves), converged, white, seconds)


def _within(quantity: str, value: float, limits: tuple[float, float]) -> Line:
    low, high = limits
    return Line(quantity, value, "", f"{low:g} to {high:g}", low <= value <= high)


def lines(repeats: Series) -> list[Line]:
    """The table against its targets."""
    table = [
        Line(
            "runs converged",
            repeats.converged,
            "",
            f"{repeats.runs} of {repeats.runs}",
            repeats.converged == repeats.runs,
        ),
        Line("runs fitted whole, residuals white", repeats.white, ""),
        Line("time of one fit, one core", repeats.seconds, "s"),
        _within("coverage of 95 % intervals, pooled", float(np.mean(repeats.coverage)), POOLED),
    ]
    for i, name in enumerate(repeats.names):
        share = repeats.bound[i] / abs(repeats.values[i])
        table.append(_within(f"{name}: RMSE / bound (bound {share:.2%} of the value)", float(repeats.ratio[i]), RATIO))
        table.append(_within(f"{name}: coverage", float(repeats.coverage[i]), COVERAGE))
    return table


def run() -> list[Line]:
    """All repeats; some minutes."""
    return lines(series())


def main(arguments: list[str]) -> int:
    """Print the table; 1 if a target is missed."""
    parser = argparse.ArgumentParser(description="errors against the Cramer-Rao bound over repeated simulated trials")
    parser.add_argument("--runs", type=int, default=RUNS)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--executes", type=int, default=EXECUTES, help="of each zigzag angle; 5: 2075 s")
    given = parser.parse_args(arguments)
    print(machine())
    table = lines(series(given.runs, given.seed, given.executes))
    for line in table:
        print(f"  {line.quantity:<66} {line.value:>10.4g} {line.unit:<10} {line.verdict}")
    return int(any(line.holds is False for line in table))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
