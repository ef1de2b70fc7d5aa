"""A warning where the estimated disturbance moves a state by more than the state moves at all: no sea does that."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.results import Prediction
from seatrial.core.text.numbers import significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import NOTATION, Finding, Severity

EXCEEDS_MOTION = "disturbance-exceeds-motion"
# of the disturbance, an open-loop error below which the model does not miss the state by anything like it; chosen
_LEAST_ERROR = 0.3


@dataclass(frozen=True)
class _Excess:
    """A state whose disturbance exceeds its motion: both, and the open-loop error (NaN: not measured), all SI."""

    state: str
    disturbed: float
    spread: float
    error: float

    @property
    def is_misfit(self) -> bool:
        """Whether the model misses the state by something like the disturbance."""
        return not self.error < _LEAST_ERROR * self.disturbed

    def text(self, seconds: float) -> str:
        unit = NOTATION[self.state].unit
        moved = f"{self.state}: {significant(self.disturbed, 2)} {unit} within {significant(seconds, 2)} s"
        missed = f" and the model misses it by {significant(self.error, 2)} {unit}" if math.isfinite(self.error) else ""
        return f"{moved}, while the runs spread by {significant(self.spread, 2)} {unit}{missed}"


def misfit_disturbance(
    intensities: Mapping[str, float], trained: Sequence[Prediction], seconds: float
) -> tuple[Finding, ...]:
    """Return a warning `disturbance-exceeds-motion` of the states whose noise exceeds their own spread.

    Where the model misses such a state by far less, open loop, it is no misfit: the intensity is not determined.

    Args:
        intensities: state -> intensity of its process noise, SI over the root of a second.
        trained: the training runs as the model has them.
        seconds: in which the craft changes its motion; noise that is not damped grows to q sqrt(T) in it.
    """
    found = list(_excesses(intensities, trained, seconds))
    undetermined = [one for one in found if not one.is_misfit]
    misfit = [one for one in found if one.is_misfit]
    findings = list[Finding]()
    if misfit:
        findings.append(Finding(
            Severity.WARNING, EXCEEDS_MOTION, "the estimated disturbance moves the craft by more than it moves in the "
            "runs: the model's misfit, not the sea, is likely", "; ".join(one.text(seconds) for one in misfit),
            "free more coefficients, correct a channel, or take a richer model",
        ))  # fmt: skip
    if undetermined:
        names = enumeration([one.state for one in undetermined])
        findings.append(Finding(
            Severity.WARNING, EXCEEDS_MOTION, f"the estimated disturbance of {names} cannot be: the model without it "
            "misses far less, so that its size is not determined", "; ".join(one.text(seconds) for one in undetermined),
            f"state the sensors' noise of {names} under [noise], so that the filter does not choose it",
            "intervals and bands that rest on it are too wide",
        ))  # fmt: skip
    return tuple(findings)


def _excesses(intensities: Mapping[str, float], trained: Sequence[Prediction], seconds: float) -> Iterator[_Excess]:
    moving = {state: intensity for state, intensity in intensities.items() if state in NOTATION}  # no instrument's own
    for state, intensity in moving.items():
        runs = [p for p in trained if state in p.simulated]
        samples = [p.simulated[state][np.isfinite(p.simulated[state])] for p in runs]
        spread = float(np.std(np.concatenate(samples))) if samples else math.nan
        error = max((p.rms[state] for p in runs if state in p.rms), default=math.nan)
        disturbed = intensity * math.sqrt(seconds)
        if disturbed > spread > 0.0:
            yield _Excess(state, disturbed, spread, error)
