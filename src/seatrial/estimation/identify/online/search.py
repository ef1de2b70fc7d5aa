"""How the window's estimate is found: by continued output error over whole runs, or by `identify` anew each time."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from seatrial.core.values import Record
from seatrial.data.trial import FitCriterion, Trial
from seatrial.estimation.estimate.fit import estimate_model, with_segment_seconds
from seatrial.estimation.estimate.online.window import (
    WindowEstimate,
    better_estimate,
    cold_start,
    refuse_diverging,
    warm_start,
)
from seatrial.estimation.estimate.runs import Runs
from seatrial.estimation.estimate.time_scale import is_pure_roll
from seatrial.estimation.identify.online.phases import Carried, KeptPhase, WarmUp
from seatrial.estimation.identify.online.schedule import SearchSchedule

# s of samples within which a search from nowhere accompanies the one from the last optimum, which may be a local one;
# later where residuals are correlated, or where their rms over that of the last estimate exceeds this ratio
_FIRST_SECONDS, _MISFIT_GROWTH = 60.0, 1.2


class WindowSearch(Protocol):
    """One way to find the estimate of what is kept."""

    @property
    def is_efficient(self) -> bool:
        """Whether all estimates minimise one criterion over whole runs.

        Only then can a filter take over, and successive estimates be tested for a change.
        """
        ...

    def estimate(self, phase: KeptPhase, records: Sequence[Record]) -> WindowEstimate:
        """Return the estimate from the records and from what the phase carries.

        Raises:
            InputError: the records cannot be fitted.
        """
        ...


@dataclass(frozen=True, eq=False)
class ContinuedSearch:
    """Output error over whole runs, from the last optimum; `schedule` says when to check it by one from nowhere.

    When inputs took effect counts as known, unless the trial names their delays.
    """

    trial: Trial
    schedule: SearchSchedule
    is_efficient: bool = True

    def estimate(self, phase: KeptPhase, records: Sequence[Record]) -> WindowEstimate:
        """As `WindowSearch.estimate`."""
        model, runs = self.trial.model, _runs(self.trial, phase, records)
        # a delay that is estimated has no place in the filter that takes over between searches
        known = self.trial.estimate.with_known_timing(model.input_names)
        settings = with_segment_seconds(known, model, runs)
        warm = None
        if not isinstance(phase, WarmUp):
            warm = warm_start(phase.estimate, model, runs, settings)
            if isinstance(phase, Carried) or not self._needs_cold_check(warm, phase.estimate):
                return warm
        self.schedule.note_cold_start()
        cold = cold_start(model, runs, settings)
        return cold if warm is None else better_estimate(warm, cold)

    def _needs_cold_check(self, warm: WindowEstimate, previous: WindowEstimate) -> bool:
        """Whether the optimum found from the last one may be a local one, and the last check was long enough ago."""
        seconds = self.schedule.last_search
        is_doubtful = seconds < _FIRST_SECONDS or warm.is_coloured or warm.misfit > _MISFIT_GROWTH * previous.misfit
        return is_doubtful and seconds >= self.schedule.next_cold_start


@dataclass(frozen=True, eq=False)
class RepeatedSearch:
    """The fit that `identify` makes, from nowhere each time."""

    trial: Trial
    is_efficient: bool = False

    def estimate(self, phase: KeptPhase, records: Sequence[Record]) -> WindowEstimate:
        """As `WindowSearch.estimate`; also refuses an estimate at which whole runs diverge."""
        model, runs = self.trial.model, _runs(self.trial, phase, records)
        settings = with_segment_seconds(self.trial.estimate, model, runs)
        if isinstance(phase, Carried):  # carried information holds about that point
            model = model.with_parameters(model.parameters.with_free_values(phase.estimate.value))
        estimation = estimate_model(model, runs, settings)
        point, covariance = estimation.estimate, estimation.interval.covariance
        refuse_diverging(point, runs, settings)
        if isinstance(phase, Carried):
            covariance = phase.inflated_covariance(point.optimum.normal.without_local()[1], point.problem.priors[1])
        count = len(point.problem.free)
        return WindowEstimate(point, estimation.residuals, covariance[:count, :count], estimation.inflation)


def suits_whole_runs(trial: Trial) -> bool:
    """Return whether the trial's criterion is output error over whole runs, so that a search can be continued."""
    wishes, model = trial.estimate, trial.model
    is_output_error = wishes.criterion in (FitCriterion.AUTO, FitCriterion.OUTPUT_ERROR)
    return is_output_error and wishes.segment_s is None and (model.is_affine or is_pure_roll(model))


def _runs(trial: Trial, phase: KeptPhase, records: Sequence[Record]) -> Runs:
    """The records, each a session, and beside them the trial's static forces or the carried information with them."""
    runs = replace(Runs.one_session_each(records, trial.ship.length), noise=trial.noise)
    if isinstance(phase, Carried):  # with it go the correlations of priors
        return replace(runs, carried=(phase.prior,))
    return replace(runs, forces=trial.forces, joint_priors=trial.joint_priors)
