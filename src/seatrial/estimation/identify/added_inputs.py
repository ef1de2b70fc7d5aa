"""What inputs beside the recorded ones would do to outputs and estimate: one column more of the slopes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.values import Array
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.estimate.process_noise_interval import inverse_variances, without_initial_state
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.problem.output_error import OutputError


@dataclass(frozen=True, eq=False)
class AddedInputEffect:
    """How an estimate answers a change of its inputs, initial states eliminated.

    Attributes:
        moves: of the free coefficients, (k,), SI, to outputs that such inputs would have made.
        information: of the records on the size of the change, the fit's unknowns eliminated.
        score: of that size at none of it: slope of the log-likelihood (Rao 1948, Proc. Cambridge Phil. Soc. 44, 50-57).
    """

    moves: Array
    information: float
    score: float

    @property
    def size(self) -> float:
        """Return the size of the change that the records ask for, in one step."""
        return self.score / self.information if self.information > 0.0 else 0.0

    @property
    def standard_errors(self) -> float:
        """Return this size over its standard error by the information alone."""
        return self.score / float(np.sqrt(self.information)) if self.information > 0.0 else 0.0


def added_input_effect(estimate: PointEstimate, added: Sequence[Array], step: float = 1.0) -> AddedInputEffect:
    """Return the effect of inputs in the model's signs on top of those of each whole run, (rows, nu) each.

    step: share of them that is simulated, small where the model is not linear in its inputs.
    """
    problem, point, local = estimate.problem, estimate.common_parameters, estimate.optimum.local
    hessian, count = estimate.optimum.normal.without_local()[1], len(problem.free)
    simulated, slopes, weights = (
        problem.simulated_outputs(point, local), problem.slopes(point, local), inverse_variances(problem)
    )  # fmt: skip
    changed = _with_inputs_added(problem, [step * one for one in added])
    moved = (changed.simulated_outputs(point, local) - simulated) / step
    left = np.nan_to_num(problem.data.measured - simulated)
    pull, power, score = np.zeros(len(point)), 0.0, 0.0
    for segment in range(problem.data.count):
        rows = slice(int(problem.data.offsets[segment]), int(problem.data.offsets[segment + 1]))
        columns = problem.columns_of(int(problem.data.session[segment]))
        n = len(columns)
        wide = np.concatenate([slopes[rows][:, :, :n], moved[rows][:, :, None], slopes[rows][:, :, n:]], axis=2)
        weighted = without_initial_state(wide, n + 1, weights[rows])
        pull[columns] += np.einsum("tyk,ty->k", weighted[:, :, :n], moved[rows])
        power += float(np.sum(weighted[:, :, n] * moved[rows]))
        score += float(np.sum(weighted[:, :, n] * left[rows]))
    moves = inverse(hessian) @ pull
    return AddedInputEffect(moves[:count], max(power - float(pull @ moves), 0.0), score)


def _with_inputs_added(problem: OutputError, added: Sequence[Array]) -> OutputError:
    """Return the problem with these inputs of whole runs on top of its own."""
    data, runs = problem.data, problem.data.run_inputs
    assert runs is not None
    parts = []
    for segment, (first, start, _) in enumerate(runs.place):
        length = int(data.offsets[segment + 1] - data.offsets[segment])
        parts.append(added[int(data.run[segment])][first - start : first - start + length])
    changed = replace(runs, values=runs.values + np.concatenate(added))
    return replace(problem, data=replace(data, inputs=data.inputs + np.concatenate(parts), run_inputs=changed))
