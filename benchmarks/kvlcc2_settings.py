"""How the settings of examples/kvlcc2_hsva.toml were chosen: each candidate leaves out every training run in turn.

`SEATRIAL_DATA=folder python benchmarks/kvlcc2_settings.py` prints, for each candidate, the mean whole-run errors over
the twelve left-out runs, and those of Z_30_05, the run of the largest rudder angle. The held-out Z_35_05 lies beyond
all training angles, so the rule is the smallest sum of both, in units of 11 deg and 6 m. Z_35_05 itself is not read.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from measure import machine

from seatrial.core.values import Prior
from seatrial.data.trial import Role, Trial, load_records, load_trial
from seatrial_studies.alexandersson2022.reproduction import leave_one_out

TRIAL = Path(__file__).parents[1] / "examples" / "kvlcc2_hsva.toml"
PUBLISHED_THRUST = {"k_0": 0.2931, "k_1": -0.2753, "k_2": -0.1385}
RUDDER = ("a_H", "gamma_R_plus", "gamma_R_minus", "l_R_prime", "kappa", "epsilon")
MASSES = ("m_x_prime", "m_y_prime", "J_z_prime")
HEADING_DEG, POSITION_M, LARGEST = 11.0, 6.0, "Z_30_05"


@dataclass(frozen=True)
class Candidate:
    """What differs from the trial file: prior of the hull in per cent, segment length, more free parameters."""

    name: str
    percent: float
    segment_s: float
    thrust: Mapping[str, float] | None = None
    extra: Mapping[str, float] | None = None

    def applied(self, trial: Trial) -> Trial:
        """The trial with these settings; `extra` maps parameters to prior standard deviations."""
        parameters = trial.model.parameters
        spread = {p.name: self.percent / 100.0 * p.characteristic_scale for p in parameters.free} | dict(
            self.extra or {}
        )
        parameters = parameters.with_values(dict(self.thrust or {})).only_free(spread)
        parameters = parameters.with_priors(
            {n: Prior(parameters[n].value, sd, "candidate") for n, sd in spread.items()}
        )
        return replace(trial, model=trial.model.with_parameters(parameters),
                       estimate=replace(trial.estimate, segment_s=self.segment_s))  # fmt: skip


def candidates(trial: Trial) -> Iterator[Candidate]:
    """The settings that were compared."""
    relative = {n: 0.1 * trial.model.parameters[n].characteristic_scale for n in (*RUDDER, *MASSES)}
    yield Candidate("hull 10 %, published thrust, 10 s", 10, 10, PUBLISHED_THRUST)
    yield Candidate("hull 10 %, published thrust, 15 s", 10, 15, PUBLISHED_THRUST)
    yield Candidate("hull 10 %, own thrust, 10 s", 10, 10)
    yield Candidate("hull 3 %, own thrust, 10 s", 3, 10)
    yield Candidate("hull 3 %, own thrust, 20 s", 3, 20)
    yield Candidate("the first, side forces of the screw", 10, 10, PUBLISHED_THRUST, {"Y_T": 0.003, "N_T": 0.003})
    yield Candidate("the first, rudder and masses 10 %", 10, 10, PUBLISHED_THRUST, relative)


def main() -> None:
    """Print the table."""
    trial = load_trial(TRIAL)
    records, _ = load_records(trial)
    rate = trial.estimate.rate
    train = [replace(r, record=r.record.resampled(rate)) for r in records if r.role is Role.TRAIN]
    print(machine())
    print(f"{'candidate':<38}{'all twelve':>16}{'Z_30_05':>16}{'score':>8}")
    for candidate in candidates(trial):
        made = leave_one_out(candidate.applied(trial), train, lambda _: {})
        errors = np.array([[m.prediction.rms["psi_deg"], m.prediction.rms["position_m"]] for m in made])
        largest = errors[[m.run.endswith(LARGEST) for m in made]][0]
        score = float(np.sum((errors.mean(axis=0) + largest) / (HEADING_DEG, POSITION_M)))
        pairs = "".join(f"{deg:>7.2f} deg{m:>5.2f} m".rjust(16) for deg, m in (errors.mean(axis=0), largest))
        print(f"{candidate.name:<38}{pairs}{score:>8.2f}", flush=True)


if __name__ == "__main__":
    main()
