"""Gains in, objectives and violated limits out, by the thousand; pressed against what they must keep."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from scipy.optimize import minimize

from seatrial.control.task import OUTPUT, Seaway, SlowDisturbance, TuningTask
from seatrial.core.results.tuning import ControllerConstraints
from seatrial.core.values import Array, Index, frozen
from seatrial.physics.loops import LoopEvaluation, LoopSignal, Objective, Performance, TransferLoop
from seatrial.physics.loops.objective import WeightedVariance, variance
from seatrial.physics.loops.performance import PEAKS, distinct_variances

# Gains in, objectives and broken restrictions out, for all that a task meets; by the thousand, with gradients.

ACTUATOR = variance("actuator", "rad^2", LoopSignal.ACTUATOR)
ACTUATOR_RATE = variance("actuator rate", "rad^2/s^2", LoopSignal.ACTUATOR, 1)
ACTUATOR_ACCELERATION = variance("actuator acceleration", "rad^2/s^4", LoopSignal.ACTUATOR, 2)
_ROUNDING = 1e-9  # relative excess over a limit that rounding explains
_KEPT_LOOPS = 64  # disturbed loops kept in memory, whatever restrictions they are judged by; chosen
_REMEMBERED = 8  # single sets of gains whose evaluation is kept; chosen
_UNSTABLE = 1e30  # variance in the place of infinity, whose ratio to a limit is no number where there is none


@dataclass(frozen=True, eq=False)
class GainEvaluation:
    """Sets of gains, n of them, judged.

    Attributes:
        objectives: (n, m), means over what disturbs the loop; infinite where unstable.
        excess: (n, 3): Ms, actuator variance and rate variance over what is allowed, minus 1, worst case; a set is
            feasible where none is positive. -1 where there is no limit.
        Ms: (n,), worst case.
        variances: output, actuator, rate, and the motion that counts, of each disturbance, (n, s, 4).
    """

    objectives: Array
    excess: Array
    Ms: Array
    variances: Array

    @property
    def is_feasible(self) -> np.ndarray:
        """Which are stable and keep every restriction, (n,)."""
        return np.all(self.excess <= _ROUNDING, axis=1)


@lru_cache(maxsize=_KEPT_LOOPS)
def _performance(met: Seaway | SlowDisturbance, loop: TransferLoop, rows: tuple[WeightedVariance, ...]) -> Performance:
    """Return what a disturbance leaves of a loop in these variances."""
    disturbed = met.disturbed(loop)
    return Performance(disturbed, met.exposure(disturbed), rows)


@dataclass(frozen=True, eq=False)
class GainEvaluator:
    """Judges gains of one loop, the task's own or a richer one, by the task's objectives and restrictions."""

    task: TuningTask
    loop: TransferLoop
    objectives: tuple[Objective, ...]

    @cached_property
    def _judged(self) -> tuple[Objective, ...]:
        return (*self.objectives, OUTPUT, ACTUATOR, ACTUATOR_RATE, self.task.motion)

    @cached_property
    def variance_indices(self) -> list[list[int]]:
        """Rows of each objective's variances, those of output, actuator, its rate and the motion that counts last."""
        return distinct_variances(self._judged)[1]

    @cached_property
    def own_rows(self) -> list[int]:
        """Rows of output, actuator, its rate and the motion that counts."""
        return [at[0] for at in self.variance_indices[-4:]]

    @cached_property
    def performances(self) -> tuple[Performance, ...]:
        """One for each thing that disturbs the loop."""
        rows = distinct_variances(self._judged)[0]
        return tuple(_performance(met, self.task.loop_at(met.U, self.loop), rows) for met in self.task.disturbances)

    def within(self, constraints: ControllerConstraints) -> "GainEvaluator":
        """Return a judge of the same loops by other restrictions."""
        return replace(self, task=replace(self.task, constraints=constraints))

    @cached_property
    def has_own_Ms(self) -> tuple[bool, ...]:
        """Whether each performance's open loop is the first of its kind: Ms is the same where the plant is."""
        plants = [p.loop.plant for p in self.performances]
        return tuple(plant not in plants[:i] for i, plant in enumerate(plants))

    def of_each(self, gains: Array) -> list[LoopEvaluation]:
        """Return the loops with the gains (n, g) in each disturbance; Ms is zero where another's is the same."""
        pairs = zip(self.performances, self.has_own_Ms, strict=True)
        return [performance.evaluate(gains, with_Ms=own) for performance, own in pairs]

    @cached_property
    def uncontrolled_variance(self) -> float:
        """Mean variance of the motion that counts without control; 1 SI of a loop that follows a demand.

        A heading has no variance without control, so that costs are its rms itself.
        """
        if self.task.demand is not None:
            return 1.0
        place = self.own_rows[3]
        return float(np.mean([p.uncontrolled_variances[place] for p in self.performances]))

    @cached_property
    def allowed_variances(self) -> Array:
        """Largest variance of actuator and rate, (2,): exp(-limit^2 / (2 variance)) = share (Rayleigh)."""
        r = self.task.constraints
        shares = ((r.limit, r.saturation), (r.rate, r.rate_saturation))
        return np.array([limit**2 / (2.0 * math.log(1.0 / share)) for limit, share in shares])

    def evaluate(self, gains: Array) -> GainEvaluation:
        """Return all of the gains (n, g)."""
        if len(gains) != 1:
            return self.evaluated(self.of_each(gains))
        return self.point(gains[0]).judged

    def point(self, gains: Array) -> "EvaluatedPoint":
        """Return one set of gains (g,); searches return to the last few for value, slopes and limits."""
        return self._remembered_point(np.asarray(gains, dtype=np.float64).tobytes())

    @cached_property
    def _remembered_point(self) -> Callable[[bytes], "EvaluatedPoint"]:
        return lru_cache(maxsize=_REMEMBERED)(lambda gains: EvaluatedPoint(self, np.frombuffer(gains).copy()))

    def evaluated(self, loops: list[LoopEvaluation]) -> GainEvaluation:
        """Return the judgement of loops, those of each disturbance."""
        made = np.array([e.variances for e in loops])
        variances = made[:, :, self.own_rows].swapaxes(0, 1)
        peak = np.array([e.Ms for e in loops]).max(axis=0)
        excess = np.empty((len(peak), 3))
        excess[:, 0] = peak / self.task.constraints.Ms - 1.0
        excess[:, 1:] = np.minimum(variances[:, :, 1:3].max(axis=1), _UNSTABLE) / self.allowed_variances - 1.0
        return GainEvaluation(self._mean_objectives(made), excess, peak, variances)

    def objective_values(self, gains: Array) -> Array:
        """Return objectives (n, m) of the gains (n, g), means over what disturbs the loop; infinite where unstable."""
        made = [performance.evaluate(gains, with_Ms=False).variances for performance in self.performances]
        return self._mean_objectives(np.array(made))

    def _mean_objectives(self, variances: Array) -> Array:
        """Return objectives (n, m) of the variances that each disturbance causes, (s, n, r)."""
        means = np.empty((variances.shape[1], len(self.objectives)))
        for i, (objective, at) in enumerate(zip(self.objectives, self.variance_indices, strict=False)):
            values = objective.value(variances[:, :, at].reshape(-1, len(at)))
            means[:, i] = values.reshape(len(variances), -1).mean(axis=0)
        return means

    @property
    def restriction_count(self) -> int:
        """Number of rows of `excess_of_each`."""
        return PEAKS * sum(self.has_own_Ms) + 2 * len(self.performances)


