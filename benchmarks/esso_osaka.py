"""Esso Osaka by cross-validation over whole runs: windows of 50 s of runs held out, beside the published coefficients.

`SEATRIAL_DATA=folder python benchmarks/esso_osaka.py` reads examples/esso_osaka.toml; every run takes its turn in
training and in validation, whatever its role there.
"""

import os
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from measure import Line, at_most

from seatrial.core.values import InputError
from seatrial.data.trial import Trial, load_records, load_trial
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.fit import estimate_model
from seatrial.estimation.predict.windows import HoldoutProtocol
from seatrial.physics.models import model_named
from seatrial.physics.models.published import parameter_set
from seatrial_studies.cross_validation import (
    CrossValidation,
    Fold,
    PooledError,
    cross_validate,
    cross_validate_unfitted,
    fit_folds,
)

TRIAL = Path(__file__).parent.parent / "examples" / "esso_osaka.toml"
LIMITS = {"turn": (0.40, 4.2), "zigzag": (0.75, 5.2), "berthing": (0.38, 4.5)}
INITIAL_S = 5.0  # s of a window from which its state is estimated, where the trial sets none
# the windows on which the published simulator was judged: the first two of a run, started from the first sample
ANCHOR = HoldoutProtocol(initial_s=0.0, max_windows=2)


def label_of(run: str) -> str:
    """Kind of manoeuvre, the word before the date."""
    return run.split("_")[0]


def show(title: str, validation: CrossValidation, *, with_targets: bool = False) -> None:
    """Print one table; `judged`: with every fold and the targets."""
    print(f"\n{title}")
    print("             windows   mean of rms          scatter over folds    rms of all samples")
    for label in validation.labels:
        p, (metres, degrees) = validation.pooled(label), validation.fold_spread(label)
        scatter = f"{metres:6.3f} m {degrees:5.2f} deg" if len(validation.elapsed_s) > 1 else f"{'-':>18}"
        print(
            f"  {label:<10} {p.windows:>6}   {p.position_m:6.3f} m {p.heading_deg:5.2f} deg   {scatter}   "
            f"{p.rms_position_m:6.3f} m {p.rms_heading_deg:5.2f} deg{_verdict(p) if with_targets else ''}"
        )
        for fold in sorted({w.fold for w in validation.windows if w.label == label} if with_targets else ()):
            q = validation.pooled(label, fold)
            print(f"    fold {fold + 1:<3} {q.windows:>6}   {q.position_m:6.3f} m {q.heading_deg:5.2f} deg")


def _verdict(pooled: PooledError) -> str:
    metres, degrees = LIMITS[pooled.label]
    holds = pooled.position_m <= metres and pooled.heading_deg <= degrees
    return f"   target {metres:.2f} m {degrees:.1f} deg {'holds' if holds else 'missed'}"


@dataclass(frozen=True)
class Voyage:
    """Runs of the example with their kinds, and the model fitted without each fold of them."""

    trial: Trial
    runs: Runs
    labels: tuple[str, ...]
    folds: tuple[Fold, ...]

    @property
    def protocol(self) -> HoldoutProtocol:
        """Windows whose initial state is estimated in their first seconds."""
        return HoldoutProtocol(initial_s=self.trial.estimate.initial_s or INITIAL_S)


def voyage(report_progress: Callable[[str], None]) -> Voyage:
    """Return the runs of the example, every one left out once; InputError where they are not there."""
    os.environ.setdefault("SEATRIAL_DATA", str(TRIAL.parent.parent.parent / "shared" / "data"))
    trial = load_trial(TRIAL)
    items, _ = load_records(trial)
    rate = trial.estimate.rate
    records = tuple(i.record if rate is None else i.record.resampled(rate) for i in items)
    labels = tuple(label_of(r.name) for r in records)
    runs = Runs(records, tuple(i.session for i in items), trial.ship.length, trial.noise, trial.forces)
    folds = fit_folds(trial.model, runs, labels, trial.estimate, report_progress=report_progress)
    return Voyage(trial, runs, labels, tuple(folds))


def run() -> list[Line]:
    """Errors of windows of runs left out, by kind of manoeuvre, beside their limits; no line without the records."""
    try:
        v = voyage(lambda text: print(text, file=sys.stderr, flush=True))
    except InputError as error:
        print(error, file=sys.stderr)
        return []
    made = cross_validate(v.folds, v.runs, v.labels, v.protocol)
    table = []
    for label in made.labels:
        pooled, (metres, degrees) = made.pooled(label), LIMITS[label]
        table.append(at_most(f"{label}: position, mean rms of windows of 50 s", pooled.position_m, "m", metres))
        table.append(at_most(f"{label}: heading, mean rms of windows of 50 s", pooled.heading_deg, "deg", degrees))
    return table


def main() -> int:
    """Print the tables; 2 for bad input."""
    try:
        v = voyage(lambda text: print(text, flush=True))
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    made = cross_validate(v.folds, v.runs, v.labels, v.protocol)
    published = parameter_set("esso-osaka").applied_to(model_named("mmg"))
    show(f"fitted, {len(v.runs)} runs, all windows, initial state from the first {v.protocol.initial_s:g} s",
         made, with_targets=True)  # fmt: skip
    print(f"  a fit takes {min(made.elapsed_s):.1f} to {max(made.elapsed_s):.1f} s")
    problem = v.folds[0].estimation.estimate.problem
    plain = replace(v.runs, noise=dict(zip(problem.data.outputs, problem.noise.tolist(), strict=True)))
    channels = v.trial.estimate.channels
    within = Fold(tuple(range(len(v.runs))), estimate_model(v.trial.model, v.runs, v.trial.estimate))
    show("fitted on all runs, nothing held out: what the model class and the wind leave",
         cross_validate((within,), v.runs, v.labels, v.protocol))  # fmt: skip
    show(
        "published coefficients, the same windows",
        cross_validate_unfitted(published, plain, v.labels, v.protocol, channels),
    )
    show("fitted, first two windows of a run, started from the first sample",
         cross_validate(v.folds, v.runs, v.labels, ANCHOR))  # fmt: skip
    show(
        "published coefficients, the same windows",
        cross_validate_unfitted(published, plain, v.labels, ANCHOR, channels),
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
