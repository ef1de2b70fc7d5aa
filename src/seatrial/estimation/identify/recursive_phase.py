"""Beyond the window: the fit's information carried on by a recursive filter, a block of samples at a time."""

import numpy as np

from seatrial.core.results.online import CoefficientChange
from seatrial.core.values import Array, InputError, Record
from seatrial.data.check.conventions import canonical_record
from seatrial.data.read.assemble import record_from_values
from seatrial.data.trial.trial import Stream
from seatrial.estimation.estimate.online.change_detection import ChangeDetector
from seatrial.estimation.estimate.online.curvature import LINEAR_ENOUGH, curvature
from seatrial.estimation.estimate.online.handover import filter_from_fit
from seatrial.estimation.estimate.online.marginal_prior import MarginalPrior, marginalise
from seatrial.estimation.estimate.online.recursive import Forgetting
from seatrial.estimation.estimate.online.sample_rows import SampleRows
from seatrial.estimation.estimate.online.window import WindowEstimate
from seatrial.estimation.information.covariance import inverse
from seatrial.physics.simulate.channels import inputs_of

# samples taken in at once; s between looks for a change
BLOCK_SAMPLES, CHANGE_TEST_INTERVAL = 10, 60.0


class RecursivePhase:
    """What a stream tells behind the last sample of a fit; refuses what a filter cannot carry on.

    Where samples are forgotten, a second filter that forgets nothing watches for a change.

    Raises:
        InputError: the fit is too curved or does not tell every coefficient, waves come from an elevation, or inputs
            are corrected for each run; a window goes on instead.
    """

    def __init__(
        self, estimate: WindowEstimate, stream: Stream, reference_point: float, change_detector: ChangeDetector
    ) -> None:
        made = estimate.estimate
        at = (made.problem, made.common_parameters, made.optimum.local, made.optimum.normal)
        if stream.waves is not None:
            raise InputError("a filter cannot turn an elevation into forces sample by sample")
        if curvature(*at) > LINEAR_ENOUGH:
            raise InputError("the fit is too curved within its own errors for a filter to take over")
        self._stream, self._reference_point = stream, reference_point
        widest = tuple(float(v) for v in np.maximum(np.abs(estimate.value), _scales(estimate)))
        fading = None if stream.forgetting_time is None else Forgetting(stream.forgetting_time, widest)
        self._filter = filter_from_fit(*at, forgetting=fading)
        self._unforgetting_filter = self._filter if fading is None else filter_from_fit(*at)
        self._model, self._names, self._outputs = made.problem.model, made.problem.free, made.problem.data.outputs
        self._priors = tuple(of[: len(self._names)] for of in made.problem.priors)
        self._change_detector = change_detector
        self._block, self._last_inputs = (
            SampleRows(len(stream.layout.columns)),
            np.full(len(self._model.inputs), np.nan),
        )

    def add(self, time: float, values: Array, elapsed: float) -> bool:
        """One sample, so many s of samples after the first of all; whether the numbers have moved."""
        self._block.add(time, values)
        if len(self._block) < BLOCK_SAMPLES:
            return False
        self._process_block()
        self._change_detector.update(elapsed, self._unforgetting_filter.value, self._unforgetting_filter.covariance)
        return True

    def _process_block(self) -> None:
        rows, self._block = self._block, SampleRows(self._block.values.shape[1])
        record = canonical_record(
            record_from_values("", self._stream.layout, rows.time, rows.values), self._reference_point
        )
        inputs = self._fill_inputs(record)
        measured = np.stack([record[o] if o in record else np.full(len(record), np.nan) for o in self._outputs], axis=1)
        for one in {id(f): f for f in (self._filter, self._unforgetting_filter)}.values():
            one.update(measured, inputs)

    def _fill_inputs(self, record: Record) -> Array:
        """Inputs of a block, (n, nu); where one is missing the last one known stands."""
        held = {}
        for place, item in enumerate(self._model.inputs):
            if item.name in record and not np.all(np.isfinite(record[item.name])):
                values = record[item.name].copy()
                before = 0.0 if np.isnan(self._last_inputs[place]) else self._last_inputs[place]
                for i in np.flatnonzero(~np.isfinite(values)):
                    values[i] = values[i - 1] if i else before
                held[item.name] = record.channel(item.name).with_values(values)
        whole = Record(record.name, record.time, {**record.channels, **held}, record.kind, record.provenance)
        for place, item in enumerate(self._model.inputs):
            self._last_inputs[place] = whole[item.name][-1] if item.name in whole else 0.0
        return inputs_of(self._model, whole)

    def finish(self) -> None:
        """Take in what still waits: the run or the stream ends."""
        if len(self._block) > 1:
            self._process_block()
        self._filter.flush()
        if self._unforgetting_filter is not self._filter:
            self._unforgetting_filter.flush()

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
    def change(self) -> CoefficientChange | None:
        """The last change told, else what the last look found."""
        return self._change_detector.detected or self._change_detector.latest

    def marginal_prior(self) -> MarginalPrior:
        """All that is known, for a window that goes on with a run whose start nobody knows."""
        places = np.array([self._model.parameters.index(n) for n in self._names], dtype=np.int64)
        return marginalise(places, self.value, inverse(self.covariance), *self._priors)


def _scales(estimate: WindowEstimate) -> Array:
    parameters = estimate.estimate.problem.model.parameters
    return np.array([parameters[n].characteristic_scale for n in estimate.estimate.problem.free])
