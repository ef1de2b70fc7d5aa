"""The paper's searches made again, and what each addition of IWHO to WHO is worth in them."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum, StrEnum
from functools import cached_property, partial

import numpy as np

from seatrial.core.values import Array, ProgressReporter
from seatrial.estimation.search import Fitness, one_sample_fitness
from seatrial.numerics.optimise import (
    Box,
    FitnessMemory,
    HerdSettings,
    ImprovedHerdSettings,
    ImprovedWildHorse,
    ParticleSwarm,
    Population,
    StrideVariant,
    SwarmSettings,
    WildHorse,
)
from seatrial.problems import centred_box, off_centre_box
from seatrial_studies.heave_pitch_search import (
    NARROW_HALF_WIDTH,
    WIDE_HALF_WIDTH,
    PitchUnit,
    RepeatedSearches,
    SearchData,
    candidates_for,
    one_sample_objective,
    repeat_searches,
    simulate_search_data,
    whole_record_objective,
)
from seatrial_studies.qi2025.published import SearchAlgorithm
from seatrial_studies.seaway import HEADINGS
from seatrial_studies.study_file import study_setting

# What the mean of ten runs is worth: the paper's ten against tens drawn from many runs of the same search.

FEWER_RUNS = study_setting("qi2025", "runs", int)
RUNS, ITERATIONS = FEWER_RUNS.value, study_setting("qi2025", "iterations", int).value
FAMILY_PROBABILITY = study_setting("qi2025", "family_probability", float).value
BOOTSTRAP_TENS = study_setting("qi2025", "drawn_tens", int).value


@dataclass(frozen=True, eq=False)
class TenRuns:
    """Relative errors of many runs at one heading, (runs, 8), the first ten those of the tables; a seed for draws."""

    errors: Array
    seed: int

    @property
    def tens(self) -> Array:
        """Return the mean absolute error of the mean of each ten runs, one ten after another, (runs / 10,)."""
        means = self.errors.reshape(-1, RUNS, self.errors.shape[1]).mean(axis=1)
        return np.mean(np.abs(means), axis=1)

    @cached_property
    def drawn_tens(self) -> Array:
        """Return the same of tens drawn with replacement from all runs, (BOOTSTRAP_TENS,)."""
        picks = np.random.default_rng([self.seed, 29]).integers(len(self.errors), size=(BOOTSTRAP_TENS, RUNS))
        return np.mean(np.abs(self.errors[picks].mean(axis=1)), axis=1)

    def probability_below(self, error: float) -> float:
        """Return the share of drawn tens whose error is at most this one."""
        return float(np.mean(self.drawn_tens <= error))

    def limit_on_median(self, printed: float, headings: int) -> float:
        """Return the largest median of tens with which a printed ten is still likely.

        A ten lies below the quantile q of its own distribution with probability FAMILY_PROBABILITY / headings
        (Bonferroni); the printed error is no such rarity as long as median / printed <= median / quantile.
        """
        drawn = self.drawn_tens
        return float(printed * np.median(drawn) / np.quantile(drawn, FAMILY_PROBABILITY / headings))


# Eq. (28) from the identified model's own state: what figures 5 to 7 suggest, where the state lags the ship's.


def model_state_objective(
    data: SearchData, optimiser: Population, pitch_unit: PitchUnit = PitchUnit.DEGREES
) -> Fitness:
    """Iteration k compares sample k alone, one step from where the best points so far have carried the model.

    Each sample is left with the best point of its own iteration, as a model that is identified while it runs; the truth
    itself then has no fitness of 0.
    """
    return one_sample_fitness(candidates_for(data, pitch_unit), optimiser)


# The paper's searches made again: the setting nearest to its IWHO, the same off centre, and the whole record.

REPEATS, PART_RUNS = study_setting("qi2025", "repeats", int), study_setting("qi2025", "part_runs", int)
# the heading of the paper's figures, whose coefficients it does not print
FIGURE_HEADING = 45


class SearchSetting(Enum):
    """What is searched: box, fitness, unit of pitch, and whether remembered points are judged again."""

    PAPER = "±10 % about the truth, one sample an iteration, pitch in rad"
    DEGREES = "±10 %, one sample, pitch in degrees"
    MODEL_STATE = "±10 %, one sample from the identified model's own state, pitch in degrees"
    MODEL_STATE_RADIANS = "±10 %, one sample from the identified model's own state, pitch in rad"
    REFERENCE = "±10 %, one sample, pitch in rad, strides as in the program of WHO's authors"
    REMEMBERED = "±10 %, one sample, pitch in rad, remembered fitness never renewed"
    OFF_CENTRE = "±50 %, truth off centre, one sample an iteration, pitch in rad"
    WHOLE = "±10 % about the truth, whole record, pitch in degrees"
    WHOLE_OFF_CENTRE = "±50 %, truth off centre, whole record, pitch in degrees"


# what the claims rest on
CLAIM_SETTINGS = (
    SearchSetting.PAPER,
    SearchSetting.DEGREES,
    SearchSetting.MODEL_STATE,
    SearchSetting.OFF_CENTRE,
    SearchSetting.WHOLE_OFF_CENTRE,
)
# as often as the paper also when quick: their means of ten stand beside the print
TEN_RUN_SETTINGS = (SearchSetting.PAPER, SearchSetting.MODEL_STATE)
FIGURE_SETTINGS = (SearchSetting.PAPER, SearchSetting.DEGREES, SearchSetting.MODEL_STATE, SearchSetting.REMEMBERED)
OptimiserFactory = Callable[[Box, np.random.Generator], Population]


def optimisers(
    iterations: int, memory: FitnessMemory, variant: StrideVariant = StrideVariant.PAPER
) -> dict[SearchAlgorithm, OptimiserFactory]:
    """Return the paper's three algorithms; PSO's omega, c1, c2 are not printed, ours are the constriction's."""
    plain = HerdSettings(iterations=iterations, memory=memory, variant=variant)
    improved = ImprovedHerdSettings(iterations=iterations, memory=memory, variant=variant)
    return {
        SearchAlgorithm.PSO: partial(ParticleSwarm, settings=SwarmSettings(iterations=iterations, memory=memory)),
        SearchAlgorithm.WHO: partial(WildHorse, settings=plain),
        SearchAlgorithm.IWHO: partial(ImprovedWildHorse, settings=improved),
    }


