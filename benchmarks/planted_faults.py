"""Faults planted in simulated and measured records: how many the checks find, and whether the right cause comes first.

    python benchmarks/planted_faults.py [--seeds 20] [--unspoilt 300] [--all]

Records are simulated with a tanker model of 7 m (KVLCC2) and a waterjet craft, steered by random steps of the rudder or
nozzle, with sensor noise; measured ones are the zigzags of kvlcc2_hsva (SEATRIAL_DATA). Thresholds of the checks are
set with the kinds at even places and the records of even seeds only; the matrix is that of the other halves, with --all
of everything. A fault is found where a finding other than a note has its code and words, and the unspoilt record gives
none such; first: it is the first of all findings.
"""

import argparse
import os
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
from benchmarks.fault_kinds import KINDS, UNDETECTABLE, FaultKind

from seatrial.core.values import Finding, InputError, Record, Severity
from seatrial.data.check import canonical_record, examine, examined_record
from seatrial.data.check.inputs import thruster_findings
from seatrial.data.trial import load_runs
from seatrial.physics.models import model_named
from seatrial.physics.models.published import kvlcc2
from seatrial.physics.models.thruster_layout import CATAMARAN
from seatrial.physics.simulate.replay import replay

ROWS, STEP_S = 3000, 0.1
DETECTED, FIRST, ALARMS = 0.98, 0.90, 3 / 300  # required
# standard deviations of the sensors: m, m/s, rad, rad/s; of a towing tank, and of GNSS and a gyro
NOISE = {"tanker": (0.02, 0.005, 0.001, 0.0005), "waterjet": (0.3, 0.02, 0.003, 0.002)}
LENGTHS = {"tanker": 7.0, "waterjet": 8.0}  # m, of the craft


@cache
def simulated(craft: str, seed: int) -> Record:
    """Return five minutes of random steps of the rudder with sensor noise; the name ends with the craft's length."""
    generator = np.random.default_rng((seed, len(craft)))
    model = kvlcc2() if craft == "tanker" else model_named("waterjet")
    time = STEP_S * np.arange(ROWS)
    edges = np.concatenate([[0.0], np.cumsum(generator.uniform(6.0, 30.0, 60))])  # s between two orders
    orders = np.radians(generator.uniform(5.0, 25.0, 60)) * np.resize([1.0, -1.0], 60)  # rad, to either side
    delta = orders[np.searchsorted(edges, time, side="right") - 1]
    inputs = {name: np.full(ROWS, value) for name, value in (("n", 10.4), ("v_j", 1.866)) if name in model.input_names}
    planned = Record.from_arrays(craft, time, {"delta": delta, **inputs})
    start = dict.fromkeys(model.states, 0.0) | {"u": 1.18 if craft == "tanker" else 0.8}  # m/s
    run = replay(model, planned, {state: start[state] for state in model.states})
    position, speed, angle, rate = NOISE[craft]
    sigmas = {"x0": position, "y0": position, "u": speed, "v": speed, "psi": angle, "r": rate}
    for symbol, sigma in sigmas.items():
        noisy = run[symbol] + sigma * generator.standard_normal(len(run))
        run = run.with_channel(symbol, run.channel(symbol).with_values(noisy))
    run = run.with_channel("delta", planned.channel("delta"))
    return run.renamed(f"{craft} {seed} L {LENGTHS[craft]}")


@cache
def measured() -> tuple[Record, ...]:
    """Return the zigzags of the tank in standard conventions, where their folder is given."""
    if not (Path(os.environ.get("SEATRIAL_DATA", "")) / "kvlcc2_hsva").is_dir():
        return ()
    runs = load_runs(Path(__file__).parents[1] / "examples" / "kvlcc2_hsva.toml")
    zigzags = [canonical_record(examined_record(run.raw_record()).record) for run in runs if "_Z_" in run.name]
    turning = [record for record in zigzags if np.ptp(record["psi"]) > np.radians(30.0)]
    return tuple(record.renamed(f"{record.name} L 7.0") for record in turning)


def records_of(seeds: Sequence[int]) -> Iterator[tuple[str, int, Record]]:
    """Yield the records of seeds: both craft, and a measured one."""
    for seed in seeds:
        yield from ((craft, seed, simulated(craft, seed)) for craft in NOISE)
        if measured():
            yield "measured", seed, measured()[seed % len(measured())]


@dataclass(frozen=True)
class Outcome:
    """What became of one planted fault."""

    kind: str
    source: str
    is_found: bool
    is_first: bool
    first: str


def serious(findings: Sequence[Finding]) -> list[Finding]:
    """Return warnings and errors."""
    return [finding for finding in findings if finding.severity is not Severity.INFO]


@cache
def alarms(record: Record) -> frozenset[str]:
    """Return the codes that an unspoilt record gives."""
    return frozenset(finding.code for finding in serious(examine(record)))


