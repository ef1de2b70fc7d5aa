"""What estimated and assumed values of a trial may be wrong by, and the coefficients that they move."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations.augment import MEMORY_PREFIX
from seatrial.core.results import Coefficient
from seatrial.core.text.numbers import percent, signed_percent, significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import NOT_MEASURED, Array, Finding, Parameter, Severity
from seatrial.data.trial import TrialRecord
from seatrial.data.trial.plausibility import ESTIMATED_VALUES
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.intervals import one_step_by_run
from seatrial.estimation.identify.characteristics import DAMPING_NAMES, RESTORING_NAMES
from seatrial.estimation.identify.identifiability import RELATIVE_CHANGE
from seatrial.estimation.identify.score_test import (
    Candidate,
    added_input,
    output_error_estimate,
    own_criterion,
    score_test,
)
from seatrial.estimation.information.covariance import excess_spread, inverse
from seatrial.estimation.problem.output_error import OutputError
from seatrial.physics.hydro.excitation import BoxForceError, BoxHull
from seatrial.physics.simulate.replay import inputs_of

# What estimated values of a trial file may be wrong by, and the coefficients and predictions that they move.

MATTERS = 1.0
"""Change of a coefficient over half its interval, and of predictions over the noise, from which a value matters: an
interval that is right but for this value would no longer hold the truth; chosen."""
_STEP = 0.01  # of such an error, of differences by it: small against the curve of outputs; chosen
_LEVER = "y_"  # begins the names of the places of thrusters across the craft
_WITH_MASS = ("I_z", "I5", "X_udot", "Y_vdot", "N_rdot")
"""What a hull that is heavier than taken has more of: estimated, it is from the same form."""
MAX_NAMED = 3
"""Values of which a warning says what they do; chosen."""


@dataclass(frozen=True, eq=False)
class EstimatedValueShift:
    """How the free coefficients move, (k,), SI, where an estimated value is too small by a share of it.

    Attributes:
        name: of the value; error: the share, a standard deviation.
        moves: of the free coefficients.
        prediction: rms change of everything compared over the training runs, over the noise.
    """

    name: str
    error: float
    moves: Array
    prediction: float


@dataclass(frozen=True)
class EstimatedValueEffect:
    """What it does to a fit that an estimated value is too small by a share of it.

    Attributes:
        name: of the value; error: the share.
        coefficient: that which moves most, over half its interval.
        relative_change: of it; NaN where its interval contains 0.
        share_of_interval: its change over half its interval.
        prediction: rms change of everything compared over the training runs, over the noise.
        is_marked: whether the trial marks it as estimated; else it stands near a formula by its prior.
    """

    name: str
    error: float
    coefficient: str
    relative_change: float
    share_of_interval: float
    prediction: float
    is_marked: bool = True

    @property
    def matters(self) -> bool:
        """Whether a coefficient leaves its interval, or predictions move by more than the noise."""
        return max(self.share_of_interval, self.prediction) >= MATTERS

    @property
    def sentence(self) -> str:
        """Return what it moves: ``m 10 % larger moves Y_v by +12 % (3.1 of half …), and predictions …``."""
        times = f"{significant(self.share_of_interval, 2)} of half its interval by the records alone"
        is_signed = math.isfinite(self.relative_change)
        how_far = f"{signed_percent(self.relative_change)} ({times})" if is_signed else times
        return (
            f"{self.name} {percent(self.error)} % larger moves {self.coefficient} by {how_far}, and predictions of the "
            f"training runs by {significant(self.prediction, 2)} of the noise"
        )


def estimated_value_shifts(estimation: Estimation) -> tuple[EstimatedValueShift, ...]:
    """Return what each estimated or assumed value does that the model holds and that is not zero.

    It is wrong by the prior that it would have if it were free, else by what such a value commonly is.
    """
    model = estimation.model
    held = {p.name: p for p in model.parameters if not p.free and p.value}
    names = [n for n, p in held.items() if p.source.startswith(NOT_MEASURED) or _spread(p) > 0.0]
    if not names:
        return ()
    groups = {name: [held[member] for member in group] for name, group in _wrong_together(names).items()}
    errors = [_spread(group[0]) or RELATIVE_CHANGE for group in groups.values()]
    candidates = [_larger(name, group, error) for (name, group), error in zip(groups.items(), errors, strict=True)]
    test, problem = score_test(own_criterion(estimation), candidates), estimation.estimate.problem
    visible = np.sqrt(test.information / np.isfinite(problem.data.measured).sum())
    moves = test.by_candidates[: len(problem.free)].T
    return tuple(map(EstimatedValueShift, test.names, errors, moves, visible.tolist()))


def _larger(name: str, group: Sequence[Parameter], error: float) -> Candidate:
    """Values that are larger by a share together, as a candidate of which 1 is that share."""

    def problem_with(problem: OutputError, size: float) -> OutputError:
        values = {p.name: (1.0 + size * error) * p.value for p in group}
        return replace(problem, model=problem.model.with_values(values))

    return Candidate(name, problem_with, _STEP)


def _spread(parameter: Parameter) -> float:
    """Standard deviation of a parameter's prior over its value, which is not zero; 0: it has none."""
    if parameter.prior is None or not math.isfinite(parameter.prior.standard_deviation):
        return 0.0
    return parameter.prior.standard_deviation / abs(parameter.value)


