"""BlueBoat: share of samples of 10 s windows inside their 95 % bands, on runs and on kinds of runs left out.

    python benchmarks/thrusters_bands.py [--window 10] [--splits spins,astern]

Model, priors and settings are those of examples/blueboat.toml. A split names the runs that are predicted; all others
train. Splits by kind: what is predicted is unlike anything that was fitted.
"""

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from seatrial.core.results import WindowScore
from seatrial.core.values import InputError
from seatrial.data.trial import Role, Trial, TrialRecord, checked_records, load_trial
from seatrial.estimation.estimate import estimate_model
from seatrial.estimation.estimate.fit import with_segment_seconds
from seatrial.estimation.estimate.runs import training_runs
from seatrial.estimation.predict.predict_runs import predict_runs
from seatrial.estimation.predict.window_scores import WindowLength

TRIAL = Path(__file__).parents[1] / "examples" / "blueboat.toml"
INITIAL_S = 1.0
"""Length of a window's beginning from which its state is estimated [s]."""
KINDS: Mapping[str, tuple[str, ...]] = {
    "spins": ("226", "228"),
    "turns": ("220", "224", "225"),
    "turns and spins": ("220", "224", "225", "226", "228"),
    "astern": ("221", "223"),
    "astern and spins": ("221", "223", "226", "228"),
    "ahead": ("218", "222", "224", "225"),
}
"""What is predicted -> last digits of the logs."""
LIMIT = 0.92
"""Share of samples of heading and position that must lie inside, on logs never seen."""


@dataclass(frozen=True)
class Coverage:
    """Of one predicted run: number of windows, extrapolation index, score by channel."""

    split: str
    run: str
    index: float
    score: WindowScore


def coverage(
    trial: Trial, items: Sequence[TrialRecord], split: str, ends: Sequence[str], window_s: float
) -> list[Coverage]:
    """Return the scores of the runs whose names end as one of `ends`, predicted from all others."""
    divided = [replace(i, role=Role.VALIDATE if i.record.name.endswith(tuple(ends)) else Role.TRAIN) for i in items]
    runs = training_runs(trial, divided)
    estimation = estimate_model(trial.model, runs, with_segment_seconds(trial.estimate, trial.model, runs))
    predicted = predict_runs(estimation, divided, INITIAL_S, runs.length, windows=[WindowLength(window_s, "s")])
    return [
        Coverage(split, p.record, p.extrapolation.index if p.extrapolation else 1.0, p.windows[0])
        for p in predicted.predictions
        if p.role == "validation" and p.windows
    ]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--window", type=float, default=10.0, help="s")
    parser.add_argument("--splits", default="", help="names, separated by commas; default: all")
    arguments = parser.parse_args()
    trial = load_trial(TRIAL)
    items = list(checked_records(trial).records)
    splits = {f"run {i.record.name[-3:]}": (i.record.name[-3:],) for i in items} | dict(KINDS)
    chosen = arguments.splits.split(",") if arguments.splits else list(splits)
    print(f"windows of {arguments.window:g} s; limit {LIMIT}")
    print(f"{'predicted':18}{'run':16}{'windows':>8}{'index':>7}{'psi in':>8}{'pos in':>8}{'psi deg':>9}{'pos m':>7}")
    for split in chosen:
        try:
            rows = coverage(trial, items, split, splits[split], arguments.window)
        except InputError as error:
            print(f"{split:18}{error}", flush=True)
            continue
        for row in rows:
            scores = row.score.scores
            inside = "".join(f"{scores[c].inside_band or 0.0:8.2f}" for c in ("psi_deg", "position_m"))
            errors = f"{scores['psi_deg'].rms:9.1f}{scores['position_m'].rms:7.2f}"
            print(f"{split:18}{row.run:16}{row.score.count:8}{row.index:7.2f}{inside}{errors}", flush=True)
        pooled = [
            sum((r.score.scores[c].inside_band or 0.0) * r.score.count for r in rows) / sum(r.score.count for r in rows)
            for c in ("psi_deg", "position_m")
        ]
        print(f"{split:18}{'all':16}{'':15}{pooled[0]:8.2f}{pooled[1]:8.2f}", flush=True)


if __name__ == "__main__":
    main()
