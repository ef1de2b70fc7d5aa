"""Heave and pitch in a known sea: a ship near the published one, its record, and what a search makes small."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Record, RecordKind
from seatrial.data.trial import Trial, TrialRun
from seatrial.estimation.problem import LinearOutputError
from seatrial.estimation.search import JudgedRun, LinearCandidates
from seatrial.numerics.optimise import Box
from seatrial.physics.models import HEAVE_PITCH_STIFFNESSES
from seatrial.problems import (
    BenchmarkProblem,
    KnownTruth,
    PaperClaim,
    Placement,
    ProblemDraw,
    centred_box,
    off_centre_box,
    standard_errors_within,
    start_within,
)
from seatrial_studies.output_error_fit import MOTION_NOISE, output_error_problem
from seatrial_studies.published_ship import SHIP
from seatrial_studies.swarm_search import (
    HEAVE_AND_PITCH,
    STEP,
    WAVE_FORCE_INPUTS,
    SearchData,
    held_force_ship,
    simulate_search_data,
)

_SCALE = 0.1
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
            truth = truth * rng.uniform(1.0 - _SCALE, 1.0 + _SCALE, len(truth))
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
    return Trial(SHIP, (TrialRun(record),), start_within(model, model.parameters.free_names, start, box), noise=noise)


def heave_pitch_problem(
    name: str, title: str, source: str, budget: int, setting: HeavePitchSetting, claims: tuple[PaperClaim, ...]
) -> BenchmarkProblem:  # fmt: skip
    """Return the benchmark problem of a setting."""
    is_changing = setting.judged is Judged.ONE_SAMPLE
    return BenchmarkProblem(
        name, _VERSION, title, source, setting.noise_text, budget, setting.draw, is_changing, claims
    )
