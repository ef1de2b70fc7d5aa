"""Gains in, objectives and broken restrictions out, for all that a task meets; by the thousand, with gradients."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from seatrial.control.task import OUTPUT, TuningTask
from seatrial.core.values import Array
from seatrial.physics.loops import LoopEvaluation, LoopSignal, Objective, Performance, TransferLoop
from seatrial.physics.loops.objective import variance
from seatrial.physics.loops.performance import distinct_variances

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
