"""One identification: records, choices of the user, the estimate, and the errors of instruments that it confirms."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Symmetry
from seatrial.core.text.numbers import significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, Finding, InputError, Parameters, ProgressReporter, Record, Severity
from seatrial.core.values.arrays import BETWEEN, Between
from seatrial.data.check.phases import is_free_decay
from seatrial.data.trial import EstimateSettings, Role, RunFiles, Trial, TrialRecord
from seatrial.estimation.estimate import (
    Beginning,
    Estimation,
    EstimatorOptions,
    Runs,
    begin_estimate,
    estimate_model,
)
from seatrial.estimation.estimate.assemble import UNIFORM, is_course_open, training_runs
from seatrial.estimation.estimate.criterion_choice import WAVE_FORCES
from seatrial.estimation.estimate.fit import moving_inputs, with_segment_seconds
from seatrial.estimation.estimate.intervals import estimate_uncertainty
from seatrial.estimation.estimate.newton_refinement import approach_by_gradient
from seatrial.estimation.estimate.point_estimate import PointEstimate, residual_correlation
from seatrial.estimation.estimate.process_noise import ProcessNoise
from seatrial.estimation.estimate.settings import INITIAL_STATE_SHIP_LENGTHS, resolved_time
from seatrial.estimation.identify.identifiability import box_scale, stands_on_box
from seatrial.estimation.identify.instruments import ErrorInformation, Suspect, detected_errors, instrument_errors
from seatrial.estimation.identify.score_test import own_criterion
from seatrial.estimation.identify.terms import standard_error_ratio
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.information.symmetries import refuse_unidentifiable, structural_symmetries
from seatrial.estimation.problem.output_error import Nuisance, OutputError
from seatrial.estimation.problem.segments import compared_outputs
from seatrial.estimation.problem.static_forces import StaticForces
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.physics.sensors import Sensors, with_sensors
from seatrial.physics.sensors.measured_outputs import lag_name, with_timed_receiver, without_sensors
from seatrial.physics.sensors.settings import Late

# What the records of a trial are: by it `identify` picks its strategy.

WAVE_SLOPE = "alpha_w"
"""The input by which waves drive roll."""


class Situation(StrEnum):
    """What moves the ship in the records, and how that is known."""

    STEERED = "steered"
    STATIC_FORCES = "steered, with static force points"
    RECORDED_WAVES = "in waves, forces or elevation recorded"
    WAVE_SPECTRUM = "in waves of which only the spectrum is known"
    UNKNOWN_WAVES = "rolling in waves of which nothing is known"
    FREE_DECAY = "rolling out from a release"
    DRIVEN_ROLL = "rolling by recorded inputs"


def situation_of(
    model: Model,
    runs: Sequence[TrialRecord],
    *,
    has_force_points: bool,
    is_criterion_free: bool,
    is_explained: Callable[[], bool],
) -> Situation:
    """Return the situation of training runs.

    Args:
        has_force_points: whether static force points are fitted with the runs.
        is_criterion_free: whether the criterion is left to the decision table.
        is_explained: whether the initial states explain the motion; called for roll without any input only. Roll
            that dies out from a release is a decay even so: one that was held, or several that no one model has.
    """
    if any(run.waves is not None and run.waves.spectrum is not None for run in runs):
        return Situation.WAVE_SPECTRUM
    if model.is_affine or set(WAVE_FORCES) & set(model.input_names):
        return Situation.RECORDED_WAVES
    if model.has_course:
        return Situation.STATIC_FORCES if has_force_points else Situation.STEERED
    if not is_unforced_roll(model, [run.record for run in runs]):
        return Situation.DRIVEN_ROLL
    if is_explained() or all(is_free_decay(run.record) for run in runs):
        return Situation.FREE_DECAY
    return Situation.UNKNOWN_WAVES if is_criterion_free else Situation.DRIVEN_ROLL


def is_unforced_roll(model: Model, records: Sequence[Record]) -> bool:
    """Return whether all records hold the roll of a model that waves can drive, and no input of it moves."""
    if model.has_course or WAVE_SLOPE not in model.input_names or not all("phi" in r for r in records):
        return False
    return not moving_inputs(model, records)


# One identification: the trial's records, the choices of the user, and the estimate that strategies share.


@dataclass(frozen=True, eq=False)
class InputStep:
    """One step of held inputs, which a training run shows at a row.

    Attributes:
        size: of each input, in the model's signs, (nu,).
        share: of the sample before that row in which the step was there already, 0 to 1.
    """

    run: int
    row: int
    size: Array
    share: float


@dataclass(frozen=True, eq=False)
class Identification:
    """What every strategy of `identify` is given.

    Attributes:
        trial: ship, model and settings.
        records: all runs that are not left out, in order; findings: of the trial and of the checks on the records.
        options: intervals, seed and the like.
        choose: whether the best member of the family takes the place of the trial's model.
        began: reading of the performance counter at the start [s].
        steps: of inputs of the training runs whose times within a sample are estimated.
        near: the beginning of the same runs, of which inputs or instruments were taken otherwise; None: there is none.
    """

    trial: Trial
    records: tuple[TrialRecord, ...]
    findings: tuple[Finding, ...]
    options: EstimatorOptions
    choose: bool
    began: float
    report_progress: ProgressReporter | None = None
    steps: tuple[InputStep, ...] = ()
    near: Beginning | None = None

    @cached_property
    def train(self) -> tuple[TrialRecord, ...]:
        """The training runs."""
        return tuple(r for r in self.records if r.role is Role.TRAIN)

    @cached_property
    def runs(self) -> Runs:
        """The training runs as data of an estimate."""
        return training_runs(self.trial, self.records)

    @cached_property
    def settings(self) -> EstimateSettings:
        """The trial's settings, segments in seconds."""
        return with_segment_seconds(self.trial.estimate, self.trial.model, self.runs)

    @cached_property
    def resolved_time(self) -> float:
        """Time in which the records show how the ship changes its motion [s]."""
        runs = self.runs
        return resolved_time(self.trial.model, runs.records, runs.length, self.trial.estimate.segment_s)

    @property
    def initial_seconds(self) -> float:
        """Length of a run's beginning from which its initial state is estimated [s]."""
        return self.trial.estimate.initial_s or INITIAL_STATE_SHIP_LENGTHS * self.resolved_time

    @cached_property
    def outputs(self) -> tuple[str, ...]:
        """Observables that are compared."""
        return compared_outputs(self.trial.model, self.runs.records, self.settings.channels)

    @cached_property
    def symmetries(self) -> tuple[Symmetry, ...]:
        """Changes of parameters that no record of these outputs can show."""
        found = structural_symmetries(self.trial.model, self.outputs, self._force_names)
        scale = box_scale(self.trial.model) if stands_on_box(self.trial) else None
        together = scale.symmetry(self.trial.model, self.outputs) if scale else None
        return (*found, *([together] if together else ()))

    @cached_property
    def instrument_errors(self) -> ErrorInformation | None:
        """What output error over segments says of errors of instruments that the model does not have; None: of none."""
        estimate = self.beginning.shooting
        return instrument_errors(estimate, self.runs.records, self.antenna_length, self.settings.delays)

    @property
    def antenna_length(self) -> float | None:
        """Length [m] of the ship along which an antenna may stand; None: the trial states where it stands."""
        is_stated = any(isinstance(run.data, RunFiles) and run.data.states_antenna for run in self.trial.runs)
        return None if is_stated else self.runs.length

    @cached_property
    def beginning(self) -> Beginning:
        """The estimate of the trial's own model over segments, from which every criterion begins.

        Raises:
            InputError: the outputs do not determine the free coefficients, or what `begin_estimate` raises.
        """
        refuse_unidentifiable(self.trial.model, self.outputs, self._force_names)
        return begin_estimate(
            self.trial.model, self.runs, self.settings, self.options, self.report_progress, near=self.near
        )

    @cached_property
    def estimation(self) -> Estimation:
        """The estimate of the trial's own model from the training runs, by the criterion that they call for.

        Raises:
            InputError: what `beginning` or `estimate_model` raises.
        """
        return estimate_model(
            self.trial.model, self.runs, self.settings, self.options, self.report_progress, beginning=self.beginning
        )

    @property
    def _force_names(self) -> tuple[str, ...]:
        model = self.trial.model
        return tuple(name for points in self.trial.forces for name in StaticForces(model, points).force_names)


