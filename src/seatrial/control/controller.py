"""One set of gains in words a control engineer knows."""

import math

import numpy as np

from seatrial.control.gain_evaluation import GainEvaluation, GainEvaluator, exceedance_share
from seatrial.core.results.tuning import Component, Controller
from seatrial.core.values import Array
from seatrial.physics.loops import TransferLoop, margins
from seatrial.physics.loops.margins import frequency_band

# relative excess over a limit that rounding explains; far below any margin that matters, our choice
_ROUNDING = 1e-9

_POINTS = 400  # frequencies of the curves in the result, evenly in the logarithm; chosen


def describe_controller(evaluator: GainEvaluator, name: str, gains: Array) -> Controller:
    """Everything linear theory says of gains (g,) in what the task meets; the frailest speed gives the margins."""
    made = evaluator.evaluate(gains[None])
    loops = [evaluator.task.loop_at(met.U, evaluator.loop).with_gains(gains) for met in evaluator.task.disturbances]
    frailest = max(loops, key=lambda loop: margins(loop).Ms)
    found = margins(frailest)
    rms = np.sqrt(made.variances[0].mean(axis=0))
    omega = np.geomspace(*frequency_band(frailest), _POINTS)
    limits = evaluator.task.constraints
    return Controller(
        name=name,
        gains=dict(zip(evaluator.loop.gains.names, gains.tolist(), strict=True)),
        objectives=made.objectives[0],
        rms=dict(zip(("output", "actuator", "actuator_rate"), rms.tolist(), strict=True)),
        reduction=math.nan
        if evaluator.task.demand
        else 1.0 - float(rms[0]) / math.sqrt(evaluator.uncontrolled_variance),
        Ms=found.Ms,
        gain_margin=found.gain,
        phase_margin=found.phase,
        delay_margin=found.delay,
        damping=found.damping,
        saturation=exceedance_share(limits.limit, float(made.variances[0, :, 1].max())),
        rate_saturation=exceedance_share(limits.rate, float(made.variances[0, :, 2].max())),
        violated=violated_restrictions(evaluator, made),
        omega=omega,
        open_loop=frailest.open_loop(omega),
    )


def violated_restrictions(evaluator: GainEvaluator, evaluation: GainEvaluation) -> tuple[str, ...]:
    """Restrictions that the first of some gains does not keep, in words."""
    if not math.isfinite(evaluation.Ms[0]):
        return ("stability: the closed loop is unstable",)
    limits, worst = evaluator.task.constraints, evaluation.variances[0].max(axis=0)
    said = []
    if evaluation.excess[0, 0] > _ROUNDING:
        said.append(f"Ms {evaluation.Ms[0]:.3g} where {limits.Ms:.3g} is allowed")
    for i, (what, limit, share) in enumerate(
        (("angle", limits.limit, limits.saturation), ("rate", limits.rate, limits.rate_saturation)), start=1
    ):
        if evaluation.excess[0, i] > _ROUNDING:
            said.append(
                f"{100.0 * exceedance_share(limit, float(worst[i])):.0f} % of the actuator's {what} "
                "amplitudes beyond its limit "
                f"where {100.0 * share:.0f} % are allowed"
            )
    return tuple(said)


def components(loop: TransferLoop) -> tuple[Component, ...]:
    """The blocks of a loop, in the order of the signal from its output back to it."""
    series = {"sensor": loop.sensor, "filter": loop.filters, "servo": loop.servo}
    made = {
        role: [Component(role, block.name, block.num, block.den, source=block.source) for block in blocks]
        for role, blocks in series.items()
    }
    terms = [
        Component("term", term.block.name, term.block.num, term.block.den, term.gain, term.block.source)
        for term in loop.terms
    ]
    plant, disturbance = (
        Component(role, block.name, block.num, block.den, source=block.source)
        for role, block in (("plant", loop.plant), ("disturbance", loop.disturbance))
    )
    return (*made["sensor"], *terms, *made["filter"], *made["servo"], plant, disturbance)