@dataclass(frozen=True, eq=False)
class EvaluatedPoint:
    """One set of gains (g,) judged, with slopes by the gains where the loop is stable; each is computed when asked."""

    evaluator: GainEvaluator
    gains: Array

    @cached_property
    def _loops(self) -> list[LoopEvaluation]:
        return self.evaluator.of_each(self.gains[None])

    @cached_property
    def judged(self) -> GainEvaluation:
        """The evaluation of the one set."""
        return self.evaluator.evaluated(self._loops)

    @cached_property
    def _variance_slopes(self) -> list[Array]:
        """The slopes of each disturbance's variances, (r, g)."""
        return [p.variance_gradients(self.gains) for p in self.evaluator.performances]

    @cached_property
    def slopes(self) -> tuple[Array, Array]:
        """d objectives / d gains (m, g) and d excess / d gains (3, g)."""
        one, made, rows = self.evaluator, [loops.variances for loops in self._loops], self._variance_slopes
        objectives = np.array([
            np.mean([objective.gradient(v[:, at])[0] @ row[at] for v, row in zip(made, rows, strict=True)], axis=0)
            for objective, at in zip(one.objectives, one.variance_indices, strict=False)
        ])  # fmt: skip
        excess = np.zeros((3, len(self.gains)))
        frailest = one.performances[int(np.argmax([loops.Ms[0] for loops in self._loops]))]
        excess[0] = frailest.sensitivity_peaks(self.gains)[1][0] / one.task.constraints.Ms
        for i, place in enumerate(one.own_rows[1:3]):
            worst = int(np.argmax([v[0, place] for v in made]))
            excess[1 + i] = rows[worst][place] / one.allowed_variances[i]
        return objectives, excess

    @cached_property
    def excess_of_each(self) -> tuple[Array, Array]:
        """Excess (c,) and its slopes (c, g), each smooth in the gains.

        A row for each peak of |S| of each plant, then for actuator and rate in each disturbance; `judged` has the
        largest of them, whose slope changes abruptly where two are equal.
        """
        one, most = self.evaluator, self.evaluator.task.constraints.Ms
        pairs = zip(one.performances, one.has_own_Ms, strict=True)
        peaks = [performance.sensitivity_peaks(self.gains) for performance, own in pairs if own]
        values, slopes = [top / most - 1.0 for top, _ in peaks], [rows / most for _, rows in peaks]
        places = one.own_rows[1:3]
        for loops, rows in zip(self._loops, self._variance_slopes, strict=True):
            values.append(loops.variances[0, places] / one.allowed_variances - 1.0)
            slopes.append(rows[places] / one.allowed_variances[:, None])
        return np.concatenate(values), np.concatenate(slopes)


