"""Is there process noise in the records, how much, and what the coefficients are when it is counted.

Prediction error with the intensities estimated, begun from an output-error estimate; a gate decides whether it is
needed (likelihood against the same filter without process noise) and whether it suffices (white innovations).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum, auto
from functools import cached_property
from itertools import pairwise

import numpy as np

from seatrial.core.equations.augment import (
    BIAS_MEMORY,
    WAVE,
    band_names,
    bias_name,
    force_peaks,
    gust_name,
    memory_name,
    wave_names,
)
from seatrial.core.results import Waves
from seatrial.core.values import Array, Index, InputError, ProgressReporter, spelling_hint
from seatrial.data.check.motion import sample_noise
from seatrial.estimation.estimate.disturbance_tests import (
    ProcessNoiseTest,
    innovation_correlation,
    likelihood_ratio_test,
)
from seatrial.estimation.estimate.newton_refinement import approach_by_gradient, refine_by_newton
from seatrial.estimation.estimate.plausibility import is_lost
from seatrial.estimation.estimate.point_estimate import PointEstimate, rounding_level
from seatrial.estimation.information.covariance import Interval, RunScores, from_information, inverse
from seatrial.estimation.problem.output_error import OutputError, SegmentNormals
from seatrial.estimation.problem.prediction_error import PredictionError, join_segments
from seatrial.numerics.optimise import (
    NormalEquations,
    Optimum,
    Solution,
    Status,
    levenberg_marquardt,
)
from seatrial.physics.sensors.measured_outputs import is_late
from seatrial.physics.sensors.wave_motion import motion_of

KINEMATIC_STATES = ("psi", "phi", "theta", "x0", "y0", "z0", "z")
# standard deviation of a measured initial state over its channel's noise, ours
_DIFFUSE_FACTOR = 10.0
# intensities tried first, over that which explains all motion, ours
_SCAN_SHARES = 10.0 ** np.arange(-3.0, 0.5, 0.5)
# promised decreases of the cost at which searches end: first, later, ours
_ROUGH, _NEGLIGIBLE = 1.0, 1e-3
# promised decrease of the cost at which the search without process noise ends, ours
_ROUGHLY_NEGLIGIBLE = 1e-2
# how far a state moves at least, SI, where nothing measures it; chosen
_LEAST_SPREAD = 1e-6
# the filter eliminates initial states: there are no local unknowns
_NO_INITIAL_STATES = np.zeros((0, 0))
# of the search for intensities alone, ours
_FEW_EVALUATIONS = 24
# of the first steps of a search: evaluations with the gain as given, then steps by the exact gradient; chosen
_APPROACH = 16, 3
# samples from which intensities for the floor of predictions are estimated, ours
_MAX_SAMPLES = 3000
# variance inflation of innovations beyond which no search makes them white, ours
_HOPELESS_INFLATION = 3.0


class NoiseEvidence(Enum):
    """What shows how strong the process noise is."""

    ONE_STEP = auto()
    WHOLE_RUNS = auto()


@dataclass(frozen=True, eq=False)
class ProcessNoise:
    """An optimum of the prediction-error criterion, with its gate.

    Attributes:
        problem: gives exact gradients; optimum: point, normal equations with expected information, history.
        newton_decrement: of the exact gradient at the point: how far above the minimum the cost still is; NaN
            where the coefficients were not searched, infinite where their search left physics.
        output_error: the problem over whole runs that it was made from; `problem.runs` is another one where the
            model has more states (gusts with a memory, biases, lags), whose parameters stand behind the free ones.
        disturbance_model: the disturbance in words; evidence: what shows its strength.
    """

    problem: PredictionError
    optimum: Optimum
    newton_decrement: float
    test: ProcessNoiseTest
    output_error: OutputError
    disturbance_model: str = "white"
    evidence: NoiseEvidence = NoiseEvidence.ONE_STEP

    @property
    def common_parameters(self) -> Array:
        """Coefficients and what the sessions have of their own, as in the output-error problem."""
        return self.optimum.solution.point[self.common_indices]

    @property
    def process_intensities(self) -> dict[str, float]:
        """Intensity of each state's process noise, SI over the root of a second; 0 where there is none.

        Of a gust with a memory that of the white noise with the same effect over longer times.
        """
        names, q = (self.problem.process, self.problem.split(self.optimum.solution.point)[1])
        intensities, states = (dict(zip(names, map(float, q), strict=True)), self.output_error.model.states)
        memories = self.added_constants
        gusts = {s: intensities[gust_name(s)] * memories[memory_name(s)] for s in states if gust_name(s) in intensities}
        return {s: v for s, v in intensities.items() if s in states} | gusts

    @property
    def state_spread(self) -> Array:
        """How far each driven state of the caller's model moves in the records, SI: measured, or at its start."""
        model, data = self.output_error.model, self.output_error.data
        spread = np.sqrt(np.max(self.problem.start_variance, axis=0))[: len(model.states)]
        for i, state in enumerate(model.states):
            if state in data.outputs:
                spread[i] = np.nanstd(data.measured[:, data.outputs.index(state)])
        driven = [s for s in self.problem.process if s in model.states]
        return np.maximum(spread[[model.states.index(s) for s in driven]], _LEAST_SPREAD)

    @property
    def added_constants(self) -> dict[str, float]:
        """Parameters the model has beyond the caller's: time constants [s]."""
        free, point = self.problem.runs.free, self.optimum.solution.point
        return {n: float(point[i]) for i, n in enumerate(free) if n not in self.output_error.free}

    @property
    def added_parameters(self) -> dict[str, float]:
        """What describes the disturbance beyond intensities: time constants [s]; of waves as `wave_parameters`."""
        waves = self.problem.waves
        return self.added_constants | waves.named(self.problem.wave_unknowns(self.optimum.solution.point))

    @property
    def measurement_noise(self) -> dict[str, float]:
        """Standard deviation of each channel about the craft's own motion, SI: noise, and waves and biases if any."""
        names, (_, q, deviation) = self.problem.process, self.problem.split(self.optimum.solution.point)
        noise, outputs = deviation**2, self.output_error.data.outputs
        for one in self.waves:
            noise += [one.rms.get(c, 0.0) ** 2 for c in outputs]
        if BIAS_MEMORY in self.added_constants:
            driven, memory = dict(zip(names, q.tolist(), strict=True)), self.added_constants[BIAS_MEMORY]
            # stationary variance of a Gauss-Markov process (Gelb 1974, section 3.5)
            noise += [0.5 * memory * driven.get(bias_name(c), 0.0) ** 2 for c in outputs]
        return dict(zip(outputs, map(float, np.sqrt(noise)), strict=True))

    @property
    def waves(self) -> tuple[Waves, ...]:
        """The waves that sensors show, one of each peak: motion beside the craft's own, or caused by their forces."""
        unknowns, outputs = self.problem.wave_unknowns(self.optimum.solution.point), self.output_error.data.outputs
        rms = np.sqrt(self.problem.waves.variances(unknowns, outputs))
        shown = tuple(
            Waves(float(omega), float(zeta), {c: float(s) for c, s in zip(outputs, sizes, strict=True) if s > 0.0})
            for (omega, zeta), sizes in zip(unknowns[: 2 * len(rms)].reshape(-1, 2), rms, strict=True)
        )
        return shown + tuple(self._forced_waves(peak + 1) for peak in range(force_peaks(self.problem.runs.model)))

    def _forced_waves(self, peak: int) -> Waves:
        """What forces at a peak cause: speeds as if nothing but inertia held the craft, angles that over frequency."""
        names, q = self.problem.process, self.problem.split(self.optimum.solution.point)[1]
        intensity, outputs = dict(zip(names, map(float, q), strict=True)), self.output_error.data.outputs
        omega, zeta = (self.added_constants[name] for name in band_names(peak))
        rms: dict[str, float] = {}
        for state in self.output_error.model.states:
            eta = wave_names(state, peak)[1]
            if eta in intensity:
                speed = intensity[eta] / np.sqrt(4.0 * zeta * omega**3)  # stationary; Fossen 2011, section 8.2.6
                rms |= {motion_of(state): speed / omega, state: speed}  # in this order: one without an angle is its own
        return Waves(omega, zeta, {c: float(v) for c, v in rms.items() if c in outputs and v > 0.0})

    @property
    def wave_cost(self) -> float | None:
        """Median over the coefficients of their standard errors over those without waves; None where there are none."""
        if not self.waves:
            return None
        problem, point = self.problem, self.optimum.solution.point.copy()
        sizes = problem.runs.size + np.flatnonzero([state.startswith(WAVE) for state in problem.process])
        first = problem.runs.size + len(problem.process)
        point[sizes] = point[first + 2 * problem.waves.peaks : first + problem.waves.size] = 0.0
        plain, k, kept = replace(problem, steps=None), len(self.output_error.free), problem.runs.size
        waved, still = (
            np.diag(inverse(plain.normal(p, _NO_INITIAL_STATES).hessian[:kept, :kept]))[:k]
            for p in (self.optimum.solution.point, point)
        )
        return float(np.sqrt(np.median(waved / still)))

    @cached_property
    def common_indices(self) -> Index:
        """Return positions among the unknowns of those that output error has too."""
        first, last = len(self.output_error.free), self.problem.runs.size
        return np.concatenate([np.arange(first), np.arange(len(self.problem.runs.free), last)])

    @cached_property
    def information(self) -> Array:
        """Information of `shared`, priors counted, the noise unknowns eliminated where they are not on a bound."""
        return self._eliminate_noise(self.optimum.normal)[1]

    @property
    def interval(self) -> Interval:
        """Of `shared`, from the information matrix of the prediction-error criterion."""
        return replace(from_information(self.information), meaning="information matrix of the innovations")

    @property
    def leave_one_out(self) -> Array:
        """`shared` with each run left out by one Newton step from stored normal equations, (runs, k)."""
        point, free, steps = self.optimum.solution.point, self._free_indices, self._run_scores.left_out_steps
        moved = np.tile(point, (len(steps), 1))
        moved[:, free] += steps
        return moved[:, self.common_indices]

    def interval_over_runs(self, meaning: str) -> Interval:
        """Return that of `shared` by how the runs differ, each weighed by the information that it holds."""
        free, size = self._free_indices, len(self.optimum.solution.point)
        interval = self._run_scores.interval(meaning)
        covariance = np.zeros((size, size))
        covariance[np.ix_(free, free)] = interval.covariance
        return replace(interval, covariance=covariance[np.ix_(self.common_indices, self.common_indices)])

    def as_point_estimate(self) -> PointEstimate:
        """The same point as an estimate over whole runs: noise levels, initial states, and the reduced information."""
        runs = replace(self.output_error, noise=np.array(list(self.measurement_noise.values())))
        states = [runs.model.states.index(s) for s in runs.starts]
        gradient, hessian = self._eliminate_noise(self.optimum.normal)
        normal = NormalEquations(self.optimum.normal.cost, gradient, hessian, _NO_INITIAL_STATES, np.zeros((0, 0, 0)),
                        np.zeros((0, len(gradient), 0)))  # fmt: skip
        solution = replace(self.optimum.solution, point=self.common_parameters)
        return PointEstimate(runs, Optimum(solution, self.problem.start[:, states], normal))

    @cached_property
    def _segment_normals(self) -> SegmentNormals:
        return replace(self.problem, steps=None).segment_normals(self.optimum.solution.point)

    @cached_property
    def _run_scores(self) -> RunScores:
        """Of the free unknowns."""
        blocks, point, runs = self._segment_normals, self.optimum.solution.point, self.problem.runs.data
        parts = [
            self.problem.assemble(blocks, point, runs.run_segments(int(r)), with_prior=False)
            for r in np.unique(runs.run)
        ]
        free = self._free_indices
        return RunScores.from_normals(
            self.optimum.normal.hessian[np.ix_(free, free)],
            np.array([p.gradient[free] for p in parts]),
            np.array([p.hessian[np.ix_(free, free)] for p in parts]),
        )

    @cached_property
    def _free_indices(self) -> Index:
        point, low, high = (self.optimum.solution.point, self.problem.lower, self.problem.upper)
        inside = (point > low) & (point < high)
        inside[: self.problem.runs.size] = True
        return np.flatnonzero(inside)

    def _eliminate_noise(self, normal: NormalEquations) -> tuple[Array, Array]:
        kept, others = (self.common_indices, np.setdiff1d(self._free_indices, self.common_indices))
        cross, inner = (normal.hessian[np.ix_(kept, others)], normal.hessian[np.ix_(others, others)])
        scale = 1.0 / np.sqrt(np.maximum(np.diag(inner), 1e-300))  # above zero, for a division
        # least squares: the memory of a gust without intensity has no influence
        solved = (
            scale[:, None] * np.linalg.lstsq(inner * scale[:, None] * scale, scale[:, None] * cross.T, rcond=1e-12)[0]
        )
        return normal.gradient[kept], normal.hessian[np.ix_(kept, kept)] - cross @ solved