# A task whose inputs run between samples as their delays say, where no record does.

_NEARER = 0.25  # of a sample: a delay by more is nearer to that of the other course than to none
_COURSE_STEPS = 6  # of a search by the gradient with the other course, which begins close to its optimum; chosen


def with_likelier_courses(task: Identification) -> Identification:
    """Return the task with inputs straight between samples that were taken as held, or held that were straight.

    Held values come half a sample after straight lines, so that a delay by nearly as much speaks for the other course.
    It is taken where the records are likelier with it, by the criterion and the noise of the task's own estimate.
    """
    if not _open_courses(task.beginning.shooting.problem, task.runs.records):
        return task
    courses = _courses_by_delay(task.estimation.estimate, task.runs.records)
    if not courses or not _are_likelier(own_criterion(task.estimation), courses):
        return task
    records = tuple(replace(r, record=_with_courses(r.record, courses)) for r in task.records)
    others = tuple(f for f in task.findings if f.code != "stepped-input")
    return replace(task, records=records, findings=(*others, _course_finding(courses)), near=task.beginning)


def _with_courses(record: Record, courses: Mapping[str, Between]) -> Record:
    for name in courses.keys() & record.channels.keys():
        record = record.with_channel(name, replace(record.channel(name), between=courses[name]))
    return record