def gain_evaluator(task: TuningTask, loop: TransferLoop | None = None) -> GainEvaluator:
    """Return a judge of the task's own loop, or of another on the same plant."""
    return GainEvaluator(task, task.loop if loop is None else loop, task.objectives)


def exceedance_share(limit: float, variance: float) -> float:
    """Return share of amplitudes beyond the limit, exp(-limit^2 / (2 variance)) (Rayleigh; Longuet-Higgins 1952)."""
    if not math.isfinite(variance):
        return 1.0
    return math.exp(-(limit**2) / (2.0 * variance)) if variance > 0.0 else 0.0


# One set of gains pressed against what it must keep, by exact gradients.

GainBounds = tuple[Array, Array]
# in the place of infinity; least value whose logarithm is taken; share of a range that is rounding; largest share by
# which a restriction is exceeded that the search sees
_HUGE, _TINY, _NO_SHARE, _LARGEST_EXCESS = 1e30, 1e-300, 1e-12, 1e3


def free_gain_bounds(evaluator: GainEvaluator) -> tuple[Index, GainBounds]:
    """Return the indices of the free gains and their bounds."""
    return _free_gain_bounds(evaluator.loop)


@lru_cache(maxsize=_KEPT_LOOPS)
def _free_gain_bounds(loop: TransferLoop) -> tuple[Index, GainBounds]:
    places = np.array([i for i, p in enumerate(loop.gains) if p.free], dtype=np.int64)
    low, high = (frozen(np.array([getattr(p, end) for p in loop.gains.free])) for end in ("lower", "upper"))
    return places, (low, high)


def all_gains(evaluator: GainEvaluator, free: Array) -> Array:
    """Return all gains (n, g) of free ones (n, f); the others as the loop has them."""
    places = free_gain_bounds(evaluator)[0]
    made = np.empty((len(free), len(evaluator.loop.terms)))
    if len(places) < made.shape[1]:
        made[:] = evaluator.loop.gain_values
    made[:, places] = free
    return made


