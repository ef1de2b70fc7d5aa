"""Thrust that falls or rises over a run at one order, as by a battery: a score test of one slope for all runs."""

from collections.abc import Mapping, Sequence

import numpy as np

from seatrial.core.text.numbers import percent
from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, Finding, Record, Severity
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.identify.assumed_information import output_error_estimate
from seatrial.estimation.identify.held_couplings import standard_error_ratio
from seatrial.estimation.identify.score_test import added_input, score_test
from seatrial.physics.models.thruster_layout import ThrusterLayout
from seatrial.physics.simulate.replay import inputs_of

_STANDARD_ERRORS = 3.0  # of the slope, from which on it is named; of a normal error one in 370 by chance; chosen
_LEAST = 0.03  # change of the order over a run that matters, as of a battery's voltage over some minutes; chosen
_STEP = 0.02  # share of the order by which it is changed for the slope, small against its curve; chosen


def drifting_thrust_finding(estimation: Estimation, records: Sequence[Record]) -> tuple[Finding, ...]:
    """Return a warning `thrust-drifts` where all thrusters seem to be ordered less, or more, towards the end of runs.

    records: the training runs, in the order of the estimate. The order is taken as changed by a share that goes
    straight from half of it at the start to less half of it at the end.
    """
    model = estimation.model
    if not model.equations.layout:
        return ()
    layout = ThrusterLayout.from_text(model.equations.layout)
    zeros = {model.input_names.index(t.command.channel): t.command.zero for t in layout.thrusters}
    estimate = output_error_estimate(estimation)
    slopes, free = [_slope_of_orders(inputs_of(model, r), zeros) for r in records], estimate.problem.free
    test = score_test(estimate, [added_input("order", slopes, _STEP)])
    (slope,), (score,) = test.sizes, test.scores / standard_error_ratio(estimation)
    if abs(score) < _STANDARD_ERRORS or abs(slope) < _LEAST:
        return ()
    errors = np.maximum(estimation.interval.standard_error[: len(free)], 1e-300)  # above zero, for a division
    moved = np.abs(test.by_candidates[: len(free), 0] * slope) / errors
    most = [free[int(i)] for i in np.argsort(-moved)[:3]]
    powers = [f"p_f{layout.suffix(leader)}" for leader in layout.leaders]
    power = float(np.mean([model.parameters[p].value if p in model.parameters else 1.0 for p in powers]))
    change, way = (1.0 + slope) ** power - 1.0, "falls" if slope < 0.0 else "rises"
    return (Finding(
        Severity.WARNING, "thrust-drifts", f"the thrust at one order {way} from the start of the runs to their end, by "
        f"{percent(abs(change))} %", f"{abs(score):.0f} standard errors; it moves most {enumeration(most)}",
        "record the battery's voltage or the propellers' rate, or train on shorter runs",
        "the intervals of the coefficients that stand in for it do not hold their true values",
    ),)  # fmt: skip


def _slope_of_orders(inputs: Array, zeros: Mapping[int, float]) -> Array:
    """Return the orders times a share from -1/2 to 1/2 over the run, other inputs unchanged, (rows, nu).

    zeros: column of each order -> what orders nothing, in its unit.
    """
    added = np.zeros_like(inputs)
    for column, zero in zeros.items():
        added[:, column] = (inputs[:, column] - zero) * np.linspace(-0.5, 0.5, len(inputs))
    return added
