"""Runs left out, predicted in windows: share of samples inside the 95 % bands, their width over the error, baselines.

    SEATRIAL_DATA=folder python benchmarks/prediction_bands.py [--tables kvlcc2,esso_day,esso_run,blueboat,...]

Models, priors and settings are those of the example trials; every run is left out once, with the others of its split.
"""

import argparse
import os
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from measure import Line, at_least, at_most, machine

from seatrial.core.results import Prediction
from seatrial.core.results.prediction import ChannelScore
from seatrial.core.values import InputError
from seatrial.data.trial import Role, Trial, TrialRecord, checked_records, load_trial
from seatrial.estimation.estimate import INITIAL_STATE_SHIP_LENGTHS, estimate_model, ship_length_seconds
from seatrial.estimation.estimate.assemble import training_runs
from seatrial.estimation.estimate.fit import with_segment_seconds
from seatrial.estimation.predict.predict_runs import predict_runs
from seatrial.estimation.predict.windows import window_lengths

EXAMPLES = Path(__file__).parents[1] / "examples"
CHANNELS = ("psi_deg", "position_m")
THREES = 4
"""Splits of the tanker's twelve runs; run number k is left out in split k modulo this."""
LEAST_INSIDE, WIDEST = 0.92, 2.7
"""Share of samples that a 95 % band must hold at least, and its half width over the rms error at most; a normal error
of known size has 0.95 and 1.96."""
BLUEBOAT_KINDS: Mapping[str, tuple[str, ...]] = {
    "spins": ("226", "228"), "turns": ("220", "224", "225"), "astern": ("221", "223"), "ahead": ("218", "222"),
}  # fmt: skip
"""What is predicted -> last digits of the logs; all others train."""


@dataclass(frozen=True)
class Table:
    """One way to leave runs of a trial out.

    Attributes:
        trial: name of the example; windows: lengths, as `--windows`.
        split_of, row_of: of a run's number and record, the split it is left out in, and the row that counts it.
        initial_s: of a window's beginning, for its initial state [s]; None: as the trial.
    """

    trial: str
    windows: str
    split_of: Callable[[int, TrialRecord], str]
    row_of: Callable[[TrialRecord], str]
    initial_s: float | None = None


def kind_of(item: TrialRecord) -> str:
    """Return the kind of manoeuvre, the word before the date in the name."""
    return item.record.name.split("_")[0]


def blueboat_kind(item: TrialRecord) -> str:
    """Return the kind of a BlueBoat log."""
    return next(kind for kind, ends in BLUEBOAT_KINDS.items() if item.record.name.endswith(ends))


TABLES: Mapping[str, Table] = {
    "kvlcc2": Table("kvlcc2_hsva", "5L,30s", lambda i, _: f"three of twelve, {i % THREES}", lambda _: "zigzag"),
    "esso_day": Table("esso_osaka", "50s", lambda _, item: item.session, kind_of),
    "esso_run": Table("esso_osaka", "50s", lambda _, item: item.record.name, kind_of),
    "blueboat": Table("blueboat", "10s,30s", lambda _, item: item.record.name, lambda _: "log", 1.0),
    "blueboat_kind": Table("blueboat", "10s,30s", lambda _, item: blueboat_kind(item), blueboat_kind, 1.0),
}


@dataclass(frozen=True)
class Row:
    """Windows of one length of one row, pooled over runs.

    Attributes:
        inside, width: of each of `CHANNELS`, share of samples inside the band and rms half width over rms error.
        rms: of each of `CHANNELS`, the fit's, then those of baselines by name.
        extrapolated: number of runs whose prediction is named as extrapolation; runs: of all.
    """

    name: str
    window: str
    count: int
    inside: tuple[float, ...]
    width: tuple[float, ...]
    rms: Mapping[str, tuple[float, ...]]
    extrapolated: int
    runs: int


