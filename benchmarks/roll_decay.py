"""KVLCC2's roll decays beside the classes of rolldecay-estimators in one run: how much of the roll is explained.

Both fit the same rows: each decay from its release, from half a second later, and from its next two extremes on.
R2 is that of the simulated angle over all of these rows. One decay also predicts the other without being refitted.
The half of the larger swings of each predicts its other half and the halves of the other decay: how far a single decay
can be judged by itself, and how far two decays of the same release differ.
"""

import json
import os
import subprocess
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from against_shipmmg import HERE, peers_python
from measure import Line, at_least, at_most, fastest

from seatrial.core.values import Record
from seatrial.data.check.motion import sample_noise
from seatrial.data.trial import Trial, load_records, load_trial
from seatrial.estimation.estimate import Estimation, Runs, estimate_model
from seatrial.estimation.identify.model_selection import halves, roll_structures
from seatrial.estimation.predict.open_loop import rms_errors, simulate_open_loop

TRIAL = HERE.parent / "examples" / "kvlcc2_rolldecay.toml"
TARGETS = {"model_test_21337": 0.99998, "model_test_21338": 0.9999}
CROSS, SECONDS = 0.998, 0.5
CHOSEN, HALF_START_S = "quadratic damping, cubic restoring", 10.0  # structure and s of a half that give its start


def r_squared(measured: np.ndarray, simulated: np.ndarray) -> float:
    """Share of the variance that is explained."""
    return float(1.0 - np.sum((measured - simulated) ** 2) / np.sum((measured - measured.mean()) ** 2))


def fit_decay(trial: Trial, record: Record) -> Estimation:
    """Ours, from an automatic start."""
    runs = Runs((record,), ("decay",), trial.ship.length, trial.noise, trial.forces)
    return estimate_model(trial.model, runs, trial.estimate)


def fitted_r_squared(estimation: Estimation, record: Record) -> float:
    """R2 over the rows that were fitted."""
    return r_squared(record["phi"], record["phi"] + estimation.residuals[:, 0])


def predicted_r_squared(estimation: Estimation, record: Record, seconds: float) -> float:
    """R2 of a record that was not fitted."""
    made = simulate_open_loop(estimation.estimate.problem, estimation.model, record, np.zeros(0), seconds)
    return r_squared(record["phi"], made.record["phi"])


def _unexplained(quantity: str, score: float, target: float | None = None) -> Line:
    """Parts per million of the variance, R2 in words; target: of R2."""
    said, left = f"{quantity}: R2 {score:.7f}", 1e6 * (1.0 - score)
    return Line(said, left, "ppm") if target is None else at_most(said, left, "ppm", round(1e6 * (1.0 - target), 6))


def halves_lines(trial: Trial, records: dict[str, Record]) -> list[Line]:
    """Errors of both halves of both decays by the half of the larger swings of one, rms [deg]."""
    model, lines = roll_structures(trial.model, None)[CHOSEN], []
    runs = {name: Runs((r,), ("decay",), trial.ship.length, trial.noise, trial.forces) for name, r in records.items()}
    splits = {name: halves(one) for name, one in runs.items()}

    def missed(estimation: Estimation, record: Record) -> float:
        made = simulate_open_loop(estimation.estimate.problem, estimation.model, record, np.zeros(0), HALF_START_S)
        return rms_errors(record, made.record)["phi_deg"]

    for name, split in splits.items():
        (other,) = [s for n, s in splits.items() if n != name]
        fit = estimate_model(model, split.fitted, trial.estimate)
        lines += [
            Line(f"{name}: noise from sample to sample", float(np.degrees(sample_noise(records[name]["phi"]))), "deg"),
            Line(f"{name}: left of its half of larger swings", float(np.degrees(np.std(fit.residuals))), "deg"),
            Line(f"{name}: its other half", missed(fit, split.judged), "deg"),
            Line(f"{name}: the other decay, larger swings", missed(fit, other.fitted.records[0]), "deg"),
            Line(f"{name}: the other decay, smaller swings", missed(fit, other.judged), "deg"),
        ]
    return lines


