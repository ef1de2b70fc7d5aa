"""The papers' problems and measured trials as benchmark problems: drawn by a seed, with bounds, noise and truth."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from functools import cache, partial

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Record, RecordKind
from seatrial.data.trial import Run, Trial, TrialRecord, checked_records
from seatrial.estimation.predict import HoldoutProtocol
from seatrial.estimation.problem import LinearOutputError
from seatrial.estimation.search import JudgedRun, LinearCandidates
from seatrial.numerics.optimise import Box, DifferentialEvolution, EvolutionSettings, search
from seatrial.physics.loops import Preamplifier
from seatrial.physics.models import HEAVE_PITCH_STIFFNESSES
from seatrial.problems import (
    BenchmarkProblem,
    KnownOptimum,
    KnownTruth,
    PaperClaim,
    Placement,
    ProblemDraw,
    centred_box,
    fold_draw,
    off_centre_box,
    standard_errors_within,
    start_within,
)
from seatrial_studies.heave_pitch_search import (
    HEAVE_AND_PITCH,
    MOTION_NOISE,
    NARROW_HALF_WIDTH,
    STEP,
    WAVE_FORCE_INPUTS,
    WIDE_HALF_WIDTH,
    SearchData,
    held_force_ship,
    output_error_problem,
    simulate_search_data,
)
from seatrial_studies.meng2014.reproduction import SEA_STATE_3
from seatrial_studies.meng2014.reproduction import SOURCE as MENG2014_SOURCE
from seatrial_studies.packaged_trials import packaged_trial
from seatrial_studies.qi2025.published import SOURCE as QI2025_SOURCE
from seatrial_studies.qi2025.reproduction import ITERATIONS
from seatrial_studies.seaway import HEADINGS, SHIP, SIGNIFICANT_HEIGHT
from seatrial_studies.yu2014.published import PREAMPLIFIER_LABELS
from seatrial_studies.yu2014.published import SOURCE as YU2014_SOURCE
from seatrial_studies.yu2014.searches import BOX, MS_LIMIT, five_gain_box, five_gain_cost, three_gain_cost

# Measured trials, a session left out: a model ship, a pond of sessions in wind, and a small craft with thrusters.

# evaluations, each a simulation of all training runs; chosen
_BUDGET = 500
_NOISE = "measured; the true coefficients are not known"


def kvlcc2_problems() -> tuple[BenchmarkProblem, ...]:
    """Return the folds of KVLCC2 in zigzags, run by run.

    Raises:
        InputError: the records are not here.
    """
    words = "KVLCC2, model of 7 m: MMG coefficients, one zigzag left out"
    source = "SIMMAN 2008 workshop, HSVA"
    return (_left_out_problem("kvlcc2-folds", "kvlcc2_hsva.toml", words, source, HoldoutProtocol(30.0, 6.0)),)


def esso_osaka_problems() -> tuple[BenchmarkProblem, ...]:
    """Return the folds of the Esso Osaka model in wind, day by day.

    Raises:
        InputError: as `kvlcc2_problems`.
    """
    words = "Esso Osaka, model of 3 m in wind: MMG coefficients, one day left out"
    source = "Wakita et al. 2022, doi 10.1007/s00773-021-00867-1"
    return (_left_out_problem("esso-folds", "esso_osaka.toml", words, source, HoldoutProtocol(50.0, 5.0)),)


def blueboat_problems() -> tuple[BenchmarkProblem, ...]:
    """Return the folds of the BlueBoat, run by run.

    Raises:
        InputError: as `kvlcc2_problems`.
    """
    words = "BlueBoat, 1.2 m, two thrusters: one run left out"
    source = "github jankristia/BlueBoatSystemIdentification"
    return (_left_out_problem("blueboat-folds", "blueboat.toml", words, source, HoldoutProtocol(10.0, 1.0)),)


def _left_out_problem(name: str, file: str, title: str, source: str, protocol: HoldoutProtocol) -> BenchmarkProblem:
    packaged_trial(file)
    return BenchmarkProblem(name, 1, title, source, _NOISE, _BUDGET, partial(_draw, file, protocol))


def _draw(file: str, protocol: HoldoutProtocol, rng: np.random.Generator, _: Placement) -> ProblemDraw:
    return fold_draw(*_records(file), protocol, rng)


@cache
def _records(file: str) -> tuple[Trial, tuple[TrialRecord, ...]]:
    """The trial and its records at the rate of its estimate, read once."""
    trial = packaged_trial(file)
    return trial, checked_records(trial).records


# Heave and pitch in a known sea: a ship near the published one, its record, and what a search makes small.

_COEFFICIENT_SCALE = 0.1
"""Half range of the factor by which a draw scales each true coefficient, 1; chosen, the ship stays a ship."""
_NO_LOCAL = np.zeros((0, 0))
_VERSION = 2
"""Of the problems: since 2 the trial states the box as bounds, and the bound counts the box."""
NOISE_TEXT = "heave 0.01 m, pitch 0.02 deg, white"


class Judged(Enum):
    """What an iteration judges candidates by."""

    ONE_SAMPLE = "one sample, each candidate from the true state before it (Qi et al. 2025, eq. 28)"
    WHOLE_RECORD = "the whole record from rest (Qi et al. 2025, eq. 27), channels weighted by their noise"


@dataclass(frozen=True)
class HeavePitchSetting:
    """One setting of the papers' problem.

    Attributes:
        heading: degrees to the waves, 180 head sea; height: significant, m.
        half_width: of the box, as a share of the truth; is_centred: whether the paper has the truth in its middle.
        has_fin: whether a fin moves as well; stiffnesses: whether the four of them are unknown, too.
    """

    heading: int
    height: float
    half_width: float
    is_centred: bool
    judged: Judged
    has_noise: bool
    has_fin: bool = False
    stiffnesses: bool = False

    def draw(self, rng: np.random.Generator, placement: Placement) -> ProblemDraw:
        """Return a draw: sea, noise, and with `Placement.SHIFTED` truth and box."""
        ship = held_force_ship(self.heading)
        if self.stiffnesses:
            ship = ship.with_parameters(ship.parameters.freed(*HEAVE_PITCH_STIFFNESSES))
        names = ship.parameters.free_names
        truth = np.array([ship.parameters[name].value for name in names])
        if placement is Placement.SHIFTED:
            truth = truth * rng.uniform(1.0 - _COEFFICIENT_SCALE, 1.0 + _COEFFICIENT_SCALE, len(truth))
            ship = ship.with_values(dict(zip(names, truth.tolist(), strict=True)))
        is_centred = self.is_centred and placement is Placement.PUBLISHED
        box = centred_box(truth, self.half_width) if is_centred else off_centre_box(truth, self.half_width, rng)
        data = simulate_search_data(
            self.heading, rng, height=self.height, has_fin=self.has_fin,
            noise=(MOTION_NOISE[0], MOTION_NOISE[1]) if self.has_noise else (0.0, 0.0), ship=ship,
        )  # fmt: skip
        problem = output_error_problem(data, data.measured)
        bound = standard_errors_within(problem.normal(truth, _NO_LOCAL).hessian, box) if self.has_noise else None
        start = self._start(problem, box)
        return ProblemDraw(
            names, tuple(ship.parameters[name].unit for name in names), box, self._fitness(data, names),
            KnownTruth(truth, bound), start, problem, _trial(data, problem.model, start, box, self.has_noise),
        )  # fmt: skip

    @property
    def noise_text(self) -> str:
        """Noise of the record, in words."""
        return NOISE_TEXT if self.has_noise else "none, as in the paper"

    def _fitness(self, data: SearchData, names: tuple[str, ...]) -> Callable[[Array, int], Array]:
        is_sample = self.judged is Judged.ONE_SAMPLE
        run = JudgedRun(data.forcing, data.states[0], data.measured, data.states if is_sample else None)
        sigma = np.array([1.0, 1.0]) if is_sample else MOTION_NOISE  # metres and radians, as Qi et al. 2025 add them
        candidates = LinearCandidates(data.model, names, WAVE_FORCE_INPUTS, (run,), HEAVE_AND_PITCH, sigma)

        def fitness(points: Array, iteration: int) -> Array:
            if not is_sample:
                return candidates.record_rms(points)
            step = min(iteration, candidates.step_count - 1)
            state = candidates.given_state(step)
            assert state is not None
            return candidates.step_rms(points, step, state)

        return fitness

    def _start(self, problem: LinearOutputError, box: Box) -> Array:
        """Values from physics; of stiffnesses the middle of the box."""
        start = problem.start()
        if self.stiffnesses:
            is_stiffness = np.isin(problem.model.parameters.free_names, list(HEAVE_PITCH_STIFFNESSES))
            start = np.where(is_stiffness, 0.5 * (box.lower + box.upper), start)
        return start


def _trial(data: SearchData, model: Model, start: Array, box: Box, has_noise: bool) -> Trial:
    """Records and model as `identify` takes them; forces positive up, and bow down, as records have them."""
    time = np.arange(len(data.measured), dtype=np.float64) * STEP
    channels = {
        "F3": -data.forces[:, 0], "M5": -data.forces[:, 1], "z": data.measured[:, 0], "theta": data.measured[:, 1],
    }  # fmt: skip
    record = Record.from_arrays("run", time, channels, RecordKind.SIMULATED)
    noise = {"z": float(MOTION_NOISE[0]), "theta": float(MOTION_NOISE[1])} if has_noise else {}
    return Trial(SHIP, (Run(record),), start_within(model, model.parameters.free_names, start, box), noise=noise)


def heave_pitch_problem(
    name: str, title: str, source: str, budget: int, setting: HeavePitchSetting, claims: tuple[PaperClaim, ...]
) -> BenchmarkProblem:  # fmt: skip
    """Return the benchmark problem of a setting."""
    is_changing = setting.judged is Judged.ONE_SAMPLE
    return BenchmarkProblem(
        name, _VERSION, title, source, setting.noise_text, budget, setting.draw, is_changing, claims
    )


# Meng et al. 2014: eight coefficients, or twelve with the stiffnesses, in sea state 3 under waves and a fin.

# degrees: of the paper's headings the one at which neither motion is small; chosen
_HEADING = 135
# candidates: the paper's swarm of 60 particles in 200 iterations; more change nothing that noise does not decide
_CLOUD_SWARM_BUDGET = 60 * 200


def meng2014_problems() -> tuple[BenchmarkProblem, ...]:
    """Return the problem with eight and with twelve unknowns."""
    return tuple(
        heave_pitch_problem(
            f"meng2014-{count}", f"heave and pitch at {_HEADING}°, {count} unknowns, box ±50 % off centre",
            MENG2014_SOURCE, _CLOUD_SWARM_BUDGET,
            HeavePitchSetting(
                _HEADING, SEA_STATE_3, WIDE_HALF_WIDTH, False, Judged.WHOLE_RECORD, has_noise=True, has_fin=True,
                stiffnesses=has_stiffnesses,
            ),
            (PaperClaim("the cloud improves the accuracy of the swarm", "icpso", "pso"),),
        )
        for count, has_stiffnesses in ((8, False), (12, True))
    )  # fmt: skip


# Qi et al. 2025: eight coefficients at three headings, by one sample an iteration or by the whole record.

# candidates of the paper's searches: a population of 40 in 200 iterations
_WILD_HORSE_BUDGET = 40 * ITERATIONS
_CLAIMS = (
    PaperClaim("IWHO is far more accurate than WHO", "iwho", "who"),
    PaperClaim("PSO is far less accurate than IWHO", "iwho", "pso"),
    PaperClaim("PSO is less accurate than WHO", "who", "pso"),
)


def qi2025_problems() -> tuple[BenchmarkProblem, ...]:
    """Return three settings at each heading of the tables."""
    return tuple(problem for heading in HEADINGS for problem in _settings(heading))


def _settings(heading: int) -> tuple[BenchmarkProblem, ...]:
    settings = {
        "paper": (NARROW_HALF_WIDTH, True, Judged.ONE_SAMPLE, "box ±10 %, one sample an iteration"),
        "off-centre": (WIDE_HALF_WIDTH, False, Judged.ONE_SAMPLE, "box ±50 % off centre, one sample an iteration"),
        "whole": (WIDE_HALF_WIDTH, False, Judged.WHOLE_RECORD, "box ±50 % off centre, whole record with noise"),
    }
    return tuple(
        heave_pitch_problem(
            f"qi2025-{heading}-{name}", f"heave and pitch at {heading}°, {words}", QI2025_SOURCE, _WILD_HORSE_BUDGET,
            HeavePitchSetting(
                heading, SIGNIFICANT_HEIGHT, width, is_centred, judged, has_noise=judged is Judged.WHOLE_RECORD
            ),
            _CLAIMS,
        )
        for name, (width, is_centred, judged, words) in settings.items()
    )  # fmt: skip


# Yu et al. 2014: three and five gains of a fin stabiliser, with both readings of its preamplifier.

# evaluations of the paper's genetic algorithm: 50 individuals in 200 generations
_GENETIC_BUDGET = 10_000
# factor by which a draw scales each gain, between its inverse and itself; chosen
_GAIN_SCALE = 1.4
# the search for the least objective: populations, their size, and how often it is repeated; far beyond the budget
_LONG_SEARCH, _SEARCHES = EvolutionSettings(population=60, iterations=800), 3

_GAIN_NAMES = ("KP", "KI", "KD", "KB", "KL")


def yu2014_problems() -> tuple[BenchmarkProblem, ...]:
    """Return three and five gains, each with both preamplifiers."""
    return tuple(_gain_problem(count, reading) for count in (3, 5) for reading in Preamplifier)


def _gain_problem(count: int, reading: Preamplifier) -> BenchmarkProblem:
    label = PREAMPLIFIER_LABELS[reading]
    words = {3: "worst of three objectives over the paper's", 5: "roll variance at the paper's fin rate, two seas"}

    def draw(rng: np.random.Generator, placement: Placement) -> ProblemDraw:
        is_shifted = placement is Placement.SHIFTED
        factors = _GAIN_SCALE ** rng.uniform(-1.0, 1.0, count) if is_shifted else np.ones(count)
        return scaled_gains(_box(count, reading), _cost(count, reading), _least(count, reading), factors)

    return BenchmarkProblem(
        f"yu2014-{count}-{reading.name.lower()}", 1,
        f"{count} gains of a fin stabiliser, preamplifier {label}: {words[count]}, Ms at most {MS_LIMIT:g}",
        YU2014_SOURCE, "none: variances by spectra", _GENETIC_BUDGET, draw,
    )  # fmt: skip


def scaled_gains(box: Box, cost: Callable[[Array], Array], least: float, factors: Array) -> ProblemDraw:
    """Return a draw in which each gain is a factor times the loop's; gains beyond the loop's bounds cost infinity.

    The bounds of the search stay the same for every draw, so that the optimum moves in them.
    """
    ends = np.stack([box.lower, box.upper])
    reach = np.concatenate([ends * _GAIN_SCALE, ends / _GAIN_SCALE])

    def fitness(points: Array, _: int = 0) -> Array:
        gains = points / factors
        is_inside = np.all((gains >= box.lower) & (gains <= box.upper), axis=1)
        values = np.full(len(points), np.inf)
        values[is_inside] = cost(gains[is_inside])
        return values

    names = _GAIN_NAMES[: box.size]
    searched = Box(reach.min(axis=0), reach.max(axis=0))
    return ProblemDraw(names, ("1",) * box.size, searched, fitness, KnownOptimum(fitness, least))


def _box(count: int, reading: Preamplifier) -> Box:
    return BOX if count == BOX.size else five_gain_box(reading)


@cache
def _cost(count: int, reading: Preamplifier) -> Callable[[Array], Array]:
    return three_gain_cost(reading, MS_LIMIT) if count == BOX.size else five_gain_cost(reading, 1.0)


@cache
def _least(count: int, reading: Preamplifier) -> float:
    """The least objective, the best of long searches; the same bits in every process."""
    box, cost = _box(count, reading), _cost(count, reading)
    searches = (DifferentialEvolution(box, np.random.default_rng([2014, k]), _LONG_SEARCH) for k in range(_SEARCHES))
    return min(search(method, cost).value for method in searches)
