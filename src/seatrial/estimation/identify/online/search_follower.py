"""A stream followed by a published search sample by sample, with the package's own follower on the same samples."""

from dataclasses import replace

import numpy as np

from seatrial.core.results import Fit, Search, SearchRestart, SearchTrack
from seatrial.core.results.online import Sample, Snapshot
from seatrial.core.values import Array, InputError, Record
from seatrial.data.trial import EstimateMethod, Role, SearchFitness, SearchSettings, Trial
from seatrial.data.trial.runs import require_stream
from seatrial.estimation.identify.online.estimator import OnlineEstimator
from seatrial.estimation.identify.search import (
    PublishedEstimate,
    search_box,
    search_budget,
    search_candidates,
    search_findings,
    search_method_text,
    simulated_starts,
    training_predictions,
)
from seatrial.estimation.search import Candidates, SampleSearch
from seatrial.numerics.optimise import SEARCH_METHODS
from seatrial.physics.simulate import initial_state

# s of a stream between two times at which samples are processed; chosen: as often as the package's own follower
_BLOCK_S = 5.0


class SearchFollower:
    """Feed with `update`; the same samples give the same bits.

    Each sample of the stream's first run is an iteration of the search that the trial names, until its iterations are
    spent. Samples are processed in blocks, those in waves somewhat late: forces follow from the elevation before and
    after, so that the record of each block may begin somewhat sooner or later than the one before.

    Raises:
        InputError: the method is no search, judges by whole records, or lacks bounds; what `OnlineEstimator` raises.
    """

    def __init__(self, trial: Trial, seed: int) -> None:
        self._method, self._settings = _sample_settings(trial)
        self._trial, self._seed = trial, seed
        self._box = search_box(trial.model, self._method, self._settings)
        self._budget = search_budget(self._method, self._settings, self._box.size)
        create = SEARCH_METHODS[self._method].within(self._budget)
        self._search = SampleSearch(create(self._box, np.random.default_rng([seed, 0])))
        self._follower = OnlineEstimator(own_trial(trial))
        self._place = len(trial.runs_with_role(Role.TRAIN))
        self._first_sample_s: float | None = None
        self._begin_s = 0.0
        self._record: Record | None = None
        self._start: Array | None = None
        self._weights: dict[str, float] | None = None
        self._candidates: Candidates | None = None
        self._follower_values: list[Array] = []
        self._follower_states: list[Array] = []
        self._due = _BLOCK_S

    def begin_run(self) -> None:
        """Begin a new run with the next sample.

        Raises:
            InputError: the run that ends cannot be used.
        """
        self._follower.begin_run()

    def update(self, sample: Sample) -> Snapshot:
        """Take in one sample, later than the last, and return the estimate by now."""
        snapshot = self._follower.update(sample)
        self._first_sample_s = sample.time if self._first_sample_s is None else self._first_sample_s
        self._follower_values.append(snapshot.value)
        seconds = len(self._follower_values) / require_stream(self._trial).rate
        if seconds >= self._due:
            self._due = seconds + _BLOCK_S
            self._process()
        return self._with_search_values(snapshot)

    def relinearise(self) -> Snapshot:
        """Process all samples that wait, and return the estimate by now."""
        snapshot = self._follower.relinearise()
        self._process()
        return self._with_search_values(snapshot)

    def estimate(self, reference: Fit) -> PublishedEstimate:
        """Return what the search has found, and how it and the package's own follower tracked the motion.

        Raises:
            InputError: the stream ended before any sample was processed.
        """
        candidates = self._candidates
        if candidates is None or not self._search.step_count:
            raise InputError(f"method '{self._method}' has seen no sample: the stream is shorter than {_BLOCK_S:g} s")
        names = self._trial.model.parameters.free_names
        finished = self._search.finished(self._seed)
        points = np.array([finished.solution.point, [reference.model.parameters[name].value for name in names]])
        runs = training_predictions(reference)
        starts = simulated_starts(self._trial.model, runs)
        whole = search_candidates(self._trial, self._trial.model, [p.measured for p in runs], starts, self._weights)
        level, own_level = map(float, whole.record_rms(points))
        restart = SearchRestart(_named(names, points[0]), level, finished.solution.evaluations, finished.cpu_s,
                                finished.solution.history)  # fmt: skip
        track = self._track(candidates)
        iterations = len(finished.solution.history)
        search = Search(
            fitness=self._settings.fitness.value, population=self._budget.population,
            iterations=self._budget.iterations,
            bounds={n: (float(a), float(b)) for n, a, b in zip(names, self._box.lower, self._box.upper, strict=True)},
            weights=dict(zip(candidates.output_names, map(float, candidates.sigma), strict=True)),
            evaluations=restart.evaluations, cpu_s=restart.cpu_s, history=restart.history, used=0, restarts=(restart,),
            trace={n: tuple(map(float, values[:iterations])) for n, values in track.values.items()},
            reference_trace={n: tuple(map(float, v[:iterations])) for n, v in track.reference_values.items()},
            track=track,
        )  # fmt: skip
        return PublishedEstimate(
            finished.solution,
            search_method_text(self._method, self._settings, search),
            search_findings(search, finished.solution.point, 1),
            search,
            own_level,
        )

    def _process(self) -> None:
        """Process the samples that are known by now."""
        record = self._first_run()
        if record is None:
            return
        model = self._trial.model
        if self._start is None:
            self._begin_s, self._start = float(record.time[0]), initial_state(model, record, {})
        record = record.between(self._begin_s, float(record.time[-1]))
        first_step = round((float(record.time[0]) - self._begin_s) / record.dt)
        if first_step > self._search.step_count:
            return
        candidates = search_candidates(self._trial, model, [record], [self._start], self._weights)
        self._weights = dict(zip(candidates.output_names, map(float, candidates.sigma), strict=True))
        self._candidates, self._record = candidates, record
        self._search.process(candidates, first_step)
        self._carry_follower(candidates, first_step)

    def _first_run(self) -> Record | None:
        """The stream's first run as it is known by now; None where it is too short, or no longer kept."""
        try:
            records = self._follower.records()
        except InputError:
            return None
        return records[self._place] if len(records) > self._place else None

    def _carry_follower(self, candidates: Candidates, first_step: int) -> None:
        """The motion as the package's own follower would have tracked it."""
        for step in range(len(self._follower_states) - first_step, candidates.step_count):
            state = candidates.given_state(step)
            if state is None:
                before = self._value_at(first_step + step - 1)
                state = candidates.advanced_state(before, step - 1, self._follower_states[-1])
            self._follower_states.append(state)

    def _value_at(self, step: int) -> Array:
        """What the package's own follower had at a step of the record, which may be resampled."""
        record, began = self._record, self._first_sample_s
        assert record is not None and began is not None
        sample = round((self._begin_s - began + step * record.dt) * require_stream(self._trial).rate)
        return self._follower_values[min(sample, len(self._follower_values) - 1)]

    def _track(self, candidates: Candidates) -> SearchTrack:
        record = self._record
        assert record is not None
        count, names, states = (
            self._search.step_count,
            self._trial.model.parameters.free_names,
            self._trial.model.states,
        )
        outputs = [name for name in candidates.output_names if name in states]
        columns = [states.index(name) for name in outputs]
        time: Array = self._begin_s + np.arange(float(count)) * record.dt
        own_values = np.array([self._value_at(step) for step in range(count)])
        return SearchTrack(
            time,
            {name: np.interp(time, record.time, record[name], left=np.nan) for name in outputs},
            dict(zip(outputs, self._search.tracked_states[:, columns].T, strict=True)),
            dict(zip(outputs, np.array(self._follower_states)[:, columns].T, strict=True)),
            dict(zip(names, self._search.trace.T, strict=True)),
            dict(zip(names, own_values.T, strict=True)),
        )

    def _with_search_values(self, snapshot: Snapshot) -> Snapshot:
        """The present coefficients of the search, which has no standard errors."""
        if not self._search.step_count:
            return snapshot
        done = min(self._search.step_count, self._budget.iterations)
        text = f"method {self._method}: iteration {done} of {self._budget.iterations}; it gives no standard errors"
        unknown = np.full(len(snapshot.names), np.inf)
        return replace(snapshot, value=self._search.best, standard_error=unknown, unidentified=(), advice=text,
                       change=None)  # fmt: skip


def own_trial(trial: Trial) -> Trial:
    """Return the trial with the package's own estimate in place of a published method."""
    return replace(trial, estimate=replace(trial.estimate, method=EstimateMethod.AUTO, search=None))


def _sample_settings(trial: Trial) -> tuple[EstimateMethod, SearchSettings]:
    """Method and settings of a search that follows a stream.

    Raises:
        InputError: the method is no search, or judges by whole records.
    """
    method, settings = trial.estimate.method, trial.estimate.search
    if not method.is_search:
        raise InputError(f"method '{method}' cannot follow a stream; name a search such as iwho, or leave the method")
    if settings is None:
        return method, SearchSettings(fitness=SearchFitness.SAMPLE, restarts=1)
    if settings.fitness is SearchFitness.RECORD:
        raise InputError('a stream is searched sample by sample; write fitness = "sample" under [estimate.search]')
    return method, settings


def _named(names: tuple[str, ...], values: Array) -> dict[str, float]:
    return dict(zip(names, map(float, values), strict=True))