def refine_gains(evaluator: GainEvaluator, start: Array, ceiling: Array | None = None) -> Array:
    """Return free gains (f,) of the least product of objectives, none above its `ceiling` (m,), restrictions kept.

    SLSQP (Kraft 1988) from feasible free gains, in the unit box, on logarithms of the objectives.
    """
    places, (low, high) = free_gain_bounds(evaluator)
    width = high - low
    count, rows = 0 if ceiling is None else len(ceiling), evaluator.restriction_count
    top = np.ones(0) if ceiling is None else np.maximum(ceiling, _TINY)

    def point_of(unit: Array) -> EvaluatedPoint:
        return evaluator.point(all_gains(evaluator, (low + np.clip(unit, 0.0, 1.0) * width)[None])[0])

    def value(unit: Array) -> float:
        return float(np.sum(np.log(np.clip(point_of(unit).judged.objectives[0], _TINY, _HUGE))))

    def slope(unit: Array) -> Array:
        point = point_of(unit)
        made = point.judged.objectives[0]
        if not np.all(np.isfinite(made) & (made > 0.0)):
            return np.zeros(len(unit))
        return (point.slopes[0][:, places] / made[:, None]).sum(axis=0) * width

    def constraint_margins(unit: Array) -> Array:
        point = point_of(unit)
        left = 1.0 - np.minimum(point.judged.objectives[0, :count] / top, _LARGEST_EXCESS)
        is_stable = math.isfinite(point.judged.Ms[0])
        each = point.excess_of_each[0] if is_stable else np.full(rows, _LARGEST_EXCESS)
        return np.concatenate([left, -np.minimum(each, _LARGEST_EXCESS)])

    def constraint_slopes(unit: Array) -> Array:
        point = point_of(unit)
        if not math.isfinite(point.judged.Ms[0]):
            return np.zeros((count + rows, len(unit)))
        excess = point.excess_of_each[1]
        each = np.concatenate([point.slopes[0][:count] / top[:, None], excess]) if count else excess
        return -each[:, places] * width

    found = minimize(
        value, (start - low) / width, jac=slope, bounds=[(0.0, 1.0)] * len(places), method="SLSQP",
        constraints={"type": "ineq", "fun": constraint_margins, "jac": constraint_slopes},  # type: ignore[arg-type]
        options={"maxiter": 50, "ftol": 1e-10},  # iterations at most, and change of the cost at the end; chosen
    )  # fmt: skip
    unit = np.clip(found.x, 0.0, 1.0)
    unit[unit < _NO_SHARE] = 0.0
    return low + unit * width


# A recommendation as a value, and which gains of a front are the best or lie on a bound.

ON_BOUND = 1e-3  # share of a gain's range that counts as on the bound; chosen


@dataclass(frozen=True, eq=False)
class NamedGains:
    """Gains (g,) of a loop that stand beside the chosen ones, by name."""

    name: str
    evaluator: GainEvaluator
    gains: Array


@dataclass(frozen=True, eq=False)
class GainChoice:
    """The evaluator of the chosen loop, its gains (g,), the name of the front they come from, why, and what else."""

    evaluator: GainEvaluator
    gains: Array
    front_name: str
    reasons: tuple[str, ...]
    designs: tuple[NamedGains, ...] = ()


def gains_on_bound(loop: TransferLoop, gains: Array) -> tuple[tuple[str, str, float], ...]:
    """Return name, end ("lower", "upper") and bound of free gains (g,) on a bound of the search which is not zero."""
    found = []
    for gain in loop.gains.free:
        value = float(gains[loop.gains.names.index(gain.name)])
        for end, bound in (("lower", gain.lower), ("upper", gain.upper)):
            if bound and abs(value - bound) <= ON_BOUND * (gain.upper - gain.lower):
                found.append((gain.name, end, bound))
    return tuple(found)


def motion_and_rate_variances(evaluator: GainEvaluator, gains: Array) -> Array:
    """Return variances of the motion that counts and of the actuator's rate, means over what the loop meets, (n, 2)."""
    return evaluator.evaluate(gains).variances[:, :, [3, 2]].mean(axis=1)


# The gains that leave least of the output within the restrictions: spread points, the best pressed by gradients.

_SAMPLES, _STARTS = 4096, 3  # spread points, and those that are refined; chosen
_AGREEING = 3  # searches that end in the best, verified optimum, after which the others are left out; chosen
_RESTARTS = 5  # searches from the best where it is not verified, until one finds nothing better; chosen


def spread_gains(evaluator: GainEvaluator, seed: int) -> Array:
    """Return gains spread over their box at random, (n, g), half of them towards small gains."""
    _, (low, high) = free_gain_bounds(evaluator)
    unit = np.random.default_rng(seed).random((_SAMPLES, len(low)))
    unit[::2] **= 3.0
    return all_gains(evaluator, low + unit * (high - low))


