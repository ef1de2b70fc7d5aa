"""Gains in, objectives and violated limits out, by the thousand; pressed against what they must keep."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from scipy.optimize import NonlinearConstraint, minimize

from seatrial.control.task import OUTPUT, TuningTask
from seatrial.core.results.tuning import ParetoFront
from seatrial.core.values import Array, Index
from seatrial.numerics.optimise import non_dominated
from seatrial.physics.loops import LoopEvaluation, LoopSignal, Objective, Performance, TransferLoop
from seatrial.physics.loops.objective import variance
from seatrial.physics.loops.performance import distinct_variances

# Gains in, objectives and broken restrictions out, for all that a task meets; by the thousand, with gradients.

ACTUATOR = variance("actuator", "rad^2", LoopSignal.ACTUATOR)
ACTUATOR_RATE = variance("actuator rate", "rad^2/s^2", LoopSignal.ACTUATOR, 1)
ACTUATOR_ACCELERATION = variance("actuator acceleration", "rad^2/s^4", LoopSignal.ACTUATOR, 2)
_ROUNDING = 1e-9  # relative excess over a limit that rounding explains
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
    def _variance_indices(self) -> list[list[int]]:
        return distinct_variances(self._judged)[1]

    @cached_property
    def performances(self) -> tuple[Performance, ...]:
        """One for each thing that disturbs the loop."""
        rows = distinct_variances(self._judged)[0]
        loops = [(met, met.disturbed(self.task.loop_at(met.U, self.loop))) for met in self.task.disturbances]
        return tuple(Performance(loop, met.exposure(loop), rows) for met, loop in loops)

    @cached_property
    def _has_own_Ms(self) -> tuple[bool, ...]:
        """Whether each performance's open loop is the first of its kind: Ms is the same where the plant is."""
        plants = [p.loop.plant for p in self.performances]
        return tuple(plant not in plants[:i] for i, plant in enumerate(plants))

    def _of_each(self, gains: Array) -> list[LoopEvaluation]:
        """Return the loops with the gains (n, g) in each disturbance; Ms is zero where another's is the same."""
        pairs = zip(self.performances, self._has_own_Ms, strict=True)
        return [performance.evaluate(gains, with_Ms=own) for performance, own in pairs]

    @cached_property
    def uncontrolled_variance(self) -> float:
        """Mean variance of the motion that counts without control; 1 SI of a loop that follows a demand.

        A heading has no variance without control, so that costs are its rms itself.
        """
        if self.task.demand is not None:
            return 1.0
        place = self._variance_indices[-1][0]
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
            return self._evaluated(self._of_each(gains))
        return self._remembered_evaluation(_bytes(gains))

    @cached_property
    def _remembered_evaluation(self) -> Callable[[bytes], GainEvaluation]:
        """Evaluate one set of gains, given as bytes; searches return to the last few for value, slope and limits."""
        return lru_cache(maxsize=_REMEMBERED)(lambda gains: self._evaluated(self._remembered_loops(gains)))

    @cached_property
    def _remembered_loops(self) -> Callable[[bytes], list[LoopEvaluation]]:
        """Return the loops with one set of gains, given as bytes, which its evaluation and its slopes rest on."""
        return lru_cache(maxsize=_REMEMBERED)(lambda gains: self._of_each(np.frombuffer(gains)[None].copy()))

    @cached_property
    def _remembered_slopes(self) -> Callable[[bytes], tuple[Array, Array]]:
        """Return `slopes` at one set of gains, given as bytes."""
        return lru_cache(maxsize=_REMEMBERED)(lambda gains: self._slopes_at(np.frombuffer(gains).copy()))

    def _evaluated(self, loops: list[LoopEvaluation]) -> GainEvaluation:
        """Return the judgement of loops, those of each disturbance."""
        places = self._variance_indices[-4:]
        variances = np.stack([e.variances[:, [p[0] for p in places]] for e in loops], axis=1)
        peak = np.max([e.Ms for e in loops], axis=0)
        worst = variances[:, :, 1:3].max(axis=1)
        over = np.where(np.isfinite(worst), worst, _UNSTABLE) / self.allowed_variances - 1.0
        excess = np.column_stack([peak / self.task.constraints.Ms - 1.0, over])
        return GainEvaluation(self._mean_objectives([e.variances for e in loops]), excess, peak, variances)

    def objective_values(self, gains: Array) -> Array:
        """Return objectives (n, m) of the gains (n, g), means over what disturbs the loop; infinite where unstable."""
        made = [performance.evaluate(gains, with_Ms=False).variances for performance in self.performances]
        return self._mean_objectives(made)

    def _mean_objectives(self, variances: list[Array]) -> Array:
        """Return objectives (n, m) of the variances (n, r) that each disturbance causes."""
        values = [
            np.mean([objective.value(made[:, at]) for made in variances], axis=0)
            for objective, at in zip(self.objectives, self._variance_indices, strict=False)
        ]
        return np.stack(values, axis=1)

    def slopes(self, gains: Array) -> tuple[Array, Array]:
        """Return d objectives / d gains (m, g) and d excess / d gains (3, g) at one stable point (g,)."""
        return self._remembered_slopes(_bytes(gains))

    def _slopes_at(self, gains: Array) -> tuple[Array, Array]:
        evaluated = self._remembered_loops(_bytes(gains))
        made = [one.variances for one in evaluated]
        rows = [p.variance_gradients(gains) for p in self.performances]
        objectives = np.array([
            np.mean([objective.gradient(v[:, at])[0] @ row[at] for v, row in zip(made, rows, strict=True)], axis=0)
            for objective, at in zip(self.objectives, self._variance_indices, strict=False)
        ])  # fmt: skip
        excess = np.zeros((3, len(gains)))
        frailest = self.performances[int(np.argmax([one.Ms[0] for one in evaluated]))]
        excess[0] = frailest.Ms_gradient(gains) / self.task.constraints.Ms
        for i, place in enumerate(at[0] for at in self._variance_indices[-3:-1]):
            worst = int(np.argmax([v[0, place] for v in made]))
            excess[1 + i] = rows[worst][place] / self.allowed_variances[i]
        return objectives, excess


