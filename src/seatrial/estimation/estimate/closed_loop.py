"""Was a controller on, what is declared of it, do innovations still follow its reference, and what does it cost?

Prediction error with the right disturbance is efficient in a closed loop as it stands: what a controller orders depends
on the craft through its outputs alone, which are predicted, so that neither controller nor reference enters the
likelihood (Gustavsson, Ljung & Soderstrom 1977, Automatica 13, 59, section 4). They serve as evidence: a declared loop
needs no test, innovations must not depend on a reference that does not depend on disturbances, and a controller's
orders must agree with the input.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.special import chdtrc

from seatrial.core.results.coefficients import FeedbackEvidence, WithoutDisturbance
from seatrial.core.values import Array, Record
from seatrial.data.check.inputs import FeedbackTest, feedback_tests
from seatrial.data.trial.craft_tables import Feedback
from seatrial.estimation.estimate.disturbance_choice import DisturbanceChoice
from seatrial.estimation.estimate.process_noise import ProcessNoise

# windows of 1, 1, 2, 4, ... samples after a change of the reference in which innovations may answer; chosen
_WINDOWS = 9
# longest delay of an input behind its controller's orders that is tried [s]: that of a slow steering gear; chosen
_LONGEST_DELAY = 10.0
# change from sample to sample that counts, over the range of the reference: noise of its log; chosen
_LEAST_CHANGE = 0.001
# singular values over the largest that count as zero: windows that no change ever fills; chosen
_SINGULAR = 1e-6


@dataclass(frozen=True, eq=False)
class LoopEvidence:
    """What shows that a controller was on.

    Attributes:
        records: of all runs; runs: names of those that were closed loops, by test or by declaration.
        test: the clearest test of the input; None: no test shows it.
    """

    records: tuple[Record, ...]
    runs: tuple[str, ...]
    test: FeedbackTest | None
    declared: Feedback | None

    @property
    def is_closed(self) -> bool:
        """Whether inputs follow outputs in any run."""
        return bool(self.runs)


def loop_evidence(
    records: Sequence[Record], declared: Feedback | None, stretches: Sequence[Record] | None = None
) -> LoopEvidence:
    """Return what shows a controller in these runs; stretches: of long runs, those that are tested in their place."""
    tested = records if stretches is None else stretches
    tests = {record.name: [t for t in feedback_tests(record) if t.has_feedback] for record in tested}
    runs = [r.name for r in records if declared is not None and declared.concerns(r)]
    runs += [name for name, some in tests.items() if some and name not in runs]
    of_input = [t for some in tests.values() for t in some if declared is None or t.command == declared.input]
    clearest = min(of_input, key=lambda t: (t.p, -abs(t.correlation)), default=None)
    return LoopEvidence(tuple(records), tuple(runs), clearest, declared)


def closed_loop(
    evidence: LoopEvidence, disturbances: DisturbanceChoice | None, noise: ProcessNoise | None
) -> FeedbackEvidence | None:
    """Return the loop as a fit reports it; None where there was none.

    noise: the prediction-error optimum behind the estimate; None: the estimate is output error.
    """
    test, declared, records = evidence.test, evidence.declared, evidence.records
    if not evidence.is_closed or (test is None and declared is None):
        return None
    agreement = None if declared is None else controller_agreement(declared, records)
    correlation, delay = agreement or (None, None)
    return FeedbackEvidence(
        input=declared.input if declared else test.command if test else "",
        output=declared.output if declared else test.motion if test else "",
        runs=evidence.runs,
        correlation=test.correlation if test else None,
        lag=test.lag if test else None,
        p=test.p if test else None,
        is_declared=declared is not None,
        reference=_reference_text(declared),
        reference_steps=None if declared is None else reference_steps(declared, records),
        reference_p=None if declared is None or noise is None else reference_p(declared, records, noise),
        controller_correlation=correlation,
        controller_delay=delay,
        without_disturbance=() if disturbances is None or noise is None else _without_disturbance(disturbances),
    )


def _reference_text(declared: Feedback | None) -> str:
    """Return the reference's channel or its constant, SI; empty where none is declared."""
    if declared is None or declared.reference is None:
        return ""
    return declared.reference if isinstance(declared.reference, str) else f"{declared.constant:g}"