def least_output_gains(evaluator: GainEvaluator, samples: Array, near: Sequence[Array] = ()) -> Array:
    """Return the best samples pressed against the restrictions; the least first objective wins, (g,).

    Where no sample keeps them, the one that breaks them least. The search stops where several starts have met in the
    best optimum so far, verified. near: optima (g,) under restrictions that are nearly the
    same, from which the search begins as well (continuation: Allgower & Georg 1990, Numerical Continuation Methods); it
    alone stays on the branch of optima where it began, such as without an integral.
    """
    judged, (places, (low, _)) = evaluator.evaluate(samples), free_gain_bounds(evaluator)
    values = np.where(judged.is_feasible, judged.objectives[:, 0], np.inf)
    order = np.argsort(values if np.isfinite(values).any() else judged.excess.max(axis=1))
    tried = [samples[i] for i in order[:_STARTS]]
    faces = np.tile(tried[0][places], (len(places), 1))  # an optimum may lie where a term is left out
    np.fill_diagonal(faces, low)
    starts = [*(start[places] for start in (*near, *tried)), *faces]
    best, agreeing, ends, verified = tried[0], 0, list[Array](), list[Array]()
    for start in starts:
        end, is_verified = _pressed_gains(evaluator, start)
        ends.append(end)
        verified += [end] * is_verified
        best = _best_of(evaluator, [*tried, *ends])
        agreeing = sum(_is_same(one, best) for one in verified)
        if agreeing == _AGREEING:
            break
    if agreeing:
        return best
    for _ in range(_RESTARTS):  # the search's picture of the curvature begins anew
        again = _best_of(evaluator, [best, _pressed_gains(evaluator, best[places])[0]])
        if _is_same(again, best):
            return again
        best = again
    return best


def _is_same(gains: Array, second: Array) -> bool:
    """Return whether two sets of gains differ by no more than rounding."""
    return bool(np.allclose(gains, second, rtol=_ROUNDING, atol=0.0))


def _pressed_gains(evaluator: GainEvaluator, start: Array) -> tuple[Array, bool]:
    """Return gains (g,) of a search by gradients from free gains (f,), and whether they are verified as an optimum."""
    gains = all_gains(evaluator, refine_gains(evaluator, start)[None])[0]
    polished = polished_gains(evaluator, gains)
    return (gains, False) if polished is None else (polished, True)


def _best_of(evaluator: GainEvaluator, tried: list[Array]) -> Array:
    """Return the feasible gains of the least first objective; without any those that break the restrictions least."""
    judged = evaluator.evaluate(np.array(tried))
    if not judged.is_feasible.any():
        return tried[int(np.argmin(judged.excess.max(axis=1)))]
    return tried[int(np.argmin(np.where(judged.is_feasible, judged.objectives[:, 0], np.inf)))]


# An optimum to rounding: Newton's method on the conditions of Karush, Kuhn and Tucker (Nocedal & Wright 2006,
# Numerical Optimization, section 12.3), so that the last bits of another machine's sums leave the gains as they are.

_ACTIVE, _AT_BOUND = 1e-5, 1e-7  # excess, and share of a range, within which a restriction is first held; chosen
_CURVATURE_STEP = 1e-5  # of a range, of the differences of slopes; the cube root of rounding
_NEWTON_STEPS, _WORKING_SETS = 30, 12  # at most; chosen
_CONVERGED = 1e-9  # share of a range of a step that is rounding
_LARGEST_NEWTON_STEP = 0.25  # share of a range: beyond it another optimum is nearer; chosen
_NO_MULTIPLIER = 1e-9  # least multiplier over the slopes of the objective, below which it is negative: rounding


