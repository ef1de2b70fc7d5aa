"""Errors of instruments that nobody stated: estimated where a pair of channels shows them, else inside the intervals.

An error of the size e adds e C(t) to what is shown, C by the simulated motion: it is the same as records from which
e C(t) is taken. So gradient and curvature by e follow from the problem of output error at such records.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from seatrial.core.values import Array, Record
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.point_estimate import (
    PointEstimate,
    effective_inflation,
    residual_correlation,
    residual_spread,
)
from seatrial.estimation.estimate.timing import UNIFORM
from seatrial.estimation.identify.assumed_information import output_error_estimate
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.problem.output_error import OutputError
from seatrial.numerics.optimise import NormalEquations, levenberg_marquardt
from seatrial.physics.sensors import Sensors, VelocityReference
from seatrial.physics.sensors.measured_outputs import lag_name
from seatrial.physics.sensors.settings import Antenna, Late

_STEP = 0.1  # of an error's standard deviation, of differences by it; chosen: these are exact where it is linear
_BIAS, _SCALE = 0.02, 0.05  # rad/s and 1: standard deviations of a yaw rate's zero and scale, before records; chosen
_LEAST_BIAS, _LEAST_SCALE = 0.002, 0.01  # rad/s and 1: below, a good rate gyro may be off; chosen
_LEAST_LEVER = 0.05  # of the ship's length, as in `antenna_place`: less is what a model of sway misses; chosen
_LEAST_LAG = 0.2  # s: below, a model that is not the craft's may well ask for it; chosen
_LAG = 1.0  # s, that of a lag where it is sought; chosen: filters of receivers and compasses
_LIKELIER = 25.0  # twice the gain of likelihood from which an error is sought, five standard errors; chosen
_EVALUATIONS = 12  # of a short search beside such errors; chosen
_CERTAIN = 2.0  # standard errors by which an error that is estimated differs from none, 95 %


@dataclass(frozen=True, eq=False)
class SensorError:
    """An error of an instrument.

    Attributes:
        name: of the coefficient that a model with sensors has of it; unit: of that.
        deviation: standard deviation where it is sought; undetected: where nothing shows it, 0: it then is none.
        negligible: size up to which it is what a model misses or a sample leaves open, and stays inside the intervals.
        slopes: channel -> what one unit of it adds to what is shown, (rows,), SI; least: smallest that there is.
    """

    name: str
    unit: str
    deviation: float
    undetected: float
    negligible: float
    slopes: Mapping[str, Array]
    least: float = -np.inf


@dataclass(frozen=True, eq=False)
class Suspect:
    """An instrument with errors that go together, in words and as the setting that has them estimated.

    reverse: in words where its error is negative.
    """

    description: str
    errors: tuple[SensorError, ...]
    stated: Callable[[Sensors], Sensors]
    line: str
    reverse: str = ""

    def text(self, sizes: Mapping[str, float]) -> str:
        """Return what is wrong with it, by errors of these sizes."""
        is_reverse = bool(self.reverse) and sizes[self.errors[0].name] < 0.0
        return self.reverse if is_reverse else self.description

    def matters(self, sizes: Mapping[str, float], spread: Mapping[str, float]) -> bool:
        """Whether errors of these sizes and standard errors are possible, and one certainly is not negligible."""
        return all(sizes[e.name] >= e.least for e in self.errors) and any(
            abs(sizes[e.name]) - _CERTAIN * spread[e.name] > e.negligible for e in self.errors
        )


def suspects(estimation: Estimation, records: Sequence[Record], length: float) -> list[Suspect]:
    """Return the instruments whose errors the estimate's model does not have and that two compared channels can show.

    length: of the ship [m], aboard of which an antenna stands.
    """
    motion = _Motion.of_estimate(estimation)
    if "psi" not in motion.channels or estimation.estimate.problem.model.is_affine:
        return []
    stated = Sensors.from_text(estimation.estimate.problem.model.equations.sensors)
    found = [*_of_yaw(motion, records)] if "r" in motion.channels else []
    if {"x0", "y0"} <= motion.channels.keys():
        found += _of_receiver(motion, records, stated, length)
    present = estimation.estimate.problem.model.parameters
    return [one for one in found if all(e.name not in present for e in one.errors)]


@dataclass(frozen=True, eq=False)
class _Motion:
    """The simulated motion by compared channel, (rows,), and its rates."""

    channels: Mapping[str, Array]
    rates: Mapping[str, Array]

    @classmethod
    def of_estimate(cls, estimation: Estimation) -> "_Motion":
        """Return the motion by output error."""
        estimate = output_error_estimate(estimation)
        data = estimate.problem.data
        simulated = estimate.problem.simulated_outputs(estimate.common_parameters, estimate.optimum.local)
        rates = np.concatenate([np.gradient(simulated[a:b], data.dt, axis=0) for a, b in pairwise(data.offsets)])
        return cls(dict(zip(data.outputs, simulated.T, strict=True)), dict(zip(data.outputs, rates.T, strict=True)))


def _of_yaw(motion: _Motion, records: Sequence[Record]) -> Iterator[Suspect]:
    """Errors of a compass and a yaw rate that are read together."""
    r, ones = motion.channels["r"], np.ones(len(motion.channels["r"]))
    yield Suspect(
        "the yaw rate has a bias", (SensorError("r_bias", "rad/s", _BIAS, _BIAS, _LEAST_BIAS, {"r": ones}),),
        lambda s: replace(s, yaw_rate_bias=True), "yaw_rate_bias = true",
    )  # fmt: skip
    yield Suspect(
        "the yaw rate is scaled", (SensorError("r_scale", "1", _SCALE, _SCALE, _LEAST_SCALE, {"r": r}),),
        lambda s: replace(s, yaw_rate_scale=True), "yaw_rate_scale = true",
    )  # fmt: skip
    for late, channel in ((Late.HEADING, "psi"), (Late.YAW_RATE, "r")):
        slopes = {channel: -motion.rates[channel]}
        yield _late(late, _lag_error(late, records, [channel], slopes, 0.0))


def _late(late: Late, error: SensorError) -> Suspect:
    instrument = f"the {late.replace('_', ' ')}"
    return Suspect(
        f"{instrument} is late", (error,), lambda s: replace(s, late=(*s.late, late)), f'late = ["{late}"]',
        f"{instrument} is early, or all else is late",
    )  # fmt: skip


def _lag_error(
    late: Late, records: Sequence[Record], channels: Sequence[str], slopes: Mapping[str, Array], least: float
) -> SensorError:
    """A lag; the sample interval of its source leaves open half of it to either side, as with inputs (`timing`)."""
    interval = max(r.channel(c).sample_s or r.dt for r in records for c in channels if c in r)
    return SensorError(lag_name(late), "s", _LAG, interval / UNIFORM, max(0.5 * interval, _LEAST_LAG), slopes, least)


def _of_receiver(motion: _Motion, records: Sequence[Record], stated: Sensors, length: float) -> Iterator[Suspect]:
    """Errors of a receiver whose track is read beside a compass."""
    psi, zero = motion.channels["psi"], np.zeros(len(motion.channels["psi"]))
    lag = {c: -motion.rates[c] for c in ("x0", "y0")}
    x = {"x0": np.cos(psi), "y0": np.sin(psi)}
    y = {"x0": -np.sin(psi), "y0": np.cos(psi)}
    if stated.velocity is VelocityReference.GROUND and {"u", "v"} <= motion.channels.keys():
        u, v, r = motion.channels["u"], motion.channels["v"], motion.rates["psi"]
        # over ground: resolved along a heading that has moved on by r lag; at (x, y) it is u - y r, v + x r
        lag |= {"u": r * v - motion.rates["u"], "v": -r * u - motion.rates["v"]}
        x, y = x | {"u": zero, "v": r}, y | {"u": -r, "v": zero}
    yield _late(Late.RECEIVER, _lag_error(Late.RECEIVER, records, ["x0", "y0"], lag, -np.inf))
    aboard = length / UNIFORM  # m: an antenna stands anywhere along the ship
    yield Suspect(
        "the antenna stands elsewhere",
        tuple(
            SensorError(name, "m", aboard, aboard, _LEAST_LEVER * length, arm)
            for name, arm in (("x_antenna", x), ("y_antenna", y))
        ),
        lambda s: replace(s, antenna=Antenna(sd=aboard)), f"antenna = {{ sd = {aboard:.2g} }}",
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class ErrorInformation:
    """Gradient (m,) and curvature (m, m) by errors of instruments with all else at its optimum, priors left out.

    Attributes:
        suspects: whose errors they are, in order; by_errors: how the shared unknowns follow them, (shared, m).
    """

    suspects: tuple[Suspect, ...]
    gradient: Array
    curvature: Array
    by_errors: Array

    @property
    def errors(self) -> tuple[SensorError, ...]:
        """Of all suspects, in order."""
        return tuple(e for one in self.suspects for e in one.errors)

    def estimate(self, among: Sequence[int], deviations: Array) -> tuple[Array, Array, float]:
        """Return values (m,) and covariance (m, m) of these errors, all others none, and twice the gain of likelihood.

        deviations: before any record, (m,).
        """
        values, covariance = np.zeros(len(self.errors)), np.zeros_like(self.curvature)
        if not len(among):
            return values, covariance, 0.0
        rows = np.ix_(among, among)
        own = inverse(self.curvature[rows] + np.diag(deviations[among] ** -2.0))
        values[among], covariance[rows] = -own @ self.gradient[among], own
        return values, covariance, float(-self.gradient[among] @ values[among])


def error_information(estimation: Estimation, among: Sequence[Suspect]) -> ErrorInformation:
    """Return what output error says of these instruments, under prediction error that over segments.

    Samples count by the noise and colour that are left once all errors are taken out: a bias that is left in would
    pass for a slow disturbance, against which it is nothing.
    """
    estimate, errors = output_error_estimate(estimation), [e for one in among for e in one.errors]
    white = _information(replace(estimate, problem=replace(estimate.problem, inflation=None)), among)
    values = white.estimate(range(len(errors)), np.array([e.deviation for e in errors]))[0]
    problem, local = _without_errors(estimate.problem, errors, values), estimate.optimum.local
    optimum = levenberg_marquardt(problem, estimate.common_parameters, local, evaluations=_EVALUATIONS)
    residuals = PointEstimate(problem, optimum).residuals()
    if not np.all(np.isfinite(np.nan_to_num(residuals))):
        return _information(estimate, among)
    noise = residual_spread(problem, residuals)
    inflation = effective_inflation(residual_correlation(problem, residuals)[1])
    return _information(replace(estimate, problem=replace(estimate.problem, noise=noise, inflation=inflation)), among)


def _without_errors(problem: OutputError, errors: Sequence[SensorError], sizes: Sequence[float] | Array) -> OutputError:
    """The problem of records from which errors of these sizes are taken."""
    measured, outputs = problem.data.measured.copy(), problem.data.outputs
    for error, size in zip(errors, sizes, strict=True):
        for channel, slope in error.slopes.items():
            measured[:, outputs.index(channel)] -= size * slope
    return replace(problem, data=replace(problem.data, measured=measured))


def _information(estimate: PointEstimate, among: Sequence[Suspect]) -> ErrorInformation:
    """The same with samples counted as the estimate's problem does: its cost is quadratic in the errors."""
    problem, point, local = estimate.problem, estimate.common_parameters, estimate.optimum.local
    errors = [e for one in among for e in one.errors]
    steps = np.diag([_STEP * e.deviation for e in errors])
    normal = problem.normal(point, local)
    ahead = [_without_errors(problem, errors, step).normal(point, local) for step in steps]
    behind = [_without_errors(problem, errors, -step).cost(point, local) for step in steps]
    curvature = np.diag([a.cost + b - 2.0 * normal.cost for a, b in zip(ahead, behind, strict=True)])
    for i in range(len(errors)):
        for j in range(i):
            both = _without_errors(problem, errors, steps[i] + steps[j]).cost(point, local)
            curvature[i, j] = curvature[j, i] = both - ahead[i].cost - ahead[j].cost + normal.cost
    sizes = np.diag(steps)
    slope = np.array([a.cost - b for a, b in zip(ahead, behind, strict=True)]) / (2.0 * sizes)
    gradient, hessian = _with_errors(normal, ahead, sizes, slope, curvature / np.outer(sizes, sizes)).without_local()
    size = len(point)
    moving = np.flatnonzero((point > problem.lower) & (point < problem.upper))
    by_errors = np.zeros((size, len(errors)))
    by_errors[moving] = -inverse(hessian[np.ix_(moving, moving)]) @ hessian[moving, size:]
    own = hessian[size:, size:] + hessian[size:, :size] @ by_errors
    if not (np.all(np.isfinite(own)) and np.all(np.isfinite(gradient))):
        raise ArithmeticError("the simulation leaves what a computer can hold where an instrument's error is tried")
    return ErrorInformation(
        tuple(among), gradient[size:] + by_errors.T @ gradient[:size], 0.5 * (own + own.T), by_errors
    )


