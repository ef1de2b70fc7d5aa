"""Simulated truth: errors of every coefficient over the Cramer-Rao bound, and coverage, for three craft with thrusters.

    python benchmarks/thrusters_truth.py [--craft two-fixed | azimuths | twin-screw] [--runs 400] [--write DIR]
    python benchmarks/thrusters_truth.py --coupling 0.4 [--hold-coupling]

Three runs of steps of all commands (60 s at 10 Hz); each draw adds white noise to all six channels, estimates all free
coefficients without a guess and without priors, from several starts, and notes whether the 95 % intervals hold. --write
keeps the records of the first draw as CSV files, those of examples/thrusters. --coupling is the true N_uv; with
--hold-coupling the estimate holds it at 0, and coverage shows what that does to the coefficients that stand in for it.
"""

import argparse
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

import numpy as np
from measure import Line, at_most
from numpy.typing import NDArray
from scipy.special import stdtrit

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Record
from seatrial.data.trial import EstimateSettings, FitCriterion
from seatrial.estimation.estimate import Runs, estimate_model
from seatrial.estimation.estimate.assemble import output_error_problem
from seatrial.physics.models.thrusters import thrusters
from seatrial.problems.thruster_craft import CRAFTS, NOISE, KnownThrusterCraft, noisy, simulated_runs

SETTINGS = EstimateSettings(method=FitCriterion.OUTPUT_ERROR)
FAR = 8.0
"""Bounds by which no coefficient errs in the right optimum: no draw of a normal law goes that far."""
LINE = 10
"""Draws after which a line is printed."""
LIMITS = (0.92, 0.98)
"""Pooled coverage of 95 % intervals."""
SAMPLE = 40
"""Draws that `make bench` runs."""


def bound(truth: Model, length: float, runs: Sequence[Record], noise: Mapping[str, float] = NOISE) -> Array:
    """Return the Cramer-Rao bound of each free coefficient at the truth: standard deviations, (free,)."""
    sessions = Runs.one_session_each(runs, length)
    problem = output_error_problem(truth, sessions, np.inf, SETTINGS)
    problem = replace(problem, noise=np.array([noise[c] for c in problem.data.outputs]))
    information = problem.normal(problem.start(), problem.measured_initial_states()).without_local()[1]
    return np.sqrt(np.diag(np.linalg.inv(information)))[: len(truth.parameters.free_names)]


def write_table(record: Record, path: Path) -> None:
    """Write time and channels as a table with one header line, five significant digits."""
    columns = np.column_stack([record.time, *(c.values for c in record.channels.values())])
    np.savetxt(path, columns, "%.5g", ",", header=",".join(("time", *record.channels)), comments="")


@dataclass(frozen=True, eq=False)
class Draws:
    """What estimates of noisy runs missed.

    Attributes:
        names, true, spread: of the free coefficients, their true values and Cramer-Rao bounds, (free,).
        errors: over the bound, (draws, free); is_held: whether the 95 % interval holds the truth, (draws, free).
        refusals: a sentence for each draw without an estimate.
    """

    names: tuple[str, ...]
    true: Array
    spread: Array
    errors: list[Array]
    is_held: list[NDArray[np.bool_]]
    refusals: list[str]

    @classmethod
    def of(cls, truth: Model, spread: Array) -> Self:
        """Return none yet, of the free coefficients of a truth and their bounds (free,)."""
        names = truth.parameters.free_names
        return cls(names, np.array([truth.parameters[n].value for n in names]), spread, [], [], [])

    def add(
        self, seeds: Iterable[int], recorded: Callable[[np.random.Generator], Sequence[Record]], fitted: Model,
        length: float, settings: EstimateSettings,
    ) -> None:  # fmt: skip
        """Estimate what is recorded with each seed by a model that begins without a guess."""
        free = len(self.names)
        for k in seeds:
            runs = Runs.one_session_each(list(recorded(np.random.default_rng([1, k]))), length)
            try:
                estimation = estimate_model(fitted, runs, settings)
            except InputError as error:
                self.refusals.append(f"draw {k}: {error}")
                continue
            missed = estimation.estimate.common_parameters[:free] - self.true
            deviation = np.sqrt(np.diag(estimation.interval.covariance))[:free]
            quantile = stdtrit(estimation.interval.degrees_of_freedom, 0.975)
            self.errors.append(missed / self.spread)
            self.is_held.append(np.abs(missed) <= quantile * deviation)
            if len(self.errors) % LINE == 0:
                print(self.line(), file=sys.stderr, flush=True)

    @property
    def ratio(self) -> Array:
        """RMSE of each coefficient over its bound."""
        return np.sqrt(np.mean(np.square(self.errors), axis=0))

    def line(self) -> str:
        """Return draws, median ratio, coverage of all coefficients together, and draws that ended elsewhere."""
        outside = int(np.sum(np.max(np.abs(self.errors), axis=1) > FAR))
        return (
            f"{len(self.errors)} draws: median RMSE/bound {np.median(self.ratio):.3f}, "
            f"pooled coverage {np.mean(self.is_held):.3f}, {outside} in another optimum"
        )

    def table(self) -> str:
        """Return a row a coefficient: true value, bound, RMSE over it and the z-score of that, coverage."""
        score = (self.ratio - 1.0) * np.sqrt(2.0 * len(self.errors))  # standard error of an RMSE: 1/sqrt(2 n) of it
        rows = zip(self.names, self.true, self.spread, self.ratio, score, np.mean(self.is_held, axis=0), strict=True)
        return "\n".join("{:12}{:10.4g}{:10.2g}{:8.3f}{:7.1f}{:8.3f}".format(*row) for row in rows)


