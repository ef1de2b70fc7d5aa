"""Everything the verdicts rest on beside the searches: biases, tracking, controllers."""

from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.problem import OutputError, cut_segments
from seatrial.numerics.optimise import Box, FitnessMemory, levenberg_marquardt, search
from seatrial.physics.models import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models import heave_pitch_zoh
from seatrial.problems import centred_box
from seatrial_studies.controller_cost import ControllerCost, pitch_controller_costs
from seatrial_studies.heave_pitch_search import (
    MOTION_NOISE,
    NARROW_HALF_WIDTH,
    SAMPLES,
    OutputErrorResults,
    PitchUnit,
    SearchData,
    candidates_for,
    is_smaller,
    one_sample_objective,
    with_physics_start,
)
from seatrial_studies.qi2025.published import (
    SATURATED_RANGE,
    SearchAlgorithm,
    WildHorseAudit,
    printed_error,
    printed_estimate,
    true_values,
)
from seatrial_studies.qi2025.reproduction import (
    FIGURE_HEADING,
    ITERATIONS,
    Ablation,
    SearchSetting,
    WildHorseReproduction,
    optimisers,
)
from seatrial_studies.seaway import HEADINGS, SIGNIFICANT_HEIGHT, SeawayScenario, ship, simulate_seaway_run
from seatrial_studies.study_file import study_setting

# What a search owes to the middle of its box: unknowns written as shares of their range, zero at the truth or not.

CENTRE_RUNS = study_setting("qi2025", "centre_runs", int).value
OFF_CENTRE_SHIFT = study_setting("qi2025", "off_centre_shift", float).value


@dataclass(frozen=True, eq=False)
class CentreBias:
    """Mean relative errors over headings, runs and coefficients, the truth at zero and a quarter of the box aside."""

    truth_at_centre: dict[SearchAlgorithm, float]
    truth_off_centre: dict[SearchAlgorithm, float]


def centre_bias(seas: dict[int, list[SearchData]], seed: int) -> CentreBias:
    """The paper's setting with unknowns x = (value / truth - 1) / 0.1 - x0 in [-1, 1]: x0 = 0, or +-0.5 drawn for each.

    The fitness is the paper's; nothing but the place of the truth in the box differs.
    """
    met = [(h, run, seas[h][run]) for h in HEADINGS for run in range(CENTRE_RUNS)]
    at_zero, aside = (
        {
            a: float(np.mean([_mean_error(data, a, shift, [seed, 17, h, run]) for h, run, data in met]))
            for a in SearchAlgorithm
        }
        for shift in (0.0, OFF_CENTRE_SHIFT)
    )
    return CentreBias(at_zero, aside)


def _mean_error(data: SearchData, algorithm: SearchAlgorithm, shift: float, seed: list[int]) -> float:
    rng = np.random.default_rng(seed)
    middle = shift * rng.choice([-1.0, 1.0], len(data.truth))
    unit = Box(-np.ones(len(data.truth)), np.ones(len(data.truth)))
    optimiser = optimisers(ITERATIONS, FitnessMemory.RE_EVALUATE)[algorithm](unit, rng)
    judged = one_sample_objective(data, optimiser, PitchUnit.RADIANS)
    found = search(optimiser, lambda x: judged(data.truth * (1.0 + NARROW_HALF_WIDTH * (x - middle))))
    return float(np.mean(np.abs(NARROW_HALF_WIDTH * (found.point - middle))))


# What holding the wave force between samples costs: data from continuous waves, fitted with the hold and without.

CONTINUOUS_WAVES = SeawayScenario(135, dt=0.1, motion_stride=5, has_fin=False, noise=(0.0, 0.0))


@dataclass(frozen=True, eq=False)
class HoldBias:
    """Relative errors (8,) without any noise, motions every 0.5 s, by what the model takes the wave force for.

    Attributes:
        held: constant from sample to sample; sampled: continuous, known every 0.5 s; fine: continuous, every 0.1 s.
    """

    held: Array
    sampled: Array
    fine: Array


def hold_bias(seed: int) -> dict[int, HoldBias]:
    """By heading, from waves that are continuous."""
    made = {}
    for heading in HEADINGS:
        voyage = replace(CONTINUOUS_WAVES, heading=heading)
        record = simulate_seaway_run(voyage, np.random.default_rng([seed, 13, heading])).record
        truth = ship(heading)
        true = np.array([truth.parameters[n].value for n in COEFFICIENTS])
        coarse = record.rows(slice(None, None, voyage.motion_stride))
        held = heave_pitch_zoh().with_parameters(truth.parameters)
        errors = []
        for model, used in ((held, coarse), (truth, coarse), (truth, record)):
            problem = OutputError(
                with_physics_start(model), cut_segments(model, [used], ("z", "theta"), None), MOTION_NOISE
            )
            found = levenberg_marquardt(problem, problem.start(), problem.measured_initial_states())
            errors.append(found.solution.point / true - 1.0)
        made[heading] = HoldBias(*errors)
    return made