def has_noise(estimate: PointEstimate) -> bool:
    """Whether the records have noise at all: rounding errors have no likelihood."""
    return bool(np.all(estimate.problem.noise > 2.0 * rounding_level(estimate.problem)))


def implied_intensities(estimate: PointEstimate, known_noise: Mapping[str, float]) -> dict[str, float]:
    """Intensity of each state's process noise that suits the estimate as it is, from some of its runs.

    What the model does not explain counts as noise here, so this bounds the process noise from above. Runs are taken
    evenly until they have some thousand samples.
    """
    data = estimate.problem.data
    count = min(len(data.runs), max(1, round(len(data.runs) * _MAX_SAMPLES / len(data.inputs))))
    runs = np.unique(np.linspace(0, len(data.runs) - 1, count).round().astype(int))
    chosen = np.concatenate([data.run_segments(int(r)) for r in runs])
    problem = replace(estimate.problem, data=data.selected(chosen))
    part = PointEstimate(problem, replace(estimate.optimum, local=estimate.optimum.local[chosen]))
    begun = initial_problem(part, known_noise, ())
    squares = _fit_intensities(begun, part)[: len(begun.process)]
    return dict(zip(begun.process, np.sqrt(squares).tolist(), strict=True))


def implied_process_noise(estimate: PointEstimate, known_noise: Mapping[str, float]) -> ProcessNoise:
    """Noise in the states and in the channels that suits the estimate as it is, over all its runs, with its gate."""
    problem = initial_problem(estimate, known_noise, ())
    return _without_search(problem, np.concatenate([estimate.common_parameters, _fit_intensities(problem, estimate)]))


