"""One set of gains in words a control engineer knows."""

import math
from dataclasses import replace

import numpy as np

from seatrial.control.demand import feed_forward, reference_rate
from seatrial.control.gain_evaluation import (
    ACTUATOR_ACCELERATION,
    ACTUATOR_RATE,
    GainEvaluation,
    GainEvaluator,
    exceedance_share,
)
from seatrial.control.task import OUTPUT, Demand, TuningTask
from seatrial.core.results.tuning import Component, Controller, DiscreteBlock, DiscreteController, ReferenceFilter
from seatrial.core.values import Array
from seatrial.physics.loops import Block, Sampling, TransferLoop, margins, reversals_per_hour
from seatrial.physics.loops.discrete import default_sample_time, difference_equation, holding_terms
from seatrial.physics.loops.margins import frequency_band

# relative excess over a limit that rounding explains; far below any margin that matters, our choice
_ROUNDING = 1e-9

_RMS_NAMES = ("output", "actuator", "actuator_rate", "motion")  # in the order of an evaluation's variances
_POINTS = 400  # frequencies of the curves in the result, evenly in the logarithm; chosen


def describe_controller(evaluator: GainEvaluator, name: str, gains: Array) -> Controller:
    """Return all that linear theory says of gains (g,) in what the task meets; the frailest speed gives the margins."""
    evaluation = evaluator.evaluate(gains[None])
    speeds = dict.fromkeys(one.U for one in evaluator.task.disturbances)
    loops = [evaluator.task.loop_at(U, evaluator.loop).with_gains(gains) for U in speeds]
    frail, frailest = max(((margins(loop), loop) for loop in loops), key=lambda pair: pair[0].Ms)
    variances, limits = evaluation.variances[0], evaluator.task.constraints
    rms = np.sqrt(variances.mean(axis=0))
    names = _RMS_NAMES[:3] if evaluator.task.motion is OUTPUT else _RMS_NAMES
    left = float(rms[3]) / math.sqrt(evaluator.uncontrolled_variance) if evaluator.task.demand is None else math.nan
    omega = np.geomspace(*frequency_band(frailest), _POINTS)
    open_loop, drive = frailest.open_loop(omega), evaluator.task.drive
    return Controller(
        name=name,
        gains=dict(zip(evaluator.loop.gains.names, gains.tolist(), strict=True)),
        objectives=evaluation.objectives[0],
        rms=dict(zip(names, rms.tolist(), strict=False)),
        reduction=1.0 - left,
        Ms=frail.Ms,
        gain_margin=frail.gain,
        phase_margin=frail.phase,
        delay_margin=frail.delay,
        damping=frail.damping,
        saturation=exceedance_share(limits.limit, float(variances[:, 1].max())),
        rate_saturation=exceedance_share(limits.rate, float(variances[:, 2].max())),
        violated=(*violated_restrictions(evaluator, evaluation), *_broken_delay(frail.delay, limits.delay)),
        omega=omega,
        open_loop=open_loop,
        lower_gain_margin=frail.lower_gain,
        noise_gain=_noise_gain(frailest, omega) if frail.is_stable else math.nan,
        reversals=_reversals(evaluator, gains),
        energy=math.nan if drive is None else drive.energy(float(variances[:, 2].mean())),
    )


def _noise_gain(loop: TransferLoop, omega: Array) -> float:
    """Return the largest |K S|: what the actuator makes of a unit of noise in the output, at its worst frequency."""
    controller = loop.gain_values @ loop.controller_terms(omega)
    return float(np.max(np.abs(controller / (1.0 + loop.open_loop(omega)))))


def _reversals(evaluator: GainEvaluator, gains: Array) -> float:
    """Return how often the actuator turns back in an hour, mean over the seas; nan where it never moves."""
    rows = (ACTUATOR_RATE.variances[0], ACTUATOR_ACCELERATION.variances[0])
    rms = [np.sqrt(replace(one, variances=rows).evaluate(gains, with_Ms=False).variances[0])
           for one in evaluator.performances]  # fmt: skip
    counts = [reversals_per_hour(float(rate), float(acceleration)) for rate, acceleration in rms if rate > 0.0]
    return float(np.mean(counts)) if counts else math.nan


def _broken_delay(delay: float, least: float) -> tuple[str, ...]:
    """Return the delay margin in words where it is too short."""
    return (f"delay margin {delay:.3g} s where {least:.3g} s are required",) if delay < least else ()


def violated_restrictions(evaluator: GainEvaluator, evaluation: GainEvaluation) -> tuple[str, ...]:
    """Return restrictions that the first of some gains does not keep, in words."""
    if not math.isfinite(evaluation.Ms[0]):
        return ("stability: the closed loop is unstable",)
    limits, worst = evaluator.task.constraints, evaluation.variances[0].max(axis=0)
    broken = []
    if evaluation.excess[0, 0] > _ROUNDING:
        broken.append(f"Ms {evaluation.Ms[0]:.3g} where {limits.Ms:.3g} is allowed")
    amplitudes = (("angle", limits.limit, limits.saturation), ("rate", limits.rate, limits.rate_saturation))
    for i, (kind, limit, share) in enumerate(amplitudes, start=1):
        if evaluation.excess[0, i] > _ROUNDING:
            beyond = 100.0 * exceedance_share(limit, float(worst[i]))
            broken.append(f"{beyond:.0f} % of the actuator's {kind} amplitudes beyond its limit "
                          f"where {100.0 * share:.0f} % are allowed")  # fmt: skip
    return tuple(broken)


def discrete_controller(task: TuningTask, loop: TransferLoop) -> DiscreteController | None:
    """Return terms and filters of a loop with its gains as difference equations, and the reference that it follows.

    None where the loop is unstable. One in continuous time is sampled as it allows.
    """
    if not margins(loop).is_stable:
        return None
    sampling = loop.sampling or Sampling(default_sample_time(loop))
    holds, sign = holding_terms(loop)

    def block(role: str, one: Block, gain: str = "", *, is_held: bool = False) -> DiscreteBlock:
        made = difference_equation(one, sampling.sample_s)
        return DiscreteBlock(role, one.name, gain, made.b, made.a, int(sign) if is_held else 0)

    terms = (block("term", t.block, t.gain, is_held=held) for t, held in zip(loop.terms, holds, strict=True))
    blocks = (*terms, *(block("filter", one) for one in loop.filters))
    reference = None if task.demand is None else _reference_filter(task, loop, task.demand)
    return DiscreteController(
        sampling.sample_s, blocks, sampling.dead_time, sampling.noise, sampling.resolution, reference,
        tuple(_component("sensor", block) for block in loop.sensor),
    )  # fmt: skip


def _reference_filter(task: TuningTask, loop: TransferLoop, demand: Demand) -> ReferenceFilter:
    law = feed_forward(loop, demand)
    rate = reference_rate(task, loop, demand)
    return ReferenceFilter(demand.time_constant, rate, law.level, law.velocity, law.acceleration)


def components(loop: TransferLoop) -> tuple[Component, ...]:
    """Return the blocks of a loop, in the order of the signal from its output back to it."""
    return (
        *(_component("sensor", block) for block in loop.sensor),
        *(_component("term", term.block, term.gain) for term in loop.terms),
        *(_component("filter", block) for block in loop.filters),
        *(_component("servo", block) for block in loop.servo),
        _component("plant", loop.plant),
        _component("disturbance", loop.disturbance),
    )


def _component(role: str, block: Block, gain: str = "") -> Component:
    return Component(role, block.name, block.num, block.den, gain, block.source)
