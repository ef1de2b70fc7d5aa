"""Beyond the window: the fit's information carried on by a recursive filter, a block of samples at a time."""

import numpy as np

from seatrial.core.results.online import Change
from seatrial.core.values import Array, InputError, Record
from seatrial.data.check.conventions import canonical
from seatrial.data.read.assemble import as_declared
from seatrial.data.trial.trial import Stream
from seatrial.estimation.estimate.online.carried import Carried, carried
from seatrial.estimation.estimate.online.change import Watch
from seatrial.estimation.estimate.online.curvature import STRAIGHT, curvature
from seatrial.estimation.estimate.online.handover import taken_over
from seatrial.estimation.estimate.online.recursive import Forgetting
from seatrial.estimation.estimate.online.rows import Rows
from seatrial.estimation.estimate.online.window import Known
from seatrial.estimation.information.covariance import inverse
from seatrial.physics.simulate.channels import inputs_of

# samples taken in at once; s between looks for a change
BLOCK, LOOKS = 10, 60.0


class Onward:
    """What a stream tells behind the last sample of a fit; refuses what a filter cannot carry on.

    Where samples are forgotten, a second filter that forgets nothing watches for a change.

    Raises:
        InputError: the fit is too curved or does not tell every coefficient, waves come from an elevation, or inputs
            are corrected for each run; a window goes on instead.
    """

    def __init__(self, known: Known, stream: Stream, reference_point: float, watch: Watch) -> None:
        made = known.made
        at = (made.problem, made.shared, made.optimum.local, made.optimum.normal)
        if stream.waves is not None:
            raise InputError("a filter cannot turn an elevation into forces sample by sample")
        if curvature(*at) > STRAIGHT:
            raise InputError("the fit is too curved within its own errors for a filter to take over")
        self._stream, self._reference_point = stream, reference_point
        widest = tuple(float(v) for v in np.maximum(np.abs(known.value), _scales(known)))
        fading = None if stream.forgetting is None else Forgetting(stream.forgetting, widest)
        self._filter = taken_over(*at, forgetting=fading)
        self._watching = self._filter if fading is None else taken_over(*at)
        self._model, self._names, self._outputs = made.problem.model, made.problem.free, made.problem.data.outputs
        self._priors = tuple(of[: len(self._names)] for of in made.problem.priors)
        self._watch = watch
        self._block, self._last = Rows(len(stream.layout.columns)), np.full(len(self._model.inputs), np.nan)

    def add(self, time: float, values: Array, elapsed: float) -> bool:
        """One sample, so many s of samples after the first of all; whether the numbers have moved."""
        self._block.add(time, values)
        if len(self._block) < BLOCK:
            return False
        self._take()
        self._watch.look(elapsed, self._watching.value, self._watching.covariance)
        return True

    def _take(self) -> None:
        rows, self._block = self._block, Rows(self._block.values.shape[1])
        record = canonical(as_declared("", self._stream.layout, rows.time, rows.values), self._reference_point)
        inputs = self._complete(record)
        measured = np.stack([record[o] if o in record else np.full(len(record), np.nan) for o in self._outputs], axis=1)
        for one in {id(f): f for f in (self._filter, self._watching)}.values():
            one.update(measured, inputs)

    def _complete(self, record: Record) -> Array:
        """Inputs of a block, (n, nu); where one is missing the last one known stands."""
        held = {}
        for place, item in enumerate(self._model.inputs):
            if item.name in record and not np.all(np.isfinite(record[item.name])):
                values = record[item.name].copy()
                before = 0.0 if np.isnan(self._last[place]) else self._last[place]
                for i in np.flatnonzero(~np.isfinite(values)):
                    values[i] = values[i - 1] if i else before
                held[item.name] = record.channel(item.name).with_values(values)
        whole = Record(record.name, record.time, {**record.channels, **held}, record.kind, record.provenance)
        for place, item in enumerate(self._model.inputs):
            self._last[place] = whole[item.name][-1] if item.name in whole else 0.0
        return inputs_of(self._model, whole)

    def finish(self) -> None:
        """Take in what still waits: the run or the stream ends."""
        if len(self._block) > 1:
            self._take()
        self._filter.flush()
        if self._watching is not self._filter:
            self._watching.flush()

    @property
    def is_sound(self) -> bool:
        """Whether the filter may be believed."""
        return self._filter.is_sound

    @property
    def value(self) -> Array:
        """Coefficients, (k,)."""
        return self._filter.value

    @property
    def covariance(self) -> Array:
        """Of the coefficients, (k, k)."""
        return self._filter.covariance

    @property
    def noise(self) -> dict[str, float]:
        """Rms of the innovations over the last half minute, SI."""
        return dict(zip(self._outputs, self._filter.innovations.rms.tolist(), strict=True))

    @property
    def change(self) -> Change | None:
        """The last change told, else what the last look found."""
        return self._watch.told or self._watch.latest

    def carried(self) -> Carried:
        """All that is known, for a window that goes on with a run whose start nobody knows."""
        places = np.array([self._model.parameters.index(n) for n in self._names], dtype=np.int64)
        return carried(places, self.value, inverse(self.covariance), *self._priors)


def _scales(known: Known) -> Array:
    parameters = known.made.problem.model.parameters
    return np.array([parameters[n].characteristic_scale for n in known.made.problem.free])