def fit_prediction_error(
    estimate: PointEstimate,
    known_noise: Mapping[str, float] | None = None,
    driven_states: tuple[str, ...] = (),
    *,
    further_starts: Sequence[PointEstimate] = (),
    thorough: bool = False,
    evaluations: int = 60,  # of the innovations, at most; chosen
    report_progress: ProgressReporter | None = None,
) -> ProcessNoise:
    """Coefficients, process and measurement noise together by maximum likelihood, from an output-error estimate.

    The intensities alone come first (coefficients held), then everything with the gain frozen in the gradient, then
    the gradient of the likelihood itself by central differences of the innovations, until it vanishes.

    Args:
        estimate: over segments or whole runs; its robust loss is not kept, outliers must be gone.
        known_noise: standard deviations of channels that are not estimated, SI.
        driven_states: states with process noise; empty: all that are no kinematics and no filter of an instrument.
        further_starts: points of the same problem, of which the search starts from the likeliest: disturbances and
            feedback can lead output error far astray.
        thorough: search the coefficients even where the innovations cannot become white.

    Returns:
        The optimum with its gate, however that decides. Where innovations stay strongly coloured with intensities that
        suit the given coefficients, these are kept: the gate is shut already, and the intensities serve the floor.
        Where the search leaves physics, the intensities that suit the given coefficients, and an infinite decrement.

    Raises:
        InputError: a driven state is none of the model's, or reaches no compared channel.
    """
    report = report_progress or (lambda _: None)
    report("process noise: intensities")
    begun = [(e, *_begun(e, known_noise or {}, driven_states)) for e in (estimate, *further_starts)]
    estimate, problem, point = min(begun, key=lambda one: one[1].cost(one[2], _NO_INITIAL_STATES))
    if not thorough and np.max(innovation_correlation(problem, point)[1]) > _HOPELESS_INFLATION:
        return _without_search(problem, point)
    exact, found, slope = search_prediction_error(problem, point, evaluations, report)
    if is_lost(problem.runs, found.solution.point):
        return replace(_without_search(problem, point), newton_decrement=np.inf)
    cost, before = _cost_without_process_noise(problem, estimate, found.solution.point)
    verdict = likelihood_ratio_test(exact, found.solution.point, found.normal.cost, cost, before)
    return ProcessNoise(exact, found, slope, verdict, problem.runs)


