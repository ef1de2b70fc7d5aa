"""One identification: the trial's records, the choices of the user, and the estimate that strategies share."""

from dataclasses import dataclass
from functools import cached_property

from seatrial.core.results import Symmetry
from seatrial.core.values import Finding, ProgressReporter
from seatrial.data.trial import EstimateSettings, Role, Trial, TrialRecord
from seatrial.estimation.estimate import Estimation, EstimatorOptions, Runs, estimate_model
from seatrial.estimation.estimate.fit import with_segment_seconds
from seatrial.estimation.estimate.runs import training_runs
from seatrial.estimation.estimate.settings import INITIAL_STATE_SHIP_LENGTHS
from seatrial.estimation.estimate.time_scale import characteristic_time
from seatrial.estimation.identify.assumed_information import output_error_estimate
from seatrial.estimation.identify.box_scale import box_scale, stands_on_box
from seatrial.estimation.identify.sensor_errors import ErrorInformation, instrument_errors
from seatrial.estimation.information.symmetries import refuse_unidentifiable, structural_symmetries
from seatrial.estimation.problem.segments import compared_outputs
from seatrial.estimation.problem.static_forces import StaticForces


@dataclass(frozen=True, eq=False)
class Identification:
    """What every strategy of `identify` is given.

    Attributes:
        trial: ship, model and settings.
        records: all runs that are not left out, in order; findings: of the trial and of the checks on the records.
        options: intervals, seed and the like.
        choose: whether the best member of the family takes the place of the trial's model.
        began: reading of the performance counter at the start [s].
    """

    trial: Trial
    records: tuple[TrialRecord, ...]
    findings: tuple[Finding, ...]
    options: EstimatorOptions
    choose: bool
    began: float
    report_progress: ProgressReporter | None = None

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
    def characteristic_time(self) -> float:
        """Time in which the ship changes its motion [s]."""
        runs = self.runs
        return characteristic_time(self.trial.model, runs.records, runs.length, self.trial.estimate.segment_s)

    @property
    def initial_seconds(self) -> float:
        """Length of a run's beginning from which its initial state is estimated [s]."""
        return self.trial.estimate.initial_s or INITIAL_STATE_SHIP_LENGTHS * self.characteristic_time

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
        """What output error says of errors of instruments that the model does not have; None: of none."""
        estimate = output_error_estimate(self.estimation)
        return instrument_errors(estimate, self.runs.records, self.runs.length, self.settings.delays)

    @cached_property
    def estimation(self) -> Estimation:
        """The estimate of the trial's own model from the training runs, by the criterion that they call for.

        Raises:
            InputError: the outputs do not determine the free coefficients, or what `estimate_model` raises.
        """
        refuse_unidentifiable(self.trial.model, self.outputs, self._force_names)
        return estimate_model(self.trial.model, self.runs, self.settings, self.options, self.report_progress)

    @property
    def _force_names(self) -> tuple[str, ...]:
        model = self.trial.model
        return tuple(name for points in self.trial.forces for name in StaticForces(model, points).force_names)