@dataclass(frozen=True, eq=False)
class WildHorseReproduction:
    """Searches by setting, heading and algorithm, and the seas they met, by heading.

    At 45 degrees the settings of the figures with the coefficients of 90 degrees, assumed: all runs in the paper's
    setting, else one.
    `ten_runs`: by heading, IWHO's runs in the paper's setting, the ten of the tables and as many tens more.
    """

    searches: dict[tuple[SearchSetting, int, SearchAlgorithm], RepeatedSearches]
    seas: dict[int, list[SearchData]]
    ten_runs: dict[int, TenRuns]
    run_count: int
    is_quick: bool

    @property
    def settings(self) -> tuple[SearchSetting, ...]:
        """Those searched at the headings of the tables."""
        return tuple(s for s in SearchSetting if (s, HEADINGS[0], SearchAlgorithm.IWHO) in self.searches)


def reproduce_searches(*, quick: bool, seed: int, report_progress: ProgressReporter | None) -> WildHorseReproduction:
    """Ten runs of every setting; `quick` leaves out those that no claim rests on and runs others five times."""
    if report_progress:
        report_progress("seas")
    headings = (*HEADINGS, FIGURE_HEADING)
    seas = {
        h: [simulate_search_data(h, np.random.default_rng([seed, h, run])) for run in range(RUNS)] for h in headings
    }
    found = {}
    for setting in SearchSetting:
        met = (
            *(HEADINGS if setting in CLAIM_SETTINGS or not quick else ()),
            *((FIGURE_HEADING,) if setting in FIGURE_SETTINGS else ()),
        )
        if report_progress and met:
            report_progress(f"searches: {setting.value}")
        for heading in met:
            found |= _search_setting(setting, heading, seas[heading][: _run_count(setting, heading, quick)], seed)
    if report_progress:
        report_progress("the ten runs again")
    repeats = REPEATS.in_version(quick=quick)
    again = {
        h: _repeat_ten_runs(h, found[SearchSetting.PAPER, h, SearchAlgorithm.IWHO], repeats, seed) for h in HEADINGS
    }
    return WildHorseReproduction(found, seas, again, RUNS, quick)