def _bytes(gains: Array) -> bytes:
    return np.asarray(gains, dtype=np.float64).tobytes()


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
    gains = evaluator.loop.gains
    places = np.array([i for i, p in enumerate(gains) if p.free], dtype=np.int64)
    return places, (np.array([gains.items[i].lower for i in places]), np.array([gains.items[i].upper for i in places]))


def all_gains(evaluator: GainEvaluator, free: Array) -> Array:
    """Return all gains (n, g) of free ones (n, f); the others as the loop has them."""
    made = np.tile(evaluator.loop.gain_values, (len(free), 1))
    made[:, free_gain_bounds(evaluator)[0]] = free
    return made


def refine_gains(evaluator: GainEvaluator, start: Array, ceiling: Array | None = None) -> Array:
    """Return free gains (f,) of the least product of objectives, none above its `ceiling` (m,), restrictions kept.

    SLSQP (Kraft 1988) from feasible free gains, in the unit box, on logarithms of the objectives.
    """
    places, (low, high) = free_gain_bounds(evaluator)
    width = high - low
    count = 0 if ceiling is None else len(ceiling)
    top = np.ones(0) if ceiling is None else np.maximum(ceiling, _TINY)

    def all_gains_at(unit: Array) -> Array:
        return all_gains(evaluator, (low + np.clip(unit, 0.0, 1.0) * width)[None])

    def value(unit: Array) -> float:
        return float(np.sum(np.log(np.clip(evaluator.evaluate(all_gains_at(unit)).objectives[0], _TINY, _HUGE))))

    def slope(unit: Array) -> Array:
        made = evaluator.evaluate(all_gains_at(unit)).objectives[0]
        if not np.all(np.isfinite(made) & (made > 0.0)):
            return np.zeros(len(unit))
        return (evaluator.slopes(all_gains_at(unit)[0])[0][:, places] / made[:, None]).sum(axis=0) * width

    def constraint_margins(unit: Array) -> Array:
        made = evaluator.evaluate(all_gains_at(unit))
        left = 1.0 - np.minimum(made.objectives[0, :count] / top, _LARGEST_EXCESS)
        return np.concatenate([left, -np.minimum(made.excess[0], _LARGEST_EXCESS)])

    def constraint_slopes(unit: Array) -> Array:
        if not math.isfinite(evaluator.evaluate(all_gains_at(unit)).Ms[0]):
            return np.zeros((count + 3, len(unit)))
        objectives, excess = evaluator.slopes(all_gains_at(unit)[0])
        return -np.concatenate([objectives[:count] / top[:, None], excess])[:, places] * width

    found = minimize(
        value, (start - low) / width, jac=slope, bounds=[(0.0, 1.0)] * len(places), method="SLSQP",
        constraints=NonlinearConstraint(constraint_margins, 0.0, np.inf, jac=constraint_slopes),
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


def non_dominated_gains(evaluator: GainEvaluator, front: ParetoFront) -> Array:
    """Return gains of the front of which none leaves less of the motion at a lower actuator rate, by motion, (n, g)."""
    both = motion_and_rate_variances(evaluator, front.gains)
    first = non_dominated(both)
    return front.gains[first[np.argsort(both[first, 0])]]


def motion_and_rate_variances(evaluator: GainEvaluator, gains: Array) -> Array:
    """Return variances of the motion that counts and of the actuator's rate, means over what the loop meets, (n, 2)."""
    return evaluator.evaluate(gains).variances[:, :, [3, 2]].mean(axis=1)


# The gains that leave least of the output within the restrictions: spread points, the best pressed by gradients.

_SAMPLES, _STARTS = 4096, 3  # Sobol points, and those that are refined; chosen
_RESTARTS = 5  # searches from the best, until one finds nothing better; chosen


def spread_gains(evaluator: GainEvaluator, seed: int) -> Array:
    """Return gains spread over their box, (n, g): Sobol points, half of them towards small gains."""
    from scipy.stats import qmc

    _, (low, high) = free_gain_bounds(evaluator)
    unit = qmc.Sobol(len(low), seed=seed).random(_SAMPLES)
    unit[::2] **= 3.0
    return all_gains(evaluator, low + unit * (high - low))


def least_output_gains(evaluator: GainEvaluator, samples: Array) -> Array:
    """Return the best samples pressed against the restrictions; the least first objective wins, (g,).

    Where no sample keeps them, the one that breaks them least.
    """
    judged = evaluator.evaluate(samples)
    values = np.where(judged.is_feasible, judged.objectives[:, 0], np.inf)
    places = free_gain_bounds(evaluator)[0]
    order = np.argsort(values if np.isfinite(values).any() else judged.excess.max(axis=1))
    tried = [samples[i] for i in order[:_STARTS]]
    tried += [all_gains(evaluator, refine_gains(evaluator, start[places])[None])[0] for start in tried]
    best = _best_of(evaluator, tried)
    for _ in range(_RESTARTS):  # the search's picture of the curvature begins anew
        again = _best_of(evaluator, [best, all_gains(evaluator, refine_gains(evaluator, best[places])[None])[0]])
        if np.array_equal(again, best):
            break
        best = again
    return best


def _best_of(evaluator: GainEvaluator, tried: list[Array]) -> Array:
    """Return the feasible gains of the least first objective; without any those that break the restrictions least."""
    judged = evaluator.evaluate(np.array(tried))
    if not judged.is_feasible.any():
        return tried[int(np.argmin(judged.excess.max(axis=1)))]
    return tried[int(np.argmin(np.where(judged.is_feasible, judged.objectives[:, 0], np.inf)))]
