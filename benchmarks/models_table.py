"""Nomoto, Abkowitz and MMG under one protocol on two ships: what a model's detail buys on records it has not seen.

KVLCC2: twelve zigzags train, Z_35_05 is held out (windows of 30 s, and the whole run open loop). Esso Osaka: turning
and zigzag, four folds over whole runs, windows of 50 s. `python benchmarks/models_table.py [kvlcc2] [esso_osaka]`.

The comparison favours Nomoto and Abkowitz: their first forms (a free cubic term; wide priors around zero) diverged on
Z_35_05, and the forms below were taken after that was seen. The MMG has the trial file's own settings.
"""

import os
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from measure import machine

from seatrial.core.equations import Model
from seatrial.core.values import InputError, Prior, Record
from seatrial.data.trial import EstimateSettings, Role, Trial, TrialRecord, load_records, load_trial
from seatrial.estimation.estimate.assemble import training_runs
from seatrial.estimation.identify import Runs, estimate_model
from seatrial.estimation.predict.open_loop import rms_errors, simulate_open_loop
from seatrial.estimation.predict.session_offsets import session_offsets
from seatrial.estimation.predict.windows import HoldoutProtocol, window_errors
from seatrial.physics.models.abkowitz import STANDARD, abkowitz
from seatrial.physics.models.nomoto import nomoto2
from seatrial_studies.cross_validation import cross_validate, fit_folds

EXAMPLES = Path(__file__).parents[1] / "examples"
HELD_OUT_SECONDS, WINDOW = 6.0, {"kvlcc2_hsva": 30.0, "esso_osaka": 50.0}
# asymmetry, and rudder terms, beside the standard set
ABKOWITZ_TERMS = (*STANDARD, "X_0", "Y_ddd", "N_ddd")


@dataclass(frozen=True)
class Row:
    """One model on one ship: errors of held-out windows (mean of their rms) and of the whole held-out run."""

    model: str
    label: str
    free: int
    position_m: float
    heading_deg: float
    whole_position_m: float | None
    whole_heading_deg: float | None
    seconds: float


def steering(trial: Trial, speed: float) -> Model:
    """Second-order Nomoto at a constant speed, which is estimated."""
    model = nomoto2().with_values(
        {"U": speed, "T_1": 4 * trial.ship.length / speed, "T_2": 0.4 * trial.ship.length / speed}
    )
    model = model.with_values({"K": 0.5 * speed / trial.ship.length, "T_3": 0.8 * trial.ship.length / speed})
    return model.with_parameters(model.parameters.freed("U"))


def expansion(trial: Trial, speed: float) -> Model:
    """Abkowitz with the trial's added masses fixed and its hull coefficients as prior means, in the L^2 prime system.

    The rest of every coefficient (rudder, propeller) is unknown: half of the mean, 0.003 at least, is its spread, and
    0.01 that of terms a hull alone does not have.
    """
    given, terms = {p.name: p.value for p in trial.model.parameters}, ABKOWITZ_TERMS
    slim = given["d"] / trial.ship.length
    masses = {"X_udot": "m_x_prime", "Y_vdot": "m_y_prime", "N_rdot": "J_z_prime"}
    mean = {n: given[n] * slim for n in terms if n in given and n not in ("Y_0", "N_0")}
    mean["Y_r"] -= given["m_x_prime"] * slim
    mean["X_vr"] += given["m_y_prime"] * slim
    priors = {n: Prior(m, max(0.5 * abs(m), 0.003), "hull of the parameter set") for n, m in mean.items()}
    priors |= {n: Prior(0.0, 0.01, "wide, chosen") for n in terms if n not in priors}
    model = abkowitz(terms).with_values(
        {**{n: given[n] for n in ("L", "m", "x_G", "I_z", "rho")}, "U_n": speed}
        | {name: -given[source] * slim for name, source in masses.items()}
        | {name: prior.mean for name, prior in priors.items()}
    )
    return model.with_parameters(model.parameters.with_priors(priors))


def modular(trial: Trial, _: float) -> Model:
    """The trial's own MMG with its priors."""
    return trial.model


MODELS: dict[str, Callable[[Trial, float], Model]] = {"nomoto2": steering, "abkowitz": expansion, "mmg": modular}