def _run_count(setting: SearchSetting, heading: int, quick: bool) -> int:
    """Runs of a setting; at the heading of the figures one, but as many as elsewhere in the paper's setting."""
    if setting is SearchSetting.PAPER:
        return RUNS
    if heading == FIGURE_HEADING:
        return 1
    return FEWER_RUNS.in_version(quick=quick and setting not in TEN_RUN_SETTINGS)


def _repeat_ten_runs(heading: int, first_ten: RepeatedSearches, count: int, seed: int) -> TenRuns:
    """Ten runs as often as `count` says; the first ten are those of the tables."""
    runs = range(RUNS, count * RUNS)
    seas = [simulate_search_data(heading, np.random.default_rng([seed, heading, run])) for run in runs]
    make = optimisers(ITERATIONS, FitnessMemory.RE_EVALUATE)[SearchAlgorithm.IWHO]
    more = repeat_in_setting(SearchSetting.PAPER, seas, make, seed, RUNS)
    return TenRuns(np.concatenate([first_ten.errors, more.errors]), seed)


def _search_setting(
    setting: SearchSetting,
    heading: int,
    seas: list[SearchData],
    seed: int,
) -> dict[tuple[SearchSetting, int, SearchAlgorithm], RepeatedSearches]:
    memory = FitnessMemory.KEEP if setting is SearchSetting.REMEMBERED else FitnessMemory.RE_EVALUATE
    variant = StrideVariant.REFERENCE if setting is SearchSetting.REFERENCE else StrideVariant.PAPER
    return {
        (setting, heading, algorithm): repeat_in_setting(setting, seas, make, seed)
        for algorithm, make in optimisers(ITERATIONS, memory, variant).items()
    }


def repeat_in_setting(
    setting: SearchSetting, seas: list[SearchData], make: OptimiserFactory, seed: int, first_run: int = 0
) -> RepeatedSearches:
    """Return one run in each sea, in the setting's box and by its fitness."""
    return repeat_searches(seas, _boxes(setting, seas, seed), make, partial(_objective, setting), seed, first_run)


def _boxes(setting: SearchSetting, seas: list[SearchData], seed: int) -> list[Box]:
    truth = seas[0].truth
    if setting in (SearchSetting.OFF_CENTRE, SearchSetting.WHOLE_OFF_CENTRE):
        return [
            off_centre_box(truth, WIDE_HALF_WIDTH, np.random.default_rng([seed, 7, run])) for run in range(len(seas))
        ]
    return [centred_box(truth, NARROW_HALF_WIDTH)] * len(seas)


def _objective(setting: SearchSetting, data: SearchData, optimiser: Population) -> Fitness:
    if setting in (SearchSetting.WHOLE, SearchSetting.WHOLE_OFF_CENTRE):
        return whole_record_objective(data, PitchUnit.DEGREES)
    if setting in (SearchSetting.MODEL_STATE, SearchSetting.MODEL_STATE_RADIANS):
        return model_state_objective(
            data, optimiser, PitchUnit.DEGREES if setting is SearchSetting.MODEL_STATE else PitchUnit.RADIANS
        )
    return one_sample_objective(
        data, optimiser, PitchUnit.DEGREES if setting is SearchSetting.DEGREES else PitchUnit.RADIANS
    )


# What each addition of IWHO to WHO is worth: the search with one of them left out, in the same seas and boxes.

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
        HerdVariant.NO_MATING: replace(whole, P_C=0.0),
    }[variant]