def controller_agreement(declared: Feedback, records: Sequence[Record]) -> tuple[float, float] | None:
    """Return the largest correlation of a controller's orders with the input and its delay [s]; None: no orders."""
    pairs = [(order, r[declared.input], r.dt) for r in records if (order := declared.order_of(r)) is not None]
    if not pairs:
        return None
    dt = pairs[0][2]
    longest = min(round(_LONGEST_DELAY / dt), min(len(order) for order, _, _ in pairs) // 2)
    correlations = [_correlation([(o[: len(o) - k], u[k:]) for o, u, _ in pairs]) for k in range(longest + 1)]
    best = int(np.argmax(correlations))
    return float(correlations[best]), best * dt


def _correlation(pairs: Sequence[tuple[Array, Array]]) -> float:
    """Return the correlation of two signals over all runs, each about its mean in the run."""
    order, value = (np.concatenate([p[i] - p[i].mean() for p in pairs]) for i in range(2))
    size = float(np.linalg.norm(order) * np.linalg.norm(value))
    return float(order @ value) / size if size > 0.0 else 0.0


def reference_steps(declared: Feedback, records: Sequence[Record]) -> int | None:
    """Return how often the declared reference changes in all runs; None where none is declared."""
    references = [reference for r in records if (reference := declared.reference_of(r)) is not None]
    return sum(map(_step_count, references)) if references else None


def _step_count(reference: Array) -> int:
    """Return how many changes begin; one that lasts several samples counts once."""
    is_changing = np.abs(np.diff(reference)) > _LEAST_CHANGE * np.ptp(reference)
    return int(np.sum(is_changing & ~np.concatenate([[False], is_changing[:-1]])))


def reference_p(declared: Feedback, records: Sequence[Record], noise: ProcessNoise) -> float | None:
    """Return the p-value that innovations do not depend on earlier changes of the reference, over all channels.

    A reference does not depend on disturbances, so that the innovations of a true model are independent of it whatever
    the controller does (Ljung 1999, section 16.6). They are regressed on its changes in windows that double in length;
    the sum of squares that these explain of white innovations is chi squared. None: no change, or long records that are
    filtered in pieces.
    """
    columns = [_windows(declared.reference_of(record), len(record)) for record in records]
    innovations = noise.problem.innovations(noise.optimum.solution.point).normalised
    if sum(map(len, columns)) != len(innovations):
        return None
    features = np.concatenate(columns)
    p_values = []
    for channel in innovations.T:
        is_measured = np.isfinite(channel)
        u, size, _ = np.linalg.svd(features[is_measured], full_matrices=False)
        u = u[:, size > _SINGULAR * np.max(size, initial=0.0)]
        if u.shape[1]:
            p_values.append(float(chdtrc(u.shape[1], np.sum((u.T @ channel[is_measured]) ** 2))))
    return min(1.0, len(p_values) * min(p_values)) if p_values else None


def _windows(reference: Array | None, rows: int) -> Array:
    """Return sums of the reference's changes over windows that end 1, 2, 4, 8, ... samples before, (rows, windows)."""
    total = np.zeros(rows) if reference is None else reference - reference[0]
    edges = [0, *(2**k for k in range(_WINDOWS))]
    delayed = [np.concatenate([np.zeros(min(e, rows)), total[: max(rows - e, 0)]]) for e in edges]
    return np.stack([near - far for near, far in pairwise(delayed)], axis=1)


def _without_disturbance(disturbances: DisturbanceChoice) -> tuple[WithoutDisturbance, ...]:
    """Return the coefficients of the candidate without a disturbance next to the chosen one's."""
    plain, chosen = disturbances.fitted[0].noise, disturbances.chosen.noise
    free = plain.output_error.free
    errors, errors_chosen = plain.interval.standard_error, chosen.interval.standard_error
    away = plain.common_parameters - chosen.common_parameters
    return tuple(
        WithoutDisturbance(
            name, float(plain.common_parameters[i]), float(errors[i]), float(away[i] / errors_chosen[i]),
            float(errors_chosen[i] / errors[i]),
        )
        for i, name in enumerate(free)
    )  # fmt: skip
