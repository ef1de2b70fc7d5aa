"""What the forces of a box leave open, that stand in for the wave forces of a hull: a part of every interval."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.results import Coefficient
from seatrial.core.text.words import enumeration
from seatrial.core.values import NOT_MEASURED, Array, Finding, Severity
from seatrial.data.trial import TrialRecord
from seatrial.data.trial.plausibility import ESTIMATED_VALUES
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.identify.assumed_information import output_error_estimate
from seatrial.estimation.identify.estimated_values_effect import EstimatedValueShift
from seatrial.estimation.identify.score_test import added_input, score_test
from seatrial.estimation.problem.output_error import OutputError
from seatrial.physics.hydro.excitation import BoxForceError, BoxHull
from seatrial.physics.sea.wave_forces import with_wave_forces
from seatrial.physics.simulate.replay import inputs_of

_FORCES = ("F3", "M5")


def box_force_shifts(estimation: Estimation, records: Sequence[TrialRecord]) -> tuple[EstimatedValueShift, ...]:
    """Return how the free coefficients move where the hull's forces differ from the box's in each possible way.

    One Gauss-Newton step to outputs that forces with the error would have: H^-1 J' W dy, initial states eliminated.
    records: the training runs, in the order of the estimate; empty: no forces of theirs are a box's.
    """
    boxes = [r.waves.excitation for r in records if r.waves is not None and isinstance(r.waves.excitation, BoxHull)]
    if not boxes or not estimation.model.is_affine:
        return ()
    estimate = output_error_estimate(estimation)
    ways = BoxForceError.all_of(boxes[0])
    added = [added_input(w.name, [_added_inputs(estimate.problem, item, w) for item in records]) for w in ways]
    test, samples = score_test(estimate, added), int(np.isfinite(estimate.problem.data.measured).sum())
    moves, visible = -test.by_candidates[: len(estimate.problem.free)].T, np.sqrt(test.information / samples)
    return tuple(EstimatedValueShift(w.name, w.size, m, float(v)) for w, m, v in zip(ways, moves, visible, strict=True))


def box_force_findings(
    shifts: Sequence[EstimatedValueShift], coefficients: Sequence[Coefficient]
) -> tuple[Finding, ...]:
    """Return a warning `estimated-values` with the coefficients that the forces of a box leave undetermined.

    coefficients: with intervals that hold what the forces may be wrong by.
    """
    if not shifts:
        return ()
    free = [c for c in coefficients if not c.fixed]
    undetermined = [c.name for c in free if c.is_sign_open]
    lost = f"not determined by these records with such forces: {enumeration(undetermined, len(free))}"
    return (Finding(
        Severity.WARNING, ESTIMATED_VALUES, f"the wave forces are those of a box, {NOT_MEASURED}",
        lost if undetermined else "every coefficient keeps its sign where they are wrong by as much as of a hull",
        'give the hull\'s own forces: [excitation] source = "table" or "capytaine"',
        "intervals of coefficients hold what the forces may be wrong by; predictions in such waves hardly change",
    ),)  # fmt: skip


def _added_inputs(problem: OutputError, item: TrialRecord, way: BoxForceError) -> Array:
    """Return what the error adds to the inputs of a whole run, (rows, nu): nothing where its waves are not known."""
    record = item.record
    nothing = np.zeros((len(record), len(problem.model.inputs)))
    if item.waves is None or "zeta" not in record:
        return nothing
    bare = replace(record, channels={n: c for n, c in record.channels.items() if n not in _FORCES})
    forced = with_wave_forces(bare, replace(way, box=item.waves.excitation), item.waves.U, item.waves.beta)
    first = round(float(forced.time[0] - record.time[0]) / record.dt)
    columns = [problem.model.input_names.index(name) for name in _FORCES]
    nothing[first : first + len(forced), columns] = inputs_of(problem.model, forced)[:, columns]
    return nothing
