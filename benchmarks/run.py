"""Every benchmark in one run: times of this machine, ratios, and whether the targets hold.

`python benchmarks/run.py simulation generation` runs the named ones only.
"""

import sys
from collections.abc import Callable

import against_optimisers
import against_shipmmg
import campaign
import checking
import design
import follow
import fusion
import generation
import gusts
import heave_pitch
import long_record
import loops
import montecarlo
import population
import roll_decay
import simulation
import tune
import warm_start
import waterjet_regressions
from measure import Line, machine

BENCHMARKS: dict[str, Callable[[], list[Line]]] = {
    "simulation": simulation.run,
    "generation": generation.run,
    "warm_start": warm_start.run,
    "against_shipmmg": against_shipmmg.run,
    "against_optimisers": against_optimisers.run,
    "montecarlo": montecarlo.run,
    "gusts": gusts.run,
    "waterjet_regressions": waterjet_regressions.run,
    "fusion": fusion.run,
    "checking": checking.run,
    "population": population.run,
    "heave_pitch": heave_pitch.run,
    "design": design.run,
    "long_record": long_record.run,
    "loops": loops.run,
    "tune": tune.run,
    "roll_decay": roll_decay.run,
    "follow": follow.run,
    "campaign": campaign.run,
}


def main(names: list[str]) -> int:
    """Print the table; 2 for an unknown name."""
    unknown = [n for n in names if n not in BENCHMARKS]
    if unknown:
        print(f"unknown benchmark '{unknown[0]}'; known are {', '.join(BENCHMARKS)}")
        return 2
    print(machine())
    for name in names or BENCHMARKS:
        print(f"\n{name.replace('_', ' ')}")
        for line in BENCHMARKS[name]():
            print(f"  {line.quantity:<66} {line.value:>10.4g} {line.unit:<10} {line.verdict}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