def _with_errors(
    normal: NormalEquations, ahead: Sequence[NormalEquations], sizes: Array, slope: Array, curvature: Array
) -> NormalEquations:
    """The normal equations with errors behind the shared unknowns; ahead: at records without their sizes.

    slope, curvature: of the cost by the errors.
    """
    pairs = list(zip(ahead, sizes, strict=True))
    by_shared = np.array([(a.gradient - normal.gradient) / step for a, step in pairs])
    by_local = np.array([(a.local_gradient - normal.local_gradient) / step for a, step in pairs])
    return NormalEquations(
        normal.cost, np.concatenate([normal.gradient, slope]),
        np.block([[normal.hessian, by_shared.T], [by_shared, curvature]]), normal.local_gradient, normal.local_hessian,
        np.concatenate([normal.cross, np.swapaxes(by_local, 0, 1)], axis=1) if normal.local_gradient.size else
        np.zeros((0, len(normal.gradient) + len(sizes), 0)),
    )  # fmt: skip


def detected_errors(information: ErrorInformation, widening: float) -> list[Suspect]:
    """Return the instruments whose errors the records show: taken up in turn, that which explains most first.

    widening: standard errors of the fit over those that information alone gives: what model error adds.
    """
    among, deviations = information.suspects, np.array([e.deviation for e in information.errors])
    names = [e.name for e in information.errors]
    taken: list[Suspect] = []
    before = 0.0
    while len(taken) < len(among):
        gains = {}
        for k, one in enumerate(among):
            if one not in taken:
                indices = [names.index(e.name) for s in (*taken, one) for e in s.errors]
                values, covariance, gain = information.estimate(indices, deviations)
                sizes = dict(zip(names, values.tolist(), strict=True))
                spread = dict(zip(names, (widening * np.sqrt(np.diag(covariance))).tolist(), strict=True))
                gains[k] = gain - before if one.matters(sizes, spread) else 0.0
        best = max(gains, key=lambda k: gains[k])
        if gains[best] < _LIKELIER * widening**2:
            break
        taken.append(among[best])
        before += gains[best]
    return taken


def instrument_errors(estimation: Estimation, records: Sequence[Record], length: float) -> ErrorInformation | None:
    """Return what the records say of errors that the estimate's model does not have; None: of none.

    length: of the ship [m].
    """
    among = suspects(estimation, records, length)
    return error_information(estimation, among) if among else None


def with_undetected_sensor_errors(estimation: Estimation, information: ErrorInformation | None) -> Estimation:
    """Return the estimation whose intervals hold errors of instruments that its model does not have.

    Each may be as large as is plausible before any record and as the records leave it.
    """
    if information is None:
        return estimation
    count = len(estimation.estimate.problem.free)
    values, covariance, _ = information.estimate(
        range(len(information.errors)), np.array([e.undetected for e in information.errors])
    )
    moves = information.by_errors[:count]
    interval, widened = estimation.interval, estimation.interval.covariance.copy()
    widened[:count, :count] += moves @ (covariance + np.outer(values, values)) @ moves.T
    meaning = f"{interval.meaning}, with lags, levers and zeros of instruments that the records leave open"
    interval = replace(interval, covariance=widened, meaning=meaning)
    return replace(estimation, uncertainty=replace(estimation.uncertainty, interval=interval))