def _begun(
    estimate: PointEstimate, known_noise: Mapping[str, float], driven_states: tuple[str, ...]
) -> tuple[PredictionError, Array]:
    """The problem and its point with intensities that suit the estimate as it is."""
    problem = initial_problem(estimate, known_noise, driven_states)
    return problem, np.concatenate([estimate.common_parameters, _fit_intensities(problem, estimate)])


def search_prediction_error(
    problem: PredictionError, point: Array, evaluations: int, report_progress: ProgressReporter
) -> tuple[PredictionError, Optimum, float]:
    """The problem with steps for exact gradients, its optimum, and the Newton decrement left there."""
    optimum = search_with_frozen_gain(problem, point, evaluations, report_progress)
    report_progress("prediction error: exact gradient")
    return refine_by_newton(problem, optimum)


def approach_optimum(
    problem: PredictionError, point: Array, report_progress: ProgressReporter
) -> tuple[Optimum, float]:
    """The first steps of a search and the Newton decrement where they end, near an optimum as a rule.

    From afar the gain as given leads as far as the exact gradient, at a quarter of its cost; nearer it stalls, since
    waves and gusts are known by the gain.
    """
    near = search_with_frozen_gain(problem, point, _APPROACH[0], report_progress)
    return approach_by_gradient(problem, near.solution.point, _APPROACH[1])


