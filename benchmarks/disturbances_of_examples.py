"""What the choice of a disturbance changes for each shipped example with records: criterion, memory, whiteness, score.

Each is identified twice: with segments or whole runs and no disturbance, as its trial file or `multiple-shooting` says,
and with everything left to the decision table. `python benchmarks/disturbances_of_examples.py [EXAMPLE ...]`; examples
of real records need SEATRIAL_DATA and are left out without it.
"""

import argparse
import os
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from measure import machine

import seatrial as st
from seatrial.core.equations.augment import MEMORY_PREFIX
from seatrial.core.values import InputError
from seatrial.data.trial import EstimateMethod, EstimateSettings

EXAMPLES = Path(__file__).parents[1] / "examples"
REAL = ("kvlcc2_hsva", "esso_osaka", "blueboat", "kvlcc2_rolldecay")
SIMULATED = ("waterjet", "thrusters", "heave_pitch", "fin_decay")


@dataclass(frozen=True)
class Row:
    """One example identified one way; scores: key -> rms error of the held-out runs, mean over them."""

    example: str
    way: str
    criterion: str
    disturbance: str
    memories: Sequence[float]
    whiteness_p: float
    scores: dict[str, float]
    seconds: float

    @property
    def text(self) -> str:
        """The row as a line."""
        memories = ", ".join(f"{m:.3g}" for m in self.memories) or "-"
        scores = ", ".join(f"{name} {value:.3g}" for name, value in self.scores.items()) or "none held out"
        return (f"{self.example:<17} {self.way:<15} {self.criterion:<62} {self.disturbance:<34} memory {memories:<16} "
                f"p {self.whiteness_p:<8.2g} {scores}  ({self.seconds:.0f} s)")  # fmt: skip


def ways(settings: EstimateSettings) -> dict[str, EstimateSettings]:
    """Settings without a disturbance, and with everything left to the decision table."""
    plain = settings if settings.segment_s or settings.segment_lengths else settings.with_method("multiple-shooting")
    free = replace(settings, method=EstimateMethod.AUTO, segment_s=None, segment_lengths=None, robust=False)
    return {"no disturbance": plain, "decision table": free}


def row(example: str, way: str, settings: EstimateSettings, trial: st.Trial) -> Row:
    """Identify one example one way."""
    began = time.process_time()
    fit = st.identify(replace(trial, estimate=settings))
    noise, keys = fit.noise_model, [k for p in fit.validation for k in p.rms]
    scores = {k: float(np.nanmean([p.rms.get(k, np.nan) for p in fit.validation])) for k in dict.fromkeys(keys)}
    return Row(
        example, way, fit.method.criterion, noise.disturbance if noise else "-",
        [t for n, t in noise.added.items() if n.startswith(MEMORY_PREFIX)] if noise else [],
        noise.whiteness_p if noise else np.nan,
        {k: v for k, v in scores.items() if k in ("psi_deg", "position_m") or "psi_deg" not in scores},
        time.process_time() - began,
    )  # fmt: skip


def main(arguments: list[str]) -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description="examples with and without a disturbance")
    parser.add_argument("examples", nargs="*", metavar="EXAMPLE", help=", ".join((*REAL, *SIMULATED)))
    given = parser.parse_args(arguments)
    print(machine())
    present = (*(REAL if os.environ.get("SEATRIAL_DATA") else ()), *SIMULATED)
    for example in given.examples or present:
        trial = st.load_trial(EXAMPLES / f"{example}.toml")
        for way, settings in ways(trial.estimate).items():
            try:
                print(row(example, way, settings, trial).text, flush=True)
            except InputError as error:
                print(f"{example:<17} {way:<15} refused: {error}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