def outcome(kind: FaultKind, source: str, seed: int, record: Record) -> Outcome:
    """Plant a fault and look for it."""
    generator = np.random.default_rng((seed, KINDS.index(kind)))
    try:
        findings = serious(examine(kind.spoil(record, generator)))
    except InputError as error:
        return Outcome(kind.name, source, False, False, str(error))
    named = [kind.names(one) for one in findings]
    new = any(named) and kind.code not in alarms(record)
    first = f"{findings[0].code}: {findings[0].message}" if findings else "nothing"
    return Outcome(kind.name, source, new, new and named[0], first)


def print_matrix(outcomes: Sequence[Outcome], title: str) -> None:
    """Print found and first by kind and source, and what came first instead."""
    sources = list(dict.fromkeys(one.source for one in outcomes))
    print(f"\n{title}: found / first")
    print(f"{'kind':38s}" + "".join(f"{source:>18s}" for source in sources))
    for kind in dict.fromkeys(one.kind for one in outcomes):
        cells, wrong = "", ""
        for source in sources:
            group = [one for one in outcomes if (one.kind, one.source) == (kind, source)]
            if not group:
                cells += f"{'':18s}"
                continue
            found, first = np.mean([one.is_found for one in group]), np.mean([one.is_first for one in group])
            cells += f"{found:>10.0%} /{first:>5.0%} "
            wrong = wrong or next((f"{source}: {one.first[:110]}" for one in group if not one.is_first), "")
        print(f"{kind:38s}{cells}  {wrong}")
    simulated_only = [one for one in outcomes if one.source != "measured"]
    for name, group in (("all", outcomes), ("simulated", simulated_only)):
        found, first = np.mean([one.is_found for one in group]), np.mean([one.is_first for one in group])
        print(f"{name}: {len(group)} faults, found {found:.1%} (required {DETECTED:.0%}), "
              f"right cause first {first:.1%} (required {FIRST:.0%})")  # fmt: skip


def thruster_outcomes(seeds: Sequence[int]) -> list[Outcome]:
    """Return what becomes of exchanged and inverted thrusters of a catamaran."""
    outcomes = []
    for seed in seeds:
        record = catamaran_run(seed)
        one, other = CATAMARAN.thrusters
        exchanged = [replace(one, y=-one.y), replace(other, y=-other.y)]
        inverted = [replace(one, command=replace(one.command, span=-one.command.span)), other]
        for name, thrusters in (("sides of thrusters exchanged", exchanged), ("a thruster inverted", inverted)):
            findings = serious(thruster_findings(replace(CATAMARAN, thrusters=tuple(thrusters)), [record]))
            is_found = any(finding.code == "thruster-side" for finding in findings)
            outcomes.append(Outcome(name, "catamaran", is_found, is_found, findings[0].message if findings else ""))
    return outcomes


@cache
def catamaran_run(seed: int) -> Record:
    """Return two minutes of steps of both thrusters, every 3 s, with noise of a small craft's log."""
    model, generator = model_named("thrusters"), np.random.default_rng(seed)
    commands = np.repeat(generator.uniform(-1.0, 1.0, size=(40, 2)), 30, axis=0)
    inputs = {"command_1": commands[:, 0], "command_2": commands[:, 1]}
    planned = Record.from_arrays(f"catamaran {seed}", STEP_S * np.arange(len(commands)), inputs)
    run = replay(model, planned, dict.fromkeys(model.states, 0.0))
    for symbol, sigma in {"u": 0.03, "v": 0.03, "r": 0.02}.items():  # m/s, rad/s
        noisy = run[symbol] + sigma * generator.standard_normal(len(run))
        run = run.with_channel(symbol, run.channel(symbol).with_values(noisy))
    return run


def main() -> None:
    """Print the matrix, false alarms on unspoilt records, and the symmetries that no check can see."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--unspoilt", type=int, default=300)
    parser.add_argument("--all", action="store_true", help="also the kinds and seeds that thresholds were set with")
    options = parser.parse_args()
    for place, title in ((1, "kinds and seeds kept aside"), (0, "kinds and seeds for setting thresholds")):
        if place == 0 and not options.all:
            continue
        seeds = range(place, 2 * options.seeds, 2)
        records = list(records_of(seeds))
        outcomes = [outcome(kind, *record) for kind in KINDS[place::2] for record in records]
        print_matrix([*outcomes, *(thruster_outcomes(seeds) if place else [])], title)
        print("measured records unspoilt:", {name: sorted(alarms(one)) for _, _, one in records
              if (name := one.name) and alarms(one) and "L 7.0" in name and "tanker" not in name})  # fmt: skip
    unspoilt = [simulated(craft, 1001 + 2 * k) for k in range(options.unspoilt // 2) for craft in NOISE]
    false = [(record.name, code) for record in unspoilt for code in sorted(alarms(record))]
    print(f"\nfalse alarms: {len(false)} on {len(unspoilt)} unspoilt records (at most {ALARMS:.0%}): {false[:6]}")
    for name, symmetry in UNDETECTABLE.items():
        silent = [alarms(symmetry(record)) == alarms(record) for record in unspoilt[:10]]
        print(f"undetectable, an exact symmetry: {name}; the same findings as unspoilt on {sum(silent)} of 10 records")


if __name__ == "__main__":
    main()