def search_with_frozen_gain(
    problem: PredictionError, point: Array, evaluations: int, report_progress: ProgressReporter
) -> Optimum:
    """The end of a search whose gradient takes the filter's gain as given, near the optimum."""

    def counted(count: int, cost: float) -> None:
        report_progress(f"prediction error: evaluation {count}, cost {cost:.6g}")

    return levenberg_marquardt(
        problem, point, _NO_INITIAL_STATES, negligible=_NEGLIGIBLE, evaluations=evaluations, report_progress=counted
    )


def _without_search(problem: PredictionError, point: Array) -> ProcessNoise:
    """Intensities alone, the coefficients as they were: no search can make these innovations white."""
    normal = problem.normal(point, _NO_INITIAL_STATES)
    optimum = Optimum(Solution(point, normal.cost, Status.STALLED, 1), _NO_INITIAL_STATES, normal)
    quiet = replace(problem, process=())
    held = np.concatenate([point[: problem.runs.size], point[problem.runs.size + len(problem.process) :]])
    verdict = likelihood_ratio_test(problem, point, normal.cost, quiet.cost(held, _NO_INITIAL_STATES), None)
    return ProcessNoise(problem, optimum, np.nan, verdict, problem.runs)


def initial_problem(
    estimate: PointEstimate, known_noise: Mapping[str, float], driven_states: tuple[str, ...]
) -> PredictionError:
    """The problem with its initial states."""
    problem, first = join_segments(estimate.problem)
    measured, local = problem.measured_initial_states(), estimate.optimum.local[first]
    model, outputs = problem.model, problem.data.outputs
    start = problem.unpack(estimate.common_parameters, measured)[0]
    variance = np.zeros_like(start)
    for m, state in enumerate(problem.starts):
        i = model.states.index(state)
        if state in outputs:
            start[:, i] = measured[:, m]
            variance[:, i] = (_DIFFUSE_FACTOR * problem.noise[outputs.index(state)]) ** 2
        else:
            column = estimate.optimum.local[:, m]
            start[:, i] = local[:, m]
            # a tenth of the largest, SI; chosen
            variance[:, i] = max(np.std(column), 0.1 * np.max(np.abs(column)), 1e-3) ** 2
    chosen = driven_states or tuple(s for s in problem.starts if s not in KINEMATIC_STATES and not is_late(s))
    for state in chosen:
        if state not in problem.starts:
            raise InputError(
                f"process noise on '{state}' would move nothing that is "
                f"measured{spelling_hint(state, list(problem.starts))}"
            )
    held = np.array([known_noise.get(o, np.nan) for o in outputs])
    return PredictionError(problem, chosen, start, variance, held)


