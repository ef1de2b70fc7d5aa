"""Where a band-pass and a low-pass beside the three gains of a fin stabiliser should stand, and what they are worth.

The published fin loop with washout in beam seas of 3.3 m at 18 kn: ITTC, JONSWAP of the same height and peak, ITTC
short-crested. CMA-ES over both frequencies and dampings; at each the five gains by SLSQP for the
least mean roll variance over the seas, each relative to the published gains', with no more fin-rate energy than
theirs in any sea and Ms below a cap. `python benchmarks/fin_structures.py` shows what the frozen ones give,
`--search 3` searches with three seeds (half a minute each).
"""

import argparse
import math
import sys
import time
from dataclasses import dataclass

import numpy as np
from cmaes import CMA
from measure import Line, at_most, machine
from scipy.optimize import NonlinearConstraint, minimize

from seatrial.core.values import Array
from seatrial.physics.loops import (
    EncounterSpectrum,
    HullFactor,
    LoopSignal,
    Performance,
    TransferLoop,
    WeightedVariance,
    sea_disturbance,
)
from seatrial.physics.loops.structures import ROLL, band_pass, fin_loop, five_gain_loop, low_pass
from seatrial.physics.sea.spectrum import ittc, jonswap

U, BEAM, HEIGHT = 18.0 * 1852.0 / 3600.0, math.pi / 2.0, 3.3
HULL = HullFactor(100.0, 10.5, 3.4)
PEAK, WORTH, CAP = 1.9, 0.70, 2.0
GENERATIONS, POPULATION = 30, 10
# frequency and damping of the band-pass, of the low-pass; searched over their logarithms
LOWER, UPPER = np.log([0.3, 0.3, 0.15, 0.4]), np.log([3.0, 1.0, 6.0, 1.0])
SCALE = np.array([20.0, 5.0, 60.0, 30.0, 30.0])
STARTS = np.array([[0.55, 0.085, 0.55, 0.0, 0.0], [0.3, 0.1, 0.3, 0.2, -0.2]])
REJECTED = 50.0
ROWS = (WeightedVariance(LoopSignal.OUTPUT, np.ones_like), WeightedVariance(LoopSignal.ACTUATOR, lambda w: w))


def seas() -> dict[str, EncounterSpectrum]:
    """By name."""
    peak = 2.0 * math.pi / ittc(HEIGHT).modal_frequency
    return {
        "ITTC": sea_disturbance(ittc(HEIGHT), U, BEAM, ROLL, HULL),
        "JONSWAP": sea_disturbance(jonswap(HEIGHT, peak), U, BEAM, ROLL, HULL),
        "ITTC short-crested": sea_disturbance(ittc(HEIGHT), U, BEAM, ROLL, HULL, spreading=1.0),
    }


@dataclass(frozen=True, eq=False)
class PublishedComparison:
    """A loop against the published gains: roll and rate variances over theirs (seas, 2), Ms."""

    gains: Array
    ratios: Array
    peak: float


def compare_with_published(loop: TransferLoop, met: list[EncounterSpectrum], gains: Array) -> PublishedComparison:
    """Of some gains."""
    published = fin_loop()
    made = [Performance(loop, sea, ROWS).evaluate(gains) for sea in met]
    theirs = [Performance(published, sea, ROWS).evaluate(published.gain_values).variances[0] for sea in met]
    return PublishedComparison(
        gains, np.array([m.variances[0] / t for m, t in zip(made, theirs, strict=True)]), float(made[0].Ms[0])
    )