def start_rows(record: Record) -> list[int]:
    """Rows: the release, half a second later, and the next two extremes."""
    rising = np.diff(record["phi"]) > 0.0
    extremes = np.flatnonzero(rising[11:] != rising[10:-1]) + 11
    return [0, round(0.5 / record.dt), *extremes[:2].tolist()]


def run() -> list[Line]:
    """Ours, then the peer's best class, then the least difference over all beginnings."""
    if "SEATRIAL_DATA" not in os.environ:
        print("  left out: set SEATRIAL_DATA to the folder with kvlcc2_rolldecay")
        return []
    trial = load_trial(TRIAL)
    records = {r.record.name: r.record for r in load_records(trial)[0]}
    found = {name: fit_decay(trial, record) for name, record in records.items()}
    lines = []
    for name, record in records.items():
        (other,) = [n for n in records if n != name]
        lines += [
            _unexplained(f"{name}, ours", fitted_r_squared(found[name], record), TARGETS[name]),
            _unexplained(f"{name} from {other}", predicted_r_squared(found[other], record, 10.0), CROSS),
            at_most(f"{name}: fit", fastest(lambda r=record: fit_decay(trial, r), 3), "s", SECONDS),
        ]
    return [*lines, *halves_lines(trial, records), *_compare_with_peer(trial, records, found)]


def _compare_with_peer(trial: Trial, records: dict[str, Record], estimations: dict[str, Estimation]) -> list[Line]:
    rows = {name: start_rows(record) for name, record in records.items()}
    theirs = _peer(records, rows, estimations)
    lines = []
    for name, record in records.items() if theirs else ():
        best = {row: max(_scores(theirs[name], str(row)), key=lambda pair: pair[1]) for row in rows[name]}
        own = {
            row: fitted_r_squared(fit_decay(trial, _from_row(record, row)), _from_row(record, row))
            for row in rows[name]
        }
        seconds = min(one["0"]["seconds"] for kind, one in theirs[name].items() if kind == best[0][0])
        lines += [
            _unexplained(f"{name}, rolldecay-estimators", best[0][1]),
            _unexplained(f"{name}, it with its own start", max(s for _, s in _scores(theirs[name], "its own start"))),
            Line(f"{name}: its search ({best[0][0]})", seconds, "s"),
            at_least(f"{name}: our R2 less its best, least of {len(own)} beginnings",
                     1e6 * min(own[row] - best[row][1] for row in own), "ppm", 0.0),
        ]  # fmt: skip
    return lines


def _from_row(record: Record, row: int) -> Record:
    return replace(record.rows(slice(row, None)), name=record.name)


def _scores(classes: dict[str, dict[str, dict[str, float | None]]], key: str) -> list[tuple[str, float]]:
    """Class and R2; minus infinity where it failed."""
    return [
        (kind, -np.inf if one[key]["r2"] is None else float(one[key]["r2"] or 0.0)) for kind, one in classes.items()
    ]


def _peer(
    records: dict[str, Record], rows: dict[str, list[int]], estimations: dict[str, Estimation]
) -> dict[str, dict[str, dict[str, dict[str, float | None]]]]:
    """What its classes reach, by run, class and beginning; empty where it cannot be installed."""
    with tempfile.TemporaryDirectory() as text:
        folder = Path(text)
        try:
            python = peers_python(folder / "peers", "peers_rolldecay.txt")
        except subprocess.CalledProcessError:
            print("  left out: rolldecay-estimators could not be installed")
            return {}
        task: dict[str, np.ndarray] = {"runs": np.array(list(records))}
        for name, record in records.items():
            rest = estimations[name].model.parameters["phi_0"].value
            task |= {
                f"{name}/time": record.time,
                f"{name}/phi": record["phi"] - rest,
                f"{name}/rows": np.array(rows[name]),
            }
        np.savez(folder / "task.npz", **task)
        same_order = {**os.environ, "PYTHONHASHSEED": "0"}  # it takes its coefficients in the order of a set
        subprocess.run([python, HERE / "peer_rolldecay.py", folder], check=True, env=same_order)
        return json.loads((folder / "peer.json").read_text())


if __name__ == "__main__":
    for line in run():
        print(f"  {line.quantity:<78} {line.value:>10.4g} {line.unit:<3} {line.verdict}", flush=True)
