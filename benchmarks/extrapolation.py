"""How fast the model's error grows beyond the training runs: KVLCC2 at large rudder angles predicted from small ones.

`SEATRIAL_DATA=folder python benchmarks/extrapolation.py` fits the training zigzags up to each limit of rudder angle,
predicts 30 s windows of the larger ones, and prints the share of headings and of positions (x0 and y0) inside the 95 %
band if the discrepancy grows with the extrapolation index to the power 0, 1, 2 or 3. The file of the run held out in
the example trial is not opened. A run that lies beyond several limits counts once for each.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from measure import machine

from seatrial.data.trial import Role, Trial, TrialRecord, load_records, load_trial
from seatrial.estimation.estimate import estimate_model
from seatrial.estimation.estimate.assemble import training_runs
from seatrial.estimation.information.discrepancy import GROWTH_POWER, HoldoutError
from seatrial.estimation.predict.windows import HoldoutProtocol
from seatrial_studies.alexandersson2022.reproduction import MissedWindows, band_coverage, holdout_windows

TRIAL = Path(__file__).parents[1] / "examples" / "kvlcc2_hsva.toml"
LIMITS, POWERS, WINDOW_S = (10, 15, 20, 25), (0.0, 1.0, 2.0, 3.0), 30.0


def angle(item: TrialRecord) -> int:
    """Rudder angle of a zigzag from its name [deg]."""
    found = re.search(r"_Z_(\d\d)", item.record.name)
    assert found is not None
    return int(found.group(1))


def shares(trial: Trial, train: Sequence[TrialRecord], limit: int) -> dict[float, list[tuple[float, float]]]:
    """Power -> shares of headings and of positions inside the band, one pair for each run beyond the limit."""
    known = [r for r in train if angle(r) <= limit]
    beyond = [r for r in train if angle(r) > limit]
    found = estimate_model(trial.model, training_runs(trial, known), trial.estimate)
    missed = holdout_windows(found, known, beyond, HoldoutProtocol(window_s=WINDOW_S))
    return {
        power: [
            (one.shares["psi"], 0.5 * (one.shares["x0"] + one.shares["y0"]))
            for one in band_coverage(to_the_power(missed, power))[1]
        ]
        for power in POWERS
    }


def to_the_power(missed: MissedWindows, power: float) -> MissedWindows:
    """The same misses with indices so changed that their growth is the given power of the true ones."""

    def changed(runs: tuple[tuple[HoldoutError, ...], ...]) -> tuple[tuple[HoldoutError, ...], ...]:
        return tuple(tuple(replace(m, index=max(m.index, 1.0) ** (power / GROWTH_POWER)) for m in run) for run in runs)

    return replace(missed, training=changed(missed.training), held_out=changed(missed.held_out))


def row(name: str, band_shares: Mapping[float, Sequence[tuple[float, float]]]) -> str:
    """Means over runs: heading / position for each power."""
    means = [np.mean(band_shares[power], axis=0) for power in POWERS]
    return f"{name:<16}{len(band_shares[0.0]):>12}" + "".join(f"{f'{h:.2f} / {p:.2f}':>15}" for h, p in means)


def main() -> None:
    """Print the table."""
    trial = load_trial(TRIAL)
    trial = replace(trial, runs=tuple(run for run in trial.runs if run.role is Role.TRAIN))
    rate = trial.estimate.rate
    train = [replace(r, record=r.record.resampled(rate) if rate else r.record) for r in load_records(trial)[0]]
    print(machine())
    print(f"{'trained up to':<16}{'runs beyond':>12}" + "".join(f"{f'power {p:g}':>15}" for p in POWERS))
    pooled: dict[float, list[tuple[float, float]]] = {p: [] for p in POWERS}
    for limit in LIMITS:
        made = shares(trial, train, limit)
        print(row(f"{limit:>4} deg", made), flush=True)
        for power in POWERS:
            pooled[power] += made[power]
    print(row("pooled", pooled))


if __name__ == "__main__":
    main()