def _course_finding(courses: Mapping[str, Between]) -> Finding:
    """The note on inputs whose delay says how they run between samples."""
    names = {way: [n for n, course in courses.items() if course == way] for way in BETWEEN}
    texts = [f"{enumeration(some, len(some))} {way}" for way, some in names.items() if some]
    return Finding(
        Severity.INFO, "stepped-input", f"between samples the records show {' and '.join(texts)}",
        "the other way the records are less likely, and half a sample is left as a delay",
        "declare between where you know it",
    )  # fmt: skip


def _open_courses(problem: OutputError, records: Sequence[Record]) -> dict[int, Nuisance]:
    """Delays of inputs of which the records do not say how they run between samples: column of a session -> delay."""
    return {
        j: nuisance
        for j, nuisance in enumerate(problem.nuisances, start=len(problem.session_parameters))
        if nuisance.correction.kind == "delay" and nuisance.is_spread_fixed
        and is_course_open(nuisance.correction.input, records)
    }  # fmt: skip


def _courses_by_delay(estimate: PointEstimate, records: Sequence[Record]) -> dict[str, Between]:
    """How inputs would run between samples by their delays, mean of all sessions: those whose records leave it open."""
    problem, courses = estimate.problem, dict[str, Between]()
    for j, nuisance in _open_courses(problem, records).items():
        name, sample = nuisance.correction.input, UNIFORM * nuisance.prior.standard_deviation
        late, is_held = float(np.mean(estimate.session_offsets[:, j])), name in problem.model.held
        if (-late if is_held else late) > _NEARER * sample:
            courses[name] = "straight" if is_held else "held"
    return courses


def _are_likelier(estimate: PointEstimate | ProcessNoise, courses: Mapping[str, Between]) -> bool:
    """Whether the criterion of an estimate is less with these courses, where a search from its optimum leads."""
    runs = estimate.problem.runs if isinstance(estimate, ProcessNoise) else estimate.problem
    point = estimate.optimum.solution.point.copy()
    own = point[len(runs.free) : runs.size].reshape(-1, runs.unknowns_per_session)
    for j, nuisance in enumerate(runs.nuisances, start=len(runs.session_parameters)):
        if (course := courses.get(nuisance.correction.input)) and nuisance.correction.kind == "delay":
            half = 0.5 * UNIFORM * nuisance.prior.standard_deviation
            own[:, j] += half if course == "straight" else -half
    held = {n for n in runs.model.input_names if courses.get(n, "held" if n in runs.model.held else "") == "held"}
    changed = replace(runs, model=runs.model.with_held(held))
    if isinstance(estimate, ProcessNoise):
        optimum, _ = approach_by_gradient(replace(estimate.problem, runs=changed), point, _COURSE_STEPS)
    else:
        optimum = levenberg_marquardt(changed, point, estimate.optimum.local)
    return optimum.solution.value < estimate.optimum.solution.value


# A task whose model has the errors of instruments that its records show, which the estimate with them confirms.


def with_detected_sensor_errors(task: Identification) -> tuple[Identification, tuple[Suspect, ...]]:
    """Return the task with errors of instruments that its records show as coefficients of its model, and which.

    The task itself and nothing where they show none, or none that the estimate with it confirms. They are sought beside
    the estimate over segments, and judged by what model error adds to the standard errors of the estimate with them.
    """
    try:
        information = task.instrument_errors
        detected = detected_errors(information, _model_error(task.beginning.shooting)) if information else []
        while information and detected:
            tried = _with_errors(task, detected)
            is_confirmed = _are_confirmed(tried.estimation, detected)
            certain = detected_errors(information, standard_error_ratio(tried.estimation))
            if is_confirmed and len(certain) == len(detected):
                return tried, tuple(detected)
            detected = certain if len(certain) < len(detected) else []
    except (ArithmeticError, np.linalg.LinAlgError, InputError):  # with them nothing is determined: without them
        return task, ()
    return task, ()


