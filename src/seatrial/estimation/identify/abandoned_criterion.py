"""A warning where a search from sample to sample led outside physics: which runs the model cannot have, and why."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Finding, Record, Severity
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.point_estimate import split_segments

LEAST_LOSS = 1.0 / 3.0
"""Share of its speed that a run loses, from which on a model without surge cannot have it; chosen."""
_WORST = 2.0  # times the median run's residuals from which on a run is named; chosen
_EDGE_SHARE = 0.1  # of a run, over which its speed is averaged at begin and end; chosen


def abandoned_criterion_finding(estimation: Estimation, records: Sequence[Record]) -> tuple[Finding, ...]:
    """Return a warning `search-abandoned` where whole runs took the place of another criterion; else nothing.

    records: the training runs, in their order.
    """
    if not estimation.abandoned:
        return ()
    losses = _speed_losses(estimation.model, records)
    worst = {} if losses else _worst_runs(estimation, records)
    named = [*losses, *worst]
    evidence = [f"{name} loses {100.0 * share:.0f} % of its speed, which the model does not have"
                for name, share in losses.items()]  # fmt: skip
    evidence += [f"{name} has {ratio:.1f} times the residuals of the median run" for name, ratio in worst.items()]
    listed = ", ".join(f'"{name}"' for name in named)
    ways = [f"leave them out, with leave_out = [{listed}] under [[records]]"] if 0 < len(named) < len(records) else []
    ways += ["take a model with surge (mmg, abkowitz)" if losses else "take a model with more terms"]
    return (Finding(
        Severity.WARNING, "search-abandoned",
        f"{estimation.abandoned}: these runs contradict the model from sample to sample, and the estimate is that of "
        "output error over whole runs", "; ".join(evidence), f"{', or '.join(ways)}",
        "coefficients are a compromise between runs that differ by more than their intervals",
    ),)  # fmt: skip


def _speed_losses(model: Model, records: Sequence[Record]) -> dict[str, float]:
    """Runs that lose much of their speed, of a model that has none, and the share that they lose."""
    if "u" in model.states:
        return {}
    losses: dict[str, float] = {}
    for record in records:
        if "u" not in record:
            continue
        count = max(1, round(_EDGE_SHARE * len(record)))
        first, last = (float(np.nanmedian(record["u"][part])) for part in (slice(count), slice(-count, None)))
        if first > 0.0 and 1.0 - last / first > LEAST_LOSS:
            losses[record.name] = 1.0 - last / first
    return losses


def _worst_runs(estimation: Estimation, records: Sequence[Record]) -> dict[str, float]:
    """Runs whose residuals are much larger than those of the median run, and how many times."""
    problem, values = estimation.estimate.problem, estimation.residuals
    if len(problem.data.runs) != len(records) or len(records) < 2:
        return {}
    squares = np.zeros(len(records))
    for column, noise in zip(values.T, problem.noise, strict=True):
        pieces = split_segments(problem, column / noise)
        squares += [np.mean(np.square(np.concatenate([pieces[k] for k in problem.data.run_segments(r)])))
                    for r in range(len(records))]  # fmt: skip
    ratios = np.sqrt(squares / np.median(squares))
    return {record.name: float(ratio) for record, ratio in zip(records, ratios, strict=True) if ratio > _WORST}
