"""What the intervals of KVLCC2 cost and are worth: run jackknife, spread of tied models, bootstrap.

`SEATRIAL_DATA=folder python benchmarks/kvlcc2_intervals.py` prints the table.
"""

import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from measure import Line, at_least, at_most, machine

from seatrial.core.results import Fit
from seatrial.data.trial import Role, TrialRecord, load_records, load_trial
from seatrial.data.trial.records import approach_condition
from seatrial.estimation.estimate.assemble import training_runs
from seatrial.estimation.estimate.fit import Estimation, estimate_model
from seatrial.estimation.estimate.intervals import estimate_uncertainty
from seatrial.estimation.estimate.settings import IntervalMethod
from seatrial.estimation.identify.identify import identify
from seatrial.estimation.predict.windows import HoldoutProtocol
from seatrial_studies.alexandersson2022.reproduction import (
    SIDES,
    WINDOW_S,
    band_coverage,
    holdout_windows,
    simulated_turn_intervals,
)
from seatrial_studies.study_file import read_study

LIMITS = read_study("alexandersson2022").limits
TRIAL = Path(__file__).parents[1] / "examples" / "kvlcc2_hsva.toml"
SECONDS = 60.0


def turn_lines(fit: Fit, kind: str) -> Iterator[Line]:
    """Half widths of the turns, and whether MARIN's values lie inside."""
    train = [p.measured for p in fit.predictions if p.role == "training"]
    approach = approach_condition(train, fit.model)
    made = [m for side in SIDES for m in simulated_turn_intervals(fit, side, approach)]
    for m in made:
        what, is_limited = f"{kind}: {m.measure} to {m.side}, half width", m.measure == "tactical diameter"
        yield at_most(what, m.half_width, "%", LIMITS["half_width"]) if is_limited else Line(what, m.half_width, "%")
    yield Line(f"{kind}: MARIN's values inside", sum(m.contains_measured for m in made), f"of {len(made)}")
    measures = [m for p in fit.validation for m in p.measures.values() if None not in (m.measured, m.lower, m.upper)]
    measures = [m for m in measures if m.upper != m.lower]
    inside = sum(m.lower <= m.measured <= m.upper for m in measures)  # type: ignore[operator]
    yield Line(f"{kind}: measures of Z_35_05 inside", inside, f"of {len(measures)}")


def band_lines(estimation: Estimation, train: Sequence[TrialRecord], held: Sequence[TrialRecord]) -> Iterator[Line]:
    """Shares of headings inside the bands of windows, runs left out and held out."""
    within, beyond = (
        [c.shares["psi"] for c in one]
        for one in band_coverage(holdout_windows(estimation, train, held, HoldoutProtocol(window_s=WINDOW_S)))
    )
    low, high = LIMITS["least_share"], LIMITS["largest_share"]
    share = float(np.mean(within))
    yield Line("headings inside, runs left out", share, "", f"{low:g} to {high:g}", low <= share <= high)
    yield Line("headings inside, worst run left out", min(within), "")
    yield at_least("headings inside, Z_35_05", float(np.mean(beyond)), "", LIMITS["held_out_share"])


def lines() -> Iterator[Line]:
    """Agreement, bands, times, widths, family."""
    trial = load_trial(TRIAL)
    rate = trial.estimate.rate
    used = [replace(r, record=r.record.resampled(rate) if rate else r.record) for r in load_records(trial)[0]]
    train, held = ([r for r in used if r.role is role] for role in (Role.TRAIN, Role.VALIDATE))
    found = estimate_model(trial.model, training_runs(trial, train), trial.estimate)
    full = estimate_uncertainty(found.estimate, found.inflation, IntervalMethod.JACKKNIFE)
    free = found.estimate.problem.free
    for i, name in enumerate(free):
        ratio = found.interval.standard_error[i] / full.interval.standard_error[i]
        yield Line(f"one-step over full jackknife, priors included, {name}", float(ratio), "")
    yield Line("one-step over full jackknife, scatter of runs, median", full.one_step_ratio or np.nan, "")
    yield from band_lines(found, train, held)
    yield from turn_lines(identify(trial), "one-step jackknife")
    began = time.perf_counter()
    fit = identify(trial, intervals=IntervalMethod.JACKKNIFE)
    estimate_uncertainty(found.estimate, found.inflation, IntervalMethod.BOOTSTRAP, np.random.default_rng(0))
    yield at_most("full jackknife, family, 40 bootstraps, two cores", time.perf_counter() - began, "s", SECONDS)
    yield from turn_lines(fit, "jackknife and ensemble")
    for m in fit.candidate_models:
        yield Line(f"family: {m.name}{', tied' if m.is_tied else ''}", m.heading_deg or np.nan, "deg")


def main() -> int:
    """Print the table; 1 if a target is missed."""
    print(machine())
    table = []
    for line in lines():
        table.append(line)
        print(f"  {line.quantity:<72} {line.value:>9.4g} {line.unit:<10} {line.verdict}", flush=True)
    return int(any(line.holds is False for line in table))


if __name__ == "__main__":
    sys.exit(main())