def _model_error(estimate: PointEstimate) -> float:
    """What the runs of an estimate add to standard errors of its information, by runs or segments left out: a ratio."""
    inflation, count = residual_correlation(estimate.problem, estimate.residuals())[1], len(estimate.problem.free)
    deviations = estimate_uncertainty(estimate, inflation).interval.standard_error[:count]
    information = inverse(estimate.optimum.normal.without_local()[1])[:count, :count]
    return max(1.0, float(np.median(deviations / np.sqrt(np.diag(information)))))


def _with_errors(task: Identification, detected: Sequence[Suspect]) -> Identification:
    """The task whose model has the errors of these instruments."""
    stated = _stated(task)
    for one in detected:
        stated = one.stated(stated)
    return with_timed_readings(_with_sensors(task, stated))


def _stated(task: Identification) -> Sensors:
    return Sensors.from_text(task.trial.model.equations.sensors)


def _with_sensors(task: Identification, stated: Sensors) -> Identification:
    """The task whose model has these sensors, and whose records have a receiver's readings moved by its lag there."""
    before, name = _stated(task).late.get(Late.RECEIVER, 0.0), lag_name(Late.RECEIVER)
    lag, model = stated.late.get(Late.RECEIVER, 0.0), _with_stated(task.trial.model, stated)
    if lag != before:
        model = model.with_values({name: lag})
    records = tuple(replace(r, record=with_timed_receiver(r.record, stated, lag - before)) for r in task.records)
    return replace(task, trial=replace(task.trial, model=model), records=records, near=task.beginning)


def _with_stated(model: Model, stated: Sensors) -> Model:
    """The model with these sensors; coefficients that it has already keep their values, bounds and priors."""
    wider = with_sensors(without_sensors(model), stated)
    present = {p.name: p for p in model.parameters}
    return wider.with_parameters(Parameters(tuple(present.get(p.name, p) for p in wider.parameters)))


_LAG_DIGITS = 9  # of a start value as a trial states it: beyond, it is rounding
_MOST_MOVES = 4  # of a receiver's readings: a lag that ends within half a sample needs one or two; chosen


def with_timed_readings(task: Identification) -> Identification:
    """Return the task with a receiver's readings moved until what is left of its lag is within half a sample.

    Outputs have what is left as a term of first order, which a longer lag of a craft that turns fast is not.
    """
    for _ in range(_MOST_MOVES):
        stated = _stated(task)
        if Late.RECEIVER not in stated.late or not task.runs.records:
            return task
        name, dt = lag_name(Late.RECEIVER), task.runs.records[0].dt
        free, lag = task.beginning.shooting.problem.free, task.trial.model.parameters[name].value
        if name in free:
            lag = float(task.beginning.shooting.common_parameters[free.index(name)])
        start = float(f"{round(lag / dt) * dt:.{_LAG_DIGITS}g}")
        if start == stated.late[Late.RECEIVER]:
            return task
        task = _with_sensors(task, replace(stated, late={**stated.late, Late.RECEIVER: start}))
    return task


def with_sensors_of(task: Identification, other: Identification) -> Identification:
    """Return the task with the sensors of another of the same records."""
    return _with_sensors(task, _stated(other))


def _sizes(estimation: Estimation) -> tuple[dict[str, float], dict[str, float]]:
    """Coefficients and their standard errors by name."""
    free, values = estimation.estimate.problem.free, estimation.estimate.common_parameters.tolist()
    errors = estimation.interval.standard_error.tolist()
    return dict(zip(free, values, strict=False)), dict(zip(free, errors, strict=False))


def _are_confirmed(estimation: Estimation, detected: Sequence[Suspect]) -> bool:
    """Whether no error of one of these instruments may be negligible."""
    values, spread = _sizes(estimation)
    return all(suspect.matters(values, spread) for suspect in detected)


def sensor_error_finding(estimation: Estimation, detected: Sequence[Suspect]) -> Finding:
    """Return the warning `sensor-error` on errors of instruments that the estimate's model has."""
    values, spread = _sizes(estimation)
    sizes = [
        f"{e.name} {significant(values[e.name], 3)} {e.unit} (standard error {significant(spread[e.name], 2)})"
        for one in detected for e in one.errors
    ]  # fmt: skip
    stated, names = Sensors.from_text(estimation.model.equations.sensors), [s.text(values) for s in detected]
    lines = "; ".join(stated.line(key) for key in dict.fromkeys(suspect.key for suspect in detected))
    return Finding(
        Severity.WARNING, "sensor-error",
        f"the records show errors of instruments, which are estimated: {enumeration(names)}",
        "; ".join(sizes).replace(" 1 (", " ("),
        f"state what is so under [sensors] ({lines}), and correct in the log what is not",
    )  # fmt: skip