# Figures 6 and 7: models that are carried on while their coefficients are identified, and one left at a guess.

GUESSES = study_setting("qi2025", "guesses", int).value
_MOTIONS = [0, 2]


@dataclass(frozen=True, eq=False)
class Tracking:
    """Motions of the identified models, and their errors.

    Attributes:
        states: of IWHO's first run at 45 degrees, carried by the best point of each iteration, then by the last,
            (samples, 4).
        errors: rms error of heave and pitch of each run over the rms of the motion, (runs, 2), by heading and
            algorithm.
        guess_errors: at 45 degrees, of coefficients drawn once from the box and kept, mean over the guesses, (2,).
        lag_gain: rms error of heave and pitch over that against the motion one sample earlier, (2,): above 1 where
            the model lags a sample, as the paper says of its own.
    """

    states: Array
    errors: dict[tuple[int, SearchAlgorithm], Array]
    guess_errors: Array
    lag_gain: Array

    def median_error(self, heading: int, algorithm: SearchAlgorithm) -> Array:
        """Return the median over the runs, heave and pitch, (2,)."""
        return np.median(self.errors[heading, algorithm], axis=0)

    def is_most_accurate(self, headings: tuple[int, ...]) -> bool:
        """Return whether IWHO tracks heave and pitch more accurately than both others, by a sign test over the runs."""
        best, *others = (
            np.concatenate([self.errors[h, a] for h in headings])
            for a in (SearchAlgorithm.IWHO, SearchAlgorithm.WHO, SearchAlgorithm.PSO)
        )
        return all(is_smaller(best[:, j], other[:, j]) for other in others for j in range(len(_MOTIONS)))


def track(reproduction: WildHorseReproduction, seed: int) -> Tracking:
    """Return all runs in the paper's setting, and guesses that are never corrected."""
    errors = {}
    for heading in (FIGURE_HEADING, *HEADINGS):
        for a in SearchAlgorithm:
            traces = reproduction.searches[SearchSetting.PAPER, heading, a].traces
            pairs = zip(reproduction.seas[heading], traces, strict=True)
            errors[heading, a] = np.array([relative_error(d, tracked_states(d, trace)) for d, trace in pairs])
    data = reproduction.seas[FIGURE_HEADING][0]
    states = tracked_states(
        data, reproduction.searches[SearchSetting.PAPER, FIGURE_HEADING, SearchAlgorithm.IWHO].trace
    )
    guesses = centred_box(data.truth, NARROW_HALF_WIDTH).random_points(np.random.default_rng([seed, 31]), GUESSES)
    guessed = [relative_error(data, tracked_states(data, guess[None])) for guess in guesses]
    iwho, ship = states[:, _MOTIONS], data.states[:, _MOTIONS]
    lag_gain = _rms(iwho[1:] - ship[1:]) / _rms(iwho[1:] - ship[:-1])
    return Tracking(states, errors, np.mean(guessed, axis=0), lag_gain)


def tracked_states(data: SearchData, trace: Array) -> Array:
    """Return the states (samples, 4) from rest, step k with the point (8,) of iteration k, later with the last."""
    candidates = candidates_for(data)
    states = [data.states[0]]
    for step in range(len(data.states) - 1):
        point = trace[min(step, len(trace) - 1)]
        states.append(candidates.advanced_state(point, step, states[-1]))
    return np.array(states)


def relative_error(data: SearchData, states: Array) -> Array:
    """Return the rms error of heave and pitch over the rms of the ship's motion, (2,)."""
    ship = data.states[:, _MOTIONS]
    return _rms(states[:, _MOTIONS] - ship) / _rms(ship)


def _rms(values: Array) -> Array:
    return np.sqrt(np.mean(values**2, axis=0))


# Controllers tuned on the coefficients that the paper prints, on ours, and on those of the searches repeated here.


def controllers(
    reproduction: WildHorseReproduction, output_error: dict[int, OutputErrorResults], seed: int
) -> dict[int, tuple[ControllerCost, ...]]:
    """Return, by heading, controllers tuned on the print's means of ten (b53 negative), and on first runs made here."""
    columns, truths = {}, {}
    for heading in HEADINGS:
        truth = reproduction.seas[heading][0].truth
        signs = np.sign(truth)
        columns[heading] = {
            **{f"{a}, printed": signs * printed_estimate(heading, a) for a in SearchAlgorithm},
            "theory with b53 positive, printed": true_values(heading),
            **{
                f"{a}, one run here": reproduction.searches[SearchSetting.PAPER, heading, a].points[0]
                for a in SearchAlgorithm
            },
            "ours, one run with noise": truth * (1.0 + output_error[heading].noisy_errors[0]),
        }
        truths[heading] = truth
    return pitch_controller_costs(columns, truths, SIGNIFICANT_HEIGHT, seed)


