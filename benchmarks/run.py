"""Every benchmark in one run: times of this machine, ratios, and whether the targets hold.

`python benchmarks/run.py simulation generation` runs the named ones only; `--record docs/numbers.json` keeps their
lines in the file from which `docs/write_numbers.py` writes the page of numbers and the table of the README.
"""

import argparse
import json
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path

import against_optimisers
import against_shipmmg
import autopilot_days
import autopilots
import campaign
import changed_ships
import checking
import controllers_at_sea
import criteria
import design
import esso_osaka
import estimation_folds
import fins_at_sea
import follow
import fusion
import generation
import gusts
import heave_pitch
import independent_ships
import interval_coverage
import kvlcc2_zigzags
import loggers
import long_record
import loops
import memory
import montecarlo
import numpy as np
import population
import prediction_bands
import proposals
import ride_at_sea
import roll_decay
import sample_rates
import simulation
import station_at_sea
import thrusters_blueboat
import thrusters_truth
import timing
import tracks_at_sea
import tune
import verification
import verify_at_sea
import warm_start
import waterjet_regressions
import wave_observer
import waves
import workspace
from measure import Line, machine

BENCHMARKS: dict[str, Callable[[], list[Line]]] = {
    "simulation": simulation.run,
    "generation": generation.run,
    "warm_start": warm_start.run,
    "against_shipmmg": against_shipmmg.run,
    "against_optimisers": against_optimisers.run,
    "montecarlo": montecarlo.run,
    "gusts": gusts.run,
    "interval_coverage": interval_coverage.run,
    "thrusters_truth": thrusters_truth.run,
    "waves": waves.run,
    "workspace": workspace.run,
    "criteria": criteria.run,
    "timing": timing.run,
    "loggers": loggers.run,
    "autopilot_days": autopilot_days.run,
    "kvlcc2_zigzags": kvlcc2_zigzags.run,
    "estimation_folds": estimation_folds.run,
    "prediction_bands": prediction_bands.run,
    "esso_osaka": esso_osaka.run,
    "thrusters_blueboat": thrusters_blueboat.run,
    "waterjet_regressions": waterjet_regressions.run,
    "fusion": fusion.run,
    "checking": checking.run,
    "population": population.run,
    "heave_pitch": heave_pitch.run,
    "design": design.run,
    "long_record": long_record.run,
    "loops": loops.run,
    "tune": tune.run,
    "autopilots": autopilots.run,
    "controllers_at_sea": controllers_at_sea.run,
    "fins_at_sea": fins_at_sea.run,
    "tracks_at_sea": tracks_at_sea.run,
    "station_at_sea": station_at_sea.run,
    "ride_at_sea": ride_at_sea.run,
    "wave_observer": wave_observer.run,
    "verification": verification.run,
    "verify_at_sea": verify_at_sea.run,
    "proposals": proposals.run,
    "roll_decay": roll_decay.run,
    "sample_rates": sample_rates.run,
    "independent_ships": independent_ships.run,
    "follow": follow.run,
    "changed_ships": changed_ships.run,
    "campaign": campaign.run,
    "memory": memory.run,
}


def main(arguments: list[str]) -> int:
    """Print the table; 2 for an unknown name."""
    parser = argparse.ArgumentParser(description="times, ratios and accuracies against their targets")
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(BENCHMARKS))
    parser.add_argument("--record", type=Path, metavar="FILE.json", help="keep the lines in this file")
    given = parser.parse_args(arguments)
    unknown = [n for n in given.names if n not in BENCHMARKS]
    if unknown:
        print(f"unknown benchmark '{unknown[0]}'; known are {', '.join(BENCHMARKS)}")
        return 2
    print(machine())
    for name in given.names or BENCHMARKS:
        print(f"\n{name.replace('_', ' ')}")
        lines = BENCHMARKS[name]()
        for line in lines:
            print(f"  {line.quantity:<66} {line.value:>10.4g} {line.unit:<10} {line.verdict}", flush=True)
        if given.record is not None:
            record(given.record, name, lines)
    return 0


def record(file: Path, name: str, lines: Sequence[Line]) -> None:
    """Keep a benchmark's lines with machine, date and commit; the file's other benchmarks stay."""
    kept = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=False)
    kept[name] = {
        "machine": machine(),
        "date": time.strftime("%Y-%m-%d"),
        "commit": commit.stdout.strip(),
        "lines": [asdict(line) for line in lines],
    }
    ordered = {n: kept[n] for n in BENCHMARKS if n in kept}
    file.write_text(json.dumps(ordered, indent=1, ensure_ascii=False, default=_plain) + "\n", encoding="utf-8")


def _plain(value: np.generic) -> object:
    """Return a NumPy scalar as Python's own."""
    return value.item()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
