"""Gains proposed for the craft as it is now: tuned on the coefficients of the moment, judged on what these allow."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from seatrial.control.choice import choose
from seatrial.control.controller import shortfall
from seatrial.control.front import Effort, pareto_front
from seatrial.control.gain_evaluation import GainEvaluator, gain_evaluator
from seatrial.control.proposals import JUDGED, WORTHWHILE, judged_gains, margins_over
from seatrial.control.task import TuningTask
from seatrial.core.results.online import Proposal
from seatrial.core.values import Array, InputError, frozen
from seatrial.data.folder.model_file import ModelFile
from seatrial.estimation.predict.draws import square_root

KNOWN = 0.15
"""Relative standard error of every coefficient from which on gains are proposed: that at which a change of the ship is
looked for, too; chosen."""
_EFFORT = Effort(refined=8, fill_rounds=2, neighbours=2000)
"""Of the front of a proposal: half a second or so of processor time, and gains within the 3 % that count; chosen."""


@dataclass(frozen=True, eq=False)
class CraftNow:
    """The craft that a stream shows by now.

    Attributes:
        names: of its coefficients; value: (k,), SI; covariance: (k, k).
        time: s on the stream's clock; since: s, from which on samples count.
    """

    names: tuple[str, ...]
    value: Array
    covariance: Array
    time: float
    since: float

    def unknown(self) -> tuple[str, ...]:
        """Return the coefficients that are not known well enough for gains to rest on them."""
        errors = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        return tuple(
            n for n, v, e in zip(self.names, self.value, errors, strict=True) if not e <= KNOWN * abs(float(v))
        )

    def file(self, base: ModelFile, value: Array) -> ModelFile:
        """Return a model file with coefficients (k,) in place of those of `base`."""
        parameters = base.model.parameters.fixed(*base.model.parameters.free_names).freed(*self.names)
        model = base.model.with_parameters(parameters).with_values(dict(zip(self.names, value.tolist(), strict=True)))
        order = [self.names.index(n) for n in model.parameters.free_names]
        return replace(base, model=model, covariance=frozen(self.covariance[np.ix_(order, order)]))

    def draws(self, count: int, seed: int) -> Array:
        """Return coefficients that the samples allow, (count, k)."""
        normal = np.random.default_rng(seed).standard_normal((count, len(self.value)))
        return self.value + normal @ square_root(self.covariance).T


def propose_for_craft(
    task_of: Callable[[ModelFile], TuningTask], base: ModelFile, craft: CraftNow, current: Array | None, seed: int = 0
) -> Proposal:
    """Return the gains for the craft as it is now, or why there are none.

    The loop is tuned anew on the coefficients of the moment. Those gains and the current ones are judged on craft drawn
    from what the samples allow, as `propose_gains` judges those of a schedule; the current ones stay where they hold
    and no others cost 3 % less.

    Args:
        task_of: the loop file's task on a model file's plant.
        base: the model file of the loop, whose values that are not estimated stay.
        current: gains (g,) that are on, or were proposed before.

    Raises:
        InputError: the loop cannot be put on these coefficients: no trim, or a plant that runs away.
    """
    if unknown := craft.unknown():
        reason = f"{', '.join(unknown)} not known to {100.0 * KNOWN:.0f} % yet, by samples since {craft.since:.0f} s"
        return _without_gains(task_of(base), craft, reason)
    task = replace(task_of(craft.file(base, craft.value)), simulation=None)  # chosen by spectra, within a second
    evaluator = gain_evaluator(task)
    front = pareto_front(evaluator, task.name, seed, lambda _: None, _EFFORT)
    if not len(front.gains):
        return _without_gains(task, craft, "no gains within their bounds keep all limits on the craft as it is now")
    newest = choose(task, ((evaluator, front),), seed, lambda _: None).gains
    candidates = np.array([newest]) if current is None else np.vstack([current, newest])
    evaluators = _evaluators(task_of, base, craft, seed)
    if 2 * len(evaluators) < JUDGED:
        reason = f"only {len(evaluators)} of {JUDGED} craft that the samples allow have a steady run"
        return _without_gains(task, craft, reason)
    judged = judged_gains(evaluators, candidates)
    short = [_shortfall(task, judged.shortfall(k, task), gains) for k, gains in enumerate(candidates)]
    if all(short):
        return _without_gains(task, craft, f"no gains hold on the craft as it is now: the newest have {short[-1]}")
    cost = judged.mean_cost
    stays = current is not None and not short[0] and (short[-1] or cost[0] <= (1.0 + WORTHWHILE) * cost[-1])
    chosen = 0 if stays else len(candidates) - 1
    return Proposal(
        loop=task.name,
        start=craft.since,
        stop=craft.time,
        gains=dict(zip(task.loop.gains.names, candidates[chosen].tolist(), strict=True)),
        reasons=_reasons(craft, short, cost, chosen, has_current=current is not None),
        gain_units={gain.name: gain.unit for gain in task.loop.gains},
        is_new=current is None or chosen > 0,
        U=task.U,
        margins=margins_over(evaluators, judged, chosen, candidates[chosen]),
    )


def _without_gains(task: TuningTask, craft: CraftNow, reason: str) -> Proposal:
    return Proposal(task.name, craft.since, craft.time, {}, (reason,), U=task.U)


def _evaluators(
    task_of: Callable[[ModelFile], TuningTask], base: ModelFile, craft: CraftNow, seed: int
) -> list[GainEvaluator]:
    """Return evaluators of the craft drawn that have a trim and do not run away by themselves."""
    evaluators = []
    for value in craft.draws(JUDGED, seed):
        with suppress(InputError):
            evaluators.append(gain_evaluator(task_of(craft.file(base, value))))
    return evaluators


def _shortfall(task: TuningTask, reason: str, gains: Array) -> str:
    """Return what gains lack on the craft drawn, else on the demand that the loop follows."""
    if reason or task.demand is None:
        return reason
    return shortfall(task, task.loop, gains)[1]


def _reasons(craft: CraftNow, short: list[str], cost: Array, chosen: int, *, has_current: bool) -> tuple[str, ...]:
    """Return why these gains, a sentence each."""
    rests = f"They rest on the coefficients of the samples from {craft.since:.0f} to {craft.time:.0f} s."
    if not has_current:
        return (rests,)
    if chosen == 0:
        return (rests, f"Those that are on hold; others cost no {100.0 * WORTHWHILE:.0f} % less.")
    if short[0]:
        return (rests, f"Those that are on no longer hold: {short[0]}.")
    more = 100.0 * (cost[0] / cost[chosen] - 1.0)
    return (rests, f"Those that are on leave {more:.0f} % more of the motion.")
