"""Time until the mean error of eight coefficients is 1 %: 135 degrees, no noise, box of +-50 % off the truth's middle.

Ours and SciPy's least squares start in the middle of the box and may leave it; population searches stay in it and stop
where they first know better than 1 %, or at their limit. All are given what is fastest in this package: SciPy the
simulation of one candidate, populations the fitness of all candidates at once. Time is that of the search until it
first asks about a point within 1 %, the package's own work included, on one thread.
"""

import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from against_shipmmg import peers_python
from measure import Line, at_least, fastest
from numpy.typing import NDArray
from scipy.optimize import least_squares

from seatrial.estimation.problem.linear_output_error import LinearOutputError
from seatrial.estimation.problem.segments import Segments
from seatrial.numerics.optimise import Box, NormalEquations, levenberg_marquardt
from seatrial.physics.simulate.population import fitness, trajectories
from seatrial.problems import off_centre_box
from seatrial_studies.heave_pitch_search import STEP, SearchData, candidate_matrices, simulate_search_data
from seatrial_studies.seaway import HEAVE_NOISE, PITCH_NOISE

Array = NDArray[np.float64]
HERE = Path(__file__).parent
GOOD, SHARE, HEADING = 0.01, 0.5, 135
NOISE = np.array([HEAVE_NOISE, PITCH_NOISE])


def problem_from_rest(data: SearchData) -> LinearOutputError:
    """The identification of a record of the papers' discretisation, from rest."""
    count = len(data.measured)
    inputs = np.zeros((count, len(data.model.inputs)))
    inputs[:, :2] = data.forces
    one = np.zeros(1, dtype=np.int64)
    names = ("papers' sea",)
    segments = Segments(inputs, data.measured, np.array([0, count]), one, one, names, names, ("z", "theta"), STEP)
    return LinearOutputError(data.model, segments, NOISE, np.zeros(4))


def seas_and_boxes(count: int) -> list[tuple[SearchData, Box]]:
    """Seas and boxes, different ones each time."""
    rngs = [np.random.default_rng([HEADING, k, 50]) for k in range(count)]
    seas = [simulate_search_data(HEADING, rng) for rng in rngs]
    return [(data, off_centre_box(data.truth, SHARE, rng)) for data, rng in zip(seas, rngs, strict=True)]


def mean_error(point: Array, truth: Array) -> float:
    """Mean relative error of the coefficients."""
    return float(np.mean(np.abs(point / truth - 1.0)))


class EvaluationLog:
    """A problem that notes when it is asked about which point."""

    def __init__(self, problem: LinearOutputError) -> None:
        self.problem, self.lower, self.upper = problem, problem.lower, problem.upper
        self.evaluations: list[tuple[float, Array]] = []

    def cost(self, shared: Array, local: Array) -> float:
        """Of the problem."""
        self.evaluations.append((time.perf_counter(), shared))
        return self.problem.cost(shared, local)

    def normal(self, shared: Array, local: Array) -> NormalEquations:
        """Of the problem."""
        self.evaluations.append((time.perf_counter(), shared))
        return self.problem.normal(shared, local)


def first_time_within(evaluations: list[tuple[float, Array]], began: float, truth: Array) -> float:
    """Seconds until the first evaluation within 1 %."""
    return next((at - began for at, point in evaluations if mean_error(point, truth) <= GOOD), np.inf)


def output_error_seconds(data: SearchData, box: Box) -> tuple[float, float]:
    """Seconds to 1 % and to rounding; the shortest of several runs."""
    problem, start = problem_from_rest(data), 0.5 * (box.lower + box.upper)
    local = problem.given_initial_states()

    def once() -> float:
        noted = EvaluationLog(problem)
        began = time.perf_counter()
        levenberg_marquardt(noted, start, local, negligible=1e-12)
        return first_time_within(noted.evaluations, began, data.truth)

    whole = fastest(lambda: levenberg_marquardt(problem, start, local, negligible=1e-12), 50)
    return min(once() for _ in range(50)), whole


def residual_function(data: SearchData) -> Callable[[Array], Array]:
    """Residuals in standard deviations of one candidate."""
    forcing, rest, measured = data.forcing, np.zeros(4), data.measured

    def residuals(point: Array) -> Array:
        return ((trajectories(*candidate_matrices(point[None]), forcing, rest)[0] - measured) / NOISE).ravel()

    return residuals