def kvlcc2() -> list[Row]:
    """Twelve zigzags train, Z_35_05 is predicted."""
    trial, records = _loaded("kvlcc2_hsva")
    train = [r for r in records if r.role is Role.TRAIN]
    held = next(r for r in records if r.role is Role.VALIDATE)
    speed = _speed([r.record for r in train])
    rows = []
    for name, made in MODELS.items():
        model = made(trial, speed)
        try:
            began = time.perf_counter()
            found = estimate_model(model, training_runs(trial, train), _settings(trial, model))
            seconds, problem, own = (
                time.perf_counter() - began,
                found.estimate.problem,
                session_offsets(found, held.session, held.record).expected,
            )
            protocol = HoldoutProtocol(window_s=WINDOW["kvlcc2_hsva"], initial_s=HELD_OUT_SECONDS)
            windows = window_errors(problem, found.model, [held.record], [own], ["zigzag"], protocol)
            whole = rms_errors(
                held.record, simulate_open_loop(problem, found.model, held.record, own, HELD_OUT_SECONDS).record
            )
        except InputError as error:
            print(f"  {name}: {error}")
            continue
        rows.append(
            Row(name, held.record.name[-7:], len(problem.free), float(np.mean([w.position_m for w in windows])),
                float(np.mean([w.heading_deg for w in windows])), whole["position_m"], whole["psi_deg"], seconds)
        )  # fmt: skip
    return rows


def esso_osaka() -> list[Row]:
    """Turning and zigzag runs in four folds."""
    trial, records = _loaded("esso_osaka")
    chosen = [r for r in records if not r.record.name.startswith("berthing")]
    speed = _speed([r.record for r in chosen])
    records_and_sessions = tuple(r.record for r in chosen), tuple(r.session for r in chosen)
    runs = Runs(*records_and_sessions, trial.ship.length, trial.noise, trial.forces)
    labels = ["turning" if r.record.name.startswith("turn") else "zigzag" for r in chosen]
    rows = []
    for name, made in MODELS.items():
        model = made(trial, speed)
        try:
            folds = fit_folds(model, runs, labels, _settings(trial, model), workers=2)
            judged = cross_validate(folds, runs, labels, HoldoutProtocol(window_s=WINDOW["esso_osaka"]))
        except InputError as error:
            print(f"  {name}: {error}")
            continue
        for label in judged.labels:
            pooled = judged.pooled(label)
            rows.append(Row(name, label, len(model.parameters.free), pooled.position_m, pooled.heading_deg, None, None,
                            float(np.mean(judged.elapsed_s))))  # fmt: skip
    return rows


SHIPS: dict[str, Callable[[], list[Row]]] = {"kvlcc2": kvlcc2, "esso_osaka": esso_osaka}


def _loaded(name: str) -> tuple[Trial, list[TrialRecord]]:
    trial = load_trial(EXAMPLES / f"{name}.toml")
    records, _ = load_records(trial)
    rate = trial.estimate.rate
    return trial, [r if rate is None else replace(r, record=r.record.resampled(rate)) for r in records]


def _speed(records: Sequence[Record]) -> float:
    return float(np.median([np.nanmedian(np.abs(r["u"])) for r in records]))


def _settings(trial: Trial, model: Model) -> EstimateSettings:
    """The trial's settings without inputs and outputs that the model lacks."""
    settings, inputs = trial.estimate, model.input_names
    return replace(
        settings,
        offsets={name: sd for name, sd in settings.offsets.items() if name in inputs},
        gains={name: sd for name, sd in settings.gains.items() if name in inputs},
        delays={name: sd for name, sd in settings.delays.items() if name in inputs},
        channels=tuple(c for c in settings.channels if c in model.observables),
    )


def main(names: list[str]) -> int:
    """Print the tables; 2 for an unknown name."""
    data = Path(__file__).parents[2] / "shared" / "data"
    os.environ.setdefault("SEATRIAL_DATA", str(data))
    unknown = [n for n in names if n not in SHIPS]
    if unknown:
        print(f"unknown ship '{unknown[0]}'; known are {', '.join(SHIPS)}")
        return 2
    print(machine())
    for ship in names or SHIPS:
        print(f"\n{ship}\n  {'model':10s} {'held out':10s} {'free':>4s} {'windows m':>10s} {'deg':>6s} "
              f"{'whole m':>8s} {'deg':>6s} {'fit s':>6s}")  # fmt: skip
        for row in SHIPS[ship]():
            whole = [f"{v:.1f}" if v is not None else "-" for v in (row.whole_position_m, row.whole_heading_deg)]
            print(f"  {row.model:10s} {row.label:10s} {row.free:4d} {row.position_m:10.2f} {row.heading_deg:6.1f} "
                  f"{whole[0]:>8s} {whole[1]:>6s} {row.seconds:6.1f}", flush=True)  # fmt: skip
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