def _wrong_together(names: Sequence[str]) -> dict[str, list[str]]:
    """The values that are wrong together, by the name of each group: levers of thrusters, what goes with m, others.

    What goes with m is also wrong by itself.
    """
    levers = [name for name in names if name.startswith(_LEVER)]
    groups = {enumeration(levers): levers} if levers else {}
    groups |= {name: [name] for name in names if name not in levers}
    if "m" in groups:
        groups["m"] += [name for name in names if name in _WITH_MASS]
    return groups


def errors_of(shifts: Sequence[EstimatedValueShift], free: Sequence[str]) -> dict[str, float]:
    """Return the standard deviation, SI, that estimated values put into each free coefficient, by its name."""
    if not shifts:
        return {}
    return dict(zip(free, np.sqrt(np.sum([shift.moves**2 for shift in shifts], axis=0)).tolist(), strict=True))


def with_estimated_values(estimation: Estimation, shifts: Sequence[EstimatedValueShift]) -> Estimation:
    """Return the estimation whose intervals hold what estimated values may be wrong by, independently of one another.

    The covariance is of coefficients beside other values than the model's: for their intervals, not for other craft.
    """
    if not shifts:
        return estimation
    moves = np.array([shift.moves for shift in shifts])
    errors = sorted({shift.error for shift in shifts})
    shares = " or ".join(f"{percent(error)} %" for error in errors)
    names = enumeration([s.name for s in shifts])
    return estimation.widened(moves.T @ moves, f"{names} wrong by {shares} (standard deviation)")


def estimated_value_effects(
    estimation: Estimation, shifts: Sequence[EstimatedValueShift]
) -> tuple[EstimatedValueEffect, ...]:
    """Return what each estimated value does to the coefficient that it moves most; the most first."""
    free, effects = estimation.estimate.problem.free, []
    near_formulas = {p.name for p in estimation.model.parameters if p.prior and not p.source.startswith(NOT_MEASURED)}
    half = np.maximum(estimation.interval.half_width[: len(free)], 1e-300)  # above zero, for a division
    for shift in shifts:
        most = int(np.argmax(np.abs(shift.moves) / half))
        value = estimation.model.parameters[free[most]].value
        relative = float(shift.moves[most] / value) if abs(value) > half[most] else math.nan
        share = float(abs(shift.moves[most]) / half[most])
        is_marked = shift.name not in near_formulas
        effects.append(
            EstimatedValueEffect(shift.name, shift.error, free[most], relative, share, shift.prediction, is_marked)
        )
    return tuple(sorted(effects, key=lambda e: -max(e.share_of_interval, e.prediction)))


def with_effects(
    findings: Sequence[Finding], estimation: Estimation, shifts: Sequence[EstimatedValueShift]
) -> Iterator[Finding]:
    """Yield the findings of a trial, that on estimated values with what these do: a note where none matters."""
    effects = estimated_value_effects(estimation, shifts)
    for finding in findings:
        yield finding_with_effects(finding, effects) if finding.code == ESTIMATED_VALUES else finding