def by_scipy(data: SearchData, box: Box, method: str) -> float:
    """Seconds to 1 % with differences for slopes, in multiples of the start; the shortest of several runs."""
    start, residuals = 0.5 * (box.lower + box.upper), residual_function(data)

    def once() -> float:
        seen: list[tuple[float, Array]] = []

        def noted(scaled: Array) -> Array:
            seen.append((time.perf_counter(), start * scaled))
            return residuals(start * scaled)

        began = time.perf_counter()
        least_squares(noted, np.ones(len(start)), method=method, xtol=1e-6, ftol=1e-12, gtol=1e-12)
        return first_time_within(seen, began, data.truth)

    return min(once() for _ in range(50))


class TargetReached(Exception):
    """The best candidate so far is within 1 % of the truth."""


class TimedFitness:
    """Our fitness of a population in coordinates of the unit box; ends the search that knows better than 1 %."""

    def __init__(self, data: SearchData, box: Box, limit: float) -> None:
        self.data, self.box, self.limit = data, box, limit
        self.forcing, self.rest, self.best = data.forcing, np.zeros(4), np.inf
        self.evaluations, self.began = 0, time.perf_counter()

    def __call__(self, unit: Array) -> Array:
        """Sum of squares in standard deviations, (count,), of points (count, 8).

        Raises:
            Reached: now.
            TimeoutError: the limit [s] is over.
        """
        points = self.box.lower + unit * (self.box.upper - self.box.lower)
        values = fitness(*candidate_matrices(points), self.forcing, self.rest, self.data.measured, NOISE)
        self.evaluations += len(points)
        first = int(np.argmin(values))
        if values[first] < self.best:
            self.best = float(values[first])
            if mean_error(points[first], self.data.truth) <= GOOD:
                raise TargetReached
        if time.perf_counter() - self.began > self.limit:
            raise TimeoutError
        return values


def time_to_target(
    search: Callable[[TimedFitness, int], None], data: SearchData, box: Box, seed: int, limit: float
) -> float:
    """Seconds to 1 %; infinite where the search gave up or the limit was over."""
    judge = TimedFitness(data, box, limit)
    try:
        search(judge, seed)
    except TargetReached:
        return time.perf_counter() - judge.began
    except TimeoutError:
        pass
    return np.inf


def _peers(boxes: int) -> dict[str, Array]:
    """Seconds of each package in each box."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        try:
            python = peers_python(folder / "peers", "peers_identification.txt")
            ourselves = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-e", HERE.parent]
            subprocess.run(ourselves, check=True, stderr=subprocess.DEVNULL)
        except subprocess.CalledProcessError:
            print("  left out: the peers' packages could not be installed")
            return {}
        subprocess.run([python, HERE / "peer_identification.py", folder, str(boxes)], check=True, cwd=folder)
        return dict(np.load(folder / "peer.npz"))


def lines(boxes: int) -> list[Line]:
    """Medians over boxes, and ratios of medians to the best of each kind."""
    drawn = seas_and_boxes(boxes)
    own = np.median([output_error_seconds(*one) for one in drawn], axis=0)
    scipy = {m: float(np.median([by_scipy(*one, m) for one in drawn])) for m in ("lm", "trf")}
    what = f"{boxes} boxes, 135 deg, median to 1 %"
    made = [Line(f"{what}: ours", 1e3 * own[0], "ms"), Line(f"{what}: ours to rounding instead", 1e3 * own[1], "ms")]
    made += [Line(f"{what}: SciPy {method}", 1e3 * seconds, "ms") for method, seconds in scipy.items()]
    made.append(at_least(f"{what}: ratio, SciPy's better", min(scipy.values()) / own[0], "x", 10.0))
    peers = {name: float(np.median(seconds)) for name, seconds in _peers(boxes).items()}
    made += [Line(f"{what}: {name}", 1e3 * seconds, "ms") for name, seconds in peers.items()]
    if peers:
        made.append(at_least(f"{what}: ratio, best of these", min(peers.values()) / own[0], "x", 100.0))
    return made


if __name__ == "__main__":
    for line in lines(12):
        print(f"  {line.quantity:<66} {line.value:>10.4g} {line.unit:<10} {line.verdict}", flush=True)
