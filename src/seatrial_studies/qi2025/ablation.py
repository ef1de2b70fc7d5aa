"""What each addition of IWHO to WHO is worth: the search with one of them left out, in the same seas and boxes."""

from dataclasses import dataclass, replace
from enum import StrEnum
from functools import partial

import numpy as np

from seatrial.core.values import Array
from seatrial.numerics.optimise import FitnessMemory, ImprovedHerdSettings, ImprovedWildHorse
from seatrial_studies.published_ship import HEADINGS
from seatrial_studies.qi2025.published import SearchAlgorithm
from seatrial_studies.qi2025.reproduction import ITERATIONS, SearchSetting, WildHorseReproduction, repeat_in_setting

# the chosen setting, and the fairest other one: whole record, truth off centre
ABLATION_SETTINGS = (SearchSetting.PAPER, SearchSetting.WHOLE_OFF_CENTRE)
# relative error below which a value is the truth itself, which is the middle of the box; our choice
_AT_CENTRE = 1e-9


class HerdVariant(StrEnum):
    """IWHO with something left out."""

    NO_FLUCTUATION = "without random fluctuation (eq. 21)"
    NO_INERTIA = "without dynamic inertia weight (eqs. 22, 23)"
    NO_COMPETITION = "without competition for the waterhole (eq. 24)"
    NO_ADDITION = "without all three, as WHO"
    NO_MATING = "without mating (eq. 18)"


@dataclass(frozen=True, eq=False)
class Ablation:
    """Relative errors (runs, 8) by setting, variant and heading, in the same seas and boxes; None: IWHO itself."""

    errors: dict[tuple[SearchSetting, HerdVariant | None, int], Array]

    def run_errors(self, setting: SearchSetting, variant: HerdVariant | None) -> Array:
        """Return the mean error of each run at all headings, (3 runs,)."""
        return np.concatenate([np.mean(np.abs(self.errors[setting, variant, h]), axis=1) for h in HEADINGS])

    def mean_errors(self, setting: SearchSetting, variant: HerdVariant | None) -> list[float]:
        """Return the mean error of single runs at each heading, per cent."""
        return [100.0 * float(np.mean(np.abs(self.errors[setting, variant, h]))) for h in HEADINGS]

    def share_at_centre(self, setting: SearchSetting, variant: HerdVariant | None) -> float:
        """Return the share of all values that are the truth itself."""
        return float(np.mean([np.abs(self.errors[setting, variant, h]) < _AT_CENTRE for h in HEADINGS]))


def ablation(reproduction: WildHorseReproduction, seed: int, runs: int) -> Ablation:
    """Return the errors of all variants, so many runs at each heading."""
    errors: dict[tuple[SearchSetting, HerdVariant | None, int], Array] = {}
    for setting in ABLATION_SETTINGS:
        for h in HEADINGS:
            errors[setting, None, h] = reproduction.searches[setting, h, SearchAlgorithm.IWHO].errors[:runs]
            for variant in HerdVariant:
                make = partial(ImprovedWildHorse, settings=herd_settings(variant))
                found = repeat_in_setting(setting, reproduction.seas[h][:runs], make, seed)
                errors[setting, variant, h] = found.errors
    return Ablation(errors)


def herd_settings(variant: HerdVariant) -> ImprovedHerdSettings:
    """Return IWHO's settings with something left out; a waterhole of weight 1 makes eq. (23) the first of eq. (19)."""
    whole = ImprovedHerdSettings(iterations=ITERATIONS, memory=FitnessMemory.RE_EVALUATE)
    still = replace(whole, scatter=0.0)
    unweighted = replace(whole, omega_min=1.0, omega_max=1.0)
    return {
        HerdVariant.NO_FLUCTUATION: still,
        HerdVariant.NO_INERTIA: unweighted,
        HerdVariant.NO_COMPETITION: replace(whole, has_competition=False),
        HerdVariant.NO_ADDITION: replace(unweighted, scatter=0.0, has_competition=False),
        HerdVariant.NO_MATING: replace(whole, crossover=0.0),
    }[variant]