def finding_with_effects(finding: Finding, effects: Sequence[EstimatedValueEffect]) -> Finding:
    """Return the finding on estimated values with what these do, the worst first: a note where none matters."""
    worst = [e for e in effects if e.matters]
    if not worst:
        text = f"none of them matters much: {effects[0].sentence}" if effects else "the model itself holds none of them"
        return replace(finding, severity=Severity.INFO, evidence=text)
    rest = [e.name for e in effects if not e.matters]
    parts = [
        "; ".join(e.sentence for e in worst[:MAX_NAMED]),
        *([f"{enumeration([e.name for e in worst[MAX_NAMED:]])} too"] if len(worst) > MAX_NAMED else []),
        *([f"{enumeration(rest)} {'matter' if len(rest) > 1 else 'matters'} less"] if rest else []),
    ]
    return replace(
        finding, evidence=f"{'; '.join(parts)}; intervals of coefficients hold these errors, of predictions do not",
        advice=_advice(worst),
    )  # fmt: skip


def _advice(worst: Sequence[EstimatedValueEffect]) -> str:
    """Return what to measure first of what a trial marks; where it marks none of the worst, what to know better."""
    marked = next((e.name for e in worst if e.is_marked), "")
    if marked:
        return f"measure {marked} first, write it in place of the estimate, and remove the mark"
    return f"write a better value of {worst[0].name} under [model.fixed], if there is one"


# What the forces of a box leave open, that stand in for the wave forces of a hull: a part of every interval.

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
        "give the hull's own forces: source = \"table\" or \"capytaine\" under [excitation]",
    ),)  # fmt: skip


def _added_inputs(problem: OutputError, item: TrialRecord, way: BoxForceError) -> Array:
    """Return what the error adds to the inputs of a whole run, (rows, nu): nothing where its waves are not known."""
    record = item.record
    nothing = np.zeros((len(record), len(problem.model.inputs)))
    if item.waves is None or "zeta" not in record:
        return nothing
    from seatrial.physics.sea.wave_forces import with_wave_forces

    bare = replace(record, channels={n: c for n, c in record.channels.items() if n not in _FORCES})
    forced = with_wave_forces(bare, replace(way, box=item.waves.excitation), item.waves.U, item.waves.beta)
    first = round(float(forced.time[0] - record.time[0]) / record.dt)
    columns = [problem.model.input_names.index(name) for name in _FORCES]
    nothing[first : first + len(forced), columns] = inputs_of(problem.model, forced)[:, columns]
    return nothing


# Runs that do not share one coefficient, as of several speeds or loadings: named, and in its interval.

# probability below which a spread between runs is no chance; chosen: with some five coefficients tested
_CHANCE = 1e-3
# share of the sum of squares that values of each run leave: no less, as far as one linear step is trusted to explain
# it, and no more, or something else moves the residuals (waves, whose period a decay of its own follows); chosen
_LEAST_LEFT, _MOST_LEFT = 0.05, 0.5
_MOST_NAMED = 8  # runs that a message names; chosen


@dataclass(frozen=True, eq=False)
class DifferingRuns:
    """The coefficient in which runs differ most.

    Attributes:
        name: of it; runs, values: each run with what it says by itself, SI; spread: standard deviation between runs
            beyond their errors, SI.
    """

    name: str
    runs: tuple[str, ...]
    values: Array
    spread: float

    def shift(self, free: tuple[str, ...]) -> EstimatedValueShift:
        """Return the spread as what the coefficient of a single run differs by."""
        moves = np.where([name == self.name for name in free], self.spread, 0.0)
        return EstimatedValueShift(f"{self.name} of a run", self.spread / abs(float(np.mean(self.values))), moves, 0.0)

    def finding(self, unit: str) -> Finding:
        """Return the warning `runs-differ`."""
        each = zip(self.runs[:_MOST_NAMED], self.values[:_MOST_NAMED], strict=True)
        listed = ", ".join(f"{significant(float(value), 2)} in {run}" for run, value in each)
        return Finding(
            Severity.WARNING, "runs-differ", f"the runs do not share one {self.name}, and no single number holds",
            f"{self.name} in {unit or '1'}: {listed}",
        )  # fmt: skip


