"""Beyond the window: the fit's information carried on by a recursive filter, a block of samples at a time."""

import numpy as np

from seatrial.core.results.online import CoefficientChange
from seatrial.core.values import Array, InputError, Record
from seatrial.data.check.conventions import canonical_record
from seatrial.data.read.assemble import record_from_values
from seatrial.data.trial.settings import Stream
from seatrial.estimation.estimate.online.change_detection import ChangeDetector
from seatrial.estimation.estimate.online.curvature import LINEAR_ENOUGH, curvature
from seatrial.estimation.estimate.online.handover import filter_from_fit
from seatrial.estimation.estimate.online.marginal_prior import marginalise
from seatrial.estimation.estimate.online.recursive import Forgetting
from seatrial.estimation.estimate.online.sample_rows import SampleRows
from seatrial.estimation.estimate.online.window import WindowEstimate
from seatrial.estimation.identify.online.phases import Carried, WarmUp
from seatrial.estimation.information.covariance import inverse
from seatrial.physics.simulate.replay import inputs_of

# samples taken in at once: enough to spread the cost of a block, few enough that numbers move within a second at 10 Hz
BLOCK_SAMPLES = 10
# s of samples between tests for a change: several periods of any motion of a ship
CHANGE_TEST_INTERVAL = 60.0


class RecursivePhase:
    """Goes on behind the last sample of a fit.

    Where samples are forgotten, a second filter that forgets nothing is tested for a change.

    Raises:
        InputError: the fit is too curved or does not identify every coefficient, waves come from an elevation, or
            inputs are corrected for each run; a window goes on instead.
    """

    def __init__(
        self, estimate: WindowEstimate, stream: Stream, reference_point: float, change_detector: ChangeDetector
    ) -> None:
        fit = estimate.estimate
        optimum = (fit.problem, fit.common_parameters, fit.optimum.local, fit.optimum.normal)
        if stream.waves is not None:
            raise InputError("a filter cannot turn an elevation into forces sample by sample")
        if curvature(*optimum) > LINEAR_ENOUGH:
            raise InputError("the fit is too curved within its own errors for a filter to take over")
        self._estimate, self._stream, self._reference_point = estimate, stream, reference_point
        widest = tuple(float(v) for v in np.maximum(np.abs(estimate.value), _scales(estimate)))
        forgetting = None if stream.forgetting_time_s is None else Forgetting(stream.forgetting_time_s, widest)
        self._filter = filter_from_fit(*optimum, forgetting=forgetting)
        self._unforgetting_filter = self._filter if forgetting is None else filter_from_fit(*optimum)
        self._model, self._outputs = fit.problem.model, fit.problem.data.outputs
        self._change_detector = change_detector
        self._block = SampleRows(len(stream.layout.columns))
        self._last_inputs = np.full(len(self._model.inputs), np.nan)

    def add(self, time: float, values: Array, elapsed: float) -> bool:
        """Take in one sample, `elapsed` s of samples after the first, and return whether the estimate has changed."""
        self._block.add(time, values)
        if len(self._block) < BLOCK_SAMPLES:
            return False
        self._process_block()
        self._change_detector.update(elapsed, self._unforgetting_filter.value, self._unforgetting_filter.covariance)
        return True

    def finish(self) -> None:
        """Take in the samples that wait: the run or the stream ends."""
        if len(self._block) > 1:
            self._process_block()
        self._filter.flush()
        if self._unforgetting_filter is not self._filter:
            self._unforgetting_filter.flush()

    def to_window(self) -> Carried | WarmUp:
        """Finish, and return the phase that goes on with a run whose initial state is unknown."""
        self.finish()
        if not self.is_sound:
            return WarmUp()
        problem = self._estimate.estimate.problem
        indices = np.array([self._model.parameters.index(n) for n in problem.free], dtype=np.int64)
        mean, weight = (values[: len(indices)] for values in problem.priors)
        return Carried(self._estimate, marginalise(indices, self.value, inverse(self.covariance), mean, weight))

    @property
    def is_sound(self) -> bool:
        """Whether the filter's numbers are to be trusted."""
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
        """Rms of the innovations over the last half minute, SI, by channel."""
        return dict(zip(self._outputs, self._filter.innovations.rms.tolist(), strict=True))

    @property
    def change(self) -> CoefficientChange | None:
        """The last significant change, else the result of the last test."""
        return self._change_detector.reported

    def _process_block(self) -> None:
        rows, self._block = self._block, SampleRows(self._block.values.shape[1])
        raw_record = record_from_values("", self._stream.layout, rows.time, rows.values)
        record = canonical_record(raw_record, self._reference_point)
        inputs = self._fill_inputs(record)
        measured = np.stack([record[o] if o in record else np.full(len(record), np.nan) for o in self._outputs], axis=1)
        self._filter.update(measured, inputs)
        if self._unforgetting_filter is not self._filter:
            self._unforgetting_filter.update(measured, inputs)

    def _fill_inputs(self, record: Record) -> Array:
        """Inputs of a block, (n, nu); a missing value is replaced by the last one received, at first by zero."""
        filled = {}
        for index, item in enumerate(self._model.inputs):
            if item.name in record and not np.all(np.isfinite(record[item.name])):
                values = record[item.name].copy()
                before = 0.0 if np.isnan(self._last_inputs[index]) else self._last_inputs[index]
                for i in np.flatnonzero(~np.isfinite(values)):
                    values[i] = values[i - 1] if i else before
                filled[item.name] = record.channel(item.name).with_values(values)
        complete = Record(record.name, record.time, {**record.channels, **filled}, record.kind, record.provenance)
        for index, item in enumerate(self._model.inputs):
            self._last_inputs[index] = complete[item.name][-1] if item.name in complete else 0.0
        return inputs_of(self._model, complete)


def _scales(estimate: WindowEstimate) -> Array:
    """The size of each free coefficient below which a value counts as zero, (k,)."""
    parameters = estimate.estimate.problem.model.parameters
    return np.array([parameters[n].characteristic_scale for n in estimate.estimate.problem.free])