# Everything the verdicts rest on, and the few numbers they share.

# a value counts as on its bound where it is off by no more than this share of it
ON_BOUND_SHARE = 0.005


@dataclass(frozen=True, eq=False)
class WildHorseEvidence:
    """Searches, the print worked through, our fits and the cost of a hold by heading, the bias to the middle.

    Also the model carried on while its coefficients evolve, IWHO with parts left out, and controllers tuned on
    coefficients, by heading.
    """

    reproduction: WildHorseReproduction
    audit: WildHorseAudit
    output_error: dict[int, OutputErrorResults]
    hold_bias: dict[int, HoldBias]
    centre_bias: CentreBias
    tracking: Tracking
    ablation: Ablation
    controllers: dict[int, tuple[ControllerCost, ...]]

    def errors_of_mean(self, setting: SearchSetting, algorithm: SearchAlgorithm) -> list[float]:
        """Error of the mean of the runs at each heading, per cent, mean over the coefficients: as the paper prints."""
        return [
            100.0 * float(np.mean(self.reproduction.searches[setting, h, algorithm].error_of_mean)) for h in HEADINGS
        ]

    def single_run_errors(self, setting: SearchSetting, algorithm: SearchAlgorithm) -> list[float]:
        """Return the mean error of single runs at each heading, per cent."""
        return [100.0 * float(np.mean(self.reproduction.searches[setting, h, algorithm].mean_error)) for h in HEADINGS]

    def scatter(self, setting: SearchSetting, algorithm: SearchAlgorithm) -> list[float]:
        """Return the standard deviation over the runs at each heading, per cent, mean over the coefficients."""
        return [100.0 * self.reproduction.searches[setting, h, algorithm].scatter for h in HEADINGS]

    def share_at_lower_bound(self, setting: SearchSetting, algorithm: SearchAlgorithm) -> float:
        """Share of the values of all runs that lie on the lower bound."""
        found = [self.reproduction.searches[setting, h, algorithm] for h in HEADINGS]
        return float(np.mean([np.abs(f.points / f.lower_bounds - 1.0) < ON_BOUND_SHARE for f in found]))

    def saturated_means(self, setting: SearchSetting) -> int:
        """Of WHO's 16 means at 90 and 135 degrees, those as near the lower bound as the printed ones."""
        found = [self.reproduction.searches[setting, h, SearchAlgorithm.WHO] for h in (90, 135)]
        return sum(int(np.sum(100.0 * (f.points.mean(axis=0) / f.truth - 1.0) <= SATURATED_RANGE[1])) for f in found)

    def evaluations(self, algorithm: SearchAlgorithm) -> int:
        """Return the candidates that a run judges in the paper's setting."""
        return int(self.reproduction.searches[SearchSetting.PAPER, HEADINGS[0], algorithm].evaluations[0])

    def run_count(self, setting: SearchSetting) -> int:
        """Return the runs of a setting at each heading of the tables."""
        return len(self.reproduction.searches[setting, HEADINGS[0], SearchAlgorithm.IWHO].points)

    @property
    def ablation_runs(self) -> int:
        """Return the runs of IWHO with parts left out, and of IWHO complete beside them, at each heading."""
        return len(self.ablation.errors[SearchSetting.PAPER, None, HEADINGS[0]])

    @property
    def output_error_evaluations(self) -> int:
        """Return the evaluations of our noise-free fit, the most at any heading."""
        return max(o.evaluations for o in self.output_error.values())

    def search_seconds(self, algorithm: SearchAlgorithm) -> float:
        """Time of a run, mean over the headings."""
        return float(np.mean([self.reproduction.searches[SearchSetting.PAPER, h, algorithm].seconds for h in HEADINGS]))

    @property
    def bound_ratio(self) -> float:
        """Return the root mean square of our errors in noise over their Cramer-Rao bound, all headings."""
        return float(np.sqrt(np.mean([o.error_over_bound**2 for o in self.output_error.values()])))

    @property
    def output_error_seconds(self) -> float:
        """Time of our noise-free fit, mean over the headings."""
        return float(np.mean([o.seconds for o in self.output_error.values()]))


def simulated_steps(evaluations: int, *, has_slopes: bool) -> int:
    """Return the steps of evaluations of the whole record, each slope by a coefficient counted as one simulation."""
    return evaluations * (SAMPLES - 1) * (1 + len(COEFFICIENTS) * has_slopes)


def count_below_printed(errors: Array, heading: int) -> int:
    """Of the eight relative errors (8,), those below IWHO's printed one."""
    return int(np.sum(100.0 * np.abs(errors) < printed_error(heading, SearchAlgorithm.IWHO)))
