"""What the benchmark of methods costs: processor time of 30 runs on one problem, and of everything but the method.

`python benchmarks/method_benchmark.py`: the framework's share is the processor time of runs through it less that of the
same searches on the same draws in a bare loop, over the time of the evaluations.
"""

import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial

import numpy as np
from measure import Line, at_most, machine

import seatrial as st
from seatrial.numerics.optimise import ParticleSwarm, SwarmSettings, search
from seatrial.problems import attempt, built_in_methods, problem_named
from seatrial.problems.problem import ProblemDraw

PROBLEM, RUNS = "qi2025-135-whole", 30
DEARER = ("song2025-zigzags",)
"""Problems whose evaluations take longer: the first one's 8000 take some 25 ms, the least of all."""
POPULATION, REPEATS = 40, 5
"""Points of an iteration of the search that is timed, and how often everything is timed; the least time counts."""


def cpu_seconds(work: Callable[[], object]) -> float:
    """Processor time of this process [s]."""
    began = time.process_time()
    work()
    return time.process_time() - began


def bare_search(draw: ProblemDraw, budget: int, seed: int) -> None:
    """The search of the built-in method `pso` without the framework."""
    settings = SwarmSettings(POPULATION, budget // POPULATION)
    calls = iter(range(budget))
    swarm = ParticleSwarm(draw.box, np.random.default_rng(seed), settings)
    search(swarm, lambda points: draw.fitness(points, next(calls)))


def evaluations(draw: ProblemDraw, budget: int) -> None:
    """As many evaluations in calls of the same size."""
    points = draw.box.random_points(np.random.default_rng(0), POPULATION)
    for call in range(budget // POPULATION):
        draw.fitness(points, call)


def overhead(name: str) -> list[Line]:
    """The framework's share of the time of the evaluations on a problem."""
    problem, method = problem_named(name), built_in_methods()["pso"]
    draw = problem.draw(0)
    parts = {
        "run": partial(attempt, method, problem, 0, draw=draw),
        "bare": partial(bare_search, draw, problem.budget, 0),
        "evaluations": partial(evaluations, draw, problem.budget),
    }
    times = {name: [cpu_seconds(work) for _ in range(REPEATS)] for name, work in parts.items()}
    least = {name: min(values) for name, values in times.items()}
    share = 100.0 * (least["run"] - least["bare"]) / least["evaluations"]
    return [
        Line(f"{name}: {problem.budget} evaluations", 1e3 * least["evaluations"], "ms"),
        Line(f"{name}: the same search in a bare loop", 1e3 * least["bare"], "ms"),
        at_most(f"{name}: framework over the evaluations' time", share, "%", 5.0),
    ]


def thirty_runs() -> list[Line]:
    """Processor time of 30 runs of one method, then of all that suit the problem, in one process."""
    lines = []
    for label, against in (("iwho", ("iwho",)), ("identify", ("identify",)), ("all built-in methods", None)):
        with tempfile.TemporaryDirectory() as folder:
            run = partial(st.benchmark, PROBLEM, folder, against=against, runs=RUNS, workers=1)
            spent = cpu_seconds(run)
        quantity = f"{RUNS} runs of {label}"
        lines.append(Line(quantity, spent, "s") if against is None else at_most(quantity, spent, "s", 60.0))
    return lines


def run() -> list[Line]:
    """All."""
    return [*(line for name in (PROBLEM, *DEARER) for line in overhead(name)), *thirty_runs()]


def main() -> int:
    """Print the table; 1 if a target is missed."""
    print(machine())
    table = run()
    for line in table:
        print(f"  {line.quantity:<50} {line.value:>10.4g} {line.unit:<4} {line.verdict}", flush=True)
    return int(any(line.holds is False for line in table))


if __name__ == "__main__":
    sys.exit(main())
