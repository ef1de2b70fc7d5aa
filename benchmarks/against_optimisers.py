"""Our population optimisers beside pyswarms and mealpy on shifted, rotated functions: values reached, time spent.

Neither package has a wild horse optimiser (mealpy's WHO is the wildebeest herd): ours stand alone in the table.
"""

import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from against_shipmmg import peers_python
from measure import Line, at_least
from optimiser_functions import FUNCTIONS, ITERATIONS, LOWER, POPULATION, RUNS, UPPER
from scipy.stats import mannwhitneyu

from seatrial.numerics.optimise import (
    AdaptationSettings,
    Box,
    CloudParticleSwarm,
    CloudSettings,
    CovarianceAdaptation,
    DifferentialEvolution,
    EvolutionSettings,
    HerdSettings,
    ImprovedHerdSettings,
    ImprovedWildHorse,
    Optimiser,
    ParticleSwarm,
    StrideVariant,
    SwarmSettings,
    WildHorse,
    search,
)

HERE = Path(__file__).parent
BOX = Box(LOWER, UPPER)
N, T = POPULATION, ITERATIONS
OURS: dict[str, Callable[[np.random.Generator], Optimiser]] = {
    "particle swarm": lambda g: ParticleSwarm(BOX, g, SwarmSettings(N, T)),
    "wild horses, paper": lambda g: WildHorse(BOX, g, HerdSettings(N, T)),
    "wild horses, reference": lambda g: WildHorse(BOX, g, HerdSettings(N, T, variant=StrideVariant.REFERENCE)),
    "improved wild horses": lambda g: ImprovedWildHorse(BOX, g, ImprovedHerdSettings(N, T)),
    "cloud particle swarm": lambda g: CloudParticleSwarm(BOX, g, CloudSettings(N, T)),
    "differential evolution": lambda g: DifferentialEvolution(BOX, g, EvolutionSettings(N, T)),
    "CMA-ES": lambda g: CovarianceAdaptation(BOX, g, AdaptationSettings(N, T)),
}


def _own_values(make: Callable[[np.random.Generator], Optimiser]) -> tuple[np.ndarray, float]:
    """Values, shape (functions, runs), and seconds of all."""
    began = time.perf_counter()
    values = [[search(make(np.random.default_rng(s)), f).value for s in range(RUNS)] for f in FUNCTIONS.values()]
    return np.array(values), time.perf_counter() - began


def overhead(make: Callable[[np.random.Generator], Optimiser]) -> float:
    """Time of one ask and one tell [us], the fitness known beforehand; shortest of five runs."""
    fitness = np.random.default_rng(1).random((T, N))
    times = []
    for _ in range(5):
        optimiser = make(np.random.default_rng(0))
        began = time.perf_counter()
        for row in fitness:
            optimiser.ask()
            optimiser.tell(row)
        times.append((time.perf_counter() - began) / T)
    return 1e6 * min(times)


def _lines(name: str, values: np.ndarray) -> list[Line]:
    medians = zip(FUNCTIONS, np.median(values, axis=1), strict=True)
    return [Line(f"{name}: {function}, median of {RUNS} runs", float(value), "") for function, value in medians]


def run() -> list[Line]:
    """Medians, overheads, and the ratios to the peers' particle swarms."""
    lines, swarm, seconds = [], np.empty(0), 0.0
    for name, make in OURS.items():
        values, spent = _own_values(make)
        if name == "particle swarm":
            swarm, seconds = values, spent
        lines += [*_lines(name, values), Line(f"{name}: an iteration of {N} x {BOX.size}", overhead(make), "us")]
    with tempfile.TemporaryDirectory() as folder:
        try:
            python = peers_python(Path(folder) / "peers", "peers_optimisers.txt")
        except subprocess.CalledProcessError:
            print("  left out: the peers' packages could not be installed")
            return lines
        subprocess.run([python, HERE / "peer_optimisers.py", folder], check=True, cwd=folder)
        theirs = dict(np.load(Path(folder) / "peer.npz"))
    for peer in ("pyswarms", "mealpy"):
        lines += _lines(f"{peer} particle swarm", theirs[peer])
        ratio = float(theirs[f"{peer}_seconds"]) / seconds
        lines.append(Line(f"{peer}: its time over that of our particle swarm", ratio, "x"))
    for row, function in enumerate(FUNCTIONS):
        chance = float(mannwhitneyu(swarm[row], theirs["pyswarms"][row], alternative="greater").pvalue)
        lines.append(at_least(f"our particle swarm ends above pyswarms' on {function} by chance: p", chance, "", 0.01))
    return lines