def differing_runs(estimation: Estimation) -> DifferingRuns | None:
    """Return the coefficient in which the training runs differ beyond chance; None: none, or no test of them.

    Q, the sum of squares about the weighted mean over the errors, is a chi squared where runs share one value (Cochran
    1954, Biometrics 10, 101-129). Steered ships are tested where their innovations are nearly white: what a model
    misses differs from run to run.
    """
    runs = estimation.shooting.problem.data.runs
    if len(runs) < 2:
        return None
    if not estimation.model.has_course:
        by_run = _by_decay(estimation)
    elif estimation.process_noise and estimation.has_process_noise and estimation.process_noise.test.is_nearly_white:
        by_run = _by_innovations(estimation)
    else:
        return None
    found = list[tuple[float, DifferingRuns]]()
    for name, (values, errors) in by_run.items():
        chance, spread = excess_spread(values, errors)
        found.append((chance, DifferingRuns(name, runs, values, spread)))
    chance, strongest = min(found, key=lambda pair: pair[0], default=(1.0, None))
    return strongest if chance < _CHANCE else None


def _by_decay(estimation: Estimation) -> dict[str, tuple[Array, Array]]:
    """Return damping and restoring of each decay by itself and their errors: name -> (runs,), (runs,).

    By one Gauss-Newton step from the joint estimate, with the noise left when each has values of its own: else what
    they differ by would pass for noise. None where these explain less than half of the residuals.
    """
    estimate, problem = estimation.shooting, estimation.shooting.problem
    by_run = one_step_by_run(estimate)
    squares = 2.0 * problem.cost(estimate.common_parameters, estimate.optimum.local)
    share = 1.0 - float(np.sum(by_run.decreases)) / squares
    if share > _MOST_LEFT:
        return {}
    left = np.sqrt(max(share, _LEAST_LEFT))
    columns = {n: problem.free.index(n) for n in (*DAMPING_NAMES, *RESTORING_NAMES) if n in problem.free}
    return {n: (by_run.values[:, k], left * by_run.deviations[:, k]) for n, k in columns.items()}


def _by_innovations(estimation: Estimation) -> dict[str, tuple[Array, Array]]:
    """Return each coefficient of each run and its error, the other coefficients as they are: name -> (runs,), (runs,).

    By one step on the likelihood of the run's innovations, with the unknowns of its session free.
    """
    assert estimation.process_noise is not None
    problem, point = estimation.process_noise.problem, estimation.process_noise.optimum.solution.point
    steps = problem.difference_steps(point, estimation.process_noise.optimum.normal.hessian)
    runs, count = problem.runs, len(problem.runs.free)
    blocks = replace(problem, steps=steps, is_one_sided=True).segment_normals(point)
    segments = [runs.data.run_segments(r) for r in range(len(runs.data.runs))]
    gradients = np.array([blocks.gradients[s].sum(axis=0) for s in segments])
    hessians = np.array([blocks.hessians[s].sum(axis=0) for s in segments])
    for k, hessian in enumerate(hessians):
        own = count + np.flatnonzero(np.diag(hessian)[count : count + runs.unknowns_per_session] > 0.0)
        shares = hessian[:count, own] @ inverse(hessian[np.ix_(own, own)])
        gradients[k, :count] -= shares @ gradients[k, own]
        hessians[k, :count, :count] -= shares @ hessian[own, :count]
    information = np.diagonal(hessians, axis1=1, axis2=2)[:, :count]
    with np.errstate(divide="ignore", invalid="ignore"):  # a run that says nothing of a coefficient
        values, errors = point[:count] - gradients[:, :count] / information, 1.0 / np.sqrt(information)
    names = {
        n: k for k, n in enumerate(runs.free) if n in estimation.model.parameters and not n.startswith(MEMORY_PREFIX)
    }
    return {n: (values[:, k], errors[:, k]) for n, k in names.items()}