@dataclass(frozen=True, eq=False)
class _LocalProblem:
    """The least first objective of an evaluator about a point, over the unit box of its free gains."""

    evaluator: GainEvaluator

    def gains(self, unit: Array) -> Array:
        """Return all gains (g,) of a point (f,) of the unit box."""
        low, high = free_gain_bounds(self.evaluator)[1]
        return all_gains(self.evaluator, (low + unit * (high - low))[None])[0]

    def slopes(self, unit: Array) -> tuple[Array, Array, Array]:
        """Return slopes of the objective's logarithm (f,), excess (c,) and its slopes (c, f)."""
        places, (low, high) = free_gain_bounds(self.evaluator)
        point, width = self.evaluator.point(self.gains(unit)), high - low
        excess, rows = point.excess_of_each
        value = point.judged.objectives[0, 0]
        return point.slopes[0][0, places] * width / value, excess, rows[:, places] * width

    def is_regular(self, unit: Array) -> bool:
        """Return whether the loop is stable there and the objective has a logarithm."""
        evaluated = self.evaluator.evaluate(self.gains(unit)[None])
        return bool(np.isfinite(evaluated.Ms[0]) and 0.0 < evaluated.objectives[0, 0] < np.inf)

    def stationary_point(self, start: Array, free: Index, held: Index) -> tuple[Array, Array] | None:
        """Return where the Lagrangian is stationary with the restrictions `held` exactly, and their multipliers.

        None where Newton's steps lead away, or to no minimum.
        """
        x, count = start.copy(), len(free)
        for _ in range(_NEWTON_STEPS):
            if not self.is_regular(x) or len(held) > count:
                return None
            slope, excess, rows = self.slopes(x)
            rows = rows[np.ix_(held, free)]
            multipliers: Array = np.asarray(np.linalg.lstsq(rows.T, -slope[free], rcond=None)[0], dtype=np.float64)
            curvature = self._curvature(x, free, held, multipliers)
            if curvature is None:
                return None
            system = np.block([[curvature, rows.T], [rows, np.zeros((len(held), len(held)))]])
            solved = np.linalg.lstsq(system, -np.concatenate([slope[free], excess[held]]), rcond=None)[0]
            step: Array = np.asarray(solved, dtype=np.float64)
            if np.abs(step[:count]).max(initial=0.0) > _LARGEST_NEWTON_STEP:
                return None
            x[free] += step[:count]
            if np.abs(step[:count]).max(initial=0.0) < _CONVERGED:
                basis = np.linalg.svd(rows)[2][len(held) :]
                is_least = np.all(np.linalg.eigvalsh(basis @ curvature @ basis.T) > 0.0)
                return (x, step[count:]) if is_least and self.is_regular(x) else None
        return None

    def _curvature(self, x: Array, free: Index, held: Index, multipliers: Array) -> Array | None:
        """Return second derivatives of the Lagrangian by the free gains, differences of its slopes."""
        columns = []
        for place in free:
            ends = []
            for step in (_CURVATURE_STEP, -_CURVATURE_STEP):
                beside = x.copy()
                beside[place] += step
                if not self.is_regular(beside):
                    return None
                slope, _, rows = self.slopes(beside)
                ends.append(slope[free] + multipliers @ rows[np.ix_(held, free)])
            columns.append((ends[0] - ends[1]) / (2.0 * _CURVATURE_STEP))
        curvature = np.reshape(columns, (len(free), len(free)))
        return 0.5 * (curvature + curvature.T)


def polished_gains(evaluator: GainEvaluator, start: Array) -> Array | None:
    """Return the gains (g,) at the optimum of the first objective next to a search's end; None where none is verified.

    Verified are the slopes of the Lagrangian (zero), restrictions (kept), multipliers (none negative) and curvature
    (positive where no restriction holds).
    """
    places, (low, high) = free_gain_bounds(evaluator)
    problem = _LocalProblem(evaluator)
    x = (start[places] - low) / (high - low)
    bound = np.where(x <= _AT_BOUND, -1, np.where(x >= 1.0 - _AT_BOUND, 1, 0))
    x = np.where(bound < 0, 0.0, np.where(bound > 0, 1.0, x))
    if not problem.is_regular(x):
        return None
    held = problem.slopes(x)[1] > -_ACTIVE
    for _ in range(_WORKING_SETS):
        stationary = problem.stationary_point(x, np.flatnonzero(bound == 0), np.flatnonzero(held))
        if stationary is None:
            return None
        point, multipliers = stationary
        slope, excess, rows = problem.slopes(point)
        pull = bound * (slope + multipliers @ rows[held])  # positive: the bound keeps nothing back
        least = -_NO_MULTIPLIER * np.abs(slope).max()
        beyond = (point < 0.0) | (point > 1.0)
        if np.any(beyond):
            place = int(np.argmax(np.abs(point - 0.5)))
            bound[place] = -1 if point[place] < 0.0 else 1
            x[place] = 0.0 if point[place] < 0.0 else 1.0
        elif np.any(excess[~held] > _ROUNDING):
            held[int(np.argmax(np.where(held, -np.inf, excess)))] = True
        elif np.any(multipliers < least):
            held[np.flatnonzero(held)[int(np.argmin(multipliers))]] = False
        elif np.any(pull > -least):
            bound[int(np.argmax(pull))] = 0
        else:
            return problem.gains(point)
    return None