def estimated(
    craft: KnownThrusterCraft, fitted: Model, count: int, settings: EstimateSettings, folder: Path | None = None
) -> Draws:
    """Return what estimates of so many draws missed; folder: where the records of the first draw are written."""
    model = craft.truth.with_parameters(craft.truth.parameters.only_free(fitted.parameters.free_names))
    clean, length = simulated_runs(craft, np.random.default_rng(1)), craft.layout.length
    if folder:
        folder.mkdir(parents=True, exist_ok=True)
        rng = np.random.default_rng([1, 0])
        for run in clean:
            write_table(noisy(run, rng), folder / f"{run.name}.csv")
    draws = Draws.of(model, bound(model, length, clean))
    draws.add(range(count), lambda rng: [noisy(run, rng) for run in clean], fitted, length, settings)
    return draws


def run() -> list[Line]:
    """A sample: a boat with two fixed thrusters."""
    craft = CRAFTS["two-fixed"]
    draws = estimated(craft, thrusters(craft.layout), SAMPLE, SETTINGS)
    low, high = LIMITS
    share = float(np.mean(draws.is_held))
    return [
        Line(f"two fixed thrusters, {SAMPLE} draws: coverage", share, "", f"{low:g} to {high:g}", low <= share <= high),
        Line("RMSE of a coefficient over its bound, median", float(np.median(draws.ratio)), ""),
        at_most("draws without an estimate", len(draws.refusals), "", 0),
    ]


def main() -> None:
    """Print errors over the bound and coverage."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--craft", choices=tuple(CRAFTS), default="two-fixed")
    parser.add_argument("--starts", type=int, help="points from which to search")
    parser.add_argument("--runs", type=int, default=400)
    parser.add_argument("--write", type=Path)
    parser.add_argument("--coupling", type=float, default=0.0, help="true N_uv over M_u")
    parser.add_argument("--hold-coupling", action="store_true", help="hold N_uv at 0 in the estimate")
    arguments = parser.parse_args()
    craft = CRAFTS[arguments.craft]
    if arguments.coupling:
        craft = replace(craft, values={**craft.values, "N_uv": arguments.coupling})
    fitted, settings = thrusters(craft.layout), replace(SETTINGS, starts=arguments.starts)
    if arguments.hold_coupling:
        fitted = fitted.with_parameters(fitted.parameters.fixed("N_uv"))
    draws = estimated(craft, fitted, arguments.runs, settings, arguments.write)
    print("\n".join(draws.refusals))
    print(f"{'':12}{'true':>10}{'bound':>10}{'ratio':>8}{'z':>7}{'inside':>8}\n{draws.table()}")
    print(f"{draws.line()}, {len(draws.refusals)} without an estimate")


if __name__ == "__main__":
    main()