def left_out(trial: Trial, items: Sequence[TrialRecord], table: Table, splits: Sequence[str] = ()) -> Iterator[
    tuple[str, Prediction]
]:  # fmt: skip
    """Yield row and prediction of every run, left out of the fit with the others of its split."""
    of_run = [table.split_of(i, item) for i, item in enumerate(items)]
    for split in splits or dict.fromkeys(of_run):
        divided = [
            replace(item, role=Role.VALIDATE if s == split else Role.TRAIN)
            for s, item in zip(of_run, items, strict=True)
        ]
        runs = training_runs(trial, divided)
        began = time.process_time()
        try:
            estimation = estimate_model(trial.model, runs, with_segment_seconds(trial.estimate, trial.model, runs))
        except InputError as error:
            print(f"{split}: {error}", file=sys.stderr)
            continue
        seconds = table.initial_s or trial.estimate.initial_s
        seconds = seconds or INITIAL_STATE_SHIP_LENGTHS * ship_length_seconds(runs.records, runs.length)
        fitted = time.process_time()
        predicted = predict_runs(
            estimation, divided, seconds, runs.length, windows=window_lengths(table.windows),
            offsets_from_start=trial.estimate.offsets_from_start,
        )  # fmt: skip
        print(f"{split}: CPU {fitted - began:.1f} s fit, {time.process_time() - fitted:.1f} s predictions",
              file=sys.stderr, flush=True)  # fmt: skip
        rows = {item.record.name: table.row_of(item) for item in items}
        yield from ((rows[p.record], p) for p in predicted.predictions if p.role == "validation")


def pooled(predictions: Sequence[tuple[str, Prediction]]) -> list[Row]:
    """Return rows of predictions, in the order in which row and length of window occur first."""
    keys = dict.fromkeys((row, w.window) for row, p in predictions for w in p.windows)
    return [_pooled(row, window, [p for r, p in predictions if r == row]) for row, window in keys]


def _pooled(row: str, window: str, predictions: Sequence[Prediction]) -> Row:
    scores = [w for p in predictions for w in p.windows if w.window == window]
    count = np.array([w.count for w in scores], dtype=float)

    def mean(values: Sequence[float]) -> float:
        return float(np.average(values, weights=count)) if len(values) == len(count) else float("nan")

    def rms(of: Sequence[Mapping[str, ChannelScore]]) -> tuple[float, ...]:
        return tuple(float(np.sqrt(mean([s[c].rms ** 2 for s in of if c in s]))) for c in CHANNELS)

    own = rms([w.scores for w in scores])
    half = [np.sqrt(mean([((w.scores[c].band_over_error or 0.0) * w.scores[c].rms) ** 2 for w in scores]))
            for c in CHANNELS]  # fmt: skip
    names = dict.fromkeys(b.name for w in scores for b in w.baselines)
    baselines = {n: rms([b.scores for w in scores for b in w.baselines if b.name == n]) for n in names}
    return Row(
        row, window, int(count.sum()),
        tuple(mean([w.scores[c].inside_band or 0.0 for w in scores]) for c in CHANNELS),
        tuple(float(h / e) for h, e in zip(half, own, strict=True)),
        {"fit": own} | baselines,
        sum(bool(p.extrapolation and p.extrapolation.index > 1.0) for p in predictions), len(predictions),
    )  # fmt: skip


def table_rows(name: str, splits: Sequence[str] = ()) -> list[Row]:
    """Return the rows of one of `TABLES`, of some of its splits or of all."""
    table = TABLES[name]
    trial = load_trial(EXAMPLES / f"{table.trial}.toml")
    items = [i for i in checked_records(trial).records if name != "kvlcc2" or i.role is Role.TRAIN]
    return pooled(list(left_out(trial, items, table, splits)))


def run() -> list[Line]:
    """The tanker's bands, of all splits."""
    if not os.environ.get("SEATRIAL_DATA"):
        return []
    lines = []
    for row in table_rows("kvlcc2"):
        for name, inside, width in zip(("heading", "position"), row.inside, row.width, strict=True):
            what = f"zigzags left out, windows of {row.window}: {name}"
            lines += [
                at_least(f"{what} inside the 95 % band", inside, "", LEAST_INSIDE),
                at_most(f"{what}, half width over error", width, "", WIDEST),
            ]
    return lines


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--tables", default=",".join(TABLES), help="names, separated by commas")
    arguments = parser.parse_args()
    print(machine())
    for name in arguments.tables.split(","):
        print(
            f"\n{name}: inside the 95 % band, heading and position (half width over error); rms heading deg, position m"
        )
        for row in table_rows(name):
            shares = "  ".join(f"{s:.3f} ({w:.1f})" for s, w in zip(row.inside, row.width, strict=True))
            errors = "; ".join(f"{n} {e[0]:.3g} {e[1]:.3g}" for n, e in row.rms.items())
            print(f"  {row.name:10}{row.window:>6}{row.count:5}   {shares}   beyond {row.extrapolated} of {row.runs}   "
                  f"{errors}", flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