def _longest_run(problem: OutputError) -> float:
    return float(np.max(np.diff(problem.data.offsets))) * problem.data.dt


def _state_spread(estimate: PointEstimate, states: tuple[str, ...]) -> Array:
    """How far each state moves in the records: measured, or else over the initial states of segments."""
    outputs, starts = estimate.problem.data.outputs, estimate.problem.starts
    spread = []
    for state in states:
        if state in outputs:
            spread.append(np.nanstd(estimate.problem.data.measured[:, outputs.index(state)]))
        else:
            spread.append(np.std(estimate.optimum.local[:, starts.index(state)]) if state in starts else 0.0)
    return np.maximum(spread, _LEAST_SPREAD)


def _fit_intensities(problem: PredictionError, estimate: PointEstimate) -> Array:
    """Squared intensities and variances that suit the coefficients as they are: a scan, then a search."""
    runs, begin = problem.runs, estimate.common_parameters
    held = runs.model.with_values(dict(zip(runs.free, begin[: len(runs.free)], strict=True)))
    held = held.with_parameters(held.parameters.fixed(*held.parameters.names))
    session_values = begin[len(runs.free) :]
    alone = replace(problem, runs=replace(runs, model=held, pinned=session_values, extra_terms=()))
    deviation = third_difference_noise(runs)
    whole = _state_spread(estimate, problem.process) / np.sqrt(_longest_run(runs))
    scanned = [
        _balance_noise(alone, np.concatenate([session_values, (share * whole) ** 2, deviation**2]))
        for share in _SCAN_SHARES
    ]
    best = min(scanned, key=lambda one: one[0])[1]
    found = levenberg_marquardt(alone, best, _NO_INITIAL_STATES, negligible=_ROUGH, evaluations=_FEW_EVALUATIONS)
    return found.solution.point[len(session_values) :]


def third_difference_noise(runs: OutputError) -> Array:
    """White noise on each channel from third differences, median over runs; at most the residuals', 1 % at least."""
    pieces = [runs.data.measured[a:b] for a, b in pairwise(runs.data.offsets)]
    readings = [[p[np.isfinite(p[:, i]), i] for p in pieces] for i in range(len(runs.noise))]
    columns = [[one for one in of_channel if len(one) > 3] for of_channel in readings]  # a third difference at least
    noise = np.array([np.median([sample_noise(c) for c in mine]) if mine else np.inf for mine in columns])
    return np.clip(noise, 1e-2 * runs.noise, runs.noise)  # a hundredth of the residuals at least; chosen


def _balance_noise(problem: PredictionError, point: Array) -> tuple[float, Array]:
    """Cost and point after two rounds of setting each channel's variance by its innovations' size."""
    ny = len(problem.runs.noise)
    for _ in range(2):
        squares = np.nanmean(problem.innovations(point).normalised ** 2, axis=0)
        if not np.all(np.isfinite(squares)):
            return np.inf, point
        point = point.copy()
        point[-ny:] *= np.clip(squares, 1e-4, 1e4)  # factors on variances in one round; chosen
        # factors on intensities in one round; chosen
        point[-ny - len(problem.process) : -ny] *= np.clip(np.median(squares), 1e-2, 1e2)
        point = np.clip(point, problem.lower, problem.upper)
    return problem.cost(point, _NO_INITIAL_STATES), point


def _cost_without_process_noise(
    problem: PredictionError, estimate: PointEstimate, point: Array
) -> tuple[float, Array | None]:
    """Minus the log-likelihood without process noise at its own optimum, and innovations there."""
    quiet = replace(problem, process=())
    k = problem.runs.size
    deviation = point[k + len(problem.process) :]
    begins = [np.concatenate([p, deviation]) for p in (point[:k], estimate.common_parameters)]
    costs = [quiet.cost(p, _NO_INITIAL_STATES) for p in begins]
    if not np.any(np.isfinite(costs)):
        return np.inf, None
    begin = begins[int(np.argmin(costs))]
    found = levenberg_marquardt(
        quiet, begin, _NO_INITIAL_STATES, negligible=_ROUGHLY_NEGLIGIBLE, evaluations=_FEW_EVALUATIONS
    )
    return found.normal.cost, quiet.innovations(found.solution.point).normalised
