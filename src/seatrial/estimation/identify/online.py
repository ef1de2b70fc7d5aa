"""One estimator fed sample by sample: the criterion of `identify` over a growing window, then over what it carries on.

While the window lasts (`Stream.whole`) every re-linearisation goes over all samples, so that the numbers are those of
the batch fit. Beyond it a recursive filter carries the same information on (`Onward`). Where a filter cannot take over
(nuisances, waves from an elevation, segments, a new run) the window's normal equations are kept instead of its samples
(`Carried`), and further stretches are added one by one.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from seatrial.core.results.online import Change, Phase, Sample, Snapshot
from seatrial.core.values import Array, InputError, Record
from seatrial.data.read.assemble import as_declared
from seatrial.data.trial import Role, Run, Trial
from seatrial.data.trial.follow_table import followed
from seatrial.data.trial.records import checked
from seatrial.estimation.estimate.fit import identified, swings
from seatrial.estimation.estimate.online.carried import Carried, carried
from seatrial.estimation.estimate.online.change import Watch
from seatrial.estimation.estimate.online.rows import Rows
from seatrial.estimation.estimate.online.window import Known, begun, better, grown, refuse_unsailed
from seatrial.estimation.estimate.settings import Criterion, Settings
from seatrial.estimation.identify.identify import settings_of
from seatrial.estimation.identify.onward import LOOKS, Onward
from seatrial.estimation.information.covariance import inverse

# samples before the first search
_FEWEST = 30
# s between searches from where the last one ended: at least, and as a share of what the window has beyond the first
_STEP, _FIRST, _SHARE = 2.5, 60.0, 0.15
# s between searches from nowhere: at least, and as a share of the window
_COLD_STEP, _COLD_SHARE = 10.0, 0.25
# share of the window that is news when a run ends, from which on a search is made then
_NEWS = 0.1
_NOT_YET = "what was seen so far leads to no model that can be simulated"
# started warm, a search from nowhere comes along in the first minute, where residuals are coloured or grow by this
# factor; s between such at least 10, and this share of the window
_WORSE, _AGAIN = 1.2, 0.5
# s of a stretch beyond the window; at least, and as a share of it, where searches are from nowhere
_STRETCH, _COLD_STRETCH = 60.0, 0.25


@dataclass
class _Kept:
    """What the window holds: raw rows of its runs, canonical records of closed ones."""

    rows: list[Rows]
    closed: list[Record]


class Online:
    """Feed with `update`; the same samples give the same bits. No threads, no files.

    A trial's own training runs come first and stay in the window.

    Raises:
        InputError: the trial follows nothing, or its own records do not pass.
    """

    def __init__(self, trial: Trial) -> None:
        self._trial, self._stream = trial, followed(trial)
        self._own = tuple(checked(run, trial.reference_point)[0] for run in trial.runs if run.role is Role.TRAIN)
        self._kept = _Kept([], [])
        self._runs = self._samples = 0
        self._carried: Carried | None = None
        self._inflation = 1.0
        self._known: Known | None = None
        self._onward: Onward | None = None
        self._watch = Watch(trial.model.parameters.free_names, LOOKS)
        self._elapsed, self._last = 0.0, np.nan
        self._next = self._next_cold = self._searched_at = 0.0
        self._why = "too few samples yet"
        self._is_warm = self._suits_whole_runs()
        self._shown = self._waiting()

    def begin_run(self) -> None:
        """What follows belongs to a new run: a gap, or a jump of the clock."""
        if self._onward is not None:
            self._back_to_window(self._onward)
        if self._kept.rows and len(self._kept.rows[-1]):
            if self._seconds - self._searched_at >= max(_COLD_STEP, _NEWS * self._seconds):
                self.relinearise()
            self._close()
        self._runs, self._last = self._runs + 1, np.nan
        self._kept.rows.append(Rows(len(self._stream.layout.columns)))

    def update(self, sample: Sample) -> Snapshot:
        """Take in one sample, later than the last; the estimate by now."""
        if not self._kept.rows:
            self.begin_run()
        self._samples += 1
        self._elapsed += 0.0 if np.isnan(self._last) else sample.time - self._last
        self._last = sample.time
        if self._onward is not None:
            self._take_onward(self._onward, sample)
            return self._shown
        self._kept.rows[-1].add(sample.time, sample.values)
        if self._seconds >= self._next and len(self._kept.rows[-1]) >= 3:
            self.relinearise()
        self._shown = replace(self._shown, time=sample.time, samples=self._samples, runs=self._runs)
        return self._shown

    def relinearise(self) -> Snapshot:
        """Search now, from where the last search ended, over everything in the window; a filter takes in what waits."""
        if self._onward is not None:
            self._onward.finish()
            self._shown = self._filtered(self._onward)
            return self._shown
        self._next, self._searched_at = self._seconds + self._pause, self._seconds
        if sum(len(rows) for rows in self._kept.rows) >= _FEWEST:
            try:
                with np.errstate(all="ignore"):  # a trial step may overflow; the search then takes another
                    self._known = self._searched(self._records())
                self._shown = self._told(self._known)
            except (InputError, np.linalg.LinAlgError) as error:
                self._why = str(error) if isinstance(error, InputError) else _NOT_YET
                self._shown = replace(self._shown, advice=self._why) if self._known is None else self._shown
        if self._known is not None and self._is_full:
            self._hand_over(self._known)
        return self._shown

    def _hand_over(self, known: Known) -> None:
        """To the filter where it can take over, else to what is carried."""
        if self._is_warm:
            try:
                self._onward = Onward(known, self._stream, self._trial.reference_point, self._watch)
            except InputError:
                self._onward = None
        if self._onward is None:
            self._carry(known)
        else:
            if self._stream.forgetting is not None and self._carried is not None:
                self._watch.reset()
            self._kept, self._own = _Kept([Rows(len(self._stream.layout.columns))], []), ()

    def _take_onward(self, onward: Onward, sample: Sample) -> None:
        if onward.add(sample.time, sample.values, self._elapsed):
            if not onward.is_sound:
                self._back_to_window(onward)
                return
            self._shown = self._filtered(onward)
        self._shown = replace(self._shown, time=sample.time, samples=self._samples, runs=self._runs)

    def _back_to_window(self, onward: Onward) -> None:
        """A window goes on: with the filter's information, or from nowhere where the filter lost the ship."""
        onward.finish()
        self._carried = onward.carried() if onward.is_sound else None
        self._known = self._known if onward.is_sound else None
        self._onward = None
        if self._known is None:
            self._watch.anew()
        self._next, self._searched_at, self._next_cold = 0.0, 0.0, 0.0

    def raw_runs(self) -> tuple[Run, ...]:
        """The stream's runs that are still kept, as training runs of a trial whose files have been read."""
        return tuple(self._run(self._raw(rows, i)) for i, rows in self._numbered() if len(rows) > 2)

    @property
    def covariance(self) -> Array:
        """Of the free coefficients, (k, k); infinite diagonal where nothing is known."""
        count = len(self._shown.names)
        if self._onward is not None:
            return self._onward.covariance
        return np.diag(np.full(count, np.inf)) if self._known is None else self._known.covariance

    def records(self) -> tuple[Record, ...]:
        """What the window holds, in the house's frames and signs.

        Raises:
            InputError: it is too short to be read as a record.
        """
        return tuple(self._records())

    @property
    def _seconds(self) -> float:
        """Length of what the window holds."""
        return sum(rows.seconds for rows in self._kept.rows)

    @property
    def _pause(self) -> float:
        """s until the next search."""
        if self._is_warm and self._carried is not None:
            return _STRETCH
        if self._is_warm:
            return max(_STEP, _SHARE * (self._seconds - _FIRST))
        return max(_COLD_STEP, _COLD_SHARE * self._seconds)

    @property
    def _is_full(self) -> bool:
        whole = min(self._stream.whole, self._stream.forgetting or np.inf)
        stretch = _STRETCH if self._is_warm else max(_STRETCH, _COLD_STRETCH * whole)
        return self._seconds >= (whole if self._carried is None else min(stretch, whole))

    def _suits_whole_runs(self) -> bool:
        wishes, model = self._trial.estimate, self._trial.model
        is_free = Criterion(wishes.criterion) in (Criterion.AUTO, Criterion.OUTPUT_ERROR) and wishes.segment_s is None
        return is_free and (model.is_affine or swings(model))

    def _numbered(self) -> list[tuple[int, Rows]]:
        first = self._runs - len(self._kept.rows) + 1
        return list(enumerate(self._kept.rows, start=first))

    def _raw(self, rows: Rows, number: int) -> Record:
        name = self._stream.name if number <= 1 else f"{self._stream.name}_{number}"
        return as_declared(name, self._stream.layout, rows.time, rows.values)

    def _run(self, raw: Record) -> Run:
        stream = self._stream
        return Run(Path(raw.name), stream.layout, Role.TRAIN, raw.name, waves=stream.waves, raw=raw)

    def _canonical(self, raw: Record) -> Record:
        record = checked(self._run(raw), self._trial.reference_point)[0]
        rate = self._trial.estimate.rate
        return record if rate is None else record.resampled(rate)

    def _close(self) -> None:
        number, rows = self._numbered()[-1]
        if len(rows) < 3:
            self._kept.rows.pop()
            return
        self._kept.closed.append(self._canonical(self._raw(rows, number)))

    def _records(self) -> list[Record]:
        open_run = self._numbered()[len(self._kept.closed) :]
        return [*self._own, *self._kept.closed, *(self._canonical(self._raw(r, i)) for i, r in open_run if len(r) > 2)]

    def _settings(self, records: Sequence[Record]) -> Settings:
        made = settings_of(self._trial, records)
        return made if self._carried is None else replace(made, others=(self._carried,), forces=())

    def _searched(self, records: list[Record]) -> Known:
        model, length, settings = self._trial.model, self._trial.ship.length, self._settings(records)
        sessions = [record.name for record in records]
        if not self._is_warm:
            if self._carried is not None and self._known is not None:  # what is carried is known about that point
                model = model.with_parameters(model.parameters.with_free_values(self._known.value))
            found = identified(model, records, sessions, length, settings)
            refuse_unsailed(found.made, records, sessions, settings)
            covariance = found.interval.covariance
            if self._carried is not None:
                known = np.diag(found.made.problem.priors[1])
                told = found.made.optimum.normal.reduced()[1] - known
                covariance = inverse(told / self._inflation + known)
            count = len(found.made.problem.free)
            return Known(found.made, found.residuals, covariance[:count, :count], found.inflation)
        warm = None if self._known is None else grown(self._known, model, records, sessions, settings)
        if warm is not None and self._known is not None:
            is_unsure = self._seconds < _FIRST or warm.is_coloured or warm.misfit > _WORSE * self._known.misfit
            if self._carried is not None or not is_unsure or self._seconds < self._next_cold:
                return warm
        self._next_cold = self._seconds + max(_COLD_STEP, _AGAIN * self._seconds)
        cold = begun(model, records, sessions, length, settings)
        return cold if warm is None else better(warm, cold)

    def _carry(self, known: Known) -> None:
        """Keep the window's normal equations instead of its samples."""
        problem = known.made.problem
        places = np.array([problem.model.parameters.index(n) for n in problem.free], dtype=np.int64)
        mean, weight = (of[: len(places)] for of in problem.priors)
        hessian = known.made.optimum.normal.reduced()[1]
        now = carried(places, known.value, hessian, mean, weight)
        if self._carried is None:
            self._inflation = now.inflation(hessian, known.covariance)
        if self._is_warm and problem.inflation is None:
            now = now.faded(1.0 / max(float(np.max(known.inflation)), 1.0))
        if self._stream.forgetting is not None:
            now = now.faded(float(np.exp(-self._seconds / self._stream.forgetting)))
        self._carried, self._own = now, ()
        self._kept = _Kept([Rows(len(self._stream.layout.columns))], [])
        self._next, self._searched_at = self._pause, 0.0

    def _waiting(self) -> Snapshot:
        free = self._trial.model.parameters.free
        values = np.array([p.value for p in free])
        names, units = tuple(p.name for p in free), tuple(p.unit for p in free)
        return Snapshot(0.0, 0, 0, Phase.WAITING, names, units, values, np.full(len(free), np.inf), advice=self._why)

    def _told(self, known: Known) -> Snapshot:
        problem = known.made.problem
        error = _errors(known.covariance)
        noise = dict(zip(problem.data.outputs, np.sqrt(np.nanmean(known.left**2, axis=0)).tolist(), strict=True))
        phase = Phase.WINDOW if self._carried is None else Phase.RECURSIVE
        return replace(
            self._shown, phase=phase, value=known.value, standard_error=error, noise=noise,
            untold=self._untold(known.value, error), advice="", change=self._looked(known),
        )  # fmt: skip

    def _looked(self, known: Known) -> Change | None:
        """Whether the latest stretch says otherwise, where the estimates are nested.

        They are not while what is old is forgotten, where every search chooses its criterion anew, and where the forces
        of the same waves change as more of their elevation is known.
        """
        is_nested = self._is_warm and self._stream.waves is None and self._stream.forgetting is None
        if is_nested and np.all(np.isfinite(known.covariance)):
            self._watch.look(self._elapsed, known.value, known.covariance)
        return self._watch.told or self._watch.latest

    def _filtered(self, onward: Onward) -> Snapshot:
        error = _errors(onward.covariance)
        return replace(
            self._shown, phase=Phase.RECURSIVE, value=onward.value, standard_error=error, noise=onward.noise,
            untold=self._untold(onward.value, error), advice="", change=onward.change,
        )  # fmt: skip

    def _untold(self, value: Array, error: Array) -> tuple[str, ...]:
        free = self._trial.model.parameters.free
        return tuple(p.name for p, v, s in zip(free, value, error, strict=True) if s > max(abs(v), p.scale))


def _errors(covariance: Array) -> Array:
    return np.sqrt(np.maximum(np.diag(covariance), 0.0))