def best_gains(loop: TransferLoop, met: list[EncounterSpectrum], peak: float) -> PublishedComparison | None:
    """Least mean roll ratio at no more rate energy in any sea; None where no start leads to a feasible one."""
    n = len(loop.terms)
    scale = SCALE[:n]
    limits = [(p.lower / s, p.upper / s) for p, s in zip(loop.gains, scale, strict=True)]

    def roll(x: Array) -> float:
        return _bounded(float(compare_with_published(loop, met, x * scale).ratios[:, 0].mean()), REJECTED)

    def constraint_margins(x: Array) -> Array:
        at = compare_with_published(loop, met, x * scale)
        return np.array([_bounded(v, -REJECTED) for v in (*(1.0 - at.ratios[:, 1]), 1.0 - at.peak / peak)])

    best = None
    for start in STARTS[:, :n]:
        found = minimize(
            roll,
            start,
            bounds=limits,
            method="SLSQP",
            constraints=NonlinearConstraint(constraint_margins, 0.0, np.inf),
            options={"maxiter": 120, "ftol": 1e-7},
        )
        at = compare_with_published(loop, met, found.x * scale)
        if constraint_margins(found.x).min() > -1e-4 and (
            best is None or at.ratios[:, 0].mean() < best.ratios[:, 0].mean()
        ):
            best = at
    return best


def _bounded(value: float, otherwise: float) -> float:
    return float(value) if np.isfinite(value) else otherwise


def with_structure(point: Array) -> TransferLoop:
    """At logarithms of frequency and damping, (4,)."""
    a, b, c, d = (float(v) for v in np.exp(point))
    return five_gain_loop(fin_loop(), band_pass(a, b), low_pass(c, d))


def search(seed: int, met: list[EncounterSpectrum]) -> tuple[Array, PublishedComparison]:
    """Frequencies and dampings (4,) and what they give."""
    span = UPPER - LOWER
    start = 0.2 + 0.6 * np.random.default_rng(seed).random(4)
    optimiser = CMA(start, 0.25, bounds=np.array([[0.0, 1.0]] * 4), seed=seed, population_size=POPULATION)
    best: tuple[float, Array, PublishedComparison | None] = (math.inf, start, None)
    for _ in range(GENERATIONS):
        evaluated = []
        for _ in range(POPULATION):
            x = optimiser.ask()
            made = best_gains(with_structure(LOWER + span * x), met, PEAK)
            value = REJECTED if made is None else float(made.ratios[:, 0].mean())
            evaluated.append((x, value))
            if value < best[0]:
                best = value, x, made
        optimiser.tell(evaluated)
    if best[2] is None:
        raise SystemExit(f"seed {seed}: nothing feasible found")
    return np.exp(LOWER + span * best[1]), best[2]


def lines(met: dict[str, EncounterSpectrum]) -> list[Line]:
    """What the frozen structure and gains are worth."""
    loop = five_gain_loop(fin_loop())
    frozen = compare_with_published(loop, list(met.values()), loop.gain_values)
    table = []
    for name, (roll, rate) in zip(met, frozen.ratios, strict=True):
        table.append(at_most(f"{name}: roll variance, five gains over published", float(roll), "", WORTH))
        table.append(at_most(f"{name}: fin-rate variance, five gains over published", float(rate), "", 1.0))
    table.append(at_most("Ms of the five gains", frozen.peak, "", CAP))
    alone = [met["ITTC"]]
    for words, one in (("three", fin_loop()), ("five", loop)):
        made = best_gains(one, alone, CAP)
        value = math.nan if made is None else float(made.ratios[0, 0])
        table.append(Line(f"ITTC alone: least roll variance of {words} gains over published, Ms <= 2", value, ""))
    return table


def main(arguments: list[str]) -> int:
    """Print the table; 1 if a target is missed."""
    parser = argparse.ArgumentParser(description="five gains of a fin stabiliser against the published three")
    parser.add_argument("--search", type=int, default=0, help="seeds to search with")
    given = parser.parse_args(arguments)
    print(machine())
    met = seas()
    for seed in range(given.search):
        began = time.perf_counter()
        point, made = search(seed, list(met.values()))
        found = f"{np.round(point, 3)} gains {np.round(made.gains, 2)} roll {np.round(made.ratios[:, 0], 3)}"
        print(f"  seed {seed}: {found} Ms {made.peak:.3f}, {time.perf_counter() - began:.0f} s")
    table = lines(met)
    for line in table:
        print(f"  {line.quantity:<72} {line.value:>8.4g} {line.unit:<2} {line.verdict}")
    return int(any(line.holds is False for line in table))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
