"""KVLCC2 with every coefficient free at a literature prior of 10 %: are masses physical, do the circles improve?

`SEATRIAL_DATA=folder python benchmarks/kvlcc2_literature_priors.py` fits the twelve training runs of
examples/kvlcc2_hsva.toml by output error over whole runs: with the example's hull coefficients, and with rudder, wake,
masses, side forces of the screw and even terms of the rudder free as well, every prior 10 % of the published value (or
of 0.02, where that is larger). Every training run is also left out in turn. Z_35_05 is not read.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np
from kvlcc2_settings import MASSES, RUDDER, TRIAL, Candidate
from measure import machine

from seatrial.core.equations import Model
from seatrial.core.values import InputError
from seatrial.data.trial import EstimateMethod, Role, Trial, TrialRecord, load_records, load_trial
from seatrial.estimation.estimate import EstimatorOptions, estimate_model, training_runs
from seatrial.physics.manoeuvres.measures import measures
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.simulate.steer import SOLAS_SLEW_RATE, manoeuvre
from seatrial_studies.alexandersson2022.reproduction import MEASURED_TURNS, SIDES, Turn, leave_one_out

PERCENT = 10.0
INTERACTION = (*RUDDER, "t_R", "x_H_prime")
WAKE = ("w_P0", "C_1", "C_2_plus", "C_2_minus")
ASYMMETRY = ("Y_T", "N_T", "Y_dd", "N_dd")


def candidates(trial: Trial) -> Iterator[Candidate]:
    """The example's hull coefficients with its priors and with 10 %, and everything free at 10 %."""
    sizes = {
        n: PERCENT / 100.0 * trial.model.parameters[n].characteristic_scale
        for n in (*INTERACTION, *WAKE, *MASSES, *ASYMMETRY)
    }
    yield Candidate("hull 3 %", 3.0, 10.0)
    yield Candidate("hull 10 %", PERCENT, 10.0)
    yield Candidate("all 10 %", PERCENT, 10.0, None, sizes)


def simulated_turns(model: Model, trial: Trial, approach: Mapping[str, float]) -> dict[str, Turn]:
    """Advance and tactical diameter of the 35 deg circles in ship lengths; a side that diverges is left out."""
    slew, length, turns = SOLAS_SLEW_RATE * math.sqrt(trial.ship.scale), trial.ship.length, {}
    for side in SIDES:
        try:
            run = manoeuvre(model, programme(f"turning-circle:35:{side}"), inputs=approach, slew_rate=slew)
            read = measures(run, length)
            turns[side] = Turn(side, read["advance_L"], read["tactical_diameter_L"], model.name)
        except (InputError, KeyError):
            continue
    return turns


def show(candidate: Candidate, trial: Trial, train: list[TrialRecord], approach: Mapping[str, float]) -> None:
    """Print masses and circles of the fit to all training runs, and the errors of each of them left out."""
    applied = candidate.applied(trial)
    applied = replace(applied, estimate=replace(applied.estimate, method=EstimateMethod.OUTPUT_ERROR, segment_s=None))
    fit = estimate_model(applied.model, training_runs(applied, train), applied.estimate, EstimatorOptions(workers=1))
    errors = dict(zip(fit.estimate.problem.free, fit.interval.standard_error, strict=False))
    print(f"{candidate.name}: {len(fit.estimate.problem.free)} coefficients free", flush=True)
    for name in (*MASSES, *ASYMMETRY):
        if name in errors:
            published = trial.model.parameters[name]
            away = (fit.model.parameters[name].value - published.value) / (
                PERCENT / 100.0 * published.characteristic_scale
            )
            value = f"{fit.model.parameters[name].value:.4g} +- {errors[name]:.2g}"
            print(f"  {name:<12} {value:<22} published {published.value:g}, {away:+.1f} prior sd")
    for side, turn in simulated_turns(fit.model, trial, approach).items():
        of_marin = MEASURED_TURNS[side]
        shares = (100.0 * (turn.advance / of_marin.advance - 1.0), 100.0 * (turn.diameter / of_marin.diameter - 1.0))
        print(f"  circle to {side:<10} advance {shares[0]:+.1f} %, tactical diameter {shares[1]:+.1f} % of MARIN's")
    left_out = leave_one_out(applied, train, lambda _: {})
    whole = np.mean([m.prediction.rms["psi_deg"] for m in left_out])
    windows = np.average([m.window_heading_deg for m in left_out], weights=[m.window_count for m in left_out])
    print(f"  runs left out: whole {whole:.2f} deg, windows of 30 s {windows:.2f} deg", flush=True)


def main() -> None:
    """Print the table."""
    trial = load_trial(TRIAL)
    rate = trial.estimate.rate
    train = [replace(r, record=r.record.resampled(rate)) for r in load_records(trial)[0] if r.role is Role.TRAIN]
    speed, n = (float(np.median(np.concatenate([r.record[s][:10] for r in train]))) for s in ("u", "n"))
    print(machine())
    print(f"approach {speed:.3f} m/s, {n:.2f} 1/s; output error over whole runs")
    for candidate in candidates(trial):
        show(candidate, trial, train, {"n": n})


if __name__ == "__main__":
    main()
